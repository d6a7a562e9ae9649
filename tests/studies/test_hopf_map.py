"""The map of Hopf curves at low damping, and all studies on models that lack what the paper's has."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rainwind as rw
from rainwind.physics.coefficients import CoefficientSet
from rainwind.plotting import style
from rainwind.studies import (
    figure_04_coefficients,
    figure_05_equilibria,
    figure_06_stability,
    figure_09_stability_diagram,
    figure_10_rivulet_and_frequency,
    figure_11_mass_coefficients_dof,
    hopf_map,
)

approx = pytest.approx
AUTO = json.loads((Path(__file__).parents[1] / "validation/auto/reference.json").read_text(encoding="utf-8"))
RATIO = "section.damping_ratio"
FLAT = CoefficientSet("flat", "no source: a test", "test", (-1.5, 0.0), [0.0], [1.2], [0.0])
STUDIES = [
    figure_04_coefficients, figure_05_equilibria, figure_06_stability, figure_09_stability_diagram,
    figure_10_rivulet_and_frequency, figure_11_mass_coefficients_dof, hopf_map,
]  # fmt: skip


@pytest.fixture(scope="module")
def result():
    return hopf_map.compute()


def test_hopf_hopf_point_as_auto_finds_it(result):
    (found,) = result.hopf_hopf
    reference = next(p for p in AUTO["points"]["hopf_curve"] if p["name"] == "HH")
    assert found[0] == approx(reference["speed"], abs=1e-5)
    assert found[1] == approx(reference["damping_ratio"], rel=1e-6)
    assert result.unstable_everywhere_below == approx(found[1], rel=1e-6)


def test_hopf_points_at_low_damping_lie_on_both_curves(result):
    low = [p["speed"] for p in AUTO["points"]["equilibria_low_damping"] if p["name"] == "HB"]
    assert result.diagram.hopf_speeds(0.0005) == approx(sorted(low)[1:], abs=2e-3)
    assert result.diagram.hopf_speeds(0.0005, "C") == approx(sorted(low)[:1], abs=2e-3)


def test_no_upper_limit_of_the_wind_speed_at_low_damping(result):
    (end,) = [p for p in AUTO["points"]["second_hopf_curve"] if p["speed"] > 25]
    i = np.argmin(np.abs(result.diagram.field.speed - end["speed"]))
    row = np.searchsorted(result.diagram.field.ratio, 0.0010)
    assert result.diagram.field.count[row, i] == 2
    assert result.unlimited_below == approx(0.00111, abs=1e-5)
    fast = rw.paper_model().with_parameters({"wind.speed": 40.0, RATIO: 0.0011})
    assert sum(e.eigenvalues.real.max() > 0 for e in rw.find_equilibria(fast)) == 3  # B, C and D
    assert "no upper limit" in result.statement


def test_counts_of_unstable_eigenvalues(result):
    field = result.diagram.field
    rng = np.random.default_rng(2)
    for _ in range(40):
        i, j = rng.integers(len(field.ratio)), rng.integers(5, len(field.speed))
        model = rw.paper_model().with_parameters({"wind.speed": field.speed[j], RATIO: field.ratio[i]})
        state = result.diagram.equilibria["D"].at(field.speed[j])
        upper = rw.find_equilibrium(model, state)
        if np.abs(upper.eigenvalues.real).min() > 1e-4:
            assert field.count[i, j] == np.sum(upper.eigenvalues.real > 0)
    assert set(np.unique(field.count)) == {0, 2, 4}


def test_every_limit_of_stability_is_explained_by_a_curve(result):
    """Where the count changes along a row of the field, a Hopf curve of D passes."""
    field = result.diagram.field
    for i in range(5, len(field.ratio), 9):
        changes = np.flatnonzero(np.diff(field.count[i, 1:])) + 1
        speeds = np.array(result.diagram.hopf_speeds(field.ratio[i]))
        for j in changes:
            between = (speeds > field.speed[j] - 1e-3) & (speeds < field.speed[j + 1] + 1e-3)
            assert between.any(), (field.ratio[i], field.speed[j])


def test_no_curve_is_drawn_twice(result):
    tops = sorted(
        (round(float(c[RATIO].max()), 5), round(float(c["phi"].mean()), 2)) for c in result.diagram.hopf
    )
    assert len(tops) == len(set(tops))
    assert {piece.letter for piece in result.diagram.pieces} == {"B", "C", "D"}


def test_statement_stands_on_the_figure(result):
    figure = hopf_map.draw(result, Figure())
    assert " ".join(figure.get_supxlabel().split()) == result.statement


def odd_models():
    sample = rw.paper_model()
    return {
        "no moment": (replace(sample, coefficients=FLAT), "no upper rivulet"),
        "no wind": (sample.with_parameters({"wind.density": 0.0}), "no upper rivulet"),
        "strongly stable": (sample.with_parameters({"rivulet.mass": 0.005, "rivulet.friction": 0.5}), "D"),
        "refuse": (rw.paper_model(outside="refuse"), "Hopf–Hopf"),
        "cable overdamped": (sample.with_parameters({RATIO: 1.5}), "Hopf–Hopf"),
    }


@pytest.mark.parametrize("name", list(odd_models()))
def test_every_study_takes_any_model(name, tmp_path):
    model, says = odd_models()[name]
    # what "refuse" changes shows in one diagram as well as in nine
    for study in STUDIES if name != "refuse" else (figure_05_equilibria, figure_06_stability, hopf_map):
        result = study.compute(model)
        style.save(study.draw(result, Figure()), tmp_path / "figure.png", dpi=40)
        assert study.tables(result)
        if study is hopf_map:
            assert says in result.statement


def test_damping_ratios_set_apart_give_way_and_a_note_says_so():
    sample = rw.paper_model()
    apart = replace(sample, section=replace(sample.section, damping_ratio_y=0.001))
    result = figure_09_stability_diagram.compute(apart)
    found = result.diagram
    figure = figure_09_stability_diagram.draw(result, Figure())
    assert " ".join(figure.get_supxlabel().split()) == found.notes[0]
    assert "same in y and z" in figure.axes[0].get_ylabel()
    assert figure.axes[0].get_title(loc="right") == ""
    assert found.notes == (
        "varied here: one damping ratio, the same for y and z; the case itself has 0.1 % in y, 0.2 % in z",
    )
    assert found.critical[1] == approx(0.0069416, abs=1e-6)


@pytest.mark.parametrize("ending", ["svg", "png", "pdf"])
def test_equal_figures_give_equal_files(result, tmp_path, ending):
    for name in ("one", "two"):
        style.save(hopf_map.draw(result, Figure()), tmp_path / f"{name}.{ending}", dpi=60)
    assert (tmp_path / f"one.{ending}").read_bytes() == (tmp_path / f"two.{ending}").read_bytes()
