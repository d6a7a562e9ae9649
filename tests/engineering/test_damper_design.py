"""Against Krenk's asymptote, sourced maxima, a soft support's factor, and the exact modes at the edges found."""

from math import inf, isnan, pi, sqrt

import numpy as np
import pytest

from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.damper_curve import damper_curve
from rainwind.engineering.damper_design import (
    best_damping,
    design_for,
    krenk_damping,
    optimum_coefficient,
    support_factor,
)
from rainwind.engineering.dampers import damped_modes
from rainwind.errors import InputError

approx = pytest.approx
LENGTH, MASS, TENSION = 168.403, 70.12, 3.55e6  # stay 22S of the Fred Hartman Bridge, second-hand
CABLE = Cable("22S", LENGTH, 0.2, MASS, TENSION, 0.5, 0.0, bending_stiffness=1e5)
UNIT = sqrt(TENSION * MASS)


def test_krenk_s_curve():
    position = 0.01 * LENGTH
    omega = pi / LENGTH * sqrt(TENSION / MASS)
    best = MASS * LENGTH * omega / (pi**2 * 3 * 0.01)  # kappa = 1/pi^2
    assert optimum_coefficient(CABLE, 3, position) == approx(best) == approx(UNIT / (pi * 3 * 0.01))
    assert krenk_damping(CABLE, 3, position, best) == approx(0.5 * 0.01)
    kappa = 2e5 / (MASS * LENGTH * omega) * 3 * 0.01
    x = pi**2 * kappa
    assert krenk_damping(CABLE, 3, position, 2e5) == approx(0.01 * x / (x**2 + 1))


@pytest.mark.parametrize(("place", "largest"), [(1e-4, 0.5), (0.01, 0.505), (0.02, 0.511)])
def test_the_largest_damping_of_mode_1(place: float, largest: float):
    # 0.505 and 0.511: solved from the single damper's equation; 1/2 in the limit
    coefficient, ratio = best_damping(CABLE, 1, place * LENGTH)
    assert ratio / place == approx(largest, abs=5e-4)
    assert coefficient == approx(UNIT / (pi * place), rel=1e-3)


def test_the_best_is_the_best():
    coefficient, ratio = best_damping(CABLE, 2, 5.0, 2e6, bending=True)

    def at(c: float) -> float:
        return damped_modes(CABLE, 2, [Damper(5.0, c, 2e6)], bending=True)[1].damping_ratio

    assert at(coefficient) == approx(ratio, rel=1e-9)
    assert max(at(0.98 * coefficient), at(1.02 * coefficient)) < ratio


@pytest.mark.parametrize("stiffness", [1e5, 1e6, 1e8])
def test_a_support_divides_damping_and_coefficient(stiffness: float):
    position = 0.002 * LENGTH
    factor = support_factor(CABLE, position, stiffness)
    assert factor == approx(1 + TENSION / (stiffness * position))
    coefficient, ratio = best_damping(CABLE, 1, position, stiffness)
    assert ratio == approx(0.5 * 0.002 / factor, rel=3e-3)
    assert coefficient == approx(UNIT / (pi * 0.002) / factor, rel=3e-3)
    exact = damped_modes(CABLE, 1, [Damper(position, 0.3 * coefficient, stiffness)])[0].damping_ratio
    assert krenk_damping(CABLE, 1, position, 0.3 * coefficient, stiffness) == approx(exact, rel=5e-3)


def test_a_curve_is_the_exact_modes_and_the_asymptote():
    over = np.geomspace(1e4, 1e6, 5)
    curve = damper_curve(CABLE, [3, 1], 4.0, over, 3e6)
    assert curve.ratios.shape == curve.asymptote.shape == (5, 2)
    for i, c in enumerate(over):
        modes = damped_modes(CABLE, 3, [Damper(4.0, c, 3e6)])
        assert curve.ratios[i] == approx([modes[2].damping_ratio, modes[0].damping_ratio], rel=1e-9)
        assert curve.asymptote[i, 1] == krenk_damping(CABLE, 1, 4.0, c, 3e6)
    far = damper_curve(CABLE, range(1, 21), 0.03 * LENGTH, over)  # past the mode that stops vibrating
    last = damped_modes(CABLE, 20, [Damper(0.03 * LENGTH, over[-1])])
    assert far.ratios[-1] == approx([mode.damping_ratio for mode in last], rel=1e-6)


@pytest.mark.parametrize("options", [{}, {"bending": True}, {"sag": True}])
def test_a_design_meets_its_targets_between_its_edges_and_not_beyond(options):
    targets = {1: 0.005, 2: 0.006, 3: 0.005}
    design = design_for(CABLE, targets, 4.0, 4e6, **options)

    def margin(c: float, position: float = 4.0) -> float:
        modes = damped_modes(CABLE, 3, [Damper(position, c, 4e6)], **options)
        return min(modes[n - 1].damping_ratio / target for n, target in targets.items())

    assert design.possible
    assert design.margin == approx(margin(design.coefficient))
    assert margin(design.low) == approx(1.0, abs=1e-4)
    assert margin(design.high) == approx(1.0, abs=1e-4)
    assert design.low < design.coefficient < design.high
    assert max(margin(design.coefficient * f) for f in (0.97, 1.03)) < design.margin
    # at the least position one coefficient just does, and a little nearer none
    there = design_for(CABLE, targets, design.least_position, 4e6, **options)
    assert there.margin == approx(1.0, abs=2e-4)
    assert design_for(CABLE, targets, 0.97 * design.least_position, 4e6, **options).margin < 1.0
    assert design.least_position < 4.0
    assert design.practice_positions == approx((1.5 * design.least_position, 2 * design.least_position))


def test_one_mode_needs_twice_its_ratio_of_the_length():
    # x/L = 2 zeta, the asymptotic limit
    design = design_for(CABLE, {1: 0.002}, 2.0)
    assert design.least_position / LENGTH == approx(2 * 0.002, rel=0.005)


def test_modes_1_and_n_meet_where_krenk_s_curves_cross():
    # X/(X^2+1) is equal at X and 1/X: c = sqrt(T m)/(pi a sqrt(n)), ratio a sqrt(n)/(n + 1)
    place = 0.002
    design = design_for(CABLE, {1: 0.001, 4: 0.001}, place * LENGTH)
    assert design.coefficient == approx(UNIT / (pi * place * 2), rel=0.01)
    assert design.margin == approx(place * 2 / 5 / 0.001, rel=0.01)


def test_what_cannot_be():
    design = design_for(CABLE, {1: 0.02}, 2.0)
    assert not design.possible
    assert isnan(design.low)
    assert isnan(design.high)
    assert design.least_position / LENGTH == approx(2 * 0.02, rel=0.06)
    assert design.ratios[0] == approx(best_damping(CABLE, 1, 2.0)[1], rel=1e-6)
    assert design_for(CABLE, {1: 0.1, 40: 0.1}, 2.0, 1e4).least_position == inf


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: design_for(CABLE, {}, 3.0), "no mode has a target"),
        (lambda: design_for(CABLE, {0: 0.01}, 3.0), "whole number"),
        (lambda: design_for(CABLE, {1: -0.01}, 3.0), "above 0"),
        (lambda: design_for(CABLE, {1: 0.5}, 3.0), "out of reach"),
        (lambda: design_for(CABLE, {1: 0.01}, 90.0), "nearer anchorage"),
        (lambda: best_damping(CABLE, 1, -1.0), "above 0"),
        (lambda: krenk_damping(CABLE, 1, 3.0, 0.0), "above 0"),
        (lambda: krenk_damping(CABLE, 1, 85.0, 1e5), "nearer anchorage"),
        (lambda: damper_curve(CABLE, [], 3.0, [1e5]), "one mode or more"),
        (lambda: damper_curve(CABLE, [1], 3.0, [1e5, 1e4]), "rise"),
        (lambda: damper_curve(CABLE, [1], 3.0, []), "rise"),
    ],
)
def test_bad_input(call, words: str):
    with pytest.raises(InputError, match=words):
        call()


@pytest.mark.parametrize(
    ("epsilon", "ends", "ratio", "stiffer"),
    [(1e-5, "clamped", 0.0148, 1.18), (1e-4, "clamped", 0.0138, 1.84), (1e-5, "pinned", 0.0164, 1.06)],
)
def test_what_bending_does_as_the_page_on_dampers_says(epsilon: float, ends, ratio: float, stiffer: float):
    cable = Cable("B", 100.0, 0.16, 60.0, 1.5e6, 0.5, 0.0, bending_stiffness=epsilon * 1.5e6 * 1e4)
    coefficient, found = best_damping(cable, 1, 3.0, bending=True, ends=ends)
    assert found == approx(ratio, abs=6e-5)
    assert coefficient / best_damping(cable, 1, 3.0)[0] == approx(stiffer, abs=6e-3)
