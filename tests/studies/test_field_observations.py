"""The assessment beside observed vibrations: the sources' own numbers, what is wrong, and docs/validation.md."""

import re
from math import acos, cos, degrees, pi, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from rainwind.engineering.criteria import rule_damping
from rainwind.engineering.observed import observed_cases, stays_table
from rainwind.engineering.sources import STATUS_WORDS
from rainwind.plotting import style
from rainwind.studies import field_observations
from rainwind.studies.field_observations import Result
from rainwind.studies.field_rivulets import Three, three_rules
from rainwind.studies.field_tables import rules_markdown

approx = pytest.approx
ROOT = Path(__file__).parents[2]
CASES = {case.name: case for case in observed_cases()}
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?")


@pytest.fixture(scope="module")
def result() -> Result:
    return field_observations.compute()


@pytest.fixture(scope="module")
def threes() -> tuple[Three, ...]:
    return three_rules()


# ---- what the sources say ----


def test_the_frequencies_of_fred_hartman_are_those_of_a_string():
    """FHWA-HRT-05-083, appendix F, table 15: f = sqrt(T/m) / 2L to 0.13 %."""
    for _, mass, tension, length, frequency in stays_table()["fred_hartman"]["rows"]:
        assert sqrt(1e6 * tension / mass) / (2 * length) == approx(frequency, rel=0.0014)


def test_reduced_speeds_are_those_of_the_sources():
    low, high = CASES["NRC rig at 55°"].reduced(1.23)
    assert (low, high) == (approx(19, abs=0.5), approx(45, abs=0.5))
    low, high = CASES["Stavanger C1E"].reduced(3 * 1.05)
    assert low < 35 < high


def test_yaw_and_the_angle_between_stay_and_wind():
    """Stavanger: 45 to 65 degrees between the stay and the wind, by vectors in space."""
    case = CASES["Stavanger C1E"]
    assert case.yaw is not None
    slope = case.cable.inclination
    down = np.array([cos(slope), 0.0, -sin(slope)])  # along the stay, as it descends
    angles = [degrees(acos(np.array([sin(yaw), cos(yaw), 0.0]) @ down)) for yaw in case.yaw]
    assert angles == approx([65, 45], abs=0.1)


def test_assumed_numbers_are_those_of_the_example():
    text = (ROOT / "examples/fred_hartman/stays.csv").read_text(encoding="utf-8")
    rows = {line.split(",")[0]: line.split(",") for line in text.splitlines()}
    for stay in ("16S", "24S"):
        cable = CASES[f"Fred Hartman {stay}"].cable
        _, length, diameter, mass, tension, inclination, _ = rows[stay]
        assert cable.length == float(length)
        assert cable.diameter == approx(float(diameter) / 1000)
        assert (cable.mass, cable.tension) == (float(mass), approx(1e6 * float(tension)))
        assert cable.inclination == approx(radians(float(inclination)))


def test_every_source_says_how_it_was_seen():
    for table in stays_table().values():
        if isinstance(table, dict):
            assert table["status"].split(" (")[0] in STATUS_WORDS


# ---- what the model says ----


def test_no_case_failed(result: Result):
    assert [one.answer.failure for one in result.cases] == [""] * len(CASES)
    assert [len(one.modes) for one in result.cases] == [case.modes for case in CASES.values()]


def test_a_rig_is_its_springs(result: Result):
    """Neither stretching nor sag: both planes have the spring's frequency."""
    for name in ("NRC rig at 30°", "NRC rig at 55°"):
        (mode,) = result.named(name).modes
        assert mode.frequency_out == approx(1.23, rel=1e-9)
        assert mode.frequency_in == approx(1.23, rel=1e-4)
        assert mode.rule_damping == approx(10 * 1.225 * 0.218**2 * 6.7 / 217, rel=1e-3)


def test_a_rig_that_stands_at_one_yaw_is_asked_for_no_other(result: Result):
    (mode,) = result.named("Hikami & Shiraishi rig").modes
    assert result.named("Hikami & Shiraishi rig").worst_yaw(mode) == approx(pi / 4)


def test_what_the_page_calls_right_and_wrong_is_so(result: Result):
    for one in result.cases:
        first, last = one.modes[0], one.modes[-1]
        # the onset's band overlaps the observed speeds, of all but one in every mode
        for mode in one.modes:
            assert mode.range_low.low < one.case.speeds[1]
        early = one.case.name == "Fred Hartman 16S"
        assert (first.range_low.high < one.case.speeds[0]) == early
        # no upper limit: in no mode does the middle of the band end
        for mode in one.modes:
            assert mode.range_high.middle == approx(40.0)
            assert mode.unlimited > 0.45
        # the first mode has the largest amplitude and needs the most damping, more than the rule asks for
        if first is not last:
            assert first.amplitude.middle > 3 * last.amplitude.middle
            assert first.damping_needed_observed.middle > 1.9 * last.damping_needed_observed.middle
            assert first.damping_needed_observed.middle > 1.5 * first.rule_damping


def test_what_the_page_says_of_both_ends_of_the_rule(threes: tuple[Three, ...]):
    """Large stays with a rivulet of one size need less than the PTI rule asks for, with one of one shape more."""
    for three in threes:
        if three[0].mode == 1 and three[0].case.cable.diameter > 0.16:
            least = rule_damping(three[0].case.cable, three[0].case.site.density)
            _, size, shape = (one.needed.middle / least for one in three)
            assert size < 0.85
            assert shape > 2


@pytest.mark.parametrize("name", ["speeds", "directions", "amplitudes", "damping"])
def test_the_tables_of_the_page_are_computed(result: Result, name: str):
    """Runs of 600 periods differ in their last digits from machine to machine; all else is to the digits printed."""
    page = (ROOT / "docs/validation.md").read_text(encoding="utf-8")
    computed = field_observations.markdown(result)[name]
    if name != "amplitudes":
        assert computed in page
        return
    lines = computed.splitlines()
    begin = page.index(lines[0])
    for printed, line in zip(page[begin:].splitlines(), lines, strict=False):
        assert NUMBER.sub("#", printed) == NUMBER.sub("#", line)
        for a, b in zip(NUMBER.findall(printed), NUMBER.findall(line), strict=True):
            assert float(a) == approx(float(b), rel=0.15, abs=0.2)


def test_small_vibrations_by_the_rule_are_those_of_the_assessment(threes: tuple[Three, ...], result: Result):
    """Found apart, with the pieces of the assessment: the same bands."""
    for rule, _, _ in threes:
        mode = result.named(rule.case.name).modes[rule.mode - 1]
        for band, other in (
            (rule.onset, mode.range_low),
            (rule.end, mode.range_high),
            (rule.needed, mode.damping_needed),
            (rule.needed_observed, mode.damping_needed_observed),
        ):
            assert (band.low, band.middle, band.high) == approx(
                (other.low, other.middle, other.high), rel=1e-9
            )
        assert rule.open == mode.unlimited


def test_the_table_of_both_ends_of_the_rule_is_computed(threes: tuple[Three, ...]):
    assert rules_markdown(threes) in (ROOT / "docs/validation.md").read_text(encoding="utf-8")


def test_the_onset_goes_with_the_root_of_the_rivulets_mass(threes: tuple[Three, ...]):
    """At one Froude number and height: U_n² is proportional to m_R (Peil & Nahrath 2003, eq. (6)).

    Of first modes: the latest ranges begin with the upper rivulet itself or just above. Mass 0.2 kg/m against 20 d².
    """
    for _, size, shape in threes:
        if size.mode == 1:
            d = size.case.cable.diameter
            assert size.onset.high / shape.onset.high == approx(0.1 / d, rel=0.01)


def test_the_page_says_what_was_assumed():
    page = (ROOT / "docs/validation.md").read_text(encoding="utf-8")
    for case in CASES.values():
        assert case.assumed in page
        assert case.source in page


def test_pictures_tables_and_sentences(result: Result, tmp_path: Path):
    figure = field_observations.draw(result, Figure())
    style.save(figure, tmp_path / "figure.png", dpi=40)
    speeds, amplitudes = figure.axes
    assert speeds.get_xlim() == (0.0, 40.0)
    assert amplitudes.get_xlabel().endswith("(diameters)")
    (table,) = field_observations.tables(result).values()
    count = sum(case.modes for case in CASES.values())
    assert table.columns["onset"].values.shape == (count, 3)
    sentences = field_observations.summary(result)
    assert [line.split(":")[0] for line in sentences] == list(CASES)


def test_what_was_seen_in_a_mode_is_not_compared_with_another(result: Result):
    """Stavanger: mode 3; Fred Hartman: which mode is not known."""
    lines = field_observations.markdown(result)["amplitudes"].splitlines()
    seen = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    assert [row[4] for row in seen if row[0] == "Stavanger C1E"] == ["–", "–", "1.0"]
    assert [row[4] for row in seen if row[0] == "Fred Hartman 24S"] == ["up to 4.1"] * 3
