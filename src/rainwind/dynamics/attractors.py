"""What trajectories end on: an equilibrium, a cycle, a torus, chaos; or what the model is about is lost.

Each trajectory is followed in rounds, each twice as long as all before, and looked at over a window at the end of each
round, until it is clear where it goes:

* lost: one of the model's `losses` was negative throughout the window;
* equilibrium: Newton from the window's end finds a stable one within 5 % of the trajectory's size, and what is left
  shrinks at the rate of its slowest eigenvalues, half of it at least;
* cycle (or whole turns): in two rounds one after the other `settled` finds the same cycle, at most 1 % of its amplitude
  missing, sizes and periods alike within 2 %;
* what is none of these at the end of the last round is followed once more, for half of all the time, with a small
  disturbance across the flow (`transverse.py`). Chaos: it grows by more than e^10, at a rate above three standard
  errors. Torus: its rate is zero within three standard errors, or within one e-folding, the ranges of all states in
  both halves are alike within 5 %, and the amplitude goes up and down by 2 % or more within ten windows. A
  cycle: it shrinks by more than e^10, and `settled` finds the cycle with at most 5 % missing. Else undecided.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from dataclasses import dataclass, field, replace
from enum import Enum
from os import cpu_count
from threading import Event as Flag
from typing import Any

import numpy as np

from rainwind.dynamics.kernels import taylor as kernel
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.newton import solve_equilibrium, spectrum
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.run_inputs import turning_states
from rainwind.dynamics.settled import Settled, settled
from rainwind.dynamics.system import System, as_system, number
from rainwind.dynamics.tape import trace_function
from rainwind.dynamics.taylor import TaylorEngine
from rainwind.dynamics.transverse import Transverse, transverse_growth
from rainwind.errors import InputError, is_interrupt

Progress = Callable[[int, int, str], None]
BATCH = 64  # trajectories that one thread follows together
LINEAR = 0.05  # of a trajectory's size: near an equilibrium
MISSING, NEARLY, ALIKE = 0.01, 0.05, 0.02
EFOLDS = 10.0
ERRORS = 3.0
SAME_RANGE = 0.05
BEATS, ENVELOPE = (
    0.02,
    50,
)  # least change of amplitude on a torus; parts of the last look in which it is taken
LAST = 10.0  # windows that the very last look takes
_STEPS = 4_000_000  # of one trajectory in one round
_BLOCKS = 20
_TURN, _SAMPLES = 2.0 * np.pi, 1000


class Kind(Enum):
    """What a trajectory ends on."""

    EQUILIBRIUM = "equilibrium"
    CYCLE = "cycle"
    TURNS = "whole turns"
    TORUS = "torus"
    CHAOS = "chaos"
    LOST = "lost"
    RAN_AWAY = "ran away"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Attractor:
    """What one trajectory ends on, and why we think so.

    amplitude (half peak to peak), mean: of each state over the window, a cycle's over its period. period: a cycle's.
    rate: what tells, in 1/time: at an equilibrium the largest real part of its eigenvalues; where a disturbance across
    the flow was followed, its mean rate of growth, with `error` and `efolds`, the log of its growth; else nan. left:
    the share of the amplitude still missing. after: the time at which it was decided. end: the last state (n,).
    """

    kind: Kind
    amplitude: Mapping[str, float]
    mean: Mapping[str, float]
    end: np.ndarray
    after: float
    period: float | None = None
    turns: Mapping[str, int] = field(default_factory=dict)
    rate: float = float("nan")
    error: float = float("nan")
    efolds: float = float("nan")
    left: float = float("nan")
    note: str = ""

    def __str__(self) -> str:
        sizes = ", ".join(f"{name} {size:.4g}" for name, size in self.amplitude.items())
        what = f"{self.kind.value} ({self.note})" if self.note else self.kind.value
        period = f" of period {self.period:.6g}" if self.period is not None else ""
        rate = f", rate {self.rate:.3g}" if np.isfinite(self.rate) else ""
        return f"{what}{period} after {self.after:.4g}: half peak to peak {sizes}{rate}"


@dataclass(frozen=True)
class Attractors(Sequence):
    """What each of N trajectories ends on, in order; None where the work was interrupted before."""

    found: tuple[Attractor | None, ...]

    def __getitem__(self, i: Any) -> Any:
        return self.found[i]

    def __len__(self) -> int:
        return len(self.found)

    @property
    def interrupted(self) -> bool:
        """Whether some are missing."""
        return None in self.found

    def count(self, value: Any) -> int:
        """How many are of a kind."""
        return sum(one is not None and one.kind is value for one in self.found)


def attractor(
    model: Any, start: Any, *, longest: float, window: float | None = None, tolerance: float = 1e-8
) -> Attractor:
    """What the trajectory from one start ends on. As `attractors`; Ctrl-C raises KeyboardInterrupt."""
    system = as_system(model)
    x = system.state(getattr(start, "end", getattr(start, "state", start)))
    found = attractors(system, x[None], longest=longest, window=window, tolerance=tolerance)[0]
    if found is None:
        raise KeyboardInterrupt
    return found


def attractors(
    model: Any,
    starts: Any,
    *,
    longest: float,
    varying: Mapping[str, Any] | None = None,
    window: float | None = None,
    tolerance: float = 1e-8,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Attractors:
    """What the trajectories from N starts (N, n) or one start (n,) end on.

    varying: parameters by name, N numbers each. longest: the time after which the last look decides what is still
    open; half of it again is spent on what then may be a torus or chaos. window: how long each look is, a dozen periods
    at least; by default a fortieth. tolerance: of each step. workers: threads; results do not depend on it.
    progress(done, total, what) is called from the calling thread. Ctrl-C gives what is done, None for the rest.
    Raises InputError.
    """
    system = as_system(model)
    if system.refusal is not None:
        raise InputError(
            "this model refuses states beyond its coefficients, so that its trajectories have no end to be told; "
            "choose outside='blend'"
        )
    x, p = _jobs(system, starts, varying)
    if not number(longest, "longest") > 0.0:
        raise InputError(f"longest = {longest!r}: give a positive time")
    window = longest / 40.0 if window is None else number(window, "window")
    if not 0.0 < window <= longest / 4.0:
        raise InputError(f"window = {window!r}: give a positive time, a quarter of the longest at most")
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
        raise InputError(f"workers = {workers!r}: give a whole number of 1 or more")
    waiting: dict[Any, slice] = {}
    judge = Judge(system, turning_states(system, x[0]), float(longest), float(window), float(tolerance))
    found: list[Attractor | None] = [None] * len(x)
    batches = [slice(k, min(k + BATCH, len(x))) for k in range(0, len(x), BATCH)]
    pool = ThreadPoolExecutor(workers or cpu_count() or 1)
    try:
        waiting = {pool.submit(judge.follow, x[one], p[one]): one for one in batches}
        if progress is not None:
            progress(0, len(x), "trajectories")
        while waiting:
            done, _ = wait(waiting, timeout=0.2, return_when=FIRST_COMPLETED)
            for future in done:
                found[waiting.pop(future)] = future.result()
            if progress is not None:
                count = sum(one is not None for one in found)
                progress(count, len(x), f"{count} of {len(x)} trajectories")
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
        for future, one in waiting.items():
            if future.done() and not future.cancelled() and future.exception() is None:
                found[one] = future.result()
    finally:
        judge.stop.set()
        pool.shutdown(wait=True, cancel_futures=True)
    return Attractors(tuple(found))


def _jobs(system: System, starts: Any, varying: Mapping[str, Any] | None) -> tuple[np.ndarray, np.ndarray]:
    """Starts (N, n) and parameters (N, m)."""
    try:
        x = np.array(starts, dtype=float, ndmin=2)
    except (TypeError, ValueError):
        x = np.zeros((0, 0))
    n = len(system.states)
    if x.ndim != 2 or x.shape[1] != n or not len(x) or not np.all(np.isfinite(x)):
        raise InputError(f"starts must be finite numbers of shape (N, {n}) ({', '.join(system.states)})")
    columns = {}
    for name, given in (varying or {}).items():
        system.number(name)
        try:
            column = np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            column = np.full((1, 1), np.nan)
        if column.ndim != 1 or not np.all(np.isfinite(column)) or not column.size:
            raise InputError(f"varying['{name}'] must be finite numbers, one for each trajectory")
        for value in (column.min(), column.max()):
            system.allowed({name: float(value)})
        columns[name] = column
    many = {len(x), *(column.size for column in columns.values())} - {1}
    if len(many) > 1:
        raise InputError(f"starts and varying must be of one length; got {sorted(many)}")
    count = max(many, default=1)
    p = np.tile(np.array(list(system.parameters.values()), dtype=float), (count, 1))
    for name, column in columns.items():
        p[:, list(system.parameters).index(name)] = column
    return np.array(np.broadcast_to(x, (count, n))), p


class _StoppedError(Exception):
    """Nobody waits for this batch any more."""


class Judge:
    """Follows batches of trajectories and says what each ends on; safe to use from several threads."""

    def __init__(
        self, system: System, turning: tuple[str, ...], longest: float, window: float, tolerance: float
    ) -> None:
        self.system, self.longest, self.window, self.tolerance = system, longest, window, tolerance
        self.engine = TaylorEngine(system, tolerance)
        self.stop = Flag()
        self.turning, self.turns = turning, np.array([name in turning for name in system.states])
        self.losses = {
            name: trace_function(function, system.states, system.parameters, name)
            for name, function in system.losses.items()
        }
        ends = [longest]
        while ends[-1] > 8.0 * window:
            ends.append(ends[-1] / 2.0)
        self.rounds = ends[::-1]

    def follow(self, starts: np.ndarray, parameters: np.ndarray) -> list[Attractor]:
        """What each of some trajectories ends on."""
        many = len(starts)
        x, sizes, p = starts.copy(), np.abs(starts), parameters
        found: list[Attractor | None] = [None] * many
        before: list[Attractor | None] = [None] * many
        scales = np.abs(starts)  # the largest that each state has been, in all windows
        left, t = np.arange(many), self.window
        for i, pieces in self._look(np.arange(many), x, sizes, p, found, t):
            scales[i] = np.maximum(scales[i], np.abs(pieces.joints()).max(axis=0))
        left = np.array([i for i in left if found[i] is None], dtype=int)
        for end in self.rounds:
            self._run(left, x, sizes, p, end - self.window - t, found, t)
            left = np.array([i for i in left if found[i] is None], dtype=int)
            t = end
            for i, pieces in self._look(left, x, sizes, p, found, t):
                scales[i] = np.maximum(scales[i], np.abs(pieces.joints()).max(axis=0))
                one = self._judged(pieces, p[i], scales[i], t)
                if _settled(one, before[i]):
                    found[i] = one
                before[i] = one
            left = np.array([i for i in left if found[i] is None], dtype=int)
            if not left.size:
                break
        if left.size:
            for i, one in zip(left, self._across(left, x, sizes, scales, p, before), strict=True):
                found[i] = one
        return [one for one in found if one is not None]

    def _run(
        self, which: np.ndarray, x: np.ndarray, sizes: np.ndarray, p: np.ndarray, duration: float,
        found: list[Attractor | None], t: float,
    ) -> None:  # fmt: skip
        """Move some trajectories on; those that cannot go on are done."""
        if self.stop.is_set():
            raise _StoppedError
        if not which.size:
            return
        run = self.engine.advance(x[which], duration, p[which], sizes=sizes[which], steps=_STEPS)
        x[which], sizes[which] = run.states, run.sizes
        for i, status, at in zip(which, run.statuses, run.times, strict=True):
            if status != kernel.ARRIVED:
                found[i] = self._failed(x[i], int(status), t + float(at))

    def _look(
        self, which: np.ndarray, x: np.ndarray, sizes: np.ndarray, p: np.ndarray,
        found: list[Attractor | None], t: float, long: float = 1.0,
    ) -> Iterator[tuple[int, Pieces]]:  # fmt: skip
        """The windows at the end of a round, one trajectory after the other; x and sizes are moved on."""
        at_once = 16 if long == 1.0 else 4  # in memory
        for first in range(0, which.size, at_once):
            if self.stop.is_set():
                raise _StoppedError
            part = which[first : first + at_once]
            looks, run = self.engine.pieces(
                x[part], long * self.window, p[part], sizes=sizes[part], steps=_STEPS
            )
            x[part], sizes[part] = run.states, run.sizes
            for i, status, pieces in zip(part, run.statuses, looks, strict=True):
                if status != kernel.ARRIVED:
                    found[i] = self._failed(x[i], int(status), t)
                else:
                    yield int(i), pieces

    def _failed(self, x: np.ndarray, status: int, t: float) -> Attractor:
        kind = Kind.UNDECIDED if status == kernel.TOO_MANY else Kind.RAN_AWAY
        note = {
            kernel.TOO_MANY: "more steps than allowed: stiff or wild here",
            kernel.STUCK: "the steps became too small: rates without bound",
        }.get(status, "")
        nothing = dict.fromkeys(self.system.states, float("nan"))
        return Attractor(kind, nothing, nothing, x.copy(), t, note=note)

    def _judged(self, pieces: Pieces, p: np.ndarray, scales: np.ndarray, t: float) -> Attractor:
        """What one window looks like; an undecided one says what it may become."""
        end, joints = pieces.at(pieces.times[-1]), pieces.joints()
        lowest, highest = joints.min(axis=0), joints.max(axis=0)
        plain = self._ranging(Attractor(Kind.UNDECIDED, {}, {}, end, t), lowest, highest, joints.mean(axis=0))
        for name, tape in self.losses.items():
            inputs = np.concatenate([joints, np.broadcast_to(p, (len(joints), p.size))], axis=1)
            if np.all(values(*tape.arrays, inputs)[:, 0] < 0.0):
                return replace(plain, kind=Kind.LOST, note=name)
        rest = self._equilibrium(joints, pieces.times, p, scales, plain)
        if rest is not None:
            return rest
        first, last = np.array_split(joints, 3)[::2]
        far = np.abs(np.ptp(first, axis=0) - np.ptp(last, axis=0)) > 3.0 * ALIKE * (highest - lowest)
        if np.any(far & ~self.turns):  # sizes still change: not worth a closer look
            return replace(plain, note="amplitudes still change")
        seen = settled(pieces, self.system.states, self.turning, self.tolerance, MISSING)
        return _as_cycle(seen, plain)

    def _equilibrium(
        self, x: np.ndarray, times: np.ndarray, p: np.ndarray, scales: np.ndarray, plain: Attractor
    ) -> Attractor | None:
        """The equilibrium that a window is near, if it is stable and what is left shrinks as it should."""
        scale = np.maximum(scales, 1e-12 * scales.max(initial=1.0))
        if np.any(np.ptp(x, axis=0) > 2.0 * LINEAR * scale):
            return None
        system = self._with(p)
        with np.errstate(all="ignore"):
            solution = solve_equilibrium(system, x.mean(axis=0))
        if solution is None or np.any(np.abs(solution[0] - x).max(axis=0) > LINEAR * scale):
            return None
        growth = float(spectrum(system.jacobian(solution[0]))[0].real)
        gaps = np.abs(solution[0] - x) / scale
        half = times > times[0] + 0.5 * (times[-1] - times[0])
        late, early = float(gaps[half].max()), float(gaps[~half].max())
        noise = 1e3 * self.tolerance
        shrinks = late <= noise or (
            early > 0.0 and np.log(early / late) >= 0.5 * -growth * 0.5 * (times[-1] - times[0])
        )
        if growth < 0.0 and shrinks:
            return replace(
                plain, kind=Kind.EQUILIBRIUM, mean=self._named(solution[0]), rate=growth, left=late,
                amplitude=self._named(np.zeros(solution[0].size)),
            )  # fmt: skip
        if late <= noise:
            note = f"it stays at an unstable equilibrium (growth {growth:.3g}): disturb the start"
            return replace(plain, rate=growth, note=note)
        return None

    def _across(
        self, which: np.ndarray, x: np.ndarray, sizes: np.ndarray, scales: np.ndarray, p: np.ndarray,
        before: Sequence[Attractor | None],
    ) -> list[Attractor]:  # fmt: skip
        """What is still open after the last round: a disturbance across the flow, and one more window."""
        duration = 0.5 * self.longest

        def look(_: float) -> None:
            if self.stop.is_set():
                raise _StoppedError

        run = transverse_growth(
            self.system, x[which], p[which], np.where(self.turns, 1.0, scales[which]), duration, self.window / 20.0,
            self.tolerance, look,
        )  # fmt: skip
        x[which], sizes[which] = run.states[-1], run.sizes
        t, found = self.longest + duration, [None] * len(x)
        judged, beats = {}, {}
        for i, pieces in self._look(which[run.fine], x, sizes, p, found, t, LAST):  # type: ignore[arg-type]
            judged[i] = self._judged(pieces, p[i], scales[i], t)
            beats[i] = self._beats(pieces)
        answers = []
        for k, i in enumerate(which):
            last = judged.get(int(i))
            if last is None:
                answers.append(self._failed(x[i], kernel.RAN_AWAY, t))
            elif last.kind in (Kind.LOST, Kind.EQUILIBRIUM) or np.isfinite(
                last.rate
            ):  # it stays where it began
                answers.append(last)
            else:
                answers.append(self._long_run(run, k, last, before[int(i)], beats[int(i)]))
        return answers

    def _long_run(
        self, run: Transverse, k: int, last: Attractor, before: Attractor | None, beats: float
    ) -> Attractor:
        growth, states, duration = run.growth[:, k], run.states[1:, k], float(run.times[-1])
        edges = np.interp(
            np.linspace(0.0, duration, _BLOCKS + 1), np.append(0.0, run.times), np.append(0.0, growth)
        )
        error = float(np.diff(edges).std(ddof=1) * np.sqrt(_BLOCKS) / duration)
        efolds = float(edges[-1])
        facts = {"rate": efolds / duration, "error": error, "efolds": efolds}
        low, high = states.min(axis=0), states.max(axis=0)
        wide = self._ranging(last, low, high, states.mean(axis=0))
        if _settled(last, before) or (efolds < -EFOLDS and last.left <= NEARLY and last.period is not None):
            return replace(last, **facts, kind=Kind.TURNS if last.turns else Kind.CYCLE, note="")
        if efolds > EFOLDS and facts["rate"] > ERRORS * error:
            return replace(wide, **facts, kind=Kind.CHAOS, period=None, note="")
        first, second = np.array_split(states, 2)
        ranges = np.ptp(first, axis=0), np.ptp(second, axis=0)
        alike = np.abs(ranges[0] - ranges[1]) <= SAME_RANGE * np.maximum(*ranges)
        neutral = abs(efolds) <= min(EFOLDS, max(ERRORS * error * duration, 1.0))
        if neutral and beats >= BEATS and np.all(alike | (self.turns & (low + _TURN <= high))):
            return replace(wide, **facts, kind=Kind.TORUS, period=None, note="")
        note = f"a disturbance across the flow grew by e^{efolds:.3g} in {duration:.4g}; {last.note or last.kind.value}"
        return replace(wide, **facts, kind=Kind.UNDECIDED, note=note)

    def _beats(self, pieces: Pieces) -> float:
        """By how much the amplitude goes up and down again, as a share of it, in the state where that is most."""
        times = np.linspace(pieces.times[0], pieces.times[-1], max(_SAMPLES * ENVELOPE, 4 * len(pieces)))
        x = pieces.at(times)[:, ~self.turns]
        moves = np.ptp(x, axis=0) > 1e-6 * np.abs(x).max(axis=0, initial=0.0)
        most = 0.0
        for column in x[:, moves].T:
            up = np.diff(column) > 0.0
            swings = int(np.count_nonzero(up[1:] != up[:-1])) // 2
            # parts of three swings at least: sizes of shorter ones say nothing
            parts = np.array_split(column, max(1, min(ENVELOPE, swings // 3)))
            sizes = np.array([np.ptp(part) for part in parts])
            steps = np.diff(sizes) / sizes.max()
            most = max(most, min(float(steps[steps > 0.0].sum()), -float(steps[steps < 0.0].sum())))
        return most

    def _ranging(self, one: Attractor, low: np.ndarray, high: np.ndarray, mean: np.ndarray) -> Attractor:
        """With these extremes; a state that went round takes every angle."""
        round_ = self.turns & (high - low >= _TURN)
        amplitude = np.where(round_, 0.5 * _TURN, 0.5 * (high - low))
        return replace(
            one, amplitude=self._named(amplitude), mean=self._named(np.where(round_, np.nan, mean))
        )

    def _with(self, p: np.ndarray) -> System:
        return self.system.with_parameters(dict(zip(self.system.parameters, p.tolist(), strict=True)))

    def _named(self, x: np.ndarray) -> dict[str, float]:
        return dict(zip(self.system.states, np.asarray(x, dtype=float).tolist(), strict=True))


def _as_cycle(seen: Settled, plain: Attractor) -> Attractor:
    """What `settled` saw in a window; a cycle has still to be confirmed by another one."""
    facts: dict[str, Any] = {"period": seen.period, "turns": dict(seen.turns), "left": seen.left}
    if seen.kind in ("cycle", "whole turns"):
        kind = Kind.TURNS if seen.turns else Kind.CYCLE
        return replace(plain, kind=kind, amplitude=seen.amplitude, mean=seen.mean, **facts)
    return replace(plain, note=seen.note, **facts)


def _settled(one: Attractor, before: Attractor | None) -> bool:
    """Whether a window, with the one of the round before, tells what the trajectory ends on."""
    if one.kind in (Kind.LOST, Kind.EQUILIBRIUM):
        return True
    if before is None or one.kind is not before.kind or one.kind not in (Kind.CYCLE, Kind.TURNS):
        return False
    a, b = (np.array(list(each.amplitude.values())) for each in (one, before))
    apart = abs((one.period or 0.0) - (before.period or 0.0))
    return bool(
        np.all(np.abs(a - b) <= ALIKE * np.maximum(a, 1e-3 * a.max()))
        and apart <= ALIKE * (one.period or 0.0)
    )
