"""Lyapunov exponents: Lorenz's, those of cycles against Floquet's, sums against the trace of J, a torus, bad input."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.system import as_system
from rainwind.errors import ComputationError, InputError

LORENZ = rw.System(
    lambda x, p: (p.s * (x.y - x.x), x.x * (p.r - x.z) - x.y, x.x * x.y - p.b * x.z),
    ("x", "y", "z"), {"s": 10.0, "r": 28.0, "b": 8.0 / 3.0},
)  # fmt: skip
VAN_DER_POL = rw.System(lambda x, p: (x.v, p.mu * (1.0 - x.x**2) * x.v - x.x), ("x", "v"), {"mu": 1.0})


def test_lorenz():
    # 0.9056, 0, -14.5723: Sprott, Chaos and Time-Series Analysis (2003); the trace of J is -(s + 1 + b) everywhere
    found = rw.lyapunov(LORENZ, (1.0, 1.0, 1.0), duration=3000.0, transient=50.0)
    assert np.all(np.abs(found.exponents - (0.9056, 0.0, -14.5723)) < 5.0 * found.errors + 1e-4)
    assert np.all(found.errors < 0.006)
    assert found.sum == pytest.approx(-41.0 / 3.0, abs=1e-6)
    assert found.dimension == pytest.approx(2.062, abs=0.002)  # Kaplan & Yorke's, 2 + 0.9056 / 14.5723
    assert found.complete


def test_the_error_is_of_the_size_of_the_scatter():
    runs = [
        rw.lyapunov(LORENZ, (1.0, 1.0, 1.0 + k), duration=200.0, transient=50.0, many=1) for k in range(8)
    ]
    apart = np.std([run.exponents[0] for run in runs], ddof=1)
    said = np.mean([run.errors[0] for run in runs])
    assert 0.3 < said / apart < 4.0


def test_a_cycle_has_one_zero_and_floquets_others():
    orbit = rw.find_orbit(VAN_DER_POL, (1.0, 0.0))
    found = rw.lyapunov(VAN_DER_POL, orbit.at(0.0), duration=40.0 * orbit.period, transient=20.0)
    floquet = np.log(np.abs(orbit.multipliers)) / orbit.period
    assert np.allclose(found.exponents, floquet, atol=1e-3)
    assert abs(found.exponents[0]) < 1e-4


def test_the_cable_on_its_cycle():
    # 12 m/s, 0.2 %: a stable cycle; rates from 0 to -80 1/s, a complex pair
    model = rw.paper_model().with_parameters({"wind.speed": 12.0})
    orbit = rw.find_orbit(model, {"y": 0.1, "phi": 0.7})
    floquet = np.sort(np.log(np.abs(orbit.multipliers)) / orbit.period)[::-1]
    found = rw.lyapunov(model, orbit.at(0.0), duration=400.0 * orbit.period, transient=1000.0)
    assert np.allclose(found.exponents, floquet, atol=2e-3, rtol=1e-3)
    # volumes grow by the trace of J, here along the collocated cycle
    times = orbit.period * (np.arange(400) + 0.5) / 400.0
    trace = np.trace(
        as_system(model).jacobian(np.array([orbit.at(t) for t in times])), axis1=-2, axis2=-1
    ).mean()
    assert found.sum == pytest.approx(trace, rel=1e-6)


def test_some_exponents_only_and_a_torus():
    # two uncoupled clocks and a sink: exponents 0, 0, -1/2 known in closed form
    clocks = rw.System(
        lambda x, p: (
            x.a * (1.0 - x.a**2 - x.b**2) - x.b, x.b * (1.0 - x.a**2 - x.b**2) + x.a,
            x.c * (1.0 - x.c**2 - x.d**2) - 2.0**0.5 * x.d, x.d * (1.0 - x.c**2 - x.d**2) + 2.0**0.5 * x.c,
            -0.5 * x.e,
        ), ("a", "b", "c", "d", "e"),
    )  # fmt: skip
    found = rw.lyapunov(clocks, (1.0, 0.2, 0.4, 1.0, 1.0), duration=200.0, transient=40.0, many=3)
    assert np.allclose(found.exponents, (0.0, 0.0, -0.5), atol=1e-3)
    assert not found.complete
    every = rw.lyapunov(clocks, (1.0, 0.2, 0.4, 1.0, 1.0), duration=200.0, transient=40.0)
    assert np.allclose(every.exponents, (0.0, 0.0, -0.5, -2.0, -2.0), atol=1e-3)


def test_it_says_what_is_wrong():
    for options, said in (
        ({"duration": 0.0}, "positive time"),
        ({"duration": float("nan")}, "finite"),
        ({"duration": 1.0, "transient": -1.0}, "transient"),
        ({"duration": 1.0, "many": 4}, "1 to 3"),
        ({"duration": 1.0, "many": True}, "many"),
        ({"duration": 1.0, "parameters": {"q": 1.0}}, "q"),
        ({"duration": 1.0, "tolerance": 1.0}, "tolerance"),
    ):
        with pytest.raises(InputError, match=said):
            rw.lyapunov(LORENZ, (1.0, 1.0, 1.0), **options)  # pyright: ignore
    runaway = rw.System(lambda x, p: (x.x**2,), ("x",))
    with pytest.raises(ComputationError, match="ran away"):
        rw.lyapunov(runaway, (1.0,), duration=10.0)


def test_an_interrupt_keeps_what_is_done():
    def progress(done: int, total: int, what: str) -> None:
        if done > 300:
            raise KeyboardInterrupt

    found = rw.lyapunov(LORENZ, (1.0, 1.0, 1.0), duration=100.0, transient=10.0, progress=progress)
    assert found.interrupted
    assert 29.0 < found.duration < 40.0
