"""What one ensemble computes, as plain data that travels to other processes; and the work on some of its rows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from threading import Lock
from typing import Any

import numpy as np

from rainwind.dynamics.drive import Drive
from rainwind.dynamics.engines import Choice, Stiff, cheaper, taylor_cost
from rainwind.dynamics.kernels import reductions as kernel
from rainwind.dynamics.kernels import taylor as taylor_kernel
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.reductions import Gathered, Marked, Reduction, View
from rainwind.dynamics.system import System
from rainwind.dynamics.tape import Tape
from rainwind.dynamics.taylor import Block, TaylorEngine
from rainwind.dynamics.trajectory import RunEnded

ENDED = tuple(RunEnded)
NOT_DONE = -1
PAUSE = 8192  # Taylor steps of a trajectory, after each of which the stiff method is tried on it
_BLOCK = 64
_NODES = 8  # degree of the polynomials for observables along steps of the stiff method
_GREW = 1e6
_KEPT = 4  # engines
_HUGE = 1e90
_LOST = 1e3  # tolerances below which a disturbance is rounding


@dataclass(frozen=True, eq=False)
class Plan:
    """One ensemble without its rows.

    flow: the tape of all states, those of a disturbance among them; stops: times up to the end at which disturbances
    are shortened again, the end alone where there are none; full: with the margins of the model's limits that
    end a trajectory, then the observables, as further outputs; extra: tapes of those alone. base (P,): the parameters'
    values; columns: numbers of the parameters that rows give.
    """

    flow: Tape
    full: Tape
    extra: tuple[Tape, ...]
    margins: tuple[str, ...]
    view: View
    base: np.ndarray
    columns: tuple[int, ...]
    drive: Drive
    tolerance: float
    most_steps: int
    stops: tuple[float, ...]
    reductions: tuple[Reduction, ...]

    @property
    def width(self) -> int:
        """How many states the model has; the disturbance's come after them."""
        return len(self.view.states)

    @property
    def disturbed(self) -> bool:
        """Whether a disturbance is followed."""
        return len(self.flow.states) > self.width


@dataclass(frozen=True, eq=False)
class Rows:
    """Some rows of an ensemble: numbers begin, ..., begin + m - 1, starts (m, n), values (m, columns)."""

    begin: int
    starts: np.ndarray
    values: np.ndarray

    def __len__(self) -> int:
        return len(self.starts)


@dataclass(frozen=True, eq=False)
class Done:
    """What came of some rows: final states (m, n), times (m,), ended (m,) as numbers into ENDED, limits (m,), the
    number of the limit that was left or -1, steps (m, 2) of both methods, and the arrays of all reductions by label."""

    begin: int
    final: np.ndarray
    times: np.ndarray
    ended: np.ndarray
    limits: np.ndarray
    steps: np.ndarray
    found: dict[str, np.ndarray]

    def __len__(self) -> int:
        return len(self.final)


def compute(plan: Plan, rows: Rows, stopped: Callable[[], bool] = lambda: False) -> Done | None:
    """All trajectories of some rows; None where `stopped` said so on the way.

    Each trajectory's numbers follow from its own start and parameters alone.
    """
    return _Work(plan, rows, stopped).run()


class _Work:
    def __init__(self, plan: Plan, rows: Rows, stopped: Callable[[], bool]) -> None:
        many, n = len(rows), len(plan.flow.states)
        self.plan, self.rows, self.stopped = plan, rows, stopped
        self.parameters = np.tile(plan.base, (many, 1))
        self.parameters[:, list(plan.columns)] = rows.values
        self.x = np.zeros((many, n))
        self.x[:, : plan.width] = rows.starts
        self.x[:, plan.width :] = 1.0 / np.sqrt(plan.width)  # a disturbance, where one is followed
        self.growth = np.zeros(many)  # the logarithm of what it has been shortened by
        self.t, self.sizes = np.zeros(many), np.zeros((many, n))
        self.ended = np.full(many, NOT_DONE)
        self.limits, self.steps = np.full(many, -1), np.zeros((many, 2), dtype=np.int64)
        self.cuts, self.cut_states = np.full(many, np.inf), np.zeros((many, n))
        self.margins = len(self.x[0]) + np.arange(len(plan.margins))
        self.gathered: list[Gathered] = [one.gather(plan.view, many) for one in plan.reductions]

    def run(self) -> Done | None:
        left = np.arange(len(self.rows))
        for k in range(len(self.plan.stops)):
            left = self._until(k, left)
            if left is None:
                return None
        return self._done()

    def _until(self, k: int, left: np.ndarray) -> np.ndarray | None:
        """Some trajectories to a stop; those that go on from there, None where `stopped` said so."""
        plan, stop, arrived = self.plan, self.plan.stops[k], []
        last = k == len(plan.stops) - 1
        while left.size:
            before, since = self.t[left], self.steps[left, 0]
            statuses = self._lanes(left, stop, min(PAUSE, plan.most_steps))
            if statuses is None:
                return None
            again = []
            for i, job in enumerate(left.tolist()):
                if self.cuts[job] < np.inf:
                    self.ended[job] = ENDED.index(RunEnded.LEFT_VALIDITY)
                elif statuses[i] == taylor_kernel.ARRIVED:
                    self.t[job] = stop
                    if last:
                        self.ended[job] = ENDED.index(RunEnded.DURATION)
                    arrived.append(job)
                elif self.steps[job].sum() >= plan.most_steps:
                    self.ended[job] = ENDED.index(RunEnded.TOO_MANY_STEPS)
                elif self._goes_on(
                    job, statuses[i], stop, (self.t[job] - before[i]) / max(self.steps[job, 0] - since[i], 1)
                ):
                    again.append(job)
                elif not self._alone(job, k):
                    return None
            left = np.array(again, dtype=np.int64)
        self._mark(stop, arrived)
        return np.array(sorted(arrived), dtype=np.int64)

    def _goes_on(self, job: int, status: int, stop: float, mean: float) -> bool:
        """Whether Taylor steps, `mean` long so far, are the way on for a trajectory that has not arrived."""
        if status == taylor_kernel.RAN_AWAY:
            return self._shortened(job)
        return status == taylor_kernel.TOO_MANY and not self._stiff(job, stop, mean)

    def _mark(self, stop: float, jobs: list[int]) -> None:
        """At a stop: disturbances get their first length again, and reductions are told how much they have grown."""
        if not self.plan.disturbed or not jobs:
            return
        for job in jobs:
            self._shorten(job, self.x[job], self.sizes[job])
        for one in self.gathered:
            if isinstance(one, Marked):
                one.mark(stop, np.array(jobs), self.growth)

    def _shorten(self, job: int, x: np.ndarray, sizes: np.ndarray) -> None:
        """Give a disturbance the length 1, and remember by how much it had grown."""
        w = x[self.plan.width :]
        length = float(np.abs(w).max())
        if length > _LOST * self.plan.tolerance:
            length *= float(np.sqrt(np.sum((w / length) ** 2)))
            self.growth[job] += np.log(length)
            w /= length
        else:  # what is left is rounding
            self.growth[job] = np.nan
            w[:] = 1.0 / np.sqrt(self.plan.width)
        sizes[self.plan.width :] = 0.0  # to be found anew

    def _shortened(self, job: int) -> bool:
        """Whether only the disturbance grew too large: then it is shortened, and the run goes on."""
        x = self.x[job]
        far = self.plan.disturbed and float(np.abs(x[: self.plan.width]).max()) < _HUGE < np.abs(x).max()
        if far and np.all(np.isfinite(x)):
            self._shorten(job, x, self.sizes[job])
            return True
        return False

    def _lanes(self, jobs: np.ndarray, stop: float, most: int) -> np.ndarray | None:
        """Taylor steps of some trajectories, at most so many of each; their statuses."""
        plan = self.plan
        drives = [plan.drive.pieces] if plan.drive.names else ()
        walk = _engine(plan).blocks(
            self.x[jobs], stop - self.t[jobs], self.parameters[jobs], begin=self.t[jobs], sizes=self.sizes[jobs],
            drives=drives, steps=most, block=_BLOCK,
        )  # fmt: skip
        for block in walk:
            numbers = np.where(block.trajectories >= 0, jobs[block.trajectories], -1)
            for k in self._take(Block(numbers, block.times, block.steps, block.coefficients)):
                walk.stop(int(np.flatnonzero(jobs == k)[0]))
            if self.stopped():
                return None
        found = walk.found
        self.x[jobs], self.t[jobs], self.sizes[jobs] = found.states, found.times, found.sizes
        self.steps[jobs, 0] += found.steps
        return found.statuses

    def _take(self, block: Block) -> list[int]:
        """Gather from some steps; the trajectories that left the model's limits in them."""
        arrays = block.trajectories, block.times, block.steps, block.coefficients
        gone: list[int] = []
        if self.margins.size:
            here = np.unique(block.trajectories)
            here = here[here >= 0]
            before = self.cuts[here] < np.inf
            kernel.margins(*arrays, self.margins, self.cuts, self.limits, self.cut_states)
            gone = here[(self.cuts[here] < np.inf) & ~before].tolist()
        for one in self.gathered:
            one.take(block, self.cuts)
        return gone

    def _stiff(self, job: int, stop: float, mean: float) -> bool:
        """Whether the stiff method costs less from here, by the rule of `simulate`."""
        plan = self.plan
        stiff = Stiff(self._system(job), plan.drive, plan.tolerance)
        cost = taylor_cost(_engine(plan).order, stiff.moving)
        return cheaper(stiff, cost, mean, self.t[job], self.x[job], self.sizes[job], stop)

    def _system(self, job: int) -> System:
        names = self.plan.flow.parameters
        values = dict(zip(names, self.parameters[job].tolist(), strict=True))
        return System(_no_rhs, self.plan.flow.states, values, tape=self.plan.flow)

    def _alone(self, job: int, k: int) -> bool:
        """One trajectory from before stop number k to its end, by whichever method costs less; False where `stopped`
        said so."""
        plan = self.plan
        choice = Choice(self._system(job), plan.drive, plan.tolerance, "auto")
        x, sizes, t = self.x[job].copy(), self.sizes[job].copy(), float(self.t[job])
        before, why = self.steps[job].copy(), None
        for stop in plan.stops[k:]:
            while t < stop and why is None:
                pieces, why = choice.advance(
                    t, x, sizes, stop, max(1, plan.most_steps - int(self.steps[job].sum()))
                )
                if len(pieces):
                    self._take(self._block(pieces, job))
                    t = float(pieces.times[-1])
                self.steps[job] = before + np.array([choice.steps["taylor"], choice.steps["rosenbrock"]])
                if self.cuts[job] < np.inf:
                    why = RunEnded.LEFT_VALIDITY
                elif why is None and t < stop and self.steps[job].sum() >= plan.most_steps:
                    why = RunEnded.TOO_MANY_STEPS
                if self.stopped():
                    return False
            self.x[job], self.sizes[job], self.t[job] = x, sizes, t
            if why is not None:
                break
            self._mark(stop, [job])
            x, sizes = self.x[job].copy(), self.sizes[job].copy()
        if why in (RunEnded.STEP_TOO_SMALL, RunEnded.RAN_AWAY):
            start = float(np.abs(self.rows.starts[job]).max(initial=0.0))
            grew = float(np.abs(x[: plan.width]).max()) > _GREW * start
            why = RunEnded.RAN_AWAY if grew else RunEnded.STEP_TOO_SMALL
        self.ended[job] = ENDED.index(why or RunEnded.DURATION)
        return True

    def _block(self, pieces: Pieces, job: int) -> Block:
        """Pieces of one trajectory as a block of one lane, with the rows that its tape does not give."""
        plan, k = self.plan, len(pieces)
        lengths = np.diff(pieces.times)
        c = pieces.coefficients
        if plan.extra:
            extra = self._along(pieces, lengths, job)
            width = max(c.shape[2], extra.shape[2])
            c = np.concatenate(
                [np.pad(part, ((0, 0), (0, 0), (0, width - part.shape[2]))) for part in (c, extra)], axis=1
            )
        numbers = np.full((k, 1), job)
        return Block(numbers, pieces.times[:-1, None], lengths[:, None], np.ascontiguousarray(c[..., None]))

    def _along(self, pieces: Pieces, lengths: np.ndarray, job: int) -> np.ndarray:
        """Polynomials of the extra outputs through their values at Chebyshev's points: (k, outputs, 9)."""
        plan, k = self.plan, len(pieces)
        shares = 0.5 - 0.5 * np.cos(np.pi * np.arange(_NODES + 1) / _NODES)
        s = lengths[:, None] * shares
        powers = s[..., None] ** np.arange(pieces.coefficients.shape[2])
        x = np.einsum("kij,ksj->ksi", pieces.coefficients[:, : plan.width], powers)
        inputs = np.tile(np.concatenate([np.zeros(plan.width), self.parameters[job]]), (k * s.shape[1], 1))
        inputs[:, : plan.width] = x.reshape(-1, plan.width)
        if plan.drive.names:
            d = plan.drive.on(pieces.times)
            driven = np.einsum("kmj,ksj->ksm", d, s[..., None] ** np.arange(d.shape[2]))
            # numbered among the inputs of the flow, whose states may be more
            at = plan.drive.numbers - len(plan.flow.states) + plan.width
            inputs[:, at] = driven.reshape(len(inputs), -1)
        found = np.stack([values(*tape.arrays, inputs)[:, 0] for tape in plan.extra], axis=1)
        found = found.reshape(k, s.shape[1], len(plan.extra))
        fit = np.linalg.inv(shares[:, None] ** np.arange(_NODES + 1))
        unit = np.einsum("js,kso->koj", fit, found)
        return unit / lengths[:, None, None] ** np.arange(_NODES + 1)

    def _done(self) -> Done:
        plan, cut = self.plan, self.cuts < np.inf
        final = np.where(cut[:, None], self.cut_states, self.x)[:, : plan.width]
        times = np.where(cut, self.cuts, self.t)
        found: dict[str, np.ndarray] = {}
        for reduction, one in zip(plan.reductions, self.gathered, strict=True):
            until = getattr(reduction, "until", None)
            missed = times < (plan.view.duration if until is None else until)
            for name, array in one.found().items():
                array = np.ascontiguousarray(array, dtype=float)
                if name not in ("time_to", "returns", "first_return"):
                    array[missed] = np.nan  # the window was not over
                found[f"{reduction.name} {name}" if reduction.name else name] = array
        return Done(self.rows.begin, final, times, self.ended, self.limits, self.steps, found)


def _no_rhs(x: Any, p: Any) -> Sequence[Any]:
    raise AssertionError("the tape is there")


_engines: dict[tuple[str, float, tuple[str, ...]], TaylorEngine] = {}
_making = Lock()


def _engine(plan: Plan) -> TaylorEngine:
    """One engine for all threads and chunks."""
    key = tape_key(plan.full), plan.tolerance, plan.drive.names
    with _making:
        if key not in _engines:
            while len(_engines) >= _KEPT:
                _engines.pop(next(iter(_engines)))
            _engines[key] = TaylorEngine(plan.full, plan.tolerance, driven=plan.drive.names)
        return _engines[key]


def tape_key(tape: Tape) -> str:
    """Equal for tapes that compute the same."""
    arrays = (*tape.arrays,)
    text = f"{tape.states} {tape.parameters}".encode()
    return sha256(text + b"".join(a.tobytes() for a in arrays)).hexdigest()
