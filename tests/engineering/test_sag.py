"""Irvine's equation: its residual, its limits, and an independent solution with bending."""

from math import pi, radians, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from rainwind.engineering.bending import wave_number
from rainwind.engineering.cable import Cable
from rainwind.engineering.modes import cable_mode, cable_modes
from rainwind.engineering.sag import (
    CROSSOVER,
    lambda_squared,
    mid_span_sag,
    sagging_wave_number,
)
from rainwind.errors import InputError

from .galerkin_cable import wave_numbers


def stay(**changes):
    usual = {"diameter": 0.16, "mass": 80.0, "tension": 4e6, "inclination": 0.5, "heading": 1.0}
    return Cable(**({"name": "a", "length": 300.0, "axial_stiffness": 1.6e9} | usual | changes))


@given(st.floats(1e-6, 1e4), st.sampled_from([1, 3, 5, 7]))
def test_irvine_s_equation_holds(lambda2, mode):
    w = sagging_wave_number(mode, lambda2)
    half = w / 2
    # multiplied by cos(w / 2): no pole
    residual = np.sin(half) - np.cos(half) * (half - 4 / lambda2 * half**3)
    assert abs(residual) < 1e-12 * (half + 4 / lambda2 * half**3)
    assert mode * pi <= w < (mode + 2) * pi


@pytest.mark.parametrize("mode", [1, 3, 5])
def test_without_sag_it_is_a_string_and_stays_the_same_mode(mode):
    assert sagging_wave_number(mode, 0.0) == mode * pi
    # first order in lambda²: w² = (n pi)² + 8 lambda² / (n pi)²
    for lambda2 in (1e-4, 1e-3, 1e-2):
        rise = sagging_wave_number(mode, lambda2) ** 2 - (mode * pi) ** 2
        assert rise == pytest.approx(8 * lambda2 / (mode * pi) ** 2, rel=1e-4)
    # so little that rounding hides it
    assert sagging_wave_number(mode, 1e-14) == mode * pi


@pytest.mark.parametrize("mode", [1, 3, 5])
def test_an_inextensible_cable_s_modes_are_the_roots_of_tan(mode):
    root = 2 * brentq(lambda h: np.sin(h) - h * np.cos(h), (mode + 1) * pi / 2, (mode + 2) * pi / 2 - 1e-9)
    assert sagging_wave_number(mode, 1e9) == pytest.approx(root, rel=1e-7)
    if mode == 1:
        assert root / pi == pytest.approx(2.86, abs=1e-3)


def test_at_the_crossover_the_first_two_frequencies_are_equal():
    assert sagging_wave_number(1, CROSSOVER) == pytest.approx(2 * pi, rel=1e-14)
    assert sagging_wave_number(1, 1.01 * CROSSOVER) > 2 * pi > sagging_wave_number(1, 0.99 * CROSSOVER)


@given(st.floats(0.0, 10.0))
def test_the_usual_approximation(lambda2):
    ratio = sagging_wave_number(1, lambda2) / pi
    assert sqrt(1 + 8 * lambda2 / pi**4) == pytest.approx(ratio, rel=3.5e-3)


@given(st.floats(0, 500), st.floats(0, 100), st.sampled_from([1, 3, 5]))
def test_more_sag_never_lowers(lambda2, more, mode):
    assert sagging_wave_number(mode, lambda2 + more) >= sagging_wave_number(mode, lambda2) - 1e-13


@pytest.mark.parametrize("ends", ["clamped", "pinned"])
@pytest.mark.parametrize("epsilon", [1e-4, 1e-2, 1.0])
@pytest.mark.parametrize("lambda2", [0.0, 1.5, 30.0, 400.0])
def test_with_bending_against_an_independent_solution(ends, epsilon, lambda2):
    odd = [sagging_wave_number(n, lambda2, epsilon, ends) for n in (1, 3, 5)]
    q = np.array([*odd, *(wave_number(n, epsilon, ends) for n in (2, 4, 6))])
    w = np.sort(q * np.sqrt(1 + epsilon * q**2))
    # the four lowest: mode 5 may have passed mode 6
    np.testing.assert_allclose(w[:4], wave_numbers(4, epsilon, lambda2, ends), rtol=1e-11)


def test_a_small_bending_stiffness_is_none():
    for lambda2 in (0.0, 1.0, 60.0):
        for mode in (1, 3):
            string = sagging_wave_number(mode, lambda2)
            assert sagging_wave_number(mode, lambda2, 1e-18) == pytest.approx(string, rel=1e-8)
            assert sagging_wave_number(mode, lambda2, 1e-25) == string
            assert sagging_wave_number(mode, lambda2, 1e-6, "pinned") == pytest.approx(string, rel=1e-4)


def test_lambda_squared_and_sag_by_hand():
    cable = stay(inclination=radians(60))
    weight = 80 * 9.81 * 300 / 2
    assert mid_span_sag(cable) == pytest.approx(weight * 300 / (8 * 4e6), rel=1e-12)
    # the length of the parabola beyond its chord, by quadrature: L_e is that of (ds/dx)³
    ratio = weight / 4e6
    slope = ratio * 0.5
    effective = quad(lambda xi: (1 + (slope * (1 - 2 * xi)) ** 2) ** 1.5, 0, 1)[0]
    expected = ratio**2 * 1.6e9 / 4e6 / effective
    assert lambda_squared(cable) == pytest.approx(expected, rel=1e-5)
    assert lambda_squared(stay(inclination=pi / 2)) == pytest.approx(0.0, abs=1e-25)


@given(st.floats(0.0, 300.0), st.sampled_from([1, 3, 5]))
def test_the_shape_obeys_the_equation(lambda2, number):
    cable = stay(axial_stiffness=max(lambda2 / lambda_squared(stay(axial_stiffness=1.0)), 1e-9))
    mode = cable_mode(cable, number)
    w = 2 * pi * mode.frequency_in * cable.length / cable.wave_speed
    h = 1e-4
    for xi in (0.1, 0.37, 0.5):
        bent = (mode.at(xi + h) - 2 * mode.at(xi) + mode.at(xi - h)) / h**2
        left = -bent + lambda_squared(cable) * mode.shape.mean
        assert left == pytest.approx(w**2 * mode.at(xi), abs=1e-4 * w**2)


def test_beyond_the_crossover_the_number_stays():
    cable = stay(axial_stiffness=1.2 * CROSSOVER / lambda_squared(stay(axial_stiffness=1.0)))
    first, second = cable_modes(cable, 2)
    assert first.frequency_in > second.frequency_in
    assert first.frequency_out < second.frequency_out
    # its shape then has two nodes, as Irvine says
    inner = first.at(np.linspace(0.001, 0.999, 999))
    assert np.sum(np.diff(np.sign(inner)) != 0) == 2


@pytest.mark.parametrize(("mode", "lambda2"), [(2, 1.0), (0, 1.0), (1, -1.0), (1, float("nan"))])
def test_bad_input(mode, lambda2):
    with pytest.raises(InputError):
        sagging_wave_number(mode, lambda2)
