"""One trajectory: a start, a duration, parameters that may follow signals, events; the engine is chosen by cost."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rainwind.dynamics.drive import Drive
from rainwind.dynamics.engines import Choice
from rainwind.dynamics.events import Crossings, Event, Function, Watch, checked, joined, none
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.pieces import joined as joined_pieces
from rainwind.dynamics.run_inputs import run_drive, run_parameters, run_start, turning_states
from rainwind.dynamics.signals import Signal
from rainwind.dynamics.system import System, as_system, number
from rainwind.dynamics.trajectory import Excursion, RunEnded, Trajectory
from rainwind.errors import InputError, is_interrupt

Progress = Callable[[int, int, str], None]
TOLERANCES = (1e-15, 1e-2)
# a run blows up where so many steps cover less than this share of all time
_MANY, _NO_TIME = 4096, 1e-7


def simulate(
    model: Any,
    start: Any,
    *,
    duration: float,
    wind: float | Signal | None = None,
    parameters: Mapping[str, float | Signal] | None = None,
    tolerance: float = 1e-9,
    events: Event | Sequence[Event] = (),
    method: Literal["auto", "taylor", "rosenbrock"] = "auto",
    most_steps: int = 500_000,
    progress: Progress | None = None,
) -> Trajectory:
    """Follow a system from t = 0 over a duration.

    start: a state by name (states left out are zero) or in order, an equilibrium, a labelled point, an orbit (its
    phase 0) or a trajectory (its end). parameters: values that replace the model's own; a `Signal` makes one a function
    of time, on whose knots steps stop, and must cover the whole duration. wind: short for the parameter "wind.speed".
    tolerance: of each step, relative to the size that each state has had, 1e-15 to 1e-2. method: "taylor" for smooth
    runs, "rosenbrock" for stiff ones, "auto" takes what costs less and looks again on the way.
    most_steps: of which each keeps its polynomial in memory. progress(done, total, what) is called often.
    A run that cannot go on, or Ctrl-C, gives what there is up to then: `run.ended` says why.
    Raises InputError for anything that makes no sense, a start where a model refuses its coefficients among it.
    """
    system = as_system(model)
    if not number(duration, "duration") > 0.0:
        raise InputError(f"duration = {duration!r}: give a positive time")
    low, high = TOLERANCES
    if not low <= number(tolerance, "tolerance") <= high:
        raise InputError(f"tolerance = {tolerance!r}: give a number from {low:g} to {high:g}")
    if method not in ("auto", "taylor", "rosenbrock"):
        raise InputError(f"method = {method!r}: choose auto, taylor or rosenbrock")
    if isinstance(most_steps, bool) or not isinstance(most_steps, int) or most_steps < 1:
        raise InputError(f"most_steps = {most_steps!r}: give a whole number of 1 or more")
    duration = float(duration)
    given = run_parameters(system, parameters, wind)
    signals = {name: value for name, value in given.items() if isinstance(value, Signal)}
    driven = run_drive(system, signals, duration)
    fixed = {name: value for name, value in given.items() if not isinstance(value, Signal)}
    fixed |= {name: float(signal.at(0.0)) for name, signal in signals.items()}
    if fixed:
        system.allowed(fixed)
        system = system.with_parameters(fixed)
    x = run_start(system, start)
    if system.refusal is not None:
        reason = system.refusal(x, system.parameters)
        if reason is not None:
            raise InputError(f"the run cannot start here: {reason}")
    run = _Run(system, driven, x, duration, float(tolerance), checked(events), method, most_steps, progress)
    run.go()
    return run.trajectory()


@dataclass(frozen=True, eq=False)
class _Block:
    """Steps taken together: their pieces, crossings of what is watched, where they end, and all steps so far."""

    pieces: Pieces
    found: list[Crossings]
    t: float
    x: np.ndarray
    sizes: np.ndarray
    steps: int


@dataclass(eq=False)
class _Run:
    """A run under way: what has been done so far, and what is watched."""

    system: System
    driven: Drive
    start: np.ndarray
    duration: float
    tolerance: float
    events: tuple[Event, ...]
    method: str
    most_steps: int
    progress: Progress | None

    def __post_init__(self) -> None:
        self.blocks = [
            _Block(
                Pieces(np.zeros(1), np.zeros((0, self.start.size, 1))),
                [],
                0.0,
                self.start,
                np.abs(self.start),
                0,
            )
        ]
        self.ended, self.note = RunEnded.DURATION, ""
        self.engines = Choice(self.system, self.driven, self.tolerance, self.method)
        refuses = self.system.refusal is not None
        limits = [
            Event(name, margin, -1 if refuses else 0, refuses)
            for name, (_, margin) in self.system.limits.items()
        ]
        self.watched = [self._watch(event) for event in self.events]
        self.watched += [self._watch(event, kept=True) for event in limits]

    def go(self) -> None:
        """Block after block to the end, or to where it cannot go on."""
        try:
            while self.blocks[-1].t < self.duration and self.ended is RunEnded.DURATION:
                self._advance(self.blocks[-1])
                if self.progress is not None:
                    t = self.blocks[-1].t
                    self.progress(
                        round(1000 * t / self.duration), 1000, f"t = {t:.4g} of {self.duration:.4g}"
                    )
        except (KeyboardInterrupt, SystemError) as error:
            if not is_interrupt(error):
                raise
            self.ended = RunEnded.INTERRUPTED

    def _advance(self, last: _Block) -> None:
        """One more block of steps, cut at the first terminal event in it."""
        left = self.most_steps - last.steps
        if left <= 0:
            self.ended, self.note = RunEnded.TOO_MANY_STEPS, f"{self.most_steps} steps; give most_steps more"
            return
        x, sizes = last.x.copy(), last.sizes.copy()
        pieces, why = self.engines.advance(last.t, x, sizes, self.duration, left)
        driven = self.driven.on(pieces.times)
        found = [watch.crossings(pieces, driven, x) for watch in self.watched]
        terminal = [
            (crossings.times[0], i)
            for i, (watch, crossings) in enumerate(zip(self.watched, found, strict=True))
            if watch.event.terminal and len(crossings)
        ]
        ended, note = RunEnded.DURATION, ""
        if terminal:
            t, i = min(terminal)
            pieces, found = pieces.until(t), [crossings.before(t) for crossings in found]
            x = found[i].state[0]
            ended = RunEnded.EVENT if i < len(self.events) else RunEnded.LEFT_VALIDITY
            note = self._where(i, t, x)
        self.blocks.append(_Block(pieces, found, float(pieces.times[-1]), x, sizes, last.steps + len(pieces)))
        if not terminal and (why is not None or self._blows_up()):
            ended = RunEnded.RAN_AWAY if why is None or self._grew() else why
            state = ", ".join(f"{n} = {v:.5g}" for n, v in zip(self.system.states, x, strict=True))
            note = f"at t = {self.blocks[-1].t:.6g}, {state}"
        self.ended, self.note = ended, note

    def _blows_up(self) -> bool:
        """Whether thousands of steps have covered next to no time while some state grew."""
        last = self.blocks[-1]
        before = next((b for b in reversed(self.blocks) if b.steps <= last.steps - _MANY), None)
        if before is None or last.t - before.t > _NO_TIME * last.t or not len(before.pieces):
            return False
        largest = [np.abs(block.pieces.coefficients[:, :, 0]).max(axis=0) for block in (before, last)]
        return bool(np.any(largest[1] > 1.2 * largest[0]))

    def _grew(self) -> bool:
        """Whether a run that cannot go on was growing without bound: in its last tenth a thousandfold."""
        pieces = joined_pieces([block.pieces for block in self.blocks])
        if not len(pieces):
            return False
        early = pieces.times[:-1] <= 0.9 * pieces.times[-1]
        largest = np.abs(pieces.coefficients[early, :, 0]).max(axis=0, initial=0.0)
        return bool(np.any(np.abs(self.blocks[-1].x) > 1e3 * np.maximum(largest, 1e-300)))

    def trajectory(self) -> Trajectory:
        """What has been done so far."""
        pieces = joined_pieces([block.pieces for block in self.blocks])
        done = self.blocks[1:]
        found = [
            joined([none(watch.event.name, self.system.states), *(block.found[i] for block in done)])
            for i, watch in enumerate(self.watched)
        ]
        many = len(self.events)
        return Trajectory(
            states=self.system.states,
            parameters=dict(self.system.parameters),
            start=self.start,
            end=self.blocks[-1].x,
            pieces=pieces,
            ended=self.ended,
            tolerance=self.tolerance,
            note=self.note,
            events={event.name: found[i] for i, event in enumerate(self.events)},
            outside=self._excursions(found[many:]),
            driven_names=self.driven.names,
            driven=Pieces(pieces.times, self.driven.on(pieces.times)) if self.driven.names else None,
            turning=turning_states(self.system, self.start),
            units=dict(self.system.units),
            steps=dict(self.engines.steps),
        )

    def _watch(self, event: Event, kept: bool = False) -> Watch:
        function = self._function(event.function, f"event '{event.name}'", kept)
        return Watch(event, self.system.states, function)

    def _function(self, function: Callable[..., Any], what: str, kept: bool) -> Function:
        return Function(function, self.system.states, self.system.parameters, self.driven.names, what, kept)

    def _where(self, i: int, t: float, x: np.ndarray) -> str:
        event = self.watched[i].event
        state = ", ".join(f"{n} = {v:.5g}" for n, v in zip(self.system.states, x, strict=True))
        if i < len(self.events):
            return f"'{event.name}' at t = {t:.9g}, {state}"
        return f"{event.name} = {self._limited(event.name, t, x):.5g} at t = {t:.9g}, {state}"

    def _limited(self, name: str, t: float, x: np.ndarray) -> float:
        """The value of what is limited."""
        function = self._function(self.system.limits[name][0], name, True)
        driven = self.driven.pieces.at(t)[None] if self.driven.names else np.zeros((1, 0))
        return float(function.at(x[None], driven)[0])

    def _excursions(self, found: Sequence[Crossings]) -> tuple[Excursion, ...]:
        excursions = []
        for (name, (_, margin)), crossings in zip(self.system.limits.items(), found, strict=True):
            driven = self.driven.pieces.at(0.0)[None] if self.driven.names else np.zeros((1, 0))
            outside = self._function(margin, f"event '{name}'", True).at(self.start[None], driven)[0] < 0.0
            leaving = [(0.0, self.start)] if outside else []
            leaving += list(zip(crossings.of(-1).times.tolist(), crossings.of(-1).state, strict=True))
            back = [*crossings.of(1).times.tolist(), self.blocks[-1].t][: len(leaving)]
            excursions += [
                Excursion(name, self._limited(name, t, x), x, t, until)
                for (t, x), until in zip(leaving, back, strict=True)
                if until > t
            ]
        return tuple(sorted(excursions, key=lambda one: one.since))
