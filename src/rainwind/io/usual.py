"""Usual ranges of a case's numbers: a number outside is most likely a slip in its unit. They forbid nothing.

Where no source is named, the range is an engineer's judgement, chosen wide.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi, radians

from rainwind.io.case_keys import Given
from rainwind.io.schema import NUMBERS
from rainwind.io.units import KINDS, Kind, unit_text, written
from rainwind.physics.model import RivuletModel

__all__ = [
    "FASTEST",
    "USUAL",
    "Range",
    "impossible",
    "is_usual",
    "unusual",
    "unusual_value",
    "usual_sentence",
]

FASTEST = 100.0  # m/s: no wind that a bridge has seen is faster; a number above it is a slip


@dataclass(frozen=True)
class Range:
    """What is usual for a parameter, in SI and radians, and why."""

    low: float
    high: float
    why: str
    zero: bool = False  # zero is usual too


_JUDGED = "engineer's judgement"
_DAMPING = Range(
    0.0001, 0.03, "real stays have 0.05 to 0.2 %, with dampers up to some per cent (engineer's judgement)"
)
_FREQUENCY = Range(0.1, 10.0, f"the modes of stays that rain and wind excite ({_JUDGED})")
USUAL = {
    "wind.speed": Range(1.0, 50.0, "rain-wind vibration is seen at 5 to 20 m/s, bridges are built for 50"),
    "wind.yaw": Range(
        radians(2.0), pi, f"a smaller one is most likely meant in radians ({_JUDGED})", zero=True
    ),
    "wind.density": Range(0.9, 1.5, "air from 2500 m height to the sea, -30 to 40 C", zero=True),
    "wind.vertical_speed": Range(
        0.01, 10.0, f"turbulence has some tenths of the wind speed, a slope no more ({_JUDGED})", zero=True
    ),
    "section.diameter": Range(0.04, 0.4, f"stay cables measure 80 to 300 mm ({_JUDGED})"),
    "section.mass": Range(3.0, 400.0, f"steel strands in a pipe of that diameter ({_JUDGED})"),
    "section.frequency_y": _FREQUENCY,
    "section.frequency_z": _FREQUENCY,
    "section.damping_ratio": _DAMPING,
    "section.damping_ratio_y": _DAMPING,
    "section.damping_ratio_z": _DAMPING,
    "section.inclination": Range(
        radians(5.0), pi / 2, f"a smaller one is most likely meant in radians ({_JUDGED})", zero=True
    ),
    "section.k3": Range(
        0.1, 1e6, f"EA (n pi)^4 / (4 L^4) of stays of 50 to 500 m, modes 1 to 5 ({_JUDGED})", zero=True
    ),
    "section.sag_offset": Range(
        0.0005, 5.0, f"about the sag in the first mode, less in higher ones ({_JUDGED})", zero=True
    ),
    "rivulet.mass": Range(0.002, 1.0, f"water some millimetres high and some centimetres wide ({_JUDGED})"),
    "rivulet.height": Range(0.0005, 0.02, f"surface tension holds no higher rivulet ({_JUDGED})"),
    "rivulet.friction": Range(
        0.0005, 5.0, f"a hundredth to a hundred times the sample case's, measured by nobody ({_JUDGED})"
    ),
}
# above solid steel, because dampers and ice add mass to a real stay
SOLID = Range(1000.0, 10000.0, "water has 1000, solid steel 7850 kg/m3")


def unusual(model: RivuletModel, given: Mapping[tuple[str, str], Given] | None = None) -> list[str]:
    """A sentence for each number of the model that is outside its usual range; none is an error.

    given: (table, name) -> what a case file gives there (`given_numbers`), so that the sentences quote the file.
    """
    return list(_sentences(model, given or {}))


def _sentences(model: RivuletModel, given: Mapping[tuple[str, str], Given]) -> Iterator[str]:
    values = model.parameters
    section = model.section
    both = section.frequency_y == section.frequency_z
    apart = section.damping_ratio_y is not None and section.damping_ratio_z is not None
    for name, usual in USUAL.items():
        hidden = (both and name == "section.frequency_z") or (apart and name == "section.damping_ratio")
        value = values.get(name)
        if value is None or hidden or is_usual(value, usual):
            continue
        table, _, field = name.partition(".")
        key, kind = _key(table, field)
        if both and field == "frequency_y":
            key = "frequency"
        quoted, suffix = _quoted(key, value, kind, given.get((table, key)))
        yield usual_sentence(f"[{table}] {quoted}", usual, kind, suffix)
    density = section.mass / (pi / 4 * section.diameter**2)
    if not is_usual(density, SOLID):
        yield usual_sentence(
            f"[section] mass and diameter make a cable of {density:.3g} kg/m3",
            SOLID,
            KINDS["density"],
            "kg_m3",
        )
    if model.rivulet.mass >= 0.1 * section.mass:
        yield (
            f"[rivulet] mass is {model.rivulet.mass / section.mass:.2g} times the cable's, which is unusual: "
            "a rivulet weighs a few thousandths of it"
        )


def impossible(model: RivuletModel) -> str:
    """What no bridge can have, though the equations could be solved for it, and what is allowed; empty if nothing."""
    for name, what in (("speed", "a wind"), ("vertical_speed", "a vertical wind")):
        speed = getattr(model.wind, name, 0.0)
        if abs(speed) > FASTEST:
            return (
                f"{what} of {speed:g} m/s; allowed is up to {FASTEST:g} m/s; correct the number or its unit"
            )
    height, diameter = 1000 * model.rivulet.height, 1000 * model.section.diameter
    if height >= diameter:
        return (
            f"a rivulet of {height:.6g} mm on a cable of {diameter:.6g} mm; allowed is a rivulet less high than the "
            "cable is thick; correct either number or its unit"
        )
    return ""


def unusual_value(name: str, value: float) -> str:
    """What is usual for a parameter by its dotted name, where a value in SI is outside of that; else empty."""
    usual = USUAL.get(name)
    if usual is None or is_usual(value, usual):
        return ""
    kind = _key(*name.split(".", 1))[1]
    return usual_sentence("", usual, kind, kind.preferred)


def is_usual(value: float, usual: Range) -> bool:
    """Whether the size of a value in SI lies in the range."""
    slack = 1e-9
    size = abs(value)
    return (usual.zero and size == 0) or usual.low * (1 - slack) <= size <= usual.high * (1 + slack)


def _key(table: str, field: str) -> tuple[str, Kind]:
    return next((item.name, item.kind) for item in NUMBERS if (item.table, item.field) == (table, field))


def _quoted(key: str, value: float, kind: Kind, given: Given | None) -> tuple[str, str]:
    """A number as it stands in the file, or as it could stand there; and the suffix of its unit."""
    if given is None:
        suffix, shown = written(value, kind)
        return f"{key}_{suffix} = {shown:.6g}", suffix
    if isinstance(given.raw, str):  # with a unit of its own
        return f'{given.key} = "{given.raw}"', kind.preferred
    return f"{given.key} = {given.raw!r}", given.key[len(key) + 1 :]


def usual_sentence(given: str, usual: Range, kind: Kind, suffix: str) -> str:
    """What was given, that it is unusual, and what is usual in the unit of `suffix`."""
    low, high = (_in_unit(bound, kind, suffix) for bound in (usual.low, usual.high))
    nothing = "0 or " if usual.zero else ""
    unit = unit_text(suffix) if suffix != "ratio" else ""
    span = f"{low:.4g} to {high:.4g} {unit}".strip()
    return f"{given}, which is unusual: usual is {nothing}{span}; {usual.why}"


def _in_unit(value: float, kind: Kind, suffix: str) -> float:
    factor, divisor = kind.suffixes[suffix]
    return value * divisor / factor
