"""Spectra of natural wind, and samples of a wind that has them.

A spectrum here is one-sided and of unit variance: the integral of S(f) over all frequencies f > 0 in Hz is 1. Its
length L is the integral length scale, S(0) = 4 L / U, so that gusts stay alike for about L / U seconds.
"""

from collections.abc import Sequence
from math import gamma, pi, sqrt
from typing import Any, Literal

import numpy as np
from scipy.special import hyp2f1

from rainwind.physics.checks import one_of

__all__ = ["Component", "Spectrum", "share_below", "spectrum_at", "turbulent_samples"]

Spectrum = Literal["kaimal", "von karman"]
Component = Literal["along", "vertical"]
SPECTRA = ("kaimal", "von karman")
COMPONENTS = ("along", "vertical")

_C = (2 * sqrt(pi) * gamma(1 / 3) / gamma(5 / 6)) ** 2
"""70.78: printed as 70.8 (ESDU 85020) or 71 (IEC 61400-1); this value makes the variance 1 exactly."""


def spectrum_at(frequency: Any, spectrum: Spectrum, component: Component, length: float, mean: float) -> Any:
    """S(f) in 1/Hz at frequencies (...,) in Hz, for a mean speed U (m/s) and this component's own length L (m).

    kaimal: 4 (L/U) / (1 + 6 f L/U)^(5/3), for both components (IEC 61400-1, annex B; EN 1991-1-4, annex B, prints
    6.8 fL / (1 + 10.2 fL)^(5/3), which is this with its L(z) times 1.7). von karman, along:
    4 (L/U) / (1 + 70.8 (f L/U)²)^(5/6); vertical: 4 (L/U) (1 + 755.2 (f L/U)²) / (1 + 283.2 (f L/U)²)^(11/6)
    (von Karman 1948; ESDU 85020). The formulas are taken from the literature; the standards themselves were not at
    hand. Raises InputError for other names.
    """
    _known(spectrum, component)
    t = length / mean
    x = np.asarray(frequency, dtype=float) * t
    if spectrum == "kaimal":
        return 4 * t * (1 + 6 * x) ** (-5 / 3)
    if component == "along":
        return 4 * t * (1 + _C * x**2) ** (-5 / 6)
    return 4 * t * (1 + 8 / 3 * 4 * _C * x**2) * (1 + 4 * _C * x**2) ** (-11 / 6)


def share_below(frequency: Any, spectrum: Spectrum, component: Component, length: float, mean: float) -> Any:
    """The integral of S from 0 to these frequencies (...,) in Hz: the share of the variance below, 0 to 1."""
    _known(spectrum, component)
    x = np.asarray(frequency, dtype=float) * length / mean
    if spectrum == "kaimal":
        return -np.expm1(-2 / 3 * np.log1p(6 * x))
    if component == "along":
        return _von_karman_below(x)
    # isotropic turbulence: S_w = (S_u - f dS_u/df) / 2, where S_u has twice the length
    return _von_karman_below(2 * x) - 4 * x * (1 + 4 * _C * x**2) ** (-5 / 6)


def _von_karman_below(x: np.ndarray) -> np.ndarray:
    return 4 * x * hyp2f1(0.5, 5 / 6, 1.5, -_C * x**2)


def turbulent_samples(
    count: int,
    dt: float,
    seed: Sequence[int],
    spectrum: Spectrum,
    component: Component,
    length: float,
    mean: float,
) -> np.ndarray:
    """Samples (count,) of unit variance before the band is cut, mean 0, dt seconds apart, periodic in count dt.

    One wave for each frequency k / (count dt) below half the sampling rate, its amplitude from the share of the
    variance within half a frequency step to either side, its phase random and uniform (Shinozuka & Deodatis 1991).
    So every record has the spectrum and variance wanted and not only the mean of many, and is Gaussian as a sum of
    many waves; random amplitudes would be Gaussian exactly, but let the variance scatter. seed: whole numbers for
    PCG64, which gives the same phases on every machine.
    """
    waves = (count - 1) // 2
    edges = (np.arange(waves + 1) + 0.5) / (count * dt)
    share = np.diff(share_below(edges, spectrum, component, length, mean))
    phases = 2 * pi * np.random.Generator(np.random.PCG64(list(seed))).random(waves)
    transform = np.zeros(count // 2 + 1, complex)
    transform[1 : waves + 1] = np.sqrt(share / 2) * np.exp(1j * phases)
    return np.fft.irfft(transform * count, count)


def _known(spectrum: Spectrum, component: Component) -> None:
    one_of("spectrum", spectrum, SPECTRA)
    one_of("component", component, COMPONENTS)
