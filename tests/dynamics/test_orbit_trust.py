"""Whether multipliers are to be believed: what the mesh, rounding and stiffness do to them, and what is said of it."""

from functools import cache
from itertools import product

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import cycle_zoo
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.kernels import trust
from rainwind.dynamics.orbit_equations import OrbitEquations
from rainwind.dynamics.orbit_trust import (
    Doubt,
    intervals_for,
    lost_in_rounding,
    mesh_is_to_blame,
    stiffness,
    trivial_error,
    words,
)

ZOO = cycle_zoo.everything()


def fitzhugh_nagumo(eps=0.08):
    def rhs(x, p):
        return x.v - x.v**3 / 3 - x.w + p.I, p.eps * (x.v + 0.7 - 0.8 * x.w)

    return rw.System(rhs, ("v", "w"), {"I": 0.0, "eps": eps})


@cache
def canards(ds, most=0, eps=0.08):
    system = fitzhugh_nagumo(eps)
    rest = rw.continue_equilibria(system, "I", start={"v": -1.2, "w": -0.6}, until=(-0.5, 2))
    mesh = rw.Mesh(40, most=most) if most else None
    return rw.continue_orbits(system, "I", start=rest.points("hopf")[0], until=(-0.5, 2), ds=ds, mesh=mesh)


# --- the mesh -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ds", [0.05, 0.2, 1.0])
def test_folds_of_canards_are_found_whatever_the_step(ds):
    """(v, w, I) -> (-v, 7/4 - w, 7/4 - I) maps the equations onto themselves, and one fold onto the other."""
    branch = canards(ds)
    assert branch.audit() == []
    assert [p.kind for p in branch.points()] == ["hopf", "lpc", "lpc", "hopf"]
    first, last = branch.points("lpc")
    assert first.parameter + last.parameter == pytest.approx(1.75, abs=1e-9)
    assert first.orbit.period == pytest.approx(last.orbit.period, abs=5e-3)
    assert first.coefficient == pytest.approx(-last.coefficient, rel=5e-3)
    assert first.parameter == pytest.approx(0.3241785225, abs=1e-9)  # the same at all steps
    assert branch["mesh_error"].max() < 1e-5
    # the unstable canards, then relaxation oscillations: nothing in between
    assert np.flatnonzero(np.diff(branch.unstable)).size == 2


def test_a_mesh_that_may_not_grow_is_said_to_be_too_coarse():
    branch = canards(0.2, most=40)
    assert branch["mesh_error"].max() < 1e-3
    assert branch["trivial_error"].max() > 1.0
    assert any("too coarse for the trivial multiplier" in fault for fault in branch.audit())
    doubted = [orbit for orbit in branch if "too coarse" in orbit.doubt]
    assert doubted
    assert all(orbit.trivial_error > 1e-3 for orbit in doubted)


def problem_of(system, along, orbit):
    units = np.maximum(1.0, np.abs(orbit.profile).max(axis=0))
    problem = OrbitEquations(
        system.with_parameters(orbit.parameters), (along,), orbit.grid, units, orbit.period, np.array([0.1])
    )
    return problem, np.concatenate([orbit.profile.ravel(), [orbit.period, orbit.parameters[along]]])


def floor_and_growth(system, along, orbit):
    problem, u = problem_of(system, along, orbit)
    at, flow = problem.linearise(u), problem.flow(u)
    floor, wrong = trust.flow_defects(at.steps, flow)
    return floor, trust.magnified(kernel.deflated(at.steps, flow), flow), wrong


def test_the_floor_of_rounding_is_where_finer_meshes_stop_to_help():
    """At one canard: the error falls like N^-8 down to about the floor, and the floor does not depend on the mesh."""
    system = fitzhugh_nagumo()
    coarse = next(orbit for orbit in canards(0.2) if orbit.period > 62)
    errors, floors = [], []
    for many in (60, 90, 135, 200, 300):
        problem, u = problem_of(system, "I", coarse)
        grid = coarse.grid.adapted(coarse.profile, np.ones(2), many)
        other = problem.on(grid)
        tangent = np.zeros(other.profile_size + 2)
        tangent[-2] = 1.0  # at the same period
        node = other.correct(None, problem.moved(u, grid), tangent)
        errors.append(node.trivial_error)
        floors.append(floor_and_growth(system, "I", other.orbit(node))[0])
    assert errors[0] > 100 * errors[2]
    assert max(floors[2:]) < 5 * min(floors[2:])
    assert 1e-6 < floors[-1] < 1e-3
    assert errors[-1] < 10 * floors[-1]


# --- rounding -------------------------------------------------------------------------------------------------------


@cache
def to_the_saddle(ds=0.2):
    known = ZOO["level curve"]
    mesh = rw.Mesh(20)
    start = find_orbit(known.system, known.start.at, period=known.start.period, mesh=mesh)
    return rw.continue_orbits(
        known.system, known.along, start=start, until=known.until, ds=ds, mesh=mesh, longest=8
    )


def test_growth_on_the_way_past_a_saddle_of_known_eigenvalues():
    """Eigenvalues 1 and -1: two orbits whose periods differ by 2 s pass the saddle with exp(s) more growth each way."""
    known = ZOO["level curve"]
    orbits = {
        round(period): floor_and_growth(known.system, "h", orbit) for period, orbit in past_the_saddle()
    }
    (t0, first), (t1, last) = min(orbits.items()), max(orbits.items())
    assert (last[1] - first[1]) / (t1 - t0) == pytest.approx(1.0, abs=0.1)
    assert np.log(last[0] / first[0]) / (t1 - t0) == pytest.approx(1.0, abs=0.15)


def past_the_saddle():
    return [(orbit.period, orbit) for orbit in to_the_saddle() if 22 < orbit.period < 32]


def test_what_is_lost_in_rounding_gives_neither_labels_nor_a_mesh_without_end():
    branch = to_the_saddle()
    lost = [orbit for orbit in branch if orbit.trivial_error > 0.1]
    assert len(lost) > 3
    assert max(len(orbit.grid.lengths) for orbit in branch) < 200  # 320 were allowed
    assert [p.kind for p in branch.points()] == ["hopf"]
    # in the plane the other multiplier does not suffer: the trace's integral tells
    assert all(abs(orbit.liouville) < 1e-3 for orbit in lost)
    assert all(orbit.doubt == "" for orbit in lost)


def test_no_label_is_certain_where_rounding_decides_the_signs():
    """exp(250) of growth: no fold's place is known, and none is given without a word."""
    branch = canards(0.2, most=60, eps=0.01)
    assert branch.audit()
    assert not [p for p in branch.points("lpc") if p.certificate.holds and p.orbit.trivial_error > 0.1]
    jumps = [p.arclength for p in branch.points("lpc") if p.certificate.holds]
    jumps += [gap.between[0] for gap in branch.unexplained if gap.change]
    crossings = np.flatnonzero(np.diff(branch.unstable))
    assert len(crossings) >= 2
    for k in crossings:
        named = min(abs(np.array(jumps) - branch.arclength[k]), default=np.inf) < 1.0
        assert named or branch[k].doubt or branch[k + 1].doubt


# --- where two multipliers are 1 ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("bautin", "lpc"),
        ("cusp from hopf", "lpc"),
        ("isola", "lpc"),
        ("lorenz", "bp"),
        ("predator-prey", "bp"),
    ],
)
def test_the_trivial_error_means_something_at_folds_and_branch_points(name, kind):
    known = ZOO[name]
    mesh = rw.Mesh(20)
    start = find_orbit(known.system, known.start.at, period=known.start.period, mesh=mesh)
    branch = rw.continue_orbits(known.system, known.along, start=start, until=known.until, ds=0.2, mesh=mesh)
    for point in branch.points(kind):
        assert abs(np.expm1(point.orbit.trivial)) > 1e-3  # the multiplier itself is of no use
        assert point.orbit.trivial_error < 1e-9
        assert abs(point.orbit.liouville) < 1e-3
        assert point.certificate.checks["trivial multiplier"][0] == point.orbit.trivial_error
    assert branch["trivial_error"].max() < 1e-6


@pytest.mark.parametrize(("d", "e"), list(product([1e-12, 1e-6, 1e-2], [1e-10, 1e-7])))
def test_the_trivial_error_of_a_matrix_written_down(d, e):
    """M - 1 = ((0, b), (e, d)): one step of inverse iteration from (1, 0) gives 1 + b e / d, and b e is wanted."""
    b = 0.7
    solved = np.linalg.solve(np.array([[0.0, b], [e, d]]), [1.0, 0.0])
    step = complex(np.log(1.0 + 1.0 / solved[0] + 0j))
    if abs(1.0 / solved[0]) > 1e-9:
        assert trivial_error(step, np.array([np.log1p(d)], complex)) == pytest.approx(b * e, rel=1e-2)


# --- stiffness ------------------------------------------------------------------------------------------------------


def test_a_stiff_system_says_so():
    """Rates to -1e6 in a period of 1: as computed, a multiplier of exp(-1e6) is 0.999."""
    known = ZOO["stiff"]
    mesh = rw.Mesh(20)
    start = find_orbit(known.system, known.start.at, period=known.start.period, mesh=mesh)
    branch = rw.continue_orbits(known.system, known.along, start=start, until=known.until, ds=0.5, mesh=mesh)
    assert branch.exponents.real[:, :2].max() > -0.1
    (fault,) = branch.audit()
    assert "faster than the mesh follows" in fault
    assert fault.startswith(f"{len(branch)} orbits at mu = -1 to 1.5")
    assert all(len(orbit.grid.lengths) == 20 for orbit in branch)  # no mesh allowed would do


@pytest.mark.parametrize(("rate", "said"), [(5.0, False), (40.0, False), (400.0, False), (4000.0, True)])
def test_a_stiff_state_beside_a_circle(rate, said):
    """z' = -rate (z - x), period 1: log mu = -rate. The mesh grows as far as it helps; beyond that it is said."""

    def rhs(x, p):
        growth = p.mu - x.x**2 - x.y**2
        turn = 2 * np.pi
        return growth * x.x - turn * x.y, turn * x.x + growth * x.y, -rate * (x.z - x.x)

    system = rw.System(rhs, ("x", "y", "z"), {"mu": 1.0})
    start = find_orbit(system, [1.0, 0.0, 1.0], period=1.0, mesh=rw.Mesh(10))
    branch = rw.continue_orbits(system, "mu", start=start, until=(0.9, 1.5), ds=0.2, mesh=rw.Mesh(10))
    doubted = ["faster than the mesh" in orbit.doubt for orbit in branch]
    smallest = branch.exponents.real.min(axis=1)
    if said:
        assert all(doubted)
        assert np.all(smallest > -12.0)
        return
    assert sum(doubted) == (rate == 400.0)  # the start, whose mesh was given
    assert np.sum(smallest > max(-rate, -12.0) + 0.1) == sum(doubted)
    assert branch[0].grid.lengths.size == (73 if rate == 400.0 else 10)


# --- the rules ------------------------------------------------------------------------------------------------------


def test_rules_in_numbers():
    far, near = np.array([-50.0 + 0j]), np.array([-1.0 + 0j])
    assert stiffness(30.0, far) == 0.0  # a multiplier of exp(-50) or of exp(-80): nothing depends on it
    assert stiffness(30.0, near) == 30.0
    assert stiffness(5.0, np.append(far, near)) == 0.0  # the far one may have lost it
    assert stiffness(0.05, near) == 0.0
    assert mesh_is_to_blame(1.0, Doubt(1e-3))
    assert not mesh_is_to_blame(1.0, Doubt(0.5))
    assert not mesh_is_to_blame(1e-4, Doubt())
    assert not mesh_is_to_blame(1e9, Doubt(1.0))
    assert lost_in_rounding(Doubt(0.2))
    assert not lost_in_rounding(Doubt(1e-3))
    assert intervals_for(40, 4, 1.0, 0.0, 640) == 120  # no more than three times as many at once
    assert intervals_for(40, 4, 1.0, 0.0, 50) == 50
    assert intervals_for(40, 4, 0.0, 100.0, 640) == 60
    assert intervals_for(40, 4, 0.0, 1e6, 640) == 40
    assert words(0j, Doubt(), 0.0, near) == ""
    assert "rounding" in words(1.0 + 0j, Doubt(1.0, 0.5), 0.0, near)
    assert words(1.0 + 0j, Doubt(1.0, 1e-3), 0.0, near) == ""
