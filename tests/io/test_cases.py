"""Case files: what is read, what is written, and each fault one by one."""

import re
from dataclasses import replace
from math import pi, radians

import pytest

from rainwind.errors import CaseError, InputError
from rainwind.io.case_files import case_text, new_case_text, write_case
from rainwind.io.cases import model_from_text, read_case
from rainwind.io.schema import NUMBERS
from rainwind.physics import load_coefficients, paper_model

EXAMPLE = new_case_text()


def with_line(key: str, line: str) -> str:
    """The example with the line of `key` replaced."""
    text, count = re.subn(rf"(?m)^{key} = .*$", lambda _: line, EXAMPLE, count=1)
    assert count == 1
    return text


def test_the_example_is_the_sample_case_of_the_paper():
    assert model_from_text(EXAMPLE) == paper_model()


def test_every_line_of_the_example_says_what_it_is():
    for line in EXAMPLE.splitlines():
        assert line == "" or line.startswith(("#", "[", "schema")) or "  # " in line


@pytest.mark.parametrize(
    ("key", "line", "parameter", "value"),
    [
        ("speed_m_s", 'speed = "32 km/h"', "wind.speed", 32 / 3.6),
        ("speed_m_s", "speed_km_h = 36", "wind.speed", 10.0),
        ("yaw_deg", "yaw_rad = 0.25", "wind.yaw", 0.25),
        ("yaw_deg", "yaw_deg = 45", "wind.yaw", radians(45)),
        ("yaw_deg", "", "wind.yaw", 0.0),
        ("yaw_deg", "vertical_speed_km_h = -3.6", "wind.vertical_speed", -1.0),
        ("yaw_deg", "", "wind.vertical_speed", 0.0),
        ("density_kg_m3", "", "wind.density", 1.225),
        ("diameter_mm", 'diameter = "12 cm"', "section.diameter", 0.12),
        ("frequency_Hz", "frequency_Hz = 1\nfrequency_z_Hz = 2", "section.frequency_z", 2.0),
        ("frequency_Hz", "frequency_y_Hz = 3\nfrequency_z_Hz = 2", "section.frequency_y", 3.0),
        ("damping_percent", "damping_ratio = 0.01", "section.damping_ratio", 0.01),
        ("damping_percent", "damping_y_percent = 1\ndamping_z_percent = 2", "section.damping_ratio_z", 0.02),
        ("damping_percent", "damping_percent = 1\ndamping_y_percent = 3", "section.damping_ratio_y", 0.03),
        ("k3_y_N_m4", "", "section.k3_y", 0.0),
        ("k3_y_N_m4", "k3_N_m4 = 90\nk3_y_N_m4 = 2", "section.k3", 90.0),
        ("k3_y_N_m4", "k3_N_m4 = 90\nk3_y_N_m4 = 2", "section.k3_y", 2.0),
        ("k2_z_N_m3", 'sag_offset = "12 cm"\nk3 = "90 N/m^4"', "section.sag_offset", 0.12),
    ],
)
def test_units_and_what_may_be_left_out(key: str, line: str, parameter: str, value: float):
    assert model_from_text(with_line(key, line)).parameters[parameter] == value


def test_options():
    text = with_line("outside", 'outside = "extend"\nmoment_of = "reconstructed-linear"')
    text = text.replace('"reconstructed" ', '"gu-lu-2001-lift-drag" ').replace("freedom = 3", "freedom = 2")
    model = model_from_text(text)
    assert model.outside == "extend"
    assert model.degrees_of_freedom == 2
    assert model.coefficients == load_coefficients("gu-lu-2001-lift-drag").with_moment_of(
        load_coefficients("reconstructed-linear")
    )


def test_a_coefficient_file_is_looked_for_beside_the_case(tmp_path):
    own = 'name = "own"\nsource = "here"\nstatus = "test"\nvalid_deg = [-90, 0]\n'
    own += "lift = [1]\ndrag = [1]\nmoment = [0]"
    (tmp_path / "own.toml").write_text(own, encoding="utf-8")
    (tmp_path / "case.toml").write_text(with_line("set", 'set = "own.toml"'), encoding="utf-8")
    model = read_case(tmp_path / "case.toml")
    assert model.coefficients.name == "own"
    with pytest.raises(InputError, match="coefficients="):
        case_text(model)
    write_case(model, tmp_path / "again.toml", coefficients="own.toml")
    assert read_case(tmp_path / "again.toml") == model


@pytest.mark.parametrize(
    "model",
    [
        paper_model(),
        paper_model("reconstructed-cubic", outside="extend", degrees_of_freedom=2),
        replace(paper_model(), angle="linear", relative_speed="full"),
        paper_model().with_parameters(
            {
                "wind.speed": 1 / 3,
                "wind.yaw": -1.1,
                "section.inclination": 0.7,
                "rivulet.height": 0.0123456789,
            }
        ),
        replace(
            paper_model(), section=replace(paper_model().section, damping_ratio_y=0.003, frequency_z=1.1)
        ),
        replace(paper_model(), section=replace(paper_model().section, k3=123.4)),
        replace(paper_model(), section=replace(paper_model().section, k3=123.4, sag_offset=0.0567)),
        replace(
            paper_model(),
            coefficients=load_coefficients("gu-lu-2001-lift-drag").with_moment_of(
                load_coefficients("reconstructed")
            ),
        ),
    ],
    ids=["paper", "two", "options", "odd numbers", "apart", "taut", "sagging", "moment of another"],
)
def test_a_written_case_reads_back_as_the_same_model(model, tmp_path):
    path = tmp_path / "case.toml"
    write_case(model, path)
    assert read_case(path) == model


def test_a_case_is_not_overwritten_unasked(tmp_path):
    path = tmp_path / "case.toml"
    write_case(paper_model(), path)
    with pytest.raises(InputError, match="exists already"):
        write_case(paper_model(), path)
    write_case(paper_model(), path, force=True)


def test_what_is_left_out_is_no_parameter():
    left_out = {"section.k3", "section.sag_offset"}
    assert not left_out & set(model_from_text(EXAMPLE).parameters)
    assert not any(word in case_text(paper_model()) for word in ("k3_N_m4", "sag_offset"))


# key whose line is replaced, the line, words of the message
FAULTS = {
    "sag without tension": (
        "k2_z_N_m3",
        "sag_offset_mm = 50",
        ["line 11", "section.sag_offset = 0.05 acts through section.k3", "give section.k3"],
    ),
    "a negative sag": (
        "k2_z_N_m3",
        "sag_offset_mm = -50\nk3_N_m4 = 90",
        ["line 19", "sag_offset_mm = -50", "must be 0 or more"],
    ),
    "a cable that snaps through": (
        "k2_z_N_m3",
        "sag_offset_m = 7\nk3_N_m4 = 90",
        ["line 11", "section.sag_offset = 7 m", "would snap through", "must stay below 1973"],
    ),
    "a tension that softens": (
        "k2_z_N_m3",
        "k3_N_m4 = -90",
        ["line 19", "k3_N_m4 = -90", "must be 0 or more"],
    ),
    "a quadratic spring alone": (
        "k3_y_N_m4",
        "k3_N_m4 = 90",
        ["line 11", "the one in y gets ever softer", "section.k2_y = 0"],
    ),
    "unknown key": (
        "speed_m_s",
        "speed_m_s = 9\nsped_m_s = 9",
        ["line 8", "unknown key 'sped_m_s'", "speed_m_s"],
    ),
    "key of another table": ("speed_m_s", "speed_m_s = 9\ndiameter_mm = 9", ["belongs in [section]"]),
    "missing key": ("mass_kg_m", "", ["line 11", "[section] has no mass", "mass_kg_m"]),
    "one damping of two": (
        "damping_percent",
        "damping_y_percent = 1",
        [
            "[section] has damping_y but no damping_z; add for example damping_z_percent = 0.2",
            "damping for both",
        ],
    ),
    "one frequency of two": ("frequency_Hz", "frequency_z_Hz = 1", ["has frequency_z but no frequency_y"]),
    "no friction": ("friction_Nms", "", ['friction_Nms = 0.05 or friction = "0.05 Nms"']),
    "no height": ("height_mm", "", ['height_mm = 10 or height = "10 mm"']),
    "comma in text": ("diameter_mm", 'diameter_mm = "79,0"', ["with a decimal point, 79.0"]),
    "no unit": ("speed_m_s", "speed = 9", ["line 7", "speed = 9 has no unit", "speed_m_s", '"9 m/s"']),
    "wrong unit": (
        "speed_m_s",
        "speed_mm = 9",
        ["'mm', which is no unit of a speed", "speed_m_s or speed_km_h"],
    ),
    "wrong unit of a mass": ("mass_kg_m", "mass_kg = 50", ["'kg'", "mass_kg_m"]),
    "wrong unit in text": ("diameter_mm", 'diameter = "3 kg"', ["diameter = '3 kg'", "no unit of a length"]),
    "text with no unit": ("yaw_deg", 'yaw = "45"', ["has no unit", '"45 deg"']),
    "units of the paper": ("k2_y_N_m3", "k2_y_N_m2 = 1", ["no unit of a quadratic stiffness", "k2_y_N_m3"]),
    "text for a number": (
        "speed_m_s",
        'speed_m_s = "fast"',
        ["speed_m_s = 'fast' is text, not a number", 'speed = "9 m/s"'],
    ),
    "true for a number": ("speed_m_s", "speed_m_s = true", ["is true or false, not a number"]),
    "list for a number": ("speed_m_s", "speed_m_s = [1, 2]", ["is a list, not a number"]),
    "nan": ("speed_m_s", "speed_m_s = nan", ["speed_m_s = nan is not a finite number"]),
    "infinity": ("diameter_mm", "diameter_mm = inf", ["is not a finite number"]),
    "both units": (
        "diameter_mm",
        "diameter_mm = 100\ndiameter_m = 0.1",
        ["line 13", "both give the diameter"],
    ),
    "negative mass": ("mass_kg_m", "mass_kg_m = -50", ["line 13", "mass_kg_m = -50", "above 0"]),
    "no wind": ("speed_m_s", "speed_m_s = 0", ["speed_m_s = 0", "above 0", "density"]),
    "faster than any wind": (
        "speed_m_s",
        "speed_m_s = 1e9",
        ["line 7", "1e+09 m/s; allowed is up to 100 m/s"],
    ),
    "rivulet as high as the cable": ("height_mm", "height_mm = 200", ["line 24", "200 mm", "thick, 100 mm"]),
    "diameter below the rivulet": ("diameter_mm", "diameter_mm = 0.079", ["height_mm = 10", "0.079 mm"]),
    "negative density": ("density_kg_m3", "density_kg_m3 = -1", ["0 or more"]),
    "negative damping": ("damping_percent", "damping_percent = -1", ["damping_percent = -1", "0 or more"]),
    "negative damping of one": (
        "damping_percent",
        "damping_percent = 1\ndamping_z_percent = -1",
        ["line 16", "damping_z_percent = -1"],
    ),
    "zero frequency": ("frequency_Hz", "frequency_Hz = 0", ["line 14", "frequency_Hz = 0", "above 0"]),
    "yaw too large": ("yaw_deg", "yaw_deg = 200", ["3.49066 rad", "-pi to pi rad (-180 to 180 deg)"]),
    "degrees as radians": ("yaw_deg", "yaw_rad = 45", ["yaw_rad = 45 is 45 rad", "its unit"]),
    "inclination too large": ("inclination_deg", "inclination_deg = 91", ["0 to pi/2 rad (0 to 90 deg)"]),
    "negative friction": ("friction_Nms", "friction_Nms = -1", ["friction_Nms = -1", "0 or more"]),
    "unknown set": ("set", 'set = "yamaguchi"', ["set = 'yamaguchi'", "reconstructed"]),
    "no coefficient file": ("set", 'set = "data/none.toml"', ["none.toml", "cannot be read"]),
    "set is a number": ("set", "set = 3", ["set = 3 is no text", "reconstructed"]),
    "set without moment": ("set", 'set = "gu-lu-2001-lift-drag"', ["line 28", "no moment", "moment_of"]),
    "unknown outside": ("outside", 'outside = "clip"', ["line 29", "outside = 'clip'", "'blend'"]),
    "unknown moment": ("outside", 'moment_of = "x"', ["moment_of = 'x'", "reconstructed"]),
    "one degree of freedom": (
        "degrees_of_freedom",
        "degrees_of_freedom = 1",
        ["degrees_of_freedom = 1", "3, 2"],
    ),
    "list of angles": ("angle", "angle = ['arctan']", ["angle = ['arctan']", "'linear'"]),
    "unknown speed": ("relative_speed", 'relative_speed = "all"', ["relative_speed = 'all'", "'full'"]),
    "schema of the future": (
        "schema",
        "schema = 2",
        ["line 4", "schema = 2 is not known", "reads schema = 1"],
    ),
    "schema as text": ("schema", 'schema = "1"', ["schema = '1' is not known"]),
    "no schema": ("schema", "", ["write schema = 1"]),
    "unknown table": ("relative_speed", "[rivulets]\nmass = 1", ["unknown table 'rivulets'", "'rivulet'"]),
    "key outside a table": (
        "schema",
        "schema = 1\nspeed_m_s = 9",
        ["unknown key 'speed_m_s'; it belongs in [wind]"],
    ),
    "unknown key outside a table": (
        "schema",
        "schema = 1\ncolour = 9",
        ["unknown key 'colour'; tables allowed: wind"],
    ),
    "option elsewhere": (
        "angle",
        'outside = "blend"',
        ["'outside' in [model]; it belongs in [coefficients]"],
    ),
    "date for a number": ("speed_m_s", "speed_m_s = 2020-01-01", ["is a date or time, not a number"]),
}


@pytest.mark.parametrize(("key", "line", "words"), FAULTS.values(), ids=FAULTS.keys())
def test_one_fault(key: str, line: str, words: list[str]):
    with pytest.raises(CaseError) as error:
        model_from_text(with_line(key, line), name="bridge.toml")
    message = str(error.value)
    assert message.startswith("bridge.toml: 1 fault\n")
    for word in words:
        assert word in message


def test_a_table_is_not_a_number():
    with pytest.raises(CaseError, match=r"line 2: 'wind' is no table; write \[wind\]"):
        model_from_text("schema = 1\nwind = 3")


def test_wind_along_the_cable_is_refused_with_both_angles():
    text = with_line("yaw_deg", "yaw_deg = 90").replace("inclination_deg = 45.0", "inclination_deg = 0")
    with pytest.raises(CaseError, match="along the cable"):
        model_from_text(text)


def test_an_empty_file_lacks_everything_that_has_no_default():
    with pytest.raises(CaseError) as error:
        model_from_text("")
    for item in NUMBERS:
        assert (f"[{item.table}] has no {item.name}; " in str(error.value)) == item.required
    assert "schema" in str(error.value)


def test_all_faults_are_told_at_once_in_the_order_of_the_lines():
    text = with_line("mass_kg_m", "mass_kg = 50").replace("yaw_deg = 0.0", "yaw_deg = 300")
    text = text.replace('"blend"', '"clip"').replace("speed_m_s = 9.0", "speed_m_s = nan")
    with pytest.raises(CaseError) as error:
        model_from_text(text, name="bridge.toml")
    first, *rest = str(error.value).splitlines()
    assert first == "bridge.toml: 4 faults"
    assert [int(re.findall(r"line (\d+):", line)[0]) for line in rest] == [7, 8, 13, 29]


def test_no_toml_names_the_line():
    with pytest.raises(CaseError, match=r"not a TOML file: .*line 2"):
        model_from_text("schema = 1\nspeed = = 3")


def test_a_decimal_comma_is_pointed_out():
    with pytest.raises(CaseError, match=r"line 12, .*write a decimal point, not a comma"):
        model_from_text(with_line("diameter_mm", "diameter_mm = 79,0"))


def test_the_example_of_a_missing_mass_is_that_of_its_table():
    with pytest.raises(CaseError, match=r'\[rivulet\] has no mass; .* mass_kg_m = 0.2 or mass = "0.2 kg/m"'):
        model_from_text(EXAMPLE.replace("mass_kg_m = 0.2", ""))


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(CaseError, match="no such file; 'rainwind new"):
        read_case(tmp_path / "none.toml")
    with pytest.raises(CaseError, match="a folder"):
        read_case(tmp_path)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(CaseError, match="UTF-8"):
        read_case(tmp_path / "binary.toml")
    with pytest.raises(CaseError, match="cannot be read"):
        read_case("a\0b.toml")


def test_a_byte_order_mark_is_no_fault(tmp_path):
    (tmp_path / "case.toml").write_text(EXAMPLE, encoding="utf-8-sig")
    assert read_case(tmp_path / "case.toml").section.inclination == pi / 4
