"""Floquet exponents log mu, where the fast way to them gives up."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]

_PASSES = 24
_APART = 2.0  # of log|mu|: after all passes two vectors this far apart are separate to rounding


def by_orthogonal_iteration(factors: np.ndarray) -> Complex:
    """log mu of a product factors[-1] ... factors[0] (K, n, n), by falling modulus, where shifted QR did not converge.

    Unshifted QR passes through the factors part moduli that differ by more than a factor e^2; what lies closer together
    is a small block, whose own product loses little.
    """
    n = factors.shape[-1]
    q = start = np.eye(n)
    sums: np.ndarray = np.zeros(n)
    triangles: list[np.ndarray] = []
    for _ in range(_PASSES):
        start, sums, triangles = q, np.zeros(n), []
        for factor in factors:
            q, r = np.linalg.qr(factor @ q)
            triangles.append(r)
            sums += np.log(np.abs(np.diag(r)))
    turn = start.T @ q  # within blocks a rotation, between them zero
    ends = [0, *(np.flatnonzero(np.diff(sums) < -_APART) + 1).tolist(), n]
    found = []
    for first, last in pairwise(ends):
        block, size = np.eye(last - first), 0.0
        for r in triangles:
            block = r[first:last, first:last] @ block
            largest = float(np.max(np.abs(block)))
            block, size = block / largest, size + np.log(largest)
        found.append(np.log(np.linalg.eigvals(turn[first:last, first:last] @ block).astype(complex)) + size)
    exponents: Any = np.concatenate(found)
    exponents.imag[exponents.imag < -np.pi + 1e-14] = np.pi
    return exponents[np.lexsort((-exponents.imag, -exponents.real))]


def log_of_defect(defect: float) -> complex:
    """log mu from 1 - 1 / mu."""
    return complex(-np.log(1.0 - defect + 0j))
