"""The stays of a case file, from [[cable]] and from the rows of [stays], each with its faults and their places."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import sqrt
from pathlib import Path
from typing import Any

from rainwind.engineering.cable import Cable, Damper
from rainwind.errors import InputError
from rainwind.io.bridge_schema import BRIDGE_KEYS, FIELDS
from rainwind.io.case_keys import Given, nearest, read_table, refusal
from rainwind.io.faults import Faults, Place
from rainwind.io.stay_tables import read_stay_rows

__all__ = ["read_stays"]

LOWEST, HIGHEST = 0.05, 20.0  # Hz: no stay has a first frequency outside (engineer's judgement, chosen wide)
SLACK, BREAKS = (
    5.0,
    20000.0,
)  # MPa if all mass is steel: a factor 1000 in any tension leaves it; carbon stays do not
STEEL = 7850.0  # kg/m³
LARGEST_DAMPING = 0.05  # of critical; stays without dampers have 0.0005 to 0.003
_FILLED_IN = ("damping", "surface", "base_height", "bending_stiffness")
_NUMBERS = BRIDGE_KEYS.numbers_of("cable")
_SAMPLE: dict[str, Any] = {item.field: item.sample for item in _NUMBERS.values() if item.required}
_SAMPLE["name"] = "a stay"


@dataclass
class _Damper:
    """A damper that was read, and where; stays: of which, None for the one that it stands under or for all."""

    damper: Damper
    position: Given
    place: Place
    stays: tuple[str, ...] | None = None


@dataclass
class _Stay:
    """What a table or row says of one stay."""

    place: Place
    values: dict[str, Given]
    dampers: list[_Damper] = field(default_factory=list)


def read_stays(content: dict[str, Any], folder: Path, faults: Faults) -> tuple[Cable, ...]:
    """All stays in the order of the file, those of [stays] last; stays with a fault are left out."""
    defaults: dict[str, Given] = {}
    if isinstance(content.get("cable_defaults"), dict):
        place = faults.part("cable_defaults")
        defaults = read_table("cable_defaults", content["cable_defaults"], place, BRIDGE_KEYS)
        defaults = {name: given for name, given in defaults.items() if not _refused(name, given, place)}
    stays = [*_from_tables(content, defaults, faults), *_from_rows(content, folder, defaults, faults)]
    if not content.get("cable") and "stays" not in content:
        faults.add("no stay is given; write [[cable]] once for each stay, or [stays] with a table of them")
    shared = _shared_dampers(content, stays, faults)
    _check_names(stays)
    cables = (_cable(stay, defaults, shared) for stay in stays)
    return tuple(cable for cable in cables if cable is not None)


def _from_tables(content: dict[str, Any], defaults: dict[str, Given], faults: Faults) -> Iterator[_Stay]:
    for path, table in _tables(content, "cable"):
        place = faults.part(*path, label="[[cable]]" if len(path) > 1 else "[cable]")
        rest = {key: value for key, value in table.items() if key != "damper"}
        values = read_table("cable", rest, place, BRIDGE_KEYS, elsewhere=defaults)
        if "damper" in table and not any(True for _ in _tables(table, "damper")):
            place.add(
                "'damper' is no table; write [[cable.damper]] and its keys on the lines below", "damper"
            )
        dampers = (
            _damper(inner, faults.part(*path, *inner_path, label="[[cable.damper]]"), own=True)
            for inner_path, inner in _tables(table, "damper")
        )
        yield _Stay(place, values, [damper for damper in dampers if damper is not None])


def _from_rows(
    content: dict[str, Any], folder: Path, defaults: dict[str, Given], faults: Faults
) -> Iterator[_Stay]:
    if not isinstance(content.get("stays"), dict):
        return
    given = read_table("stays", content["stays"], faults.part("stays"), BRIDGE_KEYS)
    if "file" not in given:
        return
    file = given["file"].value
    path = folder / file
    sheet = given["sheet"].value if "sheet" in given else None
    try:
        if not path.is_file():
            raise InputError("there is no such file; give its name relative to the case file")
        rows = read_stay_rows(path, sheet, BRIDGE_KEYS, faults, defaults)
    except OSError as error:
        faults.add(f"file = '{file}' cannot be read ({error.strerror or error})", "stays", "file")
        return
    except InputError as error:
        faults.add(f"file = '{file}': {error}", "stays", "file")
        return
    named = {item.name for item in _NUMBERS.values()} | {"name"}
    for row in rows:
        lacking = named - {name for name in named if any(_gives(key, name) for key in row.place.columns)}
        values = read_table("cable", row.content, row.place, BRIDGE_KEYS, elsewhere={*defaults, *lacking})
        damper = _damper(row.damper, row.damper_place, own=True) if row.damper else None
        yield _Stay(row.place, values, [damper] if damper else [])


def _gives(key: str, name: str) -> bool:
    return key == name or key.startswith(f"{name}_")


def _tables(content: dict[str, Any], name: str) -> Iterator[tuple[tuple[str, ...], dict[str, Any]]]:
    """Path and content of [name], or of each [[name]]."""
    given = content.get(name)
    if isinstance(given, dict):
        yield (name,), given
    elif isinstance(given, list):
        for index, table in enumerate(given):
            if isinstance(table, dict):
                yield (name, str(index)), table


def _damper(content: dict[str, Any], place: Place, *, own: bool) -> _Damper | None:
    values = read_table("damper", content, place, BRIDGE_KEYS)
    numbers = BRIDGE_KEYS.numbers_of("damper")
    sample: dict[str, Any] = {name: item.sample for name, item in numbers.items() if item.required}
    refused = False
    for name, given in values.items():
        if name in numbers:
            try:
                Damper(**(sample | {name: given.value}))
            except InputError as error:
                refused = True
                place.add(refusal(numbers[name], given, error), given.key)
    if own and "stays" in values:
        place.add(
            "stays is for a [[damper]] that serves several; here it serves the stay it is written for",
            "stays",
        )
        refused = True
    if refused or not set(sample) <= set(values):
        return None
    fields: dict[str, Any] = {name: given.value for name, given in values.items()}
    stays = fields.pop("stays", None)
    return _Damper(Damper(**fields), values["position"], place, stays)


def _shared_dampers(content: dict[str, Any], stays: list[_Stay], faults: Faults) -> list[_Damper]:
    """Those of the top-level [[damper]]."""
    names = [_name(stay) for stay in stays]
    found = []
    for path, table in _tables(content, "damper"):
        place = faults.part(*path, label="[[damper]]" if len(path) > 1 else "[damper]")
        damper = _damper(table, place, own=False)
        if damper is None:
            continue
        for name in damper.stays or ():
            if name not in names:
                place.add(f"stays: there is no stay '{name}'; {nearest(name, names, 'stays')}", "stays")
        found.append(damper)
    return found


def _name(stay: _Stay) -> str:
    return stay.values["name"].value.strip() if "name" in stay.values else ""


def _check_names(stays: list[_Stay]) -> None:
    seen: set[str] = set()
    for stay in stays:
        name = _name(stay)
        if name and name in seen:
            stay.place.add(f"name = '{name}': another stay has this name; give each its own", "name")
        seen.add(name)


def _refused(name: str, given: Given, place: Place) -> bool:
    """Whether the value alone is refused, which is then told."""
    if name == "assumed":
        unknown = [one for one in given.value if one not in FIELDS]
        for one in unknown:
            place.add(f"assumed: there is no key '{one}'; {nearest(one, FIELDS, 'keys')}", given.key)
        return bool(unknown)
    if name not in _NUMBERS:
        return False
    item = _NUMBERS[name]
    try:
        Cable(**(_SAMPLE | {item.field: given.value}))
    except InputError as error:
        place.add(refusal(item, given, error), given.key)
        return True
    if name == "damping" and max(given.value) > LARGEST_DAMPING:
        ratio = max(given.value)
        place.add(
            f"{given.key} = {given.raw!r} is {100 * ratio:g} % of critical; no stay has more than "
            f"{100 * LARGEST_DAMPING:g} % without dampers; damping_percent = {ratio:g} if per cent are meant, and "
            "dampers belong in [[cable.damper]]",
            given.key,
        )
        return True
    return False


def _cable(stay: _Stay, defaults: dict[str, Given], shared: list[_Damper]) -> Cable | None:
    """The stay, or None after a fault; what does not need the faulty values is checked all the same."""
    refused = [name for name, given in stay.values.items() if _refused(name, given, stay.place)]
    values = {name: given for name, given in (defaults | stay.values).items() if name not in refused}
    wrong = bool(refused) | _impossible_tension(values, stay.place)
    name = _name(stay)
    dampers = [*stay.dampers, *(one for one in shared if one.stays is None or name in one.stays)]
    for one in dampers:
        wrong |= _beyond_mid_span(one, name, values)
    if wrong or not set(_SAMPLE) <= set(values):
        return None
    fields: dict[str, Any] = {
        _NUMBERS[key].field if key in _NUMBERS else key: given.value for key, given in values.items()
    }
    own = {"name": name, "assumed": _assumed(stay, defaults), "dampers": tuple(one.damper for one in dampers)}
    return Cable(**(fields | own))


def _beyond_mid_span(one: _Damper, name: str, values: dict[str, Given]) -> bool:
    """Whether the damper is no damper of this stay, which is then told."""
    if "length" not in values or one.damper.position < values["length"].value / 2:
        return False
    one.place.add(
        f"{one.position.key} = {one.position.raw!r} lies beyond mid-span of stay '{name}', which is "
        f"{values['length'].value:g} m long; give the distance from the nearer anchorage",
        one.position.key,
    )
    return True


def _assumed(stay: _Stay, defaults: dict[str, Given]) -> tuple[str, ...]:
    """What the stay says, what the defaults say of it, and what the program fills in.

    A stay's own value is not assumed only because the default that it replaces is.
    """
    own = stay.values["assumed"].value if "assumed" in stay.values else ()
    of_all = defaults["assumed"].value if "assumed" in defaults else ()
    taken = [name for name in of_all if not (name in stay.values and name in defaults)]
    filled = [name for name in _FILLED_IN if name not in stay.values and name not in defaults]
    return tuple(dict.fromkeys([*own, *taken, *filled]))


def _impossible_tension(values: dict[str, Given], place: Place) -> bool:
    """Whether the tension makes an impossible first frequency or stress, which is then told."""
    if not {"tension", "mass", "length"} <= set(values):
        return False
    tension, mass, length = (values[name] for name in ("tension", "mass", "length"))

    def made(force: float) -> tuple[float, float, bool]:
        frequency = sqrt(force / mass.value) / (2 * length.value)
        stress = force * STEEL / mass.value / 1e6
        return frequency, stress, LOWEST <= frequency <= HIGHEST and SLACK <= stress <= BREAKS

    frequency, stress, possible = made(tension.value)
    if possible:
        return False
    remedy = "correct the tension, mass or length, or a unit"
    for factor, words in ((1000.0, "a thousand times the tension"), (0.001, "a thousandth of the tension")):
        other, _, fits = made(factor * tension.value)
        if fits:
            remedy = f"with {words} it would be {other:.3g} Hz: is the unit right, kN or MN?"
            break
    place.add(
        f"{tension.key} = {tension.raw!r} with {mass.value:g} kg/m over {length.value:g} m gives a first frequency of "
        f"{frequency:.3g} Hz and, if all mass is steel, a stress of {stress:.6g} MPa; allowed is {LOWEST:g} to "
        f"{HIGHEST:g} Hz and {SLACK:g} to {BREAKS:g} MPa; {remedy}",
        tension.key,
    )
    return True
