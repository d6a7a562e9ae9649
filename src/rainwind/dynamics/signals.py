"""Parameters as functions of time: piecewise polynomials whose knots an integrator stops its steps on."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.errors import InputError

__all__ = ["Signal", "ramp"]

_MOST_COEFFICIENTS = 4
_ROUNDING = 1e-14


@dataclass(frozen=True, eq=False)
class Signal:
    """A number as a function of time: sum_j c_kj (t - t_k)^j for t_k <= t < t_(k+1), of degree 3 at most.

    knots: (k + 1,), increasing, in seconds; the last may be infinite after a constant piece. coefficients:
    (k, degree + 1), lowest power first, in the unit of what varies. A jump at a knot is allowed; there the later
    piece holds. Both arrays are read-only. Signals of equal span add and subtract; numbers add and multiply.
    Raises InputError.
    """

    knots: np.ndarray
    coefficients: np.ndarray
    __array_ufunc__ = None  # NumPy's numbers leave sums and products to the signal

    def __post_init__(self) -> None:
        knots, c = _numbers("knots", self.knots, 1), _numbers("coefficients", self.coefficients, 2)
        k, width = c.shape
        if knots.size != k + 1 or k < 1 or not 1 <= width <= _MOST_COEFFICIENTS:
            raise InputError(
                "a signal of k pieces has k + 1 knots and coefficients of shape (k, 1 to 4); got "
                f"{knots.size} knots and coefficients of shape {c.shape}"
            )
        if not np.all(np.isfinite(knots[:-1])) or not (np.isfinite(knots[-1]) or knots[-1] == np.inf):
            raise InputError("the knots of a signal must be finite, but for the last, which may be infinite")
        if not np.all(np.diff(knots) > 0):
            worst = int(np.argmin(np.diff(knots) > 0))
            raise InputError(
                f"the knots of a signal must increase; got {knots[worst]:g} s, then {knots[worst + 1]:g} s"
            )
        if not np.all(np.isfinite(c)):
            raise InputError("the coefficients of a signal must be finite numbers")
        if knots[-1] == np.inf and np.any(c[-1, 1:] != 0):
            raise InputError("a signal without end must end in a constant piece")
        for name, array in (("knots", knots), ("coefficients", c)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def since(self) -> float:
        """The time of the first knot."""
        return float(self.knots[0])

    @property
    def until(self) -> float:
        """The time of the last knot, beyond which the signal has no value; infinity if it holds for ever."""
        return float(self.knots[-1])

    @property
    def degree(self) -> int:
        """The degree of the pieces as stored, 0 to 3."""
        return self.coefficients.shape[1] - 1

    def __len__(self) -> int:
        return len(self.coefficients)

    def __repr__(self) -> str:
        low, high = self.extremes()
        return (
            f"Signal({self.since:g} to {self.until:g} s, {len(self)} pieces of degree {self.degree}, "
            f"values {low:.6g} to {high:.6g})"
        )

    def at(self, t: Any, derivative: int = 0) -> Any:
        """Value, or derivative of this order, at the time t: a number or an array (...,) of seconds.

        Raises InputError for times before `since`, after `until`, or not finite.
        """
        times = np.asarray(t, dtype=float)
        outside = ~((times >= self.since) & (times <= self.until) & (times < np.inf))
        if np.any(outside):
            raise InputError(
                f"the signal is given from {self.since:g} to {self.until:g} s; it has no value at t = "
                f"{np.atleast_1d(times)[np.atleast_1d(outside)][0]:g}"
            )
        if isinstance(derivative, bool) or not isinstance(derivative, int) or derivative < 0:
            raise InputError(f"derivative = {derivative!r}: give 0, 1, 2, ...")
        c = self.coefficients
        for _ in range(min(derivative, self.degree + 1)):
            c = _derivatives(c)
        piece = np.searchsorted(self.knots[1:-1], times, side="right")
        s = times - self.knots[piece]
        found = np.zeros_like(s)
        for column in reversed(range(c.shape[1])):
            found = found * s + c[piece, column]
        return float(found) if found.ndim == 0 else found

    def extremes(self) -> tuple[float, float]:
        """The smallest and the largest value that any time has, from the polynomials themselves."""
        width = np.where(np.isfinite(self.knots[1:]), np.diff(self.knots), 0.0)
        c = np.zeros((len(self), _MOST_COEFFICIENTS))
        c[:, : self.coefficients.shape[1]] = self.coefficients
        inside = np.clip(_stationary(c), 0.0, width[:, None])
        s = np.concatenate([np.zeros((len(self), 1)), width[:, None], inside], axis=1)
        values = c[:, :1] + s * (c[:, 1:2] + s * (c[:, 2:3] + s * c[:, 3:4]))
        return float(values.min()), float(values.max())

    def shifted(self, by: float) -> "Signal":
        """The same course, `by` seconds later."""
        return Signal(self.knots + _number("by", by), self.coefficients)

    def part(self, since: float, until: float) -> "Signal":
        """The signal between two times of its span."""
        since, until = _number("since", since), _number("until", until, may_be_infinite=True)
        if not self.since <= since < until <= self.until:
            raise InputError(
                f"a part from {since:g} to {until:g} s is not inside the signal, {self.since:g} to {self.until:g} s"
            )
        between = self.knots[(self.knots > since) & (self.knots < until)]
        knots = np.concatenate([[since], between, [until]])
        return Signal(knots, _from(self, knots))

    def then(self, other: "Signal") -> "Signal":
        """This signal, and from its end on the other one, moved there. Raises InputError if this has no end."""
        if not isinstance(other, Signal):
            raise InputError(f"a signal is followed by a signal; got {other!r}")
        if self.until == np.inf:
            raise InputError(
                "a signal that holds for ever has no end to go on from; give it one, as ramp(..., hold=0)"
            )
        later = other.knots[1:] - other.since + self.until
        c = np.zeros((len(self) + len(other), max(self.degree, other.degree) + 1))
        c[: len(self), : self.degree + 1] = self.coefficients
        c[len(self) :, : other.degree + 1] = other.coefficients
        return Signal(np.concatenate([self.knots, later]), c)

    def repeated(self, times: int) -> "Signal":
        """The signal, `times` times one after the other: a period of a wind becomes a long one."""
        if isinstance(times, bool) or not isinstance(times, int | np.integer) or times < 1:
            raise InputError(f"times = {times!r} must be a whole number of 1 or more")
        if self.until == np.inf:
            raise InputError(
                "a signal that holds for ever cannot be repeated; give it an end, as ramp(..., hold=0)"
            )
        starts = self.since + (self.until - self.since) * np.arange(times)
        knots = (starts[:, None] + (self.knots[:-1] - self.since)).ravel()
        end = self.since + (self.until - self.since) * times
        return Signal(np.append(knots, end), np.tile(self.coefficients, (times, 1)))

    def __add__(self, other: Any) -> "Signal":
        if isinstance(other, Signal):
            return _sum(self, other)
        c = self.coefficients.copy()
        c[:, 0] += _number("a number added to a signal", other)
        return Signal(self.knots, c)

    def __mul__(self, factor: Any) -> "Signal":
        if isinstance(factor, Signal):
            raise InputError(
                "signals cannot be multiplied with each other: the product's degree would be above 3"
            )
        return Signal(self.knots, self.coefficients * _number("a signal's factor", factor))

    __radd__ = __add__
    __rmul__ = __mul__

    def __neg__(self) -> "Signal":
        return self * -1.0

    def __sub__(self, other: Any) -> "Signal":
        return self + (-other)

    def __rsub__(self, other: Any) -> "Signal":
        return -self + other

    def __truediv__(self, divisor: Any) -> "Signal":
        if _number("a signal's divisor", divisor) == 0:
            raise InputError("a signal cannot be divided by zero")
        return Signal(self.knots, self.coefficients / float(divisor))


def ramp(
    start: float, end: float, duration: float, *, after: float = 0.0, hold: float = float("inf")
) -> Signal:
    """From `start` to `end` at a constant rate in `duration` seconds.

    Before it the value `start` holds for `after` seconds (from t = 0), behind it `end` for `hold` seconds. A
    duration of 0 is a jump. Up and down again: `ramp(5, 15, 600, hold=60).then(ramp(15, 5, 600))`.
    Raises InputError.
    """
    start, end = _number("start", start), _number("end", end)
    lengths = []
    for name, length in (("after", after), ("duration", duration), ("hold", hold)):
        length = _number(name, length, may_be_infinite=name == "hold")
        if length < 0:
            raise InputError(f"{name} = {length:g} s must be 0 or more")
        lengths.append(length)
    rate = (end - start) / lengths[1] if lengths[1] else 0.0
    pieces = [(start, 0.0), (start, rate), (end, 0.0)]
    kept = [i for i in range(3) if lengths[i] > 0]
    if not kept:
        raise InputError("a ramp needs a duration, or a time before or behind its jump; all three are 0")
    knots = np.concatenate([[0.0], np.cumsum([lengths[i] for i in kept])])
    return Signal(knots, np.array([pieces[i] for i in kept]))


def _sum(a: Signal, b: Signal) -> Signal:
    if (a.since, a.until) != (b.since, b.until):
        raise InputError(
            f"signals add over the same times: one is from {a.since:g} to {a.until:g} s, the other from {b.since:g} "
            f"to {b.until:g} s; make them alike with shifted, then, repeated or part"
        )
    knots = np.union1d(a.knots, b.knots)
    # knots that differ by rounding are one, the first; the ends stay
    apart = np.diff(knots) > _ROUNDING * np.abs(knots[:-1])
    apart[-1] = True
    knots = knots[np.append(True, apart)]
    c = np.zeros((knots.size - 1, max(a.degree, b.degree) + 1))
    for one in (a, b):
        c[:, : one.degree + 1] += _from(one, knots)
    return Signal(knots, c)


def _from(signal: Signal, knots: np.ndarray) -> np.ndarray:
    """The coefficients (k, degree + 1) of the signal's pieces between other knots (k + 1,), in powers from these."""
    inside = knots[:-1] + np.minimum(np.diff(knots), 1.0) / 2
    piece = np.searchsorted(signal.knots[1:-1], inside, side="right")
    s = knots[:-1] - signal.knots[piece]
    c = signal.coefficients[piece].copy()
    # Horner's scheme again and again is the shift of a polynomial
    for first in range(signal.degree):
        for column in reversed(range(first, signal.degree)):
            c[:, column] += s * c[:, column + 1]
    return c


def _derivatives(c: np.ndarray) -> np.ndarray:
    if c.shape[1] == 1:
        return np.zeros_like(c)
    return c[:, 1:] * np.arange(1, c.shape[1])


def _stationary(c: np.ndarray) -> np.ndarray:
    """Where c1 + 2 c2 s + 3 c3 s² = 0, both roots (k, 2); 0 in place of those that do not exist."""
    slope, half, cube = c[:, 1], c[:, 2], 3.0 * c[:, 3]
    root = half * half - cube * slope
    q = -(half + np.copysign(np.sqrt(np.maximum(root, 0.0)), half))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        roots = np.stack([q / cube, slope / q], axis=1)
    return np.where(np.isfinite(roots) & (root >= 0)[:, None], roots, 0.0)


def _number(name: str, value: Any, *, may_be_infinite: bool = False) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise InputError(f"{name} = {value!r} must be a number")
    if not np.isfinite(value) and not (may_be_infinite and value > 0):
        raise InputError(f"{name} = {value!r} must be a finite number")
    return float(value)


def _numbers(name: str, given: Any, dimensions: int) -> np.ndarray:
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"the {name} of a signal must be numbers; got {given!r}") from error
    if array.ndim != dimensions:
        raise InputError(f"the {name} of a signal must have {dimensions} axes; got shape {array.shape}")
    return array
