"""The systems F(u) = 0 that define equilibria, folds, Hopf points and branch points, with their Jacobians.

The unknowns u are the n states, the q free parameters and, for a Hopf point, kappa = omega^2; for a branch
point, the unfolding b. Folds, Hopf and branch points are minimally augmented systems (Govaerts, Numerical
Methods for Bifurcations of Dynamical Equilibria, 2000, ch. 3-4): f and as many border scalars as conditions.

Borders are matrices of n rows: left and below of [[A, left], [below', 0]].
"""

import numpy as np
from numba import njit

from rainwind.dynamics.kernels.linear import solve_bordered, solve_many
from rainwind.dynamics.kernels.tangents import jacobian_at, second_order

EQUILIBRIUM = 0
FOLD = 1
HOPF = 2
BRANCH = 3


@njit(cache=True, nogil=True, error_model="numpy")
def squared(jacobian, kappa):
    """A = J^2 + kappa, which has a null space of dimension two at a Hopf point of omega^2 = kappa."""
    matrix = jacobian @ jacobian
    for k in range(matrix.shape[0]):
        matrix[k, k] += kappa
    return matrix


@njit(cache=True, nogil=True, error_model="numpy")
def hopf_weights(jacobian, x, y):
    """The (2, 4) weights that turn the block G into two well-scaled scalars.

    Near a Hopf point G = -Y'X (tr(M) M + (kappa - det M) I) with M the action of J on the span of X
    (Cayley-Hamilton), so G lies in the span of Y'XM = Y'JX and Y'X: the weights are the pseudo-inverse of these.
    This holds through a Bogdanov-Takens point too.
    """
    basis = np.empty((4, 2))
    left = np.ascontiguousarray(y.T)
    basis[:, 0] = (left @ (jacobian @ x)).reshape(4)
    basis[:, 1] = (left @ x).reshape(4)
    for k in range(2):
        basis[:, k] /= np.sqrt(np.sum(basis[:, k] ** 2))
    weights = np.ascontiguousarray(basis.T)
    solve_many(weights @ basis, weights)
    return weights


@njit(cache=True, nogil=True, error_model="numpy")
def equations(kind, tape, inputs, free, left, below, weights, u):
    """F (m,), its Jacobian by u (m, len(u)), and J (n, n), at u.

    inputs (states + parameters,) supplies the parameters that are not free; free (q,) are their numbers among
    the inputs. m is n for an equilibrium, n + 1 for a fold, n + 2 for Hopf and branch points.
    """
    operations, template, outputs = tape
    n, q = outputs.size, free.size
    at = inputs.copy()
    at[:n] = u[:n]
    for k in range(q):
        at[free[k]] = u[n + k]
    directions = np.empty(n + q, dtype=np.int64)
    directions[:n] = np.arange(n)
    directions[n:] = free

    f, d = jacobian_at(operations, template, outputs, at, directions)
    jacobian = np.ascontiguousarray(d[:, :n])
    extra = 0
    if kind == FOLD:
        extra = 1
    elif kind != EQUILIBRIUM:
        extra = 2
    big_f = np.empty(n + extra)
    big_d = np.zeros((n + extra, u.size))
    big_f[:n] = f
    big_d[:n, : n + q] = d
    along = np.zeros(at.size)

    if kind == FOLD:
        v, g = solve_bordered(jacobian, left, below, False)
        w, _ = solve_bordered(jacobian, left, below, True)
        along[:n] = v[:, 0]
        _, _, mixed = second_order(operations, template, outputs, at, directions, along)
        big_f[n] = g[0, 0]
        for k in range(n + q):
            for i in range(n):
                big_d[n, k] -= w[i, 0] * mixed[i, k]

    elif kind == HOPF:
        matrix = squared(jacobian, u[n + q])
        x, block = solve_bordered(matrix, left, below, False)
        y, _ = solve_bordered(matrix, left, below, True)
        yt = np.ascontiguousarray(y.T)
        ytj = yt @ jacobian
        jx = jacobian @ x
        slopes = np.empty((4, u.size))
        for j in range(2):
            along[:n] = x[:, j]
            _, _, by_x = second_order(operations, template, outputs, at, directions, along)
            along[:n] = jx[:, j]
            _, _, by_jx = second_order(operations, template, outputs, at, directions, along)
            change = yt @ by_jx + ytj @ by_x
            for i in range(2):
                slopes[2 * i + j, : n + q] = -change[i]
                slopes[2 * i + j, n + q] = -np.sum(y[:, i] * x[:, j])
        big_f[n:] = weights @ block.reshape(4)
        big_d[n:] = weights @ slopes

    elif kind == BRANCH:
        # [J, f_p] has n rows and n + 1 columns: one column of zeros beside it would do, so border it by hand:
        # left (n + 1, 1), of which n rows count, and below (n + 1, 2)
        matrix = np.zeros((n + 2, n + 2))
        matrix[:n, : n + 1] = d
        matrix[:n, n + 1] = left[:n, 0]
        for j in range(2):
            matrix[n + j, : n + 1] = below[:, j]
        transposed = np.ascontiguousarray(matrix.T)
        x = np.zeros((n + 2, 2))
        x[n, 0] = 1.0
        x[n + 1, 1] = 1.0
        solve_many(matrix, x)
        w = np.zeros((n + 2, 1))
        w[n + 1, 0] = 1.0
        solve_many(transposed, w)
        for i in range(n):
            big_f[i] += u[n + 1] * left[i, 0]
            big_d[i, n + 1] = left[i, 0]
        for j in range(2):
            big_f[n + j] = x[n + 1, j]
            along[:n] = x[:n, j]
            along[free[0]] = x[n, j]
            _, _, mixed = second_order(operations, template, outputs, at, directions, along)
            for k in range(n + 1):
                for i in range(n):
                    big_d[n + j, k] -= w[i, 0] * mixed[i, k]

    return big_f, big_d, jacobian
