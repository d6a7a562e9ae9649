"""Trajectories by Taylor series: many at once, in lanes of machine code made for the model.

Jorba & Zou, "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
Experimental Mathematics 14 (2005) 99-117: the order follows from the tolerance, each step is a share of the radius of
convergence seen in the last two coefficients.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from hashlib import sha256
from math import ceil, log, log2
from typing import Any

import numpy as np

from rainwind.dynamics.kernels import taylor as kernel
from rainwind.dynamics.kernels import taylor_code as code
from rainwind.dynamics.kernels.machine_code import address, widest_lanes
from rainwind.dynamics.kernels.taylor_code import Program, TaylorCode
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.system import as_system, number
from rainwind.dynamics.tape import Tape
from rainwind.dynamics.taylor_tape import for_taylor, moving_slots
from rainwind.errors import InputError

STEPS = 10_000_000  # of one trajectory
BLOCK = 256  # steps of all lanes between two looks at the keyboard
LOWEST, HIGHEST = 1e-15, 1e-2  # tolerances
SAFETY = 0.1  # of a step's error: with it errors over some periods are near the tolerance (decision 26)
_ALIGN = 8  # float64s: 64 bytes


def best_order(tolerance: float) -> int:
    """The order at which a given time costs least (Jorba & Zou, section 3.1)."""
    return max(4, ceil(1.0 - 0.5 * log(SAFETY * tolerance)))


class TaylorEnded(Enum):
    """Why a trajectory ended."""

    ARRIVED = "reached its end"
    RAN_AWAY = "a state is not finite or grew beyond 1e100"
    TOO_MANY = "took as many steps as allowed"
    STUCK = "the step became smaller than rounding of the time"
    STOPPED = "was stopped"


_ENDED = {
    kernel.ARRIVED: TaylorEnded.ARRIVED, kernel.RAN_AWAY: TaylorEnded.RAN_AWAY, kernel.TOO_MANY: TaylorEnded.TOO_MANY,
    kernel.STUCK: TaylorEnded.STUCK, kernel.STOPPED: TaylorEnded.STOPPED,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Block:
    """Some steps of all lanes, in order: B steps, W lanes.

    trajectories (B, W): whose step it is, -1 where none; times (B, W) and steps (B, W): where it begins, how far it
    goes (negative: back in time); coefficients (B, outputs, order + 1, W): of the states, then of the extra outputs, in
    powers of t - times. The arrays are used again for the next block: copy what is to stay.
    """

    trajectories: np.ndarray
    times: np.ndarray
    steps: np.ndarray
    coefficients: np.ndarray


@dataclass(frozen=True, eq=False)
class TaylorRuns:
    """How N trajectories ended: states (N, n), times (N,), steps (N,) taken, sizes (N, n) that errors are shares of.

    ended[i] says why; statuses (N,) are the kernel's numbers of it.
    """

    states: np.ndarray
    times: np.ndarray
    statuses: np.ndarray
    steps: np.ndarray
    sizes: np.ndarray

    @property
    def ended(self) -> list[TaylorEnded | None]:
        """Why each ended; None where it was interrupted."""
        return [_ENDED.get(int(status)) for status in self.statuses]


class TaylorEngine:
    """Taylor steps of one model at one tolerance; cheap to make again, and safe to use from several threads.

    model: a system, or a tape, which may have more outputs than states: the coefficients of the others come with the
    steps. driven: names of the parameters that vary with time. tolerance: the error of a step relative to each
    state's size, 1e-15 to 1e-2. lanes: trajectories side by side; no number depends on it. controlled: how many of
    the states the steps are chosen for, by default all: of a tape with tangents, the system's own, so that the size
    of disturbances changes no step. Raises InputError.
    """

    def __init__(
        self,
        model: Any,
        tolerance: float = 1e-9,
        *,
        driven: Sequence[str] = (),
        lanes: int | None = None,
        order: int | None = None,
        controlled: int | None = None,
    ) -> None:
        tape = model if isinstance(model, Tape) else as_system(model).tape
        if not LOWEST <= number(tolerance, "tolerance") <= HIGHEST:
            raise InputError(f"tolerance must lie between {LOWEST:g} and {HIGHEST:g}; got {tolerance!r}")
        self.lanes = widest_lanes() if lanes is None else lanes
        if self.lanes not in (1, 2, 4, 8, 16, 32):
            raise InputError(f"lanes must be 1, 2, 4, 8, 16 or 32; got {lanes!r}")
        self.order = best_order(tolerance) if order is None else order
        if not 2 <= self.order <= 60:
            raise InputError(f"order must lie between 2 and 60; got {order!r}")
        self.tolerance, self.driven = float(tolerance), tuple(driven)
        self.states, self.parameters = tape.states, tape.parameters
        for name in self.driven:
            if name not in tape.parameters:
                raise InputError(f"'{name}' is no parameter; there are {', '.join(tape.parameters)}")
        n = len(tape.states)
        controlled = n if controlled is None else controlled
        if not 1 <= controlled <= n:
            raise InputError(f"controlled must lie between 1 and {n}; got {controlled!r}")
        numbers = [n + tape.parameters.index(name) for name in self.driven]
        self._tape = for_taylor(tape, numbers)
        moves = moving_slots(self._tape, numbers)
        operations, template, outputs = self._tape.arrays
        writer = TaylorCode(
            Program(operations, outputs, moves, n, numbers, controlled), self.order, self.lanes
        )
        self.layout = writer.layout
        key = sha256(b"".join(a.tobytes() for a in (operations, outputs))).hexdigest()
        key = (
            f"{key} {n} {template.size} {numbers} order {self.order} lanes {self.lanes} control {controlled}"
        )
        self._addresses = (
            address(f"coefficients\n{key}", writer.coefficients),
            address(f"step\n{key}", writer.step),
        )
        still = operations[~moves[operations[:, 1]]] if len(operations) else operations
        self._model = (
            np.ascontiguousarray(still),
            template,
            np.array(self.layout.constants, dtype=np.int64),
            controlled,
        )
        self._kept = np.array([*range(n), *self.layout.extra], dtype=np.int64)

    def advance(
        self,
        starts: Any,
        duration: Any,
        parameters: Any = None,
        *,
        begin: Any = 0.0,
        sizes: Any = None,
        drives: "Sequence[Pieces]" = (),
        drive_of: Any = 0,
        steps: int = STEPS,
    ) -> TaylorRuns:
        """Integrate N trajectories to their ends.

        starts: (N, n); duration: () or (N,), negative: back in time; parameters: (m,) or (N, m), in the tape's order;
        begin: () or (N,), the time of the start; sizes: (N, n) of an earlier part of the same trajectory; drives:
        the driven parameters as pieces of degree 3 at most in the order of `driven`, drive_of: () or (N,), which of
        them holds for a trajectory; steps: of one trajectory at most.
        """
        run = self.begin(starts, duration, parameters, begin, sizes, drives, drive_of, steps)
        while run.advance(BLOCK):
            pass
        return run.found

    def blocks(
        self,
        starts: Any,
        duration: Any,
        parameters: Any = None,
        *,
        begin: Any = 0.0,
        sizes: Any = None,
        drives: "Sequence[Pieces]" = (),
        drive_of: Any = 0,
        steps: int = STEPS,
        block: int = 64,
    ) -> "Walk":
        """The same, as an iterator over blocks of steps with their polynomials; `found` says how all ended."""
        run = self.begin(starts, duration, parameters, begin, sizes, drives, drive_of, steps)
        return Walk(run, block)

    def pieces(
        self, starts: Any, duration: Any, parameters: Any = None, **more: Any
    ) -> tuple[list[Pieces], TaylorRuns]:
        """The same, with all steps' polynomials of each trajectory: N pieces, of states and then extra outputs."""
        walk = self.blocks(starts, duration, parameters, **more)
        many = walk.found.times.size
        times: list[list[np.ndarray]] = [[] for _ in range(many)]
        coefficients: list[list[np.ndarray]] = [[] for _ in range(many)]
        for block in walk:
            for lane in range(block.times.shape[1]):
                mine = block.trajectories[:, lane]
                for job in np.unique(mine[mine >= 0]):
                    at = mine == job
                    times[job].append(block.times[at, lane])
                    coefficients[job].append(block.coefficients[at, :, :, lane])
        ends = walk.found.times
        empty = np.zeros((0, self._kept.size, self.order + 1))
        return [
            Pieces(
                np.append(np.concatenate([np.zeros(0), *times[job]]), ends[job]),
                np.concatenate([empty, *coefficients[job]]),
            )
            for job in range(many)
        ], walk.found

    def begin(
        self, starts: Any, duration: Any, parameters: Any, begin: Any, sizes: Any, drives: Sequence[Pieces],
        drive_of: Any, steps: int,
    ) -> "Lanes":  # fmt: skip
        """All lanes at the starts of their first trajectories."""
        starts = np.array(starts, dtype=float, ndmin=2)
        many, n = starts.shape
        if n != len(self.states) or starts.ndim != 2:
            raise InputError(f"starts must have shape (N, {len(self.states)}); got {starts.shape}")
        if parameters is None:
            parameters = np.zeros(len(self.parameters))
            if len(self.parameters) > len(self.driven):
                raise InputError(f"parameters are missing: {', '.join(self.parameters)}")
        given = np.asarray(parameters, dtype=float)
        if given.shape not in ((len(self.parameters),), (many, len(self.parameters))):
            raise InputError(
                f"parameters must have shape ({len(self.parameters)},) or ({many}, {len(self.parameters)}); "
                f"got {given.shape}"
            )
        begins = _for_each(begin, many, "begin")
        ends = begins + _for_each(duration, many, "duration")
        if not np.all(np.isfinite(ends)):
            raise InputError("begin and duration must be finite numbers")
        sizes = np.zeros((many, n)) if sizes is None else np.array(sizes, dtype=float, ndmin=2)
        if sizes.shape != starts.shape:
            raise InputError(f"sizes must have the shape of starts, {starts.shape}; got {sizes.shape}")
        which = np.array(np.broadcast_to(drive_of, (many,)), dtype=np.int64)
        table = _drives(drives, len(self.driven))
        if which.min(initial=0) < 0 or which.max(initial=0) >= table[2].size - 1:
            raise InputError(f"drive_of must be numbers of the {len(drives)} drives")
        jobs = (
            np.ascontiguousarray(starts), np.array(np.broadcast_to(given, (many, len(self.parameters)))), begins, ends,
            np.ascontiguousarray(sizes), which,
        )  # fmt: skip
        return Lanes(self, jobs, table, steps)

    # what follows is the kernels' side of a run

    def memory(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Rows, constants, control and lanes for one thread."""
        layout, w = self.layout, self.lanes
        rows = _aligned(len(layout.rows), self.order + 1, w)
        constants = _aligned(max(len(layout.constants), 1), w)
        control = _aligned(layout.controls, w)
        # the step is 2^REACH of the radius: what is cut off is (h / radius)^(order + 1) of a state's size
        control[code.REACH] = log2(SAFETY * self.tolerance) / (self.order + 1)
        lanes = np.zeros((w, 4), dtype=np.int64)
        lanes[:, kernel.TRAJECTORY] = -1
        return rows, constants, control, lanes


class Lanes:
    """A run of N trajectories through W lanes; `found` fills up on the way."""

    def __init__(self, engine: TaylorEngine, jobs: tuple, drives: tuple, steps: int) -> None:
        self.engine, self._jobs, self._drives, self._steps = engine, jobs, drives, steps
        many = len(jobs[0])
        self.found = TaylorRuns(
            jobs[0].copy(),
            jobs[2].copy(),
            np.zeros(many, dtype=np.int64),
            np.zeros(many, dtype=np.int64),
            jobs[4].copy(),
        )
        found = self.found
        self._results = found.states, found.times, found.statuses, found.steps, found.sizes
        self._memory = engine.memory()
        self._position = np.array([0, many])
        self._none = self.room(0)
        kernel.begin(self._memory, self._position, engine._model, jobs, drives, self._results)

    def room(self, block: int) -> tuple[np.ndarray, ...]:
        """Arrays for a block of steps."""
        w = self.engine.lanes
        return (
            np.empty((block, self.engine._kept.size, self.engine.order + 1, w)), np.empty((block, w)),
            np.empty((block, w)), np.empty((block, w), dtype=np.int64),
        )  # fmt: skip

    def advance(self, most: int, room: tuple[np.ndarray, ...] | None = None) -> int:
        """Steps of all lanes; how many, 0 where all trajectories have ended."""
        engine = self.engine
        return kernel.march(
            engine._addresses, self._memory, self._position, engine._model, self._jobs, self._drives, self._results,
            self._none if room is None else room, engine._kept, (most, self._steps),
        )  # fmt: skip

    def here(self, lane: int) -> tuple[float, np.ndarray, np.ndarray]:
        """Time, state (n,) and sizes (n,) of a lane between two calls of `advance`."""
        control = self._memory[2][:, lane]
        own = code.FIRST_OF_STATES + code.OF_A_STATE * np.arange(len(self.engine.states))
        return float(control[code.TIME]), control[own + code.NEXT], control[own + code.SIZE]

    def stop(self, trajectory: int) -> None:
        """End a trajectory that is on its way; nothing where it has ended."""
        lanes = self._memory[3]
        for lane in np.flatnonzero(lanes[:, kernel.TRAJECTORY] == trajectory):
            kernel.stop(
                lane,
                self._memory,
                self._position,
                self.engine._model,
                self._jobs,
                self._drives,
                self._results,
            )


class Walk:
    """Blocks of steps, one after the other; `stop` ends a trajectory, `found` says how all ended."""

    def __init__(self, lanes: Lanes, block: int) -> None:
        self._lanes, self._block = lanes, block
        self.found = lanes.found
        self.stop = lanes.stop

    def __iter__(self) -> Iterator[Block]:
        room = self._lanes.room(self._block)
        while count := self._lanes.advance(self._block, room):
            coefficients, times, steps, trajectories = (array[:count] for array in room)
            yield Block(trajectories, times, steps, coefficients)


def _aligned(*shape: int) -> np.ndarray:
    """Zeros that begin where vectors may be loaded from."""
    size = int(np.prod(shape))
    raw = np.zeros(size + _ALIGN * 4)
    skip = (-(raw.ctypes.data // 8)) % (_ALIGN * 4)
    return raw[skip : skip + size].reshape(shape)


def _for_each(value: Any, many: int, what: str) -> np.ndarray:
    array = np.asarray(value, dtype=float)
    if array.shape not in ((), (many,)):
        raise InputError(f"{what} must be a number or {many} numbers; got the shape {array.shape}")
    return np.array(np.broadcast_to(array, (many,)))


def _drives(drives: Sequence[Pieces], many: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Knots, coefficients (K, many, 4) and where each drive begins, of all drives one after the other."""
    if not drives:
        if many:
            raise InputError("driven parameters need their courses: give drives=")
        return np.zeros(1), np.zeros((1, 0, 4)), np.array([0, 1])
    knots, tables = [], []
    for one in drives:
        k, d, width = one.coefficients.shape
        if d != many or width > 4 or not k:
            raise InputError(
                f"a drive has pieces of {many} parameters, of degree 3 at most; got {one.coefficients.shape}"
            )
        table = np.zeros((k, d, 4))
        table[:, :, :width] = one.coefficients
        knots.append(one.times[:-1])
        tables.append(table)
    first = np.cumsum([0, *(len(t) for t in tables)])
    return np.concatenate(knots), np.concatenate(tables), first
