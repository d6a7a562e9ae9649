"""How numbers, bands and verdicts are said: against texts written by hand."""

from math import inf, nan, pi

import pytest

from rainwind.engineering.answers import Band
from rainwind.reporting import words


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (nan, "none"),
        (None, "none"),
        (0.0, "0"),
        (inf, "no limit"),
        (1.2345, "1.23"),
        (0.012345, "0.0123"),
        (12345.6, "12346"),
        (-0.5, "\u22120.500"),
        (2e-5, "2.00e-05"),
    ],
)
def test_number(value, said):
    assert words.number(value) == said


@pytest.mark.parametrize(
    ("band", "said"),
    [
        (Band(0.0041, 0.0079, 0.0330), "0.0079 (0.0041 to 0.0330)"),
        (Band(7.49, 9.64, 11.0, 0.3125), "9.6 (7.5 to 11.0), in 31 % of samples"),
        (Band(0.31, 2.54, 12.04), "2.5 (0.3 to 12.0)"),
        (Band(1e-16, 1e-13, 0.0261), "0.000 (0.000 to 0.026)"),
        (Band(-0.29, 0.41, 1.25), "0.41 (\u22120.29 to 1.25)"),
        (Band(0.0, 0.0, 0.0), "0"),
        (Band(nan, nan, nan, 0.0), "none"),
        (None, "none"),
    ],
)
def test_band(band, said):
    assert words.band(band) == said


def test_band_with_its_unit_before_the_share():
    assert words.band(Band(1.0, 2.0, 3.0, 0.5), unit="m/s") == "2.0 (1.0 to 3.0) m/s, in 50 % of samples"


def test_a_band_in_a_cell_has_the_share_in_its_second_line():
    assert words.band_lines(Band(1.0, 2.0, 3.0, 0.999)) == "2.0 (1.0 to 3.0)\nin more than 99 % of samples"


@pytest.mark.parametrize(
    ("value", "said"), [(0.0, "0 %"), (0.001, "less than 1 %"), (0.5, "50 %"), (1.0, "100 %")]
)
def test_a_share_is_none_or_all_only_where_it_is(value, said):
    assert words.share(value) == said


@pytest.mark.parametrize(
    ("degrees", "said"),
    [(0, "0° (N)"), (135, "135° (SE)"), (359.9, "0° (N)"), (191.2, "191° (S)"), (22.5, "22° (NNE)")],
)
def test_compass(degrees, said):
    assert words.compass(degrees * pi / 180) == said


def test_margin():
    assert words.margin(inf) == "no damping needed"
    assert words.margin(0.6234) == "0.62"


def test_many_names_are_counted():
    assert words.joined(["a"]) == "a"
    assert words.joined(["a", "b", "c"]) == "a, b and c"
    assert words.joined([str(i) for i in range(14)]) == "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 2 more"


def test_a_name_for_a_figure_is_no_formula_and_has_no_control_characters():
    assert words.for_figure("$x^2$\x01 a") == r"\$x^2\$ a"
    assert len(words.for_figure("W" * 300)) == 24


def test_every_verdict_has_its_own_symbol_and_word():
    assert len({one.symbol for one in words.VERDICTS.values()}) == 4
    assert len({one.word for one in words.VERDICTS.values()}) == 4
