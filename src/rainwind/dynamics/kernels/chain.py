"""The chain x_(j+1) = G_j x_j + g_j lambda + rho_j around an orbit, reduced to its two ends by elimination.

Products of the G_j lose everything below rounding of the largest; marching along the chain is unstable where solutions
both grow and decay. So the inner points are eliminated from pairs of neighbours' equations, pivoting among the 2 n rows
of both (structured elimination; Wright, SIAM J. Sci. Stat. Comput. 13 (1992) 742), which leaves

    P x_0 + Q x_N = d lambda + e,                                                      (ends)
    R_j x_j = V_j x_0 + U_j x_(j+1) + d_j lambda + e_j,   j = N - 1 ... 1.             (tops)

Reflections instead of pivots would be stable for certain, and take three times as long. Pivoting can let rounding grow
along the chain (Wright, SIAM J. Sci. Comput. 14 (1993) 231, has an example): so who solves asks `chain_error`.
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled, quick
from rainwind.dynamics.kernels.linear import solve_many


@compiled
def reduce_chain(steps, n):
    """Reduce the chain whose columns G, g, rho are the last n rows of steps (N, m n, n + c).

    Returns ends (n, 2 n + c), columns P, Q, d, e; tops (N - 1, n, 3 n + c), columns R, V, U, d, e; the elimination:
    factors (N - 1, 2 n, n) of the rows of each pair and their orders (N - 1, 2 n); the sign of the determinants.
    """
    many, size, width = steps.shape
    c = width - n
    whole = 3 * n + c
    tops = np.empty((many - 1, n, whole))
    factors = np.zeros((many - 1, 2 * n, n))
    orders = np.zeros((many - 1, 2 * n), dtype=np.int64)  # in range even where the reduction ends early
    # rows of two neighbours: columns x_j, x_0, x_(j+1), lambda, rhs
    a = np.zeros((2 * n, whole))
    sign = 1.0
    for r in range(n):
        row = size - n + r
        for k in range(n):
            a[r, n + k] = -steps[0, row, k]
        a[r, r] = 1.0
        for k in range(c):
            a[r, 3 * n + k] = steps[0, row, n + k]
    for j in range(1, many):
        for r in range(n):
            row = size - n + r
            for k in range(n):
                a[r, 2 * n + k] = 0.0
                a[n + r, k] = -steps[j, row, k]
                a[n + r, n + k] = 0.0
                a[n + r, 2 * n + k] = 0.0
            a[n + r, 2 * n + r] = 1.0
            for k in range(c):
                a[n + r, 3 * n + k] = steps[j, row, n + k]
        sign *= _eliminate_pair(a, n, orders[j - 1])
        if sign == 0.0:
            return np.full((n, 2 * n + c), np.nan), tops, (factors, orders), 0.0
        for r in range(2 * n):
            for k in range(min(r, n)):
                factors[j - 1, r, k] = a[r, k]
        for r in range(n):
            for k in range(n):
                tops[j - 1, r, k] = a[r, k] if k >= r else 0.0
                tops[j - 1, r, n + k] = -a[r, n + k]
                tops[j - 1, r, 2 * n + k] = -a[r, 2 * n + k]
            for k in range(3 * n, whole):
                tops[j - 1, r, k] = a[r, k]
            # the rows below carry on, with x_(j+1) in the place of x_j
            for k in range(n):
                a[r, k] = a[n + r, 2 * n + k]
                a[r, n + k] = a[n + r, n + k]
            for k in range(3 * n, whole):
                a[r, k] = a[n + r, k]
    ends = np.empty((n, 2 * n + c))
    for r in range(n):
        for k in range(n):
            ends[r, k] = a[r, n + k]
            ends[r, n + k] = a[r, k]
        for k in range(c):
            ends[r, 2 * n + k] = a[r, 3 * n + k]
    return ends, tops, (factors, orders), sign


@compiled
def _eliminate_pair(a, n, order):
    """Eliminate the first n columns of a (2 n, .) in place, factors below the diagonal; the determinant's sign."""
    sign = 1.0
    whole = np.uint64(a.shape[1])  # without sign, as in `eliminate`
    for i in range(2 * n):
        order[i] = i
    for k in range(n):
        pivot, largest = k, abs(a[k, k])
        for i in range(k + 1, 2 * n):
            if abs(a[i, k]) > largest:
                pivot, largest = i, abs(a[i, k])
        if not largest > 0.0:
            return 0.0
        if pivot != k:
            sign = -sign
            order[k], order[pivot] = order[pivot], order[k]
            for col in range(whole):
                a[k, col], a[pivot, col] = a[pivot, col], a[k, col]
        if a[k, k] < 0.0:
            sign = -sign
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, 2 * n):
            factor = a[i, k] * inverse
            if factor != 0.0:
                a[i, k] = factor
                for col in range(np.uint64(k + 1), whole):
                    a[i, col] -= factor * a[k, col]
    return sign


@compiled
def reduce_right(elimination, last):
    """The columns e of the tops (N - 1, n, k) and of the ends (n, k) for other right-hand sides `last` (N, n, k)."""
    factors, orders = elimination
    many, n, k = last.shape
    tops = np.empty((many - 1, n, k))
    pair, a = np.empty((2, 2 * n, k))
    a[n:] = last[0]
    for j in range(1, many):
        pair[:n], pair[n:] = a[n:], last[j]
        for r in range(2 * n):
            for col in range(k):
                total = pair[orders[j - 1, r], col]
                for i in range(min(r, n)):
                    total -= factors[j - 1, r, i] * a[i, col]
                a[r, col] = total
        tops[j - 1] = a[:n]
    return tops, a[n:].copy()


@compiled
def multipliers_of_rows(elimination, ends):
    """The adjoint of the reduction: multipliers (N, n, k) of the chain's rows from those of the ends' rows (n, k)."""
    factors, orders = elimination
    n, k = ends.shape
    many = orders.shape[0] + 1
    found = np.empty((many, n, k))
    pair, a = np.empty((2, 2 * n, k))
    pair[:n] = ends
    for j in range(many - 1, 0, -1):
        a[:n], a[n:] = 0.0, pair[:n]
        for r in range(2 * n - 1, -1, -1):
            for i in range(min(r, n)):
                for col in range(k):
                    a[i, col] -= factors[j - 1, r, i] * a[r, col]
        for r in range(2 * n):
            pair[orders[j - 1, r]] = a[r]
        found[j] = pair[n:]
    found[0] = pair[:n]
    return found


@quick
def mesh_points(tops, right, first, last, lam):
    """x_j (N + 1, n, k) from the ends x_0 = first, x_N = last (n, k) and lambda (c, k).

    right (N - 1, n, k): the columns e of the tops, already in place of those stored there.
    """
    many, n = tops.shape[0] + 1, first.shape[0]
    c, k = lam.shape
    x = np.empty((many + 1, n, k))
    x[0], x[many] = first, last
    for j in range(many - 1, 0, -1):
        for r in range(n - 1, -1, -1):
            for col in range(k):
                fixed, total = right[j - 1, r, col], 0.0
                for i in range(c):
                    fixed += tops[j - 1, r, 3 * n + i] * lam[i, col]
                for i in range(n):
                    fixed += tops[j - 1, r, n + i] * first[i, col]
                for i in range(n):
                    total += tops[j - 1, r, 2 * n + i] * x[j + 1, i, col]
                for i in range(r + 1, n):
                    total -= tops[j - 1, r, i] * x[j, i, col]
                x[j, r, col] = (fixed + total) / tops[j - 1, r, r]
    return x


@quick
def all_nodes(steps, mesh, lam, weight):
    """x at all nodes (N m + 1, n, k) from mesh points (N + 1, n, k), lambda (c, k) and rho's weights (k,)."""
    many, size, width = steps.shape
    n, k = mesh.shape[1], mesh.shape[2]
    c = lam.shape[0]
    m = size // n
    x = np.empty((many * m + 1, n, k))
    x[0] = mesh[0]
    for j in range(many):
        for i in range(size - n):
            row, r = j * m + 1 + i // n, i % n
            for col in range(k):
                total = weight[col] * steps[j, i, width - 1]
                for s in range(n):
                    total += steps[j, i, s] * mesh[j, s, col]
                for s in range(c):
                    total += steps[j, i, n + s] * lam[s, col]
                x[row, r, col] = total
        x[(j + 1) * m] = mesh[j + 1]
    return x


@compiled
def reduce_rows(rows, steps):
    """Rows over all nodes (c, (N m + 1) n) condensed to rows over mesh points (c, N + 1, n), lambda and rho (c, .)."""
    many, size, width = steps.shape
    c = rows.shape[0]
    n = rows.shape[1] - many * size
    m = size // n
    over_mesh = np.zeros((c, many + 1, n))
    over_rest = np.zeros((c, width - n))
    for b in range(c):
        for j in range(many):
            for r in range(n):
                over_mesh[b, j, r] += rows[b, j * m * n + r]
            for i in range(size - n):
                factor = rows[b, (j * m + 1) * n + i]
                if factor != 0.0:
                    for s in range(n):
                        over_mesh[b, j, s] += factor * steps[j, i, s]
                    for s in range(width - n):
                        over_rest[b, s] += factor * steps[j, i, n + s]
        for r in range(n):
            over_mesh[b, many, r] += rows[b, many * m * n + r]
    return over_mesh, over_rest


@compiled
def _rows_over_ends(tops, over_mesh, over_rest):
    """Rows over mesh points (c, N + 1, n), lambda and rho (c, c + 1) without the inner points.

    Returns their multiples of the tops that do it (N - 1, c, n), and the rows over x_0, x_N, lambda, rho
    (c, 2 n + c + 1).
    """
    many, whole = tops.shape[0] + 1, tops.shape[2]
    c, n = over_mesh.shape[0], over_mesh.shape[2]
    multiples = np.empty((many - 1, c, n))
    row = np.empty(whole)  # columns x_j, x_0, x_(j+1), lambda, rho
    found = np.empty((c, whole - n))
    for b in range(c):
        for s in range(n):
            row[s], row[n + s] = over_mesh[b, many, s], over_mesh[b, 0, s]
            if many > 1:
                row[s] = over_mesh[b, 1, s]
        for s in range(whole - 3 * n):
            row[3 * n + s] = over_rest[b, s]
        for j in range(1, many):
            for s in range(n):
                row[2 * n + s] = over_mesh[b, j + 1, s]
            for i in range(n):
                multiple = row[i] / tops[j - 1, i, i]
                multiples[j - 1, b, i] = multiple
                for s in range(i + 1, n):
                    row[s] -= multiple * tops[j - 1, i, s]
                for s in range(n, whole):
                    row[s] += multiple * tops[j - 1, i, s]
            for s in range(n):
                row[s] = row[2 * n + s]
        for s in range(n):
            found[b, s], found[b, n + s] = row[n + s], row[s]
        for s in range(whole - 3 * n):
            found[b, 2 * n + s] = row[3 * n + s]
    return multiples, found


@compiled
def solve_periodic(steps, rows, corner, right):
    """Solve the linearised orbit problem: chain, x_N = x_0, and c rows over all nodes and lambda (c,).

    steps (N, m n, n + c + 1) from `condense`; rows (c, (N m + 1) n); corner (c, c); right (c, k): the rows' right-hand
    sides, where the collocation equations' own (rho) belongs to the first column alone. Returns x (N m + 1, n, k),
    lambda (c, k), the sign of the determinant, and what `solve_periodic_again` and others go on with: ends, tops,
    elimination, the rows' multiples of the tops, the matrix for x_0 and lambda.
    """
    many, width = steps.shape[0], steps.shape[2]
    c = right.shape[0]
    n = width - c - 1
    ends, tops, elimination, sign = reduce_chain(steps, n)
    over_mesh, over_rest = reduce_rows(rows, steps)
    multiples, over_ends = _rows_over_ends(tops, over_mesh, over_rest)
    a = np.empty((n + c, n + c))
    for r in range(n):
        for i in range(n):
            a[r, i] = ends[r, i] + ends[r, n + i]
        for i in range(c):
            a[r, n + i] = -ends[r, 2 * n + i]
    for r in range(c):
        for i in range(n):
            a[n + r, i] = over_ends[r, i] + over_ends[r, n + i]
        for i in range(c):
            a[n + r, n + i] = over_ends[r, 2 * n + i] + corner[r, i]
    inner = np.empty((many - 1, n, 1))
    for j in range(many - 1):
        for r in range(n):
            inner[j, r, 0] = tops[j, r, 3 * n + c]
    last = ends[:, 2 * n + c :].copy()
    x, found, its = _finish(steps, tops, a, inner, last, over_ends[:, 2 * n + c], right)
    return x, found, sign * its, (ends, tops, elimination, multiples, a)


@compiled
def _finish(steps, tops, a, inner, last, own, right):
    """The solution for one rho, in its reduced form: inner (N - 1, n, 1) for the tops, last (n, 1), own (c,) rows."""
    many, n, c, k = steps.shape[0], tops.shape[1], right.shape[0], right.shape[1]
    b = np.zeros((n + c, k))
    for r in range(n):
        b[r, 0] = last[r, 0]
    for r in range(c):
        b[n + r] = right[r]
        b[n + r, 0] -= own[r]
    sign = solve_many(a.copy(), b)
    above = np.zeros((many - 1, n, k))
    above[:, :, :1] = inner
    weight = np.zeros(k)
    weight[0] = 1.0
    mesh = mesh_points(tops, above, b[:n], b[:n], b[n:])
    return all_nodes(steps, mesh, b[n:], weight), b[n:].copy(), sign


@compiled
def solve_periodic_again(steps, rows, reduced, right):
    """The same equations with another rho (the last column of steps): reduced from `solve_periodic`."""
    _, tops, elimination, multiples, a = reduced
    many, size, width = steps.shape
    n, c = tops.shape[1], right.shape[0]
    m = size // n
    inner, last = reduce_right(elimination, np.ascontiguousarray(steps[:, size - n :, width - 1 :]))
    own = np.empty(c)
    for r in range(c):
        total = 0.0
        for j in range(many):
            for i in range(size - n):
                total += rows[r, (j * m + 1) * n + i] * steps[j, i, width - 1]
        for j in range(many - 1):
            for i in range(n):
                total += multiples[j, r, i] * inner[j, i, 0]
        own[r] = total
    x, found, _ = _finish(steps, tops, a, inner, last, own, right)
    return x, found


@compiled
def chain_error(steps, x, lam, n):
    """How badly a solution x (N m + 1, n, .) fails the chain in its first column, as a share of its own size."""
    many, size, width = steps.shape
    m = size // n
    worst, largest = 0.0, 0.0
    for j in range(many):
        for r in range(n):
            row = size - n + r
            total = x[(j + 1) * m, r, 0] - steps[j, row, width - 1]
            extent = abs(steps[j, row, width - 1]) + abs(x[(j + 1) * m, r, 0])
            for k in range(n):
                total -= steps[j, row, k] * x[j * m, k, 0]
                extent = max(extent, abs(steps[j, row, k] * x[j * m, k, 0]))
            for k in range(lam.shape[0]):
                total -= steps[j, row, n + k] * lam[k, 0]
                extent = max(extent, abs(steps[j, row, n + k] * lam[k, 0]))
            worst, largest = max(worst, abs(total)), max(largest, extent)
    return worst / largest if largest > 0.0 else 0.0
