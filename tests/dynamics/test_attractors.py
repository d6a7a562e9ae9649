"""What trajectories end on: systems whose attractors are known from books."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.attractors import Attractor, Kind
from rainwind.errors import InputError

LORENZ = rw.System(
    lambda x, p: (p.s * (x.y - x.x), x.x * (p.r - x.z) - x.y, x.x * x.y - p.b * x.z),
    ("x", "y", "z"), {"s": 10.0, "r": 28.0, "b": 8.0 / 3.0},
)  # fmt: skip
ROESSLER = rw.System(
    lambda x, p: (-x.y - x.z, x.x + p.a * x.y, p.b + x.z * (x.x - p.c)),
    ("x", "y", "z"), {"a": 0.2, "b": 0.2, "c": 5.7},
)  # fmt: skip
VAN_DER_POL = rw.System(lambda x, p: (x.v, p.mu * (1.0 - x.x**2) * x.v - x.x), ("x", "v"), {"mu": 1.0})
PENDULUM = rw.System(
    lambda x, p: (x.v, p.torque - p.d * x.v - rw.sin(x.q)), ("q", "v"), {"d": 0.1, "torque": 0.0}
)


def test_a_damped_pendulum_comes_to_rest_or_turns_for_ever():
    rest = rw.attractor(PENDULUM, (2.0, 0.0), longest=1000.0)
    assert rest.kind is Kind.EQUILIBRIUM
    assert rest.rate == pytest.approx(-0.05, abs=1e-9)  # -d / 2
    turning = rw.attractor(PENDULUM.with_parameters({"torque": 0.5}), (2.0, 2.0), longest=1000.0)
    assert turning.kind is Kind.TURNS
    assert turning.turns == {"q": 1}
    # the mean of v is torque / d less what sin q takes, which is small at such a speed
    assert turning.mean["v"] == pytest.approx(5.0, abs=0.02)


def test_a_start_at_an_unstable_equilibrium_is_no_attractor():
    saddle = rw.System(lambda x, p: (x.x, -x.y), ("x", "y"))
    found = rw.attractor(saddle, (0.0, 0.0), longest=100.0)
    assert found.kind is Kind.UNDECIDED


def test_van_der_pol():
    found = rw.attractor(VAN_DER_POL, (0.1, 0.0), longest=1000.0)
    assert found.kind is Kind.CYCLE
    assert found.period == pytest.approx(
        6.6632868593, abs=1e-5
    )  # Andersen & Geer, SIAM J. Appl. Math. 42 (1982)
    assert found.amplitude["x"] == pytest.approx(2.00862, abs=1e-4)
    weak = rw.attractor(VAN_DER_POL.with_parameters({"mu": 0.01}), (1.0, 0.0), longest=4000.0)
    assert weak.kind is Kind.CYCLE
    assert weak.amplitude["x"] == pytest.approx(2.0, abs=1e-3)


def test_roesslers_doublings_and_chaos():
    # periods double near 2.83, 3.86, 4.12: one, two, four loops, then chaos
    periods = {}
    for c in (2.5, 3.5, 4.0):
        found = rw.attractor(ROESSLER.with_parameters({"c": c}), (1.0, 1.0, 1.0), longest=4000.0)
        assert found.kind is Kind.CYCLE
        periods[c] = found.period
    assert periods[3.5] / periods[2.5] == pytest.approx(2.0, abs=0.05)
    assert periods[4.0] / periods[2.5] == pytest.approx(4.0, abs=0.1)
    chaos = rw.attractor(ROESSLER, (1.0, 1.0, 1.0), longest=4000.0)
    assert chaos.kind is Kind.CHAOS
    assert chaos.rate == pytest.approx(0.0714, abs=4.0 * chaos.error + 0.002)  # Sprott (2003)


def test_lorenz_in_three_regimes():
    # r = 10: two stable foci; 28: chaos; 160: a stable cycle (Sparrow, The Lorenz Equations, 1982)
    many = rw.attractors(LORENZ, (1.0, 1.0, 1.0), varying={"r": [10.0, 28.0, 160.0]}, longest=300.0)
    assert [one.kind for one in many] == [Kind.EQUILIBRIUM, Kind.CHAOS, Kind.CYCLE]
    assert many.count(Kind.CHAOS) == 1
    assert many[1].rate == pytest.approx(0.9056, abs=4.0 * many[1].error)
    assert many[0].mean["z"] == pytest.approx(9.0, abs=1e-9)  # r - 1


def test_tori():
    linear = rw.System(
        lambda x, p: (x.v, -0.1 * x.v - x.x + rw.cos(x.a) + rw.cos(x.b), 1.3, 1.3 * 2.0**0.5),
        ("x", "v", "a", "b"),
    )
    found = rw.attractor(linear, (1.0, 0.0, 0.0, 0.0), longest=2000.0)
    assert found.kind is Kind.TORUS
    # |1 / (1 - w^2 + 0.1 i w)| of both frequencies together is never passed, and nearly reached
    most = sum(1.0 / abs(1.0 - w * w + 0.1j * w) for w in (1.3, 1.3 * 2.0**0.5))
    assert 0.95 * most < found.amplitude["x"] <= most
    forced = rw.System(
        lambda x, p: (x.v, 0.5 * (1.0 - x.x**2) * x.v - x.x + p.force * rw.cos(x.t), p.w),
        ("x", "v", "t"), {"force": 0.5, "w": 1.3 * 2.0**0.5},
    )  # fmt: skip
    assert rw.attractor(forced, (1.0, 0.0, 0.0), longest=2000.0).kind is Kind.TORUS
    # near its own frequency the force locks it: a cycle
    locked = rw.attractor(forced.with_parameters({"w": 1.0}), (1.0, 0.0, 0.0), longest=2000.0)
    assert locked.kind in (Kind.CYCLE, Kind.TURNS)


def test_what_runs_away_and_what_settles_too_slowly():
    assert (
        rw.attractor(rw.System(lambda x, p: (x.x**2,), ("x",)), (1.0,), longest=100.0).kind is Kind.RAN_AWAY
    )
    slow = VAN_DER_POL.with_parameters({"mu": 1e-4})  # grows as exp(mu t / 2)
    found = rw.attractor(slow, (0.1, 0.0), longest=1000.0)
    assert found.kind is Kind.UNDECIDED
    assert found.note


def test_what_a_model_loses():
    ball = rw.System(
        lambda x, p: (x.v, -0.5 * x.v - x.x * (x.x**2 - 1.0)), ("x", "v"), losses={"gone": lambda x, p: x.x}
    )
    found = rw.attractors(ball, [[0.5, 0.0], [-0.5, 0.0]], longest=400.0)
    assert [one.kind for one in found] == [Kind.EQUILIBRIUM, Kind.LOST]
    assert found[1].note == "gone"


def test_the_rivulet_between_b_and_c_goes_to_d():
    # section 4.2; at 16.5 m/s D is stable, so it stays there
    model = rw.paper_model().with_parameters({"wind.speed": 16.5})
    b, d, c = (one["phi"] for one in list(rw.find_equilibria(model))[:3])
    assert b < d < c
    starts = np.zeros((4, 6))
    starts[:, 1] = b - 0.1, b + 0.1, c - 0.1, c + 0.1
    found = rw.attractors(model, starts, longest=2000.0, window=60.0)
    assert [one.kind for one in found] == [Kind.LOST, Kind.EQUILIBRIUM, Kind.EQUILIBRIUM, Kind.LOST]
    assert found[1].mean["phi"] == pytest.approx(d, abs=1e-9)
    assert found[0].note == "rivulet lost"


def test_results_do_not_depend_on_workers_or_neighbours():
    starts = np.random.default_rng(1).uniform(-3.0, 3.0, (70, 2))
    one = rw.attractors(PENDULUM, starts, longest=400.0, workers=1)
    two = rw.attractors(PENDULUM, starts[::-1], longest=400.0, workers=3)
    for a, b in zip(one, reversed(list(two)), strict=True):
        assert a.kind is b.kind
        assert np.array_equal(a.end, b.end)
        assert a.after == b.after


def test_an_interrupt_keeps_what_is_done():
    def progress(done: int, total: int, what: str) -> None:
        if done >= 64:
            raise KeyboardInterrupt

    starts = np.random.default_rng(1).uniform(-3.0, 3.0, (6400, 2))
    found = rw.attractors(PENDULUM, starts, longest=400.0, workers=1, progress=progress)
    assert found.interrupted
    done = [one for one in found if one is not None]
    assert 64 <= len(done) < 6400
    assert all(isinstance(one, Attractor) for one in done)


def test_it_says_what_is_wrong():
    for starts, options, said in (
        ([[0.0]], {"longest": 10.0}, "shape"),
        ([[np.nan, 0.0]], {"longest": 10.0}, "finite"),
        ([[0.0, 0.0]], {"longest": -1.0}, "longest"),
        ([[0.0, 0.0]], {"longest": 10.0, "window": 5.0}, "quarter"),
        ([[0.0, 0.0]], {"longest": 10.0, "workers": 0}, "workers"),
        ([[0.0, 0.0]], {"longest": 10.0, "varying": {"q": [1.0]}}, "q"),
        ([[0.0, 0.0]] * 3, {"longest": 10.0, "varying": {"d": [1.0, 2.0]}}, "one length"),
    ):
        with pytest.raises(InputError, match=said):
            rw.attractors(PENDULUM, starts, **options)  # pyright: ignore
    refuses = rw.paper_model(outside="refuse")
    with pytest.raises(InputError, match="blend"):
        rw.attractor(refuses, {"phi": 0.8}, longest=100.0)
