"""Energy of the cable section and its rivulet, and what changes it: eq. (4) of Peil & Nahrath (2003) as a balance."""

from collections.abc import Sequence
from typing import Any

from rainwind.elementary import cos, sin
from rainwind.physics.letters import Letters
from rainwind.physics.tension import tension_energy


def energy_parts(at: Letters, six: Sequence[Any]) -> dict[str, Any]:
    """Kinetic, elastic and gravity energy in J per metre of cable; six: y, phi, z and their rates.

    The rivulet moves with (y_dot + r phi_dot sin phi, z_dot - r phi_dot cos phi); its weight acts along
    cos(phi + beta). With these Lagrange's equations are the left sides of eq. (4) without its dampers.
    """
    y, phi, z, y_dot, phi_dot, z_dot = six
    rivulet_y, rivulet_z = y_dot + at.r * phi_dot * sin(phi), z_dot - at.r * phi_dot * cos(phi)
    cable = at.m_s * (y_dot * y_dot + z_dot * z_dot)
    rivulet = at.m_r * (rivulet_y * rivulet_y + rivulet_z * rivulet_z)
    springs = [
        q * q * (k / 2 + q * (k2 / 3 + q * k3 / 4))
        for q, k, k2, k3 in ((y, at.k_y, at.k_y2, at.k_y3), (z, at.k_z, at.k_z2, at.k_z3))
    ]
    if at.k3 is not None:
        springs.append(tension_energy(at, y, z))
    return {
        "kinetic": (cable + rivulet) / 2,
        "elastic": sum(springs[1:], springs[0]),
        "gravity": at.m_r * at.r * at.g_cos_delta * cos(phi + at.beta),
    }


def power_parts(at: Letters, six: Sequence[Any], forces: Sequence[Any]) -> dict[str, Any]:
    """What changes the energy, in W per metre of cable: the wind, the cable's dampers, the rivulet's friction.

    forces: F_y, F_z, M_phi of eq. (2), which the section and the rivulet move by y, z and phi.
    """
    _, _, _, y_dot, phi_dot, z_dot = six
    f_y, f_z, m_phi = forces
    return {
        "wind": f_y * y_dot + f_z * z_dot + m_phi * phi_dot,
        "cable damping": -(at.d_y * y_dot * y_dot + at.d_z * z_dot * z_dot),
        "rivulet friction": -(at.d_phi * phi_dot * phi_dot),
    }
