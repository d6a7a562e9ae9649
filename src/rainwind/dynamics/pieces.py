"""Polynomials one after the other in time: what every integrator leaves behind, and all that is read afterwards."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.errors import InputError


@dataclass(frozen=True, eq=False)
class Pieces:
    """sum_j c[k, i, j] (t - times[k])^j for times[k] <= t < times[k + 1]; at a joint the later piece holds.

    times (k + 1,), increasing; coefficients (k, n, D + 1), lowest power first. No piece at all: times (1,).
    """

    times: np.ndarray
    coefficients: np.ndarray

    def __len__(self) -> int:
        return len(self.coefficients)

    @property
    def degree(self) -> int:
        """The degree of all polynomials as stored."""
        return self.coefficients.shape[2] - 1

    def number(self, t: np.ndarray) -> np.ndarray:
        """The number of the piece that holds at times t (...). Raises InputError for times outside."""
        first, last = self.times[0], self.times[-1]
        outside = ~((t >= first) & (t <= last))
        if np.any(outside):
            wrong = np.atleast_1d(t)[np.atleast_1d(outside)][0]
            raise InputError(
                f"the trajectory runs from t = {first:.9g} to {last:.9g}; it has no state at t = {wrong:.9g}"
            )
        return np.searchsorted(self.times[1:-1], t, side="right")

    def at(self, t: Any, derivative: int = 0) -> np.ndarray:
        """Values, or derivatives of this order, at times t (...): (..., n). Raises InputError for times outside."""
        t = np.asarray(t, dtype=float)
        piece = self.number(t)
        one = self
        for _ in range(derivative):
            one = one.derivative()
        c = one.coefficients
        s = (t - self.times[piece])[..., None]
        found = c[piece, :, -1]
        for j in reversed(range(c.shape[2] - 1)):
            found = found * s + c[piece, :, j]
        return found

    def joints(self) -> np.ndarray:
        """The values at all times (k + 1, n)."""
        c = self.coefficients
        h = self.times[-1] - self.times[-2]
        last = c[-1] @ h ** np.arange(c.shape[2])
        return np.concatenate([c[:, :, 0], last[None]])

    def starting(self, times: np.ndarray) -> np.ndarray:
        """The polynomials that hold from some times (m,) on, in powers of t - times: (m, n, D + 1)."""
        piece = np.searchsorted(self.times[1:-1], times, side="right")
        s = (times - self.times[piece])[:, None]
        c = self.coefficients[piece]  # a copy
        # Horner's scheme again and again is the shift of a polynomial
        for first in range(self.degree):
            for j in reversed(range(first, self.degree)):
                c[:, :, j] += s * c[:, :, j + 1]
        return c

    def part(self, since: float, until: float) -> "Pieces":
        """What lies between two times within them."""
        inside = self.times[(self.times > since) & (self.times < until)]
        times = np.concatenate([[since], inside, [until]])
        first = int(np.searchsorted(self.times[1:-1], since, side="right"))
        whole = self.coefficients[first + 1 : first + times.size - 1]  # those that begin within
        return Pieces(times, np.concatenate([self.starting(times[:1]), whole]))

    def derivative(self) -> "Pieces":
        """The pieces of the derivative."""
        c = self.coefficients
        return Pieces(self.times, c[:, :, 1:] * np.arange(1, c.shape[2]) if self.degree else np.zeros_like(c))

    def integral(self) -> np.ndarray:
        """The integral over all times (n,)."""
        powers = np.arange(1, self.degree + 2)
        h = np.diff(self.times)[:, None] ** powers / powers
        return np.einsum("kij,kj->i", self.coefficients, h)

    def until(self, t: float) -> "Pieces":
        """The pieces up to a time within them."""
        keep = int(np.searchsorted(self.times[:-1], t, side="left"))
        return Pieces(np.append(self.times[:keep], t), self.coefficients[:keep])

    def between(self, first: int, last: int) -> "Pieces":
        """The pieces number first, ..., last - 1."""
        return Pieces(self.times[first : last + 1], self.coefficients[first:last])


def joined(parts: Sequence[Pieces]) -> Pieces:
    """Pieces one after the other, each part beginning where the one before ends; lower degrees are filled up."""
    width = max(part.coefficients.shape[2] for part in parts)
    padded = [
        np.pad(part.coefficients, ((0, 0), (0, 0), (0, width - part.coefficients.shape[2]))) for part in parts
    ]
    times = np.concatenate([parts[0].times[:1], *(part.times[1:] for part in parts)])
    return Pieces(times, np.concatenate(padded))
