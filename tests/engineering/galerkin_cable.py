"""A tensioned beam with sag by Legendre polynomials: an independent solution of the equation in `sag`."""

from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh


def wave_numbers(count, epsilon, lambda2=0.0, ends="clamped"):
    """w = omega L sqrt(m / T) of the first modes in plane, rising (count,).

    Stationary values of (epsilon |v''|² + |v'|² + lambda2 (mean of v)²) / |v|² over polynomials that vanish at the
    ends, with their slopes where clamped.
    """
    bending, tension, mean, mass = integrals(ends)
    stiff = epsilon * bending + tension + lambda2 * np.outer(mean, mean)
    scale = 1 / np.sqrt(np.diag(stiff))
    both = np.outer(scale, scale)
    # the largest 1 / w²: accurate although many digits of `mass` are lost to cancellation
    values = eigh(mass * both, stiff * both, eigvals_only=True)
    return 1 / np.sqrt(values[::-1][:count])


@lru_cache
def integrals(ends, degree=90):
    """Over xi from 0 to 1 of v'' v'', v' v', v and v v; x = 2 xi - 1 of the Legendre polynomials."""
    x, weight = legendre.leggauss(degree + 10)
    weight = weight / 2
    c = np.zeros((degree + 5, degree))
    for k in range(degree):
        if ends == "clamped":
            c[k, k], c[k + 2, k], c[k + 4, k] = 1, -2 * (2 * k + 5) / (2 * k + 7), (2 * k + 3) / (2 * k + 7)
        else:
            c[k, k], c[k + 2, k] = 1, -1
    v, dv, ddv = (legendre.legval(x, legendre.legder(c, i)) * 2**i for i in range(3))
    return (ddv * weight) @ ddv.T, (dv * weight) @ dv.T, v @ weight, (v * weight) @ v.T
