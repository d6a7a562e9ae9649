"""What a vibrating stay does to its anchorage: the angle there and the bending stress.

No S-N curve is given: none was read for wires and strands that are bent at their anchorage. Cycles a year by amplitude
come from `climate.cycles`; an engineer with the curve of the stay's supplier goes on from here.
"""

from math import pi

import numpy as np

from rainwind.engineering.cable import Cable
from rainwind.errors import InputError
from rainwind.physics.checks import positive

__all__ = ["anchorage_angle", "bending_stress"]


def anchorage_angle(cable: Cable, mode: int, amplitude: float | np.ndarray) -> float | np.ndarray:
    """n pi A / L in rad: how far the chord's direction swings at the anchorages, half peak to peak.

    amplitude: half peak to peak at an antinode, m, a number or any array. A taut string's mode, without sag, bending
    stiffness and dampers; the end of a damper's own piece swings less. Raises InputError. Source: derived, the slope
    of A sin(n pi x / L) at x = 0.
    """
    if isinstance(mode, bool) or not isinstance(mode, int | np.integer) or mode < 1:
        raise InputError(f"mode = {mode!r} must be a whole number from 1")
    return mode * pi * _not_negative("amplitude", amplitude, "half peak to peak in m") / cable.length


def bending_stress(angle: float | np.ndarray, axial_stress: float, modulus: float) -> float | np.ndarray:
    """2 phi sqrt(E sigma) in Pa at the outermost fibre, on top of the axial stress, for +phi; the range is twice that.

    angle: phi, rad, a number or any array; axial_stress: sigma of the tension, Pa; modulus: E, Pa. A solid round bar
    clamped in a rigid anchorage, long against sqrt(EI/T). No diameter stands in it: a bundle that sticks together and
    a wire bent by itself have the same stress; a guide or a neoprene ring lowers it. Raises InputError.

    Source: the formula for stays is from memory; derived here from M = phi sqrt(T EI) of a taut bar at its clamp.
    """
    stress = positive("axial_stress", axial_stress, "in Pa")
    return (
        2 * _not_negative("angle", angle, "in rad") * np.sqrt(positive("modulus", modulus, "in Pa") * stress)
    )


def _not_negative(name: str, value: float | np.ndarray, unit: str) -> float | np.ndarray:
    """The value, in which nan stays nan: where there is no vibration."""
    if np.any(np.asarray(value) < 0) or np.any(np.isinf(value)):
        raise InputError(f"{name} = {value} must be 0 or more, and finite; {unit}")
    return value
