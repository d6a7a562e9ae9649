"""Tensioned beams: closed forms, an independent solution, an integration of the ODE, and a real stay."""

from math import cos, cosh, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_bvp

from rainwind.engineering.bending import wave_number
from rainwind.engineering.cable import Cable
from rainwind.engineering.modes import cable_mode, cable_modes
from rainwind.errors import InputError

from .galerkin_cable import wave_numbers


def stay(**changes):
    usual = {"diameter": 0.16, "mass": 80.0, "tension": 4e6, "inclination": pi / 2, "heading": 1.0}
    return Cable(**({"name": "a", "length": 80.0} | usual | changes))


@given(st.floats(0, 1e8), st.integers(1, 12))
def test_pinned_ends_are_exact_in_closed_form(stiffness, n):
    cable = stay(bending_stiffness=stiffness)
    expected = n**2 * 4e6 / (4 * 80 * 80**2) + n**4 * pi**2 * stiffness / (4 * 80 * 80**4)
    assert cable_mode(cable, n, ends="pinned").frequency_out ** 2 == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("ends", ["clamped", "pinned"])
@pytest.mark.parametrize("epsilon", [1e-4, 1e-3, 1e-1, 10.0])
def test_against_an_independent_solution(ends, epsilon):
    q = np.array([wave_number(n, epsilon, ends) for n in range(1, 8)])
    np.testing.assert_allclose(
        q * np.sqrt(1 + epsilon * q**2), wave_numbers(7, epsilon, 0.0, ends), rtol=1e-11
    )


@pytest.mark.parametrize("n", [1, 2, 3])
def test_against_an_integration_of_the_ode(n):
    epsilon = 2e-3

    def ode(x, state, w2):
        v, dv, ddv, dddv = state
        return np.array([dv, ddv, dddv, (ddv + w2[0] * v) / epsilon])

    def at_the_ends(left, right, w2):
        # clamped, and of a size: v'' = 1 at the lower end
        return np.array([left[0], left[1], right[0], right[1], left[2] - 1])

    xi = np.linspace(0, 1, 201)
    cable = stay(bending_stiffness=epsilon * 4e6 * 80**2)
    mode = cable_mode(cable, n)
    v = np.sin(n * pi * xi) * np.minimum(1, 20 * np.minimum(xi, 1 - xi))
    start = np.array([v, *(np.zeros((3, xi.size)))])
    for i in (1, 2, 3):
        start[i] = np.gradient(start[i - 1], xi)
    start /= start[2, 0]
    found = solve_bvp(ode, at_the_ends, xi, start, p=[(1.05 * n * pi) ** 2], tol=1e-9, max_nodes=20000)
    assert found.success
    w = 2 * pi * mode.frequency_out * cable.length / cable.wave_speed
    assert sqrt(found.p[0]) == pytest.approx(w, rel=1e-8)
    fine = np.linspace(0, 1, 20001)
    shape = found.sol(fine)[0]
    np.testing.assert_allclose(mode.at(fine), shape / np.max(np.abs(shape)), atol=1e-6)


def test_without_tension_it_is_the_clamped_beam():
    # cos(k) cosh(k) = 1: k = 4.7300, and w² = epsilon k⁴
    q = wave_number(1, 1e7)
    assert q == pytest.approx(4.730041, rel=1e-6)
    assert cos(q) * cosh(q) == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("xi", [100.0, 200.0, 400.0])
def test_morse_s_approximation_for_tight_cables(n, xi):
    # f_n = f_string (1 + 2/xi + (4 + n² pi² / 2) / xi²), xi = L sqrt(T / EI); what it leaves out is of order xi^-3
    q = wave_number(n, xi**-2)
    exact = q * sqrt(1 + q**2 / xi**2) / (n * pi)
    morse = 1 + 2 / xi + (4 + n**2 * pi**2 / 2) / xi**2
    assert exact == pytest.approx(morse, abs=5 * (4 + n**2 * pi**2 / 2) / xi**3)
    assert abs(exact - 1) > 10 * abs(exact - morse)


@given(st.floats(1e-14, 1e-2), st.integers(1, 9))
def test_ends_that_are_held_raise_the_frequency(epsilon, n):
    assert n * pi < wave_number(n, epsilon) < (n + 1) * pi


def test_a_string_is_the_limit():
    for n in (1, 2, 5):
        assert wave_number(n, 0.0) == wave_number(n, 1e-25) == n * pi
        # 2 sqrt(epsilon) to first order
        for epsilon in (1e-20, 1e-12, 1e-8):
            assert wave_number(n, epsilon) / (n * pi) - 1 == pytest.approx(
                2 * sqrt(epsilon), rel=1e-3, abs=1e-15
            )


def test_stavanger_s_tension_and_bending_stiffness_from_its_frequencies():
    """Nine measured modes of stay C1E, second-hand (J. Sound Vib. 503, 116106): what they say of T and EI.

    (f / n)² = T / (4 m L²) + EI pi² n² / (4 m L⁴). A solid bar of steel, 79 mm,
    has EI = 4.0e5 Nm², a locked coil less.
    """
    measured = np.array([1.03, 2.08, 3.10, 4.15, 5.13, 6.16, 7.32, 8.30, 9.30])
    n, length, mass = np.arange(1, 10), 98.3, 40.0
    (slope, first), covariance = np.polyfit(n**2, (measured / n) ** 2, 1, cov=True)
    to_stiffness = 4 * mass * length**4 / pi**2
    stiffness, deviation = slope * to_stiffness, sqrt(covariance[0, 0]) * to_stiffness
    solid = 210e9 * pi * 0.079**4 / 64
    # less than a standard deviation from none: these frequencies cannot tell EI from 0, nor from a solid bar's
    assert 0 < stiffness < deviation < solid
    cable = stay(length=length, mass=mass, tension=first * 4 * mass * length**2, bending_stiffness=stiffness)
    fitted = [mode.frequency_out for mode in cable_modes(cable, 9, ends="pinned")]
    # scattered by 1 %, as f / n is; the tension is 3 % below that of the string with 1.05 Hz
    assert fitted == pytest.approx(measured, rel=0.011)
    assert cable.tension == pytest.approx(1.65e6, rel=0.005)


@pytest.mark.parametrize("mode", [0, 2.0, True])
def test_bad_numbers(mode):
    with pytest.raises(InputError, match="whole number"):
        wave_number(mode, 0.0)
