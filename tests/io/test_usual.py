"""Numbers that are allowed and most likely slips of a unit: each gives one sentence, none an error."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rainwind.cli import app
from rainwind.io.case_files import new_case_text
from rainwind.io.cases import given_numbers, model_from_text, read_case
from rainwind.io.usual import USUAL, unusual
from rainwind.physics import paper_model


def with_line(key: str, line: str) -> str:
    text, count = re.subn(rf"(?m)^{key} = .*$", lambda _: line, new_case_text(), count=1)
    assert count == 1
    return text


def test_the_sample_case_is_usual():
    assert unusual(paper_model()) == []
    assert unusual(paper_model().with_parameters({"wind.yaw": -0.6, "wind.speed": 20.0})) == []


def test_every_range_has_a_reason_and_is_of_a_parameter():
    ratios = "damping_y_percent = 1\ndamping_z_percent = 2"
    everything = model_from_text(with_line("damping_percent", f"{ratios}\nk3_N_m4 = 100\nsag_offset_mm = 50"))
    assert unusual(everything) == []
    assert set(USUAL) <= set(everything.parameters)
    assert all(0 < usual.low < usual.high and usual.why for usual in USUAL.values())


@pytest.mark.parametrize(
    ("key", "line", "words"),
    [
        (
            "diameter_mm",
            "diameter_m = 79",
            "[section] diameter_mm = 79000, which is unusual: usual is 40 to 400",
        ),
        ("damping_percent", "damping_ratio = 10", "[section] damping_percent = 1000, which is unusual"),
        ("damping_percent", "damping_percent = 0.002", "usual is 0.01 to 3"),
        ("yaw_deg", "yaw_deg = 0.5236", "[wind] yaw_deg = 0.5236, which is unusual: usual is 0 or 2 to 180"),
        ("inclination_deg", "inclination_deg = 0.7854", "meant in radians"),
        ("mass_kg_m", "mass_kg_m = 3920", "[section] mass_kg_m = 3920"),
        ("frequency_Hz", "frequency_Hz = 100", "[section] frequency_Hz = 100"),
        ("height_mm", "height_mm = 50", "[rivulet] height_mm = 50"),
        ("friction_Nms", "friction_Nms = 50", "[rivulet] friction_Nms = 50"),
        ("speed_m_s", "speed_m_s = 60", "[wind] speed_m_s = 60"),
        (
            "yaw_deg",
            "vertical_speed_m_s = -20",
            "[wind] vertical_speed_m_s = -20, which is unusual: usual is 0 or 0.01 to 10",
        ),
        ("density_kg_m3", "density_kg_m3 = 1225", "[wind] density_kg_m3 = 1225"),
        (
            "k2_z_N_m3",
            "k3_N_m4 = 2e-3",
            "[section] k3_N_m4 = 0.002, which is unusual: usual is 0 or 0.1 to 1e+06",
        ),
        (
            "k2_z_N_m3",
            "k3_N_m4 = 2\nsag_offset_m = 20",
            "[section] sag_offset_mm = 20000, which is unusual: usual is 0 or 0.5 to 5000 mm",
        ),
    ],
)
def test_unusual_numbers(key: str, line: str, words: str):
    sentences = unusual(model_from_text(with_line(key, line)))
    assert any(words in sentence for sentence in sentences), sentences


def test_a_rivulet_heavier_than_the_cable_and_a_cable_heavier_than_steel():
    model = paper_model().with_parameters({"rivulet.mass": 200.0, "section.diameter": 0.05})
    mass, density, share = unusual(model)
    assert "[rivulet] mass_kg_m = 200" in mass
    assert "2.55e+04 kg/m3" in density
    assert "4 times the cable's" in share


@pytest.mark.parametrize(
    ("key", "line", "words"),
    [
        (
            "diameter_mm",
            "diameter_mm = 10.1",
            "[section] diameter_mm = 10.1, which is unusual: usual is 40 to 400 mm",
        ),
        (
            "diameter_mm",
            "diameter_cm = 1.1",
            "[section] diameter_cm = 1.1, which is unusual: usual is 4 to 40 cm",
        ),
        (
            "diameter_mm",
            'diameter = "1.1 cm"',
            '[section] diameter = "1.1 cm", which is unusual: usual is 40 to 400 mm',
        ),
        (
            "damping_percent",
            "damping_ratio = 1",
            "damping_ratio = 1, which is unusual: usual is 0.0001 to 0.03;",
        ),
        ("frequency_Hz", "frequency_Hz = 33", "[section] frequency_Hz = 33,"),
        ("inclination_deg", "inclination_rad = 1e-3", "[section] inclination_rad = 0.001,"),
        ("yaw_deg", "yaw_deg = -1", "[wind] yaw_deg = -1, which is unusual: usual is 0 or 2 to 180 deg"),
    ],
)
def test_a_sentence_quotes_what_the_file_says(key: str, line: str, words: str, tmp_path: Path):
    case = tmp_path / "case.toml"
    case.write_text(with_line(key, line), encoding="utf-8")
    sentences = unusual(read_case(case), given_numbers(case))
    assert any(words in sentence for sentence in sentences), sentences
    result = CliRunner().invoke(app, ["check", str(case)])
    assert words in " ".join(result.output.split())
