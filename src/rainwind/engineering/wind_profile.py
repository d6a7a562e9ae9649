"""The mean wind over height, and the one speed that stands for a whole stay."""

from typing import Any

import numpy as np

from rainwind.engineering.bridge import Site
from rainwind.engineering.cable import Cable
from rainwind.engineering.modes import Mode
from rainwind.errors import InputError

__all__ = ["lowest_height", "mode_factor", "speed_factor"]

_POINTS = 2000  # along the stay: the middles of as many equal pieces


def lowest_height(site: Site) -> float:
    """Height in m below which the profile is kept constant: 1 m, or 10 roughness lengths, up to the reference height.

    Close to the ground neither law holds, and the logarithmic one turns negative below its roughness length. Source:
    our choice, as EN 1991-1-4 keeps its profile constant below z_min of 1 m (sea) to 10 m (towns; 10 z0 there).
    """
    lowest = max(1.0, 10 * site.roughness) if site.profile == "logarithmic" else 1.0
    return min(lowest, site.reference_height)


def speed_factor(site: Site, height: Any) -> Any:
    """U(z) / U(reference height), of the height z in m above ground or water, a number or an array of any shape.

    "uniform": 1. "power": (z / z_ref) ** exponent. "logarithmic": ln(z / z0) / ln(z_ref / z0), z0 the roughness. Below
    `lowest_height` it is constant. Raises InputError for negative heights. Source: textbook formulas.
    """
    z = np.asarray(height, dtype=float)
    if not np.all(np.isfinite(z) & (z >= 0)):
        raise InputError(f"height = {height!r} must be 0 or more, in m above ground or water")
    z = np.maximum(z, lowest_height(site))
    if site.profile == "uniform":
        factor = np.ones_like(z)
    elif site.profile == "power":
        factor = (z / site.reference_height) ** site.exponent
    else:
        factor = np.log(z / site.roughness) / np.log(site.reference_height / site.roughness)
    return float(factor) if np.ndim(height) == 0 else factor


def mode_factor(cable: Cable, mode: Mode, site: Site) -> float:
    """The speed that the equivalent section sees, over that at the reference height.

    Root of the mean of `speed_factor`² along the stay, weighted with the square of the mode's shape: every force is
    that of the dynamic pressure, and works on a displacement that has the mode's shape, with a lever (angle of
    attack, rivulet) that has it too. A damping by the wind goes with the speed itself, and would want its plain
    mean; both differ by half the square of the profile's coefficient of variation, under 1 % for usual stays.
    Source: derived.
    """
    xi = (np.arange(_POINTS) + 0.5) / _POINTS
    height = cable.base_height + xi * cable.length * np.sin(cable.inclination)
    weight = mode.at(xi) ** 2
    return float(np.sqrt(np.sum(weight * speed_factor(site, height) ** 2) / np.sum(weight)))
