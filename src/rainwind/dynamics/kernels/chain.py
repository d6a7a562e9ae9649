"""The chain x_(j+1) = G_j x_j + g_j lambda + rho_j around an orbit, reduced to its two ends by reflections.

Products of the G_j lose everything below rounding of the largest; marching along the chain is unstable where solutions
both grow and decay. So the inner points are eliminated in pairs of equations by Householder reflections (Wright,
SIAM J. Sci. Stat. Comput. 13 (1992) 742: structured orthogonal factorisation), which leaves

    P x_0 + Q x_N = d lambda + e,                                                      (ends)
    R_j x_j = V_j x_0 + U_j x_(j+1) + d_j lambda + e_j,   j = N - 1 ... 1.             (tops)
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.linear import solve_many


@compiled
def reduce_chain(steps, n):
    """Reduce the chain whose columns G, g, rho are the last n rows of steps (N, m n, n + c).

    Returns ends (n, 2 n + c), columns P, Q, d, e; tops (N - 1, n, 3 n + c), columns R, V, U, d, e; reflections
    (N - 1, n, 2 n), each a vector v of I - v v'; the sign of the determinants.
    """
    many, size, width = steps.shape
    c = width - n
    tops = np.empty((many - 1, n, 3 * n + c))
    reflections = np.zeros((many - 1, n, 2 * n))
    # rows of two neighbours: columns x_j, x_0, x_(j+1), lambda, rhs
    a = np.zeros((2 * n, 3 * n + c))
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
        for k in range(n):
            total = 0.0
            for r in range(k, 2 * n):
                total += a[r, k] * a[r, k]
            length = np.sqrt(total)
            if length == 0.0:
                return np.full((n, 2 * n + c), np.nan), tops, reflections, 0.0
            alpha = -length if a[k, k] > 0.0 else length
            # v = (x - alpha e) / sqrt(alpha^2 - alpha x_k)
            scale = 1.0 / np.sqrt(alpha * alpha - alpha * a[k, k])
            for r in range(k, 2 * n):
                reflections[j - 1, k, r] = a[r, k] * scale
            reflections[j - 1, k, k] = (a[k, k] - alpha) * scale
            a[k, k] = alpha
            sign = (
                -sign if alpha > 0.0 else sign
            )  # a reflection turns the determinant; so does a negative alpha
            reflect(reflections[j - 1, k], a, k, k + 1, 3 * n + c)
        for r in range(n):
            for k in range(n):
                tops[j - 1, r, k] = a[r, k]
                tops[j - 1, r, n + k] = -a[r, n + k]
                tops[j - 1, r, 2 * n + k] = -a[r, 2 * n + k]
            for k in range(3 * n, 3 * n + c):
                tops[j - 1, r, k] = a[r, k]
            # the rows below carry on, with x_(j+1) in the place of x_j
            for k in range(n):
                a[r, k] = a[n + r, 2 * n + k]
                a[r, n + k] = a[n + r, n + k]
            for k in range(3 * n, 3 * n + c):
                a[r, k] = a[n + r, k]
    ends = np.empty((n, 2 * n + c))
    for r in range(n):
        for k in range(n):
            ends[r, k] = a[r, n + k]
            ends[r, n + k] = a[r, k]
        for k in range(c):
            ends[r, 2 * n + k] = a[r, 3 * n + k]
    return ends, tops, reflections, sign


@compiled
def reflect(v, a, first, start, stop):
    """Apply I - v v' to the columns start ... stop - 1 of a; v is zero before `first`."""
    for c in range(start, stop):
        total = 0.0
        for r in range(first, v.size):
            total += v[r] * a[r, c]
        for r in range(first, v.size):
            a[r, c] -= total * v[r]


@compiled
def reduce_right(reflections, last):
    """The columns e of the tops (N - 1, n, k) and of the ends (n, k) for other right-hand sides `last` (N, n, k)."""
    many, n, k = last.shape
    tops = np.empty((many - 1, n, k))
    a = np.empty((2 * n, k))
    a[:n] = last[0]
    for j in range(1, many):
        a[n:] = last[j]
        for i in range(n):
            reflect(reflections[j - 1, i], a, i, 0, k)
        tops[j - 1] = a[:n]
        a[:n] = a[n:]
    return tops, a[:n].copy()


@compiled
def multipliers_of_rows(reflections, ends):
    """The adjoint of the reduction: multipliers (N, n, k) of the chain's rows from those of the ends' rows (n, k)."""
    many, n = reflections.shape[0] + 1, reflections.shape[1]
    k = ends.shape[1]
    found = np.empty((many, n, k))
    a = np.zeros((2 * n, k))
    a[:n] = ends
    for j in range(many - 1, 0, -1):
        a[n:] = a[:n]
        a[:n] = 0.0
        for i in range(n - 1, -1, -1):
            reflect(reflections[j - 1, i], a, i, 0, k)
        found[j] = a[n:]
    found[0] = a[:n]
    return found


@compiled
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
                x[j, r, col] = right[j - 1, r, col]
            for i in range(c):
                factor = tops[j - 1, r, 3 * n + i]
                for col in range(k):
                    x[j, r, col] += factor * lam[i, col]
            for i in range(n):
                v, u = tops[j - 1, r, n + i], tops[j - 1, r, 2 * n + i]
                for col in range(k):
                    x[j, r, col] += v * first[i, col] + u * x[j + 1, i, col]
            for i in range(r + 1, n):
                factor = tops[j - 1, r, i]
                for col in range(k):
                    x[j, r, col] -= factor * x[j, i, col]
            for col in range(k):
                x[j, r, col] /= tops[j - 1, r, r]
    return x


@compiled
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
                x[row, r, col] = weight[col] * steps[j, i, width - 1]
            for s in range(n):
                factor = steps[j, i, s]
                for col in range(k):
                    x[row, r, col] += factor * mesh[j, s, col]
            for s in range(c):
                factor = steps[j, i, n + s]
                for col in range(k):
                    x[row, r, col] += factor * lam[s, col]
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
def solve_periodic(steps, rows, corner, right):
    """Solve the linearised orbit problem: chain, x_N = x_0, and c rows over all nodes and lambda (c,).

    steps (N, m n, n + c + 1) from `condense`; rows (c, (N m + 1) n); corner (c, c); right (c, k): the rows' right-hand
    sides, where the collocation equations' own (rho) belongs to the first column alone. Returns x (N m + 1, n, k),
    lambda (c, k), the sign of the determinant, and what `solve_periodic_again` and others go on with: ends, tops,
    reflections, the rows over mesh points and over lambda, the mesh points as functions of x_0 and lambda, the matrix.
    """
    many, width = steps.shape[0], steps.shape[2]
    c = right.shape[0]
    n = width - c - 1
    ends, tops, reflections, sign = reduce_chain(steps, n)
    over_mesh, over_rest = reduce_rows(rows, steps)
    first = np.zeros((n, n + c))
    lam = np.zeros((c, n + c))
    for i in range(n):
        first[i, i] = 1.0
    for i in range(c):
        lam[i, n + i] = 1.0
    y = mesh_points(tops, np.zeros((many - 1, n, n + c)), first, first, lam)
    a = np.zeros((n + c, n + c))
    for r in range(n):
        for i in range(n):
            a[r, i] = ends[r, i] + ends[r, n + i]
        for i in range(c):
            a[r, n + i] = -ends[r, 2 * n + i]
    for r in range(c):
        for j in range(many + 1):
            for s in range(n):
                factor = over_mesh[r, j, s]
                if factor != 0.0:
                    for i in range(n + c):
                        a[n + r, i] += factor * y[j, s, i]
        for i in range(c):
            a[n + r, n + i] += over_rest[r, i] + corner[r, i]
    inner = np.empty((many - 1, n, 1))
    for j in range(many - 1):
        for r in range(n):
            inner[j, r, 0] = tops[j, r, 3 * n + c]
    last = ends[:, 2 * n + c :].copy()
    x, found, its = _finish(steps, tops, over_mesh, over_rest, y, a, inner, last, right)
    return x, found, sign * its, (ends, tops, reflections, over_mesh, over_rest, y, a)


@compiled
def _finish(steps, tops, over_mesh, over_rest, y, a, inner, last, right):
    """The solution for one rho, in its reduced form: inner (N - 1, n, 1) for the tops, last (n, 1) for the ends."""
    many, n, c, k = steps.shape[0], y.shape[1], right.shape[0], right.shape[1]
    none = np.zeros((n, 1))
    own = mesh_points(tops, inner, none, none, np.zeros((c, 1)))
    b = np.zeros((n + c, k))
    for r in range(n):
        b[r, 0] = last[r, 0]
    for r in range(c):
        total = over_rest[r, c]
        for j in range(many + 1):
            for s in range(n):
                total += over_mesh[r, j, s] * own[j, s, 0]
        b[n + r, 0] = -total
        for col in range(k):
            b[n + r, col] += right[r, col]
    sign = solve_many(a.copy(), b)
    mesh = np.zeros((many + 1, n, k))
    for j in range(many + 1):
        for s in range(n):
            mesh[j, s, 0] = own[j, s, 0]
            for i in range(n + c):
                for col in range(k):
                    mesh[j, s, col] += y[j, s, i] * b[i, col]
    weight = np.zeros(k)
    weight[0] = 1.0
    return all_nodes(steps, mesh, b[n:], weight), b[n:].copy(), sign


@compiled
def solve_periodic_again(steps, rows, reduced, right):
    """The same equations with another rho (the last column of steps): reduced from `solve_periodic`."""
    _, tops, reflections, over_mesh, over_rest, y, a = reduced
    many, size, width = steps.shape
    n, c = y.shape[1], right.shape[0]
    m = size // n
    inner, last = reduce_right(reflections, np.ascontiguousarray(steps[:, size - n :, width - 1 :]))
    over_rest = over_rest.copy()
    for r in range(c):
        total = 0.0
        for j in range(many):
            for i in range(size - n):
                total += rows[r, (j * m + 1) * n + i] * steps[j, i, width - 1]
        over_rest[r, c] = total
    x, found, _ = _finish(steps, tops, over_mesh, over_rest, y, a, inner, last, right)
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
