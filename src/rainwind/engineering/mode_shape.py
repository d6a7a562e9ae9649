"""How a stay moves along its length in one mode."""

from dataclasses import dataclass, field
from math import inf, sin, tanh
from typing import Any

import numpy as np

__all__ = ["ModeShape"]

_SCAN = 200  # points a wave, from which the largest value is found


@dataclass(frozen=True)
class ModeShape:
    """v(xi) of xi = x / L from the lower (0) to the upper end (1), of which the largest size is 1.

    It is constant + edge * (cosh(p s) / cosh(p / 2)) + cos(q s) with s = xi - 1/2 where it is symmetric, and
    edge * (sinh(p s) / sinh(p / 2)) - sin(q s) where it is not; q and p per length L. It begins positive at the
    lower end without sag; a symmetric one has a positive mean, with which a positive v is down.
    """

    symmetric: bool
    q: float
    p: float = inf
    edge: float = 0.0
    constant: float = 0.0
    scale: float = field(init=False, compare=False)

    def __post_init__(self) -> None:
        xi = np.linspace(0.0, 1.0, 2 * int(_SCAN * (1 + self.q)) + 1)
        v = self._bare(xi)
        i = int(np.argmax(np.abs(v)))
        largest = abs(v[i])
        if 0 < i < v.size - 1:
            # the parabola through the largest sample and its neighbours
            before, after = abs(v[i - 1]), abs(v[i + 1])
            curvature = before - 2 * largest + after
            largest -= (after - before) ** 2 / (8 * curvature) if curvature < 0 else 0.0
        sign = np.sign(self.bare_mean) if self.symmetric else np.sign(v[1])
        object.__setattr__(self, "scale", float(sign / largest))

    def __call__(self, xi: Any) -> Any:
        """v at xi, a number or an array; the result has its shape."""
        value = self.scale * self._bare(np.asarray(xi, dtype=float))
        return float(value) if np.ndim(xi) == 0 else value

    def at(self, xi: Any) -> Any:
        """The same as calling it."""
        return self(xi)

    @property
    def bare_mean(self) -> float:
        """The mean over the length before scaling."""
        if not self.symmetric:
            return 0.0
        bent = self.edge * 2 / self.p * tanh(self.p / 2)
        return self.constant + bent + 2 / self.q * sin(self.q / 2)

    @property
    def mean(self) -> float:
        """The mean over the length; 2 / (n pi) of sin(n pi xi) with odd n."""
        return self.scale * self.bare_mean

    def _bare(self, xi: np.ndarray) -> np.ndarray:
        s = xi - 0.5
        wave = np.cos(self.q * s) if self.symmetric else -np.sin(self.q * s)
        bent = self.constant + wave
        return bent if self.p == inf else bent + self.edge * self._edges(s)

    def _edges(self, s: np.ndarray) -> np.ndarray:
        """cosh(p s) / cosh(p / 2) or sinh(p s) / sinh(p / 2), which no p overflows."""
        size = np.abs(s)
        sign = 1.0 if self.symmetric else -1.0
        near = np.exp(-self.p * (0.5 - size)) * (1 + sign * np.exp(-2 * self.p * size))
        near = near / (1 + sign * np.exp(-self.p))
        return near if self.symmetric else np.sign(s) * near
