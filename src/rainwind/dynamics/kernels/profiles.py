"""Piecewise polynomials at any time, and the size of their next derivative."""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled


@compiled
def interpolated(mesh, nodes, barycentric, x, times):
    """A profile x (N m + 1, n) at times (k,): mesh (N + 1,); nodes, barycentric weights (m + 1,) -> (k, n)."""
    m, n = nodes.size - 1, x.shape[1]
    found = np.zeros((times.size, n))
    weights = np.empty(m + 1)
    for row in range(times.size):
        j = min(max(np.searchsorted(mesh, times[row], side="right") - 1, 0), mesh.size - 2)
        t = (times[row] - mesh[j]) / (mesh[j + 1] - mesh[j])
        total, hit = 0.0, -1
        for k in range(m + 1):
            if t == nodes[k]:
                hit = k
                break
            weights[k] = barycentric[k] / (t - nodes[k])
            total += weights[k]
        for k in range(m + 1):
            weight = (1.0 if k == hit else 0.0) if hit >= 0 else weights[k] / total
            if weight != 0.0:
                for c in range(n):
                    found[row, c] += weight * x[j * m + k, c]
    return found


@compiled
def next_derivative(top, h, x, scale):
    """The size (N,) of the derivative of order m + 1, from the differences of that of order m between neighbours.

    top (m + 1,): the derivative of order m of the polynomials on the unit interval; h (N,); x (N m + 1, n).
    """
    m, n, many = top.size - 1, x.shape[1], h.size
    highest = np.zeros((many, n))
    for j in range(many):
        factor = h[j] ** -m
        for k in range(m + 1):
            for c in range(n):
                highest[j, c] += factor * top[k] * x[j * m + k, c] / scale[c]
    jumps = np.empty(many)  # at the start of each interval, round the period
    for j in range(many):
        total = 0.0
        for c in range(n):
            total += (highest[j, c] - highest[j - 1, c]) ** 2
        jumps[j] = np.sqrt(total) / (0.5 * (h[j] + h[j - 1]))
    found = np.empty(many)
    for j in range(many):
        found[j] = 0.5 * (jumps[j] + jumps[(j + 1) % many])
    return found
