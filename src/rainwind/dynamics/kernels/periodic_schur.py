"""Eigenvalues of a product of small matrices whose moduli may lie hundreds of decades apart, by periodic QR.

Bojanczyk, Golub & Van Dooren (1992), The periodic Schur decomposition; Kressner (2001), An efficient and reliable
implementation of the periodic QZ algorithm. The product is never formed. One pass of QR factorisations makes it
H R_K ... R_1 with H orthogonal and R_j triangular; Givens rotations carried once around all factors bring H to
Hessenberg form and then split it by Francis' double shifts, until what is left are 1x1 and 2x2 blocks. H stays
orthogonal: an entry of it is dropped when it is small against one, whatever the spans of the R_j.

The computed multipliers are those of factors changed by a few n GROUPED eps of their norms. They are as accurate as
the factors determine them: |change of log mu| <= sum over j of |change of A_j| / (|A_j x_j| |y_j x_j|) with x_j, y_j
the unit right and left eigenvectors before and after factor j.
"""

import math

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.linear import product, solve_many, transposed_product

_EPS = 2.220446049250313e-16
_LN2 = 0.6931471805599453
_SWEEPS = 100  # for one deflation; three are usual, thirty for twelve in one Jordan block
GROUPED = 1e2  # largest condition number of a product of neighbours to which one more factor is joined


@compiled
def _scale(a):
    """Bring the largest entry of a (n, n) to the order of one by a power of two if it is far from it; its exponent."""
    largest = 0.0
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            largest = max(largest, abs(a[i, j]))
    if largest == 0.0 or 1e-30 < largest < 1e30:
        return 0
    _, exponent = math.frexp(largest)
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            a[i, j] = math.ldexp(a[i, j], -exponent)
    return exponent


@compiled
def _norm(a):
    """Largest sum of a row's moduli."""
    largest = 0.0
    for i in range(a.shape[0]):
        total = 0.0
        for j in range(a.shape[1]):
            total += abs(a[i, j])
        largest = max(largest, total)
    return largest


@compiled
def _grouped(factors, limit):
    """Products of neighbours, as many as there are, and the exponent of two taken out of all.

    Joining A to a product P rounds A P by n eps |A| |P|, as if A had changed by n eps cond(P) of its norm. So it
    is P that must be well conditioned; neither A nor what they give has to be.
    """
    n = factors.shape[1]
    out = np.empty_like(factors)
    matrix, inverse = np.empty((n, n)), np.empty((n, n))
    count, exponent, joins = 0, 0, False
    for factor in factors:
        a = factor.copy()
        exponent += _scale(a)
        if joins:
            a = product(a, out[count - 1])
            exponent += _scale(a)
        else:
            count += 1
        out[count - 1] = a
        matrix[:] = a
        inverse[:] = 0.0
        for i in range(n):
            inverse[i, i] = 1.0
        solve_many(matrix, inverse)
        joins = _norm(a) * _norm(inverse) <= limit
    return out[:count], exponent


@compiled
def _triangularise(b, floor, q):
    """b (m, w) = q r by reflections: returns its rank, puts r into b and orthonormal columns into q.

    A column whose part outside the columns before it is below its floor counts as dependent on them; r is of use
    only if there is none.
    """
    m, width = b.shape
    rank = 0
    tau, column = np.empty(width), np.empty(width, dtype=np.int64)
    for j in range(width):
        largest = square = 0.0
        for i in range(rank, m):
            largest = max(largest, abs(b[i, j]))
        if largest < 1e-300:
            continue
        for i in range(rank, m):
            square += (b[i, j] / largest) ** 2
        length = largest * np.sqrt(square)
        if length <= floor[j]:
            continue
        alpha = -length if b[rank, j] > 0.0 else length
        v0 = b[rank, j] - alpha
        tau[rank], column[rank] = -v0 / alpha, j
        for i in range(rank + 1, m):
            b[i, j] /= v0
        b[rank, j] = alpha
        for k in range(j + 1, width):
            total = b[rank, k]
            for i in range(rank + 1, m):
                total += b[i, j] * b[i, k]
            total *= tau[rank]
            b[rank, k] -= total
            for i in range(rank + 1, m):
                b[i, k] -= total * b[i, j]
        rank += 1
    for k in range(rank):
        q[k, k] = 1.0
    for k in range(rank - 1, -1, -1):
        j = column[k]
        for c in range(k, rank):
            total = q[k, c]
            for i in range(k + 1, m):
                total += b[i, j] * q[i, c]
            total *= tau[k]
            q[k, c] -= total
            for i in range(k + 1, m):
                q[i, c] -= total * b[i, j]
        for i in range(k + 1, m):
            b[i, j] = 0.0
    return rank


@compiled
def _triangular(factors):
    """H and R_1 ... R_K: H orthogonal, R_j regular and triangular, with all multipliers but those that are zero.

    Where the range of a factor (times those before it) has fewer dimensions, the pass starts again behind that
    factor, within its range: A = U U'A, and U (U'A ...) has the same multipliers as (U'A ...) U, but for zeros.
    """
    count, n = factors.shape[:2]
    r = np.zeros(factors.shape)
    start, done, width = 0, 0, n
    base = np.eye(n)
    w = base
    floor = np.empty(n)
    while done < count and width > 0:
        a = factors[(start + done) % count]
        b = product(a, w)
        floor[:] = 0.0
        for k in range(n):
            total = 0.0
            for i in range(n):
                total += abs(a[i, k])
            for j in range(width):
                floor[j] += 16.0 * _EPS * total * abs(w[k, j])
        last = done == count - 1
        if last:
            b = transposed_product(base, b)
        q = np.zeros(b.shape)
        rank = _triangularise(b, floor, q)
        if rank < width:
            base = product(base, q[:, :rank]) if last else q[:, :rank].copy()
            start, done, width, w = (start + done + 1) % count, 0, rank, base
            continue
        for i in range(width):
            for j in range(i, width):
                r[done, i, j] = b[i, j]
        w = q
        done += 1
    return w, r[:, :width, :width].copy()


@compiled
def _rotation(x, y):
    """c, s and the length with c x + s y = length, c y - s x = 0."""
    if y == 0.0:
        return 1.0, 0.0, x
    square = x * x + y * y
    if square > 1e-280:
        length = np.sqrt(square)
        return x / length, y / length, length
    largest = max(abs(x), abs(y))
    u, v = x / largest, y / largest
    length = np.sqrt(u * u + v * v)
    return u / length, v / length, largest * length


@compiled
def _carry(h, r, i, c, s, low, high):
    """Similarity by the rotation of rows i, i + 1: through all factors, each left triangular, and into h again."""
    for j in range(low, high + 1):
        x, y = h[i, j], h[i + 1, j]
        h[i, j], h[i + 1, j] = c * x + s * y, c * y - s * x
    for k in range(r.shape[0]):
        a = r[k]
        for j in range(low, i + 1):
            x, y = a[j, i], a[j, i + 1]
            a[j, i], a[j, i + 1] = c * x + s * y, c * y - s * x
        x, y = a[i, i], s * a[i + 1, i + 1]
        a[i + 1, i + 1] *= c
        c, s, a[i, i] = _rotation(x, y)
        for j in range(i + 1, high + 1):
            x, y = a[i, j], a[i + 1, j]
            a[i, j], a[i + 1, j] = c * x + s * y, c * y - s * x
    for j in range(low, high + 1):
        x, y = h[j, i], h[j, i + 1]
        h[j, i], h[j, i + 1] = c * x + s * y, c * y - s * x


@compiled
def _eliminate(h, r, i, j, low, high):
    """Make h[i + 1, j] zero by the rotation with the row above."""
    if h[i + 1, j] != 0.0:
        c, s, length = _rotation(h[i, j], h[i + 1, j])
        _carry(h, r, i, c, s, low, high)
        h[i, j], h[i + 1, j] = length, 0.0


@compiled
def _corner(r, k):
    """a, b, d and the exponent e: (a, b; 0, d) 2^e are rows and columns k, k + 1 of R_K ... R_1.

    a, b, d are those of R_j changed by a few K eps, entry by entry: the first R's own a and the last one's d
    stand in no other entry of the product, and the rest is a sum over the b of each R.
    """
    a, b, d, e = 1.0, 0.0, 1.0, 0
    for j in range(r.shape[0]):
        b = r[j, k, k] * b + r[j, k, k + 1] * d
        a *= r[j, k, k]
        d *= r[j, k + 1, k + 1]
        a, b, d, e = _rescale(a, b, d, e)
    return a, b, d, e


@compiled
def _rescale(a, b, d, e):
    """The same numbers with the largest between 1e-60 and 1e60."""
    largest = max(abs(a), abs(b), abs(d))
    if 1e-60 < largest < 1e60 or largest == 0.0:
        return a, b, d, e
    _, shift = math.frexp(largest)
    return math.ldexp(a, -shift), math.ldexp(b, -shift), math.ldexp(d, -shift), e + shift


@compiled
def _entry(r, k):
    """log of the modulus and the sign of entry k, k of R_K ... R_1."""
    mantissa, exponent = 1.0, 0
    for j in range(r.shape[0]):
        mantissa, shift = math.frexp(mantissa * r[j, k, k])
        exponent += shift
    return np.log(abs(mantissa)) + exponent * _LN2, math.copysign(1.0, mantissa)


@compiled
def _pair(h, r, k):
    """Both multipliers of the block of rows and columns k, k + 1, each as log."""
    a, b, d, e = _corner(r, k)
    log_a, sign_a = _entry(r, k)
    log_d, sign_d = _entry(r, k + 1)
    # R = diag(signs) R' and H' = H diag(signs): a', d' are positive, H' is a rotation or a reflection
    a, b, d = abs(a), sign_a * b, abs(d)
    h00, h10 = h[k, k] * sign_a, h[k + 1, k] * sign_a
    h01, h11 = h[k, k + 1] * sign_d, h[k + 1, k + 1] * sign_d
    rotation = h00 * h11 - h01 * h10 > 0.0
    sign = 1.0
    if rotation:
        if h00 + h11 < 0.0:
            sign, h00, h10, h11 = -1.0, -h00, -h10, -h11
        # t/2 - g and t^2/4 - g^2 (trace t, determinant g^2) without cancellation near a double multiplier
        c, g, roots = 0.5 * (h00 + h11), np.sqrt(a) * np.sqrt(d), np.sqrt(a) + np.sqrt(d)
        apart = (a - d) / roots if roots > 0.0 else 0.0
        less = 0.5 * (c * apart * apart + h10 * b) - h10 * h10 / (1.0 + c) * g
        half, square = less + g, less * (less + 2.0 * g)
    else:
        half = 0.5 * (h00 * a + h10 * b + h11 * d)
        square = half * half + a * d
    if square < 0.0:
        angle = math.atan2(np.sqrt(-square), sign * half)
        log = 0.5 * (log_a + log_d)
        return complex(log, angle), complex(log, -angle if angle < math.pi else angle)
    larger = abs(half) + np.sqrt(square)
    first = np.log(larger) + e * _LN2
    second = log_a + log_d - first if larger > 0.0 else first
    negative = sign * half < 0.0
    other = negative if rotation else not negative
    return (
        complex(first, math.pi if negative else 0.0),
        complex(second, math.pi if other else 0.0),
    )


@compiled
def _sweep(h, r, low, high, exceptional):
    """One double-shift step on rows and columns low ... high (three or more), shifts from the last two."""
    # last two columns of the product of R, in the last three rows: u and v
    u0 = v0 = v1 = 0.0
    u1 = v2 = 1.0
    e = 0
    k = high - 2
    for j in range(r.shape[0]):
        a = r[j]
        u0 = a[k, k] * u0 + a[k, k + 1] * u1
        u1 = a[k + 1, k + 1] * u1
        v0 = a[k, k] * v0 + a[k, k + 1] * v1 + a[k, k + 2] * v2
        v1 = a[k + 1, k + 1] * v1 + a[k + 1, k + 2] * v2
        v2 = a[k + 2, k + 2] * v2
        largest = max(abs(u0), abs(u1), abs(v0), abs(v1), abs(v2))
        if not 1e-60 < largest < 1e60 and largest > 0.0:
            _, shift = math.frexp(largest)
            u0, u1 = math.ldexp(u0, -shift), math.ldexp(u1, -shift)
            v0, v1, v2 = math.ldexp(v0, -shift), math.ldexp(v1, -shift), math.ldexp(v2, -shift)
            e += shift
    m00 = h[k + 1, k] * u0 + h[k + 1, k + 1] * u1
    m01 = h[k + 1, k] * v0 + h[k + 1, k + 1] * v1 + h[k + 1, k + 2] * v2
    m10 = h[k + 2, k + 1] * u1
    m11 = h[k + 2, k + 1] * v1 + h[k + 2, k + 2] * v2
    s, t = m00 + m11, m00 * m11 - m01 * m10
    half = 0.5 * (m00 - m11)
    square = half * half + m01 * m10
    if square >= 0.0:
        # twice the root nearer to m11: two real ones, each between another complex pair, would stall
        z = half + math.copysign(np.sqrt(square), half)
        root = m11 - m01 * m10 / z if z != 0.0 else m11
        s, t = 2.0 * root, root * root
    a, b, d, top = _corner(r, low)
    ratio = math.ldexp(1.0, max(-400, min(400, e - top)))
    if exceptional:  # breaks cycles; its size is that of the product's first column or last row
        w = abs(m10) + abs(m11)
        s, t = 1.5 * w, w * w
        if w == 0.0 or ratio > 1e30:
            s, t, ratio = 1.5 * abs(a), a * a, 1.0
    s, t = s * ratio, t * ratio * ratio
    # first column of M^2 - s M + t
    p, q = a * h[low, low] + b * h[low + 1, low], d * h[low + 1, low]
    x0 = a * (h[low, low] * p + h[low, low + 1] * q - s * h[low, low]) + t
    x1 = a * (h[low + 1, low] * p + h[low + 1, low + 1] * q - s * h[low + 1, low])
    x2 = a * h[low + 2, low + 1] * q
    largest = max(abs(x0), abs(x1), abs(x2))
    if largest == 0.0:
        x0 = x1 = x2 = largest = 1.0
    c, s, x1 = _rotation(x1 / largest, x2 / largest)
    _carry(h, r, low + 1, c, s, low, high)
    c, s, _ = _rotation(x0 / largest, x1)
    _carry(h, r, low, c, s, low, high)
    for j in range(low, high - 1):
        if j + 3 <= high:
            _eliminate(h, r, j + 2, j, low, high)
        _eliminate(h, r, j + 1, j, low, high)


@compiled
def _split(h, r, found):
    """The multipliers of H R_K ... R_1, NaN where QR does not converge."""
    n = h.shape[1]
    for j in range(n - 2):
        for i in range(n - 2, j, -1):
            _eliminate(h, r, i, j, 0, n - 1)
    high, sweeps = n - 1, 0
    while high >= 0:
        low = high
        # equal multipliers make entries no smaller than what a sweep's rounding puts there again
        negligible = _EPS * (1 + sweeps * sweeps)
        while low > 0 and abs(h[low, low - 1]) > negligible:
            low -= 1
        if low > 0:
            h[low, low - 1] = 0.0
        if low == high:
            log, sign = _entry(r, high)
            found[high] = complex(log, math.pi if sign * h[high, high] < 0.0 else 0.0)
        elif low == high - 1:
            found[low], found[high] = _pair(h, r, low)
        elif sweeps < _SWEEPS:
            sweeps += 1
            _sweep(h, r, low, high, sweeps % 10 == 0)
            continue
        high, sweeps = low - 1, 0


@compiled
def log_multipliers(factors):
    """log|mu| + i arg(mu) of the eigenvalues mu of factors[K-1] ... factors[0], factors (K, n, n) -> (n,) complex.

    By descending modulus, conjugates next to each other and exactly conjugate, that with the positive argument
    first, arg in (-pi, pi]. -inf where a multiplier is zero as far as the factors' digits can tell; NaN, at the
    end, where QR does not converge, and everywhere for factors that are not finite.
    """
    n = factors.shape[1]
    found = np.full(n, complex(np.nan, np.nan))
    if n == 0 or not np.all(np.isfinite(factors)):
        return found
    if factors.shape[0] == 0:
        found[:] = 0.0
        return found
    groups, exponent = _grouped(factors, GROUPED)
    h, r = _triangular(groups)
    width = h.shape[1]
    for j in range(width, n):
        found[j] = complex(-np.inf, 0.0)
    _split(h, r, found[:width])
    for j in range(n):
        mu = complex(found[j].real + exponent * _LN2, found[j].imag)
        i = j
        while i > 0 and not found[i - 1].real >= mu.real and not np.isnan(mu.real):
            found[i] = found[i - 1]
            i -= 1
        found[i] = mu
    return found
