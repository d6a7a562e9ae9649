"""Floquet exponents from one orbit to the next."""

import math

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled


@compiled
def matched(before, after):
    """Exponents (k,) in the order that follows `before`, nearest multipliers first: angles count round the circle."""
    k = before.size
    distance = np.empty((k, k))
    for i in range(k):
        for j in range(k):
            angle = abs(before[i].imag - after[j].imag)
            angle = min(angle, 2.0 * math.pi - angle)
            distance[i, j] = (before[i].real - after[j].real) ** 2 + angle**2
    order = np.empty(k, np.complex128)
    placed, taken = np.zeros(k, np.bool_), np.zeros(k, np.bool_)
    for _ in range(k):
        best, row, column = np.inf, -1, -1
        for i in range(k):
            for j in range(k):
                # the first free pair, so that exponents that are no numbers find a place too
                if not (placed[i] or taken[j]) and (row < 0 or distance[i, j] < best):
                    best, row, column = distance[i, j], i, j
        order[row] = after[column]
        placed[row] = taken[column] = True
    return order
