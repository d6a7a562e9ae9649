"""Without wind, the energy of cable and rivulet falls by friction alone."""

from math import pi

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from rainwind.physics import CableSection, Rivulet, RivuletModel, Wind, load_coefficients
from rainwind.physics import energy as energy_module


def still_air(degrees_of_freedom):
    section = CableSection(
        mass=30.0, frequency_z=1.3, damping_ratio_y=0.01, k2_y=40.0, k3_y=300.0, k2_z=-60.0, k3_z=200.0
    )
    return RivuletModel(
        Wind(9.0, yaw=0.7, density=0.0),
        section,
        Rivulet(mass=0.8, friction=0.09),
        load_coefficients("reconstructed"),
        degrees_of_freedom=degrees_of_freedom,
    )


MODELS = {n: still_air(n) for n in (2, 3)}


def energy_gradient(model, x):
    """T + V by its definition, and its derivatives by a complex step: exact to rounding."""
    s, m_r = model.section, model.rivulet.mass
    r = (s.diameter + model.rivulet.height) / 2
    beta = np.arctan(np.tan(model.wind.yaw) * np.sin(s.inclination))
    k_y, k_z = (s.mass * (2 * pi * f) ** 2 for f in (s.frequency_y, s.frequency_z))

    def energy(state):
        y, phi, z, y_dot, phi_dot, z_dot = state
        rivulet_y, rivulet_z = y_dot + r * np.sin(phi) * phi_dot, z_dot - r * np.cos(phi) * phi_dot
        kinetic = s.mass * (y_dot**2 + z_dot**2) / 2 + m_r * (rivulet_y**2 + rivulet_z**2) / 2
        springs = k_y * y**2 / 2 + s.k2_y * y**3 / 3 + s.k3_y * y**4 / 4
        springs += k_z * z**2 / 2 + s.k2_z * z**3 / 3 + s.k3_z * z**4 / 4
        return kinetic + springs + m_r * 9.81 * np.cos(s.inclination) * r * np.cos(phi + beta)

    return np.array([energy(x + 1e-30j * e).imag / 1e-30 for e in np.eye(6)])


limits = (0.5, 7.0, 0.5, 3.0, 10.0, 3.0)


@given(st.tuples(*(st.floats(-limit, limit) for limit in limits)))
def test_power_of_three_degrees_of_freedom(state):
    model, x = MODELS[3], np.array(state)
    power = energy_gradient(model, x) @ np.array(model.rhs(x, model.parameters))
    d_y, d_z = (2 * xi * 30.0 * 2 * pi * f for xi, f in ((0.01, 1.0), (0.002, 1.3)))
    lost = d_y * x[3] ** 2 + d_z * x[5] ** 2 + 0.09 * x[4] ** 2
    assert power == pytest.approx(-lost, rel=1e-9, abs=1e-9)


@given(st.tuples(*(st.floats(-limit, limit) for limit in limits)))
def test_power_of_two_degrees_of_freedom(state):
    model, x = MODELS[2], np.array(state)
    x[[2, 5]] = 0.0
    rates = np.array(model.rhs(x[[0, 1, 3, 4]], model.parameters))
    gradient = energy_gradient(model, x)[[0, 1, 3, 4]]
    lost = 2 * 0.01 * 30.0 * 2 * pi * x[3] ** 2 + 0.09 * x[4] ** 2
    assert gradient @ rates == pytest.approx(-lost, rel=1e-9, abs=1e-9)


# ---- the model's own energy and powers


def windy(degrees_of_freedom, outside="extend"):
    still = still_air(degrees_of_freedom)
    wind = Wind(11.0, yaw=0.7, vertical_speed=0.4)
    return RivuletModel(
        wind,
        still.section,
        still.rivulet,
        still.coefficients,
        outside,
        degrees_of_freedom,
        relative_speed="full",
    )


def test_lagranges_equations_of_this_energy_are_the_model(monkeypatch):
    """d/dt dL/dq' - dL/dq = forces, with L = T - V by SymPy: the accelerations of eq. (4), and nothing else."""
    monkeypatch.setattr(energy_module, "sin", sympy.sin)
    monkeypatch.setattr(energy_module, "cos", sympy.cos)
    model = windy(3)
    at = model.letters(model.parameters)
    q, v, a = sympy.symbols("y phi z"), sympy.symbols("v_y v_phi v_z"), sympy.symbols("a_y a_phi a_z")
    parts = energy_module.energy_parts(at, (*q, *v))
    lagrangian = parts["kinetic"] - parts["elastic"] - parts["gravity"]
    inertia = []
    for i in range(3):
        momentum = sympy.diff(lagrangian, v[i])
        rate = sum(sympy.diff(momentum, q[j]) * v[j] + sympy.diff(momentum, v[j]) * a[j] for j in range(3))
        inertia.append(rate - sympy.diff(lagrangian, q[i]))
    evaluate = sympy.lambdify([*q, *v, *a], inertia, modules="math")
    rng = np.random.default_rng(4)
    for x in rng.uniform(-1.0, 1.0, (20, 6)) * limits:
        accelerations = model.rhs(x, model.parameters)[3:]
        f_y, f_z, m_phi = model.wind_forces(x, model.parameters)
        damped = [f_y - at.d_y * x[3], m_phi - at.d_phi * x[4], f_z - at.d_z * x[5]]
        assert evaluate(*x, *accelerations) == pytest.approx(damped, rel=1e-9, abs=1e-9)


@given(st.sampled_from([2, 3]), st.tuples(*(st.floats(-limit, limit) for limit in limits)))
def test_powers_are_the_rate_of_the_energy(degrees_of_freedom, state):
    model = windy(degrees_of_freedom)
    x = np.array(state)
    if degrees_of_freedom == 2:
        x = x[[0, 1, 3, 4]]
    p, step = model.parameters, 1e-30j
    gradient = [model.energy(x + step * e, p).imag / 1e-30 for e in np.eye(x.size)]
    rate = np.dot(gradient, np.array(model.rhs(x, p)))
    powers = model.powers(x, p)
    assert set(powers) == {"wind", "cable damping", "rivulet friction"}
    assert powers["cable damping"] <= 0.0
    assert powers["rivulet friction"] <= 0.0
    assert rate == pytest.approx(sum(powers.values()), rel=1e-9, abs=1e-8)


@pytest.mark.parametrize("outside", ["extend", "refuse", "blend"])
def test_the_margin_is_positive_exactly_where_the_angle_is_valid(outside):
    model = windy(3, outside)
    value, margin = model.limits["angle of attack"]
    low, high = model.coefficients.valid
    for phi in np.linspace(-7.0, 7.0, 141):
        x = np.array([0.1, phi, 0.0, 0.3, 0.5, -0.2])
        alpha = value(x, model.parameters)
        inside = low <= alpha <= high
        if outside == "blend":
            inside = any(low <= alpha + 2 * pi * k <= high for k in range(-3, 4))
        assert (margin(x, model.parameters) > 0) == inside
