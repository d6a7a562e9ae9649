"""Taylor jets of a tape: the coefficients of t^0 ... t^K of f along a curve given by its own coefficients.

Each operation has a recurrence for its k-th coefficient from lower ones (Griewank & Walther, Evaluating
Derivatives, ch. 13). Directional derivatives of any order follow: D^k f[v, ..., v] = k! c_k on the line
x + t v.
"""

import numpy as np

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.compiling import compiled, inlined
from rainwind.dynamics.kernels.operations import operate
from rainwind.dynamics.kernels.values import moving


@inlined
def _product(slots, x, y, k, first):
    """Sum of x_j y_(k-j) for j = first ... k - first, of the coefficients of slots x and y."""
    total = 0.0
    for j in range(first, k - first + 1):
        total += slots[x, j] * slots[y, k - j]
    return total


@inlined
def _driven(slots, x, y, k, last):
    """Sum of j x_j y_(k-j) for j = 1 ... last, over k: the recurrence of z' = x' y."""
    total = 0.0
    for j in range(1, last + 1):
        total += j * slots[x, j] * slots[y, k - j]
    return total / k


@compiled
def _coefficient(code, c, a, b, z, k):
    """Fill coefficient k >= 1 of an operation's slot z (no sum or product), and of z + 1 = s where it has two.

    c (S, K + 1) holds the coefficients of all slots; those of the arguments a, b are there up to k. Rows are
    reached by number, since a view of a row costs more than the arithmetic on it.
    """
    s = z + 1
    if code == op.NEG:
        c[z, k] = -c[a, k]
    elif code == op.DIV:
        total = c[a, k]
        for j in range(k):
            total -= c[z, j] * c[b, k - j]
        c[z, k] = total / c[b, 0]
    elif code == op.POWER:
        total = 0.0
        for j in range(1, k + 1):
            total += (c[b, 0] * j - (k - j)) * c[a, j] * c[z, k - j]
        c[z, k] = total / (k * c[a, 0])
    elif code == op.SQRT:
        c[z, k] = (c[a, k] - _product(c, z, z, k, 1)) / (2.0 * c[z, 0])
    elif code == op.EXP:
        c[z, k] = _driven(c, a, z, k, k)
    elif code == op.LOG:
        c[z, k] = (c[a, k] - _driven(c, z, a, k, k - 1)) / c[a, 0]
    elif code == op.SINCOS:
        c[z, k] = _driven(c, a, s, k, k)
        c[s, k] = -_driven(c, a, z, k, k)
    elif code == op.SINHCOSH:
        c[z, k] = _driven(c, a, s, k, k)
        c[s, k] = _driven(c, a, z, k, k)
    elif code == op.TAN:
        c[z, k] = _driven(c, a, s, k, k)
        c[s, k] = _product(c, z, z, k, 0)
    elif code == op.TANH:
        c[z, k] = _driven(c, a, s, k, k)
        c[s, k] = -_product(c, z, z, k, 0)
    elif code == op.ATAN:
        c[s, k] = _product(c, a, a, k, 0)
        c[z, k] = (c[a, k] - _driven(c, z, s, k, k - 1)) / c[s, 0]
    elif code == op.ASIN or code == op.ACOS:
        # s^2 = 1 - a^2, s z' = a' (asin) or -a' (acos)
        c[s, k] = (-_product(c, a, a, k, 0) - _product(c, s, s, k, 1)) / (2.0 * c[s, 0])
        sign = 1.0 if code == op.ASIN else -1.0
        c[z, k] = (sign * c[a, k] - _driven(c, z, s, k, k - 1)) / c[s, 0]
    elif code == op.ERF:
        # s' = -2 a a' s, z' = a' s
        total = 0.0
        for j in range(1, k + 1):
            total -= j * _product(c, a, a, j, 0) * c[s, k - j]
        c[s, k] = total / k
        c[z, k] = _driven(c, a, s, k, k)
    else:  # ATAN2: (a^2 + b^2) z' = b a' - a b'
        c[s, k] = _product(c, a, a, k, 0) + _product(c, b, b, k, 0)
        c[z, k] = (_driven(c, a, b, k, k) - _driven(c, b, a, k, k) - _driven(c, z, s, k, k - 1)) / c[s, 0]


@compiled
def _values(operations, slots):
    """Fill coefficient 0 of all operations."""
    for i in range(operations.shape[0]):
        code, z = operations[i, 0], operations[i, 1]
        value, second = operate(code, slots[operations[i, 2], 0], slots[operations[i, 3], 0])
        slots[z, 0] = value
        if code >= op.FIRST_WITH_TWO:
            slots[z + 1, 0] = second


@compiled
def _higher(operations, rows, slots):
    """Fill coefficients 1 ... K of the operations numbered in `rows`; coefficient 0 is there already."""
    for row in rows:
        code, z, a, b = operations[row, 0], operations[row, 1], operations[row, 2], operations[row, 3]
        # sums and products are most of a tape: to choose once for all orders halves the time
        if code == op.MUL:
            for k in range(1, slots.shape[1]):
                slots[z, k] = _product(slots, a, b, k, 0)
        elif code == op.ADD:
            for k in range(1, slots.shape[1]):
                slots[z, k] = slots[a, k] + slots[b, k]
        elif code == op.SUB:
            for k in range(1, slots.shape[1]):
                slots[z, k] = slots[a, k] - slots[b, k]
        else:
            for k in range(1, slots.shape[1]):
                _coefficient(code, slots, a, b, z, k)


@compiled
def run_jets(operations, slots):
    """Fill slots (S, K + 1) of all operations; the rows of inputs and constants are there already."""
    _values(operations, slots)
    moves = np.zeros(slots.shape[0], dtype=np.bool_)
    given = operations[0, 1] if operations.shape[0] else slots.shape[0]
    for slot in range(slots.shape[0]):
        if slot >= given:
            slots[slot, 1:] = 0.0
        for k in range(1, slots.shape[1]):
            moves[slot] |= slots[slot, k] != 0.0
    _higher(operations, moving(operations, moves), slots)


@compiled
def directional(operations, template, outputs, inputs, vectors, order):
    """D^order f[v, ..., v] at one point for many vectors: inputs (i,), vectors (N, i) -> (N, n)."""
    slots = np.zeros((template.size, order + 1))
    slots[:, 0] = template
    slots[: inputs.size, 0] = inputs
    _values(operations, slots)
    moves = np.zeros(template.size, dtype=np.bool_)
    for row in range(vectors.shape[0]):
        for i in range(inputs.size):
            moves[i] |= vectors[row, i] != 0.0
    rows = moving(operations, moves)
    factorial = 1.0
    for k in range(2, order + 1):
        factorial *= k
    result = np.empty((vectors.shape[0], outputs.size))
    for row in range(vectors.shape[0]):
        if order:
            slots[: inputs.size, 1] = vectors[row]
        _higher(operations, rows, slots)
        for j in range(outputs.size):
            result[row, j] = factorial * slots[outputs[j], order]
    return result
