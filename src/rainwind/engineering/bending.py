"""Bending stiffness of a stay: wave numbers of a tensioned beam without sag.

Lengths in units of L, w = omega L sqrt(m / T), epsilon = EI / (T L²):

    epsilon v'''' - v'' = w² v,      v = sin or cos (q s) and sinh or cosh (p s) about mid-span,
    w² = q² + epsilon q⁴,            p² = q² + 1 / epsilon.
"""

from math import cos, inf, pi, sin, sqrt, tanh
from typing import Literal, get_args

from rainwind.engineering.cable import Cable
from rainwind.errors import InputError
from rainwind.physics.checks import one_of
from rainwind.physics.root_isolation import polished_root

__all__ = ["ENDS", "Ends", "bending_parameter", "frequency", "hyperbolic", "mode_number", "wave_number"]

Ends = Literal["clamped", "pinned"]
ENDS: tuple[str, ...] = get_args(Ends)

_NO_BENDING = 1e-24
"""epsilon below which a cable is a string: its ends change q by 2 sqrt(epsilon), far below rounding."""


def bending_parameter(cable: Cable) -> float:
    """epsilon = EI / (T L²), without a unit; 1 / sqrt(epsilon) is often called xi (100 and more for a stay)."""
    return cable.bending_stiffness / (cable.tension * cable.length**2)


def hyperbolic(q: float, epsilon: float) -> float:
    """p = sqrt(q² + 1 / epsilon), the wave number of the bent ends; infinite for a string."""
    return inf if epsilon < _NO_BENDING else sqrt(q * q + 1 / epsilon)


def frequency(cable: Cable, q: float) -> float:
    """Hz at the wave number q (rad per length L): w / (2 pi L) sqrt(T / m), w² = q² + epsilon q⁴."""
    w = q * sqrt(1 + bending_parameter(cable) * q * q)
    return w * cable.wave_speed / (2 * pi * cable.length)


def mode_number(mode: int) -> int:
    """The mode's number as an int of 1 or more; InputError otherwise."""
    if isinstance(mode, bool) or not isinstance(mode, int) or mode < 1:
        raise InputError(f"mode = {mode!r} must be a whole number, 1 for the first mode")
    return mode


def wave_number(mode: int, epsilon: float, ends: Ends = "clamped") -> float:
    """q of mode 1, 2, ... of a tensioned beam without sag, rad per length L. Raises InputError.

    Pinned ends: n pi. Clamped ends: the root of q tan(q / 2) = -p tanh(p / 2) for odd n, of
    p tan(q / 2) = q tanh(p / 2) for even n; one lies between n pi and (n + 1) pi. A stay's strands are held in
    their anchorages, so that its ends are clamped unless they are said to be pinned.
    Source: derived; tests compare it with a Chebyshev solution and with Morse's approximation.
    """
    mode = mode_number(mode)
    one_of("ends", ends, ENDS)
    if ends == "pinned" or epsilon < _NO_BENDING:
        return mode * pi

    def clamping(q: float) -> float:
        p = hyperbolic(q, epsilon)
        if mode % 2:
            return q / p * sin(q / 2) + tanh(p / 2) * cos(q / 2)
        return sin(q / 2) - q / p * tanh(p / 2) * cos(q / 2)

    return polished_root(clamping, (mode * pi, (mode + 1) * pi))
