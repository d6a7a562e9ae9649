"""Floquet multipliers of an orbit from its chain of transition matrices, the trivial one taken out."""

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]


def deflated(transitions: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """The transitions (N, n - 1, n - 1) of disturbances modulo the flow: transitions (N, n, n), flow (N + 1, n).

    A reflection turns the flow's direction into e_1 at every mesh point. G_j carries f_j into a multiple of f_(j+1) but
    for the discretisation error, so that the first column below the diagonal may be dropped. What is left has no
    multiplier near 1 but where the orbit bifurcates, so that nothing is ill conditioned at a fold of cycles.
    """
    e = flow / np.linalg.norm(flow, axis=1, keepdims=True)
    e[-1] = e[0]
    # reflections I - v v' / (1 + |e_1|) that carry e into -+ e_1
    sign = np.where(e[:, 0] >= 0.0, 1.0, -1.0)
    v = e.copy()
    v[:, 0] += sign
    weight = 1.0 / (1.0 + np.abs(e[:, 0]))
    right = transitions - np.einsum("j,jr,jc->jrc", weight[:-1], np.einsum("jrk,jk->jr", transitions, v[:-1]), v[:-1])
    left = right - np.einsum("j,jr,jc->jrc", weight[1:], v[1:], np.einsum("jk,jkc->jc", v[1:], right))
    return np.ascontiguousarray(left[:, 1:, 1:])


def trivial_exponent(exponents: Complex) -> complex:
    """Of log mu (n,) the one whose multiplier is nearest to 1."""
    return complex(exponents[np.argmin(np.abs(exponents))])


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
