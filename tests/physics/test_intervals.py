"""Enclosures hold: every value and slope in a box lies inside its interval."""

from fractions import Fraction
from math import inf, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rainwind import elementary as el
from rainwind.physics.intervals import Box

FORMULAS = {
    "sin": (lambda x: el.sin(x), lambda x: np.cos(x)),
    "cos": (lambda x: el.cos(x), lambda x: -np.sin(x)),
    "tan": (lambda x: el.tan(x), lambda x: 1 / np.cos(x) ** 2),
    "asin": (lambda x: el.asin(0.1 * x), lambda x: 0.1 / np.sqrt(1 - 0.01 * x**2)),
    "acos": (lambda x: el.acos(0.1 * x), lambda x: -0.1 / np.sqrt(1 - 0.01 * x**2)),
    "atan": (lambda x: el.atan(x), lambda x: 1 / (1 + x**2)),
    "sinh": (lambda x: el.sinh(x), lambda x: np.cosh(x)),
    "cosh": (lambda x: el.cosh(x), lambda x: np.sinh(x)),
    "tanh": (lambda x: el.tanh(x), lambda x: 1 / np.cosh(x) ** 2),
    "exp": (lambda x: el.exp(x), lambda x: np.exp(x)),
    "log": (lambda x: el.log(11 + x), lambda x: 1 / (11 + x)),
    "sqrt": (lambda x: el.sqrt(11 + x), lambda x: 0.5 / np.sqrt(11 + x)),
    "erf": (lambda x: el.erf(x), lambda x: 2 / np.sqrt(pi) * np.exp(-(x**2))),
    "product": (lambda x: (x - 1.5) * (2 - x * x), lambda x: 2 + 3 * x - 3 * x**2),
    "square": (lambda x: x * x, lambda x: 2 * x),
    "quotient": (lambda x: (1 + x) / (13 - x), lambda x: 14 / (13 - x) ** 2),
    "reciprocal": (lambda x: 3.0 / x - x / 7.0, lambda x: -3 / x**2 - 1 / 7),
    "atan2": (lambda x: el.atan2(x, 2.0), lambda x: 2 / (4 + x**2)),
    "atan2 of both": (lambda x: el.atan2(x + 1, x + 12.0), lambda x: 11 / ((x + 1) ** 2 + (x + 12) ** 2)),
    "signs": (lambda x: -(+x) - np.float64(2) * x + 1 - 0.5, lambda x: -3 + 0 * x),
}


@pytest.mark.parametrize("name", FORMULAS)
@given(low=st.floats(-9, 9), width=st.sampled_from([0.0, 1e-9, 0.01, 0.3, 2.0, 7.0]), seed=st.integers(0, 99))
def test_values_and_slopes_stay_inside(name, low, width, seed):
    formula, slope = FORMULAS[name]
    high = min(low + width, 9.5)
    box = formula(Box.variable(np.array([low]), np.array([high])))
    with np.errstate(all="ignore"):
        points = np.append(np.random.default_rng(seed).uniform(low, high, 200), [low, high])
        points = np.clip(points, low, high)
        values, slopes = formula(points), slope(points)
    finite = np.isfinite(values) & np.isfinite(slopes)
    slack = 1e-13  # the comparison itself rounds
    assert np.all(values[finite] >= box.value[0] - slack * np.abs(values[finite]) - 1e-300)
    assert np.all(values[finite] <= box.value[1] + slack * np.abs(values[finite]) + 1e-300)
    assert np.all(slopes[finite] >= box.slope[0] - slack * (1 + np.abs(slopes[finite])))
    assert np.all(slopes[finite] <= box.slope[1] + slack * (1 + np.abs(slopes[finite])))


def test_enclosures_are_sharp_on_thin_boxes():
    x = np.array([0.7])
    for name, (formula, slope) in FORMULAS.items():
        box = formula(Box.variable(x, x))
        for (low, high), exact in ((box.value, formula(x)), (box.slope, slope(x))):
            assert high - low < 1e-13 * (1 + np.abs(exact)), name


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(0.1, 5))
def test_bounds_hold_in_exact_arithmetic(a, b, c):
    """Against fractions, one operation at a time: rounding goes outward."""
    x, y, z = (Box.variable(np.array([v]), np.array([v])) for v in (a, b, c))
    exact_a, exact_b, exact_c = Fraction(a), Fraction(b), Fraction(c)
    for box, exact in (
        (x + y, exact_a + exact_b),
        (x - b, exact_a - exact_b),
        (x * y, exact_a * exact_b),
        (x * b, exact_a * exact_b),
        (x * x, exact_a**2),
        (1.0 / z, 1 / exact_c),
        (x / c, exact_a / exact_c),
    ):
        low, high = (Fraction(float(bound[0])) for bound in box.value)
        assert low <= exact <= high


def test_sine_knows_its_extremes():
    low, high = el.sin(Box.variable(np.array([1.0, 4.0]), np.array([2.0, 5.0]))).value
    assert high[0] == 1.0
    assert low[1] == -1.0


def test_undefined_values_say_nothing():
    box = el.sqrt(Box.variable(np.array([-1.0]), np.array([4.0])))
    assert box.value[0] == -inf
    assert (1.0 / Box.variable(np.array([-1.0]), np.array([4.0]))).value == (-inf, inf)
    assert el.tan(Box.variable(np.array([1.0]), np.array([2.0]))).value == (-inf, inf)


@given(st.floats(-20, 20), st.floats(0, 0.2))
def test_wrapped_angles_stay_inside(low, width):
    box = el.wrap_angle(Box.variable(np.array([low]), np.array([low + width])))
    points = el.wrap_angle(np.linspace(low, low + width, 50))
    # the two ends of the circle are one point to rounding
    near_cut = np.abs(np.abs(points) - pi) < 1e-8
    assert np.all(near_cut | ((points >= box.value[0] - 1e-13) & (points <= box.value[1] + 1e-13)))


def test_a_box_across_the_cut_has_no_bounded_slope():
    box = el.wrap_angle(Box.variable(np.array([3.0]), np.array([3.3])))
    assert box.slope == (-inf, inf)
    assert box.value[0] < -3.1
    assert box.value[1] > 3.1
