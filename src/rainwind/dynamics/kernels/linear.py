"""Small dense linear systems inside kernels.

For ten unknowns a call of LAPACK costs more than the elimination itself, and it raises on a singular matrix; here
a singular matrix gives a determinant of sign 0 and an answer of infinities, which Newton takes as a failure.
"""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
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


@njit(cache=True, nogil=True, error_model="numpy")
def solve_bordered(corner, left, below, transpose):
    """Solve [[A, B], [C', 0]] X = [0; I] for A (n, n), B and C (n, r); or the transposed system.

    Returns X[:n] (n, r) and X[n:] (r, r); of all infinities where the matrix is singular.
    """
    n, r = left.shape
    matrix = np.zeros((n + r, n + r))
    for i in range(n):
        for j in range(n):
            matrix[i, j] = corner[j, i] if transpose else corner[i, j]
        for j in range(r):
            matrix[i, n + j] = below[i, j] if transpose else left[i, j]
            matrix[n + j, i] = left[i, j] if transpose else below[i, j]
    right = np.zeros((n + r, r))
    for j in range(r):
        right[n + j, j] = 1.0
    solve_many(matrix, right)
    return right[:n].copy(), right[n:].copy()
