"""Compass directions against vectors in space, and against the model's own equations."""

from dataclasses import replace
from math import atan2, cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rainwind.engineering.inflow import beta, normal_factor, yaw
from rainwind.errors import InputError
from rainwind.physics import CoefficientSet, paper_model

ANGLE = st.floats(0.0, 2 * pi)
SLOPE = st.floats(0.02, 1.5)
# lift and moment odd, drag even under alpha -> -pi - alpha: a section that looks the same upside down
UPRIGHT = CoefficientSet(
    "upright", "made up for this test", "artificial", (-pi, pi),
    lift="0.7*sin(2*alpha)", drag="1 + 0.3*sin(alpha)", moment="0.1*cos(alpha)",
)  # fmt: skip


def in_space(direction, heading, inclination):
    """Unit vectors (east, north, up): where the wind blows to, and the cable's axis from top to bottom."""
    wind = -np.array([sin(direction), cos(direction), 0.0])
    rising = np.array([cos(inclination) * sin(heading), cos(inclination) * cos(heading), sin(inclination)])
    return wind, -rising


def test_a_wind_from_the_side_of_the_upper_end_blows_down_along_the_cable():
    north = 0.0
    assert yaw(north, heading=north) == pytest.approx(pi / 2)
    assert yaw(pi, heading=north) == pytest.approx(-pi / 2)
    assert yaw(pi / 2, heading=north) == pytest.approx(0.0, abs=1e-15)
    assert yaw(3 * pi / 2, heading=north) == pytest.approx(0.0, abs=1e-15)
    # from the north-east onto a stay that rises to the north: 45 degrees, down along it
    assert yaw(radians(45), heading=north) == pytest.approx(pi / 4)
    assert yaw(radians(200), heading=radians(200 - 60)) == pytest.approx(pi / 6)


@given(ANGLE, ANGLE, SLOPE)
def test_normal_wind_and_beta_are_those_of_vectors_in_space(direction, heading, inclination):
    wind, axis = in_space(direction, heading, inclination)
    normal = wind - (wind @ axis) * axis
    gamma = yaw(direction, heading)
    assert normal_factor(gamma, inclination) == pytest.approx(np.linalg.norm(normal), abs=1e-12)
    if np.linalg.norm(normal) < 1e-3:
        return
    z = normal / np.linalg.norm(normal)
    y = np.cross(axis, z)
    y = y if y[2] < 0 else -y  # down, on whichever side the cable descends
    down = np.array([0.0, 0.0, -1.0])
    # the cable's bottom lies at phi = pi - beta, where (y, z) = r (cos(beta), -sin(beta))
    assert beta(gamma, inclination) == pytest.approx(atan2(-(down @ z), down @ y), abs=1e-9)
    # the paper's sign: positive where the wind blows down along the cable
    if abs(wind @ axis) > 1e-9:
        assert (gamma > 0) == (wind @ axis > 0)


@given(ANGLE, ANGLE)
def test_winds_from_both_sides_of_the_cable_s_plane_are_one_section(offset, heading):
    left, right = yaw((heading + offset) % (2 * pi), heading), yaw((heading - offset) % (2 * pi), heading)
    assert left == pytest.approx(right, abs=1e-12)


@given(
    st.tuples(*(st.floats(-limit, limit) for limit in (0.5, 3.0, 0.5, 2.0, 9.0, 2.0))),
    st.floats(-1.5, 1.5),
    st.sampled_from(["wind", "full"]),
)
def test_the_other_solution_is_the_model_upside_down(x, gamma, relative_speed):
    model = replace(paper_model(UPRIGHT, "extend"), relative_speed=relative_speed)
    model = model.with_parameters({"wind.yaw": gamma, "section.k2_y": 0.0})
    other = model.with_parameters({"wind.yaw": pi - gamma if gamma > 0 else -pi - gamma})
    signs = np.array([-1, -1, 1, -1, -1, 1])
    image = np.array(x) * signs
    image[1] = pi - x[1]
    expected = np.array(model.rhs(x, model.parameters)) * signs
    np.testing.assert_allclose(other.rhs(image, other.parameters), expected, rtol=1e-9, atol=1e-9)


def test_angles_are_those_that_the_model_uses():
    model = paper_model().with_parameters({"wind.yaw": 0.6, "section.inclination": 0.5})
    assert beta(0.6, 0.5) == model.beta
    assert 9.0 * normal_factor(0.6, 0.5) == pytest.approx(model.normal_speed, rel=1e-15)


def test_arrays_keep_their_shape():
    directions = np.linspace(0, 2 * pi, 12, endpoint=False).reshape(3, 4)
    gamma = yaw(directions, 1.0)
    assert gamma.shape == (3, 4)
    assert gamma[1, 2] == yaw(float(directions[1, 2]), 1.0)
    assert normal_factor(gamma, 0.5).shape == beta(gamma, 0.5).shape == (3, 4)
    assert np.all(np.abs(gamma) <= pi / 2)


@pytest.mark.parametrize(
    ("direction", "heading"),
    [(45.0, 1.0), (np.array([0.0, 90.0]), 1.0), (np.array([np.nan]), 1.0), (1.0, 180.0), ("north", 1.0)],
)
def test_degrees_and_nonsense_are_refused(direction, heading):
    with pytest.raises(InputError):
        yaw(direction, heading)
