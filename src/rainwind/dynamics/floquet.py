"""Floquet exponents log mu: in order from one orbit to the next."""

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]


def log_of_defect(defect: float) -> complex:
    """log mu from 1 - 1 / mu."""
    return complex(-np.log(1.0 - defect + 0j))


def matched(before: Complex, after: Complex) -> Complex:
    """Exponents (k,) in the order that follows `before`, nearest multipliers first: angles count round the circle."""
    real = before.real[:, None] - after.real
    angle = np.abs(before.imag[:, None] - after.imag)
    distance = real**2 + np.minimum(angle, 2.0 * np.pi - angle) ** 2
    order = np.empty_like(before)
    for _ in range(len(before)):
        i, j = np.unravel_index(np.argmin(distance), distance.shape)
        order[i] = after[j]
        distance[i, :] = distance[:, j] = np.inf
    return order
