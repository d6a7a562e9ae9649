"""The complex roots of a characteristic function, followed while its dampers grow from nothing."""

from collections.abc import Callable

import numpy as np

from rainwind.errors import ComputationError

__all__ = ["follow_roots"]

LogDerivative = Callable[[np.ndarray, complex], np.ndarray]
STEP = np.log(4.0)
"""Of log t, at most."""
FARTHEST = 0.15
"""A root may lie this far from where the last two points lead (undamped roots are about pi apart), and farther the
more it is damped: such roots stand alone."""
CLOSE = 1e-4
"""Roots closer than this are told apart before they are followed."""
_TOLERANCE, _SHORTEST, _ITERATIONS = 1e-13, 1e-6, 12


def follow_roots(log_derivative: LogDerivative, roots: np.ndarray, start: complex, to: complex) -> np.ndarray:
    """The roots (n,) at t = to, from the roots (n,) at t = start, on the straight way of log t.

    log_derivative(s (n,), t) is f'/f. Steps by the secant, corrected by Newton's method with the other roots
    divided out (Aberth's, from memory), so that two roots never become one. Raises ComputationError where a step
    cannot be made short enough.
    """
    way = np.log(complex(to) / complex(start))
    if way == 0:
        return roots
    now, done, step = _told_apart(roots), 0.0, min(1.0, STEP / abs(way))
    slope = np.zeros_like(now)
    while done < 1.0:
        goal = 1.0 if done + 1.01 * step > 1.0 else done + step
        guess = now + slope * (goal - done)
        new = _corrected(log_derivative, guess, start * np.exp(way * goal))
        if new is not None and (np.abs(new - guess) <= FARTHEST * (1 + np.abs(new.real) / 2)).all():
            slope = (new - now) / (goal - done)
            now, done, step = new, goal, min(1.5 * step, STEP / abs(way))
        elif step * abs(way) > _SHORTEST:
            step /= 2
        else:
            raise ComputationError(
                f"the damped frequencies could not be followed beyond {abs(start * np.exp(way * done)):.3g} times "
                "the coefficients"
            )
    return now


def _corrected(log_derivative: LogDerivative, guess: np.ndarray, t: complex) -> np.ndarray | None:
    """The roots (n,) near the guess (n,), None where they are not found."""
    s, last = guess, np.inf
    for _ in range(_ITERATIONS):
        apart = s[:, None] - s[None, :]
        np.fill_diagonal(apart, np.inf)
        try:
            with np.errstate(all="ignore"):
                change = 1.0 / (log_derivative(s, t) - (1.0 / apart).sum(axis=1))
        except np.linalg.LinAlgError:  # far outside the range of numbers
            return None
        change = np.where(np.isnan(change), 0.0, change)  # exactly on the root: f = 0
        s, size = s - change, float(np.abs(change / s).max())
        if not np.isfinite(size):
            return None
        if size < _TOLERANCE or (size < 1e-9 and size > last / 4):  # as far as rounding lets it
            return s
        last = size
    return None


def _told_apart(roots: np.ndarray) -> np.ndarray:
    """The roots (n,), of which equal ones are moved a little: divided out, they would hold each other."""
    equal = np.abs(roots[:, None] - roots[None, :]) < CLOSE
    return roots + 1j * CLOSE * np.triu(equal, 1).sum(axis=0)
