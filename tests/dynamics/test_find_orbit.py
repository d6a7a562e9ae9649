"""One orbit from a state, a state and a period, a simulation, a function, another orbit; and what is none."""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rainwind as rw
from rainwind.dynamics import cycle_zoo
from rainwind.dynamics.cycle_zoo.van_der_pol import TABLE
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.errors import ComputationError, InputError

MU = 0.5


def van_der_pol(mu):
    return cycle_zoo.van_der_pol.van_der_pol(born=False).system.with_parameters({"mu": mu})


def hopf(mu, sign=-1.0):
    """r' = mu r + sign r^3, theta' = 1: period 2 pi, radius sqrt(-sign mu)."""

    def rhs(x, p):
        growth = p.mu + sign * (x.x**2 + x.y**2)
        return growth * x.x - x.y, x.x + growth * x.y

    return rw.System(rhs, ("x", "y"), {"mu": mu})


def roessler(c):
    return rw.System(
        lambda x, p: (-x.y - x.z, x.x + 0.2 * x.y, 0.2 + x.z * (x.x - p.c)), ("x", "y", "z"), {"c": c}
    )


def simulated(system, start, times):
    run = solve_ivp(lambda _, x: system.f(x), (0.0, times[-1]), start, t_eval=times, rtol=1e-9, atol=1e-9)
    return run.t, run.y


@pytest.mark.parametrize("mu", [0.1, 1.0, 5.0, 10.0])
def test_van_der_pols_period(mu):
    orbit = find_orbit(van_der_pol(mu), {"x": 0.5}, mesh=rw.Mesh(60, 5))
    period, amplitude, exponent = TABLE[mu]
    assert orbit.period == pytest.approx(period, rel=1e-9)
    assert orbit.amplitude["x"] == pytest.approx(amplitude, abs=1e-6)
    assert orbit.stable
    if mu <= 1.0:
        assert orbit.exponents[0].real == pytest.approx(exponent, rel=1e-6)
    assert orbit.mesh_error < 1e-6


def test_van_der_pols_period_by_its_series():
    """Andersen & Geer (1982): the frequency as a series in mu^2, to terms of 1e-9 here."""
    orbit = find_orbit(van_der_pol(0.5), [0.01, 0.0], mesh=rw.Mesh(60, 6))
    terms = (1, -1 / 16, 17 / 3072, 35 / 884736, -678899 / 5096079360, 28160413 / 2293235712000)
    frequency = sum(term * 0.25**k for k, term in enumerate(terms))
    assert orbit.period == pytest.approx(2 * pi / frequency, abs=1e-8)


def test_hopf_normal_form_from_a_small_start():
    orbit = find_orbit(hopf(0.04), [1e-4, 0.0])
    assert orbit.period == pytest.approx(2 * pi, rel=1e-12)
    assert orbit.amplitude == pytest.approx({"x": 0.2, "y": 0.2}, abs=1e-9)
    assert orbit.exponents[0] == pytest.approx(-2 * 0.04 * 2 * pi, rel=1e-6)


def test_an_unstable_orbit_from_a_state_and_a_period():
    orbit = find_orbit(hopf(-0.25, 1.0), [0.45, 0.0], period=6.0)
    assert orbit.period == pytest.approx(2 * pi, rel=1e-9)
    assert orbit.amplitude["x"] == pytest.approx(0.5, abs=1e-8)
    assert orbit.unstable == 1


@pytest.mark.parametrize(("c", "loops"), [(2.5, 1), (3.5, 2), (4.0, 4)])
def test_the_least_period_of_a_cycle_with_several_loops(c, loops):
    """Roessler (1976), a = b = 0.2: one loop is about 5.8 long; it doubles at c = 2.83 and 3.86."""
    orbit = find_orbit(roessler(c), [1.0, 1.0, 1.0])
    assert orbit.period / 5.8 == pytest.approx(loops, rel=0.02)
    maxima = np.diff(np.sign(np.diff(orbit.at(np.linspace(0, orbit.period, 2000))[:, 0]))) < 0
    assert np.count_nonzero(maxima) in (loops, loops - 1)  # one may lie at the ends
    assert orbit.stable
    # twice the period comes out halved
    again = find_orbit(roessler(c), orbit.at(1.0), period=2 * orbit.period)
    assert again.period == pytest.approx(orbit.period, rel=1e-8)


def test_from_a_simulation():
    system, period = van_der_pol(1.0), TABLE[1.0][0]
    times, states = simulated(system, [2.0, 0.0], np.linspace(0.0, 60.0, 1500))
    for rows in (states, states.T):
        assert find_orbit(system, (times, rows)).period == pytest.approx(period, rel=1e-7)
    one = times <= period  # ends up to a step before the start comes again
    from_one = find_orbit(system, (times[one], states[:, one]), period=period)
    assert from_one.period == pytest.approx(period, rel=1e-7)
    assert find_orbit(system, (times, states), period=6.5).period == pytest.approx(period, rel=1e-7)


def test_from_a_function_and_from_an_orbit_of_other_parameters():
    system = hopf(1.0)
    circle = find_orbit(system, lambda t: [0.8 * np.cos(t), 0.9 * np.sin(t)], period=6.0)
    assert circle.amplitude["y"] == pytest.approx(1.0, abs=1e-9)
    larger = find_orbit(hopf(1.5), circle)
    assert larger.parameters == {"mu": 1.5}
    assert larger.amplitude["y"] == pytest.approx(sqrt(1.5), abs=1e-8)


def test_a_system_without_parameters():
    system = rw.System(lambda x, p: (x.y, (1 - x.x**2) * x.y - x.x), ("x", "y"))
    orbit = find_orbit(system, {"x": 1.0})
    assert orbit.period == pytest.approx(TABLE[1.0][0], rel=1e-8)
    assert dict(orbit.parameters) == {}


def test_the_papers_model_from_a_small_start():
    """Both half-amplitudes at 12 m/s: AUTO-07p (issue 3)."""
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 14.0})
    rest = next(e for e in rw.find_equilibria(model) if e.kind == "unstable focus")
    orbit = find_orbit(model, rest.state + 0.02 * np.eye(6)[0])
    assert orbit.stable
    assert orbit.period == pytest.approx(0.99810603624, abs=1e-9)  # of this collocation, a finer mesh
    assert orbit.mesh_error < 1e-6
    assert abs(orbit.trivial) < 1e-8
    branch = rw.continue_orbits(model, "wind.speed", start=orbit, until=(11.9, 14.5), ds=0.2)
    at_12 = find_orbit(
        model.with_parameters({"wind.speed": 12.0}),
        branch[int(np.argmin(np.abs(branch["wind.speed"] - 12.0)))],
    )
    assert (at_12.amplitude["y"], at_12.amplitude["z"]) == pytest.approx((0.233, 0.203), abs=5e-4)


def test_orbits_continue_from_what_was_found():
    orbit = find_orbit(hopf(0.04), [0.1, 0.0])
    branch = rw.continue_orbits(hopf(0.04), "mu", start=orbit, until=(0.01, 1.0))
    assert branch["x"] == pytest.approx(np.sqrt(branch["mu"]), rel=1e-7)


@pytest.mark.parametrize(
    ("system", "start", "message"),
    [
        (hopf(0.04), [0.0, 0.0], r"the start is an equilibrium itself \(unstable focus\)"),
        (hopf(-0.1), [1.0, 0.0], r"comes to rest by t = \S+, at the stable focus x = .* farther from it"),
        (hopf(-0.25, 1.0), [0.6, 0.0], r"between t = .* runs away.* basin of attraction"),
    ],
)
def test_what_settles_on_no_orbit(system, start, message):
    with pytest.raises(ComputationError, match=message):
        find_orbit(system, start)


def test_what_drifts(monkeypatch):
    monkeypatch.setattr("rainwind.dynamics.find_orbit.WITHOUT_TURN", 6)
    with pytest.raises(ComputationError, match=r"does not come back .* it drifts"):
        find_orbit(rw.System(lambda x, p: (1 + 0 * x.x, -x.y), ("x", "y")), [0.0, 1.0])


def test_tori_and_chaos_are_refused(monkeypatch):
    monkeypatch.setattr("rainwind.dynamics.find_orbit.TURNS", 300)
    torus = cycle_zoo.suspended.neimark_sacker()
    with pytest.raises(ComputationError, match=r"turns none ends nearer .* this is a torus, or a slow"):
        find_orbit(torus.system.with_parameters({"mu": 0.5}), torus.start.at(0.0) + 0.03)
    with pytest.raises(ComputationError, match=r"this is chaos.*; give transient="):
        find_orbit(roessler(5.0), [1.0, 1.0, 1.0])


def test_more_time_helps_what_settles_slowly(monkeypatch):
    monkeypatch.setattr("rainwind.dynamics.find_orbit.TURNS", 1)
    monkeypatch.setattr("rainwind.dynamics.find_orbit.NEAR", 1e-3)
    with pytest.raises(ComputationError, match="give transient= to wait longer"):
        find_orbit(hopf(0.01), [0.5, 0.0])
    assert find_orbit(hopf(0.01), [0.5, 0.0], transient=400.0).amplitude["x"] == pytest.approx(0.1, abs=1e-7)


def test_guesses_from_which_newton_finds_nothing():
    system = hopf(1.0)
    with pytest.raises(ComputationError, match=r"no orbit near this function with period 6\.28"):
        find_orbit(hopf(-0.1), lambda t: [np.cos(t), np.sin(t)], period=6.28)
    with pytest.raises(ComputationError, match="does not repeat itself"):
        find_orbit(system, (np.linspace(0, 1, 20), np.linspace(0, 1, 40).reshape(20, 2)))
    with pytest.raises(ComputationError, match=r"no orbit from this state with a period near 2\.3"):
        find_orbit(van_der_pol(5.0), [2.0, 0.0], period=2.3)


@pytest.mark.parametrize(
    ("start", "options", "message"),
    [
        ([1.0], {}, "a state is 2 finite numbers"),
        ({"u": 1.0}, {}, "u"),
        ([1.0, 0.0], {"period": -1.0}, "period = -1.0 must be above zero"),
        ([1.0, 0.0], {"transient": -1.0}, "must not be below zero"),
        ([1.0, 0.0], {"mesh": 40}, "mesh must be a Mesh"),
        (lambda t: [1.0, 0.0], {}, "needs its period beside it"),
        (lambda t: [1.0], {"period": 1.0}, "a state is 2 finite numbers"),
        ((np.arange(3.0), np.ones((3, 2))), {}, "at least 8 rising times"),
        ((np.arange(9.0)[::-1], np.ones((9, 2))), {}, "at least 8 rising times"),
        ((np.arange(9.0), np.ones((9, 3))), {}, r"shapes \(9,\) and \(9, 3\)"),
        ((np.arange(9.0), np.ones((9, 2))), {"period": 20.0}, "lasts 8, less than the period of 20"),
    ],
)
def test_bad_input(start, options, message):
    with pytest.raises(InputError, match=message):
        find_orbit(hopf(1.0), start, **options)


def test_an_orbit_of_another_system_is_refused():
    orbit = find_orbit(hopf(1.0), [1.0, 0.0], period=6.28)
    with pytest.raises(InputError, match="give an orbit of this system"):
        find_orbit(roessler(3.0), orbit)


def test_an_orbit_through_refused_states():
    system = hopf(1.0)
    strict = rw.System(
        system.rhs, system.states, system.parameters, refusal=lambda x, p: "x is high" if x[0] > 0.9 else None
    )
    with pytest.raises(ComputationError, match="the model refuses: x is high"):
        find_orbit(strict, [0.5, 0.0])


def oscillator(friction: float, cubic: float = 0.0):
    return rw.System(
        lambda x, p: (x.v, p.mu * (1 - x.u**2) * x.v - x.u - p.k * x.u**3),
        ("u", "v"),
        {"mu": friction, "k": cubic},
    )


@pytest.mark.parametrize("cubic", [0.0, 1.0])  # the harmonic oscillator, and Duffing's, whose periods differ
@pytest.mark.parametrize("period", [None, 5.5])
def test_a_family_of_orbits_is_called_one(cubic, period):
    with pytest.raises(ComputationError, match="a whole family of orbits, none of them isolated"):
        find_orbit(oscillator(0.0, cubic), {"u": 1.0, "v": 0.0}, period=period)


def test_an_orbit_that_attracts_slowly_is_no_family():
    # mu = 0.01: period 2 pi (1 + mu^2 / 16), multiplier exp(-2 pi mu), Lindstedt's series
    orbit = find_orbit(oscillator(0.01), {"u": 2.05, "v": 0.0})
    assert orbit.period == pytest.approx(2 * np.pi * (1 + 1e-4 / 16), abs=1e-8)
    assert orbit.exponents[0].real == pytest.approx(-0.02 * np.pi, abs=1e-5)


@pytest.mark.parametrize("period", [None, 3.0])
def test_a_rate_that_is_not_finite_at_the_start_is_named(period):
    broken = rw.System(lambda x, p: (rw.log(x.u), x.v - x.u), ("u", "v"))
    with pytest.raises(InputError, match="not finite at the start u = -1, v = 0: the rate of u is nan"):
        find_orbit(broken, {"u": -1.0, "v": 0.0}, period=period)


def test_a_trajectory_that_leaves_where_f_is_finite_does_not_run_away():
    leaving = rw.System(lambda x, p: (-1 + 0 * x.u, rw.sqrt(x.u)), ("u", "v"))
    with pytest.raises(ComputationError, match="f is not finite"):
        find_orbit(leaving, {"u": 1.0, "v": 0.0})


def test_a_trajectory_that_runs_away_is_said_to():
    explosive = rw.System(lambda x, p: (x.u + x.v, x.v - x.u), ("u", "v"))
    with pytest.raises(ComputationError, match="the trajectory runs away: a state passes 1e"):
        find_orbit(explosive, {"u": 1.0, "v": 0.0})


def test_a_stiff_trajectory_is_called_stiff(monkeypatch):
    monkeypatch.setattr("rainwind.dynamics.find_orbit.WITHOUT_TURN", 6)
    with pytest.raises(ComputationError, match=r"it is stiff: rates there go from 5\.\d+e-05 to 2\.9\de\+04"):
        find_orbit(oscillator(1e4), {"u": 2.0, "v": 0.0})  # at u = 2, v = -u / (3 mu): 5 / 3 / 3 mu and 3 mu
