"""Eq. (4) derived anew from T and V with SymPy, and compared with the model's right-hand side."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from rainwind.physics import CableSection, Rivulet, RivuletModel, Wind, load_coefficients

T = sp.Symbol("t")
Y, PHI, Z = (sp.Function(name)(T) for name in ("y", "phi", "z"))
M_S, M_R, R, BETA, G_COS = sp.symbols("m_s m_r r beta g_cos", positive=True)
K_Y, K_Y2, K_Y3, K_Z, K_Z2, K_Z3, D_Y, D_Z, D_PHI = sp.symbols("k_y k_y2 k_y3 k_z k_z2 k_z3 d_y d_z d_phi")
F_Y, F_Z, M_PHI = sp.symbols("F_y F_z M_phi")
LETTERS = (M_S, M_R, R, BETA, G_COS, K_Y, K_Y2, K_Y3, K_Z, K_Z2, K_Z3, D_Y, D_Z, D_PHI, F_Y, F_Z, M_PHI)

MODEL = RivuletModel(
    Wind(11.0, yaw=0.6, density=1.3),
    CableSection(
        diameter=0.12,
        mass=40.0,
        frequency_y=0.9,
        frequency_z=1.2,
        damping_ratio=0.004,
        damping_ratio_z=0.007,
        inclination=0.5,
        k2_y=31.0,
        k3_y=170.0,
        k2_z=-43.0,
        k3_z=90.0,
    ),
    Rivulet(mass=0.9, height=0.02, friction=0.07),
    load_coefficients("reconstructed"),
)


def accelerations(q):
    """Lagrange's equations of the coordinates q, the others held at zero: mass matrix and right side."""
    held = {other: 0 for other in (Y, PHI, Z) if other not in q}
    y, phi, z = (sp.sympify(c).subs(held) for c in (Y, PHI, Z))
    y_r, z_r = y - R * sp.cos(phi), z - R * sp.sin(phi)
    kinetic = M_S * (y.diff(T) ** 2 + z.diff(T) ** 2) / 2 + M_R * (y_r.diff(T) ** 2 + z_r.diff(T) ** 2) / 2
    potential = (
        K_Y * y**2 / 2 + K_Y2 * y**3 / 3 + K_Y3 * y**4 / 4
        + K_Z * z**2 / 2 + K_Z2 * z**3 / 3 + K_Z3 * z**4 / 4
        + M_R * G_COS * R * sp.cos(phi + BETA)
    )  # fmt: skip
    force = {Y: F_Y - D_Y * Y.diff(T), PHI: M_PHI - D_PHI * PHI.diff(T), Z: F_Z - D_Z * Z.diff(T)}
    lagrangian = kinetic - potential
    rows = [lagrangian.diff(c.diff(T)).diff(T) - lagrangian.diff(c) - force[c] for c in q]
    seconds = [c.diff(T, 2) for c in q]
    matrix, right = sp.linear_eq_to_matrix([sp.expand(row) for row in rows], seconds)
    return matrix, right


def compiled(q):
    """numbers of (states in the model's order, letters) -> the derivatives of the rates."""
    matrix, right = accelerations(q)
    rates = [sp.Symbol(f"rate_{i}") for i in range(len(q))]
    places = [sp.Symbol(f"place_{i}") for i in range(len(q))]
    swap = [(c.diff(T), v) for c, v in zip(q, rates, strict=True)]
    swap += list(zip(q, places, strict=True))
    arguments = (*places, *rates, *LETTERS)
    return sp.lambdify(arguments, matrix.subs(swap)), sp.lambdify(arguments, right.subs(swap))


DERIVED = {3: compiled((Y, PHI, Z)), 2: compiled((Y, PHI))}


def letters_by_hand(model):
    """The letters of the derivation from the dataclasses, without `model.letters`."""
    gamma, delta, s = model.wind.yaw, model.section.inclination, model.section
    xi_y = s.damping_ratio if s.damping_ratio_y is None else s.damping_ratio_y
    xi_z = s.damping_ratio if s.damping_ratio_z is None else s.damping_ratio_z
    w_y, w_z = 2 * pi * s.frequency_y, 2 * pi * s.frequency_z
    return (
        s.mass,
        model.rivulet.mass,
        (s.diameter + model.rivulet.height) / 2,
        np.arctan(np.tan(gamma) * np.sin(delta)),
        9.81 * np.cos(delta),
        s.mass * w_y**2,
        s.k2_y,
        s.k3_y,
        s.mass * w_z**2,
        s.k2_z,
        s.k3_z,
        2 * xi_y * s.mass * w_y,
        2 * xi_z * s.mass * w_z,
        model.rivulet.friction,
    )


def wind_forces_by_hand(model, phi, y_dot, phi_dot, z_dot):
    """Eqs. (2) and (3) as printed, with arctan."""
    gamma, delta, d = model.wind.yaw, model.section.inclination, model.section.diameter
    r = (d + model.rivulet.height) / 2
    u = model.wind.speed * np.sqrt(np.cos(gamma) ** 2 + np.sin(gamma) ** 2 * np.sin(delta) ** 2)
    a_v = np.arctan((y_dot + r * phi_dot * np.sin(phi)) / (u - z_dot + r * phi_dot * np.cos(phi)))
    c_l, c_d, c_m = model.coefficients.at(-phi + a_v, model.outside)
    rho = model.wind.density
    return (
        -rho / 2 * d * u**2 * (c_l * np.cos(a_v) + c_d * np.sin(a_v)),
        rho / 2 * d * u**2 * (-c_l * np.sin(a_v) + c_d * np.cos(a_v)),
        rho / 2 * d**2 * u**2 * c_m,
    )


def small(limit):
    return st.floats(-limit, limit, allow_nan=False)


@given(small(0.5), small(4), small(0.5), small(2), small(9), small(2))
def test_three_degrees_of_freedom_obey_lagrange(y, phi, z, y_dot, phi_dot, z_dot):
    forces = wind_forces_by_hand(MODEL, phi, y_dot, phi_dot, z_dot)
    numbers = (y, phi, z, y_dot, phi_dot, z_dot, *letters_by_hand(MODEL), *forces)
    matrix, right = DERIVED[3]
    expected = np.linalg.solve(matrix(*numbers), right(*numbers)).ravel()
    x_dot = MODEL.rhs((y, phi, z, y_dot, phi_dot, z_dot), MODEL.parameters)
    np.testing.assert_allclose(x_dot[:3], (y_dot, phi_dot, z_dot), rtol=0, atol=0)
    np.testing.assert_allclose(x_dot[3:], expected, rtol=1e-9, atol=1e-8)


@given(small(0.5), small(4), small(2), small(9))
def test_two_degrees_of_freedom_obey_lagrange(y, phi, y_dot, phi_dot):
    model = replace(MODEL, degrees_of_freedom=2)
    forces = wind_forces_by_hand(model, phi, y_dot, phi_dot, 0.0)
    numbers = (y, phi, y_dot, phi_dot, *letters_by_hand(model), *forces)
    matrix, right = DERIVED[2]
    expected = np.linalg.solve(matrix(*numbers), right(*numbers)).ravel()
    x_dot = model.rhs((y, phi, y_dot, phi_dot), model.parameters)
    np.testing.assert_allclose(x_dot[:2], (y_dot, phi_dot), rtol=0, atol=0)
    np.testing.assert_allclose(x_dot[2:], expected, rtol=1e-9, atol=1e-8)


def test_mass_matrix_is_that_of_the_paper():
    """The factors of the second derivatives in eq. (4), printed there."""
    matrix, _ = accelerations((Y, PHI, Z))
    s, c = M_R * R * sp.sin(PHI), M_R * R * sp.cos(PHI)
    paper = sp.Matrix([[M_S + M_R, s, 0], [s, M_R * R**2, -c], [0, -c, M_S + M_R]])
    assert sp.simplify(matrix - paper) == sp.zeros(3)


def test_determinant_by_hand():
    """rhs divides by m_R r² m_S / (m_S + m_R), which is the determinant over (m_S + m_R)²."""
    matrix, _ = accelerations((Y, PHI, Z))
    by_hand = M_R * R**2 * M_S / (M_S + M_R)
    assert sp.simplify(matrix.det() - by_hand * (M_S + M_R) ** 2) == 0


def test_the_letters_hold_beyond_ninety_degrees_of_yaw():
    model = MODEL.with_parameters({"wind.yaw": 2.5})
    s, c = np.sin(2.5) * np.sin(0.5), np.cos(2.5)
    assert model.normal_speed == pytest.approx(11.0 * np.hypot(s, c), rel=1e-14)
    assert np.sin(model.beta) == pytest.approx(s / np.hypot(s, c), rel=1e-14)
    assert np.cos(model.beta) == pytest.approx(c / np.hypot(s, c), rel=1e-14)


def test_rhs_takes_every_parameter_from_p():
    """Moving any one parameter in p, not in the model, moves the result as with_parameters does."""
    x = (0.2, 0.8, 0.15, 0.6, 2.0, -0.4)
    for name, value in MODEL.parameters.items():
        changed = {**MODEL.parameters, name: 1.1 * value + 0.01}
        from_p = MODEL.rhs(x, changed)
        np.testing.assert_allclose(from_p, MODEL.with_parameters({name: changed[name]}).rhs(x, changed))
        assert not np.allclose(from_p, MODEL.rhs(x, MODEL.parameters), rtol=1e-9, atol=0), name


def test_still_air_of_zero_density_has_no_wind_forces():
    model = MODEL.with_parameters({"wind.density": 0.0})
    assert model.wind_forces((0.1, 1.0, 0.2, 1.0, 2.0, 3.0), model.parameters) == (0.0, 0.0, 0.0)
