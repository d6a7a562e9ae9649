"""Elementary functions of numbers, arrays and types of their own."""

import cmath
import math

import numpy as np
import pytest

from rainwind import elementary

OF_ONE = [name for name in elementary.__all__ if name not in ("atan2", "wrap_angle")]


class Recorder:
    """Notes what it is asked for."""

    def _elementary_(self, name, *others):
        return (name, *others)


@pytest.mark.parametrize("name", OF_ONE)
def test_numbers_and_arrays(name):
    function, expected = getattr(elementary, name), getattr(math, name)(0.37)
    assert function(0.37) == pytest.approx(expected, rel=1e-15)
    array = function(np.full((2, 3), 0.37))
    assert array.shape == (2, 3)
    assert array[1, 2] == pytest.approx(expected, rel=1e-15)
    assert function.__name__ == name


@pytest.mark.parametrize("name", OF_ONE)
def test_types_of_their_own_are_asked(name):
    assert getattr(elementary, name)(Recorder()) == (name,)


def test_atan2_asks_either_argument_and_keeps_their_order():
    symbol = Recorder()
    assert elementary.atan2(symbol, 2.0) == ("atan2", symbol, 2.0)
    assert elementary.atan2(1.0, symbol) == ("atan2", 1.0, symbol)
    assert elementary.atan2(1.0, -1.0) == pytest.approx(3 * math.pi / 4)


@pytest.mark.parametrize("x", [0.0, 3.0, -3.0, 3.5, -3.5, 9.0, 100.0, math.pi])
def test_wrapped_angles(x):
    wrapped = elementary.wrap_angle(x)
    assert -math.pi < wrapped <= math.pi
    assert wrapped == pytest.approx(cmath.phase(cmath.exp(1j * x)), abs=1e-12)
    assert elementary.wrap_angle(np.array([x]))[0] == wrapped


def test_wrap_angle_asks_types_of_their_own():
    class Box:
        def _wrap_angle_(self):
            return "wrapped"

    assert elementary.wrap_angle(Box()) == "wrapped"
