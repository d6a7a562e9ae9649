"""Vertical wind: its parts in the section's plane, forces and equilibria."""

from dataclasses import replace
from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from rainwind.errors import InputError
from rainwind.physics import CoefficientSet, Wind, paper_model

PLAIN = CoefficientSet("plain", "made up for this test", "artificial", (-pi, pi), 0.0, 1.0, 0.0)
MANY = CoefficientSet(
    "many", "made up for this test", "artificial", (-pi, pi),
    lift="sin(alpha)", drag="1.1", moment="0.08*sin(5*alpha + 0.3) + 0.05*cos(2*alpha)",
)  # fmt: skip
W, YAW, INCLINATION = "wind.vertical_speed", "wind.yaw", "section.inclination"
OPTIONS = [(angle, speed) for angle in ("arctan", "linear") for speed in ("wind", "full")]


def in_space(yaw, inclination):
    """Unit vectors y and z of the section's plane, in space: 0 downwind, 2 up."""
    # the cable descends along `axis`; the wind blows along e_0
    axis = np.array([cos(inclination) * sin(yaw), cos(inclination) * cos(yaw), -sin(inclination)])
    normal = np.array([1.0, 0, 0]) - axis[0] * axis
    z = normal / np.linalg.norm(normal)
    return np.cross(axis, z), z


@given(st.floats(-pi, pi), st.floats(0.01, 1.55), st.floats(-5, 5))
def test_parts_of_a_wind_given_in_space(yaw, inclination, w):
    model = paper_model().with_parameters({YAW: yaw, INCLINATION: inclination, W: w})
    at = model.letters(model.parameters)
    y, z = in_space(yaw, inclination)
    wind = np.array([9.0, 0.0, w])
    assert at.u_z == pytest.approx(wind @ z, abs=1e-12)
    assert at.u_up == pytest.approx(-wind @ y, abs=1e-12)
    if abs(yaw) < 1.5:
        # y points down wherever the wind comes from the half space that it comes from in the paper's case
        assert y[2] < 0


def test_an_updraught_lifts_a_cable_that_only_has_drag():
    model = paper_model(PLAIN, "extend").with_parameters({W: 2.0})
    f_y, f_z, _ = model.wind_forces((0.0,) * 6, model.parameters)
    up = 2.0 * cos(pi / 4)
    q = 0.5 * 1.225 * 0.1 * hypot(9.0, up)
    assert (f_y, f_z) == pytest.approx((-q * up, q * 9.0), rel=1e-13)


STATES = st.tuples(*(st.floats(-limit, limit) for limit in (0.5, 3.0, 0.5, 2.0, 9.0, 2.0)))


@given(STATES, st.floats(-3, 3), st.floats(-2.5, 2.5))
def test_vertical_wind_is_a_motion_of_the_section_the_other_way(x, w, yaw):
    still = replace(paper_model(), relative_speed="full").with_parameters({YAW: yaw})
    windy = still.with_parameters({W: w})
    y, z = in_space(yaw, pi / 4)
    moving = np.array(x) + np.array([0, 0, 0, -w * y[2], 0, -w * z[2]])
    forces = windy.wind_forces(x, windy.parameters)
    assert forces == pytest.approx(still.wind_forces(moving, still.parameters), rel=1e-10, abs=1e-11)


@given(STATES, st.floats(-2, 2), st.floats(-0.9, 0.9))
def test_the_paper_s_relative_speed_is_that_of_the_wind_alone(x, w, yaw):
    model = paper_model(PLAIN, "extend").with_parameters({W: w, YAW: yaw})
    y, z = in_space(yaw, pi / 4)
    wind = np.array([9.0, 0.0, w])
    squared = (wind @ y) ** 2 + (wind @ z) ** 2
    for angle in ("arctan", "linear"):
        f_y, f_z, _ = replace(model, angle=angle).wind_forces(x, model.parameters)
        assert hypot(f_y, f_z) == pytest.approx(0.5 * 1.225 * 0.1 * squared, rel=1e-12)


def test_linear_angle_adds_the_vertical_part_over_the_wind_along_z():
    model = replace(paper_model(PLAIN, "extend"), angle="linear").with_parameters({W: 1.2, YAW: 0.6})
    y, z = in_space(0.6, pi / 4)
    u_z = 9.0 * z[0] + 1.2 * z[2]
    alpha = model.angle_of_attack((0.0, 0.7, 0.0, 0.9, 4.0, 1.5), model.parameters)
    assert alpha == pytest.approx(-0.7 + (0.9 + 0.055 * 4.0 * sin(0.7) - 1.2 * y[2]) / u_z, abs=1e-14)


def test_at_rest_both_relative_speeds_agree():
    x = (0.1, 1.1, 0.2, 0.0, 0.0, 0.0)
    for angle in ("arctan", "linear"):
        own, full = (
            replace(paper_model(), angle=angle, relative_speed=speed).with_parameters({W: 1.4, YAW: 0.3})
            for speed in ("wind", "full")
        )
        assert own.rhs(x, own.parameters) == pytest.approx(full.rhs(x, full.parameters), rel=1e-12)


@pytest.mark.parametrize(("angle", "speed"), OPTIONS)
@pytest.mark.parametrize("freedoms", [3, 2])
@pytest.mark.parametrize("outside", ["blend", "extend", "refuse"])
@settings(max_examples=15, deadline=None)
@given(w=st.floats(-3, 3), yaw=st.floats(-3, 3), u=st.floats(5, 15))
def test_every_equilibrium_is_found(outside, freedoms, angle, speed, w, yaw, u):
    coefficients = "reconstructed" if outside == "blend" else MANY
    model = replace(
        paper_model(coefficients, outside, degrees_of_freedom=freedoms), angle=angle, relative_speed=speed
    ).with_parameters({W: w, YAW: yaw, "wind.speed": u})
    found = model.all_states()
    assert np.all(np.diff(found.states[:, 1]) >= 0)
    for x in found:
        assert np.max(np.abs(model.rhs(tuple(x), model.parameters))) < 1e-9
        assert model.refusal(x, model.parameters) is None

    y, z = in_space(yaw, pi / 4)
    up, onward = -w * y[2], u * z[0] + w * z[2]
    alpha_v = up / onward if angle == "linear" else atan2(up, onward)
    beta = atan2(sin(yaw) * sin(pi / 4), cos(yaw))

    def balance(phi):
        """The rivulet's row of eq. (4) at rest."""
        c_m = model.coefficients.at(-phi + alpha_v, outside)[2]
        wind = 0.5 * 1.225 * 0.1**2 * (up**2 + onward**2) * c_m
        return wind + 0.2 * 0.055 * 9.81 * cos(pi / 4) * np.sin(phi + beta)

    low, high = (-pi / 2, 1.5 * pi) if outside == "blend" else (alpha_v - pi, alpha_v + pi)
    grid = np.linspace(low + 1e-6, high - 1e-6, 20_001)
    values = balance(grid)
    places = np.flatnonzero(values[:-1] * values[1:] < 0)
    roots = [brentq(balance, grid[i], grid[i + 1], xtol=1e-14) for i in places]
    if found.certified:
        assert len(roots) == len(found)
        np.testing.assert_allclose(np.unique(found.states[:, 1]), roots, atol=1e-8)


def test_no_vertical_wind_changes_nothing():
    model = paper_model()
    assert model.wind == Wind(9.0)
    at = model.letters(model.parameters)
    assert (at.u_z, at.u_up) == (at.u_n, 0.0)


def test_what_is_refused():
    with pytest.raises(InputError, match=r"wind\.vertical_speed = nan is not finite"):
        Wind(9.0, vertical_speed=np.nan)
    turned = replace(paper_model(), angle="linear").with_parameters({YAW: 1.5})
    with pytest.raises(InputError, match="turns the flow around the section back"):
        turned.with_parameters({W: -30.0})
