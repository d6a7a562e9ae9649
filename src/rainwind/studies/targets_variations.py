"""T10 to T14: what the rivulet's friction and mass, the cable's frequency and the model's size change."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Any

from rainwind.physics.coefficient_files import load_coefficients
from rainwind.physics.curves import Polynomial
from rainwind.studies import paper
from rainwind.studies.figure_11_mass_coefficients_dof import gu_lu_with_our_moment
from rainwind.studies.targets_record import Outcome, Part, Rows, alike, falling, rising
from rainwind.studies.targets_upper_rivulet import damping_limits, upper_rivulet

_SAMPLE = paper.model().parameters
FRICTIONS = tuple(f * _SAMPLE["rivulet.friction"] for f in paper.FACTORS_OF_FRICTION)  # Nms per metre
# 3 Hz beside figure 10's, because "independent" is said of every frequency
FREQUENCIES = (*(f * _SAMPLE["section.frequency_y"] for f in paper.FACTORS_OF_FREQUENCY), 3.0)  # Hz
MASSES = tuple(f * _SAMPLE["rivulet.mass"] for f in paper.FACTORS_OF_MASS)  # kg/m
FAR_FRICTION = 0.2
OTHER_SETS = ("reconstructed", "reconstructed-cubic", "reconstructed-linear")
SAME = 0.05  # m/s, the tolerance of every "same onset"
_HEADER = (
    "fold [m/s]",
    "D unstable from [m/s]",
    "to [m/s]",
    "width [m/s]",
    "critical damping [%]",
    "Hopf curve leaves the fold at [%]",
)


@dataclass(frozen=True)
class Range:
    """The unstable range of D at the model's own damping (m/s), and the critical damping (%)."""

    fold: float | None
    onset: float | None
    end: float | None
    critical: float | None
    leaves: float | None

    @property
    def width(self) -> float | None:
        """How many m/s of wind speed are unstable; None where an end is missing."""
        return None if self.onset is None or self.end is None else self.end - self.onset

    @property
    def row(self) -> tuple[float | None, ...]:
        """In the order of the table's header."""
        return self.fold, self.onset, self.end, self.width, self.critical, self.leaves


def range_of(model: Any) -> Range:
    """Measure one model."""
    upper = upper_rivulet(model)
    if upper is None:
        return Range(None, None, None, None, None)
    limits = damping_limits(model)
    return Range(
        upper.fold.parameter,
        upper.onset,
        upper.end,
        None if limits.critical is None else 100 * limits.critical,
        None if limits.leaves is None else 100 * limits.leaves,
    )


def rivulet_friction(model: Any) -> Outcome:
    """T10: d_phi."""
    ranges = [range_of(model.with_parameters({"rivulet.friction": value})) for value in FRICTIONS]
    parts = (
        Part("wider range at 0.2 %", rising([r.width for r in ranges])),
        Part("lower critical damping", falling([r.critical for r in ranges])),
        Part("same fold", alike([r.fold for r in ranges], SAME)),
        Part("D unstable from the same speed on, at 0.2 %", alike([r.onset for r in ranges], SAME)),
    )
    far = range_of(model.with_parameters({"rivulet.friction": FAR_FRICTION}))
    note = "the paper's three values are lost; ours are half, one and two times the sample's"
    if far.onset is not None:
        note += f". At four times, {FAR_FRICTION:g} Nms, D is unstable from {far.onset:.2f} m/s on"
    quantity = f"critical damping at d_phi = {_list(FRICTIONS)} Nms"
    return Outcome(
        _numbers([r.critical for r in ranges]), quantity, parts, note, _rows("d_phi [Nms]", FRICTIONS, ranges)
    )


def cable_frequency(model: Any) -> Outcome:
    """T11: f, of both directions at once."""
    ranges = [
        range_of(model.with_parameters({"section.frequency_y": f, "section.frequency_z": f}))
        for f in FREQUENCIES
    ]
    parts = (
        Part("same fold", alike([r.fold for r in ranges], SAME)),
        Part("D unstable from the same speed on, at 0.2 %", alike([r.onset for r in ranges], SAME)),
    )
    note = (
        "the fold is a matter of the rivulet alone; at 0.2 % a stiffer cable's D is born stable there and "
        "turns unstable later. The paper's frequencies are lost"
    )
    quantity = f"D unstable from, at {_list(FREQUENCIES)} Hz"
    return Outcome(
        _numbers([r.onset for r in ranges]), quantity, parts, note, _rows("f [Hz]", FREQUENCIES, ranges)
    )


def rivulet_mass(model: Any) -> Outcome:
    """T12: m_R."""
    ranges = [range_of(model.with_parameters({"rivulet.mass": value})) for value in MASSES]
    parts = (
        Part("lighter: lower fold", rising([r.fold for r in ranges])),
        Part("lighter: D unstable from a lower speed on, at 0.2 %", rising([r.onset for r in ranges])),
        Part("lighter: lower critical damping", rising([r.critical for r in ranges])),
    )
    note = "the fold's speed goes with the square root of the mass; the paper's masses are lost"
    quantity = f"D unstable from, at m_R = {_list(MASSES)} kg/m"
    return Outcome(
        _numbers([r.onset for r in ranges]), quantity, parts, note, _rows("m_R [kg/m]", MASSES, ranges)
    )


def degrees_of_freedom(model: Any) -> Outcome:
    """T13: 3 and 2."""
    three, two = (range_of(replace(model, degrees_of_freedom=n)) for n in (3, 2))
    parts = (
        Part("same fold", alike([three.fold, two.fold], SAME)),
        Part("D unstable from the same speed on, at 0.2 %", alike([three.onset, two.onset], SAME)),
        Part("with 2 a narrower range at 0.2 %", falling([three.width, two.width])),
        Part("with 2 a lower critical damping", falling([three.critical, two.critical])),
    )
    return Outcome(
        _numbers([three.critical, two.critical]),
        "critical damping with 3 and with 2",
        parts,
        "",
        _rows("degrees of freedom", (3.0, 2.0), (three, two)),
    )


def other_coefficients(model: Any) -> Outcome:
    """T14 cannot be computed; in its place our other sets, and the default set with scattered slopes."""
    variants: dict[str, Any] = {
        name: replace(model, coefficients=load_coefficients(name)) for name in OTHER_SETS
    }
    variants |= {
        f"{curve} {100 * (factor - 1):+.0f} % about -45 deg": steeper(model, curve, factor)
        for curve in ("lift", "drag", "moment")
        for factor in (0.9, 1.1)
        if isinstance(getattr(model.coefficients, curve), Polynomial)
    }
    mixed = replace(gu_lu_with_our_moment(), outside=model.outside)
    variants["Gu & Lu's lift and drag, our moment; h 6 mm, m_R 0.08 kg/m, gamma 45 deg"] = mixed
    ranges = {name: range_of(one) for name, one in variants.items()}
    details = Rows(("coefficients", *_HEADER), tuple((name, *r.row) for name, r in ranges.items()))
    note = (
        "the moment curve of Gu & Lu (2001) is lost, so their case cannot be computed; in its place our "
        "other reconstructed sets, this one with each slope 10 % flatter and steeper, and Gu & Lu's lift and drag "
        "(from memory, unverified) with our moment, where D is stable at every speed at 0.2 %"
    )
    return Outcome(note=note, details=details, verdict="impossible")


def steeper(model: Any, curve: str, factor: float, about: float = -pi / 4) -> Any:
    """The model with one coefficient's polynomial stretched about its value at the angle `about` (rad)."""
    polynomial: Polynomial = getattr(model.coefficients, curve)
    numbers = [factor * c for c in polynomial.coefficients]
    numbers[0] += (1 - factor) * float(polynomial(about))
    name = f"{model.coefficients.name}, {curve} x {factor:g}"
    changed = replace(model.coefficients, name=name, **{curve: Polynomial(tuple(numbers))})
    return replace(model, coefficients=changed)


def _rows(first: str, values: Sequence[float], ranges: Sequence[Range]) -> Rows:
    rows: Mapping[float, Range] = dict(zip(values, ranges, strict=True))
    return Rows((first, *_HEADER), tuple((value, *r.row) for value, r in rows.items()))


def _numbers(values: Sequence[float | None]) -> list[float] | None:
    """JSON has no list with holes here: all numbers, or none."""
    found = [v for v in values if v is not None]
    return found if len(found) == len(values) else None


def _list(values: Sequence[float]) -> str:
    return ", ".join(f"{v:g}" for v in values)
