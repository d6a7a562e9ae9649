"""The spring that a string has: it gets longer as it moves, whichever way, and its tension pulls it back.

Energy per metre of cable: k3 e² with e = s v + (y² + z²)/2. v is the displacement in the cable's vertical plane,
positive down: v = y cos(beta) - z sin(beta), as the cable's top is at phi = -beta. s (sag_offset) comes from the
sag; without it the forces are k3 y (y² + z²) and k3 z (y² + z²).
Source: derived (docs/theory.md); Peil & Nahrath (2003) have uncoupled springs only.
"""

from math import hypot, isfinite
from typing import Any

from rainwind.physics.letters import Letters

_EPS = 2.220446049250313e-16
_MOST_STEPS = 500


def tension_forces(at: Letters, y: Any, z: Any) -> tuple[Any, Any]:
    """What the tension pulls back with in y and z, N per metre of cable: the gradient of `tension_energy`."""
    pull = at.k3 * _twice_stretch(at, y, z)
    return pull * (y + at.s_y), pull * (z + at.s_z)


def tension_energy(at: Letters, y: Any, z: Any) -> Any:
    """k3 e² in J per metre of cable."""
    twice = _twice_stretch(at, y, z)
    return at.k3 * twice * twice / 4


def _twice_stretch(at: Letters, y: Any, z: Any) -> Any:
    """2 e in m²: the squared distance from (-s_y, -s_z), less s²."""
    return y * (y + 2 * at.s_y) + z * (z + 2 * at.s_z)


def rest_position(at: Letters, force_y: float, force_z: float, freedoms: int) -> tuple[float, float, bool]:
    """(y, z) in m where the springs hold the forces (N per metre), and whether they do to rounding.

    Newton's method with steps halved until the excess falls. It finds the one position that there is where
    `need_one_rest_position` lets the numbers pass. With two degrees of freedom z is 0.
    """
    both = freedoms == 3

    def excess(y: float, z: float) -> tuple[float, float]:
        g_y, g_z = spring_forces(at, y, z)
        return g_y - force_y, g_z - force_z if both else 0.0

    y, z = 0.0, 0.0
    g_y, g_z = excess(y, z)
    for _ in range(_MOST_STEPS):
        h_yy, h_yz, h_zz = spring_stiffness(at, y, z)
        if not both:
            h_yz, h_zz = 0.0, 1.0
        # the 2 by 2 system by elimination: positive definite, so that both pivots are above zero
        ratio = h_yz / h_yy
        pivot = h_zz - ratio * h_yz
        if not pivot > 0:
            break
        step_z = -(g_z - ratio * g_y) / pivot
        step_y = -(g_y + h_yz * step_z) / h_yy
        size, share = hypot(g_y, g_z), 1.0
        while share * hypot(step_y, step_z) > 0.25 * _EPS * hypot(y, z):
            there = y + share * step_y, z + share * step_z
            found = excess(*there)
            if hypot(*found) < size:
                break
            share /= 2
        else:
            break
        (y, z), (g_y, g_z) = there, found
    t_y, t_z = tension_forces(at, y, z)
    loads = abs(force_y) + abs(force_z) + abs(at.k_y * y) + abs(at.k_z * z) + abs(t_y) + abs(t_z)
    return y, z, isfinite(loads) and hypot(g_y, g_z) <= 1e-12 * loads


def spring_forces(at: Letters, y: Any, z: Any) -> tuple[Any, Any]:
    """What all springs, tension and the cable's own, pull back with in y and z, N per metre; numbers or arrays."""
    t_y, t_z = tension_forces(at, y, z)
    return (
        y * (at.k_y + y * (at.k_y2 + y * at.k_y3)) + t_y,
        z * (at.k_z + z * (at.k_z2 + z * at.k_z3)) + t_z,
    )


def spring_stiffness(at: Letters, y: Any, z: Any) -> tuple[Any, Any, Any]:
    """The Hessian of all springs' energy: yy, yz, zz, N/m² per metre; numbers or arrays."""
    from_y, from_z, pull = y + at.s_y, z + at.s_z, at.k3 * _twice_stretch(at, y, z)
    return (
        at.k_y + y * (2 * at.k_y2 + 3 * y * at.k_y3) + pull + 2 * at.k3 * from_y * from_y,
        2 * at.k3 * from_y * from_z,
        at.k_z + z * (2 * at.k_z2 + 3 * z * at.k_z3) + pull + 2 * at.k3 * from_z * from_z,
    )
