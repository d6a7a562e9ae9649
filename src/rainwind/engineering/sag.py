"""Sag of a stay: what its weight does to the modes in its plane, after Irvine.

Lengths in units of L, s from mid-span, w and epsilon as in `bending`:

    epsilon v'''' - v'' + lambda² (integral of v) = w² v.

A symmetric mode stretches the cable once per period; the tension that this makes acts on the sag. Antisymmetric
modes and those out of plane do not stretch it, so that they are those of `bending`.
"""

from math import cos, pi, sin, tanh

from rainwind.engineering.bending import Ends, hyperbolic, wave_number
from rainwind.engineering.cable import Cable
from rainwind.errors import InputError
from rainwind.physics.checks import not_negative
from rainwind.physics.letters import GRAVITY
from rainwind.physics.root_isolation import polished_root

__all__ = [
    "CROSSOVER",
    "lambda_squared",
    "mid_span_sag",
    "sagging_wave_number",
    "symmetric_parts",
    "weight_ratio",
]

CROSSOVER = 4 * pi**2
"""lambda² at which modes 1 and 2 in plane have the same frequency (a string's)."""

_ROUNDING = 1e-14


def weight_ratio(cable: Cable) -> float:
    """m g L cos(theta) / H: the weight across the chord over the tension along it; eight times sag over length."""
    return cable.mass * GRAVITY * cable.length * cos(cable.inclination) / cable.tension


def mid_span_sag(cable: Cable) -> float:
    """m g cos(theta) L² / (8 H) in m, across the chord, of the parabola."""
    return weight_ratio(cable) * cable.length / 8


def lambda_squared(cable: Cable) -> float:
    """lambda² = (m g L cos(theta) / H)² EA L / (H L_e), L_e = L (1 + (m g L cos(theta) / H)² / 8).

    EA is the cable's, or estimated from its tension. Source: Irvine (1981), from
    memory; its consequences are derived and tested here.
    """
    ratio = weight_ratio(cable)
    return ratio**2 * cable.estimated_axial_stiffness / cable.tension / (1 + ratio**2 / 8)


def symmetric_parts(q: float, epsilon: float, ends: Ends) -> tuple[float, float]:
    """Of v = C + A cosh(p s) / cosh(p / 2) + cos(q s), which vanishes at its ends and is clamped or pinned: A and C."""
    p = hyperbolic(q, epsilon)
    clamped = ends == "clamped"
    a = q / p * sin(q / 2) / tanh(p / 2) if clamped else (q / p) ** 2 * cos(q / 2)
    return a, -a - cos(q / 2)


def sagging_wave_number(mode: int, lambda2: float, epsilon: float = 0.0, ends: Ends = "clamped") -> float:
    """q of the symmetric mode 1, 3, 5, ... in plane, rad per length L. Raises InputError.

    The root of w² C = lambda² (integral of v); without bending this is tan(w / 2) = w / 2 - (4 / lambda²) (w / 2)³
    and q = w. Mode n is the root between those without sag of modes n and n + 2 (a rank-one stiffness moves no root
    past the next), so it becomes the string's mode n as lambda² goes to 0. Its number therefore stays the same
    beyond the crossover, where its frequency is above that of mode n + 1: the number says which mode it is, not
    how many lie below. Source: Irvine (1981), from memory; with bending derived.
    """
    lambda2 = not_negative("lambda2", lambda2)
    if isinstance(mode, int) and mode % 2 == 0:
        raise InputError(f"mode = {mode} is antisymmetric and feels no sag; take `bending.wave_number`")
    low, high = wave_number(mode, epsilon, ends), wave_number(mode + 2, epsilon, ends)

    def balance(q: float) -> float:
        p = hyperbolic(q, epsilon)
        a, c = symmetric_parts(q, epsilon, ends)
        integral = c + a * 2 / p * tanh(p / 2) + 2 / q * sin(q / 2)
        return (q * q + epsilon * q**4) * c - lambda2 * integral

    # both ends are roots without sag: where it changes less than rounding does, the signs there are chance
    if lambda2 <= _ROUNDING * (high * high + epsilon * high**4) * high * high:
        return low
    return polished_root(balance, (low, high))
