"""A cable with bending stiffness, sag or both, with dampers: its characteristic function, exact."""

from collections.abc import Callable
from math import cos, pi, sin, sqrt, tanh
from typing import Literal, get_args

import numpy as np
from scipy.optimize import brentq

from rainwind.engineering.cable import Cable
from rainwind.engineering.damper_places import DamperPlaces
from rainwind.errors import ComputationError
from rainwind.physics.checks import one_of

__all__ = ["DampedBeam", "Ends", "irvine_parameter"]

Ends = Literal["clamped", "pinned"]
GRAVITY = 9.81
_DIFFERENCE = 1e-5


def irvine_parameter(cable: Cable) -> float:
    """lambda² = (m g L cos(theta)/T)² EA L/(T L_e), L_e = L (1 + (m g L cos(theta)/T)²/8) (Irvine, second-hand)."""
    sag = cable.mass * GRAVITY * cable.length * np.cos(cable.inclination) / cable.tension
    return float(sag**2 * cable.estimated_axial_stiffness / cable.tension / (1 + sag**2 / 8))


class DampedBeam:
    """epsilon v'''' - v'' + s² v = -Lambda (integral of v), and the force Z v at a damper.

    Lengths over L, s = lambda L/sqrt(T/m); epsilon = EI/(T L²) (0 without bending), Lambda = Irvine's lambda² (0
    without sag). Between dampers v is a sum of exponentials and a constant p = -Lambda (integral of v)/s²; the
    conditions at ends and dampers, and the integral, are a matrix A(s) that is singular at an eigenvalue (derived).
    Without bending v is free to bend, and the ends only hold v.
    """

    def __init__(
        self, cable: Cable, dampers: DamperPlaces, *, sag: bool, bending: bool, ends: Ends = "clamped"
    ) -> None:
        self.dampers = dampers
        self.ends = one_of("ends", ends, get_args(Ends))
        self.epsilon = cable.bending_stiffness / cable.tension / cable.length**2 if bending else 0.0
        self.sag = irvine_parameter(cable) if sag else 0.0
        self._pieces = np.diff(dampers.places, prepend=0.0, append=1.0)

    def undamped(self, count: int) -> np.ndarray:
        """i omega (count,): odd modes symmetric, even ones antisymmetric, numbered as on the string."""
        even = [self._frequency(self._antisymmetric(n)) for n in range(2, count + 1, 2)]
        odd = [self._frequency(beta) for beta in self._symmetric((count + 1) // 2)]
        omega = np.empty(count)
        omega[0::2], omega[1::2] = odd, even
        return 1j * omega

    def log_derivative(self, s: np.ndarray, t: complex) -> np.ndarray:
        """(n,): d log det A/ds = trace(A^-1 A'), A' by central differences (only Newton's path depends on it)."""
        step = _DIFFERENCE * np.abs(s)
        both = self._matrix(np.concatenate([s - step, s, s + step]), t)
        n = len(s)
        slope = (both[2 * n :] - both[:n]) / (2 * step)[:, None, None]
        return np.trace(np.linalg.solve(both[n : 2 * n], slope), axis1=1, axis2=2)

    def shapes(self, s: np.ndarray, t: complex, x: np.ndarray) -> np.ndarray:
        """Displacements (n, k) at x (k,) of the modes with the eigenvalues s (n,), of no particular size."""
        weights = np.linalg.svd(self._matrix(s, t))[2][:, -1, :].conj()
        place = np.searchsorted(self.dampers.places, x, side="left")
        starts = np.concatenate([[0.0], self.dampers.places])
        width, found = self._width, np.empty((len(s), len(x)), dtype=complex)
        for i, piece in enumerate(self._pieces):
            inside = place == i
            part = weights[:, i * width : (i + 1) * width]
            for k in np.flatnonzero(inside):
                found[:, k] = np.einsum("nj,nj->n", self._functions(s, piece, x[k] - starts[i])[:, 0], part)
        return found + (weights[:, -1:] if self.sag else 0.0)

    @property
    def _width(self) -> int:
        return 4 if self.epsilon else 2

    def _rates(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The wave's and the boundary layer's exponent, (n,) each."""
        if not self.epsilon:
            return s, np.ones_like(s)
        root = 1 + np.sqrt(1 - 4 * self.epsilon * s**2)
        return s * np.sqrt(2 / root), np.sqrt(root / (2 * self.epsilon))

    def _functions(self, s: np.ndarray, piece: float, y: float) -> np.ndarray:
        """(n, 4 or 2, width): v, v'/b, v''/b², v'''/b³ of each function at y along a piece, b the layer's exponent."""
        a, b = self._rates(s)
        c, d = np.cosh(a * y), np.sinh(a * y)
        r = a / b if self.epsilon else a / s
        rows = [[c, d], [r * d, r * c]]
        if self.epsilon:
            e, f = np.exp(-b * y), np.exp(-b * (piece - y))
            rows = [
                [c, d, e, f], [r * d, r * c, -e, f], [r**2 * c, r**2 * d, e, f], [r**3 * d, r**3 * c, -e, f],
            ]  # fmt: skip
        return np.array(rows).transpose(2, 0, 1)

    def _matrix(self, s: np.ndarray, t: complex) -> np.ndarray:
        """A (n, m, m) at s (n,)."""
        width, pieces = self._width, len(self._pieces)
        size = pieces * width + bool(self.sag)
        a, b = self._rates(s)
        jumps, _ = self.dampers.resistance(s, t)
        matrix = np.zeros((len(s), size, size), dtype=complex)
        held = [0] if not self.epsilon else [0, 1 if self.ends == "clamped" else 2]
        row = 0
        for i, piece in enumerate(self._pieces):
            here = slice(i * width, (i + 1) * width)
            first, last = self._functions(s, piece, 0.0), self._functions(s, piece, piece)
            if i == 0:
                matrix[:, row : row + len(held), here] = first[:, held]
                matrix[:, row, -1] += bool(self.sag)
                row += len(held)
            else:  # from the piece before to this one
                matrix[:, row : row + width, here] = first
                if self.epsilon:  # epsilon (v''' after - v''' before) + Z v = 0
                    force = jumps[i - 1] * s / (self.epsilon * b**3)
                    matrix[:, row + 3, here] += force[:, None] * first[:, 0]
                else:  # (v' after - v' before)/s - Z v/s = 0
                    force = -jumps[i - 1]
                    matrix[:, row + 1, here] += force[:, None] * first[:, 0]
                if self.sag:
                    matrix[:, row + width - 1, -1] += force
                row += width
            if i == pieces - 1:
                matrix[:, row : row + len(held), here] = last[:, held]
                matrix[:, row, -1] += bool(self.sag)
                row += len(held)
            else:
                matrix[:, row : row + width, here] = -last
            if self.sag:  # p + (Lambda/s²) (integral of v) = 0
                share = self.sag / s**2
                area = [np.sinh(a * piece) / a, (np.cosh(a * piece) - 1) / a]
                if self.epsilon:
                    layer = (1 - np.exp(-b * piece)) / b
                    area += [layer, layer]
                matrix[:, -1, here] = share[:, None] * np.array(area).T
        if self.sag:
            matrix[:, -1, -1] = 1 + self.sag / s**2
        return matrix

    def _frequency(self, beta: float) -> float:
        return beta * sqrt(1 + self.epsilon * beta**2)

    def _antisymmetric(self, n: int) -> float:
        """The wave number of an even mode: n pi, or clamped beta = alpha tan(beta/2)/tanh(alpha/2)."""
        if not self.epsilon or self.ends == "pinned":
            return n * pi

        def balance(beta: float) -> float:
            alpha = sqrt(beta**2 + 1 / self.epsilon)
            return beta * cos(beta / 2) * tanh(alpha / 2) - alpha * sin(beta / 2)

        return _root(balance, n * pi, (n + 1) * pi)

    def _symmetric(self, count: int) -> list[float]:
        """The wave numbers of the first odd modes; a string with sag gives Irvine's equation."""

        def balance(beta: float) -> float:
            layer = area = 0.0
            if self.epsilon:
                alpha = sqrt(beta**2 + 1 / self.epsilon)
                clamped = self.ends == "clamped"
                layer = (
                    beta * sin(beta / 2) / (alpha * tanh(alpha / 2))
                    if clamped
                    else beta**2 * cos(beta / 2) / alpha**2
                )
                area = 2 * layer * tanh(alpha / 2) / alpha
            ratio = self.sag / self._frequency(beta) ** 2
            return (1 - ratio) * (cos(beta / 2) + layer) + ratio * (2 * sin(beta / 2) / beta + area)

        grid = np.linspace(0.5 * pi, (2 * count + 3) * pi, 40 * (2 * count + 3))
        values = np.array([balance(beta) for beta in grid])
        roots = [
            _root(balance, grid[i], grid[i + 1])
            for i in np.flatnonzero((values[:-1] < 0) != (values[1:] < 0))
        ]
        if len(roots) < count:
            raise ComputationError(f"only {len(roots)} of {count} symmetric modes were found")
        return roots[:count]


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """The root between two points of different signs."""
    return brentq(function, low, high, xtol=1e-14)  # type: ignore[return-value]
