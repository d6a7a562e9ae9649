"""Eigenvalues of small real matrices inside kernels: Hessenberg form, then Francis' double-shift QR.

Golub & Van Loan, Matrix Computations, 4th ed., section 7.5. LAPACK is not called here because numba reaches its real
solver only for real spectra; the complex one is three times slower and loses the exact pairing of conjugates.
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled

_EPS = 2.220446049250313e-16


@compiled
def _balance(a):
    """Scale rows and columns by powers of two until their norms are alike: similarity, exact in binary."""
    n = a.shape[0]
    settled = False
    while not settled:
        settled = True
        for i in range(n):
            row = column = 0.0
            for j in range(n):
                if j != i:
                    column += abs(a[j, i])
                    row += abs(a[i, j])
            if row == 0.0 or column == 0.0:
                continue
            factor, total = 1.0, row + column
            while column < row / 2.0:
                factor *= 2.0
                column *= 4.0
            while column > row * 2.0:
                factor *= 0.5
                column *= 0.25
            if (column + row) / factor < 0.95 * total:
                settled = False
                for j in range(n):
                    a[i, j] /= factor
                for j in range(n):
                    a[j, i] *= factor


@compiled
def _reflect(a, x, first, count, row_from, row_to, column_from, column_to):
    """Apply I - tau v v', which turns x (count,) into a multiple of e_1, from both sides of a."""
    rest = 0.0
    for k in range(1, count):
        rest += x[k] * x[k]
    if rest == 0.0:
        return
    alpha = np.sqrt(x[0] * x[0] + rest)
    if x[0] > 0.0:
        alpha = -alpha
    v0 = x[0] - alpha
    tau = -v0 / alpha
    for k in range(1, count):
        x[k] /= v0
    x[0] = 1.0
    for j in range(column_from, column_to):
        total = 0.0
        for k in range(count):
            total += x[k] * a[first + k, j]
        total *= tau
        for k in range(count):
            a[first + k, j] -= total * x[k]
    for i in range(row_from, row_to):
        total = 0.0
        for k in range(count):
            total += x[k] * a[i, first + k]
        total *= tau
        for k in range(count):
            a[i, first + k] -= total * x[k]


@compiled
def eigenvalues(matrix):
    """Eigenvalues of a real matrix (n, n) -> (n,) complex, in no particular order; NaN if QR does not converge."""
    n = matrix.shape[0]
    h = matrix.copy()
    found = np.full(n, complex(np.nan, np.nan))
    if not np.all(np.isfinite(h)):
        return found
    _balance(h)
    x = np.empty(n)
    for k in range(n - 2):
        for i in range(k + 1, n):
            x[i - k - 1] = h[i, k]
        _reflect(h, x, k + 1, n - k - 1, 0, n, k, n)
        for i in range(k + 2, n):
            h[i, k] = 0.0
    high, sweeps = n - 1, 0
    norm = np.sum(np.abs(h))
    while high >= 0:
        low = high
        while low > 0:
            size = abs(h[low - 1, low - 1]) + abs(h[low, low])
            if abs(h[low, low - 1]) <= _EPS * (size if size > 0.0 else norm):
                h[low, low - 1] = 0.0
                break
            low -= 1
        if low == high:
            found[high] = h[high, high]
            high, sweeps = high - 1, 0
            continue
        a, b, c, d = h[high - 1, high - 1], h[high - 1, high], h[high, high - 1], h[high, high]
        if low == high - 1:
            half = 0.5 * (a - d)
            square = half * half + b * c
            if square >= 0.0:
                z = half + (np.sqrt(square) if half >= 0.0 else -np.sqrt(square))
                found[high - 1] = d + z
                found[high] = d - b * c / z if z != 0.0 else d
            else:
                found[high - 1] = complex(d + half, np.sqrt(-square))
                found[high] = complex(d + half, -np.sqrt(-square))
            high, sweeps = high - 2, 0
            continue
        sweeps += 1
        if sweeps > 60:
            return np.full(n, complex(np.nan, np.nan))
        s, t = a + d, a * d - b * c
        if sweeps % 11 == 10:  # an exceptional shift breaks cycles
            w = abs(c) + abs(h[high - 1, high - 2])
            s, t = 1.5 * w, w * w
        hl, hn = h[low, low], h[low + 1, low + 1]
        x[0] = hl * hl + h[low, low + 1] * h[low + 1, low] - s * hl + t
        x[1] = h[low + 1, low] * (hl + hn - s)
        x[2] = h[low + 1, low] * h[low + 2, low + 1]
        for k in range(low, high):
            count = min(3, high - k + 1)
            _reflect(h, x, k, count, low, min(k + 4, high + 1), max(low, k - 1), high + 1)
            if k > low:
                for i in range(k + 1, k + count):
                    h[i, k - 1] = 0.0
            if k + 1 < high + 1:
                for i in range(min(3, high - k)):
                    x[i] = h[k + 1 + i, k]
    return found
