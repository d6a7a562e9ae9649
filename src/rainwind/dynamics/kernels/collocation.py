"""Gauss collocation of x' = T f(x, p) on [0, 1], linearised and condensed interval by interval.

An interval of length h carries m + 1 nodes, the last of which is the first of the next interval, and m Gauss points.
With the basis' values W and slopes D (m, m + 1) at the Gauss points the equations are

    F_i = sum_k D_ik x_k / h - T f(sum_k W_ik x_k, p) = 0,   i = 1 ... m.

Newton's step in the nodes 1 ... m of an interval follows from that in its first node and in lambda = (T, p):
dx = S dx_0 + s dlambda + rho, from one dense elimination with pivoting (Ascher, Mattheij & Russell, Numerical Solution
of Boundary Value Problems, 1995, sec. 7.3; Doedel, Keller & Kernevez 1991). The last n rows of S carry a disturbance
over the interval: their product around the orbit is the monodromy matrix.
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled, quick
from rainwind.dynamics.kernels.tangents import jacobians
from rainwind.dynamics.kernels.values import values


@compiled
def gauss_inputs(inputs, free, w, x, p):
    """Inputs (N m, i) of a tape at all Gauss points: inputs (i,), w (m, m + 1), x (N m + 1, n), p (q,)."""
    m, n = w.shape[0], x.shape[1]
    many = (x.shape[0] - 1) // m
    at = np.empty((many * m, inputs.size))
    given = inputs.copy()
    for k in range(free.size):
        given[free[k]] = p[k]
    for j in range(many):
        for i in range(m):
            row = j * m + i
            for c in range(n, inputs.size):
                at[row, c] = given[c]
            for c in range(n):
                at[row, c] = 0.0
            for k in range(m + 1):
                for c in range(n):
                    at[row, c] += w[i, k] * x[j * m + k, c]
    return at


@compiled
def defects(tape, inputs, free, w, d, h, x, period, p):
    """The collocation equations F (N, m n): h (N,), x (N m + 1, n)."""
    operations, template, outputs = tape
    f = values(operations, template, outputs, gauss_inputs(inputs, free, w, x, p))
    return residuals(d, h, x, period, f)


@compiled
def residuals(d, h, x, period, f):
    """`defects` (N, m n) from f at the Gauss points (N m, n)."""
    m, n = d.shape[0], x.shape[1]
    found = np.empty((h.size, m * n))
    for j in range(h.size):
        for i in range(m):
            for c in range(n):
                found[j, i * n + c] = -period * f[j * m + i, c]
            for k in range(m + 1):
                slope = d[i, k] / h[j]
                for c in range(n):
                    found[j, i * n + c] += slope * x[j * m + k, c]
    return found


@compiled
def linearised(tape, inputs, free, w, x, p):
    """f (N m, n) and its derivatives by states and free parameters (N m, n, n + q) at all Gauss points."""
    operations, template, outputs = tape
    n = x.shape[1]
    directions = np.empty(n + free.size, dtype=np.int64)
    for k in range(n):
        directions[k] = k
    for k in range(free.size):
        directions[n + k] = free[k]
    return jacobians(operations, template, outputs, gauss_inputs(inputs, free, w, x, p), directions)


@compiled
def eliminate(a):
    """Gaussian elimination with row pivoting of a (k, k + r) in place: the solution takes the last r columns.

    The factors stay in the first k columns. Returns the rows' order (k,) and the sign of the determinant (0: singular).
    Four columns are eliminated before the rest of the rows is touched: memory traffic costs more than arithmetic.
    """
    k, width = a.shape
    # columns are counted without sign: an index that might be negative keeps the compiler from vector instructions
    order = np.arange(k)
    sign = 1.0
    for j in range(0, k, 4):
        end = min(j + 4, k)
        for col in range(j, end):
            pivot, largest = col, abs(a[col, col])
            for i in range(col + 1, k):
                if abs(a[i, col]) > largest:
                    pivot, largest = i, abs(a[i, col])
            if not largest > 0.0:
                a[:, k:] = np.nan
                return order, 0.0
            if pivot != col:
                sign = -sign
                order[col], order[pivot] = order[pivot], order[col]
                for c in range(np.uint64(width)):
                    a[col, c], a[pivot, c] = a[pivot, c], a[col, c]
            if a[col, col] < 0.0:
                sign = -sign
            inverse = 1.0 / a[col, col]
            for i in range(col + 1, k):
                factor = a[i, col] * inverse
                a[i, col] = factor
                for c in range(col + 1, end):
                    a[i, c] -= factor * a[col, c]
        for row in range(j + 1, end):
            for i in range(j, row):
                factor = a[row, i]
                for c in range(np.uint64(end), np.uint64(width)):
                    a[row, c] -= factor * a[i, c]
        if end < k:
            for i in range(end, k):
                f0, f1, f2, f3 = a[i, j], a[i, j + 1], a[i, j + 2], a[i, j + 3]
                for c in range(np.uint64(end), np.uint64(width)):
                    a[i, c] -= (f0 * a[j, c] + f1 * a[j + 1, c]) + (f2 * a[j + 2, c] + f3 * a[j + 3, c])
    for j in range(k - 1, -1, -1):
        i = j + 1
        while i + 3 < k:
            f0, f1, f2, f3 = a[j, i], a[j, i + 1], a[j, i + 2], a[j, i + 3]
            for c in range(np.uint64(k), np.uint64(width)):
                a[j, c] -= (f0 * a[i, c] + f1 * a[i + 1, c]) + (f2 * a[i + 2, c] + f3 * a[i + 3, c])
            i += 4
        while i < k:
            factor = a[j, i]
            for c in range(np.uint64(k), np.uint64(width)):
                a[j, c] -= factor * a[i, c]
            i += 1
        inverse = 1.0 / a[j, j]
        for c in range(np.uint64(k), np.uint64(width)):
            a[j, c] *= inverse
    return order, sign


@compiled
def condense(w, d, h, x, period, f, by):
    """Newton's step inside each interval from that at its first node and in lambda = (T, p).

    f (N m, n), by (N m, n, n + q) from `linearised`. Returns steps (N, m n, n + 1 + q + 1), the columns S, s and rho;
    the factors (N, m n, m n) and rows' orders (N, m n) for more right-hand sides; the sign of all determinants.
    """
    m, n = w.shape[0], x.shape[1]
    q = by.shape[2] - n
    size, many = m * n, h.size
    width = n + 1 + q + 1
    steps = np.empty((many, size, width))
    factors = np.empty((many, size, size))
    orders = np.empty((many, size), dtype=np.int64)
    defect = residuals(d, h, x, period, f)
    a = np.empty((size, size + width))
    sign = 1.0
    for j in range(many):
        for i in range(m):
            point = j * m + i
            for r in range(n):
                row = i * n + r
                for k in range(m + 1):
                    # the first node's block goes to the right-hand side
                    start = size if k == 0 else (k - 1) * n
                    turned = -1.0 if k == 0 else 1.0
                    weight = -turned * period * w[i, k]
                    for c in range(n):
                        a[row, start + c] = weight * by[point, r, c]
                    a[row, start + r] += turned * d[i, k] / h[j]
                a[row, size + n] = f[point, r]
                for c in range(q):
                    a[row, size + n + 1 + c] = period * by[point, r, n + c]
                a[row, size + width - 1] = -defect[j, row]
        orders[j], its = eliminate(a)
        sign *= its
        for row in range(size):
            for c in range(size):
                factors[j, row, c] = a[row, c]
            for c in range(width):
                steps[j, row, c] = a[row, size + c]
    return steps, factors, orders, sign


@compiled
def solve_inside(factors, orders, right, found):
    """Fill the columns found (N, m n, k) that solve an interval's equations for right (N, m n, k)."""
    many, size, columns = right.shape
    for j in range(many):
        for i in range(size):
            for c in range(columns):
                found[j, i, c] = right[j, orders[j, i], c]
            for k in range(i):
                factor = factors[j, i, k]
                for c in range(columns):
                    found[j, i, c] -= factor * found[j, k, c]
        for i in range(size - 1, -1, -1):
            for k in range(i + 1, size):
                factor = factors[j, i, k]
                for c in range(columns):
                    found[j, i, c] -= factor * found[j, k, c]
            for c in range(columns):
                found[j, i, c] /= factors[j, i, i]


@quick
def solve_inside_once(factors, orders, right, found):
    """`solve_inside` for one column: right, found (N, m n)."""
    many, size = right.shape
    for j in range(many):
        for i in range(size):
            total = right[j, orders[j, i]]
            for k in range(i):
                total -= factors[j, i, k] * found[j, k]
            found[j, i] = total
        for i in range(size - 1, -1, -1):
            total = found[j, i]
            for k in range(i + 1, size):
                total -= factors[j, i, k] * found[j, k]
            found[j, i] = total / factors[j, i, i]


@compiled
def solve_inside_transposed(factors, orders, right):
    """The solution (N, m n, k) of the transposed equations of each interval for right (N, m n, k)."""
    many, size, columns = right.shape
    found = np.empty((many, size, columns))
    x = np.empty((size, columns))
    for j in range(many):
        for i in range(size):
            for c in range(columns):
                x[i, c] = right[j, i, c]
        for i in range(size):
            for c in range(columns):
                x[i, c] /= factors[j, i, i]
            for k in range(i + 1, size):
                factor = factors[j, i, k]
                for c in range(columns):
                    x[k, c] -= factor * x[i, c]
        for i in range(size - 1, -1, -1):
            for k in range(i):
                factor = factors[j, i, k]
                for c in range(columns):
                    x[k, c] -= factor * x[i, c]
            for c in range(columns):
                found[j, orders[j, i], c] = x[i, c]
    return found


@compiled
def phase_row(weights, w, d, h, x, units):
    """The row (N m + 1) n of the integral of slope(x) times a disturbance, states in units (n,)."""
    m, n = w.shape[0], x.shape[1]
    row = np.zeros(x.size)
    slope = np.empty(n)
    for j in range(h.size):
        for i in range(m):
            slope[:] = 0.0
            for k in range(m + 1):
                for c in range(n):
                    slope[c] += d[i, k] * x[j * m + k, c]
            for c in range(n):
                slope[c] *= weights[i] / units[c] ** 2
            for k in range(m + 1):
                for c in range(n):
                    row[(j * m + k) * n + c] += w[i, k] * slope[c]
    return row


@compiled
def deflated(steps, flow):
    """Transitions modulo the flow: the last n rows of steps (N, m n, .), flow (N + 1, n) -> (N, n - 1, n - 1).

    A reflection turns the flow's direction into +-e_1 at every mesh point.
    """
    many, size = steps.shape[0], steps.shape[1]
    n = flow.shape[1]
    found = np.empty((many, n - 1, n - 1))
    v = np.empty((2, n))  # I - v v' at both ends of the interval
    a = np.empty((n, n))
    for j in range(many + 1):
        source = flow[j] if j < many else flow[0]
        length = np.sqrt(np.sum(source * source))
        sign = 1.0 if source[0] >= 0.0 else -1.0
        scale = 1.0 / np.sqrt(1.0 + abs(source[0]) / length)
        v[0] = v[1]
        for r in range(n):
            v[1, r] = scale * (source[r] / length + (sign if r == 0 else 0.0))
        if j == 0:
            continue
        for r in range(n):
            total = 0.0
            for c in range(n):
                total += steps[j - 1, size - n + r, c] * v[0, c]
            for c in range(n):
                a[r, c] = steps[j - 1, size - n + r, c] - total * v[0, c]
        for c in range(1, n):
            total = 0.0
            for r in range(n):
                total += v[1, r] * a[r, c]
            for r in range(1, n):
                found[j - 1, r - 1, c - 1] = a[r, c] - total * v[1, r]
    return found
