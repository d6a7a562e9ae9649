"""Case files of bridges in: a TOML text, with a table of stays or without, becomes a Bridge or every fault at once."""

from pathlib import Path
from typing import Any

from rainwind.engineering.bridge import Bridge, ClimateSource, Limits, Question, Site
from rainwind.engineering.cable import Cable
from rainwind.errors import CaseError, InputError
from rainwind.io.bridge_schema import BRIDGE_KEYS, BRIDGE_MARKS
from rainwind.io.bridge_stays import read_stays
from rainwind.io.case_keys import Given, check_top, read_table, refusal
from rainwind.io.cases import case_content, case_file_text
from rainwind.io.climate_files import read_climate
from rainwind.io.faults import Faults
from rainwind.io.lines import key_lines
from rainwind.io.usual_bridge import unusual_bridge
from rainwind.physics.coefficient_files import load_coefficients, shipped_sets
from rainwind.physics.rivulet import Rivulet

__all__ = ["bridge_from_text", "is_bridge_case", "read_bridge", "unusual_bridge"]

_SMALL = 65536  # bytes of a file of records that are looked at


def read_bridge(path: Path | str) -> Bridge:
    """The bridge that the case file at `path` describes, in SI and radians; files it names are found beside it.

    Raises CaseError with every fault of the file and its table of stays, each with its line, or its row and column.
    """
    path = Path(path)
    return bridge_from_text(case_file_text(path), name=str(path), folder=path.parent)


def is_bridge_case(path: Path | str) -> bool:
    """Whether the file describes a bridge: it has [bridge], [cable] or [stays]. CaseError for one that is no TOML."""
    content = case_content(case_file_text(Path(path)), str(path))
    return any(mark in content for mark in BRIDGE_MARKS)


def bridge_from_text(text: str, name: str = "case", folder: Path | None = None) -> Bridge:
    """The bridge that a case file's text describes; files it names are looked for in `folder`.

    Raises CaseError as `read_bridge` does.
    """
    content = case_content(text, name)
    folder = folder or Path()
    faults = Faults(name, key_lines(text))
    check_top(content, faults, BRIDGE_KEYS)
    values = {
        table: read_table(table, content.get(table, {}), faults.part(table), BRIDGE_KEYS)
        for table in ("bridge", "site", "limits", "assessment")
    }
    observed = Limits().observed_speeds
    limits = _pair(values["limits"], "observed_low", "observed_high", "observed_speeds", observed)
    stays = read_stays(content, folder, faults)
    records: dict[str, Any] = {
        "site": _record("site", Site, values["site"], faults),
        "limits": _record("limits", Limits, limits, faults),
        "question": _record(
            "assessment", Question, _assessment(values["assessment"], folder, faults), faults
        ),
        "climate": _climate(content, folder, faults),
        "rivulet": _rivulet(content, stays, faults),
    }
    if faults.any and records["climate"] is not None:
        _climate_faults(records["climate"], faults)
    faults.raise_any()
    said = {key: given.value for key, given in values["bridge"].items()}
    try:
        return Bridge(**({"name": Path(name).stem} | said), stays=stays, **records)
    except InputError as error:  # tables that are each allowed and do not fit each other
        faults.add(str(error), "limits" if "limits" in content else "assessment")
        faults.raise_any()
        raise


def _record(table: str, kind: Any, values: dict[str, Given], faults: Faults) -> Any:
    """The table's dataclass; each value is tried alone first, so that its fault is found at its line."""
    numbers = BRIDGE_KEYS.numbers_of(table)
    refused = False
    for name, given in values.items():
        try:
            kind(**{name: given.value})
        except InputError as error:
            refused = True
            faults.add(
                refusal(numbers[name], given, error) if name in numbers else str(error), table, given.key
            )
    if refused:
        return None
    try:
        return kind(**{name: given.value for name, given in values.items()})
    except InputError as error:  # values that are each allowed and do not fit each other
        faults.add(str(error), table)
        return None


def _pair(
    values: dict[str, Given], low: str, high: str, field: str, usual: tuple[float, float]
) -> dict[str, Given]:
    """`values` with the two numbers as one field; the one that is left out is the usual one."""
    rest = {name: given for name, given in values.items() if name not in (low, high)}
    given = [values[name] for name in (low, high) if name in values]
    if given:
        both = tuple(
            values[name].value if name in values else one
            for name, one in zip((low, high), usual, strict=True)
        )
        rest[field] = Given(given[0].key, given[0].raw, both)
    return rest


def _assessment(values: dict[str, Given], folder: Path, faults: Faults) -> dict[str, Given]:
    """The fields of `Question`; the sets of coefficients are looked for."""
    values = _pair(values, "low", "high", "speeds", Question().speeds)
    if "sets" in values:
        given = values["sets"]
        names = tuple(_set(name, folder, faults) for name in given.value)
        values = values | {"sets": Given(given.key, given.raw, names)}
    return values


def _set(name: str, folder: Path, faults: Faults) -> str:
    """The name of a shipped set, or the path of a set's file."""
    is_file = name.endswith(".toml") or "/" in name or "\\" in name
    found = str(folder / name) if is_file else name.replace("_", "-")
    try:
        coefficients = load_coefficients(found)
    except (InputError, OSError) as error:
        faults.add(f"sets: '{name}': {error}", "assessment", "sets")
        return name
    if coefficients.moment is None:
        whole = ", ".join(one for one in shipped_sets() if load_coefficients(one).moment is not None)
        faults.add(
            f"sets: '{name}' has no moment curve, and the rivulet needs one; sets that have one: {whole}",
            "assessment",
            "sets",
        )
    return found


def _climate(content: dict[str, Any], folder: Path, faults: Faults) -> ClimateSource | None:
    if not isinstance(content.get("climate"), dict):
        return None
    values = read_table("climate", content["climate"], faults.part("climate"), BRIDGE_KEYS)
    fields = {
        {"file": "path"}.get(name, name): Given(
            given.key, given.raw, folder / given.value if name == "file" else given.value
        )
        for name, given in values.items()
    }
    if "path" not in fields:
        return None
    wrong = _unreadable(fields["path"].value)
    if wrong:
        faults.add(f"file = '{fields['path'].raw}': {wrong}", "climate", "file")
    sample = {"path": fields["path"].value}
    numbers = BRIDGE_KEYS.numbers_of("climate")
    for name, given in fields.items():
        try:
            ClimateSource(**(sample | {name: given.value}))
        except InputError as error:
            wrong = str(error)
            faults.add(refusal(numbers[name], given, error), "climate", given.key)
    return None if wrong else ClimateSource(**{name: given.value for name, given in fields.items()})


def _climate_faults(source: ClimateSource, faults: Faults) -> None:
    """What is wrong inside the file, beside the faults there are; of a case without any it is read later, and once."""
    try:
        read_climate(source)
    except CaseError as error:
        faults.behind(str(error))


def _unreadable(path: Path) -> str:
    """What is wrong with a file of records at first sight; empty if nothing."""
    try:
        if path.is_dir():
            return "is a folder; name the file in it"
        if not path.exists():
            return "there is no such file; give its name relative to the case file, or leave [climate] out"
        with path.open("rb") as file:
            start = file.read(_SMALL)
    except (OSError, ValueError) as error:
        return f"cannot be read ({getattr(error, 'strerror', None) or error})"
    lines = [line for line in start.splitlines() if line.strip() and not line.lstrip().startswith(b"#")]
    if not lines:
        return "is empty; it needs a line of headers and records, or leave [climate] out"
    if len(lines) == 1 and path.suffix.lower() in (".csv", ".txt"):
        return "has headers and no record below them"
    return ""


def _rivulet(content: dict[str, Any], stays: tuple[Cable, ...], faults: Faults) -> Rivulet | None:
    if not isinstance(content.get("rivulet"), dict):
        return None
    values = read_table("rivulet", content["rivulet"], faults.part("rivulet"), BRIDGE_KEYS)
    rivulet = _record("rivulet", Rivulet, values, faults)
    if rivulet is None or len(values) < 3:
        return None
    thin = next((stay for stay in stays if rivulet.height >= stay.diameter), None)
    if thin is not None:
        given = values["height"]
        faults.add(
            f"{given.key} = {given.raw!r}: a rivulet of {1000 * rivulet.height:g} mm is as high as stay "
            f"'{thin.name}' is thick, {1000 * thin.diameter:g} mm; correct either number or its unit",
            "rivulet",
            given.key,
        )
    return rivulet
