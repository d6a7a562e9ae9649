"""Higher derivatives of a tape at all Gauss points of an orbit: along vectors, or contracted with multipliers."""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.jets import directional
from rainwind.dynamics.kernels.tangents import second_orders


@compiled
def contracted(tape, points, free, phi, rest, psi, period):
    """psi_a' d(T J phi_b + f phi_T + T f_p phi_p) at all Gauss points: by states, and summed by period and parameters.

    points (P, i): inputs of the tape; phi (b, P, n); rest (b, 1 + q): phi_T, phi_p; psi (a, P, n). Returns
    by_state (a, b, P, n), by_period (a, b), by_parameter (a, b, q).
    """
    operations, template, outputs = tape
    many, n, q = points.shape[0], outputs.size, free.size
    directions = np.empty(n + q, dtype=np.int64)
    for k in range(n):
        directions[k] = k
    for k in range(q):
        directions[n + k] = free[k]
    by_state = np.zeros((psi.shape[0], phi.shape[0], many, n))
    by_period = np.zeros((psi.shape[0], phi.shape[0]))
    by_parameter = np.zeros((psi.shape[0], phi.shape[0], q))
    vectors = np.zeros((phi.shape[0], points.shape[1]))
    for point in range(many):
        for b in range(phi.shape[0]):
            for k in range(n):
                vectors[b, k] = phi[b, point, k]
            for k in range(q):
                vectors[b, free[k]] = rest[b, 1 + k]
        _, d, mixed = second_orders(operations, template, outputs, points[point], directions, vectors)
        for b in range(phi.shape[0]):
            for a in range(psi.shape[0]):
                for i in range(n):
                    weight = psi[a, point, i]
                    for k in range(n):
                        by_state[a, b, point, k] += weight * (period * mixed[b, i, k] + rest[b, 0] * d[i, k])
                        by_period[a, b] += weight * d[i, k] * phi[b, point, k]
                    for k in range(q):
                        by_parameter[a, b, k] += weight * (
                            period * mixed[b, i, n + k] + rest[b, 0] * d[i, n + k]
                        )
                        by_period[a, b] += weight * d[i, n + k] * rest[b, 1 + k]
    return by_state, by_period, by_parameter


@compiled
def second_along(tape, points, vectors):
    """The matrices B(v, .) (k, P, n, n) for vectors (k, P, n) at points (P, i)."""
    operations, template, outputs = tape
    k, many, n = vectors.shape
    states = np.arange(n)
    along = np.zeros((k, points.shape[1]))
    found = np.empty((k, many, n, n))
    for point in range(many):
        for row in range(k):
            along[row, :n] = vectors[row, point]
        _, _, mixed = second_orders(operations, template, outputs, points[point], states, along)
        for row in range(k):
            found[row, point] = mixed[row]
    return found


@compiled
def third_along(tape, points, vectors):
    """C(v, v, v) (k, P, n) for vectors (k, P, n) at points (P, i)."""
    operations, template, outputs = tape
    k, many, n = vectors.shape
    along = np.zeros((k, points.shape[1]))
    found = np.empty((k, many, n))
    for point in range(many):
        for row in range(k):
            along[row, :n] = vectors[row, point]
        found[:, point] = directional(operations, template, outputs, points[point], along, 3)
    return found
