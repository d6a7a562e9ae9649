"""Which equilibrium the studies call D: the one inside the coefficients' range, against the eigenvalues themselves."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

import rainwind as rw
from rainwind.dynamics.results import Ended
from rainwind.studies import equilibrium_map as maps
from rainwind.studies import (
    figure_05_equilibria,
    figure_06_stability,
    figure_09_stability_diagram,
    figure_10_rivulet_and_frequency,
    figure_11_mass_coefficients_dof,
    hopf_curves,
    hopf_map,
)
from rainwind.studies.equilibrium_map import equilibrium_map
from rainwind.studies.stability_diagram import stability_diagram, unstable_speeds
from rainwind.studies.walks import whole

approx = pytest.approx
RATIO = "section.damping_ratio"


def turned(name, yaw, inclination, **changes):
    model = replace(rw.paper_model(), coefficients=rw.load_coefficients(name))
    angles = {"wind.yaw": np.radians(yaw), "section.inclination": np.radians(inclination)}
    return model.with_parameters({**angles, **changes})


def with_second_fold(**changes):
    """An own set that is valid only where the blend makes an equilibrium between two folds."""
    model = turned("reconstructed-linear", 45, 35, **changes)
    own = replace(model.coefficients, name="own", valid=(np.radians(8), np.radians(30)))
    return replace(model, coefficients=own)


def upper_at(model, speed):
    upper = equilibrium_map(model, (1.0, 40.0))["D"]
    assert upper is not None
    state = upper.at(speed)
    assert state is not None
    return state


def inside(model, equilibrium):
    return model.coefficients.covers(-equilibrium["phi"])


@pytest.mark.parametrize("inclination", [35, 45])
@pytest.mark.parametrize("yaw", [30, 45, 60])
@pytest.mark.parametrize("name", ["reconstructed", "reconstructed-cubic", "reconstructed-linear"])
def test_d_is_the_equilibrium_inside_the_coefficients_range(name, yaw, inclination):
    model = turned(name, yaw, inclination, **{RATIO: 0.001})
    known = equilibrium_map(model, (1.0, 40.0))
    assert known.onset == approx({30: 9.6, 45: 10.6, 60: 11.6}[yaw], abs=1.5)
    for speed in (16.0, 24.0, 39.0):
        at = model.with_parameters({"wind.speed": speed})
        # the real upper rivulet: inside the range, and no saddle
        (upper,) = [
            e
            for e in rw.find_equilibria(at)
            if inside(model, e)
            and np.sum((e.eigenvalues.imag == 0) & (e.eigenvalues.real > 0)) == 0
            and np.cos(e["phi"] + model.beta) > -0.5
        ]
        assert np.allclose(upper_at(model, speed), upper.state, atol=2e-3)
        ranges = unstable_speeds(stability_diagram(model, (4.0, 40.0), shape=None))
        assert any(a < speed < b for a, b in ranges) == (upper.eigenvalues.real.max() > 0)


def test_equilibria_outside_the_range_are_noted_and_marked():
    model = turned("reconstructed-linear", 45, 35)
    result = figure_05_equilibria.compute(model)
    (note,) = result.equilibria.notes
    assert "outside the coefficients' range" in note
    assert "not D" in note
    said = " ".join(figure_05_equilibria.draw(result, Figure()).get_supxlabel().split())
    assert said.endswith(note)
    for letter in "BCD":
        assert not any(side is result.equilibria[letter] for side in result.equilibria.outside)


def test_without_an_equilibrium_inside_the_range_there_is_no_d():
    model = turned("reconstructed", 120, 29.8)
    known = equilibrium_map(model, (1.0, 40.0))
    assert known["D"] is None
    assert "not D" in known.notes[0]


def test_several_that_qualify_are_noted():
    model = turned("reconstructed-linear", 45, 35)
    wide = replace(model.coefficients, name="wide", valid=(-np.pi / 2, np.radians(30)))
    model = replace(model, coefficients=wide)
    known = equilibrium_map(model, (1.0, 40.0))
    assert np.degrees(upper_at(model, 20.0)[1]) == approx(36, abs=4)
    assert "2 equilibria could be D" in known.notes[0]


def test_beyond_a_second_fold_there_is_no_d():
    model = with_second_fold()
    result = figure_09_stability_diagram.compute(model, speeds=(1.0, 30.0), cycles=False)
    diagram = result.diagram
    assert diagram.reach is not None
    assert diagram.field is not None
    first, last = diagram.reach
    assert diagram.onset == approx(first) == approx(5.64, abs=0.02)
    assert last == approx(20.5, abs=0.1)
    assert not diagram.reaches_end
    assert not diagram.unstable_at_end(0.0002)
    assert diagram.field.speed[-1] == approx(last)
    axes = figure_09_stability_diagram.draw(result, Figure()).axes[0]
    texts = [text.get_text() for text in axes.texts]
    assert sum("no\nequilibrium" in text for text in texts) == 2
    for speed, there in ((last - 0.2, True), (last + 0.2, False)):
        found = rw.find_equilibria(model.with_parameters({"wind.speed": speed}))
        assert any(inside(model, e) for e in found) == there


def test_map_claims_nothing_where_d_has_ended():
    result = hopf_map.compute(with_second_fold(), speeds=(4.0, 30.0))
    assert result.unlimited_below is None
    assert "30 m/s, the end" not in result.statement
    assert "second fold" in result.statement


def test_an_upper_limit_far_beyond_the_map_is_found():
    result = hopf_map.compute(turned("reconstructed-linear", 45, 35, **{RATIO: 0.0005}))
    assert "no upper limit" not in result.statement
    assert "it is stable at 140 m/s" in result.statement
    fast = turned("reconstructed-linear", 45, 35, **{RATIO: 0.0005, "wind.speed": 140.0})
    upper = [e for e in rw.find_equilibria(fast) if 0.3 < e["phi"] < 1.0]
    assert [e.stable for e in upper] == [True]


def test_a_stopped_walk_is_not_drawn(monkeypatch):
    def stopped(*args, **kwargs):
        branch = maps_continue(*args, **kwargs)
        return replace(branch, ended=(branch.ended[0], Ended.INTERRUPTED))

    maps_continue = maps.continue_equilibria
    branch = maps_continue(rw.paper_model(), "wind.speed", until=(9.0, 12.0))
    assert whole(branch) is branch
    monkeypatch.setattr(maps, "continue_equilibria", stopped)
    with pytest.raises(KeyboardInterrupt):
        hopf_map.compute()


def test_a_stopped_hopf_curve_is_not_drawn(monkeypatch):
    walk = hopf_curves.continue_hopf

    def stopped(*args, **kwargs):
        curve = walk(*args, **kwargs)
        return replace(curve, ended=(Ended.INTERRUPTED, curve.ended[1]))

    monkeypatch.setattr(hopf_curves, "continue_hopf", stopped)
    with pytest.raises(KeyboardInterrupt):
        figure_09_stability_diagram.compute(cycles=False)


def test_summaries_say_fold_critical_damping_and_unstable_speeds():
    result = figure_09_stability_diagram.compute(cycles=False)
    said = figure_09_stability_diagram.summary(result)
    assert said[0] == "The upper rivulet D exists above 8.00 m/s (fold)."
    assert said[1].startswith("Critical damping: 0.694 %, at 9.05 m/s")
    assert "0.2 %, D is unstable from 8.00 to 14.80 m/s" in said[2]
    assert said[3].startswith("The paper's letters")
    assert len(said) == 4


def test_figure_6_marks_only_where_its_own_curve_crosses_zero():
    """At 0.05 % a second pair is unstable before the first is stable: no crossing, though two Hopf points."""
    model = turned("reconstructed", 0, 29.8, **{RATIO: 0.0005})
    result = figure_06_stability.compute(model)
    assert len(result.hopf_on_d) == 2
    axes = figure_06_stability.draw(result, Figure()).axes[0]
    assert not [line for line in axes.lines if line.get_marker() == "o"]
    axes = figure_06_stability.draw(figure_06_stability.compute(), Figure()).axes[0]
    (marked,) = [line for line in axes.lines if line.get_marker() == "o"]
    assert np.asarray(marked.get_xydata())[0, 0] == approx(14.8, abs=0.01)


@pytest.mark.parametrize("study", [figure_10_rivulet_and_frequency, figure_11_mass_coefficients_dof])
def test_figures_of_variants_say_what_lies_outside_the_range(study):
    result = study.compute(turned("reconstructed-linear", 45, 35))
    assert "outside the coefficients' range; it is not D" in study.summary(result)[-1]
    assert "is not D" in " ".join(study.draw(result, Figure()).get_supxlabel().split())


def test_own_damping_is_a_line_of_the_map_and_the_fold_in_its_legend():
    result = hopf_map.compute(turned("reconstructed", 30, 29.8, **{RATIO: 0.001}))
    labels = hopf_map.draw(result, Figure()).axes[0].get_legend_handles_labels()[1]
    assert "this case: 0.1 %" in labels
    assert "fold, where D begins" in labels
    assert not any("another" in label for label in labels)
