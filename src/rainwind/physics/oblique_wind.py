"""A wind that does not blow across the cable: its part in the section's plane, and how gravity lies to it, eq. (1)."""

from typing import Any

from rainwind.elementary import atan2, cos, sin, sqrt

__all__ = ["beta", "normal_factor"]


def normal_factor(yaw: Any, inclination: Any) -> Any:
    """U_n / U = sqrt(cos² gamma + sin² gamma sin² delta) of a horizontal wind.

    yaw gamma and inclination delta in rad: numbers, arrays or tape symbols. Source: geometry (derived; a test
    compares it with vectors in space): the paper prints beta only.
    """
    gamma, delta = yaw, inclination
    return sqrt(cos(gamma) * cos(gamma) + sin(gamma) * sin(gamma) * (sin(delta) * sin(delta)))


def beta(yaw: Any, inclination: Any) -> Any:
    """beta in rad, -pi to pi: the cable's top lies at phi = -beta.

    yaw gamma and inclination delta in rad: numbers, arrays or tape symbols. Source: Peil & Nahrath (2003), eq. (1)
    (read), with atan2 so that it also holds beyond 90 degrees of yaw.
    """
    gamma, delta = yaw, inclination
    return atan2(sin(gamma) * sin(delta), cos(gamma))
