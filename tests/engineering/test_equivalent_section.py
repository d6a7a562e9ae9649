"""The section has the numbers of the stay and its mode, and swings as the mode does."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from rainwind.engineering.cable import Cable
from rainwind.engineering.equivalent_section import section_model
from rainwind.engineering.modes import cable_mode
from rainwind.errors import InputError
from rainwind.physics import Rivulet, load_coefficients

# so light that it does not show in the frequencies
LIGHT = Rivulet(mass=1e-9, height=0.005, friction=0.01)
CABLE = Cable("S", 250.0, 0.16, 70.0, 4.0e6, 0.5, 1.0, axial_stiffness=1.5e9, bending_stiffness=4e5)


def model(number=1, cable=CABLE, rivulet=LIGHT, **changes):
    given = {"coefficients": "reconstructed", "damping_ratio": 0.003} | changes
    return section_model(cable, cable_mode(cable, number), rivulet=rivulet, **given)


def test_numbers_are_those_of_the_stay_and_the_mode():
    rivulet = Rivulet(mass=0.3, height=0.008, friction=0.04)
    found = model(2, rivulet=rivulet, density=1.2, outside="extend")
    expected = {
        "wind.speed": 10.0, "wind.yaw": 0.0, "wind.density": 1.2, "section.diameter": 0.16, "section.mass": 70.0,
        "section.frequency_y": cable_mode(CABLE, 2).frequency_out, "section.damping_ratio": 0.003,
        "section.frequency_z": cable_mode(CABLE, 2).frequency_out, "section.inclination": 0.5,
        "section.k2_y": 0.0, "section.k3_y": 0.0, "section.k2_z": 0.0, "section.k3_z": 0.0,
        "section.k3": cable_mode(CABLE, 2).k3, "section.sag_offset": 0.0,
        "rivulet.mass": 0.3, "rivulet.height": 0.008, "rivulet.friction": 0.04,
    }  # fmt: skip
    assert {name: found.parameters[name] for name in expected} == expected
    assert found.outside == "extend"
    assert found.coefficients == load_coefficients("reconstructed")


@pytest.mark.parametrize("number", [1, 2, 3])
@pytest.mark.parametrize("yaw", [0.0, 0.7, -1.2])
def test_it_swings_at_both_frequencies_of_the_mode(number, yaw):
    still = model(number, damping_ratio=0.0).with_parameters({"wind.density": 0.0, "wind.yaw": yaw})
    mode = cable_mode(CABLE, number)
    # y and z alone, the rivulet of a milligram held: columns of the acceleration by small displacements
    p, step = still.parameters, 1e-7

    def slopes(y, z):
        ahead, behind = (still.rhs((sign * y, 0.0, sign * z, 0.0, 0.0, 0.0), p) for sign in (1, -1))
        return (np.array(ahead) - np.array(behind))[[3, 5]] / (2 * step)

    stiffness = -np.array([slopes(step, 0.0), slopes(0.0, step)])
    values, vectors = np.linalg.eigh(stiffness)
    expected = sorted([mode.frequency_out, mode.frequency_in])
    assert np.sqrt(values) / (2 * pi) == pytest.approx(expected, rel=1e-6)
    if number != 2:
        # the higher one moves in the cable's vertical plane: along gravity, (cos beta, -sin beta)
        assert abs(vectors[:, 1] @ [np.cos(still.beta), -np.sin(still.beta)]) == pytest.approx(1, abs=1e-6)


def test_a_flat_and_heavy_cable_that_snaps_through_is_refused():
    slack = replace(CABLE, tension=5e5, axial_stiffness=2e9)
    with pytest.raises(InputError, match=r"it sags too much for this model.*tension, mass and axial stiff"):
        model(cable=slack)


@pytest.mark.parametrize(("tension", "refused"), [(1.11e6, False), (1.09e6, True)])
def test_the_most_sag_is_where_the_frequencies_are_apart_by_the_root_of_three(tension, refused):
    stay = replace(CABLE, tension=tension, axial_stiffness=1.5e9, bending_stiffness=0.0)
    first = cable_mode(stay, 1)
    assert (first.frequency_in > 3**0.5 * first.frequency_out) == refused  # the case lies on the side it says
    if refused:
        with pytest.raises(InputError, match="sags too much"):
            model(cable=stay)
    else:
        assert model(cable=stay).parameters["section.k3"] == first.k3


def test_a_set_serves_as_well_as_its_name():
    assert model(coefficients=load_coefficients("reconstructed")) == model()


def test_nonsense_is_refused_at_the_door():
    with pytest.raises(InputError, match="damping_ratio"):
        model(damping_ratio=-0.1)
    with pytest.raises(InputError):
        model(coefficients="no such set")
