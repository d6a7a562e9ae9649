"""A stay that moves gets longer: the cubic stiffness that couples both directions, and the sag in it.

With the mode shape sin(n pi x / L) the mean strain is e = e1 y + e2 (y² + z²), y down in plane, z out of plane. The
energy EA e² per metre of the equivalent section (its modal mass is that of L / 2) is

    V = k3 (s y + (y² + z²) / 2)²,       k3 = 4 EA e2²,       s = e1 / (2 e2).

Source: derived. A test integrates the strain.
"""

from math import cos, pi, sqrt

from rainwind.engineering.cable import Cable
from rainwind.physics.letters import GRAVITY

__all__ = ["cubic_stiffness", "sag_offset", "sine_sag_offset"]


def cubic_stiffness(cable: Cable, mode: int) -> float:
    """k3 = EA (n pi)⁴ / (4 L⁴) in N/m⁴ per metre: the force on the section is k3 y (y² + z²) and k3 z (y² + z²)."""
    return cable.estimated_axial_stiffness * (mode * pi / cable.length) ** 4 / 4


def sag_offset(cable: Cable, mode: int, frequency_in: float, frequency_out: float) -> float:
    """s >= 0 in m with which the section has both linear frequencies (Hz): 2 k3 s² = m (2 pi)² (f_in² - f_out²).

    0 for antisymmetric modes, whose frequencies are the same.
    """
    added = cable.mass * (2 * pi) ** 2 * (frequency_in**2 - frequency_out**2)
    return sqrt(max(added, 0.0) / (2 * cubic_stiffness(cable, mode)))


def sine_sag_offset(cable: Cable, mode: int) -> float:
    """s = e1 / (2 e2) = 4 m g cos(theta) L² / (H (n pi)³) in m of a sine: what `sag_offset` becomes for little sag.

    1.03 times the mid-span sag for the first mode; 0 for antisymmetric modes.
    """
    if mode % 2 == 0:
        return 0.0
    weight = cable.mass * GRAVITY * cos(cable.inclination)
    return 4 * weight * cable.length**2 / (cable.tension * (mode * pi) ** 3)
