"""Normal-form coefficients of a fold and of a Hopf point (Kuznetsov, Elements of Applied Bifurcation Theory, ch. 5)."""

import numpy as np
from numba import njit

from rainwind.dynamics.kernels.jets import directional
from rainwind.dynamics.kernels.tangents import second_order


@njit(cache=True, nogil=True, error_model="numpy")
def fold_coefficient(tape, at, v, w):
    """a = w'B(v, v) / 2 of z' = a z^2 for unit vectors v, w; and the product w'v, zero at Bogdanov-Takens.

    The usual normalisation w'v = 1 divides by that product; without it `a` stays finite along a fold curve.
    """
    operations, template, outputs = tape
    n = outputs.size
    v = v / np.sqrt(np.sum(v * v))
    w = w / np.sqrt(np.sum(w * w))
    vectors = np.zeros((1, at.size))
    vectors[0, :n] = v
    return 0.5 * np.sum(w * directional(operations, template, outputs, at, vectors, 2)[0]), np.sum(w * v)


@njit(cache=True, nogil=True, error_model="numpy")
def lyapunov_coefficient(tape, at, jacobian, omega, q):
    """The first Lyapunov coefficient l1 of a Hopf point, eq. (5.34) of Kuznetsov (3rd ed.).

    q (n,) complex, J q = i omega q, of unit length; the adjoint p has p*q = 1. l1 = Re(...) / (2 omega).
    """
    operations, template, outputs = tape
    n = outputs.size
    states = np.arange(n)
    identity = np.eye(n)
    # p: J' p = -i omega p, from the smallest singular direction by one bordered solve
    bordered = np.zeros((n + 1, n + 1), dtype=np.complex128)
    bordered[:n, :n] = jacobian.T + 1j * omega * identity
    bordered[:n, n] = q
    bordered[n, :n] = np.conj(q)
    unit = np.zeros(n + 1, dtype=np.complex128)
    unit[n] = 1.0
    p = np.linalg.solve(bordered, unit)[:n]
    p = p / np.conj(np.sum(np.conj(p) * q))

    along = np.zeros(at.size)
    along[:n] = q.real
    _, _, by_a = second_order(operations, template, outputs, at, states, along)
    along[:n] = q.imag
    _, _, by_b = second_order(operations, template, outputs, at, states, along)
    a, b = np.ascontiguousarray(q.real), np.ascontiguousarray(q.imag)
    baa, bab, bbb = by_a @ a, by_a @ b, by_b @ b
    h11 = -np.linalg.solve(jacobian, baa + bbb)
    h20 = np.linalg.solve(2j * omega * identity - jacobian, (baa - bbb) + 2j * bab)

    vectors = np.zeros((4, at.size))
    vectors[0, :n], vectors[1, :n], vectors[2, :n], vectors[3, :n] = a, b, a + b, a - b
    cubes = directional(operations, template, outputs, at, vectors, 3)
    aaa, bbb3 = cubes[0], cubes[1]
    abb = (cubes[2] + cubes[3] - 2.0 * aaa) / 6.0
    aab = (cubes[2] - cubes[3] - 2.0 * bbb3) / 6.0
    cubic = (aaa + abb) + 1j * (aab + bbb3)  # C(q, q, conj q)

    re, im = np.ascontiguousarray(h20.real), np.ascontiguousarray(h20.imag)
    q_h11 = by_a @ h11 + 1j * (by_b @ h11)  # B(q, h11)
    qbar_h20 = (by_a @ re + by_b @ im) + 1j * (by_a @ im - by_b @ re)  # B(conj q, h20)
    return np.sum(np.conj(p) * (cubic + 2.0 * q_h11 + qbar_h20)).real / (2.0 * omega)
