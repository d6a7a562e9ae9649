"""Reductions against closed forms, and against trajectories kept whole."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.extremes import extremes_between

W = 3.0


def _oscillator() -> rw.System:
    def rhs(x, p):
        return x.v, -p.w * p.w * x.x - 2.0 * p.d * x.v

    return rw.System(rhs, states=("x", "v"), parameters={"w": W, "d": 0.0})


def _at(a: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """Starts of x = a sin(w t + phase)."""
    return np.stack([a * np.sin(phase), a * W * np.cos(phase)], axis=1)


A, PHASE = np.array([0.5, 1.0, 2.0, 7.0, 1e-5]), np.array([0.0, 0.7, 2.0, -1.0, 3.0])


def _ensemble(*reduce, duration: float = 10.0, **more):
    return rw.ensemble(
        _oscillator(), _at(A, PHASE), duration=duration, tolerance=1e-12, reduce=reduce, workers=1, **more
    )


def test_extremes_of_an_oscillation():
    run = _ensemble(rw.Extremes(since=2.3))
    np.testing.assert_allclose(run["highest", "x"], A, rtol=1e-10)
    np.testing.assert_allclose(run["lowest", "v"], -A * W, rtol=1e-10)
    np.testing.assert_allclose(run["amplitude"], np.stack([A, A * W], axis=1), rtol=1e-10)


def test_extremes_of_a_short_window_are_at_its_edges():
    run = _ensemble(rw.Extremes("x", since=1.0, until=1.02))
    edges = A[:, None] * np.sin(W * np.array([1.0, 1.02]) + PHASE[:, None])
    inside = np.pi / 2 - (W * 1.0 + PHASE) % np.pi
    assert np.all((inside < 0) | (inside > 0.06))  # none turns in the window
    np.testing.assert_allclose(run["highest", "x"], edges.max(axis=1), rtol=1e-9)
    np.testing.assert_allclose(run["lowest", "x"], edges.min(axis=1), rtol=1e-9)


def test_mean_and_root_mean_square():
    run = _ensemble(rw.Mean(since=1.0, until=4.5))
    a, b = 1.0 * W + PHASE, 4.5 * W + PHASE
    mean = A * (np.cos(a) - np.cos(b)) / (W * 3.5)
    square = A**2 * (0.5 - (np.sin(2 * b) - np.sin(2 * a)) / (4 * W * 3.5))
    np.testing.assert_allclose(run["mean", "x"], mean, rtol=1e-9)
    np.testing.assert_allclose(run["rms", "x"], np.sqrt(square), rtol=1e-9)
    np.testing.assert_allclose(run["deviation", "x"], np.sqrt(square - mean**2), rtol=1e-9)


def test_returns_through_a_plane_and_by_turning_points():
    run = _ensemble(rw.Returns("x", value=0.0, direction=1, name="plane"), rw.Returns("x", since=2.0))
    period = 2 * np.pi / W
    np.testing.assert_allclose(run["plane return_time"], period, rtol=1e-10)
    np.testing.assert_allclose(run["plane period"], period, rtol=1e-10)
    first = (-PHASE / W) % period
    first[0] = period  # it starts on the plane, which does not count
    np.testing.assert_allclose(run["plane first_return"], first, rtol=1e-9)
    np.testing.assert_allclose(run["first_return"], 2.0 + ((np.pi / 2 - PHASE) / W - 2.0) % period, rtol=1e-9)
    np.testing.assert_array_equal(run["returns"], np.floor((10.0 - run["first_return"]) / period) + 1)
    np.testing.assert_allclose(run["return_spread"], 0.0, atol=1e-6)


def test_the_period_of_a_cycle_with_two_turns_is_that_of_both():
    # x = sin(t) + sin(2 t): two maxima of different height in each period of 2 pi
    def rhs(x, p):
        return x.b, -x.a, x.d, -4.0 * x.c

    system = rw.System(rhs, states=("a", "b", "c", "d"))
    run = rw.ensemble(
        system, np.array([[0.0, 1.0, 0.0, 2.0]]), duration=60.0, tolerance=1e-12,
        reduce=rw.Returns({"a": 1.0, "c": 1.0}), workers=1,
    )  # fmt: skip
    np.testing.assert_allclose(run["period"], 2 * np.pi, rtol=1e-9)
    np.testing.assert_allclose(run["return_time"], np.pi, rtol=0.02)


def test_time_to_a_level():
    run = _ensemble(rw.TimeTo("x", 0.9), rw.TimeTo("x", 0.9, both_sides=True, name="both"))
    t = np.linspace(0.0, 10.0, 2_000_001)
    for i, (a, phase) in enumerate(zip(A, PHASE, strict=True)):
        x = a * np.sin(W * t + phase)
        for name, reached in (("time_to", x >= 0.9), ("both time_to", np.abs(x) >= 0.9)):
            expected = t[np.argmax(reached)] if reached.any() else np.nan
            np.testing.assert_allclose(run[name][i], expected, atol=6e-6)


def test_settled_tells_rest_from_oscillation_from_neither():
    d = np.array([0.0, 0.01, 2.0])
    run = rw.ensemble(_oscillator(), [1.0, 0.0], varying={"d": d}, duration=50.0, reduce="settled", workers=1)
    assert [rw.SETTLED[int(k)] for k in run["settled"]] == ["oscillation", "not settled", "equilibrium"]
    # windows of 10: amplitudes fall by e^(-0.1) from one to the next
    assert run["change"][1] == pytest.approx(np.exp(0.1) - 1.0, rel=0.1)


def test_whole_turns_are_seen():
    def rhs(x, p):
        return x.w, p.torque - 0.5 * x.w - rw.sin(x.a)

    system = rw.System(rhs, states=("a", "w"), parameters={"torque": 0.0})
    run = rw.ensemble(
        system, [0.1, 0.0], varying={"torque": [0.2, 3.0]}, duration=100.0, workers=1, reduce="settled"
    )
    assert [rw.SETTLED[int(k)] for k in run["settled"]] == ["equilibrium", "whole turns"]
    assert run["turns", "a"][1] == pytest.approx(
        20.0 * 6.0 / (2 * np.pi), abs=1.0
    )  # w = torque / 0.5 on average


def test_lyapunov_exponents_of_linear_systems_and_of_lorenz():
    run = rw.ensemble(
        _oscillator(), [1.0, 0.0], varying={"d": [0.0, 0.1, 1.0, -0.2]}, duration=100.0, workers=1,
        reduce=rw.Lyapunov(since=20.0),
    )  # fmt: skip
    np.testing.assert_allclose(run["lyapunov"], [0.0, -0.1, -1.0, 0.2], atol=0.02)

    def lorenz(x, p):
        return 10.0 * (x.y - x.x), x.x * (p.r - x.z) - x.y, x.x * x.y - 8.0 / 3.0 * x.z

    system = rw.System(lorenz, states=("x", "y", "z"), parameters={"r": 28.0})
    run = rw.ensemble(
        system, [1.0, 1.0, 20.0], varying={"y": np.linspace(1.0, 2.0, 16)}, duration=320.0, workers=1,
        reduce=rw.Lyapunov(since=20.0),
    )  # fmt: skip
    # 0.9056: Sprott, Chaos and Time-Series Analysis (2003), p. 116
    assert run["lyapunov"].mean() == pytest.approx(0.9056, abs=0.01)


def test_a_disturbance_may_grow_beyond_all_numbers():
    system = rw.System(lambda x, p: (p.a * x.x,), states=("x",), parameters={"a": 1.0})
    run = rw.ensemble(
        system, [0.0], varying={"a": [5.0, -9.0, 40.0]}, duration=100.0, workers=1, reduce="lyapunov"
    )
    np.testing.assert_allclose(run["lyapunov"], [5.0, -9.0, 40.0], rtol=1e-9)
    assert run.finished.all()


def test_reductions_of_the_cable_are_those_of_its_trajectories():
    model = rw.paper_model(coefficients="reconstructed")
    speeds = np.array([8.0, 9.5, 12.0])
    run = rw.ensemble(
        model, {"phi": 0.6, "y": 0.02}, varying={"wind.speed": speeds}, duration=40.0, workers=1,
        reduce=(
            rw.Extremes(since=25.0), rw.Mean(since=25.0), rw.Mean("energy", name="of"),
            rw.Returns("y", value=0.003, direction=1, since=25.0),
        ),
    )  # fmt: skip
    for i, speed in enumerate(speeds):
        one = rw.simulate(model, {"phi": 0.6, "y": 0.02}, duration=40.0, wind=float(speed))
        np.testing.assert_array_equal(run.final[i], one.end)
        low, high = extremes_between(one, np.array([25.0, 40.0]))
        np.testing.assert_allclose(run["lowest"][i], low[0], rtol=1e-13)
        np.testing.assert_allclose(run["highest"][i], high[0], rtol=1e-13)
        part = one.pieces.part(25.0, 40.0)
        np.testing.assert_allclose(run["mean"][i], part.integral() / 15.0, rtol=1e-9, atol=1e-12)
        energy = one.integral(model.energy)[-1] / 40.0
        assert run["of mean", "energy"][i] == pytest.approx(energy, rel=1e-9)
        up = one.section(rw.Event("up", lambda x, p: x.y - 0.003, direction=1))
        up = up.times[up.times > 25.0]
        assert run["returns"][i] == up.size
        assert run["last_return"][i] == pytest.approx(up[-1], abs=1e-9)


@pytest.mark.parametrize(
    ("reduce", "what"),
    [
        (rw.Extremes(since=5.0, until=30.0), "does not lie within the run, 0 to 10"),
        (rw.Extremes(since=5.0, until=5.0), "since < until"),
        (rw.Extremes("nothing"), "there is no state or observable 'nothing'"),
        (rw.Mean(since=np.nan), "finite"),
        (rw.Settled(window=6.0), "at most 5"),
        (rw.Settled(within=2.0), "between 0 and 1"),
        (rw.Returns("x", direction=2), "choose 1"),
        (rw.Returns({"x": 0.0}), "no plane"),
        (rw.TimeTo("x", -1.0, both_sides=True), "above zero"),
        (rw.Lyapunov(since=-1.0), "does not lie within"),
        ("extreme", "Did you mean 'extremes'"),
        ((rw.Extremes(), rw.Extremes(since=2.0)), "name='late'"),
        (3.0, "reduce takes"),
    ],
)
def test_bad_reductions_are_refused(reduce, what: str):
    with pytest.raises(rw.RainwindError, match=what):
        rw.ensemble(_oscillator(), _at(A, PHASE), duration=10.0, reduce=reduce)
