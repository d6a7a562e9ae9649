"""The observed cases at both ends of the rule for the rivulet: what of the disagreement comes from the rule.

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
from rainwind.engineering.rivulets import RIVULET_SCATTER, SIZE, factors_at, sample_factors, usual_rivulet
from rainwind.engineering.upper_rivulet import upper_rivulets, wind_speed_normal
from rainwind.engineering.vibration_ranges import unstable_ranges
from rainwind.engineering.wind_profile import mode_factor
from rainwind.studies.field_comparison import DIRECTIONS, SAMPLES, SETS, TOP

__all__ = ["ONE_SHAPE", "ONE_SIZE", "SmallVibrations", "Three", "small_vibrations", "three_rules"]

ONE_SIZE, ONE_SHAPE = 0.0, 2.0
"""Both ends of the exponent with which a rivulet's mass goes with the diameter."""
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


Three = tuple[SmallVibrations, SmallVibrations, SmallVibrations]
"""By the rule, with a rivulet of one size, with one of one shape."""


def three_rules() -> tuple[Three, ...]:
    """Of the first and the last mode of each case."""
    return tuple(
        (
            small_vibrations(case, mode),
            small_vibrations(case, mode, ONE_SIZE),
            small_vibrations(case, mode, ONE_SHAPE),
        )
        for case in observed_cases()
        for mode in sorted({1, case.modes})
    )


def small_vibrations(case: Observed, number: int, exponent: float | None = None) -> SmallVibrations:
    """As an assessment finds them; exponent: in all samples, in place of the scattered one of the rule."""
    cable = case.cable
    rivulet = usual_rivulet(cable.diameter)
    samples = dict(sample_factors(RIVULET_SCATTER, SAMPLES, 1))
    if exponent is not None:
        samples[SIZE] = np.full(SAMPLES, exponent)
    factors = factors_at(samples, cable.diameter)
    mode = cable_modes(cable, number)[number - 1]
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
