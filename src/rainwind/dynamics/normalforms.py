"""Normal-form coefficients at special points: is the onset soft or hard?"""

from collections.abc import Mapping

import numpy as np

from rainwind.dynamics.kernels import forms as kernel
from rainwind.dynamics.kernels.linear import orthonormal
from rainwind.dynamics.system import System


def fold_coefficient(
    system: System, state: np.ndarray, parameters: Mapping[str, float]
) -> tuple[float, float, np.ndarray]:
    """a = w'B(v, v)/2 with unit null vectors v, w of J and J'; then w'v, and w (n,).

    Kuznetsov's coefficient (3rd ed., eq. 5.20, w'v = 1) is a / w'v: zero a is a cusp, zero w'v Bogdanov-Takens.
    """
    u, _, vt = np.linalg.svd(system.jacobian(state, parameters))
    w, v = np.ascontiguousarray(u[:, -1]), np.ascontiguousarray(vt[-1])
    a, product = kernel.fold_coefficient(system.tape.arrays, system.inputs(state, parameters), v, w)
    return float(a), float(product), w


def lyapunov_coefficient(
    system: System, state: np.ndarray, parameters: Mapping[str, float], omega: float
) -> float:
    """The first Lyapunov coefficient l1 of a Hopf point of frequency omega, in Kuznetsov's normalisation.

    Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., eq. (5.34), with |q| = 1. Negative: stable cycles
    are born (soft onset); positive: unstable ones (hard onset). The sign does not depend on the states' units, the
    size does. MatCont prints omega times it.
    """
    jacobian = system.jacobian(state, parameters)
    left_plane, plane = (critical_plane(matrix, omega) for matrix in (jacobian.T, jacobian))
    inputs = system.inputs(state, parameters)
    return float(
        kernel.lyapunov_coefficient(system.tape.arrays, inputs, jacobian, omega, plane, left_plane)[0]
    )


def critical_plane(jacobian: np.ndarray, omega: float) -> np.ndarray:
    """An orthonormal basis (n, 2) of the plane of the eigenvectors nearest to +- i omega."""
    values, vectors = np.linalg.eig(jacobian)
    q = vectors[:, np.argmin(np.abs(values - 1j * omega))]
    return orthonormal(np.column_stack([np.real(q), np.imag(q)]))
