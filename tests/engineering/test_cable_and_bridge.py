"""Stays, sites and questions at the door: what is refused, and what follows from what is given."""

from dataclasses import replace
from math import nan, pi

import pytest

from rainwind.engineering.bridge import Bridge, ClimateSource, Limits, Question, Site
from rainwind.engineering.cable import Cable, Damper
from rainwind.errors import InputError

STAY = Cable("1", 100.0, 0.16, 60.0, 3e6, 0.5, 1.0, damping_ratios=(0.001, 0.002))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"name": " "}, "not empty"),
        ({"length": 0.0}, "above 0"),
        ({"tension": nan}, "not finite"),
        ({"mass": "60"}, "not a number"),
        ({"inclination": 30.0}, "radians"),
        ({"heading": 400.0}, "radians"),
        ({"heading": -0.1}, "radians"),
        ({"axial_stiffness": 0.0}, "EA in N"),
        ({"bending_stiffness": -1.0}, "0 or more"),
        ({"damping_ratios": ()}, "one ratio or more"),
        ({"damping_ratios": (0.001, -0.001)}, "0 or more"),
        ({"damping_ratios": (1.5,)}, "critical"),
        ({"surface": "rough"}, "smooth"),
        ({"base_height": -1.0}, "0 or more"),
        ({"dampers": (Damper(50.0, 1e4),)}, "beyond mid-span"),
    ],
)
def test_a_stay_that_cannot_be_is_refused(change: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(STAY, **change)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"position": 0.0}, "position"),
        ({"coefficient": -1.0}, "Ns/m"),
        ({"support_stiffness": 0.0}, "rigid"),
        ({"end": "middle"}, "lower"),
    ],
)
def test_a_damper_that_cannot_be_is_refused(change: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(Damper(2.0, 1e4), **change)


def test_what_follows_from_a_stay() -> None:
    """sqrt(3e6/60) = 223.6 m/s; strands at 744 MPa with 195 GPa: EA = 262.1 T."""
    assert STAY.wave_speed == pytest.approx(223.607, abs=1e-3)
    assert STAY.estimated_axial_stiffness == pytest.approx(262.097 * 3e6, rel=1e-5)
    assert replace(STAY, axial_stiffness=1e9).estimated_axial_stiffness == 1e9
    assert [STAY.damping_ratio(k) for k in (1, 2, 7)] == [0.001, 0.002, 0.002]


def test_bridges_sites_and_limits_that_cannot_be_are_refused() -> None:
    for make, said in (
        (lambda: Bridge("b", ()), "one stay or more"),
        (lambda: Bridge("b", (STAY, STAY)), "two stays have the name '1'"),
        (lambda: Site(profile="log"), "logarithmic"),
        (lambda: Site(profile="logarithmic", roughness=20.0), "less than the reference height"),
        (lambda: Site(density=0.0), "density"),
        (lambda: ClimateSource("x.csv", height=0.0), "height"),
        (lambda: ClimateSource("x.csv", rain_threshold=-1.0), "rain_threshold"),
        (lambda: Limits(amplitude_diameters=0.0), "amplitude"),
        (lambda: Limits(observed_speeds=(18.0, 5.0)), "lower one first"),
    ):
        with pytest.raises(InputError, match=said):
            make()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"modes": 0}, "1 to 20"),
        ({"directions": 36.0}, "whole number"),
        ({"samples": True}, "whole number"),
        ({"runs": 1}, "2 to 1024"),
        ({"speeds": (40.0, 3.0)}, "lower first"),
        ({"speeds": (3.0, 400.0)}, "100 m/s"),
        ({"sets": ()}, "one set"),
    ],
)
def test_questions_that_cannot_be_answered_are_refused(change: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(Question(), **change)


def test_an_angle_in_degrees_is_told_from_one_in_radians() -> None:
    assert replace(STAY, heading=2 * pi).heading == 2 * pi
    with pytest.raises(InputError, match=r"math\.radians"):
        replace(STAY, inclination=45.0)
