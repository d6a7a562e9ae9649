"""Which damper meets the damping that some modes need: the best coefficient, the range, the least position."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, inf, log, nan

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.damped_beam import Ends
from rainwind.engineering.damper_curve import damper_curve, krenk_damping, optimum_coefficient, support_factor
from rainwind.engineering.dampers import (
    damped_cable,
    damped_modes,
    damper_work,
    force,
    ratios_of,
    scaled_roots,
    stroke,
    whole_number,
)  # fmt: skip
from rainwind.errors import InputError
from rainwind.physics.checks import positive

__all__ = [
    "PRACTICE", "DamperDesign", "best_damping", "damper_work", "design_for", "force", "krenk_damping",
    "optimum_coefficient", "stroke", "support_factor",
]  # fmt: skip

PRACTICE = (1.5, 2.0)
"""A damper is put so many times farther out than the least position, for what the model leaves out (a guess)."""
FARTHEST = 0.3
"""Of the length: farther out no damper is looked for."""
_POINTS = 6  # a factor e of the coefficient


@dataclass(frozen=True)
class DamperDesign:
    """One damper for the ratios that some modes need.

    position: m; support_stiffness: N/m. modes, targets (m,): ratios to be added by the damper. coefficient: Ns/m, at
    which the least ratio over target is largest; ratios (m,): there, exact; margin: that least one, 1 or more if the
    damper does. low, high: Ns/m, between them every target is met; nan where none does. least_position: m, where one
    coefficient just meets every target on such a support (inf: none up to `FARTHEST` of the length).
    """

    position: float
    support_stiffness: float
    modes: tuple[int, ...]
    targets: tuple[float, ...]
    coefficient: float
    ratios: tuple[float, ...]
    margin: float
    low: float
    high: float
    least_position: float

    @property
    def possible(self) -> bool:
        """Whether one coefficient at this position meets every target."""
        return self.margin >= 1.0

    @property
    def practice_positions(self) -> tuple[float, float]:
        """m: the least position times `PRACTICE` (a guess)."""
        return (PRACTICE[0] * self.least_position, PRACTICE[1] * self.least_position)


def best_damping(
    cable: Cable,
    mode: int,
    position: float,
    support_stiffness: float = inf,
    *,
    sag: bool = False,
    bending: bool = False,
    ends: Ends = "clamped",
) -> tuple[float, float]:
    """The coefficient in Ns/m with which a damper at the position, m, adds most to a mode, and that ratio; exact.

    Near the anchorage the ratio is half of x/L and the coefficient `optimum_coefficient`. Raises InputError.
    """
    mode = whole_number("mode", mode)
    start = optimum_coefficient(cable, mode, position, support_stiffness)
    model = damped_cable(
        cable, (Damper(position, start, support_stiffness),), sag=sag, bending=bending, ends=ends
    )

    def ratios(scales: np.ndarray) -> np.ndarray:
        return ratios_of(scaled_roots(model, mode, scales)[:, mode - 1])

    grid = np.linspace(-3.0, 3.0, 6 * _POINTS + 1)
    top = int(np.argmax(ratios(np.exp(grid))))
    low, high = grid[max(top - 1, 0)], grid[min(top + 1, len(grid) - 1)]
    at = _highest(lambda x: float(ratios(np.array([exp(x)]))[0]), low, high)
    return start * exp(at), float(ratios(np.array([exp(at)]))[0])


def design_for(
    cable: Cable,
    targets: Mapping[int, float],
    position: float,
    support_stiffness: float = inf,
    *,
    sag: bool = False,
    bending: bool = False,
    ends: Ends = "clamped",
) -> DamperDesign:
    """One damper at the position, m, on a support, N/m, that adds the ratios wanted: mode -> ratio.

    Coefficients are scanned with exact modes, and interpolated by splines between. sag, bending,
    ends: as in `damped_modes`. Raises InputError.
    """
    if not targets:
        raise InputError("no mode has a target; give {mode: ratio}, such as {1: 0.005}")
    modes = tuple(sorted(whole_number("mode", mode) for mode in targets))
    wanted = tuple(positive(f"target of mode {mode}", targets[mode], "a ratio of critical") for mode in modes)
    if max(wanted) > 0.1:
        raise InputError(
            f"a target of {max(wanted):g} is out of reach; a ratio is of critical, 0.5 % is 0.005"
        )
    options = {"sag": sag, "bending": bending, "ends": ends}

    def scan(at: float, *, widely: bool = True) -> CubicSpline:
        """log c -> ratio over target (m,); widely: as far as the targets may reach, else about the best."""
        optima = [optimum_coefficient(cable, mode, at, support_stiffness) for mode in modes]
        reach = 0.2 * min(1.0, min(wanted) * cable.length / at) if widely else 0.4
        ends_ = log(min(optima) * reach), log(max(optima) / reach)
        grid = np.linspace(*ends_, 2 + int(_POINTS * (ends_[1] - ends_[0])))
        curve = damper_curve(cable, modes, at, np.exp(grid), support_stiffness, **options)
        return CubicSpline(grid, curve.ratios / np.array(wanted))

    curves = scan(positive("position", position, "in m from the nearer anchorage"))
    best, margin = _best(curves)
    low, high = (exp(x) for x in _range(curves, best)) if margin >= 1.0 else (nan, nan)
    coefficient = exp(best)
    found = damped_modes(cable, max(modes), [Damper(position, coefficient, support_stiffness)], **options)
    ratios = tuple(found[mode - 1].damping_ratio for mode in modes)
    margin = min(ratio / target for ratio, target in zip(ratios, wanted, strict=True))
    least = _least_position(lambda at: _best(scan(at, widely=False))[1], cable.length, max(wanted))
    return DamperDesign(
        float(position), float(support_stiffness), modes, wanted, coefficient, ratios, margin, low, high, least
    )  # fmt: skip


def _best(curves: CubicSpline) -> tuple[float, float]:
    """log c and the value where the least of the curves is largest."""
    grid = curves.x
    top = int(np.argmax(curves(grid).min(axis=1)))
    bounds = grid[max(top - 1, 0)], grid[min(top + 1, len(grid) - 1)]
    at = _highest(lambda x: float(curves(x).min()), *bounds)
    return at, float(curves(at).min())


def _highest(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function of one hump is highest."""
    options = {"xatol": 1e-7}
    found = minimize_scalar(lambda x: -function(x), bounds=(low, high), method="bounded", options=options)
    return float(found.x)  # type: ignore[attr-defined]


def _range(curves: CubicSpline, best: float) -> tuple[float, float]:
    """log c to the left and right of the best one where the least of the curves falls to 1."""
    edges = []
    for grid in (curves.x[curves.x < best][::-1], curves.x[curves.x > best]):
        inside = best
        for x in grid:
            if curves(x).min() < 1.0:
                inside = float(brentq(lambda at: curves(at).min() - 1.0, inside, x))  # type: ignore[arg-type]
                break
            inside = x
        edges.append(float(inside))
    return edges[0], edges[1]


def _least_position(margin: Callable[[float], float], length: float, target: float) -> float:
    """The least position, m, with a margin of 1, looked for near twice the target times the length."""
    low, high = 1.2 * target * length, 2.2 * target * length
    while margin(low) >= 1.0:  # modes near L/2x
        low, high = low / 1.5, low
    while high < FARTHEST * length and margin(high) < 1.0:
        low, high = high, 1.3 * high
    if high >= FARTHEST * length and margin(high := FARTHEST * length) < 1.0:
        return inf
    return float(brentq(lambda at: margin(at) - 1.0, low, high, xtol=1e-5 * length))  # type: ignore[arg-type]
