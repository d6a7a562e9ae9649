"""The pseudo-arclength walk, compiled: many points of a branch or curve in one call.

Borders are turned to the null vectors at every node, so that they never go stale.
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled, inlined
from rainwind.dynamics.kernels.equations import (
    EQUILIBRIUM,
    FOLD,
    HOPF,
    equations,
    hopf_weights,
    squared,
)
from rainwind.dynamics.kernels.forms import fold_coefficient, lyapunov_coefficient
from rainwind.dynamics.kernels.linear import orthonormal, solve_bordered, solve_many

GOING_ON, LEFT_WINDOW, STEP_TOO_SMALL = 0, 1, 2
# a step is repeated at half its length when the tangent turns by more than 32 degrees, or when the correction is
# longer than half the step: either may be a jump to another branch
MOST_TURN = 0.85
MOST_CORRECTION = 0.5


@compiled
def solve(kind, tape, inputs, free, left, below, weights, u, scale, tolerance, limit):
    """Newton on as many equations as unknowns. Returns converged, u, largest |F| there."""
    u = u.copy()
    right = np.empty((u.size, 1))
    converged = False
    for _ in range(limit):
        f, d, _ = equations(kind, tape, inputs, free, left, below, weights, u)
        residual = 0.0
        for i in range(u.size):
            residual = max(residual, abs(f[i]))
            right[i, 0] = -f[i]
            for j in range(u.size):
                d[i, j] *= scale[j]
        if converged:
            return True, u, residual
        if solve_many(d, right) == 0.0:
            # singular: only an exact root may stay where it is
            return residual == 0.0, u, residual
        size = 0.0
        for k in range(u.size):
            u[k] += right[k, 0] * scale[k]
            size = max(size, abs(right[k, 0]) / (1.0 + abs(u[k] / scale[k])))
        if not np.isfinite(size):
            break
        converged = size < tolerance
    return False, u, np.inf


@compiled
def correct(kind, tape, inputs, free, left, below, weights, u, tangent, scale, tolerance, limit, exact):
    """Newton in the hyperplane through u across `tangent`, then the tangent of the curve where it ends.

    u (N,) is the predicted point, tangent (N,) a unit vector in scaled unknowns u / scale. Returns iterations (0: not
    converged), u, tangent, sign of det [F_u; tangent], J (n, n). If `exact`, tangent and J belong to u itself; else
    to the last iterate but one, and Newton stops when the next correction, foretold from its quadratic convergence,
    is below the tolerance.
    """
    many = u.size
    u = u.copy()
    bordered = np.empty((many, many))
    right = np.empty((many, 2))  # the Newton step and the tangent in one elimination
    target = 0.0
    for k in range(many):
        target += tangent[k] * u[k] / scale[k]
    before = np.inf
    converged = False
    for iteration in range(limit):
        f, d, jacobian = equations(kind, tape, inputs, free, left, below, weights, u)
        here = 0.0
        for i in range(many):
            here += tangent[i] * u[i] / scale[i]
            for j in range(many):
                bordered[i, j] = d[i, j] * scale[j] if i < many - 1 else tangent[j]
            right[i, 0] = -f[i] if i < many - 1 else 0.0
            right[i, 1] = 0.0 if i < many - 1 else 1.0
        right[many - 1, 0] = target - here
        sign = solve_many(bordered, right)
        if sign == 0.0:
            break
        size = length = 0.0
        for k in range(many):
            u[k] += 0.0 if converged else right[k, 0] * scale[k]
            size = max(size, abs(right[k, 0]) / (1.0 + abs(u[k] / scale[k])))
            length += right[k, 1] ** 2
        if not np.isfinite(size):
            break
        foretold = size * (size / before) ** 2 if iteration > 0 and size < 0.01 else np.inf
        if converged or (not exact and (size < tolerance or foretold < 0.1 * tolerance)):
            return iteration + 1, u, right[:, 1] / np.sqrt(length), sign, jacobian
        converged = size < tolerance
        before = size
    return 0, u, tangent, 0.0, np.empty((0, 0))


@compiled
def null_borders(kind, u, jacobian, left, below):
    """Borders turned to the null vectors at u, and the weights that go with them."""
    matrix = squared(jacobian, u[u.size - 1]) if kind == HOPF else jacobian
    x, _ = solve_bordered(matrix, left, below, False)
    y, _ = solve_bordered(matrix, left, below, True)
    if kind == HOPF:
        x, y = orthonormal(x), orthonormal(y)
        return y, x, hopf_weights(jacobian, x, y)
    for vector in (x, y):
        length = 0.0
        for i in range(vector.shape[0]):
            length += vector[i, 0] ** 2
        for i in range(vector.shape[0]):
            vector[i, 0] /= np.sqrt(length)
    return y.copy(), x.copy(), np.zeros((2, 4))


@inlined
def _test_values(kind, tape, inputs, free, u, tangent, sign, jacobian, left, below):
    """Two values whose signs reveal special points.

    Equilibria: the parameter's share of the tangent (fold), det [F_u; tangent] (branch point). Folds: the quadratic
    coefficient (cusp), w'v (Bogdanov-Takens). Hopf points: kappa (Bogdanov-Takens), l1 det J (generalised Hopf; the
    determinant takes away the pole that l1 has where a zero eigenvalue joins).
    """
    n = tape[2].size
    first, second = tangent[n], sign
    if kind != EQUILIBRIUM:
        at = inputs.copy()
        at[:n] = u[:n]
        for k in range(free.size):
            at[free[k]] = u[n + k]
        if kind == FOLD:
            first, second = fold_coefficient(tape, at, below[:, 0], left[:, 0])
        else:
            first, second = u[u.size - 1], 0.0
            if first > 0.0:
                l1, determinant = lyapunov_coefficient(tape, at, jacobian, np.sqrt(first), below, left)
                second = l1 * determinant
    return first, second


@compiled
def next_step(step, iterations, cosine, largest):
    """The next step's length after a good step: longer where Newton was quick and the curve straight."""
    if iterations <= 3 and cosine > 0.98:
        step *= 1.5
    elif iterations > 5 or cosine < 0.93:
        step *= 0.6
    return min(step, largest)


@compiled
def march(
    kind, tape, inputs, free, left, below, weights, u, tangent, scale, lower, upper,
    step, largest, smallest, tolerance, limit, count,
):  # fmt: skip
    """Walk from the node (u, tangent) until a free parameter has left [lower, upper], or for `count` nodes.

    A step of zero corrects u itself, exactly, into one node. Returns status, number of nodes, and for each node: u,
    tangent, step, test values, left, below, weights; last the next step's length and the iterations of the last.
    """
    n = tape[2].size
    exact = step == 0.0
    us = np.empty((count, u.size))
    tangents = np.empty((count, u.size))
    steps = np.empty(count)
    values = np.empty((count, 2))
    lefts = np.empty((count, left.shape[0], left.shape[1]))
    belows = np.empty((count, below.shape[0], below.shape[1]))
    weightss = np.empty((count, 2, 4))
    status = GOING_ON
    done = 0
    iterations = 0
    predicted = np.empty(u.size)
    bend = np.zeros(u.size)  # the tangent's turn per length of the step before
    while done < count:
        for k in range(u.size):
            predicted[k] = u[k] + step * (tangent[k] + 0.5 * step * bend[k]) * scale[k]
        iterations, new, turned, sign, jacobian = correct(
            kind, tape, inputs, free, left, below, weights, predicted, tangent, scale, tolerance, limit, exact
        )
        cosine = correction = 0.0
        for k in range(u.size):
            cosine += turned[k] * tangent[k]
            correction += ((new[k] - predicted[k]) / scale[k]) ** 2
        good = iterations > 0
        if not exact:
            good = good and cosine >= MOST_TURN and np.sqrt(correction) <= MOST_CORRECTION * step
        if not good:
            step *= 0.5
            if exact or step < smallest:
                status = STEP_TOO_SMALL
                break
            continue
        for k in range(u.size):
            bend[k] = (turned[k] - tangent[k]) / step if step > 0.0 else 0.0
        u, tangent = new, turned
        if kind != EQUILIBRIUM:
            left, below, weights = null_borders(kind, u, jacobian, left, below)
        values[done] = _test_values(kind, tape, inputs, free, u, tangent, sign, jacobian, left, below)
        us[done], tangents[done], steps[done] = u, tangent, step
        lefts[done], belows[done], weightss[done] = left, below, weights
        done += 1
        outside = False
        for k in range(free.size):
            outside = outside or u[n + k] < lower[k] or u[n + k] > upper[k]
        if outside:
            status = LEFT_WINDOW
            break
        step = next_step(step, iterations, cosine, largest)
    return status, done, us, tangents, steps, values, lefts, belows, weightss, step, iterations
