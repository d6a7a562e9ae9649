"""Equilibria, folds, Hopf points and their curves against AUTO-07p on the same model (raw polynomials).

The stored numbers of AUTO (auto/reference.json, made by auto/make_reference.py) are compared everywhere; where
AUTO-07p is installed it runs again, and its own branch is compared point by point.
"""

import json

import numpy as np
import pytest

import rainwind as rw

from .auto.auto_runner import Auto, auto_directory
from .auto.make_reference import REFERENCE
from .auto.sample_case import EQUATIONS, EQUILIBRIA, Equations, fold_and_hopf_points, tight

pytestmark = pytest.mark.validation
needs_auto = pytest.mark.skipif(auto_directory() is None, reason="AUTO-07p or gfortran is not installed")

SPEED, DAMPING = "wind.speed", "section.damping_ratio"
WINDOW = {SPEED: (4.0, 25.0), DAMPING: (2e-4, 0.01)}
STORED = json.loads(REFERENCE.read_text())["points"]


def branch_d(damping_ratio=0.002, **options):
    """D and C: one branch, joined at the fold."""
    model = rw.paper_model(outside="extend").with_parameters({SPEED: 9.0, DAMPING: damping_ratio})
    start = min(rw.find_equilibria(model), key=lambda e: abs(np.degrees(e["phi"]) - 45.0))
    return model, rw.continue_equilibria(model, SPEED, start=start, until=WINDOW[SPEED], **options)


def stored(run, name):
    return [p for p in STORED[run] if p["name"] == name]


def nearest(points, speed):
    return min(points, key=lambda p: abs(p[SPEED] - speed))


@pytest.fixture(scope="module")
def curves():
    model, branch = branch_d()
    (fold,), hopf = branch.points("fold"), branch.points("hopf")
    return {
        "fold_curve": rw.continue_fold(model, (SPEED, DAMPING), start=fold, until=WINDOW),
        "hopf_curve": rw.continue_hopf(model, (SPEED, DAMPING), start=hopf[0], until=WINDOW, ds=0.01),
    }


@pytest.mark.parametrize("kind", ["fold", "hopf"])
def test_special_points_of_the_branch(kind):
    _, branch = branch_d()
    expected = [p for p in STORED["equilibria"] if p["auto_label"] == {"fold": "LP", "hopf": "HB"}[kind]]
    found = branch.points(kind)
    assert len(found) == len(expected) == {"fold": 1, "hopf": 2}[kind]
    for point in expected:
        ours = nearest(found, point["speed"])
        assert ours[SPEED] == pytest.approx(point["speed"], abs=1e-7)
        assert ours.state == pytest.approx(np.array(point["state"]), abs=1e-7)
        theirs = np.array([complex(*value) for value in point["eigenvalues"]])
        for value in theirs:
            # AUTO stores the point to 11 digits; at a fold the zero eigenvalue moves like the root of that
            assert np.min(np.abs(ours.eigenvalues - value)) < (1e-5 if kind == "fold" else 1e-6)
        assert ours.certificate.holds


def test_low_damping_has_two_hopf_points_on_d_and_one_on_c():
    _, branch = branch_d(0.0005)
    expected = sorted(p["speed"] for p in STORED["equilibria_low_damping"] if p["auto_label"] == "HB")
    assert sorted(p[SPEED] for p in branch.points("hopf")) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("point", stored("hopf_curve", "UZ"), ids=lambda p: f"{p['speed']:.3f} m/s")
def test_hopf_speed_at_other_dampings(point):
    """AUTO's Hopf curve is met by following equilibria at its damping: another way to the same point."""
    low, high = WINDOW[DAMPING]
    _, branch = branch_d(min(max(point["damping_ratio"], low), high))
    assert nearest(branch.points("hopf"), point["speed"])[SPEED] == pytest.approx(point["speed"], abs=1e-6)


@pytest.mark.parametrize(
    ("run", "name", "kind"),
    [("hopf_curve", "HH", "hh"), ("hopf_curve_finer", "FH", "zh"), ("fold_curve", "FH", "zh")],
)
def test_codimension_two_points(curves, run, name, kind):
    expected = stored(run, name)[0]
    (ours,) = curves["fold_curve" if run == "fold_curve" else "hopf_curve"].points(kind)
    assert ours[SPEED] == pytest.approx(expected["speed"], abs=1e-6)
    assert ours[DAMPING] == pytest.approx(expected["damping_ratio"], abs=1e-8)
    assert ours.certificate.holds


def test_no_generalised_hopf_point_where_auto_prints_one(curves):
    """AUTO's label moves with its step, for the Lyapunov coefficient only changes sign through a pole there."""
    assert not curves["hopf_curve"].points("gh")


def test_critical_damping(curves):
    (highest,) = stored("hopf_curve", "MAX")
    assert curves["hopf_curve"].extremum(DAMPING) == pytest.approx(highest["damping_ratio"], rel=1e-5)


@pytest.mark.parametrize("ds", [0.01, 0.05, 0.2, 1.0])
def test_the_same_labels_for_every_step_size(ds):
    for damping_ratio, count in ((0.002, 3), (0.0005, 4)):
        _, branch = branch_d(damping_ratio, ds=ds)
        assert len(branch.points()) == count
        assert not branch.audit()


@needs_auto
def test_autos_whole_branch(tmp_path):
    """Every point that AUTO computes lies on our branch, and f and J agree there."""
    auto = Auto(EQUATIONS, tmp_path)
    run = auto.run(tight(EQUILIBRIA))
    theirs = Equations(auto)
    model, branch = branch_d()
    system = rw.System(model.rhs, model.states, model.parameters)
    ours = np.column_stack([branch["phi"], branch[SPEED]])
    for row in run.table[:: max(1, len(run.table) // 60)]:
        speed = row[run.columns.index("U")]
        state = np.array([row[run.columns.index(name)] for name in model.states])
        f, jacobian, by_parameter = theirs(state, speed, 0.002)
        at = {SPEED: speed}
        assert system.f(state, at) == pytest.approx(f, abs=1e-9)
        assert system.jacobian(state, at) == pytest.approx(jacobian, abs=1e-9 * np.abs(jacobian).max())
        mine = system.jacobian_parameters(state, [SPEED, DAMPING], at)
        assert mine == pytest.approx(by_parameter, abs=1e-9 * max(1.0, np.abs(by_parameter).max()))
        assert np.min(np.hypot(*(ours - [state[1], speed]).T)) < 0.06  # within a step
    for point, kind in zip(fold_and_hopf_points(run), ("fold", "hopf", "hopf"), strict=True):
        speed = point.parameters[0]
        assert nearest(branch.points(kind), speed)[SPEED] == pytest.approx(speed, abs=1e-7)
