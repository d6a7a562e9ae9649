"""The loop over Taylor steps: lanes that finish take the next trajectory.

The code that a step runs is made for each tape (`taylor_code.py`) and called by its address. What belongs to a lane is
in columns of `rows`, `constants`, `control` and `lanes`; nothing that a lane computes depends on another.
"""

from ctypes import CFUNCTYPE, c_int64, c_void_p

import numpy as np
from llvmlite import ir
from numba import config
from numba.core import types
from numba.extending import intrinsic

from rainwind.dynamics.kernels import taylor_code as code
from rainwind.dynamics.kernels.compiling import compiled, inlined
from rainwind.dynamics.kernels.values import run

RUNNING, ARRIVED, RAN_AWAY, TOO_MANY, STUCK, STOPPED = range(6)
TRAJECTORY, STEPS, FRESH, PIECE = range(4)  # columns of lanes; no trajectory: -1


@intrinsic
def _call(typing, address, rows, constants, control):
    """Call a function made by `taylor_code` at an address, with the addresses of its arrays."""

    def generate(context, builder, signature, arguments):
        pointer = ir.PointerType()
        kind = ir.FunctionType(ir.IntType(64), [pointer] * 3)
        pointers = [builder.inttoptr(value, pointer) for value in arguments[1:]]
        # llvmlite wants to know what a pointer points to where a function is called by it
        function = builder.inttoptr(arguments[0], ir.PointerType(kind))
        return builder.call(function, pointers)

    return types.int64(types.int64, types.int64, types.int64, types.int64), generate


if config.DISABLE_JIT:  # type: ignore[attr-defined]  # kernels run as plain Python: call what they would call

    def _call(address, rows, constants, control):
        return CFUNCTYPE(c_int64, c_void_p, c_void_p, c_void_p)(address)(rows, constants, control)


@compiled
def fill(at, rows, constants, control):
    """Call generated code once."""
    return _call(at, rows.ctypes.data, constants.ctypes.data, control.ctypes.data)


@inlined
def _own(i):
    return code.FIRST_OF_STATES + code.OF_A_STATE * i


@compiled
def _take_piece(lane, control, lanes, knots, table, states, end):
    """Set a lane's driven inputs to the piece that holds, and its next stop to that piece's end."""
    piece = lanes[lane, PIECE]
    forward = control[code.SIGN, lane] > 0.0
    control[code.KNOT, lane] = knots[piece]
    for i in range(table.shape[1]):
        for j in range(4):
            control[_own(states) + code.OF_A_DRIVEN * i + j, lane] = table[piece, i, j]
    stop = end
    if forward and piece + 1 < table.shape[0]:
        stop = min(end, knots[piece + 1])
    elif not forward and piece > 0:
        stop = max(end, knots[piece])
    control[code.STOP, lane] = stop


@compiled
def _begin(lane, job, model, jobs, drives, constants, control, lanes):
    """Put a trajectory into a lane."""
    operations, template, slots, controlled = model
    starts, parameters, begins, ends, sizes, drive_of = jobs
    knots, table, first = drives
    n = starts.shape[1]
    values = template.copy()
    values[n : n + parameters.shape[1]] = parameters[job]
    run(operations, values)
    for c in range(slots.size):
        constants[c, lane] = values[slots[c]]
    fresh = False
    for i in range(n):
        own = _own(i)
        control[own + code.NEXT, lane] = starts[job, i]
        control[own + code.LOW, lane] = 0.0
        control[own + code.SIZE, lane] = sizes[job, i]
        fresh |= i < controlled and not sizes[job, i] > 0.0
    control[code.TIME, lane] = begins[job]
    control[code.TIME_LOW, lane] = 0.0
    control[code.FREE, lane] = 0.0
    control[code.SIGN, lane] = 1.0 if ends[job] >= begins[job] else -1.0
    lanes[lane, TRAJECTORY] = job
    lanes[lane, STEPS] = 0
    lanes[lane, FRESH] = fresh
    low, high = first[drive_of[job]], first[drive_of[job] + 1]
    forward = control[code.SIGN, lane] > 0.0
    piece = 0
    while piece + 1 < high - low and (
        knots[low + piece + 1] <= begins[job] if forward else knots[low + piece + 1] < begins[job]
    ):
        piece += 1
    lanes[lane, PIECE] = piece
    _take_piece(lane, control, lanes, knots[low:high], table[low:high], n, ends[job])


@compiled
def _finish(lane, status, control, lanes, results):
    """Write down how a lane's trajectory ended."""
    states, times, statuses, steps, sizes = results
    job = lanes[lane, TRAJECTORY]
    for i in range(states.shape[1]):
        states[job, i] = control[_own(i) + code.NEXT, lane]
        sizes[job, i] = control[_own(i) + code.SIZE, lane]
    times[job] = control[code.TIME, lane]
    statuses[job] = status
    steps[job] = lanes[lane, STEPS]


@compiled
def _rest(lane, control, lanes):
    """Let a lane stay where it is."""
    lanes[lane, TRAJECTORY] = -1
    control[code.SIGN, lane] = 0.0
    control[code.STOP, lane] = control[code.TIME, lane]
    control[code.TIME_LOW, lane] = 0.0


@compiled
def _first_radius(lane, rows, i):
    """A state's radius of convergence at a start, by all its terms, with gaps and zeros among the first; infinite
    where they say nothing."""
    radius = np.inf
    for j in range(3, rows.shape[1]):
        term = abs(rows[i, j, lane])
        if term > 0.0:
            best = 0.0
            for lower in range(j):
                best = max(best, (abs(rows[i, lower, lane]) / term) ** (1.0 / (j - lower)))
            if best > 0.0:
                radius = min(radius, best)
    return radius


@compiled
def _first_sizes(lane, rows, control, states, reach):
    """At a start, where a state may be zero: sizes from its terms after a first step, which is chosen carefully."""
    radius = np.inf
    for i in range(states):
        radius = min(radius, _first_radius(lane, rows, i))
    # polynomials, as far as can be seen: a part of the time to go
    h = reach * radius if radius < np.inf else abs(control[code.STOP, lane] - control[code.TIME, lane]) / 16.0
    control[code.FREE, lane] = 0.5 * h
    for i in range(states):
        size, power = abs(rows[i, 0, lane]), 1.0
        for j in range(1, rows.shape[1]):
            power *= h
            term = abs(rows[i, j, lane]) * power
            if np.isfinite(term):
                size = max(size, term)
        own = _own(i)
        control[own + code.SIZE, lane] = max(size, control[own + code.SIZE, lane])


@compiled
def _next(lane, position, model, jobs, drives, constants, control, lanes, results):
    """Give a free lane the next trajectory, or let it rest; one that is over at its start takes no lane."""
    starts, begins, ends = jobs[0], jobs[2], jobs[3]
    states, times, statuses, steps, _ = results
    while position[0] < position[1]:
        job = position[0]
        position[0] += 1
        finite = np.isfinite(begins[job]) and np.isfinite(ends[job])
        for i in range(starts.shape[1]):
            finite &= abs(starts[job, i]) < code.LARGEST_STATE
        if finite and begins[job] != ends[job]:
            _begin(lane, job, model, jobs, drives, constants, control, lanes)
            return
        states[job], times[job], steps[job] = starts[job], begins[job], 0
        statuses[job] = ARRIVED if finite else RAN_AWAY
    _rest(lane, control, lanes)


@compiled
def march(addresses, memory, position, model, jobs, drives, results, record, kept, limits):
    """Steps of all lanes, at most limits[0] of them or until `record` is full; how many, 0 where all is done.

    addresses: of the code for coefficients and step; memory: rows, constants, control, lanes; position: the next
    trajectory and the one after the last; model: operations and template for the constants, their slots, how many
    states the steps are chosen for; jobs: starts (N, n), parameters (N, m), begins, ends, sizes (N, n; 0: unknown),
    numbers of drives; drives: knots, table (K, D, 4), where each begins; results: states, times, statuses, steps,
    sizes; record: coefficients (B, r, P + 1, W), times, steps (signed; 0: none), trajectories (B, W); kept: the rows
    that go there; limits[1]: steps of one trajectory.
    """
    rows, constants, control, lanes = memory
    coefficients, times, lengths, numbers = record
    knots, table, first = drives
    n, width, controlled = jobs[0].shape[1], lanes.shape[0], model[3]
    reach = 2.0 ** control[code.REACH, 0]
    ends, drive_of = jobs[3], jobs[5]
    blocks = coefficients.shape[0]
    most = blocks if blocks else limits[0]
    for count in range(most):
        busy = False
        unknown = False
        for lane in range(width):
            busy |= lanes[lane, TRAJECTORY] >= 0
            unknown |= lanes[lane, FRESH] > 0
        if not busy:
            return count
        fill(addresses[0], rows, constants, control)
        if unknown:
            for lane in range(width):
                if lanes[lane, FRESH] > 0:
                    _first_sizes(lane, rows, control, controlled, reach)
                    lanes[lane, FRESH] = 0
        if blocks:
            for i in range(kept.size):
                coefficients[count, i] = rows[kept[i]]
            for lane in range(width):
                times[count, lane] = control[code.TIME, lane]
                numbers[count, lane] = lanes[lane, TRAJECTORY]
        found = fill(addresses[1], rows, constants, control)
        if blocks:
            for lane in range(width):
                failed = (found >> (32 + lane)) & 1
                if failed:
                    numbers[count, lane] = -1
                lengths[count, lane] = 0.0 if numbers[count, lane] < 0 else control[code.STEP, lane]
        for lane in range(width):
            lanes[lane, STEPS] += 1
        for lane in range(width):
            if lanes[lane, TRAJECTORY] < 0:
                continue
            job = lanes[lane, TRAJECTORY]
            status = RUNNING
            if (found >> (32 + lane)) & 1:
                lanes[lane, STEPS] -= 1
                status = RAN_AWAY
                if abs(control[code.STEP, lane]) < 2.0**-52 * abs(control[code.TIME, lane]):
                    status = STUCK
            elif (found >> lane) & 1 and control[code.TIME, lane] == ends[job]:
                status = ARRIVED
            elif lanes[lane, STEPS] >= limits[1]:
                status = TOO_MANY
            elif (found >> lane) & 1:
                lanes[lane, PIECE] += 1 if control[code.SIGN, lane] > 0.0 else -1
                low, high = first[drive_of[job]], first[drive_of[job] + 1]
                _take_piece(lane, control, lanes, knots[low:high], table[low:high], n, ends[job])
            if status != RUNNING:
                _finish(lane, status, control, lanes, results)
                _next(lane, position, model, jobs, drives, constants, control, lanes, results)
    return most


@compiled
def begin(memory, position, model, jobs, drives, results):
    """Fill all lanes; those that no trajectory is left for repeat the first, and rest."""
    _, constants, control, lanes = memory
    for lane in range(lanes.shape[0]):
        constants[:, lane] = constants[:, 0]
        control[:, lane] = control[:, 0]
        _next(lane, position, model, jobs, drives, constants, control, lanes, results)


@compiled
def stop(lane, memory, position, model, jobs, drives, results):
    """End a lane's trajectory now."""
    _, constants, control, lanes = memory
    _finish(lane, STOPPED, control, lanes, results)
    _next(lane, position, model, jobs, drives, constants, control, lanes, results)
