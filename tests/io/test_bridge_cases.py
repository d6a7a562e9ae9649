"""Case files of bridges: what is read, and each fault with its line."""

import re
from contextlib import suppress
from dataclasses import replace
from math import inf, isclose, pi, radians, sqrt
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rainwind.engineering.bridge import Bridge, ClimateSource, Limits, Question, Site
from rainwind.engineering.cable import SURFACES, Cable, Damper
from rainwind.errors import CaseError
from rainwind.io.bridge_cases import bridge_from_text, is_bridge_case, read_bridge
from rainwind.io.bridge_schema import BRIDGE_KEYS
from rainwind.io.case_files import new_case_text
from rainwind.io.new_bridge import new_bridge_text
from rainwind.io.toml_values import toml_value
from rainwind.io.units import written
from rainwind.physics.rivulet import Rivulet

EXAMPLE = new_bridge_text()
EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*/*.toml"))

# each stay's lines are named in the faults below
TWO = """\
schema = 1
[bridge]
name = "Two"
[[cable]]
name = "A"
length_m = 100
diameter_mm = 160
mass_kg_m = 60
tension_kN = 3000
inclination_deg = 30
heading_deg = 270
damping_percent = 0.2
base_height_m = 12
surface = "helical fillet"
bending_stiffness_kNm2 = 0
[[cable.damper]]
position_m = 3
coefficient_kNs_m = 100
[[cable]]
name = "B"
length_m = 120
diameter_mm = 160
mass_kg_m = 60
tension = "3 MN"
inclination_deg = 25
heading_deg = 90
"""


def with_line(key: str, line: str, text: str = TWO) -> str:
    """The text with the first line of `key` replaced."""
    text, count = re.subn(rf"(?m)^{key} = .*$", lambda _: line, text, count=1)
    assert count == 1
    return text


def faults_of(text: str, folder: Path | None = None) -> list[str]:
    with pytest.raises(CaseError) as error:
        bridge_from_text(text, "bridge.toml", folder)
    first, *rest = str(error.value).splitlines()
    assert first == f"bridge.toml: {len(rest)} fault{'s' if len(rest) > 1 else ''}"
    return [line.strip() for line in rest]


def test_stays_in_si():
    bridge = bridge_from_text(TWO)
    assert bridge.stays == (
        Cable(
            "A",
            100.0,
            0.16,
            60.0,
            3e6,
            radians(30),
            radians(270),
            damping_ratios=(0.002,),
            surface="helical fillet",
            base_height=12.0,
            dampers=(Damper(3.0, 1e5),),
        ),
        Cable(
            "B",
            120.0,
            0.16,
            60.0,
            3e6,
            radians(25),
            radians(90),
            # what the program fills in was measured by nobody
            assumed=("damping", "surface", "base_height", "bending_stiffness"),
        ),
    )
    assert bridge == Bridge("Two", bridge.stays)


def test_everything_else_in_si(tmp_path: Path):
    (tmp_path / "year.csv").write_text("time,speed_m_s\n0,1\n", encoding="utf-8")
    text = f"""{TWO}
[site]
profile = "logarithmic"
reference_height = "40 m"
roughness_cm = 1
density_kg_m3 = 1.2
[climate]
file = "year.csv"
height_m = 30
look_back_min = 90
rain_threshold = "0.5 mm/h"
[limits]
amplitude_diameters = 1
observed_high_km_h = 72
[assessment]
modes = 4
directions = 12
low_m_s = 5
sets = ["reconstructed"]
samples = 3
seed = 7
[rivulet]
mass_g_m = 100
height_mm = 4
friction_Nms = 0.1
[[damper]]
position_m = 2
coefficient_kNs_m = 50
support_stiffness_MN_m = 4
end = "upper"
stays = ["B"]
"""
    bridge = bridge_from_text(text, folder=tmp_path)
    assert bridge.site == Site("logarithmic", 40.0, roughness=0.01, density=1.2)
    assert bridge.climate == ClimateSource(tmp_path / "year.csv", 30.0, 5400.0, 0.5)
    assert bridge.limits == Limits(1.0, (5.0, 20.0))
    assert bridge.question == Question(4, 12, (5.0, 40.0), ("reconstructed",), 3, 7)
    assert bridge.rivulet == Rivulet(0.1, 0.004, 0.1)
    assert [stay.dampers for stay in bridge.stays] == [
        (Damper(3.0, 1e5),),
        (Damper(2.0, 5e4, 4e6, "upper"),),
    ]


def test_defaults_fill_what_stays_leave_out():
    text = f"""{TWO}
[cable_defaults]
damping_percent = [0.1, 0.05]
surface = "dimples"
assumed = ["damping", "heading"]
"""
    a, b = bridge_from_text(text).stays
    assert (a.damping_ratios, a.surface) == ((0.002,), "helical fillet")
    assert a.assumed == ("heading",)  # its damping is its own
    assert (b.damping_ratios, b.surface) == ((0.001, 0.0005), "dimples")
    assert b.assumed == ("damping", "heading", "base_height", "bending_stiffness")


def test_a_damper_for_all_and_one_stay_without_brackets():
    text = TWO.split("[[cable]]\n")[0] + "[cable]\n" + TWO.split("[[cable]]\n")[2]
    text += "[damper]\nposition_m = 4\ncoefficient_Ns_m = 1000\n"
    (stay,) = bridge_from_text(text).stays
    assert stay.dampers == (Damper(4.0, 1000.0, inf, "lower"),)


def test_the_file_names_the_bridge_that_has_no_name():
    assert bridge_from_text(TWO.replace('name = "Two"\n', ""), "a/north.toml").name == "north"


# ---- faults: key whose first line is replaced, the line, words of the message

FAULTS = {
    "tension in kN for MN": (
        "tension_kN",
        "tension_kN = 3",
        "line 9: tension_kN = 3 with 60 kg/m over 100 m gives a first frequency of 0.0354 Hz and, if all mass is "
        "steel, a stress of 0.3925 MPa; allowed is 0.05 to 20 Hz and 5 to 20000 MPa; with a thousand times the "
        "tension it would be 1.12 Hz: is the unit right, kN or MN?",
    ),
    "tension in MN for kN": (
        "tension_kN",
        "tension_MN = 3000",
        "line 9: tension_MN = 3000 with 60 kg/m over 100 m gives a first frequency of 35.4 Hz and, if all mass is "
        "steel, a stress of 392500 MPa; allowed is 0.05 to 20 Hz and 5 to 20000 MPa; with a thousandth of the tension",
    ),
    "text for a tension": (
        "tension_kN",
        'tension = "3000"',
        "line 9: tension = '3000' has no unit; write a force",
    ),
    "mass for a force": (
        "tension_kN",
        'tension = "300 t"',
        "line 9: tension = '300 t' has the unit 't', which is no unit",
    ),
    "no unit": ("length_m", "length = 100", "line 6: length = 100 has no unit; write length_m or length_cm"),
    "damper beyond mid-span": (
        "position_m",
        "position_m = 50",
        "line 17: position_m = 50 lies beyond mid-span of stay 'A', which is 100 m long; give the distance from the",
    ),
    "damper behind its anchorage": (
        "position_m",
        "position_m = -1",
        "line 17: position_m = -1: damper.position = -1",
    ),
    "per cent as a ratio": (
        "damping_percent",
        "damping_ratio = 0.15",
        "line 12: damping_ratio = 0.15 is 15 % of critical; no stay has more than 5 % without dampers; "
        "damping_percent = 0.15 if per cent are meant",
    ),
    "one of several dampings": (
        "damping_percent",
        "damping_percent = [0.1, 20]",
        "line 12: damping_percent = [0.1, 20] is 20 % of critical",
    ),
    "negative damping": (
        "damping_percent",
        "damping_percent = [0.1, -1]",
        "line 12: damping_percent = [0.1, -1]: cable",
    ),
    "no damping": ("damping_percent", "damping_percent = []", "line 12: damping_percent = [] is empty"),
    "damping as text": (
        "damping_percent",
        'damping_percent = ["x"]',
        "line 12: damping_percent = 'x' is text",
    ),
    "heading": (
        "heading_deg",
        "heading_deg = 400",
        "line 11: heading_deg = 400 is 6.98132 rad; allowed is 0 to 2 pi rad (0 to 360 deg)",
    ),
    "heading in degrees as radians": (
        "heading_deg",
        "heading_rad = 270",
        "line 11: heading_rad = 270 is 270 rad; allowed",
    ),
    "inclination": (
        "inclination_deg",
        "inclination_deg = 100",
        "line 10: inclination_deg = 100 is 1.74533 rad; allowed",
    ),
    "negative length": (
        "length_m",
        "length_m = -100",
        "line 6: length_m = -100: cable.length = -100 is not allowed",
    ),
    "unknown key": (
        "surface",
        'sourface = "smooth"',
        "line 14: unknown key 'sourface' in [[cable]]; did you mean 'surface'?",
    ),
    "key of a damper": (
        "surface",
        "position_m = 3",
        "line 14: unknown key 'position_m' in [[cable]]; it belongs in [damper]",
    ),
    "unknown surface": (
        "surface",
        'surface = "helical"',
        "line 14: surface = 'helical' is not known; did you mean 'helical fillet'?",
    ),
    "unknown assumed": (
        "surface",
        'assumed = ["tensions"]',
        "line 14: assumed: there is no key 'tensions'; did you mean 'tension'?",
    ),
    "assumed is no list": (
        "surface",
        'assumed = "tension"',
        "line 14: assumed = 'tension' is no list of texts; write assumed = [",
    ),
    "missing mass": (
        "mass_kg_m",
        "",
        'line 4: [[cable]] has no mass; add for example mass_kg_m = 60 or mass = "60 kg/m"',
    ),
    "name is a number": (
        "mass_kg_m",
        "mass_kg_m = 60\nname_of = 3",
        "line 9: unknown key 'name_of' in [[cable]]; did you",
    ),
    "end of a damper": (
        "coefficient_kNs_m",
        'coefficient_kNs_m = 1\nend = "top"',
        "line 19: end = 'top' is not known",
    ),
    "missing coefficient": (
        "coefficient_kNs_m",
        "",
        "line 16: [[cable.damper]] has no coefficient; add for example",
    ),
    "stays of its own damper": (
        "coefficient_kNs_m",
        'coefficient_kNs_m = 9\nstays = ["A"]',
        "line 19: stays is for a [[damper]] that serves several",
    ),
    "bridge's name": ("name", "name = 3", 'line 3: name = 3 is no text; write name = "A bridge"'),
}


@pytest.mark.parametrize(("key", "line", "words"), FAULTS.values(), ids=FAULTS.keys())
def test_one_fault_of_a_stay(key: str, line: str, words: str):
    (fault,) = faults_of(with_line(key, line))
    assert fault.startswith(words)


@pytest.mark.parametrize(
    ("length", "tension", "words"),
    [
        (30, "tension_kN = 3", "0.118 Hz and, if all mass is steel, a stress of 0.3925 MPa"),
        (200, "tension_MN = 3000", "17.7 Hz and, if all mass is steel, a stress of 392500 MPa"),
    ],
)
def test_a_slip_that_the_frequency_alone_does_not_show(length: float, tension: str, words: str):
    (fault,) = faults_of(with_line("tension_kN", tension, with_line("length_m", f"length_m = {length}")))
    assert words in fault
    assert fault.endswith("is the unit right, kN or MN?")


MORE = {
    "two of one name": (
        "",
        TWO.replace('"B"', '"A"'),
        "line 20: name = 'A': another stay has this name; give each its own",
    ),
    "no stay": ("", "schema = 1\n[bridge]\n", "no stay is given; write [[cable]] once for each stay"),
    "unknown table": ("[climat]\n", TWO, "line 27: unknown table 'climat'; did you mean 'climate'?"),
    "table of a section": (
        "[wind]\n",
        TWO,
        "line 27: unknown table 'wind'; it belongs to the case of one section",
    ),
    "table as a list": ("[[site]]\n", TWO, "line 27: 'site' is no table; write [site] and its keys"),
    "damper that is no table": (
        "[stays]\nfile = 3\n",
        TWO,
        'line 28: file = 3 is no text; write file = "stays.csv"',
    ),
    "unknown profile": (
        '[site]\nprofile = "log"\n',
        TWO,
        "line 28: profile = 'log' is not known; words allowed: uniform, power, logarithmic",
    ),
    "exponent as text": ('[site]\nexponent = "a"\n', TWO, "line 28: exponent = 'a' is text, not a number"),
    "negative exponent": ("[site]\nexponent = -1\n", TWO, "line 28: site.exponent = -1 is not allowed"),
    "rough beyond the reference height": (
        '[site]\nprofile = "logarithmic"\nroughness_m = 20\n',
        TWO,
        "line 27: site.roughness = 20 m must be less than the reference height, 10 m",
    ),
    "no climate file": (
        '[climate]\nfile = "none.csv"\n',
        TWO,
        "line 28: file = 'none.csv': there is no such file; give its name relative to the case file",
    ),
    "empty climate file": ('[climate]\nfile = "empty.csv"\n', TWO, "line 28: file = 'empty.csv': is empty"),
    "climate without records": (
        '[climate]\nfile = "head.csv"\n',
        TWO,
        "line 28: file = 'head.csv': has headers and no record",
    ),
    "climate is a folder": (
        '[climate]\nfile = "."\n',
        TWO,
        "line 28: file = '.': is a folder; name the file in it",
    ),
    "climate without a file": (
        "[climate]\nheight_m = 3\n",
        TWO,
        "line 27: [climate] has no file; add for example file =",
    ),
    "look back": (
        '[climate]\nfile = "year.csv"\nlook_back_h = -1\n',
        TWO,
        "line 29: look_back_h = -1: climate.look_back = -3600 is not allowed: it must be 0 or more",
    ),
    "observed speeds": (
        "[limits]\nobserved_low_m_s = 20\n",
        TWO,
        "line 28: limits.observed_speeds = (20, 18) must be two",
    ),
    "observed speeds that are not looked at": (
        "[limits]\nobserved_low_m_s = 45\nobserved_high_m_s = 50\n",
        TWO,
        "line 27: limits.observed_speeds = (45, 50) lie outside assessment.speeds = (3, 40)",
    ),
    "speeds looked at that are not observed": (
        "[assessment]\nlow_m_s = 20\n",
        TWO,
        "line 27: limits.observed_speeds = (5, 18) lie outside assessment.speeds = (20, 40)",
    ),
    "speeds": (
        "[assessment]\nhigh_m_s = 300\n",
        TWO,
        "line 28: assessment.speeds = (3, 300) must be two speeds up to 100",
    ),
    "modes": ("[assessment]\nmodes = 3.5\n", TWO, "line 28: modes = 3.5 is no whole number; write modes = 3"),
    "samples": (
        "[assessment]\nsamples = 1\n",
        TWO,
        "line 28: assessment.samples = 1 must be a whole number from 2 to 1024",
    ),
    "sets": ('[assessment]\nsets = ["x"]\n', TWO, "line 28: sets: 'x': there is no coefficient set 'x'"),
    "set without moment": (
        '[assessment]\nsets = ["gu-lu-2001-lift-drag"]\n',
        TWO,
        "line 28: sets: 'gu-lu-2001-lift-drag' has no moment curve, and the rivulet needs one",
    ),
    "no sets": ("[assessment]\nsets = []\n", TWO, "line 28: assessment.sets is empty"),
    "rivulet without friction": (
        "[rivulet]\nmass_kg_m = 0.1\nheight_mm = 4\n",
        TWO,
        "line 27: [rivulet] has no friction; add for example friction_Nms = 0.05",
    ),
    "rivulet as high as a stay": (
        "[rivulet]\nmass_kg_m = 0.1\nfriction_Nms = 0.05\nheight_mm = 160\n",
        TWO,
        "line 30: height_mm = 160: a rivulet of 160 mm is as high as stay 'A' is thick, 160 mm",
    ),
    "damper of no stay": (
        '[[damper]]\nposition_m = 2\ncoefficient_kNs_m = 50\nstays = ["C"]\n',
        TWO,
        "line 30: stays: there is no stay 'C'; stays allowed: A, B",
    ),
    "default": ("[cable_defaults]\nheading_deg = 400\n", TWO, "line 28: heading_deg = 400 is 6.98132 rad"),
    "name as a default": (
        '[cable_defaults]\nname = "A"\n',
        TWO,
        "line 28: unknown key 'name' in [cable_defaults]; it belongs in",
    ),
    "no schema": ("", TWO.replace("schema = 1\n", ""), "no 'schema'; write schema = 1 above the first table"),
}


@pytest.mark.parametrize(("added", "text", "words"), MORE.values(), ids=MORE.keys())
def test_one_fault_elsewhere(added: str, text: str, words: str, tmp_path: Path):
    (tmp_path / "empty.csv").write_text("\n# nothing yet\n", encoding="utf-8")
    (tmp_path / "head.csv").write_text("time,speed_m_s\n", encoding="utf-8")
    (tmp_path / "year.csv").write_text("time,speed_m_s\n0,1\n", encoding="utf-8")
    (fault,) = faults_of(text + added, tmp_path)
    assert fault.startswith(words)


def test_all_faults_are_told_at_once_and_one_does_not_hide_another():
    text = with_line("heading_deg", "heading_deg = 400")
    text = with_line("tension_kN", "tension_kN = 3", text)
    text = with_line("position_m", "position_m = 60", text)
    text = with_line("mass_kg_m", "mass_kg_m = 60\nmas_kg_m = 3", text)
    text = with_line("tension", 'tension = "3 N"', text) + "[site]\nheight_m = 3\n"
    lines = [int(re.findall(r"^line (\d+):", fault)[0]) for fault in faults_of(text)]
    assert lines == [9, 10, 12, 18, 25, 29]


def test_no_toml_and_no_file(tmp_path: Path):
    with pytest.raises(CaseError, match=r"not a TOML file: .*line 2"):
        bridge_from_text("schema = 1\nbridge = = 3")
    with pytest.raises(CaseError, match="no such file"):
        read_bridge(tmp_path / "none.toml")


def test_which_kind_a_file_is(tmp_path: Path):
    case = tmp_path / "case.toml"
    for text, bridge in (
        (EXAMPLE, True),
        (TWO, True),
        (new_case_text(), False),
        ("[stays]", True),
        ("[cable]", True),
        ("[bridge]", True),
        ("[site]", False),
    ):
        case.write_text(text, encoding="utf-8")
        assert is_bridge_case(case) is bridge
    case.write_text("a = = b", encoding="utf-8")
    with pytest.raises(CaseError, match="not a TOML file"):
        is_bridge_case(case)


ODD = (
    "true",
    "nan",
    "-1",
    "0",
    '"x"',
    '""',
    "[]",
    "{}",
    "1e400",
    "2020-01-01",
    '[1, "a"]',
    "[[]]",
    "[{a = 1}]",
)


@pytest.mark.parametrize("value", ODD)
def test_any_value_is_read_or_refused_and_never_another_error(value: str, tmp_path: Path):
    (tmp_path / "climate.csv").write_text("time,speed_m_s\n0,1\n", encoding="utf-8")
    (tmp_path / "stays.csv").write_text("name,length_m\nS2,90\n", encoding="utf-8")
    lines = switched_on().splitlines()
    bridge_from_text("\n".join(lines), folder=tmp_path)
    for index, line in enumerate(lines):
        key, equals, _ = line.partition(" = ")
        if line.startswith(("#", "[")) or not equals:
            continue
        text = "\n".join([*lines[:index], f"{key} = {value}", *lines[index + 1 :]])
        with suppress(CaseError):
            bridge_from_text(text, folder=tmp_path)
    for table in (*BRIDGE_KEYS.tables, "cable.damper"):
        with pytest.raises(CaseError):
            bridge_from_text(f"schema = 1\n{table} = {value}\n", folder=tmp_path)


def switched_on() -> str:
    """The example with all that is switched off, and what its table of stays leaves out."""
    text = re.sub(r"(?m)^# (?=\[|\w+ = )", "", EXAMPLE)
    more = "diameter_mm = 160\nmass_kg_m = 60\ntension_kN = 3000\ninclination_deg = 30\n"
    return text.replace("[site]", more + "[site]")


# ---- the example, and those shipped


def test_the_example_reads_with_every_table_switched_on(tmp_path: Path):
    bridge = bridge_from_text(EXAMPLE)
    assert bridge.stays[0].length == 130.0
    assert bridge.question == replace(Question(), sets=bridge.question.sets)
    assert (bridge.site, bridge.limits) == (Site(), Limits())
    on = switched_on()
    (tmp_path / "climate.csv").write_text("time,speed_m_s\n0,1\n", encoding="utf-8")
    table = "name,length_m\nS2,90\n"
    (tmp_path / "stays.csv").write_text(table, encoding="utf-8")
    whole = bridge_from_text(on, folder=tmp_path)
    assert [stay.name for stay in whole.stays] == ["S1", "S2"]
    assert whole.climate == ClimateSource(tmp_path / "climate.csv")
    assert whole.rivulet == Rivulet(0.2, 0.01, 0.05)
    for item in (*BRIDGE_KEYS.numbers, *BRIDGE_KEYS.options):
        assert item.name == "stays" or re.search(rf"(?m)^{item.name}(_\w+)? = ", on), item.name


def test_examples_are_found():
    assert len(EXAMPLES) >= 4


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_shipped_examples_read_and_say_what_is_assumed(path: Path):
    bridge = read_bridge(path)
    assert bridge.sources
    assert bridge.assumptions
    assert all(stay.assumed for stay in bridge.stays)


def test_fred_hartmans_frequencies():
    """Those of the table, which are not in the file, agree with the string's to 0.13 %."""
    hertz = (1.893, 1.355, 1.300, 1.215, 1.071, 1.012, 0.881, 0.782, 0.759, 0.668, 0.648, 0.617)
    stays = read_bridge(next(path for path in EXAMPLES if "fred" in str(path))).stays
    names = [f"{number}S" for number in range(13, 25)]
    assert [stay.name for stay in stays] == names
    for stay, frequency in zip(stays, hertz, strict=True):
        assert isclose(sqrt(stay.tension / stay.mass) / (2 * stay.length), frequency, rel_tol=1.3e-3)


@pytest.mark.parametrize(("folder", "hertz"), [("stavanger_c1e", 1.05), ("paper_cable", 1.0)])
def test_tensions_from_the_frequency(folder: str, hertz: float):
    (stay,) = read_bridge(next(path for path in EXAMPLES if path.parent.name == folder)).stays
    assert isclose(sqrt(stay.tension / stay.mass) / (2 * stay.length), hertz, rel_tol=1e-6)


# ---- a bridge written as text reads back

positive = st.floats(0.5, 500.0)
small = st.floats(0.0, 0.05)
names = st.text(st.characters(codec="ascii", exclude_categories=["C"]), min_size=1).filter(
    lambda text: text.strip() == text
)


@st.composite
def cables(draw: st.DrawFn, name: str) -> Cable:
    length, mass, stress = draw(st.floats(20, 600)), draw(st.floats(3, 300)), draw(st.floats(5e7, 2e9))
    return Cable(
        name,
        length,
        draw(st.floats(0.05, 0.4)),
        mass,
        stress * mass / 7850,
        draw(st.floats(0, pi / 2)),
        draw(st.floats(0, 2 * pi)),
        axial_stiffness=draw(st.none() | st.floats(1e6, 1e10)),
        bending_stiffness=draw(st.floats(0, 1e7)),
        damping_ratios=tuple(draw(st.lists(small, min_size=1, max_size=3))),
        surface=draw(st.sampled_from(SURFACES)),  # type: ignore[arg-type]
        base_height=draw(st.floats(0, 300)),
        chainage=draw(st.none() | st.floats(-1e3, 1e3)),
        dampers=tuple(
            Damper(
                draw(st.floats(0.1, 0.49 * length)),
                draw(st.floats(1.0, 1e6)),
                draw(st.just(inf) | st.floats(1e3, 1e9)),
                draw(st.sampled_from(("lower", "upper"))),  # type: ignore[arg-type]
            )
            for _ in range(draw(st.integers(0, 2)))
        ),
        assumed=draw(st.sampled_from(((), ("tension",), ("heading", "dampers")))),
    )


@st.composite
def bridges(draw: st.DrawFn) -> Bridge:
    low, high = sorted(draw(st.lists(st.floats(0.5, 90.0), min_size=2, max_size=2, unique=True)))
    return Bridge(
        draw(names),
        tuple(draw(cables(name)) for name in draw(st.lists(names, min_size=1, max_size=3, unique=True))),
        Site(
            draw(st.sampled_from(("uniform", "power"))),  # type: ignore[arg-type]
            *draw(st.tuples(positive, positive, positive, positive)),
        ),
        draw(st.none() | st.builds(Rivulet, st.floats(0.001, 1), st.floats(0, 0.04), st.floats(0, 1))),
        limits=Limits(draw(positive), (low, high)),
        question=Question(
            draw(st.integers(1, 20)), 36, (low, high), ("reconstructed",), draw(st.integers(2, 99)), 3
        ),
        assumptions=tuple(draw(st.lists(names, max_size=2))),
        sources=tuple(draw(st.lists(names, max_size=2))),
    )


def number(table: str, name: str, value: float | tuple[float, ...]) -> str:
    """The line of a number in the preferred unit, or in SI where that does not give it back."""
    kind = BRIDGE_KEYS.numbers_of(table)[name].kind
    if isinstance(value, tuple):
        return f"{name}_{next(iter(kind.suffixes))} = {toml_value(value)}"
    suffix, shown = written(value, kind)
    return f"{name}_{suffix} = {shown!r}"


def record(table: str, thing: object, names: dict[str, str] | None = None, header: str = "") -> list[str]:
    """Lines of one table: the fields of a frozen record under the names of the keys."""
    keys = {**{n: i.field for n, i in BRIDGE_KEYS.numbers_of(table).items()}, **(names or {})}
    lines = [header or f"[{table}]"]
    for name, field in keys.items():
        value = getattr(thing, field)
        if value is None or value == inf:
            continue
        plain = name in BRIDGE_KEYS.options_of(table)
        lines.append(f"{name} = {toml_value(value)}" if plain else number(table, name, value))
    return lines


def text_of(bridge: Bridge) -> str:
    same = {name: name for name in ("name", "surface", "assumed")}
    lines = ["schema = 1", *record("bridge", bridge, {n: n for n in ("name", "assumptions", "sources")})]
    for stay in bridge.stays:
        lines += record("cable", stay, same, "[[cable]]")
        for damper in stay.dampers:
            lines += record("damper", damper, {"end": "end"}, "[[cable.damper]]")
    lines += record("site", bridge.site, {"profile": "profile", "exponent": "exponent"})
    low, high = bridge.limits.observed_speeds
    lines += ["[limits]", f"amplitude_diameters = {bridge.limits.amplitude_diameters!r}"]
    lines += [f"observed_low_m_s = {low!r}", f"observed_high_m_s = {high!r}"]
    low, high = bridge.question.speeds
    lines += ["[assessment]", f"low_m_s = {low!r}", f"high_m_s = {high!r}"]
    lines += [
        f"{name} = {toml_value(getattr(bridge.question, name))}"
        for name in ("modes", "directions", "sets", "samples", "seed", "runs")
    ]
    if bridge.rivulet is not None:
        lines += record("rivulet", bridge.rivulet)
    return "\n".join(lines) + "\n"


@settings(max_examples=60, deadline=None)
@given(bridges())
def test_a_bridge_written_as_text_reads_back_equal(bridge: Bridge):
    assert bridge_from_text(text_of(bridge)) == bridge
