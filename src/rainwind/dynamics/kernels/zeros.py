"""Zeros of functions along polynomial pieces, none missed and each located to rounding.

On an interval a function is sampled at Chebyshev's points; its interpolating polynomial in Bernstein's form has at
least as many changes of sign among its coefficients as zeros, so none means no zero and one means one. Other
intervals, and those on which the polynomial is no good picture of the function, are halved and sampled again. Most
intervals are far from a zero: half of the points, which are Chebyshev's points too, are enough to see that.
Source: Farouki (2012), The Bernstein polynomial basis: a centennial retrospective, Comput. Aided Geom. Des. 29:379.
"""

from math import comb, cos, pi

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.values import run

DEGREE = 12
# intervals of a piece: a function that is noise must end too
_MOST = 400
_NARROW = 1e-11
# a polynomial pictures a function when its last coefficients in Chebyshev's form are below this share of the largest
_RESOLVED = 1e-5
_EPS = 2.220446049250313e-16

POINTS = np.array([0.5 - 0.5 * cos(pi * i / DEGREE) for i in range(DEGREE + 1)])


def _to_bernstein(points: np.ndarray) -> np.ndarray:
    """Coefficients in Bernstein's form from values at points."""
    n = points.size - 1
    rows = [[comb(n, j) * s**j * (1.0 - s) ** (n - j) for j in range(n + 1)] for s in points]
    return np.linalg.inv(np.array(rows))


def _to_chebyshev(points: np.ndarray) -> np.ndarray:
    """Coefficients in Chebyshev's form from values at points."""
    return np.linalg.inv(np.polynomial.chebyshev.chebvander(2.0 * points - 1.0, points.size - 1))


_BERNSTEIN, _CHEBYSHEV = _to_bernstein(POINTS), _to_chebyshev(POINTS)
# one point more is foretold from half of them: a function that only looks smooth on them is found out
_FORETOLD = 5
_HALF_BERNSTEIN, _HALF_CHEBYSHEV = _to_bernstein(POINTS[::2]), _to_chebyshev(POINTS[::2])
_FORETELLING = (
    np.polynomial.chebyshev.chebvander(2.0 * POINTS[_FORETOLD : _FORETOLD + 1] - 1.0, DEGREE // 2)
    @ _HALF_CHEBYSHEV
)[0]
# how many times the last coefficients in Chebyshev's form a function must stay away from zero to be clear of it
_CLEAR = 30.0


@compiled
def _value(operations, slots, output, c, numbers, driven, s):
    """A function at s after the beginning of a piece: c (n, D + 1), driven (m, 4)."""
    for i in range(c.shape[0]):
        total = c[i, c.shape[1] - 1]
        for j in range(c.shape[1] - 2, -1, -1):
            total = total * s + c[i, j]
        slots[i] = total
    for i in range(numbers.size):
        slots[numbers[i]] = driven[i, 0] + s * (driven[i, 1] + s * (driven[i, 2] + s * driven[i, 3]))
    run(operations, slots)
    return slots[output]


@compiled
def _located(operations, slots, output, c, numbers, driven, low, high, at_low, at_high):
    """The zero between low and high by bisection and secants (Illinois); the side on which the new sign holds."""
    positive = at_high > 0.0
    for step in range(200):
        if high - low <= 2.0 * _EPS * high:
            break
        s = 0.5 * (low + high)
        if step % 3 != 2 and at_high != at_low:
            secant = high - at_high * (high - low) / (at_high - at_low)
            if low < secant < high:
                s = secant
        if not low < s < high:
            break
        found = _value(operations, slots, output, c, numbers, driven, s)
        if not np.isfinite(found):
            break
        if (found > 0.0) == positive:
            high, at_high = s, found
            at_low *= 0.5
        else:
            low, at_low = s, found
            at_high *= 0.5
    return high


@compiled
def find_zeros(
    operations,
    template,
    output,
    times,
    coefficients,
    numbers,
    driven,
    end,
    sign,
    found_at,
    found_piece,
    found_rising,
):
    """Where a function of states and driven parameters changes its sign along pieces.

    times (k + 1,), coefficients (k, n, D + 1), end (n,): the state at the last time; numbers (m,), driven (k, m, 4):
    the driven parameters. sign: 1 or -1, that of the function so far, 0 at the start of a run. Filled: times after the
    beginning of the piece, numbers of the pieces, and whether the function rises.
    Returns (how many, the sign at the end, the pieces looked at: fewer than k where the arrays are full).
    """
    slots = template.copy()
    n = end.size
    values = np.empty(DEGREE + 1)
    lows, highs = np.empty(_MOST), np.empty(_MOST)
    at_lows, at_highs = np.empty(_MOST), np.empty(_MOST)
    count = 0
    for piece in range(coefficients.shape[0]):
        h = times[piece + 1] - times[piece]
        c, p = coefficients[piece], driven[piece]
        before, sign_before = count, sign
        # at joints the states themselves, so that neighbours agree on the sign
        for i in range(numbers.size):
            slots[numbers[i]] = p[i, 0] + h * (p[i, 1] + h * (p[i, 2] + h * p[i, 3]))
        for i in range(n):
            slots[i] = coefficients[piece + 1, i, 0] if piece + 1 < coefficients.shape[0] else end[i]
        run(operations, slots)
        at_end = slots[output]
        at_start = _value(operations, slots, output, c, numbers, p, 0.0)
        if sign == 0:
            sign = 1 if at_start > 0.0 else -1
            nearby = _value(operations, slots, output, c, numbers, p, POINTS[1] * h)
            if abs(at_start) <= 1e-12 * max(abs(nearby), abs(at_end)):  # it starts on the zero
                sign = 1 if nearby > 0.0 else -1
                at_start = sign * 1e-300
        elif (at_start > 0.0) != (sign > 0):  # a driven parameter jumps
            sign = -sign
            if count == found_at.size:
                return before, sign_before, piece
            found_at[count], found_piece[count], found_rising[count] = 0.0, piece, sign > 0
            count += 1
        lows[0], highs[0], at_lows[0], at_highs[0] = 0.0, h, at_start, at_end
        waiting, looked = 1, 0
        while waiting > 0:
            waiting -= 1
            low, high, at_low, at_high = lows[waiting], highs[waiting], at_lows[waiting], at_highs[waiting]
            looked += 1
            values[0], values[DEGREE] = at_low, at_high
            for i in (2, 4, _FORETOLD, 6, 8, 10):
                s = low + POINTS[i] * (high - low)
                values[i] = _value(operations, slots, output, c, numbers, p, s)
            if _clear(values):
                continue
            for i in range(1, DEGREE, 2):
                s = low + POINTS[i] * (high - low)
                values[i] = _value(operations, slots, output, c, numbers, p, s)
            largest = 0.0
            for i in range(DEGREE + 1):
                largest = max(largest, abs(values[i]))
            changes, last = _changes(values)
            crossed = (at_low > 0.0) != (at_high > 0.0)
            stop = high - low <= _NARROW * h or looked + waiting >= _MOST - 2 or not np.isfinite(largest)
            if not stop and (changes > 1 or last > _RESOLVED):
                middle = 0.5 * (low + high)
                at_middle = values[DEGREE // 2]  # DEGREE is even: the middle is a point
                lows[waiting], highs[waiting] = middle, high
                at_lows[waiting], at_highs[waiting] = at_middle, at_high
                lows[waiting + 1], highs[waiting + 1] = low, middle
                at_lows[waiting + 1], at_highs[waiting + 1] = at_low, at_middle
                waiting += 2
                continue
            if crossed:
                s = _located(operations, slots, output, c, numbers, p, low, high, at_low, at_high)
                if count == found_at.size:
                    return before, sign_before, piece
                sign = 1 if at_high > 0.0 else -1
                found_at[count], found_piece[count], found_rising[count] = s, piece, sign > 0
                count += 1
    return count, sign, coefficients.shape[0]


@compiled
def _clear(values):
    """Whether the polynomial through every second value stays of one sign, by far more than it may be off."""
    nearest, last, sign = np.inf, 0.0, values[0] > 0.0
    half = DEGREE // 2
    for j in range(half + 1):
        b, t = 0.0, 0.0
        for i in range(half + 1):
            b += _HALF_BERNSTEIN[j, i] * values[2 * i]
            t += _HALF_CHEBYSHEV[j, i] * values[2 * i]
        if not np.isfinite(b) or (b > 0.0) != sign:
            return False
        nearest = min(nearest, abs(b))
        if j > half - 2:
            last = max(last, abs(t))
    foretold = 0.0
    for i in range(half + 1):
        foretold += _FORETELLING[i] * values[2 * i]
    return nearest > _CLEAR * max(last, abs(values[_FORETOLD] - foretold))


@compiled
def _changes(values):
    """Changes of sign of the polynomial's Bernstein coefficients, and the size of its last Chebyshev coefficients."""
    changes, sign = 0, 0
    largest, last = 0.0, 0.0
    for j in range(DEGREE + 1):
        if j == 0 or j == DEGREE:
            b = values[j]
        else:
            b = 0.0
            for i in range(DEGREE + 1):
                b += _BERNSTEIN[j, i] * values[i]
        now = 1 if b > 0.0 else -1
        changes += sign != 0 and now != sign
        sign = now
        t = 0.0
        for i in range(DEGREE + 1):
            t += _CHEBYSHEV[j, i] * values[i]
        largest = max(largest, abs(t))
        if j > DEGREE - 3:
            last = max(last, abs(t))
    return changes, (last / largest if largest > 0.0 else 0.0)
