"""Case files in: a TOML text becomes a RivuletModel, or one error that lists every fault."""

import re
import tomllib
from pathlib import Path
from typing import Any

from rainwind.errors import CaseError, InputError
from rainwind.io.case_keys import Given, check_top, read_table, refusal
from rainwind.io.faults import Faults
from rainwind.io.lines import key_lines
from rainwind.io.schema import NUMBERS, TABLES
from rainwind.io.units import has_decimal_comma
from rainwind.io.usual import FASTEST
from rainwind.physics.coefficient_files import load_coefficients, shipped_sets
from rainwind.physics.coefficients import CoefficientSet
from rainwind.physics.model import RivuletModel
from rainwind.physics.rivulet import Rivulet
from rainwind.physics.section import CableSection
from rainwind.physics.wind import Wind

__all__ = ["case_content", "case_file_text", "given_numbers", "model_from_text", "read_case"]

_DEFAULT_SET = "reconstructed"
_RECORDS = {"wind": Wind, "section": CableSection, "rivulet": Rivulet}


def read_case(path: Path | str) -> RivuletModel:
    """The model that the case file at `path` describes, in SI and radians.

    Raises CaseError with every fault of the file and its line: unreadable or no TOML, unknown or missing
    keys, wrong units, values that the physics refuses.
    """
    path = Path(path)
    return model_from_text(case_file_text(path), name=str(path), folder=path.parent)


def given_numbers(path: Path | str) -> dict[tuple[str, str], Given]:
    """(Table, name without unit) -> what the case file at `path` gives there, as it is written. Raises CaseError."""
    path = Path(path)
    content = tomllib.loads(case_file_text(path))
    faults = Faults(str(path), {})
    return {
        (table, name): given
        for table in TABLES
        for name, given in read_table(table, content.get(table, {}), faults.part(table)).items()
    }


def model_from_text(text: str, name: str = "case", folder: Path | None = None) -> RivuletModel:
    """The model that a case file's text describes; coefficient files are looked for in `folder`.

    Raises CaseError as `read_case` does.
    """
    content = case_content(text, name)
    faults = Faults(name, key_lines(text))
    check_top(content, faults)
    values = {table: read_table(table, content.get(table, {}), faults.part(table)) for table in TABLES}
    records = {table: _record(table, values[table], faults) for table in _RECORDS}
    _check_possible(values, records, faults)
    coefficients = _coefficients(values["coefficients"], folder or Path(), faults)
    choices = _choices(values, faults)
    faults.raise_any()
    assert coefficients is not None  # else there was a fault
    try:
        return RivuletModel(**records, coefficients=coefficients, **choices)
    except InputError as error:  # values that are each allowed and do not fit each other
        faults.add(str(error))
        faults.raise_any()
        raise


def case_content(text: str, name: str) -> dict[str, Any]:
    """What the TOML text says. Raises CaseError where it is no TOML."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{name}: not a TOML file: {error}; {_remedy(text, error)}") from error


def _remedy(text: str, error: tomllib.TOMLDecodeError) -> str:
    place = re.search(r"at line (\d+)", str(error))
    line = text.splitlines()[int(place[1]) - 1] if place else ""
    _, equals, value = line.partition("=")
    return "write a decimal point, not a comma" if equals and has_decimal_comma(value) else "correct it there"


def case_file_text(path: Path) -> str:
    """The text of a case file. Raises CaseError where it cannot be read."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise CaseError(f"{path}: no such file; 'rainwind new {path}' writes an example") from error
    except IsADirectoryError as error:
        raise CaseError(f"{path}: a folder, not a case file; name the file in it") from error
    except UnicodeDecodeError as error:
        raise CaseError(f"{path}: not a text file in UTF-8; save it as UTF-8") from error
    except (OSError, ValueError) as error:
        if path.is_dir():  # what Windows calls "permission denied"
            raise CaseError(f"{path}: a folder, not a case file; name the file in it") from error
        reason = getattr(error, "strerror", None) or error
        raise CaseError(f"{path}: cannot be read ({reason}); check its name and permissions") from error


def _record(table: str, values: dict[str, Given], faults: Faults) -> Any:
    """The table's dataclass; each value is tried alone first, so that its fault is found at its line."""
    numbers = {item.name: item for item in NUMBERS if item.table == table}
    sample = {item.field: item.sample for item in numbers.values() if item.required}
    refused = False
    for name, given in values.items():
        item = numbers[name]
        through = {"k3": 0.0} if item.field == "sag_offset" else {}  # means nothing without
        try:
            _RECORDS[table](**_fields(table, sample | through | {item.field: given.value}))
        except InputError as error:
            refused = True
            faults.add(refusal(item, given, error), table, given.key)
    complete = all(
        name in values or (item.parts and set(item.parts) <= set(values))
        for name, item in numbers.items()
        if item.required
    )
    if refused or not complete:
        return None
    fields = {item.field: 0.0 for item in numbers.values() if item.zero_if_left_out}
    fields |= {numbers[name].field: given.value for name, given in values.items()}
    try:
        return _RECORDS[table](**_fields(table, fields))
    except InputError as error:
        faults.add(str(error), table)
        return None


def _check_possible(values: dict[str, dict[str, Given]], records: dict[str, Any], faults: Faults) -> None:
    """What no bridge can have, though the equations could be solved for it."""
    for speed in (values["wind"].get("speed"), values["wind"].get("vertical_speed")):
        if speed is not None and abs(speed.value) > FASTEST:
            faults.add(
                f"{speed.key} = {speed.raw!r} is {speed.value:g} m/s; allowed is up to {FASTEST:g} m/s; correct the "
                "number or its unit",
                "wind",
                speed.key,
            )
    section, rivulet = records["section"], records["rivulet"]
    if section is not None and rivulet is not None and rivulet.height >= section.diameter:
        height = values["rivulet"]["height"]
        faults.add(
            f"{height.key} = {height.raw!r}: a rivulet of {1000 * rivulet.height:g} mm is as high as the cable is "
            f"thick, {1000 * section.diameter:g} mm; correct either number or its unit",
            "rivulet",
            height.key,
        )


def _fields(table: str, values: dict[str, Any]) -> dict[str, Any]:
    """What the dataclass takes: one frequency stands for two, two damping ratios need a common one."""
    fields = dict(values)
    if table == "section":
        if "frequency" in fields:
            both = fields.pop("frequency")
            fields = {"frequency_y": both, "frequency_z": both} | fields
        if "damping_ratio_y" in fields:
            fields.setdefault("damping_ratio", fields["damping_ratio_y"])
    return fields


def _coefficients(values: dict[str, Given], folder: Path, faults: Faults) -> CoefficientSet | None:
    """The coefficient set, with another set's moment where the case says so; None after a fault."""
    chosen = _load("set", values["set"].value if "set" in values else _DEFAULT_SET, folder, faults)
    if "moment_of" not in values:
        if chosen is not None and chosen.moment is None:
            given = f"the set '{chosen.name}' has no moment curve, and the rivulet needs one"
            faults.add(f'{given}; write moment_of = "{_DEFAULT_SET}"', "coefficients", "set")
            return None
        return chosen
    other = _load("moment_of", values["moment_of"].value, folder, faults)
    if chosen is None or other is None:
        return None
    try:
        return chosen.with_moment_of(other)
    except InputError as error:
        faults.add(str(error), "coefficients", "moment_of")
        return None


def _load(key: str, given: Any, folder: Path, faults: Faults) -> CoefficientSet | None:
    if not isinstance(given, str):
        known = ", ".join(shipped_sets())
        faults.add(f"{key} = {given!r} is no text; write one of {known}, or a file", "coefficients", key)
        return None
    is_file = given.endswith(".toml") or "/" in given or "\\" in given
    try:
        return load_coefficients(folder / given if is_file else given)
    except (InputError, OSError) as error:
        faults.add(f"{key} = {given!r}: {error}", "coefficients", key)
        return None


def _choices(values: dict[str, dict[str, Given]], faults: Faults) -> dict[str, Any]:
    """The model's options; each is tried alone, so that its fault is found at its line."""
    choices = {name: given.value for name, given in values["model"].items()}
    if "outside" in values["coefficients"]:
        choices["outside"] = values["coefficients"]["outside"].value
    wind, section, rivulet = Wind(speed=9.0), CableSection(), Rivulet()
    coefficients = load_coefficients(_DEFAULT_SET)
    for key, value in choices.items():
        try:
            RivuletModel(wind, section, rivulet, coefficients, **{key: value})
        except InputError as error:
            faults.add(str(error), "coefficients" if key == "outside" else "model", key)
    return choices
