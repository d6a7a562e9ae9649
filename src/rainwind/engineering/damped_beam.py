"""A cable with bending stiffness, sag or both, with dampers: its characteristic function, exact."""

import numpy as np

from rainwind.engineering.bending import ENDS, Ends, bending_parameter, wave_number
from rainwind.engineering.cable import Cable
from rainwind.engineering.damper_places import DamperPlaces
from rainwind.engineering.sag import lambda_squared, sagging_wave_number
from rainwind.physics.checks import one_of

__all__ = ["DampedBeam", "Ends"]

_DIFFERENCE = 1e-5


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
        self.ends = one_of("ends", ends, ENDS)
        self.epsilon = bending_parameter(cable) if bending else 0.0
        self.sag = lambda_squared(cable) if sag else 0.0
        self._pieces = np.diff(dampers.places, prepend=0.0, append=1.0)

    def undamped(self, count: int) -> np.ndarray:
        """i omega (count,): odd modes symmetric, even ones antisymmetric, numbered as on the string."""
        e, ends = self.epsilon, self.ends
        q = np.array(
            [
                sagging_wave_number(n, self.sag, e, ends) if self.sag and n % 2 else wave_number(n, e, ends)
                for n in range(1, count + 1)
            ]
        )
        return 1j * q * np.sqrt(1 + e * q**2)

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
