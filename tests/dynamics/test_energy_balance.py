"""Energy along runs: what goes in and out is the change, to the error of the run."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.errors import InputError


def damped():
    """x'' + 2 c x' + k x = 0."""
    return rw.System(lambda x, p: (x.v, -2 * p.c * x.v - p.k * x.q), ("q", "v"), {"c": 0.1, "k": 4.0})


def energy(x, p):
    return (x.v * x.v + p.k * x.q * x.q) / 2


def friction(x, p):
    return -2 * p.c * x.v * x.v


def test_an_integral_along_a_run_has_its_closed_form():
    system = rw.System(lambda x, p: (x.v, -x.q), ("q", "v"))
    run = rw.simulate(system, [0.0, 1.0], duration=30.0, tolerance=1e-12)
    squares = run.integral(lambda x, p: x.q * x.q)
    t = run.times
    assert squares == pytest.approx(t / 2 - np.sin(2 * t) / 4, abs=1e-10)
    assert run.value(lambda x, p: x.q * x.v, t) == pytest.approx(np.sin(2 * t) / 2, abs=1e-10)


@pytest.mark.parametrize("method", ["taylor", "rosenbrock"])
def test_a_damped_oscillator(method):
    run = rw.simulate(damped(), [1.0, 0.0], duration=20.0, tolerance=1e-11, method=method)
    balance = rw.energy_balance(run, energy=energy, powers={"friction": friction})
    assert balance.worst < 1e-9
    assert balance.energy[0] == 2.0
    assert balance.work["friction"][-1] == pytest.approx(balance.energy[-1] - 2.0, rel=1e-9)
    assert balance.energy[-1] < 0.05


def test_a_power_that_is_left_out_shows():
    run = rw.simulate(damped(), [1.0, 0.0], duration=20.0)
    balance = rw.energy_balance(run, energy=energy, powers={"friction": lambda x, p: 0.9 * friction(x, p)})
    assert balance.worst == pytest.approx(0.1, rel=0.05)


def test_a_spring_that_stiffens_does_work():
    """k rises over 5 s, then jumps: work p' q^2 / 2 and a jump of the energy."""
    k = rw.ramp(4.0, 6.0, 5.0, hold=3.0).then(rw.ramp(2.0, 2.0, 0.0))
    run = rw.simulate(damped(), [1.0, 0.0], duration=12.0, parameters={"k": k, "c": 0.0}, tolerance=1e-12)
    balance = rw.energy_balance(run, energy=energy, powers={"friction": friction})
    assert balance.worst < 1e-10
    q = run.at(8.0)[0]
    at_jump = int(np.flatnonzero(run.times == 8.0)[0])
    work = balance.work["driven parameters"]
    jump = work[at_jump] - work[at_jump - 1]
    assert jump == pytest.approx((2.0 - 6.0) * q * q / 2, rel=1e-6)


@pytest.mark.parametrize("outside", ["blend", "extend"])
@pytest.mark.parametrize("degrees_of_freedom", [2, 3])
def test_the_cable_in_a_rising_wind(outside, degrees_of_freedom):
    model = rw.paper_model(outside=outside, degrees_of_freedom=degrees_of_freedom)
    run = rw.simulate(
        model, {"phi": 1.0, "y": 0.05}, duration=60.0, wind=rw.ramp(9.0, 14.0, 40.0), tolerance=1e-11
    )
    balance = rw.energy_balance(run, model)
    assert balance.worst < 1e-9
    assert set(balance.work) == {"wind", "cable damping", "rivulet friction"}
    assert balance.work["cable damping"][-1] < 0.0
    assert balance.work["wind"][-1] > 0.0


def test_a_turning_wind_does_work_on_the_weight_of_the_rivulet():
    """beta follows the yaw: the energy depends on a driven parameter."""
    model = rw.paper_model(outside="blend")
    yaw = rw.ramp(0.0, 0.5, 20.0)
    run = rw.simulate(model, {"phi": 1.0}, duration=40.0, parameters={"wind.yaw": yaw}, tolerance=1e-11)
    balance = rw.energy_balance(run, model)
    assert balance.worst < 1e-9
    assert abs(balance.work["driven parameters"][-1]) > 1e-3


def test_models_without_energy_are_refused():
    run = rw.simulate(damped(), [1.0, 0.0], duration=1.0)
    with pytest.raises(InputError, match=r"System has no energy"):
        rw.energy_balance(run, damped())
