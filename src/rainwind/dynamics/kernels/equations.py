"""The systems F(u) = 0 that define equilibria, folds, Hopf points and branch points, with their Jacobians.

The unknowns u are the n states, the q free parameters and, for a Hopf point, kappa = omega^2; for a branch
point, the unfolding b. Folds, Hopf and branch points are minimally augmented systems (Govaerts, Numerical
Methods for Bifurcations of Dynamical Equilibria, 2000, ch. 3-4): f and as many border scalars as conditions.

A border scalar g comes from [[A, left], [below', 0]] [X; g] = [0; I], and with Y from the transposed system its
derivatives are -Y' A_u X. A is J at a fold, J^2 + kappa at a Hopf point, [J, f_p] at a branch point.
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.linear import product, solve_bordered, solve_many, transposed_product
from rainwind.dynamics.kernels.tangents import jacobian_at, second_orders

EQUILIBRIUM = 0
FOLD = 1
HOPF = 2
BRANCH = 3


@compiled
def squared(jacobian, kappa):
    """A = J^2 + kappa, which has a null space of dimension two at a Hopf point of omega^2 = kappa."""
    matrix = product(jacobian, jacobian)
    for k in range(matrix.shape[0]):
        matrix[k, k] += kappa
    return matrix


@compiled
def hopf_weights(jacobian, x, y):
    """The (2, 4) weights that turn the block G into two well-scaled scalars.

    Near a Hopf point G = -Y'X (tr(M) M + (kappa - det M) I) with M the action of J on the span of X
    (Cayley-Hamilton), so G lies in the span of Y'XM = Y'JX and Y'X: the weights are the pseudo-inverse of these.
    This holds through a Bogdanov-Takens point too.
    """
    turned, plain = transposed_product(y, product(jacobian, x)), transposed_product(y, x)
    weights = np.empty((2, 4))
    lengths = np.zeros(2)
    for i in range(2):
        for j in range(2):
            weights[0, 2 * i + j], weights[1, 2 * i + j] = turned[i, j], plain[i, j]
            lengths[0] += turned[i, j] ** 2
            lengths[1] += plain[i, j] ** 2
    for k in range(4):
        weights[0, k] /= np.sqrt(lengths[0])
        weights[1, k] /= np.sqrt(lengths[1])
    gram = np.zeros((2, 2))
    for i in range(2):
        for j in range(2):
            for k in range(4):
                gram[i, j] += weights[i, k] * weights[j, k]
    solve_many(gram, weights)
    return weights


@compiled
def equations(kind, tape, inputs, free, left, below, weights, u):
    """F (m,), its Jacobian by u (m, len(u)), and J (n, n), at u.

    inputs (states + parameters,) supplies the parameters that are not free; free (q,) are their numbers among
    the inputs. m is n for an equilibrium, n + 1 for a fold, n + 2 for Hopf and branch points.
    """
    operations, template, outputs = tape
    n, q = outputs.size, free.size
    at = inputs.copy()
    directions = np.empty(n + q, dtype=np.int64)
    for i in range(n):
        at[i] = u[i]
        directions[i] = i
    for k in range(q):
        at[free[k]] = u[n + k]
        directions[n + k] = free[k]
    f, d = jacobian_at(operations, template, outputs, at, directions)
    jacobian = np.empty((n, n))
    extra = 0 if kind == EQUILIBRIUM else (1 if kind == FOLD else 2)
    big_f = np.zeros(n + extra)
    big_d = np.zeros((n + extra, u.size))
    for i in range(n):
        big_f[i] = f[i]
        for j in range(n + q):
            big_d[i, j] = d[i, j]
        for j in range(n):
            jacobian[i, j] = d[i, j]
    if kind == EQUILIBRIUM:
        return big_f, big_d, jacobian

    matrix = squared(jacobian, u[n + q]) if kind == HOPF else (jacobian if kind == FOLD else d)
    x, block = solve_bordered(matrix, left, below, False)
    y, _ = solve_bordered(matrix, left, below, True)
    if kind == BRANCH:
        for i in range(n):
            big_f[i] += u[n + 1] * left[i, 0]
            big_d[i, n + 1] = left[i, 0]
    jx = product(jacobian, x) if kind == HOPF else x
    pairs = x.shape[1]
    vectors = np.zeros((2 * pairs if kind == HOPF else pairs, at.size))
    for j in range(pairs):
        for i in range(x.shape[0]):
            vectors[j, directions[i]] = x[i, j]
            if kind == HOPF:
                vectors[pairs + j, i] = jx[i, j]
    _, _, mixed = second_orders(operations, template, outputs, at, directions, vectors)
    slopes = np.zeros((4, u.size))
    for j in range(pairs):
        if kind == HOPF:  # J_u J x + J J_u x
            change = product(jacobian, mixed[j])
            for k in range(n + q):
                for row in range(n):
                    for i in range(2):
                        slopes[2 * i + j, k] -= y[row, i] * (mixed[pairs + j, row, k] + change[row, k])
            for i in range(2):
                for row in range(n):
                    slopes[2 * i + j, n + q] -= y[row, i] * x[row, j]
        else:
            for k in range(n + q):
                for i in range(n):
                    slopes[j, k] -= y[i, 0] * mixed[j, i, k]
    for i in range(extra):
        if kind == HOPF:
            for k in range(4):
                big_f[n + i] += weights[i, k] * block[k // 2, k % 2]
                for j in range(u.size):
                    big_d[n + i, j] += weights[i, k] * slopes[k, j]
        else:
            big_f[n + i] = block[0, i]
            for j in range(u.size):
                big_d[n + i, j] = slopes[i, j]
    return big_f, big_d, jacobian
