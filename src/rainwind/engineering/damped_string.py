"""A taut string with dampers: its characteristic function and the shapes of its modes, exact."""

import numpy as np

from rainwind.engineering.damper_places import DamperPlaces

__all__ = ["DampedString"]


class DampedString:
    """v'' = s² v between dampers, v = 0 at both ends, v' jumps by Z v at a damper (derived; no approximation).

    Lengths over L, s = lambda L / sqrt(T/m). With one rigid damper at a the roots obey
    coth(s a) + coth(s (1 - a)) = -c/sqrt(T m) (derived, checked against finite elements).
    """

    def __init__(self, dampers: DamperPlaces) -> None:
        self.dampers = dampers
        self._pieces = np.diff(dampers.places, prepend=0.0, append=1.0)

    def undamped(self, count: int) -> np.ndarray:
        """i pi n for n = 1 ... count."""
        return 1j * np.pi * np.arange(1, count + 1)

    def log_derivative(self, s: np.ndarray, t: complex) -> np.ndarray:
        """f'(s)/f(s) (n,) of f = v(1)/s, where v starts with v(0) = 0 and v'(0) = s; t scales the dampers."""
        jumps, slopes = self.dampers.resistance(s, t)
        v, w = np.zeros_like(s), np.ones_like(s)  # displacement, and slope over s
        v_s, w_s = np.zeros_like(s), np.zeros_like(s)
        for i, piece in enumerate(self._pieces):
            c, d = np.cosh(s * piece), np.sinh(s * piece)
            v, w, v_s, w_s = c * v + d * w, d * v + c * w, c * v_s + d * w_s, d * v_s + c * w_s
            v_s, w_s = v_s + piece * w, w_s + piece * v
            if i < len(jumps):
                w, w_s = w + jumps[i] * v, w_s + jumps[i] * v_s + slopes[i] * v
        return v_s / v - 1.0 / s

    def shapes(self, s: np.ndarray, t: complex, x: np.ndarray) -> np.ndarray:
        """Displacements (n, k) at x (k,) of the modes with the eigenvalues s (n,), of no particular size."""
        jumps, _ = self.dampers.resistance(s, t)
        place = np.searchsorted(self.dampers.places, x, side="left")
        v, w = np.zeros_like(s), np.ones_like(s)
        start, found = 0.0, np.empty((len(s), len(x)), dtype=complex)
        for i, piece in enumerate(self._pieces):
            inside = place == i
            y = s[:, None] * (x[inside] - start)
            found[:, inside] = np.cosh(y) * v[:, None] + np.sinh(y) * w[:, None]
            c, d = np.cosh(s * piece), np.sinh(s * piece)
            v, w = c * v + d * w, d * v + c * w
            if i < len(jumps):
                w = w + jumps[i] * v
            start += piece
        return found
