"""Branches of the cycle zoo: every label at its exact place, whatever the step; every start; every end.

Meshes are of degree 4. With 20 intervals labels are good to 1e-6 (their places err like the mesh points, N^-8).
"""

from functools import cache
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rainwind as rw
from rainwind.dynamics import cycle_zoo
from rainwind.dynamics.cycle_zoo.van_der_pol import TABLE
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.dynamics.results import Ended

ZOO = cycle_zoo.everything()
ZOO_BRANCHES = [name for name in ZOO if name != "alpha loop"]  # its cycles are not known
MESH = rw.Mesh(20)


def exact_start(known, cycle=None, mesh=MESH):
    """An orbit of the branch by Newton from the exact one."""
    cycle = cycle or known.start
    system = known.system.with_parameters(cycle.parameters)
    if known.system.parameters.keys() == {"mu"}:  # van der Pol's cycle takes long to compute
        return find_orbit(system, cycle.at(np.array(0.0)), period=cycle.period, mesh=mesh)
    return find_orbit(system, cycle.at, period=cycle.period, mesh=mesh)


@cache
def followed(name, ds):
    known = ZOO[name]
    start = exact_start(known)
    return rw.continue_orbits(
        known.system, known.along, start=start, until=known.until, ds=ds, mesh=MESH, longest=8
    )


def assert_found(branch, answers, tolerance=1e-6, stiff=False):
    """The labels but for Hopf points are the answers: as many, each at its place, with all that is known of it."""
    assert len(branch.audit()) == stiff
    assert all("faster than the mesh follows" in fault for fault in branch.audit())
    left = [p for p in branch.points() if p.kind != "hopf"]
    for answer in answers:
        near = [
            p
            for p in left
            if p.kind == answer.kind
            and all(abs(p.parameters[k] - v) < tolerance for k, v in answer.at.items())
        ]
        assert near, f"{answer} is missing among {[str(p) for p in left]}"
        point = min(near, key=lambda p: abs((p.angle or 0.0) - (answer.angle or 0.0)))
        left.remove(point)
        assert point.certificate.holds, str(point.certificate)
        assert 0.0 < point.certificate.residual < 1e-7
        if point.kind == "ns":
            assert point.angle == pytest.approx(answer.angle, abs=1e-5)
        if answer.soft is not None:
            assert (point.coefficient < 0) == answer.soft, str(point)
    assert not left, f"too many: {[str(p) for p in left]}"


@pytest.mark.parametrize("ds", [0.05, 0.2, 1.0])
@pytest.mark.parametrize("name", ZOO_BRANCHES)
def test_the_labels_of_a_branch(name, ds):
    known = ZOO[name]
    branch = followed(name, ds)
    assert_found(branch, known.answers, stiff=name == "stiff")
    hopf = [p.parameter for p in branch.points("hopf")]
    assert hopf == pytest.approx([] if known.hopf is None else [known.hopf], abs=1e-9)
    assert (Ended.AT_HOPF in branch.ended) == (known.hopf is not None)
    if known.closed:
        assert branch.ended == (Ended.CLOSED, Ended.CLOSED)
        assert branch[0] is branch[-1]
    elif known.homoclinic is not None:
        assert branch.ended[1] is Ended.HOMOCLINIC
        assert branch[known.along][-1] == pytest.approx(known.homoclinic, abs=1e-6)
    elif known.hopf is None:
        assert branch.ended == (Ended.AT_BOUND, Ended.AT_BOUND)


@pytest.mark.parametrize("name", ["fold-flip", "bogdanov-takens", "1:2, doubled", "cusp from hopf"])
def test_the_labels_of_a_branch_in_short_steps(name):
    assert_found(followed(name, 0.01), ZOO[name].answers)


@pytest.mark.parametrize("name", [n for n in ZOO_BRANCHES if not n.startswith("van der pol")])
def test_periods_and_multipliers_along_a_branch(name):
    known, seen = ZOO[name], 0
    for orbit in followed(name, 0.2)[::4]:
        value = orbit.parameters[known.along]
        cycles = known.cycles({known.along: value}, known.branch)
        if known.homoclinic is not None and abs(value - known.homoclinic) < 1e-4:
            continue  # there the exact period itself loses digits
        nearest = min(cycles, key=lambda c: _far(orbit, c))
        exponents = np.sort(nearest.exponents.real)
        exact = np.delete(exponents, np.argmin(np.abs(exponents)))
        if name != "stiff" and np.abs(exact).min() < 0.02:
            continue  # near a fold of cycles the nearest one moves like the root of the error
        seen += 1
        assert orbit.period == pytest.approx(nearest.period, rel=1e-6)
        found = orbit.exponents.real
        # those of fast decay, exp(-T rate / 20) in an interval, are worse; of exp(-1e6 T) nothing is right
        for exponent in exact[exact > -20]:
            assert np.abs(found - exponent).min() < 1e-4 * (1 + abs(exponent))
        # the trace's integral is good, so that Liouville's error is the multipliers' own
        total = found.sum() + orbit.trivial.real - exact.sum()
        assert orbit.liouville == pytest.approx(total, rel=1e-5, abs=1e-5)
    assert seen > 3


def _far(orbit, cycle):
    """How far the largest and smallest states are from a cycle's."""
    x = cycle.at(cycle.period * np.arange(256) / 256)
    return np.abs(orbit.extremes - [x.min(axis=0), x.max(axis=0)]).max() + abs(orbit.period - cycle.period)


@pytest.mark.parametrize("name", ["cusp", "lorenz", "fold-flip", "predator-prey", "pitchfork, one full turn"])
@pytest.mark.parametrize("ds", [0.07, 0.5])
def test_the_start_does_not_matter(name, ds):
    known = ZOO[name]
    low, high = known.until
    for share in (0.03, 0.93):
        cycles = known.cycles({known.along: low + share * (high - low)}, known.branch)
        for cycle in cycles:
            start = exact_start(known, cycle)
            branch = rw.continue_orbits(
                known.system, known.along, start=start, until=known.until, ds=ds, mesh=MESH
            )
            assert_found(branch, known.answers)


@pytest.mark.parametrize("name", ["cusp", "soft doubling", "chenciner", "transcritical", "fold-flip"])
def test_a_parameter_that_runs_the_other_way(name):
    """q = -p: the same labels in reverse, and the same exponents."""
    known = ZOO[name]

    def rhs(x, p):
        values = {k: (-p[k] if k == known.along else p[k]) for k in known.system.parameters}
        return known.system.rhs(x, cycle_zoo.Named(values))

    parameters = {**known.system.parameters, known.along: -known.system.parameters[known.along]}
    system = rw.System(rhs, known.system.states, parameters)
    start = find_orbit(system, known.start.at, period=known.start.period, mesh=MESH)
    low, high = known.until
    branch = rw.continue_orbits(
        system, known.along, start=start, until=(-high, -low), ds=0.2, mesh=MESH, longest=6
    )
    assert branch.audit() == []
    one, other = branch.points(), followed(name, 0.2).points()
    assert sorted((p.kind, round(-p.parameter, 6) + 0.0) for p in one) == sorted(
        (p.kind, round(p.parameter, 6) + 0.0) for p in other
    )
    for p, q in zip(
        sorted(one, key=lambda p: p.parameter), sorted(other, key=lambda p: -p.parameter), strict=True
    ):
        assert np.sort(p.eigenvalues.real)[1:] == pytest.approx(np.sort(q.eigenvalues.real)[1:], abs=1e-5)


DISGUISED = [n for n in ZOO_BRANCHES if not n.startswith(("van der pol", "level", "stiff"))]


@settings(
    max_examples=14, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.differing_executors]
)
@given(
    name=st.sampled_from(DISGUISED),
    seed=st.integers(0, 10**6),
    bend=st.sampled_from([0.0, 0.1, 0.2]),
    ds=st.sampled_from([0.1, 0.4, 1.0]),
)
def test_labels_do_not_depend_on_coordinates(name, seed, bend, ds):
    known, rng = ZOO[name], np.random.default_rng(seed)
    n = len(known.system.states)
    turn, again = (np.linalg.qr(rng.normal(size=(n, n)))[0] for _ in range(2))
    hidden = cycle_zoo.disguised(known, turn @ np.diag(10 ** rng.uniform(-0.4, 0.4, n)) @ again, bend)
    start = find_orbit(hidden.system, hidden.start.at, period=hidden.start.period, mesh=rw.Mesh(30))
    branch = rw.continue_orbits(
        hidden.system, hidden.along, start=start, until=hidden.until, ds=ds, mesh=rw.Mesh(30), longest=6
    )
    assert_found(branch, hidden.answers)


# --- where a branch begins ------------------------------------------------------------------------------------------

BORN = [name for name, known in ZOO.items() if known.equilibrium is not None]


@cache
def hopf_point(name):
    known = ZOO[name]
    equilibria = rw.continue_equilibria(
        known.system, known.along, start=list(known.equilibrium), until=known.until
    )
    return min(equilibria.points("hopf"), key=lambda p: abs(p.parameter - known.hopf))


@pytest.mark.parametrize("ds", [0.05, 0.3])
@pytest.mark.parametrize("name", BORN)
def test_a_branch_from_its_hopf_point(name, ds):
    known, hopf = ZOO[name], hopf_point(name)
    branch = rw.continue_orbits(
        known.system, known.along, start=hopf, until=known.until, ds=ds, mesh=MESH, longest=8
    )
    assert_found(branch, known.answers)
    assert branch.ended[0] is Ended.AT_HOPF
    assert branch.ended[1] is (Ended.AT_BOUND if known.homoclinic is None else Ended.HOMOCLINIC)
    (named,) = branch.points("hopf")
    assert named.arclength == 0.0
    assert named.parameter == pytest.approx(known.hopf, abs=1e-9)
    assert branch.arclength[0] > 0
    assert branch[0].period == pytest.approx(2 * pi / hopf.omega, rel=0.02)
    # amplitudes grow like the root of the distance
    assert np.max([*branch[0].amplitude.values()]) < 2 * ds


def test_the_hopf_normal_form_in_closed_form():
    """r^2 = mu, T = 2 pi / (omega + shear mu), log of the multiplier -2 mu T, along the whole branch."""
    p = ZOO["hopf"].system.parameters
    branch = rw.continue_orbits(
        ZOO["hopf"].system, "mu", start=hopf_point("hopf"), until=(-0.5, 1.5), ds=0.2, mesh=rw.Mesh(20, 5)
    )
    mu = branch["mu"]
    assert branch["x"] == pytest.approx(np.sqrt(mu), rel=1e-7)
    assert branch["max y"] == pytest.approx(np.sqrt(mu), rel=1e-7)
    assert branch["mean x"] == pytest.approx(0, abs=1e-9)
    assert branch["period"] == pytest.approx(2 * pi / (p["omega"] + p["shear"] * mu), rel=1e-9)
    assert branch.exponents[:, 0].real == pytest.approx(-2 * mu * branch["period"], rel=1e-7, abs=1e-9)
    assert not branch.unstable.any()


def test_the_alpha_loop_ends_homoclinic_where_it_should():
    branch = rw.continue_orbits(
        ZOO["alpha loop"].system, "mu", start=hopf_point("alpha loop"), until=(-0.1, 0.3), ds=0.1, longest=12
    )
    assert branch.ended == (Ended.AT_HOPF, Ended.HOMOCLINIC)
    assert branch["mu"][-1] == pytest.approx(0.0, abs=1e-6)
    assert branch["period"][-1] > 12 * branch["period"][0]
    assert branch.audit() == []
    # the loop's rightmost point: x^2 (1 - x) = y^2 ends at x = 1
    assert branch[-1].extremes[:, 0] == pytest.approx([0.0, 1.0], abs=1e-3)


@pytest.mark.parametrize("mu", [1.0, 5.0, 10.0])
def test_van_der_pols_period_and_multiplier_to_ten_digits(mu):
    known = cycle_zoo.van_der_pol.van_der_pol(born=False)
    system = known.system.with_parameters({"mu": 0.9 * mu})
    mesh = rw.Mesh(int(60 + 12 * mu), 7)
    start = find_orbit(system, [2.0, 0.0], mesh=mesh)
    branch = rw.continue_orbits(system, "mu", start=start, until=(0.5 * mu, mu), ds=1.0, mesh=mesh)
    period, amplitude, exponent = TABLE[mu]
    end = branch[-1]
    assert end.parameters["mu"] == mu
    assert end.period == pytest.approx(period, rel=1e-10)
    assert end.extremes[1, 0] == pytest.approx(amplitude, rel=1e-9)
    if mu < 10:  # exp(-312) decays too fast for this mesh
        assert end.exponents[0].real == pytest.approx(exponent, rel=1e-6)


def test_from_another_orbit_on_another_mesh():
    known = ZOO["cusp"]
    start = exact_start(known)
    for mesh in (rw.Mesh(13, 5), rw.Mesh(40, 3), None):
        branch = rw.continue_orbits(known.system, "b", start=start, until=known.until, ds=0.5, mesh=mesh)
        assert_found(branch, known.answers, tolerance=1e-5)
        if mesh is not None:
            assert branch[0].grid.degree == mesh.degree


@pytest.mark.parametrize("kind", ["lpc", "ns"])
def test_from_a_labelled_orbit_on_the_branch(kind):
    name = {"lpc": "bogdanov-takens", "ns": "bogdanov-takens"}[kind]
    known = ZOO[name]
    point = followed(name, 0.2).points(kind)[0]
    branch = rw.continue_orbits(known.system, known.along, start=point, until=known.until, ds=0.2, mesh=MESH)
    assert [p.kind for p in branch.points()] != []
    assert branch.audit() == []
    others = [a for a in known.answers if a.kind != kind]
    left = [p for p in branch.points() if p.kind != kind]
    assert [p.parameter for p in left] == pytest.approx([a.at[known.along] for a in others], abs=1e-6)


# --- where branches meet --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ds", [0.05, 0.3, 1.0])
@pytest.mark.parametrize(
    "name", ["soft doubling", "hard doubling", "soft doubling, flat", "generalised doubling"]
)
def test_a_period_doubling_leads_onto_the_doubled_branch(name, ds):
    """z1^2 = -a / b, period twice 2 pi / (carrier + shear z1^2): both exactly."""
    known = ZOO[name]
    (pd,) = followed(name, 0.2).points("pd")
    branch = rw.continue_orbits(known.system, "a", start=pd, until=known.until, ds=ds, mesh=rw.Mesh(40))
    assert branch.ended[0] is Ended.REVISITED
    assert branch.audit() == []
    p, a = known.system.parameters, branch["a"]
    square = -a / p["b"] if not p["e"] else (p["b"] + np.sign(p["b"]) * np.sqrt(p["b"] ** 2 + 4 * a)) / 2
    if not p["e"]:
        assert np.all(square > 0)
        assert branch["period"] == pytest.approx(4 * pi / (p["carrier"] + p["shear"] * square), rel=1e-7)
        assert branch["period"][0] == pytest.approx(2 * pd.orbit.period, rel=0.05)
        assert (a[0] > 0) == (pd.coefficient < 0)
        if name == "soft doubling, flat":
            # w = z1 (cos, sin) of half the angle
            assert branch["max u"] == pytest.approx(np.sqrt(square), abs=1e-6)
        assert np.ptp(a) > 0.5
    for orbit in branch[::7]:
        half = orbit.at(orbit.period * (orbit.grid.nodes + 0.5))
        assert np.abs(half - orbit.profile).max() > 1e-3 * sqrt(abs(orbit.parameters["a"]))


@pytest.mark.parametrize("ds", [0.1, 0.5])
@pytest.mark.parametrize(
    "name", ["transcritical", "pitchfork", "pitchfork, one full turn", "pitchfork, no turn", "predator-prey"]
)
def test_a_branch_point_leads_onto_the_crossing_branch(name, ds):
    known = ZOO[name]
    (bp,) = followed(name, 0.2).points("bp")
    branch = rw.continue_orbits(known.system, known.along, start=bp, until=known.until, ds=ds, mesh=MESH)
    assert branch.audit() == []
    assert len(branch) > 5
    for orbit in branch[::3]:
        value = orbit.parameters[known.along]
        crossing = known.cycles({known.along: value}, "crossing")
        main = known.cycles({known.along: value}, "main")
        assert crossing, f"no crossing cycle at {value}"
        best = min(crossing, key=lambda c: _far(orbit, c))
        assert _far(orbit, best) < 2e-3
        assert orbit.period == pytest.approx(best.period, rel=1e-6)
        if abs(value - bp.parameter) > 0.05:
            assert _far(orbit, main[0]) > 5 * _far(orbit, best)


def test_the_branch_of_the_lorenz_equations_turns_at_its_pitchfork():
    """Both sides of the pitchfork are one branch: periods differ, and the parameter turns at the bp."""
    branch = followed("lorenz", 0.2)
    assert [p.kind for p in branch.points()] == ["ns", "bp", "ns"]
    assert branch["rho"].min() == pytest.approx(1.0, abs=0.05)
