"""Quasi-static sweeps: a parameter moves on step by step, each time the system settles, and jumps are closed in on.

Steps and not a ramp: on a ramp a trajectory stays beside a state long after it has lost its stability (delayed
bifurcation), the longer the slower the ramp and the smaller the noise. Held steps with a small push have no such delay.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from rainwind.dynamics.extremes import extremes_between
from rainwind.dynamics.simulate import simulate
from rainwind.dynamics.system import System, as_system, number
from rainwind.dynamics.trajectory import RunEnded
from rainwind.errors import InputError, is_interrupt
from rainwind.parameters import unknown_name

Progress = Callable[[float], None]
_TURN = 2.0 * np.pi
_BINS = 10  # pieces of a block, over each of which extremes are taken
_BIG = (
    0.5  # of a state's scale: between neighbouring values of the parameter this is a jump, or too long a step
)
_CALM = 2  # blocks in a row in which little is still to come
_NOTHING = 1e-7  # of a scale: change for rounding and the integrator
_PATIENCE = 10.0  # times `longest`: at the end of a step before what looks like a jump
_GROWS = 3  # steps without trouble after which the step is doubled


class SweepEnded(Enum):
    """Why a sweep ended."""

    AT_END = "the parameter reached its end"
    LEFT = "the system settled nowhere: a run ended before its time"
    INTERRUPTED = "interrupted by the user"


@dataclass(frozen=True)
class Level:
    """One held value of the parameter: the state at the end (n,), lowest and highest values (n,) over the last block.

    held: for how long. steady: whether the extremes had stopped changing; if not, `longest` was over, and low and high
    are those of whatever went on (a very slow approach, beats, chaos).
    """

    value: float
    state: np.ndarray
    low: np.ndarray
    high: np.ndarray
    held: float
    steady: bool

    @property
    def amplitude(self) -> np.ndarray:
        """Half peak-to-peak of each state (n,)."""
        return 0.5 * (self.high - self.low)

    @property
    def middle(self) -> np.ndarray:
        """Half way between lowest and highest (n,)."""
        return 0.5 * (self.high + self.low)


@dataclass(frozen=True)
class SweepJump:
    """Between two levels the system went elsewhere; value: half way between them; after: None if nowhere.

    They are no more than the finest step apart, unless the level before it had not settled even with patience: beside
    a fold of cycles the system lingers where the cycle was. Then `before` is the one before that.
    """

    before: Level
    after: Level | None
    value: float


@dataclass(frozen=True, eq=False)
class Sweep:
    """One sweep, its levels in order of time, the jumps, and why it ended."""

    along: str
    states: tuple[str, ...]
    rising: bool
    levels: tuple[Level, ...]
    jumps: tuple[SweepJump, ...]
    ended: SweepEnded
    note: str = ""

    @property
    def values(self) -> np.ndarray:
        """The parameter's values (m,)."""
        return np.array([level.value for level in self.levels])

    def __getitem__(self, name: str) -> np.ndarray:
        """Half peak-to-peak of a state at each value; "min y" and "max y" for its extremes."""
        of, _, state = name.rpartition(" ")
        if state not in self.states or of not in ("", "min", "max"):
            raise unknown_name(name, self.states, "state")
        i = self.states.index(state)
        pick = {"": "amplitude", "min": "low", "max": "high"}[of]
        return np.array([getattr(level, pick)[i] for level in self.levels])


def sweep(
    model: Any,
    along: str,
    *,
    start: Any,
    until: tuple[float, float],
    step: float,
    finest: float,
    scales: Mapping[str, float],
    push: Mapping[str, float],
    hold: float,
    longest: float,
    accuracy: float = 1e-4,
    tolerance: float = 1e-9,
    progress: Progress | None = None,
) -> Sweep:
    """Move a parameter from until[0] to until[1] in steps, and let the system settle at each value.

    start: a state at until[0]. scales: what counts as large for the states that are watched. push: added to states at
    every new value, so that nothing stays on an unstable state for want of a disturbance; small beside the scales. At
    each value blocks of `hold` seconds, many periods, follow each other until the extremes over a tenth of a block
    change so little, and less each time, that less than `accuracy` times the scales is still to come, or `longest`
    seconds are over (before a jump ten times that). Where extremes change by more than half a scale from one value to
    the next, the step is halved and tried again from the state before; what is left at the `finest` step is a jump.
    progress(value) is called often.
    A run that ends early, or Ctrl-C, gives what there is up to then: `ended` says why. Raises InputError.
    """
    system = as_system(model)
    first, last = (number(end, f"an end of the range of {along}") for end in until)
    if along not in system.parameters:
        raise unknown_name(along, system.parameters, "parameter")
    for name in (*scales, *push):
        if name not in system.states:
            raise unknown_name(name, system.states, "state")
    if not scales or not all(number(size, "a scale") > 0.0 for size in scales.values()):
        raise InputError(
            f"scales = {dict(scales)!r}: give what counts as large, above 0, for one state or more"
        )
    if first == last:
        raise InputError(f"the range of {along} is one value, {first:g}; give two different ends")
    if not 0.0 < number(finest, "finest") <= number(step, "step"):
        raise InputError(f"step = {step!r}, finest = {finest!r}: give 0 < finest <= step")
    if not 0.0 < number(hold, "hold") <= number(longest, "longest"):
        raise InputError(f"hold = {hold!r}, longest = {longest!r}: give 0 < hold <= longest")
    if not number(accuracy, "accuracy") > 0.0:
        raise InputError(f"accuracy = {accuracy!r}: give a number above 0")
    for end in (first, last):
        system.allowed({along: end})
    holder = _Holder(system, along, dict(scales), dict(push), hold, longest, accuracy, tolerance, progress)
    return _walk(holder, system.state(getattr(start, "state", start)), first, last, step, finest)


def _walk(holder: "_Holder", x: np.ndarray, first: float, last: float, step: float, finest: float) -> Sweep:
    sign = 1.0 if last > first else -1.0
    levels: list[Level] = []
    jumps: list[SweepJump] = []
    ended, note, h, good = SweepEnded.AT_END, "", step, 0
    value = first
    try:
        while True:
            level = holder.settle(value, x)
            before = levels[-1] if levels else None
            while before is not None and not before.steady and holder.far(before, level):
                if holder.lingers(before):
                    break
                # it had not settled, so this is no jump yet: wait there for as long as it takes
                gone = levels.pop()
                if jumps and jumps[-1].after is gone:  # judged anew, with what it comes to
                    jumps.pop()
                value, level = before.value, holder.settle(before.value, before.state, patient=True)
                before = levels[-1] if levels else None
            far = before is not None and holder.far(before, level)
            if far and before is not None and abs(value - before.value) > finest * (1.0 + 1e-9):
                h, good, x = max(0.5 * abs(value - before.value), finest), 0, before.state
                value = before.value + sign * h
                continue
            if far and before is not None:
                k = len(levels) - 1
                while k > 0 and holder.lingers(levels[k]) and not (jumps and levels[k] is jumps[-1].after):
                    k -= 1
                jumps.append(SweepJump(levels[k], level, 0.5 * (levels[k].value + value)))
                h = step
            if level is None:
                ended, note = SweepEnded.LEFT, f"at {holder.along} = {value:.6g}: {holder.note}"
                break
            levels.append(level)
            x = level.state
            if value == last:
                break
            good += 1
            if good >= _GROWS:
                h, good = min(2.0 * h, step), 0
            value = level.value + sign * h
            if sign * (last - value) < 0.5 * finest:
                value = last
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
        ended = SweepEnded.INTERRUPTED
    return Sweep(holder.along, holder.system.states, sign > 0, tuple(levels), tuple(jumps), ended, note)


@dataclass(eq=False)
class _Holder:
    """Holds the parameter at a value until the system has settled."""

    system: System
    along: str
    scales: dict[str, float]
    push: dict[str, float]
    hold: float
    longest: float
    accuracy: float
    tolerance: float
    progress: Progress | None
    note: str = ""

    def __post_init__(self) -> None:
        self.watched = [self.system.states.index(name) for name in self.scales]
        self.sizes = np.array(list(self.scales.values()))

    def far(self, one: Level, other: Level | None) -> bool:
        """Whether two levels are so far apart that a jump lies between them, or the step was too long."""
        if other is None:
            return True
        gaps = np.maximum(np.abs(one.low - other.low), np.abs(one.high - other.high))[self.watched]
        return bool(np.any(gaps > _BIG * self.sizes))

    def lingers(self, level: Level) -> bool:
        """Whether a level had not settled even with patience: it may be on its way elsewhere."""
        return not level.steady and level.held > self.longest

    def settle(self, value: float, x: np.ndarray, *, patient: bool = False) -> Level | None:
        """The level at a value, from a state; None if a run ended early, and `note` says how.

        patient: it has been held for `longest` already, and goes on for some times that.
        """
        at = self.system.with_parameters({self.along: value})
        x, held = x.copy(), self.longest if patient else 0.0
        longest = _PATIENCE * self.longest if patient else self.longest
        last, calm = np.inf, 0
        for name, by in self.push.items():
            x[at.states.index(name)] += 0.0 if patient else by
        while True:
            if self.progress is not None:
                self.progress(value)
            run = simulate(at, x, duration=self.hold, tolerance=self.tolerance)
            if run.ended is RunEnded.INTERRUPTED:
                raise KeyboardInterrupt
            if not run.finished:
                self.note = f"{run.ended.value} {run.note}".strip()
                return None
            held += self.hold
            turned = np.array([name in run.turning for name in run.states]) * np.round((run.end - x) / _TURN)
            low, high = extremes_between(run, np.linspace(0.0, self.hold, _BINS + 1))
            x = run.end - turned * _TURN
            # what goes round for ever has no extremes
            low[:, turned != 0], high[:, turned != 0] = -np.pi, np.pi
            change = float(
                np.max(np.maximum(np.ptp(low, axis=0), np.ptp(high, axis=0))[self.watched] / self.sizes)
            )
            calm = calm + 1 if self._is_calm(change, last) else 0
            last, steady = change, calm >= _CALM
            if steady or held + self.hold > longest:
                lowest, highest = low.min(axis=0), high.max(axis=0)
                # a state that turns may have settled some turns away: it counts from -90 to 270 degrees
                turns = np.floor((0.5 * (lowest + highest) + 0.5 * np.pi) / _TURN)
                away = np.array([name in run.turning for name in run.states]) * turns * _TURN
                return Level(value, x - away, lowest - away, highest - away, held, steady)

    def _is_calm(self, change: float, last: float) -> bool:
        """Whether what is still to come, if each block changes less than the one before by the same ratio, is little.

        What grows, however slowly, is not calm.
        """
        if change <= _NOTHING:
            return True
        ratio = change / last
        return ratio < 1.0 and change * ratio / (1.0 - ratio) <= self.accuracy
