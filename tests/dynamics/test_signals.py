"""Signals: values, sums, ramps, chains, and what they refuse."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

import rainwind as rw
from rainwind.dynamics.signals import Signal
from rainwind.errors import InputError

KNOTS = np.array([-1.0, 0.5, 0.75, 4.0])
CUBICS = np.array([[1.0, 2.0, -3.0, 0.5], [0.0, -1.0, 0.0, 4.0], [7.0, 0.25, 1.0, -0.5]])
CURVE = Signal(KNOTS, CUBICS)


def by_hand(t, derivative=0):
    piece = max(i for i in range(3) if KNOTS[i] <= t)
    return Polynomial(CUBICS[piece]).deriv(derivative)(t - KNOTS[piece]) if derivative <= 3 else 0.0


@pytest.mark.parametrize("derivative", [0, 1, 2, 3, 4])
def test_value_and_derivatives_of_the_pieces(derivative):
    times = np.array([[-1.0, 0.1, 0.5], [0.6, 0.75, 4.0]])
    expected = [[by_hand(t, derivative) for t in row] for row in times]
    np.testing.assert_allclose(CURVE.at(times, derivative), expected, rtol=1e-14, atol=1e-13)
    assert CURVE.at(0.6, derivative) == pytest.approx(by_hand(0.6, derivative), rel=1e-14)
    assert isinstance(CURVE.at(0.6, derivative), float)


def test_at_a_jump_the_later_piece_holds():
    jump = rw.ramp(2.0, 5.0, 0.0, after=3.0, hold=1.0)
    assert jump.knots.tolist() == [0.0, 3.0, 4.0]
    assert jump.at([0.0, np.nextafter(3.0, 0), 3.0, 4.0]).tolist() == [2.0, 2.0, 5.0, 5.0]


def test_ramp_by_hand():
    ramp = rw.ramp(5, 15, 100, after=10)
    assert ramp.until == np.inf
    assert ramp.at([0, 10, 60, 110, 1e9]).tolist() == [5.0, 5.0, 10.0, 15.0, 15.0]
    assert ramp.knots.tolist() == [0.0, 10.0, 110.0, np.inf]
    assert ramp.at(60.0, derivative=1) == 0.1
    assert rw.ramp(5, 15, 100, hold=0).until == 100.0


def test_up_and_down_again():
    sweep = rw.ramp(5, 15, 100, hold=20).then(rw.ramp(15, 5, 50))
    assert sweep.knots.tolist() == [0.0, 100.0, 120.0, 170.0, np.inf]
    assert sweep.at([50, 110, 145, 1000]).tolist() == [10.0, 15.0, 10.0, 5.0]


@given(st.floats(-1, 4), st.floats(-3, 3))
def test_sums_and_multiples_are_those_of_the_values(t, factor):
    other = Signal([-1.0, 0.1, 4.0], [[3.0, -1.0], [0.0, 0.5]])
    a, b = CURVE.at(t), other.at(t)
    for signal, expected in (
        (CURVE + other, a + b), (CURVE - other, a - b), (factor * CURVE, factor * a), (-CURVE, -a),
        (CURVE + factor, a + factor), (factor - CURVE, factor - a), (np.float64(factor) * CURVE, factor * a),
        (CURVE / 4, a / 4), (CURVE - factor, a - factor),
    ):  # fmt: skip
        assert signal.at(t) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_a_sum_has_the_knots_of_both():
    total = CURVE + Signal([-1.0, 0.1, 4.0], [[3.0], [0.0]])
    assert total.knots.tolist() == [-1.0, 0.1, 0.5, 0.75, 4.0]
    assert total.degree == 3


def test_knots_that_differ_by_rounding_are_one():
    a, b = Signal([0.0, 0.1 * 3, 1.0], [[1.0, 1.0], [2.0, 5.0]]), Signal([0.0, 0.3, 1.0], [[0.0], [10.0]])
    assert 0.1 * 3 != 0.3
    for total in (a + b, b + a):
        assert total.knots.tolist() == [0.0, 0.3, 1.0]
        assert total.at([0.2, 0.5]) == pytest.approx([1.2, 13.0], rel=1e-14)


def test_shifted_part_repeated():
    assert CURVE.shifted(10.0).at(10.3) == pytest.approx(CURVE.at(0.3))
    part = CURVE.part(0.6, 3.0)
    assert part.knots.tolist() == [0.6, 0.75, 3.0]
    assert part.at([0.7, 2.0]) == pytest.approx(CURVE.at([0.7, 2.0]))
    again = CURVE.repeated(3)
    assert (again.since, again.until, len(again)) == (-1.0, 14.0, 9)
    assert again.at([0.3, 5.3, 10.3]) == pytest.approx([CURVE.at(0.3)] * 3)


@given(st.lists(st.tuples(*[st.floats(-9, 9)] * 4), min_size=1, max_size=4))
def test_extremes_are_those_of_a_dense_grid(rows):
    signal = Signal(np.arange(len(rows) + 1.0), rows)
    grid = np.linspace(0, 1, 2001)
    values = np.array([np.polynomial.polynomial.polyval(grid, row) for row in rows])
    low, high = signal.extremes()
    # a grid misses an extremum by half its step squared times half the curvature
    missed = (9 * 2 + 9 * 6) / 2 * (grid[1] / 2) ** 2
    assert values.min() - missed - 1e-12 <= low <= values.min() + 1e-12
    assert values.max() - 1e-12 <= high <= values.max() + missed + 1e-12


def test_extremes_of_a_signal_that_holds_for_ever():
    assert rw.ramp(3, 1, 10).extremes() == (1.0, 3.0)
    assert Signal([0.0, 4.0], [[0.0, 4.0, -1.0]]).extremes() == (0.0, 4.0)
    assert "values 1 to 3" in repr(rw.ramp(3, 1, 10))


def test_arrays_are_copies_and_read_only():
    knots = np.array([0.0, 1.0])
    signal = Signal(knots, np.array([[1.0]]))
    knots[1] = 9.0
    assert signal.until == 1.0
    with pytest.raises(ValueError, match="read-only"):
        signal.knots[0] = 5.0
    assert pickle.loads(pickle.dumps(CURVE)).at(0.6) == CURVE.at(0.6)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda: Signal([0.0, 1.0], [[1.0], [2.0]]), "2 knots and coefficients of shape \\(2, 1\\)"),
        (lambda: Signal([0.0, 1.0], [[1.0] * 5]), "shape \\(1, 5\\)"),
        (lambda: Signal([0.0], np.zeros((0, 2))), "k \\+ 1 knots"),
        (lambda: Signal([0.0, 2.0, 1.0], [[1.0], [2.0]]), "must increase; got 2 s, then 1 s"),
        (lambda: Signal([0.0, np.nan], [[1.0]]), "must be finite"),
        (lambda: Signal([-np.inf, 0.0], [[1.0]]), "must be finite"),
        (lambda: Signal([0.0, 1.0], [[np.nan]]), "coefficients of a signal must be finite"),
        (lambda: Signal([0.0, np.inf], [[1.0, 2.0]]), "end in a constant piece"),
        (lambda: Signal(["a", "b"], [[1.0]]), "must be numbers"),
        (lambda: Signal(0.0, [[1.0]]), "1 axes"),
        (lambda: CURVE.at(4.1), "from -1 to 4 s; it has no value at t = 4.1"),
        (lambda: CURVE.at([0.0, np.nan]), "no value at t = nan"),
        (lambda: rw.ramp(1, 2, 3).at(np.inf), "no value at t = inf"),
        (lambda: CURVE.at(0.0, derivative=-1), "derivative = -1"),
        (lambda: CURVE * CURVE, "degree would be above 3"),
        (lambda: CURVE + "1", "must be a number"),
        (lambda: CURVE * np.nan, "finite number"),
        (lambda: CURVE / 0, "divided by zero"),
        (lambda: CURVE + rw.ramp(1, 2, 3), "same times"),
        (lambda: rw.ramp(1, 2, 3).then(CURVE), "no end to go on from"),
        (lambda: rw.ramp(1, 2, 3).repeated(2), "cannot be repeated"),
        (lambda: CURVE.repeated(0), "times = 0"),
        (lambda: CURVE.then(3), "followed by a signal"),
        (lambda: CURVE.part(3, 5), "not inside the signal"),
        (lambda: CURVE.part(3, 2), "not inside the signal"),
        (lambda: rw.ramp(1, 2, -3), "duration = -3 s must be 0 or more"),
        (lambda: rw.ramp(1, np.nan, 3), "end = nan must be a finite number"),
        (lambda: rw.ramp(1, 2, np.inf), "duration = inf"),
        (lambda: rw.ramp(1, 2, 0, hold=0), "all three are 0"),
        (lambda: rw.ramp(True, 2, 1), "start = True must be a number"),
    ],
)
def test_what_is_refused(wrong, words):
    with pytest.raises(InputError, match=words):
        wrong()
