"""Whether a curve stays finite on a whole range of angles, not only at the angles that one looks at."""

from typing import Any

import numpy as np

from rainwind.errors import InputError
from rainwind.physics.intervals import Box

_GRID = 721
_PIECES = 16
# below this width (rad) a box without bounds is a pole, not a wide enclosure
_SMALLEST = 1e-9
# more suspicious boxes than that are a curve that we cannot judge; each halving of a pole keeps a few only
_MOST = 100_000


def need_finite(what: str, curve: Any, low: float, high: float) -> None:
    """InputError if the curve is not finite somewhere on [low, high] (rad); None has nothing to check."""
    if curve is None:
        return
    alpha = np.linspace(low, high, _GRID)
    with np.errstate(all="ignore"):
        try:
            values = np.broadcast_to(curve(alpha), alpha.shape)
        except (ZeroDivisionError, OverflowError):
            raise InputError(f"{what} divides by zero or overflows") from None
    bad = ~np.isfinite(values)
    if bad.any():
        raise _not_finite(what, alpha[bad][0])
    pole = _pole(curve, alpha)
    if pole is not None:
        raise _not_finite(what, pole)


def _not_finite(what: str, alpha: float) -> InputError:
    return InputError(
        f"{what} is not finite, e.g. at alpha = {alpha:.4g} rad ({np.degrees(alpha):.4g} deg); change the "
        "formula or the range"
    )


def _pole(curve: Any, edges: np.ndarray) -> float | None:
    """An angle near which interval arithmetic finds no bound, however narrow the box; None if there is none."""
    low, high = edges[0], edges[-1]
    left, right = edges[:-1], edges[1:]
    while left.size:
        keep = _unbounded(curve, left, right)
        left, right = left[keep], right[keep]
        if not left.size:
            return None
        if right[0] - left[0] < _SMALLEST or left.size > _MOST:
            # at the ends the values themselves are known: the root of zero there is no pole
            inside = (left > low) & (right < high)
            return float(left[inside][0]) if inside.any() else None
        steps = np.linspace(0.0, 1.0, _PIECES + 1)
        cuts = left[:, None] + (right - left)[:, None] * steps
        left, right = cuts[:, :-1].ravel(), cuts[:, 1:].ravel()
    return None


def _unbounded(curve: Any, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        box = curve(Box.variable(left, right))
    if not isinstance(box, Box):
        return np.zeros(left.shape, dtype=bool)
    lo, hi = box.value
    return np.broadcast_to(~(np.isfinite(lo) & np.isfinite(hi)), left.shape)
