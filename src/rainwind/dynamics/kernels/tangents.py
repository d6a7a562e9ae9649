"""First and second derivatives of a tape by forward propagation, all directions in one pass.

`second_orders` carries, beside the tangents along unit directions, the derivatives of everything along some more
vectors v: this gives f, J and the matrices D_v J = B(v, .) in one pass.
"""

import numpy as np

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.compiling import compiled, inlined
from rainwind.dynamics.kernels.operations import operate, partials, second_partials
from rainwind.dynamics.kernels.values import FEW, LANES, lanes_of, moving, run_lanes, varying


@compiled
def first_order(operations, slots, tangents, active):
    """Run a tape with tangents.

    slots (S,) with inputs and constants filled in; tangents (S, m) and active (S,) bool with the rows of the
    inputs filled in. A slot is active when some tangent of it may differ from zero; rows of others are not
    read.
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


@compiled
def jacobian_at(operations, template, outputs, inputs, directions):
    """f (n,) and its derivatives (n, m) by the inputs numbered in `directions`, at one point: inputs (i,)."""
    m, n = directions.size, outputs.size
    slots = template.copy()
    slots[: inputs.size] = inputs
    tangents = np.empty((template.size, m))
    tangents[: inputs.size] = 0.0
    active = np.zeros(template.size, dtype=np.bool_)
    for k in range(m):
        tangents[directions[k], k] = 1.0
        active[directions[k]] = True
    first_order(operations, slots, tangents, active)
    values = np.empty(n)
    derivatives = np.zeros((n, m))
    for j in range(n):
        values[j] = slots[outputs[j]]
        if active[outputs[j]]:
            derivatives[j] = tangents[outputs[j]]
    return values, derivatives


@compiled
def jacobians(operations, template, outputs, inputs, directions):
    """f and its derivatives by the inputs numbered in `directions`, at N points.

    inputs (N, states + parameters), directions (m,) -> values (N, n), derivatives (N, n, m).
    """
    points, m, n = inputs.shape[0], directions.size, outputs.size
    values = np.empty((points, n))
    derivatives = np.zeros((points, n, m))
    if points >= FEW:
        _jacobians_in_lanes(operations, template, outputs, inputs, directions, values, derivatives)
    else:
        for point in range(points):
            found = jacobian_at(operations, template, outputs, inputs[point], directions)
            values[point], derivatives[point] = found
    return values, derivatives


@compiled
def _steps(operations, rows, size, directions):
    """Which tangents differ from zero, and how each follows from others.

    A tangent is a slot along a direction. Returns steps (count, 4), each a tangent, its two sources (-1:
    none) and whether it is of an operation's second slot; begin, so that steps[begin[i] : begin[i + 1]]
    belong to the operation rows[i]; tangent (S, m), the number of each tangent or -1; the number of all.
    """
    m = directions.size
    tangent = np.full((size, m), -1)
    for k in range(m):
        tangent[directions[k], k] = k
    steps = np.empty((2 * m * rows.size, 4), dtype=np.int64)
    begin = np.zeros(rows.size + 1, dtype=np.int64)
    count = 0
    for i in range(rows.size):
        row = rows[i]
        code, z, ia, ib = operations[row, 0], operations[row, 1], operations[row, 2], operations[row, 3]
        for k in range(m):
            a = tangent[ia, k]
            b = tangent[ib, k] if code <= op.DIV or code == op.ATAN2 else -1
            if a < 0 and b < 0:
                continue
            tangent[z, k] = m + count
            steps[count, 0], steps[count, 1], steps[count, 2], steps[count, 3] = m + count, a, b, 0
            count += 1
            if op.FIRST_WITH_TWO <= code <= op.SINHCOSH:
                tangent[z + 1, k] = m + count
                steps[count, 0], steps[count, 1], steps[count, 2], steps[count, 3] = m + count, a, -1, 1
                count += 1
        begin[i + 1] = count
    return steps[:count], begin, tangent, m + count


@inlined
def _each(code, lanes, z, a, b, factors, count):
    for lane in range(count):
        second = lanes[z + 1, lane] if code >= op.FIRST_WITH_TWO else 0.0
        fa, fb, ga = partials(code, lanes[a, lane], lanes[b, lane], lanes[z, lane], second)
        factors[0, lane], factors[1, lane], factors[2, lane] = fa, fb, ga


@compiled
def _partials_in_lanes(code, lanes, z, a, b, factors, count):
    if code == op.ADD:
        _each(op.ADD, lanes, z, a, b, factors, count)
    elif code == op.SUB:
        _each(op.SUB, lanes, z, a, b, factors, count)
    elif code == op.MUL:
        _each(op.MUL, lanes, z, a, b, factors, count)
    elif code == op.DIV:
        _each(op.DIV, lanes, z, a, b, factors, count)
    else:
        _each(code, lanes, z, a, b, factors, count)


@compiled
def _jacobians_in_lanes(operations, template, outputs, inputs, directions, values, derivatives):
    """Fill values and derivatives block by block, as `values` does, along the tangents that are not zero."""
    points, m, n = derivatives.shape[0], directions.size, outputs.size
    moves = varying(inputs, template.size)
    for k in range(m):
        moves[directions[k]] = True
    rows = moving(operations, moves)
    steps, begin, tangent, used = _steps(operations, rows, template.size, directions)
    lanes = lanes_of(operations, template, inputs)
    tangents = np.ones((used, lanes.shape[1]))
    factors = np.empty((3, lanes.shape[1]))
    for start in range(0, points, LANES):
        count = min(LANES, points - start)
        for i in range(inputs.shape[1]):
            for lane in range(count):
                lanes[i, lane] = inputs[start + lane, i]
        for i in range(rows.size):
            row = rows[i]
            code, z, a, b = operations[row, 0], operations[row, 1], operations[row, 2], operations[row, 3]
            run_lanes(code, lanes, z, a, b, count)
            if begin[i] == begin[i + 1]:
                continue
            _partials_in_lanes(code, lanes, z, a, b, factors, count)
            for step in range(begin[i], begin[i + 1]):
                t, ta, tb = steps[step, 0], steps[step, 1], steps[step, 2]
                if steps[step, 3]:
                    for lane in range(count):
                        tangents[t, lane] = factors[2, lane] * tangents[ta, lane]
                elif tb < 0:
                    for lane in range(count):
                        tangents[t, lane] = factors[0, lane] * tangents[ta, lane]
                elif ta < 0:
                    for lane in range(count):
                        tangents[t, lane] = factors[1, lane] * tangents[tb, lane]
                else:
                    for lane in range(count):
                        along_a = factors[0, lane] * tangents[ta, lane]
                        tangents[t, lane] = along_a + factors[1, lane] * tangents[tb, lane]
        for j in range(n):
            for lane in range(count):
                values[start + lane, j] = lanes[outputs[j], lane]
            for k in range(m):
                t = tangent[outputs[j], k]
                if t >= 0:
                    for lane in range(count):
                        derivatives[start + lane, j, k] = tangents[t, lane]


@compiled
def second_orders(operations, template, outputs, inputs, directions, vectors):
    """f, its derivatives along `directions`, and those derivatives' derivatives along vectors, at one point.

    inputs (i,), directions (m,), vectors (r, i) -> f (n,), D (n, m), D_v D (r, n, m).
    """
    m, n, many = directions.size, outputs.size, vectors.shape[0]
    slots = template.copy()
    slots[: inputs.size] = inputs
    along = np.zeros((template.size, many))  # derivatives along the vectors
    d = np.zeros((template.size, m))
    dd = np.zeros((many, template.size, m))
    active = np.zeros(template.size, dtype=np.bool_)  # slots of which some derivative may differ from zero
    for i in range(inputs.size):
        for r in range(many):
            along[i, r] = vectors[r, i]
            active[i] |= vectors[r, i] != 0.0
    for k in range(m):
        d[directions[k], k] = 1.0
        active[directions[k]] = True
    for i in range(operations.shape[0]):
        code, z = operations[i, 0], operations[i, 1]
        ia, ib = operations[i, 2], operations[i, 3]
        a, b = slots[ia], slots[ib]
        value, second = operate(code, a, b)
        slots[z] = value
        if code >= op.FIRST_WITH_TWO:
            slots[z + 1] = second
        if not (active[ia] or active[ib]):
            continue
        active[z] = True
        fa, fb, ga = partials(code, a, b, value, second)
        if code <= op.DIV or code == op.ATAN2:
            for k in range(m):
                d[z, k] = fa * d[ia, k] + fb * d[ib, k]
        else:
            for k in range(m):
                d[z, k] = fa * d[ia, k]
        if code <= op.SUB:  # no second derivatives
            for r in range(many):
                along[z, r] = fa * along[ia, r] + fb * along[ib, r]
                for k in range(m):
                    dd[r, z, k] = fa * dd[r, ia, k] + fb * dd[r, ib, k]
            continue
        faa, fab, fbb, gaa = second_partials(code, a, b, value, second)
        for r in range(many):
            va, vb = along[ia, r], along[ib, r]
            if code <= op.DIV or code == op.ATAN2:
                ca, cb = faa * va + fab * vb, fab * va + fbb * vb
                along[z, r] = fa * va + fb * vb
                for k in range(m):
                    dd[r, z, k] = fa * dd[r, ia, k] + fb * dd[r, ib, k] + ca * d[ia, k] + cb * d[ib, k]
            else:
                along[z, r] = fa * va
                for k in range(m):
                    dd[r, z, k] = fa * dd[r, ia, k] + faa * va * d[ia, k]
            if op.FIRST_WITH_TWO <= code <= op.SINHCOSH:
                along[z + 1, r] = ga * va
                for k in range(m):
                    dd[r, z + 1, k] = ga * dd[r, ia, k] + gaa * va * d[ia, k]
        if op.FIRST_WITH_TWO <= code <= op.SINHCOSH:
            active[z + 1] = True
            for k in range(m):
                d[z + 1, k] = ga * d[ia, k]
    f = np.empty(n)
    first = np.empty((n, m))
    mixed = np.empty((many, n, m))
    for j in range(n):
        f[j] = slots[outputs[j]]
        for k in range(m):
            first[j, k] = d[outputs[j], k]
            for r in range(many):
                mixed[r, j, k] = dd[r, outputs[j], k]
    return f, first, mixed


@compiled
def second_order(operations, template, outputs, inputs, directions, v):
    """`second_orders` along one vector v (i,): f (n,), D (n, m), D_v D (n, m)."""
    f, first, mixed = second_orders(operations, template, outputs, inputs, directions, v.reshape((1, v.size)))
    return f, first, mixed[0]
