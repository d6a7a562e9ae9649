"""Newton's method for a periodic orbit of a branch, with its tangent and multipliers, in one compiled call."""

import numpy as np

from rainwind.dynamics.kernels import kinematic
from rainwind.dynamics.kernels.chain import chain_error, solve_periodic, solve_periodic_again
from rainwind.dynamics.kernels.collocation import (
    condense,
    defects,
    deflated,
    linearised,
    phase_row,
    residuals,
    solve_inside_once,
)
from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.linear import solve_many
from rainwind.dynamics.kernels.periodic_schur import log_multipliers
from rainwind.dynamics.kernels.values import values

POOR = -1  # instead of a number of iterations
_POOR_SOLUTION = 1e-6  # of the linear equations' error, as a share of their terms
_CHORD = 1e-2  # size of Newton's step below which the next one may use the same matrix


@compiled
def correct(tape, inputs, free, rule, h, u, tangent, scale, units, tolerance, limit):
    """The orbit in the hyperplane through u across the tangent (both (N,), the tangent in scaled unknowns).

    rule: Gauss weights, values w and slopes d of the basis; h: lengths of the intervals; units (n,) of the states.
    Returns iterations (0: not converged; POOR: the linear algebra failed), u, tangent, sign of the determinant, log mu
    without the trivial one, 1 - 1/mu of that one, the Liouville error of the others, the largest defect before the last
    step.
    """
    weights, w, d = rule
    m, n, q = w.shape[0], units.size, free.size
    size = (h.size * m + 1) * n
    count = 1 + q
    u = u.copy()
    rows, corner = np.zeros((2, size)), np.zeros((2, count))
    target = 0.0
    for k in range(u.size):
        target += tangent[k] / scale[k] * u[k]
        if k < size:
            rows[1, k] = tangent[k] / scale[k]
        else:
            corner[1, k - size] = tangent[k] / scale[k]
    rows[0] = reference_row(rule, h, u[:size], tangent * scale, scale, units)
    phase = np.dot(rows[0], u[:size])
    x = u[:size].reshape((-1, n))  # follows u
    before = np.inf
    change = np.inf
    last = False
    rates = kinematic.rates_of(tape[2])
    matrix = _matrix(tape, inputs, free, rates, w, d, h, x, u, size)
    steps, factors, orders, sign, by, period, residual = matrix
    fresh = True
    for iteration in range(limit):
        here = 0.0
        for k in range(u.size):
            here += tangent[k] / scale[k] * u[k]
        right = np.zeros((2, 2 if last else 1))
        right[1, -1] = 1.0  # the tangent
        right[0, 0], right[1, 0] = phase - np.dot(rows[0], u[:size]), target - here
        if iteration > 0:
            fresh = last or iteration > 2 or change > _CHORD
            if fresh:
                matrix = _matrix(tape, inputs, free, rates, w, d, h, x, u, size)
                steps, factors, orders, sign, by, period, residual = matrix
            else:  # near the orbit the matrix of the step before does
                defect = defects(tape, inputs, free, w, d, h, x, u[size], u[size + 1 :])
                if np.any(rates >= 0):
                    kinematic.solve_again(rates, w, d, h, period, by, factors, orders, defect, steps)
                else:
                    inside = np.empty_like(defect)
                    solve_inside_once(factors, orders, -defect, inside)
                    steps[:, :, steps.shape[2] - 1] = inside
        if sign == 0.0:
            return POOR, u, tangent, 0.0, np.empty(0, np.complex128), 0.0, 0.0, np.inf
        if fresh:
            profile, rest, its, reduced = solve_periodic(steps, rows, corner, right)
            if not chain_error(steps, profile, rest, n) < _POOR_SOLUTION:
                return POOR, u, tangent, 0.0, np.empty(0, np.complex128), 0.0, 0.0, np.inf
        else:
            profile, rest = solve_periodic_again(steps, rows, reduced, right)
        before, change = change, 0.0
        flat = profile.reshape((size, right.shape[1]))
        for k in range(u.size):
            step = flat[k, 0] if k < size else rest[k - size, 0]
            u[k] += step
            unit = units[k % n] if k < size else scale[k]
            change = max(change, abs(step) / (unit + abs(u[k])))
        if not np.isfinite(change):
            break
        if last:
            turned = np.empty(u.size)
            length = 0.0
            for k in range(u.size):
                turned[k] = (flat[k, 1] if k < size else rest[k - size, 1]) / scale[k]
                length += turned[k] * turned[k]
            turned /= np.sqrt(length)
            exponents, trivial, trace = _floquet(
                tape, inputs, free, w, weights, h, x, u, size, steps, by, reduced
            )
            return iteration, u, turned, sign * its, exponents, trivial, trace, residual
        # the error after this step, foretold from the sizes of two; one more step comes with the tangent
        last = change < tolerance or (iteration > 0 and change * (change / before) < 0.1 * tolerance)
    return 0, u, tangent, 0.0, np.empty(0, np.complex128), 0.0, 0.0, np.inf


@compiled
def reference_row(rule, h, profile, direction, scale, units):
    """The row of the phase condition at a profile; where that is a point, the branch's direction gives the slope."""
    weights, w, d = rule
    n = units.size
    x = profile.reshape((-1, n))
    largest = 0.0
    for c in range(n):
        largest = max(largest, (np.max(x[:, c]) - np.min(x[:, c])) / units[c])
    if largest < 1e-9:
        x = direction[: profile.size].copy().reshape((-1, n))
    row = phase_row(weights, w, d, h, x, units)
    total = 0.0
    for k in range(row.size):
        total += (row[k] * scale[k]) ** 2
    return row / np.sqrt(total)


@compiled
def _matrix(tape, inputs, free, rates, w, d, h, x, u, size):
    """Everything about the equations at u: steps, factors, orders, sign, derivatives, period, largest defect."""
    f, by = linearised(tape, inputs, free, w, x, u[size + 1 :])
    period = u[size]
    defect = residuals(d, h, x, period, f)
    if np.any(rates >= 0):
        steps, factors, orders, sign = kinematic.condense(rates, w, d, h, period, f, by, defect)
    else:
        steps, factors, orders, sign = condense(w, d, h, x, period, f, by)
    return steps, factors, orders, sign, by, period, np.max(np.abs(defect))


@compiled
def _floquet(tape, inputs, free, w, weights, h, x, u, size, steps, by, reduced):
    operations, template, outputs = tape
    m, n = w.shape[0], x.shape[1]
    at = np.empty((h.size + 1, inputs.size))
    for j in range(h.size + 1):
        at[j] = inputs
        for c in range(n):
            at[j, c] = x[j * m, c]
        for k in range(free.size):
            at[j, free[k]] = u[size + 1 + k]
    flow = values(operations, template, outputs, at)
    exponents = log_multipliers(deflated(steps, flow))
    trivial = trivial_defect(reduced[0], flow[0])
    integral = 0.0
    for j in range(h.size):
        for i in range(m):
            for c in range(n):
                integral += u[size] * h[j] * weights[i] * by[j * m + i, c, c]
    total = 0.0
    for k in range(n - 1):
        total += exponents[k].real
    return exponents, trivial, total - integral


@compiled
def trivial_defect(ends, flow):
    """1 - 1/mu of the multiplier nearest to 1, from P x_0 + Q x_N = 0 by inverse iteration from the flow (n,)."""
    n = flow.size
    matrix = np.empty((n, n))
    right = np.zeros((n, 1))
    length = np.sqrt(np.sum(flow * flow))
    for r in range(n):
        for c in range(n):
            matrix[r, c] = ends[r, c] + ends[r, n + c]
            right[r, 0] += ends[r, n + c] * flow[c] / length
    if solve_many(matrix, right) == 0.0:
        return 0.0
    # (P + mu Q) x = 0 means (P + Q) x = (1 - mu) Q x
    overlap = 0.0
    for c in range(n):
        overlap += flow[c] / length * right[c, 0]
    return 1.0 - 1.0 / (1.0 - 1.0 / overlap)
