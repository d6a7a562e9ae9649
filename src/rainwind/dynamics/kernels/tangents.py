"""First and second derivatives of a tape by forward propagation, all directions in one pass.

`second_order` carries, beside the tangents along unit directions, the derivative of everything along one more
vector v: this gives f, J and the matrix D_v J = B(v, .) at about four times the cost of J.
"""

import numpy as np
from numba import njit

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.operations import operate, partials, second_partials


@njit(cache=True, nogil=True, error_model="numpy")
def first_order(operations, slots, tangents, active):
    """Run a tape with tangents.

    slots (S,) with inputs and constants filled in; tangents (S, m) and active (S,) bool with the rows of the
    inputs filled in. A slot is active when some tangent of it may differ from zero; rows of others are not read.
    """
    m = tangents.shape[1]
    for i in range(operations.shape[0]):
        code, z = operations[i, 0], operations[i, 1]
        ia, ib = operations[i, 2], operations[i, 3]
        a, b = slots[ia], slots[ib]
        value, second = operate(code, a, b)
        slots[z] = value
        two = code >= op.FIRST_WITH_TWO
        if two:
            slots[z + 1] = second
        from_b = active[ib] and (code <= op.DIV or code == op.ATAN2)
        if not (active[ia] or from_b):
            active[z] = False
            if two:
                active[z + 1] = False
            continue
        fa, fb, ga = partials(code, a, b, value, second)
        active[z] = True
        if active[ia] and from_b:
            for k in range(m):
                tangents[z, k] = fa * tangents[ia, k] + fb * tangents[ib, k]
        elif active[ia]:
            for k in range(m):
                tangents[z, k] = fa * tangents[ia, k]
        else:
            for k in range(m):
                tangents[z, k] = fb * tangents[ib, k]
        if two:
            active[z + 1] = code <= op.SINHCOSH
            if code <= op.SINHCOSH:
                for k in range(m):
                    tangents[z + 1, k] = ga * tangents[ia, k]


@njit(cache=True, nogil=True, error_model="numpy")
def jacobians(operations, template, outputs, inputs, directions):
    """f and its derivatives by the inputs numbered in `directions`, at N points.

    inputs (N, states + parameters), directions (m,) -> values (N, n), derivatives (N, n, m).
    """
    points, m, n = inputs.shape[0], directions.size, outputs.size
    slots = template.copy()
    tangents = np.zeros((template.size, m))
    active = np.zeros(template.size, dtype=np.bool_)
    for k in range(m):
        tangents[directions[k], k] = 1.0
        active[directions[k]] = True
    values = np.empty((points, n))
    derivatives = np.zeros((points, n, m))
    for point in range(points):
        slots[: inputs.shape[1]] = inputs[point]
        first_order(operations, slots, tangents, active)
        for j in range(n):
            values[point, j] = slots[outputs[j]]
            if active[outputs[j]]:
                for k in range(m):
                    derivatives[point, j, k] = tangents[outputs[j], k]
    return values, derivatives


@njit(cache=True, nogil=True, error_model="numpy")
def second_order(operations, template, outputs, inputs, directions, v):
    """f, its derivatives along `directions`, and those derivatives' derivative along v, at one point.

    inputs (i,), directions (m,), v (i,) -> f (n,), D (n, m), D_v D (n, m).
    """
    m, n = directions.size, outputs.size
    slots = template.copy()
    slots[: inputs.size] = inputs
    along = np.zeros(template.size)  # derivative along v
    along[: inputs.size] = v
    d = np.zeros((template.size, m))
    dd = np.zeros((template.size, m))
    for k in range(m):
        d[directions[k], k] = 1.0
    for i in range(operations.shape[0]):
        code, z = operations[i, 0], operations[i, 1]
        ia, ib = operations[i, 2], operations[i, 3]
        a, b = slots[ia], slots[ib]
        value, second = operate(code, a, b)
        slots[z] = value
        fa, fb, ga = partials(code, a, b, value, second)
        faa, fab, fbb, gaa = second_partials(code, a, b, value, second)
        va, vb = along[ia], along[ib]
        if code <= op.DIV or code == op.ATAN2:
            ca, cb = faa * va + fab * vb, fab * va + fbb * vb
            along[z] = fa * va + fb * vb
            for k in range(m):
                d[z, k] = fa * d[ia, k] + fb * d[ib, k]
                dd[z, k] = fa * dd[ia, k] + fb * dd[ib, k] + ca * d[ia, k] + cb * d[ib, k]
        else:
            along[z] = fa * va
            for k in range(m):
                d[z, k] = fa * d[ia, k]
                dd[z, k] = fa * dd[ia, k] + faa * va * d[ia, k]
        if code >= op.FIRST_WITH_TWO:
            slots[z + 1] = second
            if code <= op.SINHCOSH:
                along[z + 1] = ga * va
                for k in range(m):
                    d[z + 1, k] = ga * d[ia, k]
                    dd[z + 1, k] = ga * dd[ia, k] + gaa * va * d[ia, k]
    f = np.empty(n)
    first = np.empty((n, m))
    mixed = np.empty((n, m))
    for j in range(n):
        f[j] = slots[outputs[j]]
        first[j] = d[outputs[j]]
        mixed[j] = dd[outputs[j]]
    return f, first, mixed
