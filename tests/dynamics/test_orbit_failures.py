"""Wrong input is one message at the door; a walk that fails is a result that keeps its good orbits."""

from dataclasses import replace
from math import cos, sin, sqrt

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rainwind as rw
from rainwind.dynamics import cycle_zoo, zoo
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.dynamics.results import Ended
from rainwind.errors import ComputationError, InputError

KNOWN = cycle_zoo.planar.hopf()
MESH = rw.Mesh(10)
START = find_orbit(KNOWN.system, KNOWN.start.at, period=KNOWN.start.period, mesh=MESH)
EQUILIBRIA = rw.continue_equilibria(KNOWN.system, "mu", start=[0, 0], until=(-0.5, 1.5))
HOPF = EQUILIBRIA.points("hopf")[0]
FOLD = rw.continue_equilibria(zoo.cusp().system, "b", start=[-2], until=(-5, 5)).points("fold")[0]
BAUTIN = cycle_zoo.planar.bautin()
LPC = rw.continue_orbits(
    BAUTIN.system,
    "b1",
    start=find_orbit(BAUTIN.system, BAUTIN.start.at, period=BAUTIN.start.period, mesh=MESH),
    until=BAUTIN.until,
    ds=0.3,
).points("lpc")[0]
NAN, INF = float("nan"), float("inf")


def follow(system=KNOWN.system, **changes):
    options = {"along": "mu", "start": START, "until": (-0.5, 1.5), "ds": 0.3, "mesh": MESH, **changes}
    return rw.continue_orbits(system, options.pop("along"), **options)


# --- at the door ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"along": "nu"}, "there is no parameter 'nu'. Known: mu, omega, shear"),
        ({"along": 3}, "there is no parameter '3'"),
        ({"along": ["mu"]}, "there is no parameter"),
        ({"until": (1, 0)}, r"\(1, 0\): the first must be the smaller"),
        ({"until": (0, NAN)}, "upper bound of mu must be a finite number; got nan"),
        ({"until": 3}, r"two numbers \(low, high\); got 3"),
        ({"until": (1, 2)}, r"start: mu = 0.3 lies outside until = \(1, 2\); move one of them"),
        ({"start": HOPF, "until": (1, 2)}, r"start: mu = .* lies outside until = \(1, 2\)"),
        ({"ds": 0}, "ds = 0: the step of arclength must be a positive number"),
        ({"ds": "a"}, "ds must be a finite number; got 'a'"),
        ({"ds": INF}, "ds must be a finite number; got inf"),
        ({"limit": 0}, "limit = 0: at least one point"),
        ({"longest": 1}, "longest = 1: the factor by which the period may grow must be above 1"),
        ({"longest": NAN}, "longest must be a finite number; got nan"),
        ({"mesh": 20}, r"mesh must be a Mesh, for example Mesh\(intervals=40, degree=4\); got 20"),
        ({"mesh": "fine"}, "mesh must be a Mesh"),
        ({"start": HOPF, "mesh": 20}, "mesh must be a Mesh"),
        (
            {"start": None},
            r"orbits start from a Hopf point, an Orbit \(see find_orbit\) or a labelled orbit; got None",
        ),
        ({"start": [1.0, 0.0]}, "orbits start from a Hopf point.*; got list"),
        ({"start": FOLD}, "orbits start from a Hopf point.*; got a fold point"),
        ({"start": EQUILIBRIA}, "orbits start from a Hopf point.*; got Branch"),
        ({"system": BAUTIN.system}, "'mu'"),
        ({"system": zoo.cusp().system, "along": "b"}, "start has the states x, y, the system has x"),
        ({"system": 3}, "int is no model"),
    ],
)
def test_continue_orbits(changes, words):
    with pytest.raises(InputError, match=words):
        follow(**changes)


WINDOWS = {"b1": (-1, 1), "b2": (-1, 2)}


@pytest.mark.parametrize("continue_curve", [rw.continue_lpc, rw.continue_pd, rw.continue_ns])
def test_a_curve_starts_from_its_own_points(continue_curve):
    for start in (START, HOPF, None, "lpc"):
        with pytest.raises(InputError, match="starts from a labelled orbit"):
            continue_curve(BAUTIN.system, ("b1", "b2"), start=start, until=WINDOWS)
    if continue_curve is not rw.continue_lpc:
        with pytest.raises(InputError, match=r"starts from a labelled orbit \((pd|ns), .*\); got lpc"):
            continue_curve(BAUTIN.system, ("b1", "b2"), start=LPC, until=WINDOWS)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"along": ("b1", "b1")}, "two different parameters"),
        ({"along": ("b1",)}, "two different parameters"),
        ({"along": "b1"}, "two different parameters"),
        ({"along": ("b1", "c")}, "'c'"),
        ({"until": {"b1": (-1, 1)}}, "window"),
        ({"until": {**WINDOWS, "b1": (0, 1)}}, r"b1 = -0.25 lies outside until = \(0, 1\); move one of them"),
        ({"until": {**WINDOWS, "b1": (1, -1)}}, "the first must be the smaller"),
        ({"ds": -1}, "ds = -1"),
        ({"limit": 0}, "limit = 0"),
        ({"mesh": 20}, "mesh must be a Mesh"),
    ],
)
def test_continue_lpc(changes, words):
    options = {"along": ("b1", "b2"), "start": LPC, "until": WINDOWS, **changes}
    with pytest.raises(InputError, match=words):
        rw.continue_lpc(BAUTIN.system, options.pop("along"), **options)


def test_columns_and_kinds_by_wrong_names():
    branch = follow(ds=1.0)
    for name in ("z", "max z", "worst x", "mus"):
        with pytest.raises(InputError, match=name.split()[-1]):
            branch[name]
    with pytest.raises(InputError, match="fold"):
        branch.points("fold")
    with pytest.raises(InputError, match="'z'"):
        branch[0]["z"]


# --- a start that cannot be used ------------------------------------------------------------------------------------

RNG = np.random.default_rng(0)


@pytest.mark.parametrize(
    "profile",
    [
        5 * RNG.normal(size=START.profile.shape),
        np.zeros_like(START.profile),
        np.full_like(START.profile, 0.3),
        np.full_like(START.profile, NAN),
        1e6 * START.profile,
    ],
    ids=["noise", "at rest", "constant", "nan", "far"],
)
def test_a_start_from_which_newton_finds_no_orbit(profile):
    with pytest.raises(ComputationError, match=r"mu = 0.3; give a nearer one"):
        follow(start=replace(START, profile=profile))


def test_a_curve_that_cannot_be_started():
    noise = replace(LPC, orbit=replace(LPC.orbit, profile=5 * RNG.normal(size=LPC.orbit.profile.shape)))
    with pytest.raises(ComputationError, match="the lpc curve could not be started from lpc at b1"):
        rw.continue_lpc(BAUTIN.system, ("b1", "b2"), start=noise, until=WINDOWS)


def test_an_equilibrium_is_never_taken_for_an_orbit():
    """It solves the equations with any period. At these steps Newton falls from the last small orbits onto it."""
    for known, ds in ((cycle_zoo.planar.cusp(), 0.2), (BAUTIN, 0.13), (BAUTIN, 0.4), (known_level(), 0.3)):
        start = find_orbit(known.system, known.start.at, period=known.start.period, mesh=rw.Mesh(20))
        branch = rw.continue_orbits(
            known.system, known.along, start=start, until=known.until, ds=ds, mesh=rw.Mesh(20), longest=3
        )
        assert branch.audit() == []
        assert branch[known.system.states[0]].min() > 1e-6
        assert [p.parameter for p in branch.points("hopf")] == pytest.approx([known.hopf], abs=1e-9)


def known_level():
    return cycle_zoo.planar.level_curve()


# --- in the middle --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("start", [START, HOPF], ids=["orbit", "hopf"])
@pytest.mark.parametrize("after", [1, 2, 7])
def test_ctrl_c_keeps_the_orbits(start, after):
    def progress(orbit, count):
        assert orbit.states == ("x", "y")
        if count >= after:
            raise KeyboardInterrupt

    branch = follow(start=start, progress=progress)
    assert branch.ended[1] is Ended.INTERRUPTED
    assert len(branch) == max(after, 2 if start is START else 1)
    assert np.all(np.diff(branch.arclength) > 0)


def test_ctrl_c_in_the_second_half_keeps_the_first():
    seen = []

    def progress(orbit, count):
        seen.append(orbit.parameters["mu"])
        if len(seen) > 2 and seen[-1] < 0.25:
            raise KeyboardInterrupt

    branch = follow(progress=progress)
    assert branch.ended == (Ended.INTERRUPTED, Ended.AT_BOUND)
    assert branch["mu"][-1] == pytest.approx(1.5)
    assert branch["mu"][0] < 0.25


@pytest.mark.parametrize("limit", [1, 2, 3, 6])
def test_a_limit_on_the_number_of_points(limit):
    branch = follow(limit=limit, ds=0.05)
    assert branch.ended == (Ended.TOO_MANY_POINTS, Ended.TOO_MANY_POINTS)
    assert len(branch) == 2 * max(limit, 2) - 1
    assert "limit" in branch.audit()[0]
    (point,) = (born := follow(start=HOPF, limit=limit)).points()
    assert point.kind == "hopf"
    assert born.ended == (Ended.AT_HOPF, Ended.TOO_MANY_POINTS)
    assert len(born) == limit


def test_a_window_that_holds_no_orbit_of_the_branch():
    """The branch of a soft Hopf point leaves a window that ends there at once: no orbit, and still a result."""
    branch = follow(start=HOPF, until=(-1.0, HOPF.parameter))
    assert len(branch) <= 1
    assert [p.kind for p in branch.points()] == ["hopf"]
    assert "hopf" in repr(branch)
    assert branch.ended[0] is Ended.AT_HOPF


def test_a_start_on_the_bound():
    branch = follow(until=(0.3, 1.0))
    assert branch.ended == (Ended.AT_BOUND, Ended.AT_BOUND)
    assert branch["mu"].min() == pytest.approx(0.3, abs=1e-12)


def test_a_mesh_at_its_limit():
    """Van der Pol at mu = 20 has layers of width 1/400: four intervals cannot hold it, and are not let to."""
    known = cycle_zoo.van_der_pol.van_der_pol(born=False)
    system = known.system.with_parameters({"mu": 0.3})
    start = find_orbit(system, [2.0, 0.0], mesh=MESH)
    for mesh in (rw.Mesh(4, 2, most=4), rw.Mesh(4, 3, most=6), rw.Mesh(8, 2, most=12)):
        branch = rw.continue_orbits(system, "mu", start=start, until=(0.2, 20), ds=0.5, mesh=mesh)
        assert branch.ended[1] in (Ended.MESH_AT_LIMIT, Ended.STEP_TOO_SMALL)
        assert branch["mu"][-1] < 10
        kept = [orbit for orbit in branch[1:] if len(orbit.grid.lengths) == mesh.most]
        assert all(orbit.mesh_error < 1e-2 for orbit in kept if orbit.parameters["mu"] > 0.31)
        assert branch.audit()
    branch = rw.continue_orbits(
        system, "mu", start=start, until=(0.2, 20), ds=0.5, mesh=rw.Mesh(10, 4, most=400)
    )
    assert branch.ended == (Ended.AT_BOUND, Ended.AT_BOUND)
    assert max(len(orbit.grid.lengths) for orbit in branch) > 40
    assert branch[-1].period == pytest.approx(cycle_zoo.van_der_pol.TABLE[20.0][0], rel=1e-6)


def test_a_step_too_long_for_what_it_meets_is_halved():
    branch = follow(ds=50.0)
    assert branch["mu"].max() == pytest.approx(1.5)
    assert all(isinstance(end, Ended) for end in branch.ended)


def test_a_model_that_refuses_states():
    def refusal(x, p):
        return "too far" if abs(x[0]) > 0.8 else None

    system = rw.System(KNOWN.system.rhs, ("x", "y"), dict(KNOWN.system.parameters), refusal=refusal)
    branch = follow(system)
    assert branch.ended == (Ended.AT_HOPF, Ended.REFUSED)
    assert 0.4 < branch["mu"][-1] < 0.64 + 1e-9
    assert branch["max x"].max() < 0.8 + 1e-2


@pytest.mark.parametrize("place", ["parameter", "state"])
def test_a_right_hand_side_that_becomes_nan(place):
    """log(1 - mu), or the root of 0.9 - x, ends the branch: a result with the orbits before."""

    def rhs(x, p):
        square = x.x**2 + x.y**2
        edge = rw.log(1 - p.mu) if place == "parameter" else rw.sqrt(0.9 - x.x)
        return (p.mu - square) * x.x - x.y, x.x + (p.mu - square) * x.y + 1e-3 * edge

    system = rw.System(rhs, ("x", "y"), {"mu": 0.3})
    start = find_orbit(system, lambda t: sqrt(0.3) * np.array([cos(t), sin(t)]), period=6.28, mesh=MESH)
    branch = rw.continue_orbits(system, "mu", start=start, until=(0.1, 1.5), ds=0.4, mesh=MESH)
    assert branch.ended[0] is Ended.AT_BOUND
    assert branch.ended[1] in (Ended.STEP_TOO_SMALL, Ended.NOT_FINITE, Ended.MESH_AT_LIMIT)
    assert 0.5 < branch["mu"][-1] < 1.0 + 1e-9
    assert np.all(np.isfinite(branch["period"]))
    assert np.all(np.isfinite(branch["residual"]))
    assert branch.audit()


def test_a_user_s_own_error_is_not_swallowed():
    def progress(orbit, count):
        raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        follow(progress=progress)


# --- any system with a Hopf point -----------------------------------------------------------------------------------


def random_system(rng, n):
    """A pair that crosses at mu = 0, n - 2 decaying states, quadratic and cubic terms, in random coordinates.

    The cubic terms pull inwards, so that the branch is there for mu > 0 or, where the quadratic ones win, below.
    """
    omega = rng.uniform(0.5, 3.0)
    rates = -rng.uniform(0.3, 3.0, n)
    quadratic = 0.4 * rng.normal(size=(n, n, n))
    matrix = np.linalg.qr(rng.normal(size=(n, n)))[0] @ np.diag(rng.uniform(0.5, 2.0, n))
    inverse = np.linalg.inv(matrix)

    def rhs(y, p):
        z = [sum(float(inverse[i, j]) * y[j] for j in range(n)) for i in range(n)]
        square = sum(value**2 for value in z)
        f = [p.mu * z[0] - omega * z[1], omega * z[0] + p.mu * z[1]]
        f += [float(rates[i]) * z[i] for i in range(2, n)]
        for i in range(n):
            bent = sum(float(quadratic[i, j, k]) * z[j] * z[k] for j in range(n) for k in range(j, n))
            f[i] = f[i] + bent - square * z[i]
        return [sum(float(matrix[i, j]) * f[j] for j in range(n)) for i in range(n)]

    return rw.System(rhs, tuple(f"y{i}" for i in range(n)), {"mu": -0.1}), omega


@settings(
    max_examples=12, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.differing_executors]
)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 4), ds=st.sampled_from([0.1, 0.5]))
def test_random_systems(seed, n, ds):
    """What any cycle must have: small defects, a multiplier 1, Liouville's formula, a period of no mesh's making."""
    system, omega = random_system(np.random.default_rng(seed), n)
    equilibria = rw.continue_equilibria(system, "mu", start=[0.0] * n, until=(-0.3, 0.3))
    hopf = min(equilibria.points("hopf"), key=lambda p: abs(p.parameter))
    assert hopf.parameter == pytest.approx(0.0, abs=1e-9)
    meshes = (rw.Mesh(20, 4), rw.Mesh(33, 5))
    branches = [
        rw.continue_orbits(system, "mu", start=hopf, until=(-0.3, 0.3), ds=ds, mesh=mesh, limit=60)
        for mesh in meshes
    ]
    for branch in branches:
        assert not [p for p in branch.points() if not p.certificate.holds]
        assert branch.unexplained == ()
        first = branch[0]
        assert first.period == pytest.approx(2 * np.pi / omega, rel=0.1)
        assert (first.parameters["mu"] > 0) == (hopf.lyapunov < 0)
        for orbit in branch:
            error = max(1e-7, 1e3 * orbit.mesh_error)
            assert orbit.residual < 1e-7
            assert abs(np.expm1(orbit.trivial)) < error
            assert abs(orbit.liouville) < error
            assert orbit.profile[-1] == pytest.approx(orbit.profile[0], abs=1e-8)
    coarse, fine = branches
    for orbit in coarse[:: max(1, len(coarse) // 5)]:
        again = find_orbit(system.with_parameters(orbit.parameters), orbit, mesh=rw.Mesh(41, 6))
        assert orbit.period == pytest.approx(again.period, rel=max(1e-8, orbit.mesh_error))
    kinds = [[p.kind for p in branch.points()] for branch in branches]
    shortest = min(map(len, kinds))
    assert kinds[0][:shortest] == kinds[1][:shortest]
    assert fine[0].grid.degree == 5


def test_a_family_whose_period_changes_is_one_too():
    """Duffing's oscillator, undamped at mu = 0."""
    system = rw.System(lambda x, p: (x.v, p.mu * x.v - x.u - x.u**3), ("u", "v"), {"mu": -0.5})
    (hopf,) = rw.continue_equilibria(system, "mu", start=[0, 0], until=(-1, 1)).points("hopf")
    branch = rw.continue_orbits(system, "mu", start=hopf, until=(-1, 1), ds=0.2)
    assert branch.ended[1] is Ended.FAMILY
    assert np.ptp(branch["period"]) > 0.1


@pytest.mark.parametrize("ds", [0.05, 0.5])
def test_a_vertical_family_ends_early_and_says_so(ds):
    """Van der Pol's cycles at mu = 0 are all circles: the Hopf point there is degenerate."""
    system = rw.System(lambda x, p: (x.v, p.mu * (1 - x.u**2) * x.v - x.u), ("u", "v"), {"mu": -0.5})
    (hopf,) = rw.continue_equilibria(system, "mu", start=[0, 0], until=(-1, 1)).points("hopf")
    branch = rw.continue_orbits(system, "mu", start=hopf, until=(-1, 1), ds=ds)
    assert branch.ended[1] is Ended.FAMILY
    assert len(branch) < 20
    assert abs(branch["mu"]).max() < 1e-9
    linear = rw.System(lambda x, p: (p.mu * x.u - x.v, x.u + p.mu * x.v), ("u", "v"), {"mu": -0.5})
    found = rw.diagram(linear, "mu", until=(-1, 1), ds=ds)
    assert [b.ended[1] for b in found.orbits] == [Ended.FAMILY]
    assert any("a whole family of orbits at one value" in note for note in found.notes)
