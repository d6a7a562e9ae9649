"""Normal-form coefficients of folds and Hopf points (Kuznetsov, Elements of Applied Bifurcation Theory, ch. 5)."""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.jets import directional
from rainwind.dynamics.kernels.linear import product, solve_many, transposed_product
from rainwind.dynamics.kernels.tangents import second_orders


@compiled
def fold_coefficient(tape, at, v, w):
    """a = w'B(v, v) / 2 for unit vectors v, w (n,); and the product w'v, zero at Bogdanov-Takens.

    The usual normalisation w'v = 1 divides by that product; without it `a` stays finite along a fold curve.
    """
    operations, template, outputs = tape
    vectors = np.zeros((1, at.size))
    for i in range(v.size):
        vectors[0, i] = v[i]
    second = directional(operations, template, outputs, at, vectors, 2)
    a = dot = 0.0
    for i in range(v.size):
        a += 0.5 * w[i] * second[0, i]
        dot += w[i] * v[i]
    return a, dot


@compiled
def critical_vector(jacobian, omega, plane):
    """Re q and Im q (n, 2), |q| = 1, with J q = i omega q in the invariant plane (n, 2) of orthonormal columns."""
    m = transposed_product(plane, product(jacobian, plane))
    # (M - i omega) s = 0, from the row of larger size
    if m[0, 1] ** 2 + m[0, 0] ** 2 >= m[1, 0] ** 2 + m[1, 1] ** 2:
        re0, im0, re1, im1 = m[0, 1], 0.0, -m[0, 0], omega
    else:
        re0, im0, re1, im1 = -m[1, 1], omega, m[1, 0], 0.0
    q = np.empty((plane.shape[0], 2))
    length = 0.0
    for i in range(plane.shape[0]):
        q[i, 0] = plane[i, 0] * re0 + plane[i, 1] * re1
        q[i, 1] = plane[i, 0] * im0 + plane[i, 1] * im1
        length += q[i, 0] ** 2 + q[i, 1] ** 2
    return q / np.sqrt(length)


@compiled
def lyapunov_coefficient(tape, at, jacobian, omega, plane, left_plane):
    """The first Lyapunov coefficient l1 of a Hopf point, eq. (5.34) of Kuznetsov (3rd ed.), and det J.

    plane, left_plane (n, 2): orthonormal bases of the critical planes of J and J'. With |q| = 1 and p*q = 1,
    l1 = Re [p*C(q, q, q*) - 2 p*B(q, J^-1 B(q, q*)) + p*B(q*, (2 i omega - J)^-1 B(q, q))] / (2 omega).
    """
    operations, template, outputs = tape
    n = outputs.size
    states = np.arange(n)
    q = critical_vector(jacobian, omega, plane)
    transposed = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            transposed[i, j] = jacobian[j, i]
    p = critical_vector(transposed, -omega, left_plane)

    # B(a, .) and B(b, .) for q = a + i b
    vectors = np.zeros((4, at.size))
    for i in range(n):
        a, b = q[i, 0], q[i, 1]
        vectors[0, i], vectors[1, i], vectors[2, i], vectors[3, i] = a, b, a + b, a - b
    _, _, mixed = second_orders(operations, template, outputs, at, states, vectors[:2])
    by_a, by_b = mixed[0], mixed[1]
    b_a, b_b = product(by_a, q), product(by_b, q)  # columns B(a, a), B(a, b); B(b, a), B(b, b)

    h11 = np.empty((n, 1))
    h20 = np.zeros((2 * n, 1))
    big = np.zeros((2 * n, 2 * n))  # 2 i omega - J as a real matrix
    for i in range(n):
        h11[i, 0] = -(b_a[i, 0] + b_b[i, 1])
        h20[i, 0], h20[n + i, 0] = b_a[i, 0] - b_b[i, 1], 2.0 * b_a[i, 1]
        big[i, n + i], big[n + i, i] = -2.0 * omega, 2.0 * omega
        for j in range(n):
            big[i, j] = big[n + i, n + j] = -jacobian[i, j]
    matrix = jacobian.copy()
    determinant = solve_many(matrix, h11)
    for i in range(n):
        determinant *= abs(matrix[i, i])
    solve_many(big, h20)

    cubes = directional(operations, template, outputs, at, vectors, 3)

    overlap_re = overlap_im = total_re = total_im = 0.0  # p*q and p*(...)
    for i in range(n):
        aaa, bbb = cubes[0, i], cubes[1, i]
        abb = (cubes[2, i] + cubes[3, i] - 2.0 * aaa) / 6.0
        aab = (cubes[2, i] - cubes[3, i] - 2.0 * bbb) / 6.0
        re, im = aaa + abb, aab + bbb  # C(q, q, q*)
        for j in range(n):
            x, y = h20[j, 0], h20[n + j, 0]
            re += 2.0 * by_a[i, j] * h11[j, 0] + by_a[i, j] * x + by_b[i, j] * y
            im += 2.0 * by_b[i, j] * h11[j, 0] + by_a[i, j] * y - by_b[i, j] * x
        overlap_re += p[i, 0] * q[i, 0] + p[i, 1] * q[i, 1]
        overlap_im += p[i, 0] * q[i, 1] - p[i, 1] * q[i, 0]
        total_re += p[i, 0] * re + p[i, 1] * im
        total_im += p[i, 0] * im - p[i, 1] * re
    # with p scaled so that p*q = 1 the sum is divided by p*q
    size = overlap_re * overlap_re + overlap_im * overlap_im
    return (total_re * overlap_re + total_im * overlap_im) / size / (2.0 * omega), determinant
