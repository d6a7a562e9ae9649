"""Taylor jets of a tape: the coefficients of t^0 ... t^K of f along a curve given by its own coefficients.

Each operation has a recurrence for its k-th coefficient from lower ones (Griewank & Walther, Evaluating
Derivatives, ch. 13). Directional derivatives of any order follow: D^k f[v, ..., v] = k! c_k on the line
x + t v.
"""

import numpy as np
from numba import njit

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.operations import operate


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _product(x, y, k, first):
    """Sum of x[j] y[k - j] for j = first ... k - first."""
    total = 0.0
    for j in range(first, k - first + 1):
        total += x[j] * y[k - j]
    return total


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _driven(x, y, k, last):
    """Sum of j x[j] y[k - j] for j = 1 ... last, over k: the recurrence of z' = x' y."""
    total = 0.0
    for j in range(1, last + 1):
        total += j * x[j] * y[k - j]
    return total / k


@njit(cache=True, nogil=True, error_model="numpy")
def coefficient(code, a, b, z, s, k):
    """Coefficient k >= 1 of an operation's value z and second value s, from coefficients of a, b up to k."""
    if code == op.ADD:
        z[k] = a[k] + b[k]
    elif code == op.SUB:
        z[k] = a[k] - b[k]
    elif code == op.MUL:
        z[k] = _product(a, b, k, 0)
    elif code == op.NEG:
        z[k] = -a[k]
    elif code == op.DIV:
        total = a[k]
        for j in range(k):
            total -= z[j] * b[k - j]
        z[k] = total / b[0]
    elif code == op.POWER:
        total = 0.0
        for j in range(1, k + 1):
            total += (b[0] * j - (k - j)) * a[j] * z[k - j]
        z[k] = total / (k * a[0])
    elif code == op.SQRT:
        z[k] = (a[k] - _product(z, z, k, 1)) / (2.0 * z[0])
    elif code == op.EXP:
        z[k] = _driven(a, z, k, k)
    elif code == op.LOG:
        z[k] = (a[k] - _driven(z, a, k, k - 1)) / a[0]
    elif code == op.SINCOS:
        z[k] = _driven(a, s, k, k)
        s[k] = -_driven(a, z, k, k)
    elif code == op.SINHCOSH:
        z[k] = _driven(a, s, k, k)
        s[k] = _driven(a, z, k, k)
    elif code == op.TAN:
        z[k] = _driven(a, s, k, k)
        s[k] = _product(z, z, k, 0)
    elif code == op.TANH:
        z[k] = _driven(a, s, k, k)
        s[k] = -_product(z, z, k, 0)
    elif code == op.ATAN:
        s[k] = _product(a, a, k, 0)
        z[k] = (a[k] - _driven(z, s, k, k - 1)) / s[0]
    elif code == op.ASIN or code == op.ACOS:
        # s^2 = 1 - a^2, s z' = a' (asin) or -a' (acos)
        s[k] = (-_product(a, a, k, 0) - _product(s, s, k, 1)) / (2.0 * s[0])
        sign = 1.0 if code == op.ASIN else -1.0
        z[k] = (sign * a[k] - _driven(z, s, k, k - 1)) / s[0]
    elif code == op.ERF:
        # s' = -2 a a' s, z' = a' s
        total = 0.0
        for j in range(1, k + 1):
            total -= j * _product(a, a, j, 0) * s[k - j]
        s[k] = total / k
        z[k] = _driven(a, s, k, k)
    else:  # ATAN2: (a^2 + b^2) z' = b a' - a b'
        s[k] = _product(a, a, k, 0) + _product(b, b, k, 0)
        z[k] = (_driven(a, b, k, k) - _driven(b, a, k, k) - _driven(z, s, k, k - 1)) / s[0]


@njit(cache=True, nogil=True, error_model="numpy")
def run_jets(operations, slots):
    """Fill slots (S, K + 1) of all operations; the rows of inputs and constants are there already."""
    for i in range(operations.shape[0]):
        code, iz = operations[i, 0], operations[i, 1]
        a, b, z = slots[operations[i, 2]], slots[operations[i, 3]], slots[iz]
        s = slots[iz + 1] if code >= op.FIRST_WITH_TWO else z
        value, second = operate(code, a[0], b[0])
        z[0] = value
        if code >= op.FIRST_WITH_TWO:
            s[0] = second
        for k in range(1, slots.shape[1]):
            coefficient(code, a, b, z, s, k)


@njit(cache=True, nogil=True, error_model="numpy")
def directional(operations, template, outputs, inputs, vectors, order):
    """D^order f[v, ..., v] at one point for many vectors: inputs (i,), vectors (N, i) -> (N, n)."""
    slots = np.zeros((template.size, order + 1))
    slots[:, 0] = template
    slots[: inputs.size, 0] = inputs
    factorial = 1.0
    for k in range(2, order + 1):
        factorial *= k
    result = np.empty((vectors.shape[0], outputs.size))
    for row in range(vectors.shape[0]):
        slots[: inputs.size, 1] = vectors[row]
        run_jets(operations, slots)
        for j in range(outputs.size):
            result[row, j] = factorial * slots[outputs[j], order]
    return result
