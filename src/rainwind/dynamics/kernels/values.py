"""Values of a tape at one point and at many."""

import numpy as np
from numba import njit

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.operations import operate


@njit(cache=True, nogil=True, error_model="numpy")
def run(operations, slots):
    """Fill the slots of all operations, in order; inputs and constants are there already."""
    for i in range(operations.shape[0]):
        code, z = operations[i, 0], operations[i, 1]
        value, second = operate(code, slots[operations[i, 2]], slots[operations[i, 3]])
        slots[z] = value
        if code >= op.FIRST_WITH_TWO:
            slots[z + 1] = second


@njit(cache=True, nogil=True, error_model="numpy")
def values(operations, template, outputs, inputs):
    """f at N points: inputs (N, states + parameters) -> (N, n)."""
    slots = template.copy()
    result = np.empty((inputs.shape[0], outputs.size))
    for point in range(inputs.shape[0]):
        slots[: inputs.shape[1]] = inputs[point]
        run(operations, slots)
        for k in range(outputs.size):
            result[point, k] = slots[outputs[k]]
    return result
