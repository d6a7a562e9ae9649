"""What is kept of trajectories while they run: extremes, integrals, crossings, from blocks of polynomial steps.

A block has B steps of W lanes: numbers of trajectories (B, W), -1 where there is none; times and lengths of the steps
(B, W); coefficients (B, rows, D + 1, W). Only what lies between `since` and `until`, and before the trajectory's own
end in `cuts` (N,), counts. Each trajectory's numbers follow from its own steps alone, one after the other.
"""

from math import pi

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled, inlined

_EPS = 2.220446049250313e-16
_DEEPEST = 60  # halvings of a step
# of Gauss' quadrature in a step
_NODES, _WEIGHTS = (
    0.5 * (a + 1.0) if k == 0 else 0.5 * a for k, a in enumerate(np.polynomial.legendre.leggauss(10))
)
COUNT, FIRST, LAST, SUM, SQUARES, SHORTEST, LONGEST, SIGN = range(8)  # columns of what is kept of crossings


@inlined
def _value(c, s):
    total = c[c.size - 1]
    for j in range(c.size - 2, -1, -1):
        total = total * s + c[j]
    return total


@inlined
def _slope(c, s):
    total = 0.0
    for j in range(c.size - 1, 0, -1):
        total = total * s + j * c[j]
    return total


@compiled
def _bounds(c, h):
    """Bounds of |p'|, |p''| and |p'''| on [0, h]."""
    first, second, third = 0.0, 0.0, 0.0
    for j in range(c.size - 1, 0, -1):
        a = abs(c[j])
        first = first * h + j * a
        if j >= 2:
            second = second * h + j * (j - 1) * a
        if j >= 3:
            third = third * h + j * (j - 1) * (j - 2) * a
    return first, second, third


@compiled
def _zero_between(c, low, high, at_low, at_high):
    """The zero of a polynomial between two points of different sign, by secants and halving (Illinois)."""
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
        found = _value(c, s)
        if found == 0.0:
            return s
        if (found > 0.0) == (at_high > 0.0):
            high, at_high = s, found
            at_low *= 0.5
        else:
            low, at_low = s, found
            at_high *= 0.5
    return high


@compiled
def _top(d, low, high):
    """Where a slope d, positive at `low` and negative at `high`, is zero, to 1e-8 of the interval: the value there is
    then the largest to rounding. Newton's steps, halving where they leave the interval."""
    a, b = low, high
    s = 0.5 * (a + b)
    for _ in range(60):
        slope = _value(d, s)
        if slope > 0.0:
            a = s
        else:
            b = s
        bend = _slope(d, s)
        new = s - slope / bend if bend < 0.0 else 0.5 * (a + b)
        if not a <= new <= b:
            new = 0.5 * (a + b)
        if abs(new - s) <= 1e-8 * (high - low):
            return new
        s = new
    return s


@compiled
def _highest(c, d, stack, low, high, best, bound_2, bound_3):
    """The largest value of a polynomial on [low, high] if it exceeds `best`, else `best`. d, stack: room.

    Intervals that cannot hold a larger value are dropped, those with p'' of one sign give it at once, others are
    halved.
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    if _value(c, middle) + abs(_slope(c, middle)) * half + 0.5 * bound_2 * half * half <= best:
        return best
    for j in range(1, c.size):
        d[j - 1] = j * c[j]
    d[c.size - 1] = 0.0
    lows, highs = stack[0], stack[1]
    lows[0], highs[0] = low, high
    waiting = 1
    width = (high - low) * 1e-12
    while waiting > 0:
        waiting -= 1
        a, b = lows[waiting], highs[waiting]
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        value, slope = _value(c, middle), _value(d, middle)
        if value > best:
            best = value
        bend = _slope(d, middle)
        reach = abs(slope) * half + 0.5 * bound_2 * half * half
        if value + reach <= best + 2.0 * _EPS * abs(best) or b - a <= width:
            continue
        if abs(bend) > bound_3 * half:  # the slope rises or falls throughout
            at_a, at_b = _value(d, a), _value(d, b)
            if bend < 0.0 and at_a > 0.0 and at_b < 0.0:
                best = max(best, _value(c, _top(d, a, b)))
            else:
                best = max(best, _value(c, a), _value(c, b))
            continue
        if waiting + 2 > lows.size:
            continue
        lows[waiting], highs[waiting] = a, middle
        lows[waiting + 1], highs[waiting + 1] = middle, b
        waiting += 2
    return best


@compiled
def _spans(numbers, times, lengths, since, until, cuts, begins, ends):
    """What of a step counts in each lane: from begins to ends (W,) after its beginning; whether any lane has some."""
    some = False
    for lane in range(numbers.size):
        begins[lane], ends[lane] = 0.0, 0.0
        if numbers[lane] >= 0:
            t = times[lane]
            begin, end = max(0.0, since - t), min(lengths[lane], min(until, cuts[numbers[lane]]) - t)
            if begin < end:
                begins[lane], ends[lane], some = begin, end, True
    return some


# in the next two, four lanes go together in registers: what each does is the same as alone


@compiled
def _at(c, s, found):
    """Values of polynomials c (D + 1, W) at s (W,)."""
    top, width = c.shape[0] - 1, s.size
    whole = width - width % 4
    for lane in range(0, whole, 4):
        s_0, s_1, s_2, s_3 = s[lane], s[lane + 1], s[lane + 2], s[lane + 3]
        a_0, a_1, a_2, a_3 = c[top, lane], c[top, lane + 1], c[top, lane + 2], c[top, lane + 3]
        for j in range(top - 1, -1, -1):
            a_0, a_1 = a_0 * s_0 + c[j, lane], a_1 * s_1 + c[j, lane + 1]
            a_2, a_3 = a_2 * s_2 + c[j, lane + 2], a_3 * s_3 + c[j, lane + 3]
        found[lane], found[lane + 1], found[lane + 2], found[lane + 3] = a_0, a_1, a_2, a_3
    for lane in range(whole, width):
        a_0 = c[top, lane]
        for j in range(top - 1, -1, -1):
            a_0 = a_0 * s[lane] + c[j, lane]
        found[lane] = a_0


@compiled
def _reaches(c, h, up, down):
    """How far polynomials may rise above and fall below their first values on [0, h]: sums of the terms of one sign."""
    top, width = c.shape[0] - 1, h.size
    whole = width - width % 4
    for lane in range(0, whole, 4):
        h_0, h_1, h_2, h_3 = h[lane], h[lane + 1], h[lane + 2], h[lane + 3]
        a_0, a_1, a_2, a_3 = 0.0, 0.0, 0.0, 0.0
        b_0, b_1, b_2, b_3 = 0.0, 0.0, 0.0, 0.0
        for j in range(top, 0, -1):
            a_0, b_0 = (a_0 + max(c[j, lane], 0.0)) * h_0, (b_0 + min(c[j, lane], 0.0)) * h_0
            a_1, b_1 = (a_1 + max(c[j, lane + 1], 0.0)) * h_1, (b_1 + min(c[j, lane + 1], 0.0)) * h_1
            a_2, b_2 = (a_2 + max(c[j, lane + 2], 0.0)) * h_2, (b_2 + min(c[j, lane + 2], 0.0)) * h_2
            a_3, b_3 = (a_3 + max(c[j, lane + 3], 0.0)) * h_3, (b_3 + min(c[j, lane + 3], 0.0)) * h_3
        up[lane], up[lane + 1], up[lane + 2], up[lane + 3] = a_0, a_1, a_2, a_3
        down[lane], down[lane + 1], down[lane + 2], down[lane + 3] = b_0, b_1, b_2, b_3
    for lane in range(whole, width):
        a_0, b_0 = 0.0, 0.0
        for j in range(top, 0, -1):
            a_0, b_0 = (a_0 + max(c[j, lane], 0.0)) * h[lane], (b_0 + min(c[j, lane], 0.0)) * h[lane]
        up[lane], down[lane] = a_0, b_0


@compiled
def extremes(numbers, times, lengths, coefficients, rows, since, until, cuts, low, high):
    """The lowest and the highest values so far of some rows: low, high (N, k), infinite at first."""
    order, width = coefficients.shape[2], coefficients.shape[3]
    c, d, stack = np.empty(order), np.empty(order), np.empty((2, _DEEPEST + 2))
    begins, ends = np.empty(width), np.empty(width)
    up, down = np.empty(width), np.empty(width)
    for step in range(numbers.shape[0]):
        if not _spans(numbers[step], times[step], lengths[step], since, until, cuts, begins, ends):
            continue
        for k in range(rows.size):
            all_lanes = coefficients[step, rows[k]]
            _reaches(all_lanes, ends, up, down)
            for lane in range(width):
                end = ends[lane]
                if end == 0.0:
                    continue
                job, value = numbers[step, lane], all_lanes[0, lane]
                if value + up[lane] <= high[job, k] and value + down[lane] >= low[job, k]:
                    continue
                for j in range(order):
                    c[j] = all_lanes[j, lane]
                begin = begins[lane]
                at_begin, at_end = _value(c, begin), _value(c, end)
                low[job, k] = min(low[job, k], min(at_begin, at_end))
                high[job, k] = max(high[job, k], max(at_begin, at_end))
                above, below = value + up[lane] > high[job, k], value + down[lane] < low[job, k]
                if not above and not below:
                    continue
                first, second, third = _bounds(c, end)
                slope = abs(c[1])
                if first - slope < slope:  # it rises or falls throughout
                    continue
                if above:
                    high[job, k] = _highest(c, d, stack, begin, end, high[job, k], second, third)
                if below:
                    for j in range(order):
                        c[j] = -c[j]
                    low[job, k] = -_highest(c, d, stack, begin, end, -low[job, k], second, third)


@compiled
def integrals(numbers, times, lengths, coefficients, rows, since, until, cuts, squares, total, duration):
    """Integrals so far of some rows, and of their squares where asked: total (N, 2 k), duration (N,)."""
    order, width, many = coefficients.shape[2], coefficients.shape[3], rows.size
    shares = 1.0 / np.arange(1, order + 1)
    begins, ends = np.empty(width), np.empty(width)
    here, found, sums = np.empty(width), np.empty(width), np.empty(width)
    c = np.empty((order, width))
    for step in range(numbers.shape[0]):
        if not _spans(numbers[step], times[step], lengths[step], since, until, cuts, begins, ends):
            continue
        for lane in range(width):
            if ends[lane] > 0.0:
                duration[numbers[step, lane]] += ends[lane] - begins[lane]
        for k in range(many):
            all_lanes = coefficients[step, rows[k]]
            for j in range(order):
                for lane in range(width):
                    c[j, lane] = all_lanes[j, lane] * shares[j]
            _at(c, ends, found)
            _at(c, begins, here)
            for lane in range(width):
                if ends[lane] > 0.0:
                    total[numbers[step, lane], k] += found[lane] * ends[lane] - here[lane] * begins[lane]
            if squares:
                sums[:] = 0.0
                for g in range(_NODES.size):
                    for lane in range(width):
                        here[lane] = begins[lane] + (ends[lane] - begins[lane]) * _NODES[g]
                    _at(all_lanes, here, found)
                    for lane in range(width):
                        sums[lane] += _WEIGHTS[g] * found[lane] * found[lane]
                for lane in range(width):
                    if ends[lane] > 0.0:
                        total[numbers[step, lane], many + k] += (ends[lane] - begins[lane]) * sums[lane]


@compiled
def _crossings(c, stack, begin, end, sign, at, rising):
    """Where a polynomial changes its sign on [begin, end], in order; how many, and the sign at the end.

    sign: so far, 0 at the start of all. at, rising: filled. stack: room.
    """
    count = 0
    at_begin, at_end = _value(c, begin), _value(c, end)
    now = 1.0 if at_begin > 0.0 else -1.0
    if sign == 0.0:
        if at_begin == 0.0:  # it starts on the zero, which does not count
            now = 1.0 if _value(c, begin + 1e-6 * (end - begin)) > 0.0 else -1.0
        sign = now
    elif now != sign:  # at a joint, by rounding or where a driven parameter jumps
        at[0], rising[0] = begin, now > 0.0
        count, sign = 1, now
    first, second, _ = _bounds(c, end)
    lows, highs = stack[0], stack[1]
    lows[0], highs[0] = begin, end
    waiting = 1
    width = (end - begin) * 1e-11
    while waiting > 0:
        waiting -= 1
        a, b = lows[waiting], highs[waiting]
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        value = _value(c, middle)
        if abs(value) > first * half:
            now = 1.0 if value > 0.0 else -1.0
            if now != sign and count < at.size:
                at[count], rising[count] = a, now > 0.0
                count += 1
                sign = now
            continue
        small = b - a <= width or waiting + 2 > lows.size
        if abs(_slope(c, middle)) > second * half or small:
            at_b = at_end if b == end else _value(c, b)
            now = 1.0 if at_b > 0.0 else -1.0
            if now != sign and count < at.size:
                at_a = at_begin if a == begin else _value(c, a)
                s = a
                if (at_a > 0.0) != (at_b > 0.0):
                    s = _zero_between(c, a, b, at_a, at_b)
                at[count], rising[count] = s, now > 0.0
                count += 1
                sign = now
            continue
        lows[waiting], highs[waiting] = middle, b
        lows[waiting + 1], highs[waiting + 1] = a, middle
        waiting += 2
    return count, sign


@compiled
def sections(
    numbers, times, lengths, coefficients, weights, level, turning, direction, since, until, cuts, kept, ring_times,
    ring_states, low, high,
):  # fmt: skip
    """Crossings of a plane so far: sum of weights (rows,) times rows = level; where `turning`, zeros of its slope.

    direction: 1, -1, 0 both. kept (N, 8): COUNT ... SIGN; ring_times (N, K), ring_states (N, K, n): of the last K
    crossings, crossing number i in column i modulo K; low, high (N, n): of the states at the ends of steps.
    """
    order, n = coefficients.shape[2], ring_states.shape[2]
    g, c = np.empty(order), np.empty(order)
    at, rising, stack = np.empty(64), np.empty(64, dtype=np.bool_), np.empty((2, _DEEPEST + 2))
    for step in range(numbers.shape[0]):
        for lane in range(numbers.shape[1]):
            job = numbers[step, lane]
            if job < 0:
                continue
            t, h = times[step, lane], lengths[step, lane]
            begin, end = max(0.0, since - t), min(h, min(until, cuts[job]) - t)
            if not begin < end:
                continue
            for i in range(n):
                value = coefficients[step, i, 0, lane]
                low[job, i], high[job, i] = min(low[job, i], value), max(high[job, i], value)
            for j in range(order):
                g[j] = 0.0
            for i in range(weights.size):
                if weights[i] != 0.0:
                    for j in range(order):
                        g[j] += weights[i] * coefficients[step, i, j, lane]
            if turning:
                for j in range(1, order):
                    g[j - 1] = j * g[j]
                g[order - 1] = 0.0
            else:
                g[0] -= level
            own = kept[job]
            rest, power = 0.0, 1.0
            for j in range(1, order):
                power *= h
                rest += abs(g[j]) * power
            if own[SIGN] != 0.0 and rest < abs(g[0]) and (g[0] > 0.0) == (own[SIGN] > 0.0):
                continue
            count, own[SIGN] = _crossings(g, stack, begin, end, own[SIGN], at, rising)
            for i in range(count):
                if direction != 0 and rising[i] != (direction > 0):
                    continue
                now = t + at[i]
                if own[COUNT] == 0.0:
                    own[FIRST] = now
                else:
                    gap = now - own[LAST]
                    own[SUM] += gap
                    own[SQUARES] += gap * gap
                    own[SHORTEST], own[LONGEST] = min(own[SHORTEST], gap), max(own[LONGEST], gap)
                column = int(own[COUNT]) % ring_times.shape[1]
                own[LAST] = now
                own[COUNT] += 1.0
                ring_times[job, column] = now
                for row in range(n):
                    for j in range(order):
                        c[j] = coefficients[step, row, j, lane]
                    ring_states[job, column, row] = _value(c, at[i])


@compiled
def states_at(numbers, times, lengths, coefficients, rows, wanted, cuts, found):
    """The values of some rows at one time: found (N, k), filled by the step that holds it."""
    order = coefficients.shape[2]
    c = np.empty(order)
    for step in range(numbers.shape[0]):
        for lane in range(numbers.shape[1]):
            job = numbers[step, lane]
            if job < 0:
                continue
            s, h = wanted - times[step, lane], lengths[step, lane]
            # joints are known to rounding only
            if not -1e-9 * h <= s <= h * (1.0 + 1e-9) or wanted > cuts[job]:
                continue
            for k in range(rows.size):
                for j in range(order):
                    c[j] = coefficients[step, rows[k], j, lane]
                found[job, k] = _value(c, s)


@compiled
def margins(numbers, times, lengths, coefficients, rows, cuts, which, states):
    """Where a trajectory leaves what its model allows: the first zero of some rows that are positive before.

    Filled where one is found: cuts (N,), infinite before; which (N,), the number of the row; states (N, n) there.
    """
    order, n = coefficients.shape[2], states.shape[1]
    c = np.empty(order)
    at, rising, stack = np.empty(64), np.empty(64, dtype=np.bool_), np.empty((2, _DEEPEST + 2))
    for step in range(numbers.shape[0]):
        for lane in range(numbers.shape[1]):
            job = numbers[step, lane]
            if job < 0 or cuts[job] < np.inf:
                continue
            t, h = times[step, lane], lengths[step, lane]
            first = np.inf
            for k in range(rows.size):
                rest, power = 0.0, 1.0
                for j in range(order):
                    c[j] = coefficients[step, rows[k], j, lane]
                    if j > 0:
                        power *= h
                        rest += abs(c[j]) * power
                if c[0] > rest:
                    continue
                s = np.inf
                if c[0] < 0.0:
                    s = 0.0
                else:
                    count, _ = _crossings(c, stack, 0.0, h, 1.0, at, rising)
                    for i in range(count):
                        if not rising[i]:
                            s = at[i]
                            break
                if s < first:
                    first, which[job] = s, k
            if first < np.inf:
                cuts[job] = t + first
                for i in range(n):
                    for j in range(order):
                        c[j] = coefficients[step, i, j, lane]
                    states[job, i] = _value(c, first)


@compiled
def ranges(numbers, times, lengths, coefficients, rows, cuts, low, high):
    """The lowest and highest values of some rows at the beginnings of steps: a quick, rough range."""
    for step in range(numbers.shape[0]):
        for lane in range(numbers.shape[1]):
            job = numbers[step, lane]
            if job < 0 or times[step, lane] > cuts[job]:
                continue
            for k in range(rows.size):
                value = coefficients[step, rows[k], 0, lane]
                low[job, k], high[job, k] = min(low[job, k], value), max(high[job, k], value)


@compiled
def first_time(numbers, times, lengths, coefficients, row, level, way, since, until, cuts, found):
    """When a row first lies at or beyond a level: above it (way = 1) or below it (-1). found (N,), NaN before."""
    order = coefficients.shape[2]
    c = np.empty(order)
    at, rising, stack = np.empty(64), np.empty(64, dtype=np.bool_), np.empty((2, _DEEPEST + 2))
    for step in range(numbers.shape[0]):
        for lane in range(numbers.shape[1]):
            job = numbers[step, lane]
            if job < 0 or not np.isnan(found[job]):
                continue
            t, h = times[step, lane], lengths[step, lane]
            begin, end = max(0.0, since - t), min(h, min(until, cuts[job]) - t)
            if not begin < end:
                continue
            reach, power = 0.0, 1.0
            for j in range(order):
                c[j] = way * coefficients[step, row, j, lane]
                if j > 0:
                    power *= h
                    reach += abs(c[j]) * power
            c[0] -= way * level
            if c[0] + reach < 0.0:
                continue
            if _value(c, begin) >= 0.0:
                found[job] = t + begin
                continue
            count, _ = _crossings(c, stack, begin, end, -1.0, at, rising)
            if count > 0:
                found[job] = t + at[0]


@compiled
def recurrences(kept, ring_times, ring_states, units, whole, within, periods, gaps):
    """After how many crossings the last state comes back: periods (N,) and how far from it, in units, gaps (N,).

    units (N, n): of the states; whole (n,): those that count modulo a full turn; within: how near is back.
    """
    size, n = ring_times.shape[1], ring_states.shape[2]
    for job in range(kept.shape[0]):
        count = int(kept[job, COUNT])
        periods[job], gaps[job] = np.nan, np.nan
        last = (count - 1) % size
        for back in range(1, min(count, size)):
            before = (count - 1 - back) % size
            gap = 0.0
            for i in range(n):
                one = ring_states[job, last, i] - ring_states[job, before, i]
                if whole[i]:
                    one -= 2.0 * pi * np.round(one / (2.0 * pi))
                gap = max(gap, abs(one) / units[job, i])
            if not gaps[job] <= gap:
                gaps[job] = gap
            if gap <= within:
                periods[job] = ring_times[job, last] - ring_times[job, before]
                gaps[job] = gap
                break
