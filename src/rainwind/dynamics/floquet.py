"""Floquet multipliers of an orbit from its chain of transition matrices, the trivial one taken out."""

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics.kernels.collocation import deflated
from rainwind.dynamics.kernels.periodic_schur import log_multipliers

Complex = NDArray[np.complex128]


def nontrivial_exponents(steps: np.ndarray, flow: np.ndarray) -> Complex:
    """log mu of all multipliers but the trivial one (n - 1,), from steps (N, m n, .) and flow (N + 1, n).

    G_j carries the flow f_j into a multiple of f_(j + 1) but for the discretisation error, so that f may be divided
    out at every mesh point. What is left has no multiplier near 1 but where the orbit bifurcates, so that nothing is
    ill conditioned at a fold of cycles, where the trivial multiplier is double.
    """
    return log_multipliers(deflated(steps, flow))


def trivial_exponent(ends: np.ndarray, flow: np.ndarray) -> complex:
    """log of the multiplier nearest to 1, from P x_0 + Q x_N = 0 (n, 2 n + .) by inverse iteration from the flow (n,)."""
    n = len(flow)
    p, q = ends[:, :n], ends[:, n : 2 * n]
    x = flow / np.linalg.norm(flow)
    try:
        y = np.linalg.solve(p + q, q @ x)
    except np.linalg.LinAlgError:
        return 0j
    # (P + mu Q) x = 0 means (P + Q) x = (1 - mu) Q x
    return complex(np.log(1.0 - 1.0 / (x @ y) + 0j))


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
