"""Samples in time become a signal: straight lines or cubics between them, faults of the samples refused."""

from typing import Any, Literal

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from rainwind.dynamics.signals import Signal
from rainwind.errors import InputError

__all__ = ["GAP", "gaps_in", "record"]

GAP = 1.5
"""A step between samples longer than this many usual ones (the median) is a gap: samples are missing."""
_KINDS = ("linear", "cubic", "spline")
_SAME = 1e-13


def record(
    times: Any,
    values: Any,
    kind: Literal["linear", "cubic", "spline"] = "linear",
    *,
    gaps: Literal["refuse", "interpolate"] = "refuse",
    periodic: bool = False,
) -> Signal:
    """A signal through samples: times (n,) in seconds, increasing, values (n,) in the unit of what varies.

    kind: "linear"; "cubic", with one continuous derivative, nowhere beyond its neighbouring samples (PCHIP: Fritsch
    & Butland 1984); "spline", with two continuous derivatives, which may overshoot (de Boor, "not-a-knot"). A step
    longer than 1.5 times the usual one (their median) is a gap and refused; gaps="interpolate" bridges it, which is
    also the word for points placed at uneven times on purpose. periodic: the last value must equal the first, and
    the derivatives are continuous there; `repeated` then makes it as long as needed. Samples on one straight line
    become one piece. Raises InputError for fewer than two samples, NaN, times unsorted or given twice, and gaps.
    """
    for name, value, allowed in (("kind", kind, _KINDS), ("gaps", gaps, ("refuse", "interpolate"))):
        if value not in allowed:
            raise InputError(
                f"{name} = {value!r} is not known; choose one of {', '.join(map(repr, allowed))}"
            )
    t, v = _samples(times, values)
    if gaps == "refuse":
        _refuse_gaps(t)
    if periodic and v[0] != v[-1]:
        raise InputError(
            f"a periodic record ends with the value it begins with; got {v[0]:g} and {v[-1]:g}: repeat the first "
            "sample at the end of the period"
        )
    if kind == "linear" or t.size == 2:
        return _merged(t, np.column_stack([v[:-1], np.diff(v) / np.diff(t)]))
    return _merged(t, _cubic(t, v, kind, periodic))


def gaps_in(times: np.ndarray) -> list[int]:
    """Numbers i of the samples behind which some are missing: times[i + 1] is too far off. Sorted times (n,)."""
    steps = np.diff(times)
    return np.flatnonzero(steps > GAP * np.median(steps)).tolist() if steps.size else []


def _samples(times: Any, values: Any) -> tuple[np.ndarray, np.ndarray]:
    t, v = _column("times", times), _column("values", values)
    if t.size != v.size:
        raise InputError(f"a record needs a value for each time; got {t.size} times and {v.size} values")
    if t.size < 2:
        raise InputError(f"a record needs two samples or more; got {t.size}")
    for name, column in (("time", t), ("value", v)):
        bad = np.flatnonzero(~np.isfinite(column))
        if bad.size:
            raise InputError(
                f"{bad.size} {name}{'s' * (bad.size > 1)} of the record {'are' if bad.size > 1 else 'is'} not finite, "
                f"the first is sample {bad[0]} ({column[bad[0]]}); remove these samples, and bridge what is then "
                "missing with gaps='interpolate'"
            )
    wrong = np.flatnonzero(np.diff(t) <= 0)
    if wrong.size:
        i = int(wrong[0])
        what = "comes twice" if t[i + 1] == t[i] else f"comes after {t[i]:.9g} s"
        raise InputError(
            f"the times of a record must increase; {t[i + 1]:.9g} s {what} (samples {i} and {i + 1}, "
            f"{wrong.size} such place{'s' * (wrong.size > 1)}); sort the samples and keep one of each time"
        )
    return t, v


def _column(name: str, given: Any) -> np.ndarray:
    array = np.ma.filled(given, np.nan) if np.ma.isMaskedArray(given) else np.asarray(given)
    if array.dtype.kind in "mM":
        raise InputError(f"the {name} of a record are seconds as numbers; got dates: subtract the first one")
    if array.dtype.kind not in "iufO":
        raise InputError(f"the {name} of a record must be real numbers; got {array.dtype}")
    try:
        column = np.array(array, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"the {name} of a record must be real numbers: {error}") from error
    if column.ndim != 1:
        raise InputError(f"the {name} of a record must be one column; got shape {column.shape}")
    return column


def _refuse_gaps(t: np.ndarray) -> None:
    found = gaps_in(t)
    if not found:
        return
    listed = ", ".join(f"{t[i]:.9g} to {t[i + 1]:.9g} s" for i in found[:3]) + ", ..." * (len(found) > 3)
    raise InputError(
        f"the record has {len(found)} gap{'s' * (len(found) > 1)} ({listed}): there the step is more than {GAP:g} "
        f"times the usual one, {np.median(np.diff(t)):.6g} s; fill in what is missing, or accept it with "
        "gaps='interpolate'"
    )


def _cubic(t: np.ndarray, v: np.ndarray, kind: str, periodic: bool) -> np.ndarray:
    """Coefficients (n - 1, 4), lowest power first."""
    if kind == "spline":
        return CubicSpline(t, v, bc_type="periodic" if periodic else "not-a-knot").c[::-1].T
    # the harmonic mean of two slopes, one of them next to nothing, is next to nothing: overflow on its way there
    with np.errstate(over="ignore"):
        if not periodic:
            return PchipInterpolator(t, v).c[::-1].T
        # a derivative depends on the two neighbours only
        before, behind = t[0] - (t[-1] - t[-2]), t[-1] + (t[1] - t[0])
        around = PchipInterpolator(np.r_[before, t, behind], np.r_[v[-2], v, v[1]])
        return around.c[::-1].T[1:-1]


def _merged(knots: np.ndarray, c: np.ndarray) -> Signal:
    """Neighbouring pieces of one and the same polynomial, to rounding, become one: fewer stops in time."""
    size = float(np.max(np.abs(c[:, 0]))) or 1.0
    alike = _continues(knots, c, np.arange(len(c) - 1), np.arange(1, len(c)), size)
    starts = np.ones(len(c), bool)
    candidates = np.flatnonzero(alike) + 1
    first = last = 0
    block = 1
    while last < len(candidates):
        # runs of candidates are compared with the first piece of the run, so that small differences do not add up
        if starts[candidates[last] - 1]:
            first = candidates[last] - 1
        others = candidates[last : last + block]
        others = others[others - candidates[last] == np.arange(others.size)]
        same = _continues(knots, c, np.full(others.size, first), others, size)
        good = others.size if np.all(same) else int(np.argmin(same))
        starts[others[:good]] = False
        last += max(good, 1)
        block = 2 * block if good == others.size else 1
    return Signal(np.append(knots[:-1][starts], knots[-1]), c[starts])


def _continues(
    knots: np.ndarray, c: np.ndarray, first: np.ndarray, other: np.ndarray, size: float
) -> np.ndarray:
    """Whether the polynomials of the pieces `first` go through those of `other`, at as many places as needed."""
    width = knots[other + 1] - knots[other]
    same = np.ones(len(first), bool)
    for part in np.linspace(0.0, 1.0, c.shape[1]):
        s = part * width
        a, b = _horner(c[first], knots[other] - knots[first] + s), _horner(c[other], s)
        same &= np.abs(a - b) <= _SAME * size
    return same


def _horner(c: np.ndarray, s: np.ndarray) -> np.ndarray:
    found = np.zeros_like(s)
    for column in reversed(range(c.shape[1])):
        found = found * s + c[:, column]
    return found
