"""Lift, drag and moment of the wetted cable as functions of the angle of attack."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import lru_cache
from math import degrees, pi, radians
from typing import Any, Literal

from rainwind.errors import InputError
from rainwind.physics.blend import Blend, default_blend
from rainwind.physics.checks import finite_number, not_negative, one_of
from rainwind.physics.curves import Curve, Table, as_curve
from rainwind.physics.finiteness import need_finite

Outside = Literal["blend", "extend", "refuse"]
OUTSIDE = ("blend", "extend", "refuse")
# how sure a set's numbers are; "artificial" and "test" are for sets that describe no cable
STATUSES = ("measured", "read off", "reconstructed", "unverified", "artificial", "test")
# a range below this (rad) that is meant in degrees was most likely given in radians: pi is 3.1
NARROWEST = radians(5.0)
_ANGLE_ROUNDING = 1e-9
_AND_MOMENT = "; moment: "


@dataclass(frozen=True)
class CoefficientSet:
    """C_L, C_D and C_M in alpha (rad), with their source and the range [low, high] (rad) in which they hold.

    lift, drag and moment: a list of numbers c0, c1, ... (polynomial), text in alpha, a `Table` or a number;
    moment may be None where the source has none. blend: None takes half points 12° outside the valid range.
    rivulet_height in m. reading_error: absolute, of each coefficient. notes: what the set's file says beside.
    status: one of STATUSES. A table must cover the valid range, and every curve must be finite in it.
    Raises InputError. Source of the definitions: Peil & Nahrath (2003), eqs. (2), (3).
    """

    name: str
    source: str
    status: str
    valid: tuple[float, float]
    lift: Curve
    drag: Curve
    moment: Curve | None = None
    blend: Blend | None = None
    rivulet_height: float | None = None
    reading_error: float | None = None
    notes: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        for key in ("name", "source", "status"):
            if not isinstance(getattr(self, key), str) or not getattr(self, key).strip():
                raise InputError(
                    f"{key} = {getattr(self, key)!r} must be text that says where the numbers are from"
                )
        _status(self.status)
        set_(self, "valid", _valid_range(self.valid))
        set_(self, "lift", as_curve("lift", self.lift))
        set_(self, "drag", as_curve("drag", self.drag))
        if self.moment is not None:
            set_(self, "moment", as_curve("moment", self.moment))
        for key in ("rivulet_height", "reading_error"):
            if getattr(self, key) is not None:
                set_(self, key, not_negative(key, getattr(self, key)))
        if self.blend is not None and not isinstance(self.blend, Blend):
            raise InputError(f"blend = {self.blend!r} must be a Blend or None")
        for key in ("lift", "drag", "moment"):
            what = f"{key} of '{self.name}'"
            _need_covered(what, getattr(self, key), *self.valid)
            need_finite(what, getattr(self, key), *self.valid)

    def covers(self, alpha: float) -> bool:
        """Whether alpha (rad, not wrapped) lies in the valid range."""
        return bool(self.valid[0] <= alpha <= self.valid[1])

    def at(self, alpha: Any, outside: Outside = "blend") -> tuple[Any, Any, Any]:
        """C_L, C_D, C_M at alpha (rad): numbers, arrays, tape symbols or intervals, of alpha's shape.

        outside: "blend" passes into the bare cylinder, 2-pi-periodic; "extend" and "refuse" are the curves as
        they are (with "refuse" the model says where its states leave the valid range).
        Raises InputError if the set has no moment.
        """
        curves = (self.lift, self.drag, self.need_moment())
        if outside != "blend":
            return tuple(curve(alpha) for curve in curves)
        blend = self.usable_blend
        w, angle = blend.weight_and_angle(alpha)
        bares = (blend.bare_lift(alpha), blend.bare_drag(alpha), blend.bare_moment(alpha))
        return tuple(bare + w * (curve(angle) - bare) for curve, bare in zip(curves, bares, strict=True))

    def moment_at(self, alpha: Any, outside: Outside = "blend") -> Any:
        """C_M alone, as `at` gives it."""
        moment = self.need_moment()
        if outside != "blend":
            return moment(alpha)
        w, angle = self.usable_blend.weight_and_angle(alpha)
        bare = self.usable_blend.bare_moment(alpha)
        return bare + w * (moment(angle) - bare)

    @property
    def usable_blend(self) -> Blend:
        """The set's own blend, or the one by default for its valid range."""
        return self.blend if self.blend is not None else _default_blend(*self.valid)

    def need_moment(self) -> Curve:
        """The moment curve; InputError if the set has none."""
        if self.moment is None:
            raise InputError(
                f"the set '{self.name}' has no moment curve, and the rivulet needs one; take another "
                "set's with .with_moment_of(other)"
            )
        return self.moment

    def with_moment_of(self, other: "CoefficientSet") -> "CoefficientSet":
        """This set's lift and drag with the moment of `other`, valid where both are; its name says so."""
        low, high = max(self.valid[0], other.valid[0]), min(self.valid[1], other.valid[1])
        if low >= high:
            raise InputError(f"'{self.name}' and '{other.name}' are valid on ranges that do not overlap")
        blend = self.usable_blend if self.valid == (low, high) else None
        if blend is None:
            own = self.usable_blend
            blend = replace(_default_blend(low, high), bare_lift=own.bare_lift, bare_drag=own.bare_drag)
        return CoefficientSet(
            name=f"{self.name} + moment of {other.name}",
            source=f"lift and drag: {self.source}; moment: {other.source}",
            status=self.status
            if self.status == other.status
            else f"{self.status}{_AND_MOMENT}{other.status}",
            valid=(low, high),
            lift=self.lift,
            drag=self.drag,
            moment=other.need_moment(),
            blend=replace(blend, bare_moment=other.usable_blend.bare_moment),
            rivulet_height=self.rivulet_height,
            reading_error=self.reading_error,
            notes={"lift_and_drag": dict(self.notes), "moment": dict(other.notes)},
        )


@lru_cache(maxsize=256)
def check_usable(coefficients: CoefficientSet, outside: Outside) -> None:
    """InputError if a model cannot use the set this way: no moment, no blend, values that are not finite."""
    one_of("outside", outside, OUTSIDE)
    coefficients.need_moment()
    if outside == "refuse":
        return
    low, high = -pi, pi
    if outside == "blend":
        centre = coefficients.usable_blend.centre
        low, high = centre - pi, centre + pi
    for index, key in enumerate(("lift", "drag", "moment")):
        need_finite(
            f"{key} of '{coefficients.name}' with outside='{outside}'",
            lambda alpha, i=index: coefficients.at(alpha, outside)[i],
            low,
            high,
        )


_default_blend = lru_cache(maxsize=256)(default_blend)


def _valid_range(valid: Any) -> tuple[float, float]:
    if isinstance(valid, str) or not hasattr(valid, "__len__") or len(valid) != 2:
        raise InputError(f"the valid range {valid!r} must be two angles, low and high")
    low, high = (finite_number("valid range", v) for v in valid)
    if low >= high:
        raise InputError(
            f"the valid range {low:.6g} to {high:.6g} is reversed or empty; give the lower angle first"
        )
    if high - low > 2 * pi + 1e-9 or max(abs(low), abs(high)) > 2 * pi + 1e-9:
        raise InputError(f"the valid range {low:.6g} to {high:.6g} does not look like radians on one circle")
    return low, high


def _status(given: str) -> None:
    """A set joined by `with_moment_of` has two, one after the other."""
    for one in given.split(_AND_MOMENT):
        if one not in STATUSES:
            near = get_close_matches(one, STATUSES, n=1)
            hint = f"did you mean '{near[0]}'? " if near else ""
            raise InputError(f"status = {one!r} is not known; {hint}choose one of {', '.join(STATUSES)}")


def _need_covered(what: str, curve: Curve | None, low: float, high: float) -> None:
    if not isinstance(curve, Table):
        return
    first, last = curve.alpha[0], curve.alpha[-1]
    if first <= low + _ANGLE_ROUNDING and last >= high - _ANGLE_ROUNDING:
        return
    narrow = last - first < NARROWEST
    raise InputError(
        f"{what} is a table from {degrees(first):.4g} to {degrees(last):.4g} deg, but the valid range is "
        f"{degrees(low):.4g} to {degrees(high):.4g} deg; "
        + (
            "its angles look like radians, a file takes degrees"
            if narrow
            else "narrow the valid range or add rows: a fit says nothing beyond its table"
        )
    )
