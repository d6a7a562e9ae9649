"""The damping of a stay's modes over the coefficient of one damper: exact, and Krenk's asymptote."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np

from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.damped_beam import Ends
from rainwind.engineering.dampers import damped_cable, ratios_of, scaled_roots, whole_number
from rainwind.errors import InputError
from rainwind.physics.checks import positive

__all__ = ["DamperCurve", "damper_curve", "krenk_damping", "optimum_coefficient", "support_factor"]


@dataclass(frozen=True, eq=False)
class DamperCurve:
    """Ratios over the coefficient of one damper.

    cable: its name. position: of the damper, m. support_stiffness: N/m. modes (m,). coefficients (k,), Ns/m, rising.
    ratios (k, m): exact, added by the damper. asymptote (k, m): Krenk's, of the taut string.
    """

    cable: str
    position: float
    support_stiffness: float
    modes: tuple[int, ...]
    coefficients: np.ndarray
    ratios: np.ndarray
    asymptote: np.ndarray


def krenk_damping(
    cable: Cable, mode: int, position: float, coefficient: float, support_stiffness: float = inf
) -> float:
    """Damping ratio by the universal curve: zeta_n/(x/L) = X/(X² + 1) with X = pi² kappa (Krenk 2000, second-hand).

    kappa = c/(m L omega_1) n x/L. On a support of stiffness k: X/((X F)² + 1), F = `support_factor` (derived; checked
    against the exact modes). For a damper near the anchorage, n x/L much less than 1/2. Raises InputError.
    """
    share = _share(cable, position)
    factor = support_factor(cable, position, support_stiffness)
    size = pi * whole_number("mode", mode) * share * positive("coefficient", coefficient, "in Ns/m")
    size /= sqrt(cable.tension * cable.mass)
    return share * size / ((size * factor) ** 2 + 1)


def optimum_coefficient(cable: Cable, mode: int, position: float, support_stiffness: float = inf) -> float:
    """The coefficient in Ns/m at which Krenk's curve is highest: sqrt(T m)/(pi n x/L F) (second-hand; F derived)."""
    factor = support_factor(cable, position, support_stiffness)
    share = _share(cable, position)
    return sqrt(cable.tension * cable.mass) / (pi * whole_number("mode", mode) * share * factor)


def support_factor(cable: Cable, position: float, support_stiffness: float) -> float:
    """F = 1 + T/(k x): a support in series divides the largest damping and its coefficient by it (derived).

    The string yields to a force at x near the anchorage by x/T, and the support by 1/k beside it.
    """
    return 1.0 + cable.tension / (Damper(position, 1.0, support_stiffness).support_stiffness * position)


def damper_curve(
    cable: Cable,
    modes: Sequence[int],
    position: float,
    coefficients: Sequence[float] | np.ndarray,
    support_stiffness: float = inf,
    *,
    sag: bool = False,
    bending: bool = False,
    ends: Ends = "clamped",
) -> DamperCurve:
    """Ratios of modes (m,) over coefficients (k,) in Ns/m, rising, of a damper at the position, m. Raises InputError.

    sag, bending, ends: as in `damped_modes`; the asymptote is always the taut string's.
    """
    numbers = tuple(whole_number("mode", mode) for mode in modes)
    over = np.array([positive("coefficient", c, "in Ns/m") for c in coefficients])
    if not numbers or not len(over) or not (np.diff(over) > 0).all():
        raise InputError("give one mode or more, and coefficients that rise")
    model = damped_cable(
        cable, (Damper(position, over[0], support_stiffness),), sag=sag, bending=bending, ends=ends
    )
    roots = scaled_roots(model, max(numbers), over / over[0])[:, np.array(numbers) - 1]
    asymptote = [[krenk_damping(cable, n, position, c, support_stiffness) for n in numbers] for c in over]
    return DamperCurve(
        cable.name,
        float(position),
        float(support_stiffness),
        numbers,
        over,
        ratios_of(roots),
        np.array(asymptote),
    )


def _share(cable: Cable, position: float) -> float:
    """x/L, below one half."""
    share = positive("position", position, "in m from the nearer anchorage") / cable.length
    if share >= 0.5:
        raise InputError(
            f"position = {position:g} m lies beyond mid-span of stay '{cable.name}', which is {cable.length:g} m long; "
            "give the distance from the nearer anchorage"
        )
    return share
