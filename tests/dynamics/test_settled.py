"""What runs settle to, where the answer is known in closed form or by collocation."""

import numpy as np
import pytest

import rainwind as rw


def oscillator(damping=0.0):
    return rw.System(lambda x, p: (x.v, -x.q - p.c * x.v), ("q", "v"), {"c": damping})


def test_a_cycle_with_its_period_and_sizes():
    """The Hopf normal form: radius 1, period 2 pi / 1.5; it is approached like exp(-2 t)."""

    def rhs(x, p):
        pull = 1.0 - x.u * x.u - x.v * x.v
        return pull * x.u - 1.5 * x.v + 0.0, pull * x.v + 1.5 * x.u

    run = rw.simulate(rw.System(rhs, ("u", "v")), [0.01, 0.0], duration=60.0, tolerance=1e-11)
    found = run.settled()
    assert found.kind == "cycle"
    assert found.period == pytest.approx(2 * np.pi / 1.5, rel=1e-8)
    assert found.amplitude == pytest.approx({"u": 1.0, "v": 1.0}, rel=1e-9)
    assert found.highest == pytest.approx({"u": 1.0, "v": 1.0}, rel=1e-9)
    assert found.mean == pytest.approx({"u": 0.0, "v": 0.0}, abs=1e-8)
    assert found.left < 1e-6
    # r = 1 / sqrt(1 + (1 / r0^2 - 1) exp(-2 t)) is within 1 % from t = 6.6 on, and one period may be mixed
    assert 5.5 < found.since < 6.6 + found.period
    assert "cycle of period 4.18879" in str(found)


def test_an_equilibrium_and_since_when():
    found = rw.simulate(oscillator(0.2), [1.0, 0.0], duration=200.0).settled()
    assert found.kind == "equilibrium"
    assert found.period is None
    assert found.since == pytest.approx(np.log(1 / 0.017) / 0.1, abs=5.0)  # within 1 % of the range
    assert rw.simulate(oscillator(), [0.0, 0.0], duration=5.0).settled().kind == "equilibrium"


def test_slow_settling_is_said():
    found = rw.simulate(oscillator(0.01), [1.0, 0.0], duration=100.0).settled()
    assert found.kind == "not settled"
    assert "falls by 0.031" in found.note  # 1 - exp(-0.005 * 2 pi)
    found = rw.simulate(oscillator(-0.01), [1.0, 0.0], duration=100.0).settled()
    assert found.kind == "not settled"
    assert "grows by 0.03" in found.note


def test_a_cycle_that_decays_to_nothing_is_an_equilibrium():
    found = rw.simulate(oscillator(0.02), [1.0, 0.0], duration=1000.0).settled()
    assert found.kind == "equilibrium"
    assert found.left < 1e-3


def test_a_small_oscillation_that_still_decays_is_no_cycle():
    """The lower rivulet at 9 m/s: each period changes it by less than the run's errors may, but always the same way."""
    run = rw.simulate(rw.paper_model(outside="blend"), {"phi": 1.0}, duration=1000.0)
    found = run.settled()
    assert found.kind == "equilibrium"
    lower = [e for e in rw.find_equilibria(rw.paper_model()) if abs(e["phi"] - found.mean["phi"]) < 1e-3]
    assert len(lower) == 1
    assert lower[0].stable


def test_whole_turns_of_a_driven_pendulum():
    """w' = f - c w - sin q: the mean of f - c w - sin q over a turn is zero."""
    system = rw.System(lambda x, p: (x.w, p.f - p.c * x.w - rw.sin(x.q)), ("q", "w"), {"c": 0.2, "f": 1.5})
    run = rw.simulate(system, [0.0, 0.0], duration=300.0)
    found = run.settled()
    assert run.turning == ("q",)
    assert found.kind == "whole turns"
    assert found.turns == {"q": 1}
    assert found.mean["w"] == pytest.approx(2 * np.pi / found.period, rel=1e-9)
    orbit = run.at(300.0 - found.period)
    assert run.end - orbit == pytest.approx([2 * np.pi, 0.0], abs=1e-6)


def rossler(c):
    return rw.System(
        lambda x, p: (-x.y - x.z, x.x + 0.2 * x.y, 0.2 + x.z * (x.x - p.c)), ("x", "y", "z"), {"c": c}
    )


@pytest.mark.parametrize(("c", "loops"), [(2.5, 1), (3.5, 2), (4.0, 4)])
def test_doubled_periods_are_told_apart(c, loops):
    """Rossler's system: periods 1, 2 and 4; the lengths by collocation."""
    run = rw.simulate(rossler(c), [1.0, 1.0, 1.0], duration=1500.0)
    found = run.settled()
    assert found.kind == "cycle"
    orbit = rw.find_orbit(rossler(c), run.end, period=found.period)
    assert orbit.period == pytest.approx(found.period, rel=1e-6)
    assert found.amplitude == pytest.approx(orbit.amplitude, rel=1e-6)
    maxima = run.section(lambda x, p: -x.y - x.z, direction=-1)
    assert np.sum(maxima.times > run.duration - found.period) == loops


@pytest.mark.parametrize("c", [5.7, 9.0])
def test_chaos_is_no_cycle(c):
    assert rw.simulate(rossler(c), [1.0, 1.0, 1.0], duration=1500.0).settled().kind == "not settled"


def test_a_torus_is_no_cycle():
    system = rw.System(lambda x, p: (x.b, -x.a, x.d * 2**0.5, -x.c * 2**0.5), ("a", "b", "c", "d"))
    assert rw.simulate(system, [1.0, 0.0, 0.7, 0.0], duration=300.0).settled().kind == "not settled"


def test_a_run_that_broke_off_has_not_settled():
    run = rw.simulate(rw.System(lambda x, p: (x.x * x.x,), ("x",)), [1.0], duration=5.0)
    assert run.settled().kind == "not settled"
    assert "ran away" in run.settled().note


def test_the_limit_cycle_of_the_cable_as_collocation_has_it():
    """The sample case at 12 m/s, coefficients extended: half amplitudes (y, z) near (0.233, 0.203) m."""
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 12.0})
    run = rw.simulate(model, {"phi": 1.0}, duration=2500.0)
    found = run.settled()
    orbit = rw.find_orbit(model, run.end)
    assert found.kind == "cycle"
    assert orbit.stable
    assert found.period == pytest.approx(orbit.period, rel=1e-8)
    assert found.amplitude == pytest.approx(orbit.amplitude, rel=1e-6)
    assert found.mean["phi"] == pytest.approx(orbit.mean["phi"], rel=1e-6)
    assert (found.amplitude["y"], found.amplitude["z"]) == pytest.approx((0.233, 0.203), abs=5e-4)
    assert run.turning == ()  # polynomials know no full turn
