"""Limit cycles, their special points and curves of these against AUTO-07p and against polished cycles.

`auto/reference.json` holds AUTO's points and the same cycles solved for again to rounding (auto/README.md says how); it
is compared everywhere. Where AUTO-07p is installed it runs again, and its own rows are compared.
"""

import json
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import KroghInterpolator
from scipy.optimize import brentq

import rainwind as rw

from .auto.auto_runner import Auto, auto_directory
from .auto.make_reference import REFERENCE
from .auto.sample_case import (
    EQUATIONS,
    EQUILIBRIA,
    LPC_CURVE,
    ORBIT_BRANCH,
    extended,
    fold_and_hopf_points,
    tight,
)

pytestmark = pytest.mark.validation
needs_auto = pytest.mark.skipif(auto_directory() is None, reason="AUTO-07p or gfortran is not installed")

SPEED, DAMPING = "wind.speed", "section.damping_ratio"
WINDOW = {SPEED: (4.0, 25.1), DAMPING: (1e-4, 0.01)}
REFERENCE_POINTS = json.loads(REFERENCE.read_text())
STORED = REFERENCE_POINTS["orbits"]
SPEEDS = (9.0, 10.0, 12.0, 13.0, 14.0)
# multipliers of 1e-39 need it: 40 intervals leave an error of 0.2 in log|mu|, 80 of 5e-4 (test_orders_of_convergence)
FINE = rw.Mesh(80, 4)
# at 24.86 m/s, 0.02 %, a multiplier is 3e7; with FINE it is wrong by 1e-4
FINER = rw.Mesh(60, 6)


# ---- our side ----


@cache
def hopf_points(damping_ratio):
    """The model and the Hopf points of D and C."""
    model = rw.paper_model(outside="extend").with_parameters({SPEED: 9.0, DAMPING: damping_ratio})
    start = min(rw.find_equilibria(model), key=lambda e: abs(np.degrees(e["phi"]) - 45.0))
    return model, rw.continue_equilibria(model, SPEED, start=start, until=WINDOW[SPEED]).points("hopf")


def branch(damping_ratio, hopf_speed, ds, mesh=None, monitors=()):
    """The cycles born at one Hopf point."""
    model, hopf = hopf_points(damping_ratio)
    start = nearest(hopf, hopf_speed)
    return rw.continue_orbits(
        model, SPEED, start=start, until=WINDOW[SPEED], ds=ds, mesh=mesh, monitors=monitors
    )


def nearest(points, speed):
    return min(points, key=lambda p: abs(p[SPEED] - speed))


def at_values(parameter, values):
    """Monitors that label a branch where a parameter takes some values."""
    return [
        rw.Monitor(f"{parameter} {value!r}", lambda o, v=value: o.parameters[parameter] - v, "label")
        for value in values
    ]


def complex_numbers(pairs):
    return np.array([complex(*pair) for pair in pairs])


def multiplier_errors(ours, theirs):
    """Largest relative error where |mu| > 1e-6, largest error of log|mu| below; double roots at 1 left out."""
    ours = list(ours)
    large, small = [0.0], [0.0]
    for mu in sorted(theirs, key=abs, reverse=True):
        mine = ours.pop(int(np.argmin(np.abs(np.log(np.array(ours)) - np.log(mu)))))
        if abs(mu) > 1e-6:
            large.append(abs(mine - mu) / abs(mu))
        else:
            small.append(abs(np.log(abs(mine)) - np.log(abs(mu))))
    return max(large), max(small)


# ---- branches and their labels ----

BRANCHES = STORED["branches"]


def name_of(record):
    return f"{100 * record['damping_ratio']:g} % from {record['hopf_speed']:.3f} m/s"


@pytest.mark.parametrize("record", BRANCHES, ids=name_of)
def test_labels_of_a_branch(record):
    """Every label of the reference, no other one, where the polished cycle has it: also those that AUTO never prints.

    Never printed (`found_with_dsmax` empty): Neimark-Sacker points at 15.1996 and 20.9493 m/s, 0.02 %. Printed with one
    of three steps only: the one at 13.5547 m/s, 0.17 %, 0.0003 m/s before a fold.
    """
    found = branch(record["damping_ratio"], record["hopf_speed"], 0.5, FINER)
    assert not found.audit()
    expect_ends(found, record)
    labels = [p for p in found.points() if p.kind != "hopf"]
    assert sorted(p.kind for p in labels) == sorted(label["name"] for label in record["labels"])
    for label in record["labels"]:
        polished = label["polished"]
        ours = nearest(found.points(label["name"]), polished["speed"])
        multipliers = complex_numbers(polished["multipliers"])
        # at 24.86 m/s one multiplier is 3e7, and 80 intervals leave 1e-8 m/s
        assert ours[SPEED] == pytest.approx(
            polished["speed"], abs=3e-8 if max(abs(multipliers)) > 1e7 else 1e-9
        )
        # the reference takes an LPC's period where U is stationary: near the cusp it is known to 1e-9 only
        assert ours.orbit.period == pytest.approx(
            polished["period"], abs=2e-9 if label["name"] == "lpc" else 1e-12
        )
        for state, value in polished["half_peak_to_peak"].items():
            assert ours.orbit.amplitude[state] == pytest.approx(value, abs=1e-6)
        if label["name"] == "ns":
            assert ours.angle == pytest.approx(polished["angle"], abs=1e-9)
        if label["name"] != "lpc":
            assert multiplier_errors(ours.orbit.multipliers, multipliers)[0] < 1e-6
        assert ours.certificate.holds


def expect_ends(found, record):
    hopf = found.points("hopf")
    assert hopf[0][SPEED] == pytest.approx(record["hopf_speed"], abs=1e-8)
    if record["damping_ratio"] in (0.0017, 0.002, 0.004):
        # one branch joins the two Hopf points; AUTO was stopped 1e-4 m/s before the second, lest it turn round
        assert found.ended == (rw.Ended.AT_HOPF, rw.Ended.AT_HOPF)
        assert hopf[1][SPEED] == pytest.approx(record["lowest_speed"] - 1e-4, abs=1e-8)
    else:
        assert found.ended == (rw.Ended.AT_HOPF, rw.Ended.AT_BOUND)
        assert found[-1].parameters[SPEED] == pytest.approx(25.1, abs=1e-12)
        assert found[-1].period == pytest.approx(record["followed_to"]["period"], abs=1e-9)


@pytest.mark.parametrize("ds", [0.05, 0.2, 1.0])
@pytest.mark.parametrize("record", BRANCHES, ids=name_of)
def test_the_same_labels_for_every_step_size(record, ds):
    expect_labels(branch(record["damping_ratio"], record["hopf_speed"], ds), record)


def test_the_same_labels_for_the_smallest_step():
    (record,) = (r for r in BRANCHES if r["damping_ratio"] == 0.002)
    expect_labels(branch(0.002, record["hopf_speed"], 0.01), record)


def expect_labels(found, record):
    """All labels on the default mesh, on which the period doubling at 24.86 m/s is 1e-6 m/s away."""
    expected = sorted((label["name"], label["polished"]["speed"]) for label in record["labels"])
    ours = sorted((p.kind, p[SPEED]) for p in found.points() if p.kind != "hopf")
    assert [kind for kind, _ in ours] == [kind for kind, _ in expected]
    assert [speed for _, speed in ours] == pytest.approx([speed for _, speed in expected], abs=3e-6)
    assert not found.audit()


# ---- cycles at round wind speeds ----


@cache
def sample_cycles(mesh):
    """Our cycles at the speeds of the reference, each beside its record."""
    found = branch(0.002, 14.799, 0.3, mesh, at_values(SPEED, SPEEDS)).points("event")
    assert len(found) == len(STORED["cycles"]) == 7
    return [
        (min(found, key=lambda p: abs(p[SPEED] - c["speed"]) + abs(p.orbit.period - c["period"])).orbit, c)
        for c in STORED["cycles"]
    ]


def test_cycles_at_round_wind_speeds():
    """Three of them coexist at 12 m/s; the smallest multipliers are 1e-33 ... 1e-39."""
    cycles = sample_cycles(FINE)
    assert len({id(orbit) for orbit, _ in cycles}) == 7
    for orbit, record in cycles:
        assert orbit.parameters[SPEED] == pytest.approx(record["speed"], abs=1e-9)
        assert orbit.period == pytest.approx(record["period"], abs=1e-11)
        assert orbit.unstable == record["unstable"]
        for k, state in enumerate(orbit.states[:3]):
            assert orbit.amplitude[state] == pytest.approx(record["half_peak_to_peak"][state], abs=2e-9)
            assert orbit.extremes[0, k] == pytest.approx(record["minima"][state], abs=2e-9)
            assert orbit.extremes[1, k] == pytest.approx(record["maxima"][state], abs=2e-9)
        assert list(orbit.mean.values()) == pytest.approx(record["mean"], abs=1e-10)
        large, small = multiplier_errors(orbit.multipliers, complex_numbers(record["multipliers"]))
        assert large < 1e-8
        assert small < 1e-3
        assert abs(orbit.trivial) < 1e-12
        # log of the product of all multipliers against the integral of trace J: the smallest one's error again
        assert abs(orbit.liouville) < 1e-3
        total = np.log(np.abs(orbit.multipliers)).sum()
        assert total == pytest.approx(record["integral_of_trace"], abs=1e-3)


@pytest.mark.parametrize(("degree", "intervals"), [(2, (40, 80, 160)), (3, (20, 40, 80)), (4, (40, 80, 160))])
def test_orders_of_convergence(degree, intervals):
    """Period and multipliers are functionals of the orbit: their errors fall like intervals^(-2 degree)."""
    errors = []
    for count in intervals:
        rows = []
        for orbit, record in sample_cycles(rw.Mesh(count, degree, most=count)):
            large, small = multiplier_errors(orbit.multipliers, complex_numbers(record["multipliers"]))
            rows.append((abs(orbit.period - record["period"]), large, small))
        errors.append(np.median(rows, axis=0))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # degree 4: period and large multipliers are exact to rounding; degree 3: 20 intervals say nothing of the smallest
    reliable = {2: orders[:, :2], 3: orders[:, 0], 4: orders[:, 2]}[degree]
    assert np.all(np.abs(reliable - 2 * degree) < 0.35), orders


@pytest.mark.parametrize("number", [1, 4])  # stable at 13 m/s, unstable at 12 m/s
def test_shooting_finds_the_same_cycles(number):
    model, _ = hopf_points(0.002)
    orbit, record = sample_cycles(FINE)[number]
    shot = rw.shoot(model, orbit)
    assert shot.converged, shot.note
    apart = shot.differences(orbit)
    assert apart["period"] < 1e-11
    assert apart["state"] < 1e-8
    assert apart["multipliers"] < 1e-7
    assert apart["small multipliers"] < 1e-3
    # and the reference itself, to what shooting's tolerance allows
    assert shot.period == pytest.approx(record["period"], abs=1e-11)
    large, small = multiplier_errors(shot.multipliers, complex_numbers(record["multipliers"]))
    assert large < 1e-7
    assert small < 1e-6
    assert shot.trivial_error < 1e-9


# ---- curves in (U, xi) ----

CURVES = {  # function, kind, damping ratio, Hopf point, speed of the label to start from, largest step
    "lpc": (rw.continue_lpc, "lpc", 0.002, 14.799, 10.691, 0.3),
    "ns": (rw.continue_ns, "ns", 0.002, 14.799, 10.853, 0.2),
    "second_ns": (rw.continue_ns, "ns", 0.0017, 15.177, 13.555, 0.3),
    # within 0.2 m/s about R2 the largest multiplier goes from -e^10.9 to e^12.2: steps of 0.2 leave changes unexplained
    "pd": (rw.continue_pd, "pd", 0.001, 8.182, 17.125, 0.1),
    "second_pd": (rw.continue_pd, "pd", 0.0002, 17.503, 24.865, 0.4),
}
CURVE_MESH = rw.Mesh(60, 4)


def rows_of(name):
    """(speed, damping ratio, period, polished) of the reference's points at given damping ratios."""
    rows = []
    for p in STORED["curves"][name]["points"]:
        best = p.get("polished") or p
        rows.append(
            (best["speed"], best.get("damping_ratio", p["damping_ratio"]), best["period"], best is not p)
        )
    return rows


@cache
def curve(name, dampings=None):
    function, kind, damping_ratio, hopf_speed, label_speed, ds = CURVES[name]
    model, _ = hopf_points(damping_ratio)
    start = nearest(branch(damping_ratio, hopf_speed, 0.5, CURVE_MESH).points(kind), label_speed)
    monitors = at_values(DAMPING, dampings or sorted({row[1] for row in rows_of(name)}))
    return function(
        model, (SPEED, DAMPING), start=start, until=WINDOW, ds=ds, mesh=CURVE_MESH, monitors=monitors
    )


def extremum(found, of, near):
    """(speed, damping ratio) where one of the two is stationary along a curve, from values and slopes at 6 points."""
    k = (SPEED, DAMPING).index(of)
    rates = found.tangent_parameter
    turns = np.flatnonzero((rates[:-1, k] > 0) != (rates[1:, k] > 0))
    columns = np.column_stack([found[SPEED], found[DAMPING]])
    i = min(turns, key=lambda i: np.linalg.norm((columns[i] - near) / near))
    at = slice(i - 2, i + 4)
    x, y, slopes = columns[at, 1 - k], columns[at, k], rates[at, k] / rates[at, 1 - k]
    middle = x.mean()
    poly = KroghInterpolator(np.repeat(x - middle, 2), np.column_stack([y, slopes]).ravel())
    x0 = brentq(poly.derivative, x[2] - middle, x[3] - middle, xtol=1e-14)
    return (middle + x0, float(poly(x0)))[:: 1 if k else -1]


@pytest.mark.parametrize("name", CURVES)
def test_points_of_curves_at_given_dampings(name):
    found = curve(name).points("event")
    for speed, damping_ratio, period, polished in rows_of(name):
        ours = min(found, key=lambda p: abs(p[SPEED] - speed) + 1e5 * abs(p[DAMPING] - damping_ratio))
        assert ours[DAMPING] == pytest.approx(damping_ratio, abs=1e-12)
        # on the second PD curve a multiplier is 3e7: 60 intervals leave 2e-7 m/s
        close = 1e-8 if polished and name != "second_pd" else 1e-6
        assert ours[SPEED] == pytest.approx(speed, abs=close)
        assert ours.orbit.period == pytest.approx(period, abs=1e-10 if polished else 1e-9)


@pytest.mark.parametrize("name", CURVES)
def test_curves_end_for_a_reason_and_leave_nothing_unexplained(name):
    found = curve(name)
    assert not found.audit()
    expected = {
        "ns": (rw.Ended.AT_BOUND, rw.Ended.AT_HOPF),
        "second_ns": (rw.Ended.AT_RESONANCE, rw.Ended.AT_RESONANCE),
    }
    assert found.ended == expected.get(name, (rw.Ended.AT_BOUND, rw.Ended.AT_BOUND))


@pytest.mark.parametrize(
    ("name", "of", "at"),
    [
        ("lpc", SPEED, (10.964476775, 0.00308136018805)),
        ("ns", SPEED, (11.05361995, 0.0028803052923)),
        ("ns", DAMPING, (9.6804645033, 0.0046706927868)),
        ("ns", DAMPING, (10.6371438815, 0.0042390200889)),
        ("ns", DAMPING, (10.62658125, 0.0042296809423)),
        ("pd", SPEED, (16.54844026, 0.000767439723015)),
        ("pd", DAMPING, (18.797691835, 0.0010880443542)),
    ],
    ids=lambda value: f"{value[0]:.4f} m/s" if isinstance(value, tuple) else None,
)
def test_extrema_of_curves(name, of, at):
    """Where AUTO labels LP on a curve: one parameter is stationary."""
    stored = [(label["speed"], label["damping_ratio"]) for label in STORED["curves"][name]["labels"]]
    assert min(np.linalg.norm(np.subtract(at, pair)) for pair in stored) < 1e-9
    assert extremum(curve(name), of, at) == pytest.approx(at, abs=1e-6, rel=0)


def test_cusp_of_the_fold_curve():
    """AUTO labels it LP, for both parameters are stationary there; the point is the same."""
    (cusp,) = curve("lpc").points("cpc")
    (stored,) = (p for p in STORED["curves"]["lpc"]["labels"] if abs(p["speed"] - 10.7605) < 1e-3)
    assert stored["speed"] == pytest.approx(10.760471982, abs=1e-9)
    assert cusp[SPEED] == pytest.approx(stored["speed"], abs=2e-9)
    assert cusp[DAMPING] == pytest.approx(stored["damping_ratio"], abs=1e-12)
    assert cusp.certificate.holds


def test_resonances_by_two_ways():
    """The R1 points on the fold curve are where the second NS curve ends, and where AUTO has them to its spread.

    AUTO's labels spread over 2e-5 m/s, and its NS curve stops 5e-4 and 5e-5 m/s before them. Ours agree within 1e-6
    between a fold curve on which a third multiplier becomes 1 and an NS curve (another system of equations) whose
    angle goes to zero: so 14.7250201 m/s is right, and AUTO's median 14.7250240 is off by 4e-6.
    """
    on_fold = sorted(curve("lpc").points("r1"), key=lambda p: p[SPEED])
    on_ns = sorted(curve("second_ns").points("r1"), key=lambda p: p[SPEED])
    stored = [p for p in STORED["curves"]["lpc"]["labels"] if p["auto_label"] == "R1"]
    for ours, other, theirs in zip(on_fold, on_ns, sorted(stored, key=lambda p: p["speed"]), strict=True):
        assert ours[SPEED] == pytest.approx(other[SPEED], abs=2e-6)
        assert ours[DAMPING] == pytest.approx(other[DAMPING], abs=1e-9)
        assert ours[SPEED] == pytest.approx(theirs["speed"], abs=theirs["spread"]["speed"])
        assert ours[DAMPING] == pytest.approx(theirs["damping_ratio"], abs=theirs["spread"]["damping_ratio"])
        assert ours.certificate.holds


def test_the_curve_of_tori_begins_in_the_fold_hopf_point():
    """Found on the fold curve of the equilibria to 1e-8; ours is extrapolated from cycles of vanishing size."""
    (stored,) = (p for p in REFERENCE_POINTS["points"]["fold_curve"] if p["name"] == "FH")
    (ours,) = curve("ns").points("zh")
    assert ours[SPEED] == pytest.approx(stored["speed"], abs=1e-5)
    assert ours[DAMPING] == pytest.approx(stored["damping_ratio"], abs=5e-8)


def test_resonance_on_the_period_doubling_curves():
    """Two multipliers -1 at once: rounding parts them by its root, yet the label holds its certificate (bug fixed)."""
    for name, count in (("pd", 1), ("second_pd", 1)):
        found = curve(name).points("r2")
        assert len(found) == count
        assert all(p.certificate.holds for p in found)


# ---- AUTO itself ----


@needs_auto
def test_autos_branch_and_curve_again(tmp_path):
    """Rows of AUTO's own runs, away from its labels: period, multipliers, and the fold curve's speeds."""
    auto = Auto(EQUATIONS, tmp_path)
    _, on_d, _ = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
    run = auto.run(tight(ORBIT_BRANCH), on_d)
    assert run.points("TR")
    rows = np.linspace(20, len(run.table) - 20, 12).astype(int)
    speeds, periods = run.table[rows, 0], run.table[rows, run.columns.index("PERIOD")]
    found = branch(0.002, 14.799, 0.3, FINE, at_values(SPEED, speeds.tolist())).points("event")
    for row, speed, period in zip(rows, speeds, periods, strict=True):
        here = [p for p in found if abs(p[SPEED] - speed) < 1e-8]
        orbit = min(here, key=lambda p: abs(p.orbit.period - period)).orbit
        assert orbit.period == pytest.approx(period, abs=1e-8)
        for mu in run.spectrum(row + 1):
            if abs(mu) > 1e-6:  # AUTO prints 6 digits
                assert np.min(np.abs(orbit.multipliers - mu)) < 2e-5 * max(abs(mu), 1e-3)

    start = run.points("LP")[0]
    line = auto.run(tight(LPC_CURVE), extended(auto, LPC_CURVE, start))
    at = np.linspace(5, len(line.table) - 5, 8).astype(int)
    columns = [line.columns.index(name) for name in ("U", "xi", "PERIOD")]
    theirs = line.table[np.ix_(at, columns)]
    ours = curve("lpc", tuple(theirs[:, 1].tolist())).points("event")
    for speed, damping_ratio, period in theirs:
        here = [p for p in ours if abs(p[DAMPING] - damping_ratio) < 1e-11]
        point = nearest(here, speed)
        assert point[SPEED] == pytest.approx(speed, abs=1e-6)
        assert point.orbit.period == pytest.approx(period, abs=1e-8)
