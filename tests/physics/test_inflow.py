"""Angle of attack and relative speed, eq. (3)."""

from dataclasses import replace
from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rainwind.physics import CoefficientSet, paper_model

PLAIN = CoefficientSet("plain", "made up for this test", "artificial", (-pi, pi), 0.0, 1.0, 0.0)
R, U = 0.055, 9.0


def model(**options):
    return replace(paper_model(PLAIN, "extend"), **options)


@given(st.floats(-3, 3), st.floats(-2, 2), st.floats(-9, 9), st.floats(-2, 2))
def test_angle_of_attack_is_that_of_the_wind_relative_to_the_rivulet(phi, y_dot, phi_dot, z_dot):
    # the rivulet's centre is at y - r cos(phi), z - r sin(phi); up is -y, the wind blows along +z
    rivulet_y, rivulet_z = y_dot + R * sin(phi) * phi_dot, z_dot - R * cos(phi) * phi_dot
    m = model()
    alpha = m.angle_of_attack((0.0, phi, 0.0, y_dot, phi_dot, z_dot), m.parameters)
    assert alpha == pytest.approx(-phi + atan2(rivulet_y, U - rivulet_z), abs=1e-14)


def test_linear_angle_is_the_right_hand_form_of_eq_3():
    m = model(angle="linear")
    alpha = m.angle_of_attack((0.0, 0.7, 0.0, 0.9, 4.0, 1.5), m.parameters)
    assert alpha == pytest.approx(-0.7 + 0.9 / U + R * 4.0 * sin(0.7) / U, abs=1e-15)


def test_linear_and_arctan_agree_to_second_order():
    x = np.array([0.0, 0.7, 0.0, 0.9, 4.0, 1.5])
    slow = np.array([1, 1, 1, 1e-5, 1e-5, 1e-5])
    exact, linear = model(), model(angle="linear")
    p = exact.parameters
    apart = exact.angle_of_attack(x * slow, p) - linear.angle_of_attack(x * slow, p)
    assert 0 < abs(apart) < 1e-10
    assert abs(exact.angle_of_attack(x, p) - linear.angle_of_attack(x, p)) > 1e-3


@pytest.mark.parametrize("angle", ["arctan", "linear"])
def test_full_relative_speed_scales_the_drag(angle):
    m = model(relative_speed="full", angle=angle)
    phi, y_dot, phi_dot, z_dot = 0.7, 0.9, 4.0, 1.5
    upward, onward = y_dot + R * phi_dot * sin(phi), U - z_dot + R * phi_dot * cos(phi)
    f_y, f_z, m_phi = m.wind_forces((0, phi, 0, y_dot, phi_dot, z_dot), m.parameters)
    assert hypot(f_y, f_z) == pytest.approx(0.5 * 1.225 * 0.1 * (upward**2 + onward**2), rel=1e-13)
    assert m_phi == 0
    # drag acts along the wind that the rivulet meets: against a downward motion, so up
    a_v = upward / U if angle == "linear" else atan2(upward, onward)
    assert f_y == pytest.approx(-hypot(f_y, f_z) * sin(a_v), rel=1e-13)


def test_wind_speed_alone_by_default():
    m = model()
    f_y, f_z, _ = m.wind_forces((0, 0.7, 0, 0.9, 4.0, 1.5), m.parameters)
    assert hypot(f_y, f_z) == pytest.approx(0.5 * 1.225 * 0.1 * U**2, rel=1e-13)


def test_at_rest_all_options_agree():
    x = (0.1, 1.1, 0.2, 0.0, 0.0, 0.0)
    p = model().parameters
    for angle in ("arctan", "linear"):
        for speed in ("wind", "full"):
            assert model(angle=angle, relative_speed=speed).rhs(x, p) == pytest.approx(
                model().rhs(x, p), rel=1e-14
            )


def test_two_degrees_of_freedom_are_three_with_z_at_rest():
    m = model(degrees_of_freedom=2)
    assert m.states == ("y", "phi", "y_dot", "phi_dot")
    forces = m.wind_forces((0.1, 0.7, 0.9, 4.0), m.parameters)
    assert forces == model().wind_forces((0.1, 0.7, 0.0, 0.9, 4.0, 0.0), m.parameters)
