"""The letters of the paper's equations, from parameters by dotted name."""

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

from rainwind.elementary import cos, sin
from rainwind.physics.oblique_wind import beta, normal_factor
from rainwind.physics.section import damping, stiffness

GRAVITY = 9.81
"""g in m/s², as in Peil & Nahrath (2003)."""


class Letters(NamedTuple):
    """The letters of eqs. (1) to (4) at given parameters: numbers or tape symbols.

    u_n: of the horizontal wind, as in the paper; u_z, u_up: of all wind in the section's plane, along z and
    along -y. Without vertical wind they are u_n and 0. k3: of the tension spring, None without one; s: its offset
    by the sag, along (s_y, s_z), which is down.
    """

    rho: Any
    u_n: Any
    u_z: Any
    u_up: Any
    beta: Any
    d: Any
    r: Any
    m_s: Any
    m_r: Any
    g_cos_delta: Any
    d_y: Any
    d_z: Any
    d_phi: Any
    k_y: Any
    k_y2: Any
    k_y3: Any
    k_z: Any
    k_z2: Any
    k_z3: Any
    k3: Any = None
    s: Any = 0.0
    s_y: Any = 0.0
    s_z: Any = 0.0


def letters(p: Mapping[str, Any], given: Collection[str] = ()) -> Letters:
    """The letters from the parameters p; given: those of the section's fields `OPTIONAL` that p has."""
    gamma, delta = p["wind.yaw"], p["section.inclination"]
    normal = normal_factor(gamma, delta)
    u_n = p["wind.speed"] * normal
    # the vertical wind's part in the section's plane, turned by beta: cos(beta) = cos(gamma) / normal
    lifting = p["wind.vertical_speed"] * cos(delta) / normal
    m_s, f_y, f_z = p["section.mass"], p["section.frequency_y"], p["section.frequency_z"]
    follows = "section.damping_ratio"
    xi_y = p["section.damping_ratio_y" if "damping_ratio_y" in given else follows]
    xi_z = p["section.damping_ratio_z" if "damping_ratio_z" in given else follows]
    s = p["section.sag_offset"] if "sag_offset" in given else 0.0
    return Letters(
        rho=p["wind.density"],
        u_n=u_n,
        u_z=u_n + lifting * (sin(gamma) * sin(delta)),
        u_up=lifting * cos(gamma),
        beta=beta(gamma, delta),
        d=p["section.diameter"],
        r=(p["section.diameter"] + p["rivulet.height"]) / 2,
        m_s=m_s,
        m_r=p["rivulet.mass"],
        g_cos_delta=GRAVITY * cos(delta),
        d_y=damping(m_s, f_y, xi_y),
        d_z=damping(m_s, f_z, xi_z),
        d_phi=p["rivulet.friction"],
        k_y=stiffness(m_s, f_y),
        k_y2=p["section.k2_y"],
        k_y3=p["section.k3_y"],
        k_z=stiffness(m_s, f_z),
        k_z2=p["section.k2_z"],
        k_z3=p["section.k3_z"],
        k3=p["section.k3"] if "k3" in given else None,
        s=s,
        # down is opposite to the cable's top at phi = -beta
        s_y=s * cos(gamma) / normal,
        s_z=-s * (sin(gamma) * sin(delta)) / normal,
    )
