"""The observed cases once more with another rivulet: what of the disagreement comes from the rule for its size.

Small vibrations only, none is followed in time: a few seconds for all cases.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from rainwind.engineering.answers import Band
from rainwind.engineering.equivalent_section import section_model
from rainwind.engineering.inflow import beta, normal_factor, yaw
from rainwind.engineering.linear_stability import damping_needed, growth
from rainwind.engineering.modes import cable_modes
from rainwind.engineering.observed import Observed, observed_cases
from rainwind.engineering.rivulets import RIVULET_SCATTER, factors_at, sample_factors, usual_rivulet
from rainwind.engineering.upper_rivulet import upper_rivulets, wind_speed_normal
from rainwind.engineering.vibration_ranges import unstable_ranges
from rainwind.engineering.wind_profile import mode_factor
from rainwind.physics.rivulet import Rivulet
from rainwind.studies.field_comparison import DIRECTIONS, SAMPLES, SETS, TOP

__all__ = ["ONE_SIZE", "SmallVibrations", "one_size", "small_vibrations"]

ONE_SIZE = Rivulet(mass=0.2, height=0.01, friction=0.05)
"""That of Peil & Nahrath (2003), section 3 (read), here on a stay of any diameter."""
_SPEEDS = 64
_BOTTOM = 3.0


@dataclass(frozen=True)
class SmallVibrations:
    """Of one mode: where they begin and end in any direction (m/s), and the damping ratios that stop them.

    needed_observed: at the observed speeds only. open: share of samples unstable at the highest speed looked at.
    """

    case: Observed
    mode: int
    onset: Band
    end: Band
    open: float
    needed_observed: Band
    needed: Band


def one_size() -> tuple[tuple[SmallVibrations, SmallVibrations], ...]:
    """Of the first and the last mode of each case: by the rule for the diameter, and with `ONE_SIZE`."""
    return tuple(
        (
            small_vibrations(case, mode),
            small_vibrations(case, mode, ONE_SIZE),
        )
        for case in observed_cases()
        for mode in sorted({1, case.modes})
    )


def small_vibrations(case: Observed, number: int, rivulet: Rivulet | None = None) -> SmallVibrations:
    """As an assessment finds them; with a rivulet in place of that by the rule, where one is given."""
    cable = case.cable
    by_rule = rivulet is None
    rivulet = rivulet or usual_rivulet(cable.diameter)
    mode = cable_modes(cable, number)[number - 1]
    factors = factors_at(sample_factors(RIVULET_SCATTER, SAMPLES, 1), cable.diameter if by_rule else None)
    (name,) = SETS
    model = section_model(
        cable,
        mode,
        coefficients=name,
        rivulet=rivulet,
        damping_ratio=cable.damping_ratio(number),
        density=case.site.density,
    )
    many = 4 if cable.heading else DIRECTIONS
    gamma = np.unique(np.round(yaw(2 * pi * np.arange(many) / many, cable.heading), 12))
    speed, weight = np.geomspace(_BOTTOM, TOP, _SPEEDS), mode_factor(cable, mode, case.site)
    branches = upper_rivulets(model, factors, beta(gamma, cable.inclination))
    found = growth(model, factors, branches, gamma, weight * speed)
    mass = factors["rivulet.mass"][:, None] * rivulet.mass
    onset = wind_speed_normal(model, branches.onset, mass) / normal_factor(gamma, cable.inclination)
    low, high, opened = unstable_ranges(found.rate, speed, onset / weight)
    there = np.isfinite(found.rate)
    seen = (speed >= case.speeds[0]) & (speed <= case.speeds[1])
    return SmallVibrations(
        case,
        number,
        Band.of(np.fmin.reduce(low, axis=1)),
        Band.of(np.fmax.reduce(high, axis=1)),
        float(opened.any(axis=1).mean()),
        Band.of(damping_needed(found, there & seen)[0]),
        Band.of(damping_needed(found, there)[0]),
    )
