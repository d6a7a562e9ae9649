"""What makes a computed trivial multiplier wrong: the mesh, or rounding that the orbit's own growth magnifies.

The flow f solves the linearised equations around the orbit, x_(j+1) = G_j x_j, but for defects d_j = f_(j+1)
- G_j f_j. With the left vectors w_j of the computed multiplier, w_(j-1) = G_j' w_j, all other terms cancel:

    1 - mu = sum over j of w_j . d_j / (w_0 . f_0).

d_j is what the mesh makes it, and never less than its own rounding, about eps (|G_j| |f_j| + |f_(j+1)|). The
same sum over that instead is the floor below which no mesh brings the error.
"""

import numpy as np

from rainwind.dynamics.kernels.chain import multipliers_of_rows, reduce_chain
from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.linear import solve_many

_EPS = 2.220446049250313e-16
_ITERATIONS = 3


@compiled
def flow_defects(steps, flow):
    """How far rounding may bring the trivial multiplier from 1, by the formula above.

    steps (N, m n, .) from `condense`, flow (N + 1, n) at the mesh points. Returns the floor of rounding, and
    |d_j| / |f_j| (N,): how much each G_j is known to be wrong.
    """
    many, size = steps.shape[0], steps.shape[1]
    n = flow.shape[1]
    ends, _, elimination, sign = reduce_chain(steps, n)
    wrong = np.zeros(many)
    if sign == 0.0:
        return np.inf, wrong
    carried = np.zeros(n)  # Q f_0
    matrix = np.empty((n, n))
    left = np.empty((n, 1))
    for r in range(n):
        for c in range(n):
            carried[r] += ends[r, n + c] * flow[0, c]
        left[r, 0] = carried[r]
    for _ in range(_ITERATIONS):
        right = np.zeros((n, 1))
        for r in range(n):
            for c in range(n):
                matrix[c, r] = ends[r, c] + ends[r, n + c]
                right[c, 0] += ends[r, n + c] * left[r, 0]
        if solve_many(matrix, right) == 0.0:
            return 0.0, wrong  # the flow closes to the last digit
        left = right / np.sqrt(np.sum(right * right))
    rows = multipliers_of_rows(elimination, left)
    floor = overlap = 0.0
    for r in range(n):
        overlap += left[r, 0] * carried[r]
    for j in range(many):
        after = flow[j + 1] if j + 1 < many else flow[0]
        terms = square = before = weight = 0.0
        for r in range(n):
            defect, extent = after[r], abs(after[r])
            for c in range(n):
                term = steps[j, size - n + r, c] * flow[j, c]
                defect -= term
                extent += abs(term)
            square += defect * defect
            terms += extent * extent
            before += flow[j, r] ** 2
            weight += rows[j, r, 0] ** 2
        floor += _EPS * np.sqrt(weight * terms)
        wrong[j] = np.sqrt(square / before) if before > 0.0 else np.inf
    if overlap == 0.0:
        return np.inf, wrong
    return floor / abs(overlap), wrong


@compiled
def magnified(factors, flow):
    """log of how much a disturbance across the orbit, as a share of |f|, is magnified before it decays.

    factors (N, n - 1, n - 1) from `deflated`, flow (N + 1, n). A disturbance is carried round the orbit till
    it lies in the direction that grows most. What grows over the whole period is followed backwards, as
    whoever solves a boundary value problem does.
    """
    many, n = factors.shape[0], factors.shape[1]
    x, y = np.ones(n), np.empty(n)
    logs = np.zeros(2 * many + 1)
    speed = np.empty(many + 1)
    for j in range(many + 1):
        speed[j] = 0.5 * np.log(np.sum(flow[j if j < many else 0] ** 2) + 1e-300)
    for lap in range(3):
        for j in range(many):
            length = 0.0
            for r in range(n):
                y[r] = 0.0
                for c in range(n):
                    y[r] += factors[j, r, c] * x[c]
                length += y[r] * y[r]
            length = np.sqrt(length)
            if not length > 0.0 or not np.isfinite(length):
                return np.inf
            x[:] = y / length
            if lap > 0:
                k = (lap - 1) * many + j
                logs[k + 1] = logs[k] + np.log(length) + speed[j] - speed[j + 1]
    up = down = 0.0
    lowest = highest = 0.0
    for k in range(1, 2 * many + 1):
        lowest, highest = min(lowest, logs[k]), max(highest, logs[k])
        up, down = max(up, logs[k] - lowest), max(down, highest - logs[k])
    return down if logs[2 * many] > 0.0 else up
