"""Quasi-static sweeps on the normal form r' = r (mu + r² - r⁴): Hopf at 0, fold of cycles at -1/4."""

import numpy as np
import pytest

from rainwind.dynamics.simulate import simulate
from rainwind.dynamics.sweeps import SweepEnded, sweep
from rainwind.dynamics.system import System
from rainwind.elementary import sin
from rainwind.errors import InputError

FINEST = 2e-3


def _rhs(x, p):
    square = x.u * x.u + x.v * x.v
    growth = p.mu + square - square * square
    return x.u * growth - 6.0 * x.v, x.v * growth + 6.0 * x.u


OSCILLATOR = System(_rhs, ("u", "v"), {"mu": -0.5})
SETTINGS = {
    "step": 0.08, "finest": FINEST, "scales": {"u": 0.5, "v": 0.5}, "push": {"u": 1e-3}, "hold": 40.0,
    "longest": 4000.0,
}  # fmt: skip


def radius(mu: float) -> float:
    """Of the stable cycle."""
    return np.sqrt(0.5 + np.sqrt(0.25 + mu))


def go(first: float, last: float, start: tuple[float, float], **changed):
    return sweep(OSCILLATOR, "mu", start=start, until=(first, last), **(SETTINGS | changed))


@pytest.fixture(scope="module")
def up():
    return go(-0.5, 0.3, (0.0, 0.0))


@pytest.fixture(scope="module")
def down(up):
    return go(0.3, -0.5, tuple(up.levels[-1].state))


def test_rising_it_jumps_at_the_hopf_point(up):
    (jump,) = up.jumps
    assert up.rising
    assert up.ended is SweepEnded.AT_END
    assert jump.before.value <= FINEST  # at 0, and not long after it as on a ramp
    assert abs(jump.value) < FINEST
    assert jump.after is not None
    assert np.max(jump.before.amplitude) < 2e-3
    assert jump.after.amplitude == pytest.approx([radius(jump.after.value)] * 2, rel=1e-4)


def test_falling_it_jumps_at_the_fold_of_cycles(down):
    (jump,) = down.jumps
    assert not down.rising
    assert jump.value == pytest.approx(-0.25, abs=FINEST)
    assert jump.after is not None
    assert np.max(jump.after.amplitude) < 2e-3


def test_a_jump_to_what_has_not_settled_in_time_counts_once():
    found = go(0.3, -0.5, (radius(0.3), 0.0), longest=80.0)
    (jump,) = found.jumps
    assert jump.after in found.levels
    assert jump.after is not None
    assert jump.after.held > 80.0  # held longer, before it was called a jump from there
    # right at the fold nothing settles, however patient: the jump lies between there and the level before
    assert jump.after.value == pytest.approx(-0.252)
    assert jump.before.value == pytest.approx(-0.24)
    assert jump.value == pytest.approx(-0.246)


def test_on_the_way_it_is_the_stable_cycle_in_closed_form(down):
    on = [level for level in down.levels if level.value > -0.249]
    assert len(on) > 8
    for level in on:
        assert level.steady
        assert level.amplitude == pytest.approx([radius(level.value)] * 2, rel=1e-4)
    # steps shrink only where the branch is steep
    assert np.abs(np.diff(down.values)).max() == pytest.approx(SETTINGS["step"])


def test_a_soft_hopf_point_is_no_jump():
    def soft(x, p):
        growth = p.mu - x.u * x.u - x.v * x.v
        return x.u * growth - 6.0 * x.v, x.v * growth + 6.0 * x.u

    found = sweep(
        System(soft, ("u", "v"), {"mu": 0.0}), "mu", start=(0.0, 0.0), until=(-0.1, 0.3), **SETTINGS
    )
    assert not found.jumps
    for level in found.levels:
        if level.value > 0.02:
            assert level.amplitude == pytest.approx([np.sqrt(level.value)] * 2, rel=2e-3)


def test_what_runs_away_ends_the_sweep_and_says_where():
    away = System(lambda x, p: (p.a + x[0] * x[0],), ("x",), {"a": -1.0})
    found = sweep(
        away, "a", start=(-1.0,), until=(-1.0, 0.5), step=0.1, finest=0.01, scales={"x": 1.0}, push={"x": 1e-3},
        hold=50.0, longest=500.0,
    )  # fmt: skip
    assert found.ended is SweepEnded.LEFT
    (jump,) = found.jumps
    assert jump.after is None
    assert -0.02 < jump.value < 0.02  # the fold is at 0
    assert "at a = " in found.note


def test_ctrl_c_keeps_what_is_done():
    asked = []

    def stop(value: float) -> None:
        asked.append(value)
        if value > -0.3:
            raise KeyboardInterrupt

    found = go(-0.5, 0.3, (0.0, 0.0), progress=stop)
    assert found.ended is SweepEnded.INTERRUPTED
    assert found.values.tolist() == pytest.approx([-0.5, -0.42, -0.34])


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"finest": 0.0}, "0 < finest <= step"),
        ({"finest": 0.1}, "0 < finest <= step"),
        ({"step": float("nan")}, "step"),
        ({"hold": -1.0}, "0 < hold <= longest"),
        ({"longest": 1.0}, "0 < hold <= longest"),
        ({"scales": {}}, "above 0"),
        ({"scales": {"u": 0.0}}, "above 0"),
        ({"scales": {"w": 1.0}}, "w"),
        ({"push": {"w": 1.0}}, "w"),
        ({"accuracy": 0.0}, "accuracy"),
    ],
)
def test_what_makes_no_sense_is_refused(changed, words):
    with pytest.raises(InputError, match=words):
        go(-0.5, 0.3, (0.0, 0.0), **changed)
    with pytest.raises(InputError, match="one value"):
        go(0.1, 0.1, (0.0, 0.0))


def test_an_angle_counts_from_minus_90_to_270_degrees():
    # a pendulum at rest at sin(angle) = torque, begun a turn away
    def rhs(x, p):
        return x.v, p.torque - sin(x.angle) - 20.0 * x.v

    pendulum = System(rhs, ("angle", "v"), {"torque": 0.0})
    found = sweep(
        pendulum, "torque", start=(-2.0 * np.pi, 0.0), until=(0.0, -0.5), step=0.25, finest=0.05,
        scales={"angle": 1.0}, push={}, hold=400.0, longest=4000.0,
    )  # fmt: skip
    assert [level.state[0] for level in found.levels] == pytest.approx(
        np.arcsin([0.0, -0.25, -0.5]), abs=1e-4
    )
    assert found["min angle"] == pytest.approx(np.arcsin([0.0, -0.25, -0.5]), abs=1e-4)


def test_columns_by_name(down):
    assert down["u"] == pytest.approx(0.5 * (down["max u"] - down["min u"]))
    with pytest.raises(InputError, match="w"):
        down["w"]


def test_extremes_between_are_those_of_a_sine():
    from rainwind.dynamics.extremes import extremes_between

    circle = System(lambda x, p: (x[1], -x[0]), ("x", "v"))
    run = simulate(circle, (0.0, 1.0), duration=20.0, tolerance=1e-13)
    low, high = extremes_between(run, np.array([0.0, 1.0, 2.0, 4.0, 11.0]))  # x = sin t
    assert high[:, 0] == pytest.approx([np.sin(1.0), 1.0, np.sin(2.0), 1.0], abs=1e-12)
    assert low[:, 0] == pytest.approx([0.0, np.sin(1.0), np.sin(4.0), -1.0], abs=1e-12)
    with pytest.raises(InputError, match="increase"):
        extremes_between(run, np.array([1.0, 1.0]))
