"""Which engine takes the next block of steps: the one that costs less for the time it covers, looked at on the way.

An explicit method pays for stiffness with short steps, a Rosenbrock method for accuracy. So the engine that rests takes
a few steps from time to time, from where the run is; they are thrown away, and what they cost for the time that they
cover is compared. Costs are estimated from the tape, not measured, so that a run repeated is the same run.
"""

from functools import lru_cache

import numpy as np

from rainwind.dynamics.drive import Drive
from rainwind.dynamics.kernels import rosenbrock as stiff_kernel
from rainwind.dynamics.kernels import taylor as taylor_kernel
from rainwind.dynamics.kernels import taylor_code as code
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.rosenbrock import Rosenbrock
from rainwind.dynamics.system import System
from rainwind.dynamics.tape import Tape
from rainwind.dynamics.taylor import STEPS, Lanes, TaylorEngine
from rainwind.dynamics.trajectory import RunEnded

BLOCK = 256
_TRIAL = 12  # steps of the resting engine
_FIRST, _LAST = 64, 4096  # steps between two trials: ever more, as long as nothing changes
_BETTER = 1.5  # by what the other engine must be cheaper
_CHANGED = 0.3  # share of the step at the last trial below which another trial is due


class Taylor:
    """Steps by Taylor series along one trajectory. cost: of a step, in nanoseconds, roughly."""

    name = "taylor"

    def __init__(self, system: System, driven: Drive, tolerance: float, moving: int) -> None:
        self._engine = _taylor(system.tape, tolerance, driven.names)
        self._parameters = np.array(list(system.parameters.values()), dtype=float)
        self._drives = [driven.pieces] if driven.names else []
        self._lanes: Lanes | None = None
        self._here: tuple[float, bytes] | None = None
        self.cost = taylor_cost(self._engine.order, moving)

    def advance(
        self, t: float, state: np.ndarray, sizes: np.ndarray, end: float, most: int
    ) -> tuple[Pieces, RunEnded | None]:
        """At most `most` steps towards `end`; why it cannot go on, if so. state and sizes are moved on in place."""
        if self._lanes is None or self._here != (t, state.tobytes()):
            self._lanes = self._engine.begin(
                state, end - t, self._parameters, t, sizes, self._drives, 0, STEPS
            )
        lanes = self._lanes
        room = lanes.room(most)
        count = lanes.advance(most, room)
        coefficients, times, _, trajectories = (array[:count] for array in room)
        taken = trajectories[:, 0] >= 0
        status = int(lanes.found.statuses[0])
        if status == taylor_kernel.RUNNING:
            control = lanes._memory[2][:, 0]
            own = code.FIRST_OF_STATES + code.OF_A_STATE * np.arange(state.size)
            now, state[:], sizes[:] = control[code.TIME], control[own + code.NEXT], control[own + code.SIZE]
        else:
            now, state[:], sizes[:] = lanes.found.times[0], lanes.found.states[0], lanes.found.sizes[0]
            self._lanes = None
        if status == taylor_kernel.ARRIVED:
            now = end  # t + (end - t) may differ by rounding
        self._here = float(now), state.tobytes()
        pieces = Pieces(np.append(times[taken, 0], now), coefficients[taken, :, :, 0])
        failed = status not in (taylor_kernel.RUNNING, taylor_kernel.ARRIVED)
        return pieces, RunEnded.STEP_TOO_SMALL if failed else None

    def forget(self) -> None:
        """The next block begins anew: another engine has moved the run on."""
        self._lanes = None


def taylor_cost(order: int, moving: int) -> float:
    """What a Taylor step costs in nanoseconds, roughly, with so many operations of the tape that move."""
    return 60.0 + 0.09 * moving * (order + 1) * (order + 2) / 2.0


@lru_cache(maxsize=8)
def _taylor(tape: Tape, tolerance: float, driven: tuple[str, ...]) -> TaylorEngine:
    """One engine for all runs that differ in parameters only."""
    return TaylorEngine(tape, tolerance, driven=driven, lanes=1)


class Stiff:
    """Steps of the Rosenbrock method along one trajectory. cost: of a step, in nanoseconds, roughly."""

    name = "rosenbrock"

    def __init__(self, system: System, driven: Drive, tolerance: float) -> None:
        self._engine = Rosenbrock(system, driven, tolerance)
        self.moving, n = self._engine.moving, len(system.states)
        self.cost = 350.0 + 2.2 * self.moving * (n + len(driven.names) + 10) + 3.0 * n * n
        self._step = 0.0

    def advance(
        self, t: float, state: np.ndarray, sizes: np.ndarray, end: float, most: int
    ) -> tuple[Pieces, RunEnded | None]:
        """As `Taylor.advance`."""
        pieces, status, self._step = self._engine.advance(t, state, sizes, self._step, end, most)
        return pieces, _WHY.get(status)

    def forget(self) -> None:
        """The next block finds its first step anew."""
        self._step = 0.0


_WHY = {stiff_kernel.STEP_TOO_SMALL: RunEnded.STEP_TOO_SMALL, stiff_kernel.TOO_LARGE: RunEnded.RAN_AWAY}


class Choice:
    """The engines of one run, and which one is on. steps: how many each has taken so far."""

    def __init__(self, system: System, driven: Drive, tolerance: float, method: str) -> None:
        stiff = Stiff(system, driven, tolerance)
        made: dict[str, Taylor | Stiff] = {}
        if method != "rosenbrock":
            made["taylor"] = Taylor(system, driven, tolerance, stiff.moving)
        if method != "taylor":
            made["rosenbrock"] = stiff
        self.on, *self._resting = made.values()
        self.steps = dict.fromkeys(made, 0)
        self._since = 0  # steps since the last trial
        self._pause = _FIRST  # steps to the next one
        self._step = 0.0  # mean step at the last trial

    def advance(
        self, t: float, state: np.ndarray, sizes: np.ndarray, end: float, most: int
    ) -> tuple[Pieces, RunEnded | None]:
        """A block of steps, at most `most`, towards `end`; why it cannot go on, if so. Moves state and sizes on."""
        before, before_sizes = state.copy(), sizes.copy()
        block = min(most, BLOCK)
        if self._resting:
            block = min(block, max(self._pause - self._since, 1))
        pieces, why = self.on.advance(t, state, sizes, end, block)
        if why is not None and self._resting and not len(pieces):
            # what one cannot do the other may
            state[:], sizes[:] = before, before_sizes
            self._change()
            pieces, why = self.on.advance(t, state, sizes, end, min(most, _FIRST))
        elif why is not None and self._resting:
            why = None  # the good steps first: the next call finds out
        self.steps[self.on.name] += len(pieces)
        self._since += len(pieces)
        if self._resting and why is None and len(pieces) and pieces.times[-1] < end:
            self._compare(pieces, state, sizes, end)
        return pieces, why

    def _compare(self, pieces: Pieces, state: np.ndarray, sizes: np.ndarray, end: float) -> None:
        """Let the other engine try, where it is time to, and change to it if it is cheaper."""
        t = float(pieces.times[-1])
        mean = (t - pieces.times[0]) / len(pieces)
        if self._since < self._pause and not mean < _CHANGED * self._step:
            return
        self._since, self._step, self._pause = 0, mean, min(2 * self._pause, _LAST)
        if cheaper(self._resting[0], self.on.cost, mean, t, state, sizes, end):
            self._change()

    def _change(self) -> None:
        self.on, self._resting = self._resting[0], [self.on]
        self.on.forget()
        self._since, self._pause, self._step = 0, _FIRST, 0.0


def cheaper(
    other: Taylor | Stiff,
    cost: float,
    mean: float,
    t: float,
    state: np.ndarray,
    sizes: np.ndarray,
    end: float,
) -> bool:
    """Whether an engine, tried from here, costs clearly less than one whose steps cost `cost` and are `mean` long."""
    other.forget()
    tried, why = other.advance(t, state.copy(), sizes.copy(), end, _TRIAL)
    other.forget()
    if why is not None or not len(tried):
        return False
    # its last steps: the first ones only find the length
    late = tried.times[-1 - max(1, (len(tried) + 1) // 3) :]
    step = float(late[-1] - late[0]) / (late.size - 1)
    if step / other.cost > _BETTER * mean / cost:
        return True
    arrived = bool(tried.times[-1] >= end)
    return arrived and len(tried) * other.cost * _BETTER < (end - t) / mean * cost
