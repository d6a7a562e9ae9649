"""The section has the numbers of the stay and its mode, and swings as the mode does."""

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
        "rivulet.mass": 0.3, "rivulet.height": 0.008, "rivulet.friction": 0.04,
    }  # fmt: skip
    assert {name: found.parameters[name] for name in expected} == expected
    assert found.outside == "extend"
    assert found.coefficients == load_coefficients("reconstructed")


def test_a_set_serves_as_well_as_its_name():
    assert model(coefficients=load_coefficients("reconstructed")) == model()


def test_nonsense_is_refused_at_the_door():
    with pytest.raises(InputError, match="damping_ratio"):
        model(damping_ratio=-0.1)
    with pytest.raises(InputError):
        model(coefficients="no such set")
