"""Polynomial pieces: values, derivatives, parts and integrals of polynomials that are known."""

import numpy as np
import pytest

from rainwind.dynamics.drive import drive
from rainwind.dynamics.pieces import Pieces, joined
from rainwind.dynamics.signals import Signal, ramp
from rainwind.errors import InputError

# one quartic and one line on [1, 6], cut into pieces whose coefficients count from their beginning
FULL = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.3, -0.1])
LINE = np.polynomial.Polynomial([2.0, 3.0, 0.0, 0.0, 0.0])
TIMES = np.array([1.0, 1.5, 3.0, 3.25, 6.0])


def taylor(polynomial, t):
    c = [polynomial.deriv(j)(t) / np.prod(np.arange(1, j + 1)) if j else polynomial(t) for j in range(5)]
    return np.array(c)


def pieces():
    return Pieces(TIMES, np.array([[taylor(FULL, t), taylor(LINE, t)] for t in TIMES[:-1]]))


def test_values_and_derivatives():
    t = np.linspace(1.0, 6.0, 60).reshape(3, 20)
    for order in range(5):
        found = pieces().at(t, derivative=order)
        assert found.shape == (3, 20, 2)
        exact = [p.deriv(order)(t) if order else p(t) for p in (FULL, LINE)]
        assert found == pytest.approx(np.stack(exact, axis=-1), rel=1e-12, abs=1e-12)
    assert pieces().at(2.0).shape == (2,)
    assert pieces().joints() == pytest.approx(np.stack([FULL(TIMES), LINE(TIMES)], axis=1), rel=1e-13)


def test_at_a_joint_the_later_piece_holds():
    jump = Pieces(np.array([0.0, 1.0, 2.0]), np.array([[[1.0]], [[5.0]]]))
    assert jump.at([0.0, 0.999, 1.0, 2.0])[:, 0].tolist() == [1.0, 1.0, 5.0, 5.0]


def test_parts_and_integrals():
    part = pieces().part(1.2, 5.5)
    assert part.times.tolist() == [1.2, 1.5, 3.0, 3.25, 5.5]
    t = np.linspace(1.2, 5.5, 99)
    assert part.at(t) == pytest.approx(pieces().at(t), rel=1e-12, abs=1e-12)
    exact = [p.integ()(5.5) - p.integ()(1.2) for p in (FULL, LINE)]
    assert part.integral() == pytest.approx(exact, rel=1e-12)
    cut = pieces().until(3.1)
    assert cut.times.tolist() == [1.0, 1.5, 3.0, 3.1]
    assert cut.at(3.05) == pytest.approx(pieces().at(3.05))
    assert pieces().until(3.0).times.tolist() == [1.0, 1.5, 3.0]


def test_joined_parts_of_different_degree():
    line = Pieces(np.array([6.0, 7.0]), np.array([[[FULL(6.0), 1.0], [LINE(6.0), 3.0]]]))
    both = joined([pieces(), line])
    assert len(both) == 5
    assert both.at(6.5) == pytest.approx([FULL(6.0) + 0.5, LINE(6.5)])


def test_times_outside_are_refused():
    for wrong in (0.9, 6.1, np.nan):
        with pytest.raises(InputError, match=r"from t = 1 to 6"):
            pieces().at([2.0, wrong])


def test_signals_on_one_table():
    cubic = Signal(np.array([-1.0, 0.5, 9.0]), np.array([[1.0, 2.0, 3.0, 4.0], [0.0, -1.0, 0.0, 0.5]]))
    rise = ramp(5.0, 8.0, 2.0, after=1.0)
    table = drive({"a": cubic, "b": rise}, {"a": 7, "b": 4}, 4.0)
    assert table.pieces.times.tolist() == [0.0, 0.5, 1.0, 3.0, 4.0]
    assert table.numbers.tolist() == [7, 4]
    t = np.linspace(0.0, 4.0, 77)
    assert table.pieces.at(t) == pytest.approx(np.stack([cubic.at(t), rise.at(t)], axis=1), rel=1e-12)
    steps = np.array([0.0, 0.2, 0.5, 0.7, 1.0, 2.0, 3.0, 4.0])
    assert Pieces(steps, table.on(steps)).at(t) == pytest.approx(table.pieces.at(t), rel=1e-12)
