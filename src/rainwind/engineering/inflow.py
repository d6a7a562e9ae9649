"""From compass directions to the angles of the section: yaw gamma, beta and the wind normal to the cable."""

from math import pi
from typing import Any

import numpy as np

from rainwind.errors import InputError
from rainwind.physics.checks import radians_between
from rainwind.physics.oblique_wind import beta, normal_factor

__all__ = ["beta", "normal_factor", "yaw"]

_ROUNDING = 1e-9


def yaw(direction: Any, heading: float) -> Any:
    """gamma in rad, -pi/2 to pi/2, of winds from `direction` on a stay that rises towards `heading`.

    direction: where the wind comes from, rad clockwise from north, a number or an array; the result has its shape.
    heading: from the lower to the upper anchorage, rad clockwise from north. A wind from the side of the upper end
    blows down along the cable: gamma > 0. Raises InputError.

    sin(gamma) = cos(direction - heading) has two solutions, gamma and pi - gamma. They are mirror images of each
    other in the vertical plane of the wind: the cable descends to the wind's left or to its right. A round cable
    looks the same in that mirror, and so does its rivulet. The section's y points down only for |gamma| <= pi/2,
    and the coefficients belong to a rivulet on the upper side there; so this one is taken.
    Source: derived; the signs are those of `Wind.yaw`.
    """
    heading = radians_between("heading", heading, 0.0, 2 * pi)
    if np.ndim(direction) == 0:
        direction = radians_between("direction", direction, -2 * pi - _ROUNDING, 2 * pi + _ROUNDING)
    else:
        direction = np.asarray(direction, dtype=float)
        if not np.all(np.abs(direction) <= 2 * pi + _ROUNDING):
            raise InputError(
                "direction holds values that do not look like angles in radians: allowed is one turn, "
                f"-{2 * pi:.6g} to {2 * pi:.6g}; convert degrees with numpy.radians"
            )
    along, across = np.cos(direction - heading), np.abs(np.sin(direction - heading))
    # asin(along), without its loss of digits near +-pi/2
    gamma = np.arctan2(along, across)
    return float(gamma) if np.ndim(gamma) == 0 else gamma
