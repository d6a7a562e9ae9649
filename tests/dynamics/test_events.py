"""Zeros along trajectories: all of them, each at its closed form, and the ends that they bring."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.errors import InputError, TraceError


def oscillator():
    """q = sin t from (0, 1)."""
    return rw.System(lambda x, p: (x.v, -x.q), ("q", "v"))


def run(events=(), duration=100.0, **options):
    options = {"tolerance": 1e-12, **options}
    return rw.simulate(oscillator(), [0.0, 1.0], duration=duration, events=events, **options)


def found(function, **options):
    event = rw.Event("it", function, **options)
    return run(event).events["it"]


def test_zeros_of_a_sine():
    crossings = found(lambda x, p: x.q)
    assert crossings.times == pytest.approx(np.pi * np.arange(1, 32), abs=1e-10)  # the start does not count
    assert crossings.rising.tolist() == [k % 2 == 1 for k in range(31)]
    assert np.abs(crossings["q"]).max() < 1e-15  # located to rounding


@pytest.mark.parametrize(("direction", "first"), [(1, 2 * np.pi), (-1, np.pi)])
def test_directions(direction, first):
    crossings = found(lambda x, p: x.q, direction=direction)
    assert crossings.times == pytest.approx(first + 2 * np.pi * np.arange(len(crossings)), abs=1e-10)
    assert len(crossings) == (15 if direction == 1 else 16)


@pytest.mark.parametrize("depth", [1e-2, 1e-5, 1e-8])
def test_two_zeros_in_one_step_are_both_found(depth):
    crossings = found(lambda x, p: x.q - (1.0 - depth))
    tops = np.pi / 2 + 2 * np.pi * np.arange(16)
    width = np.arccos(1.0 - depth)
    exact = np.sort(np.concatenate([tops - width, tops + width]))
    assert len(crossings) == 32
    assert crossings.times == pytest.approx(exact, abs=1e-11 / width)


def test_touching_is_no_crossing_and_near_misses_are_none():
    assert len(found(lambda x, p: x.q - (1.0 + 1e-9))) == 0
    assert len(found(lambda x, p: (x.q - 0.5) ** 2)) == 0


def test_many_zeros_in_one_step():
    """sin(40 sin t) vanishes where 40 sin t is k pi, |k| <= 12: 50 times a turn."""
    crossings = found(lambda x, p: rw.sin(40.0 * x.q))
    levels = np.arange(-12, 13) * np.pi / 40.0
    t = np.concatenate([np.arcsin(levels), np.pi - np.arcsin(levels)])
    exact = np.sort((t[:, None] + 2 * np.pi * np.arange(-1, 17)).ravel())
    exact = exact[(exact > 1e-9) & (exact < 100.0)]
    assert len(crossings) == len(exact)
    assert crossings.times == pytest.approx(exact, abs=1e-10)


def test_a_function_that_looks_constant_on_half_of_the_points():
    """T_12 + 0.9 on one straight piece: 1.9 at all seven points that are looked at first, and yet twelve zeros."""

    def chebyshev(s):
        before, now = 1.0, s
        for _ in range(11):
            before, now = now, 2.0 * s * now - before
        return now

    straight = rw.System(lambda x, p: (1.0 + 0.0 * x.s,), ("s",))
    course = rw.simulate(straight, [-1.0], duration=2.0)
    assert len(course) == 1
    crossings = course.section(lambda x, p: chebyshev(x.s) + 0.9, direction=0)
    angles = (np.arange(6)[:, None] * 2 + 1) * np.pi / 12 + np.array([-1, 1]) * np.arccos(0.9) / 12
    assert crossings["s"] == pytest.approx(np.sort(np.cos(angles).ravel()), abs=1e-12)


def test_functions_that_polynomials_follow_badly():
    steep = found(lambda x, p: rw.tanh(1e4 * (x.q - 0.3)))
    assert len(steep) == 32
    assert steep["q"] == pytest.approx(np.full(32, 0.3), abs=1e-14)
    near_a_pole = found(lambda x, p: 1.0 / (x.q - 1.001) + 100.0)
    assert near_a_pole["q"] == pytest.approx(np.full(len(near_a_pole), 0.991), abs=1e-12)
    assert len(near_a_pole) == 32


def test_noise_comes_to_an_end():
    """The energy less its value is rounding: nothing can be said but that the search ends."""
    found(lambda x, p: x.q * x.q + x.v * x.v - 1.0)
    assert len(found(lambda x, p: 0.0 * x.q)) == 0


def test_a_terminal_event_ends_the_run_exactly_there():
    fall = rw.Event("falls", lambda x, p: x.q - 0.5, direction=-1, terminal=True)
    top = rw.Event("top", lambda x, p: x.v)
    ended = run([top, fall])
    assert ended.ended is rw.RunEnded.EVENT
    assert ended.duration == pytest.approx(5 * np.pi / 6, abs=1e-12)
    assert ended.end == pytest.approx([0.5, -np.sqrt(0.75)], abs=1e-12)
    assert ended.at(ended.duration) == pytest.approx(ended.end, abs=1e-15)
    assert ended.events["top"].times == pytest.approx([np.pi / 2], abs=1e-11)
    assert len(ended.events["falls"]) == 1
    assert "falls" in ended.note


def test_the_first_of_two_terminal_events_wins():
    first = rw.Event("first", lambda x, p: x.q - 0.3, terminal=True)
    second = rw.Event("second", lambda x, p: x.q - 0.300001, terminal=True)
    ended = run([second, first])
    assert len(ended.events["second"]) == 0
    assert ended.end[0] == pytest.approx(0.3, abs=1e-15)


def test_a_jump_of_a_driven_parameter_crosses_at_its_knot():
    system = rw.System(lambda x, p: 0.0 * x.x + 1.0, ("x",), {"level": 10.0})
    level = rw.ramp(10.0, 0.5, 0.0, after=2.0)
    event = rw.Event("above", lambda x, p: x.x - p.level)
    jumped = rw.simulate(system, [0.0], duration=4.0, parameters={"level": level}, events=event)
    assert jumped.events["above"].times.tolist() == [2.0]
    slow = rw.simulate(system, [0.0], duration=8.0, parameters={"level": rw.ramp(10, 0, 10)}, events=event)
    assert slow.events["above"].times == pytest.approx([5.0], abs=1e-12)


def test_sections_after_the_run():
    trajectory = run()
    for where in (("q", 0.5), lambda x, p: x.q - 0.5, rw.Event("half", lambda x, p: x.q - 0.5, direction=1)):
        section = trajectory.section(where)
        assert section.times == pytest.approx(np.pi / 6 + 2 * np.pi * np.arange(16), abs=1e-10)
    both = trajectory.section(("q", 0.5), direction=0)
    assert len(both) == 32
    assert both["v"] == pytest.approx(np.where(both.rising, 1, -1) * np.sqrt(0.75), abs=1e-10)


def test_wrong_events():
    with pytest.raises(InputError, match="direction = 2"):
        rw.Event("a", lambda x, p: x.q, direction=2)
    with pytest.raises(InputError, match="callable"):
        rw.Event("a", 3.0)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="name must be a word"):
        rw.Event("", lambda x, p: x.q)
    twice = [rw.Event("a", lambda x, p: x.q), rw.Event("a", lambda x, p: x.v)]
    with pytest.raises(InputError, match="two events are called 'a'"):
        run(twice)
    with pytest.raises(InputError, match=r"events are rw\.Event"):
        run([lambda x, p: x.q])
    with pytest.raises(TraceError, match="branch"):
        run(rw.Event("a", lambda x, p: abs(x.q)))
    with pytest.raises(TraceError, match="no 'w'"):
        run(rw.Event("a", lambda x, p: x.w))
    with pytest.raises(TraceError, match="event 'a' failed: it returned"):
        run(rw.Event("a", lambda x, p: (x.q, x.v)))
    with pytest.raises(InputError, match="no state 'w'"):
        run().section(("w", 0.0))
