"""The coupled cubic stiffness against the length of the curve that the stay takes."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from rainwind.engineering.bending import bending_parameter
from rainwind.engineering.cable import Cable
from rainwind.engineering.modes import cable_mode
from rainwind.engineering.nonlinear_stiffness import cubic_stiffness, sine_sag_offset
from rainwind.engineering.sag import lambda_squared, mid_span_sag

CABLE = Cable("a", 300.0, 0.16, 80.0, 4e6, 0.5, 1.0, axial_stiffness=1.6e9)


def section_energy(cable, number, v, w):
    """k3 (s v + (v² + w²) / 2)² with the offset of a sine, J per metre."""
    return cubic_stiffness(cable, number) * (sine_sag_offset(cable, number) * v + (v * v + w * w) / 2) ** 2


def strain(cable, number, v, w, exact):
    """Mean strain by quadrature of the curve (x, sag + v sin, w sin), down in plane: to second order, or its length."""
    length, sag = cable.length, mid_span_sag(cable)

    def longer(xi):
        # slopes per length; the parabola 4 sag xi (1 - xi) hangs down
        before = 4 * sag * (1 - 2 * xi) / length
        added = number * pi / length * np.cos(number * pi * xi)
        if exact:
            return sqrt(1 + (before + v * added) ** 2 + (w * added) ** 2) - sqrt(1 + before**2)
        return before * v * added + (v * v + w * w) * added**2 / 2

    return quad(longer, 0, 1, epsabs=1e-15, epsrel=1e-12, limit=200)[0]


@pytest.mark.parametrize("number", [1, 2, 3, 5])
@pytest.mark.parametrize(("v", "w"), [(0.4, 0.0), (-0.4, 0.3), (0.0, 0.7), (-6.0, 2.0)])
def test_the_section_s_energy_is_that_of_the_strain(number, v, w):
    # EA e² L / 2 of the whole stay, over its modal length L / 2
    expected = CABLE.estimated_axial_stiffness * strain(CABLE, number, v, w, exact=False) ** 2
    assert section_energy(CABLE, number, v, w) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("number", [1, 2, 3])
@pytest.mark.parametrize(("v", "w"), [(0.4, 0.0), (-0.4, 0.3), (0.0, 0.7)])
def test_it_holds_for_the_length_of_the_curve_itself(number, v, w):
    # what is left out is of the order of slope²: 1e-4 here, twice in the square
    expected = CABLE.estimated_axial_stiffness * strain(CABLE, number, v, w, exact=True) ** 2
    assert section_energy(CABLE, number, v, w) == pytest.approx(expected, rel=2e-3)


@given(st.floats(1e-3, 3.0), st.sampled_from([1, 3]))
@settings(max_examples=40)
def test_the_offset_for_exact_frequencies_is_a_sine_s_to_first_order(lambda2, number):
    one = replace(CABLE, axial_stiffness=1.0)
    cable = replace(CABLE, axial_stiffness=lambda2 / lambda_squared(one))
    ratio = cable_mode(cable, number).sag_offset / sine_sag_offset(cable, number)
    # second order of perturbation: -lambda² 8 / pi⁴ times the sum of 1 / (k² (k² - n²)) over the other odd k, 0.01
    # at most, so that its square is the third; and L_e for L in lambda² but not in the sine's strain
    others = [k for k in range(1, 4001, 2) if k != number]
    second = 8 / pi**4 * sum(1 / (k**2 * (k**2 - number**2)) for k in others)
    effective = lambda_squared(one) * 4e6 / (80 * 9.81 * 300 * np.cos(0.5) / 4e6) ** 2
    assert ratio**2 == pytest.approx(
        (1 - lambda2 * second) * effective, abs=2 * (0.0103 * lambda2) ** 2 + 1e-9
    )


def test_antisymmetric_modes_have_no_offset():
    for number in (2, 4):
        assert sine_sag_offset(CABLE, number) == cable_mode(CABLE, number).sag_offset == 0.0


def test_the_first_mode_s_offset_is_about_the_sag():
    assert sine_sag_offset(CABLE, 1) == pytest.approx(32 / pi**3 * mid_span_sag(CABLE), rel=1e-12)


@pytest.mark.parametrize("number", [1, 2])
def test_clamped_ends_raise_the_cubic_stiffness_by_little(number):
    """k3 = EA (integral of v'²)² / (2 L⁴ integral of v²) of any shape, lengths in units of L.

    A clamped end of a tight cable is slope (x - a + a exp(-x / a)) with a = sqrt(epsilon). To first order the
    integral of v'² is a sine's and that of v² shorter by 2 a: k3 is larger by 2 a, 1 % here.
    """
    a = 1 / 200
    cable = replace(CABLE, inclination=pi / 2, bending_stiffness=CABLE.tension * (CABLE.length * a) ** 2)
    assert sqrt(bending_parameter(cable)) == pytest.approx(a)
    xi = np.linspace(0, 1, 40001)
    v = cable_mode(cable, number).at(xi)
    slope, square = np.gradient(v, xi), np.trapezoid(v * v, xi)
    found = 1.6e9 * np.trapezoid(slope * slope, xi) ** 2 / (2 * CABLE.length**4 * square)
    assert found / cubic_stiffness(cable, number) == pytest.approx(1 + 2 * a, abs=10 * number**2 * a**2)
