"""Figures 9, 10 and 11: stability diagrams and their trends."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from scipy.integrate import solve_ivp

import rainwind as rw
from rainwind.dynamics.crossings import orbits_at
from rainwind.dynamics.system import as_system
from rainwind.studies import figure_09_stability_diagram as figure_09
from rainwind.studies import figure_10_rivulet_and_frequency as figure_10
from rainwind.studies import figure_11_mass_coefficients_dof as figure_11
from rainwind.studies.cycle_curves import crossings, passes
from rainwind.studies.equilibrium_map import equilibria_by_letter, equilibrium_map

approx = pytest.approx
AUTO = json.loads((Path(__file__).parents[1] / "validation/auto/reference.json").read_text(encoding="utf-8"))
RATIO = "section.damping_ratio"


def auto(curve, name):
    return next(point for point in AUTO["points"][curve] if point["name"] == name)


@pytest.fixture(scope="module")
def diagram():
    return figure_09.compute()


@pytest.fixture(scope="module")
def stiff():
    """A thicker cable at 3 Hz and 0.1 %: a fold curve that is isolated from the Hopf points."""
    changes = {"section.diameter": 0.16, "section.frequency_y": 3.0, "section.frequency_z": 3.0, RATIO: 0.001}
    return figure_09.compute(rw.paper_model().with_parameters(changes))


@pytest.fixture(scope="module")
def tenth():
    return figure_10.compute()


@pytest.fixture(scope="module")
def eleventh():
    return figure_11.compute()


def test_critical_damping(diagram):  # section 5, T8
    speed, ratio = diagram.diagram.critical
    assert 100 * ratio == approx(0.7, abs=0.02)
    highest = auto("hopf_curve", "MAX")
    assert ratio == approx(highest["damping_ratio"], rel=1e-6)
    assert speed == approx(highest["speed"], abs=5e-3)


@pytest.mark.parametrize(("kind", "name"), [("zh", "FH"), ("hh", "HH")])
def test_codimension_two_points_as_auto_finds_them(diagram, kind, name):
    (point,) = [p for p in diagram.diagram.points if p.kind == kind]
    assert point.parameter == approx(auto("hopf_curve", name)["speed"], abs=1e-5)
    assert point.parameters[RATIO] == approx(auto("hopf_curve", name)["damping_ratio"], rel=1e-6)


@pytest.mark.parametrize("speed", [10.633528192, 12.634092509, 14.799080927, 16.154167542])
def test_hopf_curve_passes_autos_points(diagram, speed):
    point = next(p for p in AUTO["points"]["hopf_curve"] if p["speed"] == approx(speed))
    assert diagram.diagram.hopf_speeds(point["damping_ratio"])[-1 if speed != 16.154167542 else 0] == approx(
        point["speed"], abs=2e-3
    )


def test_the_onset_does_not_depend_on_damping(diagram):  # T8
    assert np.ptp(diagram.diagram.fold["wind.speed"]) < 1e-9


def test_curves_of_d_and_of_c_part_at_the_fold_hopf_point(diagram):
    (point,) = [p for p in diagram.diagram.points if p.kind == "zh"]
    meeting = [
        {"letter": piece.letter, "lower": piece.ratio.max() <= point.parameters[RATIO] + 1e-9}
        for piece in diagram.diagram.pieces
        if min(np.hypot(piece.speed - point.parameter, piece.ratio - point.parameters[RATIO])) < 1e-9
    ]
    assert sorted(m["letter"] for m in meeting) == ["C", "D"]
    assert {m["letter"]: m["lower"] for m in meeting} == {"C": True, "D": False}


def test_shaded_region_is_where_d_is_unstable(diagram):
    """The region as drawn, against the eigenvalues of every equilibrium found anew at points all over the plane."""
    figure = figure_09.draw(diagram, Figure())
    regions = [c for c in figure.axes[0].collections if hasattr(c, "levels")]
    shaded = regions[0].get_paths()
    rng = np.random.default_rng(9)
    checked = {True: 0, False: 0}
    for speed, ratio in zip(rng.uniform(8.05, 19.9, 150), rng.uniform(2e-5, 0.0095, 150), strict=True):
        model = rw.paper_model().with_parameters({"wind.speed": speed, RATIO: ratio})
        upper = min(
            rw.find_equilibria(model), key=lambda e: abs(e["phi"] - np.radians(40)) + (e["phi"] > 1.06)
        )
        growth = upper.eigenvalues.real.max()
        if abs(growth) < 5e-4:  # so near to the curve that its drawing decides
            continue
        inside = any(path.contains_point((speed, 100 * ratio)) for path in shaded)
        assert inside == (growth > 0), (speed, ratio, growth)
        checked[inside] += 1
    assert min(checked.values()) > 30


def test_no_equilibrium_d_left_of_the_fold(diagram):
    left = rw.paper_model().with_parameters({"wind.speed": diagram.diagram.onset - 0.01})
    right = rw.paper_model().with_parameters({"wind.speed": diagram.diagram.onset + 0.01})
    assert "D" not in equilibria_by_letter(left)
    assert "D" in equilibria_by_letter(right)


def test_figure_9_says_nothing_against_itself(diagram):
    assert diagram.diagram.audit() == []
    assert diagram.stable.faults == ()


@pytest.fixture(scope="module")
def raw():
    """With the raw polynomials, as AUTO-07p has them."""
    return figure_09.compute(rw.paper_model(outside="extend"))


def labels_of_auto():
    """Every fold of cycles, Neimark-Sacker point and doubling that AUTO's branches pass below 20 m/s."""
    branches = AUTO["orbits"]["branches"]
    labels = [label for branch in branches for label in branch["labels"] if label["speed"] < 20]
    return [(label["name"], label["speed"], label["damping_ratio"], label["period"]) for label in labels]


def test_curves_pass_every_label_on_autos_branches(raw):
    """At 0.02 to 0.4 %; a curve is interpolated between its points, which costs some of AUTO's digits."""
    labels = labels_of_auto()
    assert {name for name, *_ in labels} == {"lpc", "ns", "pd"}
    for name, speed, ratio, period in labels:
        places = [
            (abs(u - speed), abs(t - period))
            for curve in raw.diagram.cycle_curves.of(name)
            for u, t in crossings(ratio, curve[RATIO], curve["wind.speed"], curve["period"])
        ]
        gap, other = min(places, default=(np.inf, np.inf))
        assert gap < 0.012, (name, speed, ratio)
        assert other < 1e-4, (name, speed, ratio)


def test_fold_curve_of_cycles_passes_autos_points(raw):
    curves = raw.diagram.cycle_curves.of("lpc")
    points = AUTO["orbits"]["curves"]["lpc"]["points"]
    assert len(points) > 10
    for point in points:
        speeds = [u for c in curves for (u,) in crossings(point["damping_ratio"], c[RATIO], c["wind.speed"])]
        assert min(abs(u - point["speed"]) for u in speeds) < 4e-3, point


def test_cusp_and_resonances_of_the_fold_curve_as_auto_finds_them(raw):
    """AUTO labels the cusp LP, and a fold along the curve too: the cusp is the one at the highest damping."""
    labels = AUTO["orbits"]["curves"]["lpc"]["labels"]
    cusp = max(labels, key=lambda label: label["damping_ratio"])
    known = [("r1", one) for one in labels if one["auto_label"] == "R1"] + [("cpc", cusp)]
    assert len(known) == 3
    for kind, one in known:
        nearest = min(
            (p for p in raw.points if p.kind == kind), key=lambda p: abs(p.parameter - one["speed"])
        )
        assert nearest.parameter == approx(one["speed"], abs=3e-5)
        assert nearest.parameters[RATIO] == approx(one["damping_ratio"], rel=1e-5)


def test_ns_curve_ends_in_the_fold_hopf_point(raw):
    (linear,) = [p for p in raw.diagram.points if p.kind == "zh"]
    (end,) = [p for p in raw.points if p.kind == "zh"]
    assert end.parameter == approx(linear.parameter, abs=1e-4)
    assert end.parameters[RATIO] == approx(linear.parameters[RATIO], rel=1e-4)


def test_every_resonance_is_counted_once(raw):
    """An ns curve's own end is extrapolated; the fold curve has the point itself."""
    assert all(not p.note for p in raw.points if p.kind == "r1")
    assert len([p for p in raw.points if p.kind == "r1"]) == 5


def test_beyond_the_range_the_coefficients_do_not_matter_to_cycles_of_the_upper_rivulet(raw, diagram):
    assert [p.kind for p in diagram.points] == [p.kind for p in raw.points]
    for ours, other in zip(diagram.points, raw.points, strict=True):
        assert ours.parameter == approx(other.parameter, abs=1e-4)
        assert ours.parameters[RATIO] == approx(other.parameters[RATIO], rel=1e-4)


def test_where_a_cycle_is_stable_at_the_samples_damping(diagram, raw):
    """From AUTO's Neimark-Sacker point to its upper Hopf point."""
    ((low, high),) = raw.stable.ranges(0.002)
    assert low == approx(10.8526, abs=1e-3)
    assert high == approx(14.7991, abs=1e-3)
    assert diagram.stable.ranges(0.002) == [(approx(low, abs=1e-4), approx(high, abs=1e-4))]


@pytest.mark.parametrize("ratio", [0.0004, 0.0011, 0.0035, 0.0045])
def test_the_count_of_stable_cycles_agrees_with_branches_it_was_not_made_from(diagram, ratio):
    model = rw.paper_model().with_parameters({RATIO: ratio})
    known = equilibrium_map(model, diagram.diagram.speeds)
    hopf = [p for side in known.sides if side.letter in ("C", "D") for p in side.points("hopf")]
    found = {}
    for start in hopf:
        branch = rw.continue_orbits(
            model, "wind.speed", start=start, until=diagram.diagram.speeds, ds=0.2, mesh=rw.Mesh(30)
        )
        for speed in (7.5, 8.3, 9.2, 10.2, 11.5, 13.1, 14.0, 15.9, 16.6, 18.2, 19.6):
            orbits = orbits_at(as_system(model), branch, speed)
            found.setdefault(speed, {}).update({round(o.period, 6): o.stable for o in orbits})
    for speed, orbits in found.items():
        assert diagram.stable.at(speed, ratio) == sum(orbits.values()), (speed, ratio)


def test_a_torus_beside_the_supercritical_part_of_the_ns_curve(diagram):
    """No cycle is stable there; the vibration beats, and stays so, where the figure says that tori are suspected."""
    assert diagram.stable.at(9.05, 0.0045) == 0
    model = rw.paper_model().with_parameters({RATIO: 0.0045, "wind.speed": 9.05})
    system = as_system(model)
    side = equilibrium_map(model, diagram.diagram.speeds)["D"]
    assert side is not None
    start = side.points("hopf")[0]
    branch = rw.continue_orbits(model, "wind.speed", start=start, until=(4.0, 12.0), ds=0.2, mesh=rw.Mesh(30))
    (orbit,) = orbits_at(system, branch, 9.05)
    assert not orbit.stable
    run = solve_ivp(
        lambda t, x: system.f(x[None, :])[0], (0.0, 900.0), orbit.profile[0] + 2e-3, method="LSODA", rtol=1e-8,
        atol=1e-9, t_eval=np.linspace(700.0, 900.0, 12001),
    )  # fmt: skip
    y = run.y[0] - run.y[0].mean()
    tops = y[1:-1][(y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])]
    assert tops.min() == approx(0.124, abs=0.002)
    assert tops.max() == approx(0.133, abs=0.002)


def test_figure_9_names_what_it_shows(diagram):
    figure = figure_09.draw(diagram, Figure())
    assert len(figure.axes) == 3
    words = [text.get_text() for text in figure.findobj(Text)]
    assert {"fold of cycles (LPC)", "Neimark–Sacker (NS)", "period doubling (PD)", "resonance 1:1"} <= set(
        words
    )
    said = " ".join(figure_09.summary(diagram))
    # the top of AUTO's fold curve (its cusp), and the paper's critical damping, section 5
    assert "Cusps of cycles (two folds meet and vanish): " in said
    assert "10.760 m/s (0.4023 %)" in said
    assert "Above a damping ratio of 0.694 % nothing vibrates between 4 and 20 m/s" in said
    assert "at 9.05 m/s, where the last vibration vanishes in the Hopf curve of D" in said
    assert said.endswith("which are never stable.")
    for code in ("cpc", " ch ", "gpd", " r1", "zh ", "gh "):
        assert code not in said
    assert "a limit cycle is stable at 10.85 to 14.80 m/s" in said
    tables = figure_09.tables(diagram)
    assert {"lpc_1", "ns_1", "pd_1", "cycle_curve_points", "stable_cycles"} <= set(tables)


def test_each_special_point_is_said_once(stiff, diagram):
    for result in (stiff, diagram):
        places = [
            text
            for line in figure_09.summary(result)
            for text in re.findall(r"\d+\.\d+ m/s \([\d.]+ %\)", line)
        ]
        assert len(places) > 10
        of_kinds = [
            line for line in figure_09.summary(result) if " m/s (" in line and line.split(":")[0][0].isupper()
        ]
        for line in of_kinds:
            found = re.findall(r"([\d.]+) m/s \(([\d.]+) %\)", line)
            assert len(found) == len(set(found)), line
    own = figure_09.compute(cycles=False)
    twice = replace(stiff.diagram.cycle_curves, curves=stiff.diagram.cycle_curves.curves * 2)
    assert [p.kind for p in twice.points()] == [p.kind for p in stiff.points]
    assert "Cusps" not in " ".join(figure_09.summary(own))


def test_each_hopf_curve_is_counted_once(stiff):
    """Two Hopf curves cross near a 1:1 resonance at no damping, and the walks end on the same one."""
    on_limit = [piece for piece in stiff.diagram.pieces if piece.others == 0]
    assert [piece.letter for piece in on_limit] == ["D"]
    assert not [fault for fault in stiff.stable.faults if "walked" in fault]


def test_a_count_that_changes_along_a_level_line_is_called_doubtful(stiff, diagram):
    """Near 0.03 and 0.04 % of this case a piece of a curve is counted wrongly; the diagram says so."""
    assert diagram.stable.faults == ()
    assert all("it changes all along" in fault for fault in stiff.stable.faults)
    assert stiff.stable.faults
    assert "The count of stable cycles is doubtful: at 0." in " ".join(figure_09.summary(stiff))


def test_a_fold_curve_that_no_row_met_is_found_from_the_points_on_other_curves(stiff):
    """Fold-flip and fold-NS points lie on a fold of cycles: it is walked, and its isolated cycles are counted."""
    curves = stiff.diagram.cycle_curves
    places = [p for p in stiff.points if p.kind in ("lpns", "foldflip")]
    assert len(places) == 3
    for point in places:
        assert any(
            passes(fold, replace(point, kind="lpc"), stiff.diagram.speeds) for fold in curves.of("lpc")
        )
    ((_, speed),) = [one for one in stiff.stable.isolated if one[0] == 0.001]
    # an independent look: beside the fold a stable cycle exists, on no branch from a Hopf point
    assert stiff.stable.at(speed + 0.3, 0.001) == 1
    (fold,) = [c for c in curves.of("lpc") if c[RATIO].max() > 0.0013]
    orbit = min(fold, key=lambda one: abs(one.parameters[RATIO] - 0.001))
    branch = rw.continue_orbits(
        stiff.diagram.model, "wind.speed", start=orbit, until=(7.0, 8.5), ds=0.2, mesh=rw.Mesh(30)
    )
    assert any(branch.stable)
    assert branch.parameter.min() == approx(speed, abs=0.02)
    said = " ".join(figure_09.summary(stiff))
    assert f"no Hopf point leads to; it ends in a fold at {speed:.2f} m/s" in said


def test_notes_do_not_lie_on_the_legend(stiff):
    doubtful = replace(stiff, stable=replace(stiff.stable, faults=("a test",)))
    figure = figure_09.draw(doubtful, Figure())
    FigureCanvasAgg(figure).draw()
    (legend,) = figure.legends
    (note,) = [text for text in figure.findobj(Text) if "doubtful: a test" in text.get_text()]  # type: ignore[attr-defined]
    assert not legend.get_window_extent().overlaps(note.get_window_extent())


def test_more_rivulet_friction(tenth):  # section 5, T10
    low, middle, high = tenth.friction.variants
    assert low.onset == approx(high.onset, abs=1e-6)
    assert low.critical_damping > middle.critical_damping > high.critical_damping
    assert low.width(0.002) < middle.width(0.002) < high.width(0.002)


def test_onset_does_not_depend_on_the_frequency(tenth):  # section 5, T11
    onsets = [variant.onset for variant in tenth.frequency.variants]
    assert np.ptp(onsets) < 0.05


def test_lighter_rivulet(eleventh):  # section 5, T12
    light, middle, heavy = eleventh.mass.variants
    assert light.onset < middle.onset < heavy.onset
    assert light.critical_damping < middle.critical_damping < heavy.critical_damping


def test_second_pair_of_a_light_rivulet_is_followed_too(eleventh):
    light = eleventh.mass.variants[0].diagram
    assert light.unstable_at_end(0.0005)
    assert not light.unstable_at_end(0.0006)
    (end,) = [p.ratio[np.argmax(p.speed)] for p in light.pieces if p.letter == "D" and p.speed.max() > 19.9]
    assert 0.0005 < end < 0.0006


def test_two_degrees_of_freedom(eleventh):  # section 5, T13
    three, two = eleventh.degrees_of_freedom.variants
    assert two.onset == approx(three.onset, abs=0.05)
    assert two.critical_damping < three.critical_damping
    assert two.width(0.002) < three.width(0.002)
    upper = two.diagram.hopf_speeds(0.002)[-1]
    assert upper == approx(13.9, abs=0.06)  # as noted in the coefficient set, from AUTO-07p


def test_other_reconstructions_have_like_limits(eleventh):
    for variant in eleventh.coefficients.variants[:3]:
        assert variant.onset == approx(8.0, abs=0.05)
        assert 100 * variant.critical_damping == approx(0.7, abs=0.02)


def test_gu_and_lu_with_our_moment_is_labelled_and_practically_stable(eleventh):
    last = eleventh.coefficients.variants[-1]
    assert "our moment" in last.label
    assert last.onset is not None
    assert last.critical_damping < 2e-5
    figure = figure_11.draw(eleventh, Figure())
    texts = [t.get_text() for t in figure.axes[1].get_legend().get_texts()]
    assert any("our moment" in t and "D stable" in t for t in texts)


@pytest.mark.parametrize("name", ["tenth", "eleventh"])
def test_figures_draw_and_tabulate_every_variant(request, name):
    result = request.getfixturevalue(name)
    study = figure_10 if name == "tenth" else figure_11
    figure = study.draw(result, Figure())
    assert all("$U$" in axes.get_xlabel() and "m/s" in axes.get_xlabel() for axes in figure.axes)
    tables = study.tables(result)
    assert all(f"{key}_1_fold" in tables for key in (("friction",) if name == "tenth" else ("mass",)))


def test_heavy_rivulet_raises_the_window_of_damping():
    heavy = rw.paper_model().with_parameters({"rivulet.mass": 0.5})
    result = figure_09.compute(heavy, cycles=False)
    assert result.diagram.ratios[1] > 0.01
    assert result.diagram.critical[1] < result.diagram.ratios[1]
