"""A plane w that goes round a cycle in a frame of half turns: w = R(k theta / 2) z with z' = G z.

G is a matrix of z1^2 and other even quantities. After one round z has become (-1)^k z: the multipliers of z = 0 are
(-1)^k exp(lambda T), lambda the eigenvalues of G, and for odd k any other equilibrium z is a cycle of period 2T. As a
function of theta, R G R^-1 has only cos k theta and sin k theta in it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from rainwind.dynamics.cycle_zoo.driven import circle
from rainwind.dynamics.cycle_zoo.known import Cycle, Parameters
from rainwind.elementary import sqrt


@dataclass(frozen=True)
class Twist:
    """The plane and its cycle.

    flat: w = (u, v), two states beside the unit circle (with a multiplier exp(-2 T) of its own): polynomials, four
    states. Else w = (r - 1, height), the plane across a circle in space: three states, smooth but on the axis.
    """

    half_turns: int = 1
    flat: bool = False

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return ("cosine", "sine", "u", "v") if self.flat else ("x", "y", "height")

    def _around(self, x: Any) -> tuple[Any, Any, Any, Any]:
        """cos theta, sin theta, w."""
        if self.flat:
            return x.cosine, x.sine, x.u, x.v
        radius = sqrt(x.x**2 + x.y**2)
        return x.x / radius, x.y / radius, radius - 1, x.height

    def _frame(self, c: Any, s: Any) -> tuple[Any, Any]:
        """cos k theta, sin k theta."""
        return ((1.0, 0.0), (c, s), (c**2 - s**2, 2 * c * s))[self.half_turns]

    def square(self, x: Any) -> Any:
        """z1^2 at the state x."""
        c, s, u, v = self._around(x)
        c, s = self._frame(c, s)
        return (u**2 * (1 + c) + v**2 * (1 - c)) / 2 + u * v * s

    def derivatives(self, x: Any, turn: Any, matrix: Any) -> tuple[Any, ...]:
        """Of the states, from theta' = turn and the matrix G at the state x.

        R G R^-1 has a part that commutes with rotations (mean, spin), and one that turns with k theta.
        """
        c, s, u, v = self._around(x)
        cos_k, sin_k = self._frame(c, s)
        (g11, g12), (g21, g22) = matrix
        mean, spin = (g11 + g22) / 2, (g21 - g12) / 2 + 0.5 * self.half_turns * turn
        stretch, slant = (g11 - g22) / 2, (g12 + g21) / 2
        first, second = stretch * cos_k - slant * sin_k, stretch * sin_k + slant * cos_k
        across = mean * u - spin * v + first * u + second * v
        along = spin * u + mean * v + second * u - first * v
        if self.flat:
            return *circle(c, s, turn), across, along
        return c * across - turn * x.y, s * across + turn * x.x, along

    def cycle(
        self,
        branch: str,
        parameters: Parameters,
        turn: float,
        first: float,
        rates: Any,
        *,
        rounds: int = 1,
        still: Sequence[float] = (),
    ) -> Cycle:
        """The cycle at the equilibrium z = (first, 0); rates: eigenvalues there, those of the plane before others.

        still: values of the other states.
        """
        period = rounds * 2 * pi / turn
        flips = [1j * pi * self.half_turns * rounds if k < 2 and first == 0 else 0 for k in range(len(rates))]
        exponents = [rate * period + flip for rate, flip in zip(rates, flips, strict=True)]

        def at(t: Any) -> np.ndarray:
            angle = turn * np.asarray(t)
            w: Any = first * np.exp(0.5j * self.half_turns * angle)
            radius = 1.0 if self.flat else 1 + w.real
            rest = [np.full(angle.shape, value) for value in still]
            plane = [w.real, w.imag] if self.flat else [w.imag]
            return np.stack([radius * np.cos(angle), radius * np.sin(angle), *plane, *rest], axis=-1)

        radial = [-2 * period] if self.flat else []
        return Cycle(branch, parameters, period, at, np.array([*exponents, 0, *radial], complex))
