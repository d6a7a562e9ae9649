"""Interval arithmetic with outward rounding, over many boxes at once, with the derivative along.

A `Box` stands for arrays of intervals: in each, the values that a function of one variable takes while the
variable runs through a box, and the values of its derivative there. It goes through plain formulas and
through `rainwind.elementary`. Enclosures are wider than needed, never narrower.
Source: Moore, Kearfott & Cloud (2009), Introduction to Interval Analysis, chs. 2 to 6.
"""

from collections.abc import Callable
from math import pi, sqrt
from typing import Any

import numpy as np
from scipy.special import erf

Interval = tuple[np.ndarray, np.ndarray]

# an elementary function of numpy is exact to about one unit in the last place; four are allowed for
_SLACK = 4 * np.finfo(float).eps
_TINY = 1e-300
_ONE = np.ones(1)


class Box:
    """Arrays of intervals [lo, hi] with the intervals [dlo, dhi] of the derivative; same shapes."""

    __array_ufunc__ = None  # numpy numbers must leave the operation to this class
    __slots__ = ("slope", "value")

    def __init__(self, value: Interval, slope: Interval) -> None:
        self.value = value
        self.slope = slope

    @classmethod
    def variable(cls, lo: np.ndarray, hi: np.ndarray) -> "Box":
        """The variable itself on the boxes [lo, hi]: slope 1."""
        return cls((lo, hi), (_ONE, _ONE))

    def __neg__(self) -> "Box":
        return Box(_negative(self.value), _negative(self.slope))

    def __pos__(self) -> "Box":
        return self

    def __add__(self, other: Any) -> "Box":
        if isinstance(other, Box):
            return Box(_sum(self.value, other.value), _sum(self.slope, other.slope))
        return Box(_sum(self.value, (other, other)), self.slope)

    __radd__ = __add__

    def __sub__(self, other: Any) -> "Box":
        return self + (-other)

    def __rsub__(self, other: Any) -> "Box":
        return -self + other

    def __mul__(self, other: Any) -> "Box":
        if not isinstance(other, Box):
            return Box(_scaled(self.value, other), _scaled(self.slope, other))
        if other is self:
            square = _square(self.value)
            return Box(square, _product(_scaled(self.value, 2.0), self.slope))
        slope = _sum(_product(self.slope, other.value), _product(self.value, other.slope))
        return Box(_product(self.value, other.value), slope)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Box":
        return self * (1.0 / other if isinstance(other, Box) else _reciprocal_of_number(other))

    def __rtruediv__(self, other: Any) -> "Box":
        one_over = _reciprocal(self.value)
        slope = _negative(_product(_square(one_over), self.slope))
        return Box(one_over, slope) * other

    def _elementary_(self, name: str, *others: Any) -> "Box":
        if name == "atan2":
            return _angle_of(*others)
        function, derivative = _FUNCTIONS[name]
        with np.errstate(all="ignore"):
            value = _whole_where_nan(function(self.value))
            return Box(value, _product(_whole_where_nan(derivative(self.value, value)), self.slope))

    def _wrap_angle_(self) -> "Box":
        """Boxes that reach across the cut at an odd multiple of pi have a slope without bounds."""
        lo, hi = self.value
        turns = np.round((lo + hi) / (4 * pi))
        # 2 pi as a float is not exact: widen by what that costs
        moved = _widened(_sum(self.value, (-turns * 2 * pi, -turns * 2 * pi)), np.abs(turns) * 1e-15)
        slack = pi + 1e-9
        cut = (moved[0] < -slack) | (moved[1] > slack)
        value = np.where(cut, -pi - _SLACK, moved[0]), np.where(cut, pi + _SLACK, moved[1])
        slope = np.where(cut, -np.inf, self.slope[0]), np.where(cut, np.inf, self.slope[1])
        return Box(value, slope)


def _down(x: Any) -> Any:
    return np.nextafter(x, -np.inf)


def _up(x: Any) -> Any:
    return np.nextafter(x, np.inf)


def _negative(a: Interval) -> Interval:
    return -a[1], -a[0]


def _sum(a: Interval, b: Any) -> Interval:
    with np.errstate(all="ignore"):
        return _whole_where_nan((_down(a[0] + b[0]), _up(a[1] + b[1])))


def _scaled(a: Interval, factor: Any) -> Interval:
    with np.errstate(all="ignore"):
        first, second = a[0] * factor, a[1] * factor
        return _whole_where_nan((_down(np.minimum(first, second)), _up(np.maximum(first, second))))


def _product(a: Interval, b: Interval) -> Interval:
    with np.errstate(all="ignore"):
        p, q, r, s = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
        lo = np.minimum(np.minimum(p, q), np.minimum(r, s))
        hi = np.maximum(np.maximum(p, q), np.maximum(r, s))
        return _whole_where_nan((_down(lo), _up(hi)))


def _square(a: Interval) -> Interval:
    with np.errstate(all="ignore"):
        first, second = a[0] * a[0], a[1] * a[1]
        lo = np.where((a[0] <= 0) & (a[1] >= 0), 0.0, _down(np.minimum(first, second)))
        return _whole_where_nan((lo, _up(np.maximum(first, second))))


def _reciprocal(a: Interval) -> Interval:
    with np.errstate(all="ignore"):
        through_zero = (a[0] <= 0) & (a[1] >= 0)
        lo, hi = _down(1.0 / a[1]), _up(1.0 / a[0])
        return np.where(through_zero, -np.inf, lo), np.where(through_zero, np.inf, hi)


def _reciprocal_of_number(x: float) -> "Box":
    whole = np.array([1.0 / x]) if x else np.array([np.nan])
    zero = np.zeros(1)
    return Box(_whole_where_nan((_down(whole), _up(whole))), (zero, zero))


def _widened(a: Interval, by: Any) -> Interval:
    return a[0] - by, a[1] + by


def _whole_where_nan(a: Interval) -> Interval:
    """An undefined bound (0 times infinity, the root of a negative number) says nothing: the whole line."""
    bad = np.isnan(a[0]) | np.isnan(a[1])
    if not bad.any():
        return a
    return np.where(bad, -np.inf, a[0]), np.where(bad, np.inf, a[1])


def _outward(lo: Any, hi: Any) -> Interval:
    return lo - (np.abs(lo) * _SLACK + _TINY), hi + (np.abs(hi) * _SLACK + _TINY)


def _rising(function: Callable[[Any], Any]) -> Callable[[Interval], Interval]:
    return lambda a: _outward(function(a[0]), function(a[1]))


def _falling(function: Callable[[Any], Any]) -> Callable[[Interval], Interval]:
    return lambda a: _outward(function(a[1]), function(a[0]))


def _meets(a: Interval, point: float, period: float) -> np.ndarray:
    """Whether the interval holds point + any multiple of the period, with slack for rounding."""
    slack = 1e-14 * (1.0 + np.abs(a[0]) + np.abs(a[1]))
    return np.floor((a[1] + slack - point) / period) >= np.ceil((a[0] - slack - point) / period)


def _cosine(a: Interval) -> Interval:
    first, second = np.cos(a[0]), np.cos(a[1])
    lo, hi = _outward(np.minimum(first, second), np.maximum(first, second))
    lo = np.where(_meets(a, pi, 2 * pi), -1.0, np.maximum(lo, -1.0))
    return lo, np.where(_meets(a, 0.0, 2 * pi), 1.0, np.minimum(hi, 1.0))


def _sine(a: Interval) -> Interval:
    first, second = np.sin(a[0]), np.sin(a[1])
    lo, hi = _outward(np.minimum(first, second), np.maximum(first, second))
    lo = np.where(_meets(a, -pi / 2, 2 * pi), -1.0, np.maximum(lo, -1.0))
    return lo, np.where(_meets(a, pi / 2, 2 * pi), 1.0, np.minimum(hi, 1.0))


def _tangent(a: Interval) -> Interval:
    lo, hi = _outward(np.tan(a[0]), np.tan(a[1]))
    pole = _meets(a, pi / 2, pi)
    return np.where(pole, -np.inf, lo), np.where(pole, np.inf, hi)


def _hyperbolic_cosine(a: Interval) -> Interval:
    first, second = np.cosh(a[0]), np.cosh(a[1])
    lo, hi = _outward(np.minimum(first, second), np.maximum(first, second))
    return np.where((a[0] <= 0) & (a[1] >= 0), 1.0, lo), hi


def _one_minus_square(a: Interval) -> Interval:
    lo, hi = _sum(_negative(_square(a)), (1.0, 1.0))
    return np.maximum(lo, 0.0), np.maximum(hi, 0.0)


def _one_plus_square(a: Interval) -> Interval:
    return _sum(_square(a), (1.0, 1.0))


def _bell(a: Interval) -> Interval:
    """2/sqrt(pi) exp(-x²), the derivative of erf."""
    lo, hi = _rising(np.exp)(_negative(_square(a)))
    factor = 2 / sqrt(pi)
    return _scaled((np.maximum(lo, 0.0), hi), factor)


_square_root = _rising(np.sqrt)

# name -> the function's enclosure, and its derivative's from the argument's and the value's
_FUNCTIONS: dict[str, tuple[Callable[[Interval], Interval], Callable[[Interval, Interval], Interval]]] = {
    "sin": (_sine, lambda a, v: _cosine(a)),
    "cos": (_cosine, lambda a, v: _negative(_sine(a))),
    "tan": (_tangent, lambda a, v: _one_plus_square(v)),
    "asin": (_rising(np.arcsin), lambda a, v: _reciprocal(_square_root(_one_minus_square(a)))),
    "acos": (_falling(np.arccos), lambda a, v: _negative(_reciprocal(_square_root(_one_minus_square(a))))),
    "atan": (_rising(np.arctan), lambda a, v: _reciprocal(_one_plus_square(a))),
    "sinh": (_rising(np.sinh), lambda a, v: _hyperbolic_cosine(a)),
    "cosh": (_hyperbolic_cosine, lambda a, v: _rising(np.sinh)(a)),
    "tanh": (_rising(np.tanh), lambda a, v: _one_minus_square(v)),
    "exp": (_rising(np.exp), lambda a, v: v),
    "log": (_rising(np.log), lambda a, v: _reciprocal(a)),
    "sqrt": (_square_root, lambda a, v: _reciprocal(_scaled(v, 2.0))),
    "erf": (_rising(erf), lambda a, v: _bell(a)),
}


def _angle_of(y: Any, x: Any) -> Box:
    """atan2 where x stays above zero; elsewhere only that it lies in [-pi, pi]."""
    zero = np.zeros(1)
    y, x = (v if isinstance(v, Box) else Box((zero + v, zero + v), (zero, zero)) for v in (y, x))
    right = (y / x)._elementary_("atan")
    good = np.broadcast_to(x.value[0] > 0, np.broadcast_shapes(right.value[0].shape, x.value[0].shape))
    value = (
        np.where(good, right.value[0], -pi - _SLACK),
        np.where(good, right.value[1], pi + _SLACK),
    )
    return Box(value, (np.where(good, right.slope[0], -np.inf), np.where(good, right.slope[1], np.inf)))
