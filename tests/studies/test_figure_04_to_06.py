"""Figures 4, 5 and 6: coefficients, equilibria, growth of D."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rainwind as rw
from rainwind.studies import figure_04_coefficients as figure_04
from rainwind.studies import figure_05_equilibria as figure_05
from rainwind.studies import figure_06_stability as figure_06
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import equilibria_by_letter, speed_window

approx = pytest.approx
AUTO = json.loads((Path(__file__).parents[1] / "validation/auto/reference.json").read_text(encoding="utf-8"))


def auto(curve, name):
    """The first of AUTO-07p's points of this name; it has the raw polynomials, outside="extend"."""
    return next(point for point in AUTO["points"][curve] if point["name"] == name)


@pytest.fixture(scope="module")
def equilibria():
    return figure_05.compute()


@pytest.fixture(scope="module")
def growth():
    return figure_06.compute()


def test_moment_touches_the_static_balance_at_the_fold():
    result = figure_04.compute()
    angle, moment = result.contact
    assert -np.degrees(angle) == approx(np.degrees(auto("equilibria", "fold")["state"][1]), abs=1e-4)
    needed = result.balance[result.onset]
    assert np.interp(angle, result.alpha, needed) == approx(moment, abs=1e-4)
    difference = result.blend[2] - needed
    near = np.abs(result.alpha - angle) < np.radians(10)
    assert np.all(difference[near] > -1e-5)  # the curves touch and do not cross


def test_blend_equals_the_raw_curve_in_the_valid_range():
    result = figure_04.compute()
    low, high = result.own.valid
    inside = (result.alpha >= low) & (result.alpha <= high)
    assert np.abs(result.blend - result.raw)[:, inside].max() < 1e-4


def test_coefficients_are_not_called_yamaguchis():
    figure = figure_04.draw(figure_04.compute(), Figure())
    assert "not Yamaguchi's data" in figure.get_suptitle()
    assert "reconstructed" in figure.get_suptitle()


def test_two_equilibria_below_8_metres_per_second_and_four_above():  # section 4.1, T1
    below = equilibria_by_letter(rw.paper_model().with_parameters({"wind.speed": 7.0}))
    above = equilibria_by_letter(rw.paper_model().with_parameters({"wind.speed": 9.0}))
    assert {letter: e.kind for letter, e in below.items()} == {"A": "stable focus", "B": "saddle"}
    assert above["A"].kind == "stable focus"
    assert above["B"].kind == above["C"].kind == "saddle"
    assert above["D"].kind == "unstable focus"
    assert above["B"]["phi"] < above["D"]["phi"] < above["C"]["phi"] < above["A"]["phi"]


def test_fold_at_8_metres_per_second(equilibria):  # section 4.1, T2
    assert equilibria.onset == approx(8.0, abs=0.05)
    assert equilibria.onset == approx(auto("equilibria", "fold")["speed"], abs=1e-4)
    assert equilibria.equilibria.speeds == paper.SPEEDS


def test_upper_rivulet_at_45_degrees_at_9_metres_per_second_falling_with_the_wind(equilibria):  # T3
    upper = equilibria.equilibria["D"]
    assert np.degrees(upper.at(9.0)[1]) == approx(45.0, abs=2.0)
    assert np.all(np.diff(upper.states()[1][:, 1]) < 0)


def test_letters_are_on_the_figure(equilibria):
    figure = figure_05.draw(equilibria, Figure())
    texts = {" ".join(text.get_text().split()) for text in figure.axes[0].texts}
    assert {"A", "B", "C", "D", "fold 8.00 m/s", "Hopf 14.80 m/s"} <= texts
    assert "undisturbed" in figure.axes[0].get_xlabel()


def test_upper_hopf_point_at_14_8_metres_per_second(growth):  # section 4.2, T4
    assert growth.hopf_on_d[-1].parameter == approx(14.8, abs=0.05)
    assert growth.hopf_on_d[-1].parameter == approx(auto("equilibria", "Hopf on D")["speed"], abs=1e-4)
    speed, value = growth.growth["D"]
    assert np.all((value > 0) == (speed < growth.hopf_on_d[-1].parameter))


def test_low_hopf_point_lies_on_c(growth):
    (low,) = growth.hopf_on_c
    assert low.parameter == approx(auto("equilibria", "Hopf on C")["speed"], abs=1e-4)
    speed, value = growth.oscillating["C"]
    assert np.interp(low.parameter, speed, value) == approx(0.0, abs=1e-5)
    assert value[0] == approx(0.010515191, abs=1e-6)  # AUTO's fold: both sides start there
    assert growth.growth["D"][1][0] == approx(value[0], abs=1e-9)


@pytest.mark.parametrize("study", [figure_04, figure_05, figure_06])
def test_tables_are_finite_and_name_their_units(study):
    tables = study.tables(study.compute())
    assert tables
    for name, table in tables.items():
        for label, column in table.columns.items():
            assert np.ndim(column.values) == 1, (name, label)
            assert label not in ("wind_speed", "phi", "alpha") or column.unit


def test_window_follows_the_onset():
    light = rw.paper_model().with_parameters({"rivulet.mass": 0.05})  # onset as the root of the mass: 4 m/s
    assert speed_window(light) == (2.0, 10.0)
