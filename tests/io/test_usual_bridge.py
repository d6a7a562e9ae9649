"""Numbers of a bridge that are allowed and most likely slips of a unit: each gives one sentence, none an error."""

import re
from dataclasses import replace
from math import radians
from pathlib import Path

import pytest

from rainwind.engineering.bridge import Bridge, ClimateSource, Limits, Site
from rainwind.engineering.cable import Cable, Damper
from rainwind.io.bridge_cases import bridge_from_text, read_bridge
from rainwind.io.new_bridge import new_bridge_text
from rainwind.io.usual_bridge import unusual_bridge

STAY = Cable("1N", 130.0, 0.16, 60.0, 3.2e6, radians(35), radians(90))
EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*/*.toml"))


def sentences(**changed: object) -> list[str]:
    return unusual_bridge(Bridge("North", (replace(STAY, **changed),)))  # type: ignore[arg-type]


def test_a_usual_bridge_has_none():
    assert sentences() == []
    assert sentences(dampers=(Damper(4.0, 1.4e5, 2e7),), axial_stiffness=1.6e9, bending_stiffness=9e5) == []
    assert unusual_bridge(bridge_from_text(new_bridge_text())) == []


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_shipped_examples_are_usual(path: Path):
    assert unusual_bridge(read_bridge(path)) == []


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (
            {"diameter": 0.03, "mass": 3.0, "tension": 2e5},
            "diameter_mm = 30, which is unusual: usual is 40 to 400 mm",
        ),
        ({"inclination": radians(0.6)}, "inclination_deg = 0.6, which is unusual: usual is 5 to 85 deg"),
        ({"heading": radians(1.5)}, "heading_deg = 1.5, which is unusual: usual is 0 or 6.5 to 360 deg"),
        (
            {"damping_ratios": (0.000015,)},
            "damping_percent = 0.0015, which is unusual: usual is 0.03 to 0.5 %",
        ),
        ({"damping_ratios": (0.001, 0.02)}, "damping_percent = 2, which is unusual"),
        ({"damping_ratios": (0.0,)}, "damping_percent = 0, which is unusual"),
        ({"base_height": 1000.0}, "base_height_m = 1000, which is unusual: usual is 0 or 0.5 to 300 m"),
        ({"mass": 15.0, "tension": 8e5}, "mass and diameter make a cable of 746 kg/m3, which is unusual"),
        ({"mass": 250.0, "tension": 1.3e7}, "make a cable of 1.24e+04 kg/m3, which is unusual"),
        ({"tension": 3.2e5}, "tension and mass make a stress of 41.9 MPa if all mass is steel"),
        ({"tension": 1.2e7}, "tension and mass make a stress of 1.57e+03 MPa"),
        ({"axial_stiffness": 1.6e6}, "tension and axial_stiffness make a strain of 200 %"),
        (
            # (60 kg/m * 9.81 m/s² * 170 m * cos(35 deg) / 0.85 MN)² * 1600 MN / 0.85 MN = 17.5, over 1.001
            {"tension": 8.5e5, "axial_stiffness": 1.6e9, "length": 170.0},
            "its sag makes lambda² = 17.5, which is unusual",
        ),
        ({"bending_stiffness": 9e8}, "L sqrt(T/EI) = 7.75, which is unusual"),
        (
            {"dampers": (Damper(4.0, 140.0),)},
            "a damper of c = 0.14 kNs/m at 4 m, which is unusual: about 143 kNs/m would be the best there",
        ),
        (
            {"dampers": (Damper(40.0, 1e4),)},
            "a damper at 30.8 % of the length, which is unusual: usual is 1 to 10 %",
        ),
        ({"dampers": (Damper(4.0, 1.4e5, 2e4),)}, "a damper on a support of 20 kN/m, which is unusual"),
    ],
)
def test_unusual_numbers_of_a_stay(changed: dict[str, object], words: str):
    (sentence,) = sentences(**changed)
    assert sentence.startswith("stay '1N': ")
    assert words in sentence


def test_a_slow_stay():
    assert any(
        "make a first frequency of 0.0886 Hz, which is unusual" in one for one in sentences(length=1303.0)
    )


def test_stays_with_the_same_number_share_a_sentence():
    stays = tuple(
        replace(STAY, name=f"{number}N", diameter=0.5, mass=400.0, tension=2e7) for number in range(1, 8)
    )
    (sentence,) = unusual_bridge(Bridge("North", stays))
    assert sentence.startswith("all 7 stays: diameter_mm = 500, which is unusual")
    (sentence,) = unusual_bridge(Bridge("North", (*stays[:6], replace(STAY, name="7N"))))
    assert sentence.startswith("stays '1N', '2N', '3N' and 3 more: diameter_mm = 500")
    (sentence,) = unusual_bridge(Bridge("North", (*stays[:2], replace(STAY, name="7N"))))
    assert sentence.startswith("stays '1N' and '2N': diameter_mm = 500")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (
            {"site": Site(density=12.25)},
            "[site] density_kg_m3 = 12.25, which is unusual: usual is 0.9 to 1.5 kg/m^3",
        ),
        ({"site": Site("power", exponent=1.4)}, "[site] exponent = 1.4, which is unusual"),
        ({"site": Site("logarithmic", roughness=5.0)}, "[site] roughness_m = 5, which is unusual"),
        (
            {"climate": ClimateSource(Path("x"), look_back=7.2e6)},
            "[climate] look_back_h = 2000, which is unusual",
        ),
        (
            {"climate": ClimateSource(Path("x"), rain_threshold=10)},
            "[climate] rain_threshold_mm_h = 10, which is",
        ),
        ({"limits": Limits(50.0)}, "[limits] amplitude_diameters = 50, which is unusual"),
    ],
)
def test_unusual_numbers_of_the_place(changed: dict[str, object], words: str):
    (sentence,) = unusual_bridge(Bridge("North", (STAY,), **changed))  # type: ignore[arg-type]
    assert sentence.startswith(words)


def test_every_sentence_is_one_line_with_a_reason():
    for sentence in sentences(diameter=0.5, damping_ratios=(0.0,), dampers=(Damper(40.0, 1.0),)):
        assert re.search(r"which is unusual: ", sentence)
        assert "\n" not in sentence
