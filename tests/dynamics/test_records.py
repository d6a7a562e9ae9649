"""Signals through samples: what lies between them, and which samples are refused."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rainwind as rw
import rainwind.dynamics.records  # slow to load: not inside a test with a deadline
from rainwind.errors import InputError

KINDS = ["linear", "cubic", "spline"]


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("kind", KINDS)
@given(st.lists(st.floats(-5, 5), min_size=4, max_size=9))
def test_goes_through_the_samples(kind, periodic, values):
    values = [*values, values[0]]
    times = np.cumsum(1.0 + 0.4 * np.sin(np.arange(len(values))))
    signal = rw.record(times, values, kind, periodic=periodic, gaps="interpolate")
    assert (signal.since, signal.until) == (times[0], times[-1])
    np.testing.assert_allclose(signal.at(times), values, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize(("kind", "order"), [("linear", 2), ("spline", 4)])
def test_order_between_the_samples(kind, order):
    errors = []
    for n in (40, 80):
        t = np.linspace(0, 3, n + 1)
        between = np.linspace(0.5, 2.5, 777)
        signal = rw.record(t, np.sin(2 * t), kind)
        errors.append(np.max(np.abs(signal.at(between) - np.sin(2 * between))))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2)


@given(st.lists(st.floats(-5, 5), min_size=3, max_size=12))
def test_a_cubic_stays_between_neighbouring_samples(values):
    signal = rw.record(np.arange(len(values)), values, "cubic")
    for i, (a, b) in enumerate(pairwise(values)):
        low, high = signal.part(i, i + 1).extremes()
        assert low == pytest.approx(min(a, b), abs=1e-12)
        assert high == pytest.approx(max(a, b), abs=1e-12)


@pytest.mark.parametrize(("kind", "smooth"), [("cubic", 1), ("spline", 2)])
def test_derivatives_meet_at_the_knots_and_at_the_turn_of_a_period(kind, smooth):
    t = np.linspace(0, 1, 13)
    v = np.sin(2 * np.pi * t) + 0.3 * np.cos(6 * np.pi * t)
    v[-1] = v[0]
    twice = rw.record(t, v, kind, periodic=True).repeated(2)
    assert len(twice) == 24
    for knot in twice.knots[1:-1]:
        for derivative in range(1, smooth + 1):
            before, behind = twice.at([np.nextafter(knot, 0), knot], derivative)
            assert before == pytest.approx(behind, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_where_a_period_begins_makes_no_difference(kind):
    v = np.array([1.0, 3.0, 2.5, -1.0, 0.5, 0.7])
    first = rw.record(np.arange(7), np.append(v, v[0]), kind, periodic=True)
    rolled = np.roll(v, -2)
    second = rw.record(np.arange(7), np.append(rolled, rolled[0]), kind, periodic=True)
    t = np.linspace(0, 3.9, 40)
    np.testing.assert_allclose(first.repeated(2).at(t + 2), second.at(t), atol=1e-13)


def test_samples_on_one_line_are_one_piece():
    t = np.arange(0.0, 100.0, 0.1)
    v = np.interp(t, [0, 30, 60, 100], [5, 5, 11, 7])
    signal = rw.record(t, v)
    assert signal.knots.tolist() == pytest.approx([0, 30, 60, 99.9])
    np.testing.assert_allclose(signal.at(t), v, rtol=0, atol=1e-12)


def test_nearly_straight_samples_are_not_one_piece():
    # every second difference is below the rounding that is let pass, their sum is not
    t = np.arange(2000.0)
    v = 5 + 1e-13 * t**2
    signal = rw.record(t, v)
    assert 1 < len(signal) < 1999
    np.testing.assert_allclose(signal.at(t), v, rtol=0, atol=2e-12)


def test_a_missing_sample_is_a_gap_and_may_be_bridged():
    t = np.delete(np.arange(0.0, 10.0, 0.5), [3, 9, 10])
    with pytest.raises(InputError, match=r"2 gaps \(1 to 2 s, 4 to 5.5 s\).* usual one, 0.5 s.*interpolate"):
        rw.record(t, t)
    assert rw.record(t, t, gaps="interpolate").at(4.7) == pytest.approx(4.7)
    # steps that scatter are no gaps
    rw.record([0, 1, 2.4, 3, 4.2], [1, 2, 3, 4, 5])


@pytest.mark.parametrize(
    ("times", "values", "options", "words"),
    [
        ([0, 1, 2], [1, np.nan, 3], {}, "1 value of the record is not finite, the first is sample 1 \\(nan\\)"),
        ([0, 1, np.inf], [1, 2, 3], {}, "1 time of the record is not finite"),
        ([0, 1, 2], np.ma.masked_invalid([1, np.nan, np.nan]), {}, "2 values of the record are not finite"),
        ([0, 2, 1, 3], [1, 2, 3, 4], {}, "must increase; 1 s comes after 2 s \\(samples 1 and 2, 1 such place\\)"),
        ([0, 1, 1, 2], [1, 2, 3, 4], {}, "1 s comes twice"),
        ([0], [1], {}, "two samples or more; got 1"),
        ([], [], {}, "two samples or more; got 0"),
        ([0, 1], [1, 2, 3], {}, "2 times and 3 values"),
        ([[0, 1]], [[1, 2]], {}, "must be one column"),
        (["0", "1"], [1, 2], {}, "must be real numbers"),
        ([0, None], [1, 2], {}, "not finite"),
        (np.array(["2026-01-01", "2026-01-02"], "datetime64[s]"), [1, 2], {}, "subtract the first one"),
        ([0, 1], [1j, 2], {}, "must be real numbers"),
        ([0, 1], [1, 2], {"kind": "quintic"}, "kind = 'quintic' is not known"),
        ([0, 1], [1, 2], {"gaps": "ignore"}, "gaps = 'ignore' is not known"),
        ([0, 1], [1, 2], {"periodic": True}, "got 1 and 2"),
    ],
)  # fmt: skip
def test_what_is_refused(times, values, options, words):
    with pytest.raises(InputError, match=words):
        rw.record(times, values, **options)
