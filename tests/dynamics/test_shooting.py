"""Multiple shooting against orbits known in closed form or to twenty digits, and against collocation."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rainwind as rw
from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.cycle_zoo import suspended
from rainwind.dynamics.cycle_zoo.van_der_pol import TABLE
from rainwind.dynamics.orbit_equations import OrbitEquations, OrbitNode
from rainwind.dynamics.orbit_results import Orbit
from rainwind.dynamics.shooting import shoot
from rainwind.dynamics.system import as_system
from rainwind.dynamics.variational import Flow
from rainwind.errors import InputError


def circle(x, p):
    """z' = (mu + i w) z - z |z|^2 for z = x + i y: radius sqrt(mu), exponent -2 mu."""
    r2 = x[0] ** 2 + x[1] ** 2
    return [p.mu * x[0] - p.w * x[1] - x[0] * r2, p.w * x[0] + p.mu * x[1] - x[1] * r2]


CIRCLE = rw.System(circle, ("x", "y"), {"mu": 0.3, "w": 1.7})
VAN_DER_POL = rw.System(lambda x, p: (x.y, p.mu * (1 - x.x**2) * x.y - x.x), ("x", "y"), {"mu": 1.0})
PERIOD = 2 * np.pi / 1.7


def exact_circle():
    """The circle as an orbit: its exact states at the nodes of a fine grid."""
    grid = Grid.even(Mesh(60, 5))
    turn = 2 * np.pi * (grid.nodes[:, None] + [0.0, -0.25])
    return Orbit(
        states=CIRCLE.states, parameters=dict(CIRCLE.parameters), period=PERIOD, grid=grid,
        profile=np.sqrt(0.3) * np.cos(turn), exponents=np.array([-0.6 * PERIOD + 0j]), trivial=0j,
        liouville=0.0, residual=0.0,
    )  # fmt: skip


def test_the_hopf_normal_form():
    shot = shoot(CIRCLE, {"x": 0.6, "y": 0.1}, period=3.5)
    assert shot.converged
    assert shot.note == ""
    assert shot.period == pytest.approx(PERIOD, rel=1e-11)
    assert np.hypot(*shot.starts.T) == pytest.approx(np.sqrt(0.3), rel=1e-11)
    assert shot.log_multipliers == pytest.approx([0.0, -0.6 * PERIOD], abs=1e-10)
    assert shot.multipliers == pytest.approx([1.0, np.exp(-0.6 * PERIOD)], abs=1e-10)
    assert max(shot.residual, shot.correction, shot.trivial_error, abs(shot.liouville)) < 1e-10


@pytest.mark.parametrize("mu", [0.1, 1.0, 5.0])
def test_van_der_pol_to_its_twenty_digits(mu):
    """At mu = 5 the multiplier is 8e-38: one matrix for the whole period would give 1e-16 at best."""
    period, amplitude, exponent = TABLE[mu]
    shot = shoot(VAN_DER_POL.with_parameters({"mu": mu}), [amplitude + 0.1, 0.0], period=1.05 * period)
    assert shot.converged
    assert shot.period == pytest.approx(period, rel=1e-12)
    assert shot.log_multipliers[1] == pytest.approx(exponent, abs=1e-9)
    assert abs(shot.liouville) < 1e-9


def transverse(rates, turning, basis):
    """The circle with z_i' = rates_i z_i and a pair that turns beside it, all seen in skew coordinates x = basis z."""
    inverse = np.linalg.inv(basis)

    def rhs(x, p):
        n = len(basis)
        z = [sum(inverse[i, j] * x[j] for j in range(n)) for i in range(n)]
        rate, turn = turning
        pair = [rate * z[2] - turn * z[3], turn * z[2] + rate * z[3]]
        f = [*circle(z, p), *pair, *(rate * z[4 + i] for i, rate in enumerate(rates))]
        return [sum(basis[i, j] * f[j] for j in range(n)) for i in range(n)]

    return rw.System(rhs, tuple(f"x{i}" for i in range(len(basis))), dict(CIRCLE.parameters))


def test_multipliers_over_42_decades_beside_each_other():
    """1e2, 1, a pair 1e-9 exp(+-0.9 i), -0.6 T of the circle, 1e-40, exactly, in coordinates that mix them all."""
    logs = np.log([1e2, 1e-40])
    basis = np.random.default_rng(5).standard_normal((6, 6)) + 3 * np.eye(6)
    system = transverse(logs / PERIOD, (np.log(1e-9) / PERIOD, 0.9 / PERIOD), basis)
    shot = shoot(system, basis @ [np.sqrt(0.3), 0, 1e-3, 0, 1e-4, 0], period=0.99 * PERIOD)
    assert shot.converged
    assert shot.period == pytest.approx(PERIOD, rel=1e-10)
    pair = np.log(1e-9) + np.array([0.9j, -0.9j])
    assert shot.log_multipliers == pytest.approx(
        np.array([logs[0], 0, -0.6 * PERIOD, *pair, logs[1]]), abs=1e-7
    )
    inverse = np.linalg.inv(basis)
    assert np.hypot(*(inverse[:2] @ shot.starts.T)) == pytest.approx(np.sqrt(0.3), rel=1e-9)
    assert inverse[2:] @ shot.starts.T == pytest.approx(0.0, abs=1e-9)


def test_the_exact_matrix_of_a_flow_by_both_methods():
    """The circle's flow in closed form: r^2 = mu / (1 + (mu / r0^2 - 1) exp(-2 mu t)), the angle turns by w t."""
    t, (x, y) = 1.3, (0.4, 0.2)

    def flow(x, y):
        r2 = 0.3 / (1 + (0.3 / (x**2 + y**2) - 1) * np.exp(-0.6 * t))
        return (x + 1j * y) * np.exp(1.7j * t) * np.sqrt(r2 / (x**2 + y**2))

    h = 1e-5
    dx, dy = (flow(x + h, y) - flow(x - h, y)) / (2 * h), (flow(x, y + h) - flow(x, y - h)) / (2 * h)
    units = np.array([0.5, 2.0])
    exact = np.array([[dx.real, dy.real], [dx.imag, dy.imag]]) * units / units[:, None]
    for stiff, tolerance in ((1e9, 1e-12), (0.0, 1e-9)):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("rainwind.dynamics.variational.STIFF", stiff)
            found = Flow(CIRCLE, units, tolerance).over(np.array([x, y]) / units, t)
        assert found is not None
        assert found.fast is (stiff > 0)
        end = flow(x, y)
        assert found.end * units == pytest.approx([end.real, end.imag], abs=30 * tolerance)
        assert found.matrix == pytest.approx(exact, abs=1e-9 + 30 * tolerance)
        # Liouville's formula
        assert np.exp(found.trace) == pytest.approx(np.linalg.det(exact), rel=1e-8)


def test_a_stiff_direction_is_integrated_and_its_multiplier_given_up():
    rate = 1e6

    def rhs(x, p):
        return [*circle(x, p), rate * (x[0] - x[2])]

    system = rw.System(rhs, ("x", "y", "fast"), dict(CIRCLE.parameters))
    shot = shoot(system, [0.5, 0.0, 0.5], period=3.6, segments=4, tolerance=1e-5)
    assert shot.converged
    assert shot.period == pytest.approx(PERIOD, rel=1e-5)
    assert shot.log_multipliers[:2] == pytest.approx([0.0, -0.6 * PERIOD], abs=1e-4)
    assert "upper bounds" in shot.note


@pytest.fixture(scope="module")
def collocated():
    """An unstable orbit of the paper's model at 12 m/s by collocation, from a trajectory near it."""
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 12.0})
    system = as_system(model)
    grid = Grid.even(Mesh(100, 4))
    start, period = [-0.18140948, 1.35743939, 0.32024461, -0.47093115, -0.97968738, 2.60597769], 1.0015649
    run = solve_ivp(
        lambda _, x: system.f(x), (0, period), start, t_eval=grid.nodes * period, rtol=1e-9, atol=1e-9
    )
    problem = OrbitEquations(system, ("wind.speed",), grid, np.ptp(run.y, axis=1), period, np.array([10.0]))
    u = np.concatenate([run.y.T.ravel(), [period, 12.0]])
    tangent = np.zeros(u.size)
    tangent[-1] = 1.0  # the wind speed stays
    node = problem.correct(OrbitNode(u, tangent, grid=grid), u, tangent)
    assert node is not None
    return model, problem.orbit(node)


def test_collocation_of_the_papers_model_agrees(collocated):
    model, orbit = collocated
    shot = shoot(model, orbit)
    assert shot.converged
    assert shot.note == ""
    assert np.sum(shot.log_multipliers.real > 1e-6) == 1
    assert shot.log_multipliers[-1].real < -80
    differences = shot.differences(orbit)
    assert differences["period"] < 1e-7
    assert differences["state"] < 1e-5
    assert differences["multipliers"] < 1e-5
    assert differences["small multipliers"] < 1e-3
    assert shot.trivial_error < 1e-9
    assert abs(shot.liouville) < 1e-8


def test_shooting_starts_from_the_orbits_parameters(collocated):
    model, orbit = collocated
    shot = shoot(model.with_parameters({"wind.speed": 9.0}), orbit, tolerance=1e-7)
    assert shot.parameters["wind.speed"] == 12.0
    assert shot.differences(orbit)["period"] < 1e-6


def test_differences_see_what_differs_and_no_shift_of_phase():
    orbit = exact_circle()
    shot = shoot(CIRCLE, orbit)
    shifted = replace(orbit, profile=orbit.profile @ [[0.6, -0.8], [0.8, 0.6]])
    for same in (orbit, shifted):
        assert max(shot.differences(same).values()) < 1e-7
    assert shot.differences(replace(orbit, period=PERIOD * 1.001))["period"] == pytest.approx(1e-3, rel=1e-4)
    larger = replace(orbit, profile=orbit.profile * 1.002)  # radius 0.2 %: 0.1 % of a range
    assert shot.differences(larger)["state"] == pytest.approx(1e-3, rel=2e-2)
    other = replace(orbit, exponents=orbit.exponents + 0.01)
    assert shot.differences(other)["multipliers"] == pytest.approx(0.01, rel=0.01)
    turned = replace(orbit, exponents=orbit.exponents + 1j * np.pi)
    assert shot.differences(turned)["multipliers"] == pytest.approx(2.0)


def test_a_state_that_should_vanish_gets_no_tiny_unit():
    """A cycle in a plane, started 1e-6 beside it: as units, such states would ask for a thousand segments."""
    known = suspended.zero_hopf()
    cycle = next(c for mu in np.linspace(*known.until, 9) for c in known.cycles({known.along: mu}))
    shot = shoot(known.system.with_parameters(cycle.parameters), cycle.at(0.0) + 1e-6, period=cycle.period)
    assert shot.converged
    assert len(shot.times) == 20
    assert shot.period == pytest.approx(cycle.period, rel=1e-10)
    expected = cycle.exponents[np.argsort(-cycle.exponents.real, kind="stable")]
    assert shot.log_multipliers.real == pytest.approx(expected.real, abs=1e-8)


def test_an_orbit_round_twice_says_so():
    shot = shoot(CIRCLE, [0.55, 0.0], period=2 * PERIOD)
    assert shot.period == pytest.approx(2 * PERIOD)
    assert "1/2 of the period" in shot.note


def test_failures_are_results_that_say_why():
    still = shoot(CIRCLE.with_parameters({"mu": -0.3}), [0.01, 0.0], period=PERIOD)
    assert not still.converged
    assert "equilibrium" in still.note
    gone = shoot(rw.System(lambda x, p: (x.x**2 + 1, -x.y), ("x", "y")), [1.0, 0.0], period=3.0)
    assert not gone.converged
    assert "runs away" in gone.note
    assert np.isnan(gone.multipliers).all()
    assert shoot(CIRCLE, [1e80, 0.0], period=PERIOD).differences(exact_circle())["multipliers"] == np.inf


@pytest.mark.parametrize(("mu", "exists"), [(-0.9, True), (-1.0001, False)])
def test_beside_a_fold_of_cycles(mu, exists):
    """r' = r (mu + 2 r^2 - r^4) has two cycles, r^2 = 1 +- sqrt(1 + mu), down to mu = -1, and none below."""

    def rhs(x, p):
        r2 = x.x**2 + x.y**2
        grows = p.mu + 2 * r2 - r2**2
        return grows * x.x - x.y, grows * x.y + x.x

    shot = shoot(rw.System(rhs, ("x", "y"), {"mu": mu}), [1.14, 0.0], period=6.3)
    assert shot.converged is exists
    if exists:
        r2 = 1 + np.sqrt(1 + mu)
        assert np.sum(shot.starts**2, axis=1) == pytest.approx(r2, rel=1e-10)
        assert shot.log_multipliers[1].real == pytest.approx(2 * np.pi * 4 * r2 * (1 - r2), rel=1e-9)
    else:
        assert shot.note


def test_the_model_that_refuses_a_state_is_heard():
    refusing = rw.System(
        circle, ("x", "y"), dict(CIRCLE.parameters), refusal=lambda x, p: "too wet" if x[0] > 0.5 else None
    )
    assert "too wet" in shoot(refusing, [0.55, 0.0], period=PERIOD).note


def test_wrong_input_is_refused():
    orbit = exact_circle()
    with pytest.raises(InputError, match="guess of the period"):
        shoot(CIRCLE, [0.5, 0.0])
    with pytest.raises(InputError, match="above zero"):
        shoot(CIRCLE, [0.5, 0.0], period=-1.0)
    with pytest.raises(InputError, match="leave out period"):
        shoot(CIRCLE, orbit, period=3.0)
    with pytest.raises(InputError, match="states are x, y"):
        shoot(rw.System(lambda x, p: (x.a, x.b), ("a", "b")), orbit)
    with pytest.raises(InputError, match="segments"):
        shoot(CIRCLE, orbit, segments=0)
    with pytest.raises(InputError, match="tolerance"):
        shoot(CIRCLE, orbit, tolerance=1.0)
    with pytest.raises(InputError, match="2 finite numbers"):
        shoot(CIRCLE, [0.5], period=3.0)
    with pytest.raises(InputError, match="takes an orbit"):
        shoot(CIRCLE, orbit).differences("orbit")  # pyright: ignore[reportArgumentType]
