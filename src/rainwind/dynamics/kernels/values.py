"""Values of a tape at one point and at many.

Many points go through the tape in blocks of LANES, each operation for the whole block: the inner loops are
long enough for vector instructions, and the interpreter's cost is shared. What no varying input enters (in a
physics model about half of the operations) is computed once.
"""

import numpy as np

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.compiling import compiled, inlined
from rainwind.dynamics.kernels.operations import operate

LANES = 64
FEW = 8  # points below which blocks do not pay


@compiled
def run(operations, slots):
    """Fill the slots of all operations, in order; inputs and constants are there already."""
    for i in range(operations.shape[0]):
        code, z = operations[i, 0], operations[i, 1]
        value, second = operate(code, slots[operations[i, 2]], slots[operations[i, 3]])
        slots[z] = value
        if code >= op.FIRST_WITH_TWO:
            slots[z + 1] = second


@compiled
def varying(inputs, size):
    """Marks, for all slots, the inputs that are not the same at all points."""
    moves = np.zeros(size, dtype=np.bool_)
    for point in range(1, inputs.shape[0]):
        for i in range(inputs.shape[1]):
            moves[i] |= inputs[point, i] != inputs[0, i]
    return moves


@compiled
def moving(operations, moves):
    """Numbers of the operations that depend on slots marked in `moves`; marks their slots too."""
    rows = np.empty(operations.shape[0], dtype=np.int64)
    count = 0
    for i in range(operations.shape[0]):
        z = operations[i, 1]
        if moves[operations[i, 2]] or moves[operations[i, 3]]:
            rows[count] = i
            count += 1
            moves[z] = True
            if operations[i, 0] >= op.FIRST_WITH_TWO:
                moves[z + 1] = True
    return rows[:count]


@compiled
def specialised(operations, template, inputs, free):
    """The tape with everything computed that depends on no input marked in `free` (i,): operations, template.

    Slots keep their numbers, so outputs stay as they are.
    """
    slots = template.copy()
    slots[: inputs.size] = inputs
    run(operations, slots)
    moves = np.zeros(template.size, dtype=np.bool_)
    moves[: inputs.size] = free
    return operations[moving(operations, moves)], slots


@compiled
def lanes_of(operations, template, inputs):
    """All slots at the first point of inputs (N, i), repeated in each lane: (S, min(N, LANES))."""
    slots = template.copy()
    slots[: inputs.shape[1]] = inputs[0]
    run(operations, slots)
    lanes = np.empty((slots.size, min(inputs.shape[0], LANES)))
    for slot in range(slots.size):
        lanes[slot] = slots[slot]
    return lanes


@inlined
def _each(code, lanes, z, a, b, count):
    for lane in range(count):
        value, second = operate(code, lanes[a, lane], lanes[b, lane])
        lanes[z, lane] = value
        if code >= op.FIRST_WITH_TWO:
            lanes[z + 1, lane] = second


@compiled
def run_lanes(code, lanes, z, a, b, count):
    """Fill one operation's slots of the first `count` lanes."""
    # a known opcode leaves a loop without branches, which the compiler turns into vector instructions
    if code == op.ADD:
        _each(op.ADD, lanes, z, a, b, count)
    elif code == op.SUB:
        _each(op.SUB, lanes, z, a, b, count)
    elif code == op.MUL:
        _each(op.MUL, lanes, z, a, b, count)
    elif code == op.DIV:
        _each(op.DIV, lanes, z, a, b, count)
    else:
        _each(code, lanes, z, a, b, count)


@compiled
def values(operations, template, outputs, inputs):
    """f at N points: inputs (N, states + parameters) -> (N, n)."""
    points = inputs.shape[0]
    result = np.empty((points, outputs.size))
    if points < FEW:
        slots = template.copy()
        for point in range(points):
            slots[: inputs.shape[1]] = inputs[point]
            run(operations, slots)
            for k in range(outputs.size):
                result[point, k] = slots[outputs[k]]
        return result
    lanes = lanes_of(operations, template, inputs)
    rows = moving(operations, varying(inputs, template.size))
    for start in range(0, points, LANES):
        count = min(LANES, points - start)
        for i in range(inputs.shape[1]):
            for lane in range(count):
                lanes[i, lane] = inputs[start + lane, i]
        for row in rows:
            code, z, a, b = operations[row, 0], operations[row, 1], operations[row, 2], operations[row, 3]
            run_lanes(code, lanes, z, a, b, count)
        for k in range(outputs.size):
            for lane in range(count):
                result[start + lane, k] = lanes[outputs[k], lane]
    return result
