"""Figure 7 and the map of limit cycles behind it, against AUTO-07p's cycles at three damping ratios."""

import json
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rainwind.dynamics.orbit_results import Orbit
from rainwind.physics.model import paper_model
from rainwind.studies import figure_07_limit_cycles as figure_07
from rainwind.studies import paper
from rainwind.studies.cycle_map import cycle_map

approx = pytest.approx
BOTH = ("section.frequency_y", "section.frequency_z")
AUTO = json.loads((Path(__file__).parents[1] / "validation/auto/reference.json").read_text(encoding="utf-8"))
# AUTO-07p 0.9.2 on the raw polynomials, polished, tests/validation/auto
CYCLES = [c for c in AUTO["orbits"]["cycles"] if c["damping_ratio"] == 0.002]
BRANCHES = AUTO["orbits"]["branches"]


def at_ratio(ratio: float, outside: str = "extend"):
    model = paper_model(outside=outside).with_parameters({"section.damping_ratio": ratio})  # type: ignore[arg-type]
    return cycle_map(model, paper.SPEEDS)


@pytest.fixture(scope="module")
def result():
    return figure_07.compute()


@pytest.mark.parametrize("speed", sorted({c["speed"] for c in CYCLES if c["speed"] < 14.7}))
def test_every_cycle_at_a_wind_speed_is_autos(speed: float):
    expected = sorted((c for c in CYCLES if c["speed"] == speed), key=lambda c: -c["half_peak_to_peak"]["y"])
    found = at_ratio(0.002).cycles(speed)
    assert len(found) == len(expected)
    for ours, theirs in zip(found, expected, strict=True):
        assert ours.period == approx(theirs["period"], rel=1e-8)
        assert ours.unstable == theirs["unstable"]
        for name in ("y", "phi", "z"):
            assert ours.amplitude[name] == approx(theirs["half_peak_to_peak"][name], rel=1e-4)


def test_the_three_cycles_at_12_metres_per_second():  # issue 3, from AUTO-07p
    sizes = [(o.amplitude["y"], o.amplitude["z"]) for o in at_ratio(0.002).cycles(12.0)]
    assert np.round(sizes, 3).tolist() == [[0.233, 0.203], [0.199, 0.521], [0.174, 0.551]]


@pytest.mark.parametrize(
    "ratio", sorted({b["damping_ratio"] for b in BRANCHES if b["damping_ratio"] < 0.0021})
)
def test_labels_are_autos(ratio: float):
    known = at_ratio(ratio)
    ours = [(p.kind, p.parameter) for b in known.singles for p in b.special if p.kind in ("lpc", "ns", "pd")]
    theirs = {
        (label["name"], round(label["speed"], 6)): label["speed"]
        for branch in BRANCHES
        if branch["damping_ratio"] == ratio
        for label in branch["labels"]
        if label["name"] in ("lpc", "ns", "pd") and paper.SPEEDS[0] < label["speed"] < paper.SPEEDS[1]
    }
    for (kind, _), speed in theirs.items():
        assert any(kind == own and at == approx(speed, abs=2e-6) for own, at in ours), (kind, speed)


def test_folds_of_cycles_at_10_7_and_12_7_metres_per_second(result: figure_07.Result):  # section 4.3, T5
    assert [p.parameter for p in result.cycles.points("lpc")] == approx([10.7, 12.7], abs=0.05)


def test_what_is_stable_where(result: figure_07.Result):
    ranges = [(r.low, r.high, r.equilibria, len(r.cycles)) for r in result.cycles.ranges()]
    ns, hopf = 10.8525928, 14.7990809  # issue 3, from AUTO-07p
    assert ranges == [
        (4.0, approx(ns, abs=1e-6), ("A",), 0),
        (approx(ns, abs=1e-6), approx(hopf, abs=1e-6), ("A",), 1),
        (approx(hopf, abs=1e-6), 20.0, ("A", "D"), 0),
    ]
    names = [name for name, _ in result.cycles.attractors(13.0)]
    assert names == ["A", "cycle"]
    assert all(one.stable for _, one in result.cycles.attractors(13.0))


def test_the_stable_vibration_ends_in_a_jump_at_the_neimark_sacker_point(result: figure_07.Result):
    (jump,) = result.jumps
    assert (jump.kind, jump.rising, jump.to) == ("ns", False, "A")
    assert jump.speed == approx(10.8525928, abs=1e-6)


def test_jumps_between_two_stable_vibrations_at_very_low_damping():
    low = paper_model().with_parameters({"section.damping_ratio": 0.0002})
    result = figure_07.compute(low)
    found = [(j.kind, j.rising, j.to) for j in result.jumps]
    # the fold of cycles at 10.53 m/s ends the larger one for falling wind, the point at 15.20 the smaller for rising
    assert found[0] == ("lpc", False, "cycle")
    assert result.jumps[0].end[0] < result.jumps[0].start[0]
    assert found[1] == ("ns", True, "cycle")
    assert result.jumps[1].end[0] > result.jumps[1].start[0]
    assert len([o for o in result.cycles.cycles(12.0) if o.stable]) == 2
    figure_07.draw(result, Figure())


def test_period_doublings_are_followed_onto_the_doubled_cycles():
    known = at_ratio(0.001, "blend")
    doubled = [b for b in known.branches if not b.points("hopf")]
    assert [round(float(np.median(b["period"]))) for b in doubled] == [2, 4]
    (first,) = known.singles[0].points("pd")
    assert doubled[0].parameter[0] == approx(first.parameter, abs=0.02)  # one step of arclength


def test_the_figure_shows_stability_and_marks_every_point(result: figure_07.Result):
    figure = figure_07.draw(result, Figure())
    top = figure.axes[0]
    texts = {text.get_text() for text in top.texts}
    assert {"8.06", "10.69", "10.85", "12.67", "14.80", "to A", "$d$"} <= texts
    assert "undisturbed" in top.get_xlabel()
    (legend,) = figure.legends
    words = {text.get_text() for text in legend.get_texts()}
    assert {"stable", "fold of cycles", "Neimark–Sacker", "Hopf", "jump"} <= words
    assert {"unstable: 1 multiplier outside", "unstable: 2 or more outside"} <= words
    assert list(result.shown) == [9.0, 12.0, 14.0]
    assert [len(orbits) for orbits in result.shown.values()] == [1, 3, 1]


def test_tables_and_sentences(result: figure_07.Result):
    tables = figure_07.tables(result)
    assert {"cycles_1", "cycle_points", "stable", "orbit_9_1", "orbit_12_3"} <= set(tables)
    assert tables["cycle_points"].columns["kind"].values.tolist() == ["lpc", "lpc", "ns"]
    said = " ".join(figure_07.summary(result))
    for words in (
        "Folds of cycles at 10.69, 12.67 m/s",
        "10.85 to 14.80 m/s: stable equilibrium A and a limit cycle",
    ):
        assert words in said


@pytest.mark.parametrize("degrees_of_freedom", [2, 3])
def test_a_case_without_vibration_and_one_without_z_are_drawn(degrees_of_freedom: int):
    quiet = paper_model(degrees_of_freedom=degrees_of_freedom)
    if degrees_of_freedom == 3:
        quiet = quiet.with_parameters({"section.damping_ratio": 0.02})
    result = figure_07.compute(quiet)
    assert bool(result.cycles.branches) == (degrees_of_freedom == 2)
    figure = figure_07.draw(result, Figure())
    assert figure.axes
    assert figure_07.summary(result)
    assert figure_07.tables(result)


def test_the_cycle_at_9_metres_per_second_is_unstable(result: figure_07.Result):  # reading notes, T7
    (orbit,) = result.shown[9.0]
    assert isinstance(orbit, Orbit)
    assert orbit.unstable == 2
    assert np.degrees(orbit.amplitude["phi"]) == approx(13.3, abs=0.1)


CASES = {  # cycles from 8.3 to 10.4 m/s only; flat orbits; a light cable
    "narrow": {"section.damping_ratio": 0.0062},
    "flat": {"section.damping_ratio": 0.001, "section.diameter": 0.16, **dict.fromkeys(BOTH, 3.0)},
    "light": {"section.damping_ratio": 0.003, "section.mass": 20.0, **dict.fromkeys(BOTH, 2.5)},
}


@pytest.fixture(scope="module", params=sorted(CASES))
def other(request: pytest.FixtureRequest):
    return figure_07.compute(paper_model().with_parameters(CASES[request.param]))


def test_cycles_are_drawn_at_speeds_that_have_some(other: figure_07.Result):
    assert len(other.shown) == 3
    assert all(other.shown.values())


def test_no_tick_label_lies_on_another(other: figure_07.Result):
    figure = figure_07.draw(other, Figure())
    FigureCanvasAgg(figure).draw()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            boxes = [
                tick.label1.get_window_extent()
                for tick in axis.get_major_ticks()
                if low <= tick.get_loc() <= high and tick.label1.get_text()  # type: ignore[attr-defined]
            ]
            assert len(boxes) > 1
            assert not any(a.overlaps(b) for a, b in combinations(boxes, 2)), axes.get_title(loc="left")
