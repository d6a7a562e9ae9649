"""Small dense linear algebra inside kernels.

For ten unknowns a call of LAPACK costs more than the elimination itself, and it raises on a singular matrix; here
a singular matrix gives a determinant of sign 0 and an answer of infinities, which Newton takes as a failure.
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled


@compiled
def solve_many(matrix, right):
    """Solve matrix (k, k) x = right (k, r) by elimination with row pivoting; both are overwritten, right by x.

    Returns the sign of the determinant: 1, -1, or 0 for a singular matrix.
    """
    k, r = right.shape
    sign = 1.0
    for j in range(k):
        pivot = j
        for i in range(j + 1, k):
            if abs(matrix[i, j]) > abs(matrix[pivot, j]):
                pivot = i
        if matrix[pivot, j] == 0.0 or not np.isfinite(matrix[pivot, j]):
            right[:] = np.inf
            return 0.0
        if pivot != j:
            sign = -sign
            for c in range(j, k):
                matrix[j, c], matrix[pivot, c] = matrix[pivot, c], matrix[j, c]
            for c in range(r):
                right[j, c], right[pivot, c] = right[pivot, c], right[j, c]
        if matrix[j, j] < 0.0:
            sign = -sign
        inverse = 1.0 / matrix[j, j]
        for i in range(j + 1, k):
            factor = matrix[i, j] * inverse
            if factor != 0.0:
                for c in range(j + 1, k):
                    matrix[i, c] -= factor * matrix[j, c]
                for c in range(r):
                    right[i, c] -= factor * right[j, c]
    for j in range(k - 1, -1, -1):
        for c in range(r):
            total = right[j, c]
            for i in range(j + 1, k):
                total -= matrix[j, i] * right[i, c]
            right[j, c] = total / matrix[j, j]
    return sign


@compiled
def solve_bordered(corner, left, below, transpose):
    """Solve [[A, left], [below', 0]] X = [0; I] for A (n, m), left (n, .), below (m, .); or the transposed system.

    The whole matrix is square. Returns X (rows of A or, transposed, of A', then the border block), all of
    infinities where the matrix is singular.
    """
    n, m = corner.shape
    size = m + left.shape[1]
    matrix = np.zeros((size, size))
    for i in range(n):
        for j in range(m):
            matrix[i, j] = corner[i, j]
        for j in range(left.shape[1]):
            matrix[i, m + j] = left[i, j]
    for j in range(below.shape[1]):
        for i in range(m):
            matrix[n + j, i] = below[i, j]
    first = m
    if transpose:
        first = n
        for i in range(size):
            for j in range(i):
                matrix[i, j], matrix[j, i] = matrix[j, i], matrix[i, j]
    right = np.zeros((size, size - (m if transpose else n)))
    for j in range(right.shape[1]):
        right[(m if transpose else n) + j, j] = 1.0
    solve_many(matrix, right)
    return right[:first], right[first:]


@compiled
def product(a, b):
    """a b of small matrices (n, k), (k, m)."""
    n, m = a.shape[0], b.shape[1]
    out = np.zeros((n, m))
    for i in range(n):
        for k in range(b.shape[0]):
            factor = a[i, k]
            for j in range(m):
                out[i, j] += factor * b[k, j]
    return out


@compiled
def transposed_product(a, b):
    """a' b of small matrices (k, n), (k, m)."""
    n, m = a.shape[1], b.shape[1]
    out = np.zeros((n, m))
    for k in range(a.shape[0]):
        for i in range(n):
            for j in range(m):
                out[i, j] += a[k, i] * b[k, j]
    return out


@compiled
def orthonormal(x):
    """The two columns of x (n, 2) made orthonormal."""
    q = x.copy()
    n = x.shape[0]
    for j in range(2):
        overlap = 0.0
        for i in range(n):
            overlap += q[i, 0] * q[i, 1]
        length = 0.0
        for i in range(n):
            if j == 1:
                q[i, 1] -= overlap * q[i, 0]
            length += q[i, j] * q[i, j]
        length = np.sqrt(length)
        for i in range(n):
            q[i, j] /= length
    return q
