"""The elimination inside intervals (`kernels/collocation.py`) for states whose rate is another state: x' = v.

In a mechanical system half of the equations say only that. With D, W without their first columns (the interval's first
node) called D_1, W_1, with B = D_1^-1 W_1, G = W_1 D_1^-1, and since D and W take constants to 0 and to constants,

    x_k = x_0 + h T (B v + D_1^-1 w_0 v_0)_k + h (D_1^-1 (v dT - F_x))_k,

so that only the other states' nodes are left for the elimination: half as many, an eighth of the work. F_x are the
collocation equations of x.
"""

import numpy as np

from rainwind.dynamics.kernels.collocation import eliminate
from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.linear import solve_many


@compiled
def rates_of(outputs):
    """The state that is the rate of each state (n,), -1 where it is none or is itself of that kind."""
    n = outputs.size
    found = np.full(n, -1, dtype=np.int64)
    for c in range(n):
        v = outputs[c]
        if v < n and outputs[v] >= n:
            found[c] = v
    return found


@compiled
def _constants(w, d):
    """D_1^-1, D_1^-1 W, W_1 D_1^-1, W_1 D_1^-1 W (m, .) and the sign of D_1's determinant."""
    m = w.shape[0]
    first, inverse = d[:, 1:].copy(), np.eye(m)
    sign = solve_many(first, inverse)
    integral, after = np.zeros((m, m + 1)), np.zeros((m, m))
    for i in range(m):
        for k in range(m):
            for j in range(m + 1):
                integral[i, j] += inverse[i, k] * w[k, j]
            for j in range(m):
                after[i, j] += w[i, k + 1] * inverse[k, j]
    twice = np.zeros((m, m + 1))
    for i in range(m):
        for k in range(m):
            for j in range(m + 1):
                twice[i, j] += w[i, k + 1] * integral[k, j]
    return inverse, integral, after, twice, sign


@compiled
def condense(rates, w, d, h, period, f, by, defect):
    """`kernels/collocation.py`'s steps (N, m n, n + 1 + q + 1), from its f, by and defects (N, m n).

    rates (n,) from `rates_of`. Returns steps, the factors and orders of the smaller elimination, the sign of the
    determinants.
    """
    m, n = w.shape[0], rates.size
    q, many = by.shape[2] - n, h.size
    width = n + 1 + q + 1
    inverse, integral, after, twice, sign_of_each = _constants(w, d)
    kept, held, place = _sorted(rates)
    left = kept.size
    size = m * left
    steps = np.empty((many, m * n, width))
    factors = np.empty((many, size, size))
    orders = np.empty((many, size), dtype=np.int64)
    a = np.empty((size, size + width))
    own, through = np.empty(
        (2, left, left)
    )  # derivatives by the states that are left: direct, and by what they move
    sign = 1.0
    for _ in range(held.size * many):
        sign *= sign_of_each
    # columns are counted without sign: an index that might be negative keeps the compiler from vector instructions
    first, last, wide = np.uint64(0), np.uint64(left), np.uint64(width)
    for j in range(many):
        _fill_right(held, kept, period, h[j], by, after, defect[j], j, a[:, size + width - 1])
        for i in range(m):
            point = j * m + i
            for r in range(left):
                for c in range(left):
                    own[r, c] = period * by[point, kept[r], kept[c]]
                    through[r, c] = 0.0
            for x in held:
                for r in range(left):
                    through[r, place[rates[x]]] += h[j] * period * period * by[point, kept[r], x]
            for k in range(m):
                direct, moved, slope = w[i, k + 1], twice[i, k + 1], d[i, k + 1] / h[j]
                for r in range(left):
                    for c in range(first, last):
                        a[i * left + r, k * left + c] = -direct * own[r, c] - moved * through[r, c]
                    a[i * left + r, k * left + r] += slope
            for r in range(left):
                row, state = i * left + r, kept[r]
                for c in range(left):
                    a[row, size + kept[c]] = w[i, 0] * own[r, c] + twice[i, 0] * through[r, c]
                a[row, size + state] -= d[i, 0] / h[j]
                a[row, size + n] = f[point, state]
                for x in held:
                    a[row, size + x] = period * by[point, state, x]
                    total = 0.0
                    for k in range(m):
                        total += after[i, k] * f[j * m + k, x]
                    a[row, size + n] += h[j] * period * by[point, state, x] * total
                for c in range(q):
                    a[row, size + n + 1 + c] = period * by[point, state, n + c]
        orders[j], its = eliminate(a)
        sign *= its
        factors[j] = a[:, :size]
        for i in range(m):
            for r in range(left):
                for c in range(first, wide):
                    steps[j, i * n + kept[r], c] = a[i * left + r, size + c]
            for x in held:
                row, v = i * n + x, place[rates[x]]
                for c in range(first, wide):
                    steps[j, row, c] = 0.0
                for k in range(m):
                    factor = h[j] * period * integral[i, k + 1]
                    for c in range(first, wide):
                        steps[j, row, c] += factor * a[k * left + v, size + c]
                steps[j, row, x] += 1.0
                steps[j, row, rates[x]] += h[j] * period * integral[i, 0]
                for k in range(m):
                    steps[j, row, n] += h[j] * inverse[i, k] * f[j * m + k, x]
                    steps[j, row, width - 1] -= h[j] * inverse[i, k] * defect[j, k * n + x]
    return steps, factors, orders, sign


@compiled
def _sorted(rates):
    """The states that are left, those held by their rates, and each one's place among those left."""
    kept = np.flatnonzero(rates < 0)
    place = np.zeros(rates.size, dtype=np.int64)
    for k in range(kept.size):
        place[kept[k]] = k
    return kept, np.flatnonzero(rates >= 0), place


@compiled
def _fill_right(held, kept, period, h, by, after, defect, j, right):
    """The right-hand side (m left,) of one interval's remaining equations, from all its defects (m n,)."""
    m, n, left = after.shape[0], held.size + kept.size, kept.size
    for i in range(m):
        for r in range(left):
            right[i * left + r] = -defect[i * n + kept[r]]
        for x in held:
            total = 0.0
            for k in range(m):
                total += after[i, k] * defect[k * n + x]
            for r in range(left):
                right[i * left + r] -= h * period * by[j * m + i, kept[r], x] * total


@compiled
def solve_again(rates, w, d, h, period, by, factors, orders, defect, steps):
    """Fill the last column of steps for other defects (N, m n), with the matrix that `condense` eliminated."""
    m, n = w.shape[0], rates.size
    many, size = orders.shape
    inverse, integral, after, _, _ = _constants(w, d)
    kept, held, place = _sorted(rates)
    left, last = kept.size, steps.shape[2] - 1
    right, found = np.empty(size), np.empty(size)
    for j in range(many):
        _fill_right(held, kept, period, h[j], by, after, defect[j], j, right)
        for i in range(size):
            total = right[orders[j, i]]
            for k in range(i):
                total -= factors[j, i, k] * found[k]
            found[i] = total
        for i in range(size - 1, -1, -1):
            total = found[i]
            for k in range(i + 1, size):
                total -= factors[j, i, k] * found[k]
            found[i] = total / factors[j, i, i]
        for i in range(m):
            for r in range(left):
                steps[j, i * n + kept[r], last] = found[i * left + r]
            for x in held:
                total = 0.0
                for k in range(m):
                    total += period * integral[i, k + 1] * found[k * left + place[rates[x]]]
                    total -= inverse[i, k] * defect[j, k * n + x]
                steps[j, i * n + x, last] = h[j] * total
