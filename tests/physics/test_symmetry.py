"""Symmetries that the equations have exactly."""

from dataclasses import replace
from math import pi

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rainwind.physics import CoefficientSet, paper_model

STATES = st.tuples(*(st.floats(-limit, limit) for limit in (0.5, 3.0, 0.5, 2.0, 9.0, 2.0)))
SPRINGS = {"section.k2_y": 30.0, "section.k3_y": 200.0, "section.k2_z": -50.0, "section.k3_z": 100.0}
STILL = paper_model().with_parameters({"wind.density": 0.0, "wind.yaw": 0.4, **SPRINGS})
# lift and moment odd, drag even under alpha -> -pi - alpha: a section that looks the same upside down
UPRIGHT = CoefficientSet(
    "upright", "made up for this test", "artificial", (-pi, pi),
    lift="0.7*sin(2*alpha)", drag="1 + 0.3*sin(alpha)", moment="0.1*cos(alpha)",
)  # fmt: skip


def assert_maps(model, mirrored, x, signs, phi):
    """If x moves, its mirror image moves as the image of the motion."""
    image = np.array(x) * signs
    image[1] = phi
    expected = np.array(model.rhs(x, model.parameters)) * signs
    np.testing.assert_allclose(mirrored.rhs(image, mirrored.parameters), expected, rtol=1e-9, atol=1e-9)


@given(STATES)
def test_still_air_windward_and_leeward_are_alike(x):
    mirrored = STILL.with_parameters({"wind.yaw": -0.4, "section.k2_z": 50.0})
    assert_maps(STILL, mirrored, x, np.array([1, -1, -1, 1, -1, -1]), -x[1])


@given(STATES)
def test_still_air_turned_upside_down_with_gravity(x):
    mirrored = STILL.with_parameters({"wind.yaw": pi - 0.4, "section.k2_y": -30.0})
    assert_maps(STILL, mirrored, x, np.array([-1, -1, 1, -1, -1, 1]), pi - x[1])


@given(STATES, st.sampled_from(["wind", "full"]), st.sampled_from(["arctan", "linear"]))
def test_a_symmetric_section_in_wind_turned_upside_down_with_gravity(x, relative_speed, angle):
    model = replace(paper_model(UPRIGHT, "extend"), relative_speed=relative_speed, angle=angle)
    model = model.with_parameters({"wind.yaw": 0.4, "wind.vertical_speed": 1.7, **SPRINGS})
    mirrored = model.with_parameters({"wind.yaw": pi - 0.4, "section.k2_y": -30.0})
    assert_maps(model, mirrored, x, np.array([-1, -1, 1, -1, -1, 1]), pi - x[1])


@given(STATES, st.integers(-3, 3))
def test_a_full_turn_of_the_rivulet_changes_nothing_with_the_blend(x, turns):
    model = paper_model()
    turned = np.array(x)
    turned[1] += 2 * pi * turns
    expected = model.rhs(x, model.parameters)
    np.testing.assert_allclose(model.rhs(turned, model.parameters), expected, rtol=1e-8, atol=1e-8)
