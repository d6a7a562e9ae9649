"""What a run leaves behind: a trajectory that can be asked at any time, cut by planes, integrated along."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from rainwind.dynamics.events import Crossings, Event, Function, Watch
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.settled import Settled, settled, unsettled
from rainwind.errors import InputError
from rainwind.parameters import unknown_name

# of Gauss' quadrature in a piece
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_AT_ONCE = 2048


class RunEnded(Enum):
    """Why a run ended."""

    DURATION = "the duration is over"
    EVENT = "a terminal event"
    LEFT_VALIDITY = "the state left the range in which the model holds"
    RAN_AWAY = "the state ran away: it grew without bound"
    STEP_TOO_SMALL = "the step became too small: the rates are not finite or not smooth here"
    TOO_MANY_STEPS = "the limit on the number of steps was reached"
    INTERRUPTED = "interrupted by the user"


@dataclass(frozen=True)
class Excursion:
    """A time that a run spent beyond one of the model's limits: name, value of what is limited on leaving, state (n,)
    there, since and until (the end of the run if it did not come back)."""

    name: str
    value: float
    state: np.ndarray
    since: float
    until: float

    @property
    def duration(self) -> float:
        """For how long."""
        return self.until - self.since


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """One run of a system from t = 0, as polynomial pieces.

    start, end: the first and the last state (n,). parameters: all of them; those that signals drive have their first
    value, and `driven` their pieces on the same times. ended: why; note: where and what. events: the crossings of each
    event by name. outside: times beyond the model's limits. turning: states in which the system is 2-pi-periodic.
    steps: how many of each engine.
    `run["y"]`, `run["wind.speed"]` give columns at `run.times`.
    """

    states: tuple[str, ...]
    parameters: Mapping[str, float]
    start: np.ndarray
    end: np.ndarray
    pieces: Pieces
    ended: RunEnded
    tolerance: float
    note: str = ""
    events: Mapping[str, Crossings] = field(default_factory=dict)
    outside: tuple[Excursion, ...] = ()
    driven_names: tuple[str, ...] = ()
    driven: Pieces | None = None
    turning: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    steps: Mapping[str, int] = field(default_factory=dict)

    @property
    def times(self) -> np.ndarray:
        """The ends of all steps (k + 1,), from 0."""
        return self.pieces.times

    @property
    def duration(self) -> float:
        """The time at the end."""
        return float(self.pieces.times[-1])

    @property
    def state(self) -> np.ndarray:
        """The states at `times` (k + 1, n)."""
        return np.concatenate([self.pieces.coefficients[:, :, 0], self.end[None]])

    @property
    def finished(self) -> bool:
        """Whether it ran to the end of its duration or to a terminal event."""
        return self.ended in (RunEnded.DURATION, RunEnded.EVENT)

    def __len__(self) -> int:
        return len(self.pieces)

    def at(self, t: Any, derivative: int = 0) -> np.ndarray:
        """States, or their derivatives of this order, at times t (...): (..., n). Raises InputError outside."""
        return self.pieces.at(t, derivative)

    def driven_at(self, t: Any) -> np.ndarray:
        """The driven parameters at times t (...): (..., m)."""
        return np.zeros((*np.shape(t), 0)) if self.driven is None else self.driven.at(t)

    def __getitem__(self, name: str) -> np.ndarray:
        if name in self.states:
            return self.state[:, self.states.index(name)]
        if name in self.driven_names:
            return self.driven_at(self.times)[:, self.driven_names.index(name)]
        if name in self.parameters:
            return np.full(len(self.times), self.parameters[name])
        raise unknown_name(name, (*self.states, *self.parameters), "state or parameter")

    def section(
        self, where: Event | tuple[str, float] | Callable[[Any, Any], Any], direction: int = 1
    ) -> Crossings:
        """Where the trajectory crosses a surface: a Poincare section, each crossing located to rounding.

        where: ("y", 0.0), the plane on which a state has a value; a function (x, p) -> number, or an Event, that
        vanishes on the surface. direction: 1 rising, -1 falling, 0 both; an Event brings its own.
        Raises InputError, and TraceError for a function that cannot be recorded.
        """
        if isinstance(where, tuple):
            name, level = where
            if name not in self.states:
                raise unknown_name(name, self.states, "state")
            event = Event(f"{name} = {level:g}", lambda x, p: x[name] - level, direction)
        else:
            event = where if isinstance(where, Event) else Event("section", where, direction)
        watch = Watch(event, self.states, self._function(event.function, f"event '{event.name}'"))
        return watch.crossings(self.pieces, self._driven_coefficients(), self.end)

    def value(self, function: Callable[[Any, Any], Any], t: Any) -> np.ndarray:
        """A function (x, p) -> number at times t (...): (...). Raises InputError, TraceError."""
        t = np.asarray(t, dtype=float)
        found = self._function(function, "the function")
        states, driven = self.at(t.ravel()), self.driven_at(t.ravel())
        return found.at(states, driven).reshape(t.shape)

    def integral(self, function: Callable[[Any, Any], Any]) -> np.ndarray:
        """The integral over time of a function (x, p) -> number, from the start to each of `times`: (k + 1,).

        By Gauss' quadrature with ten points a step, on the pieces. Raises TraceError.
        """
        found, total = self._function(function, "the function"), np.zeros(len(self) + 1)
        for first in range(0, len(self), _AT_ONCE):
            left, right = self.times[first:-1][:_AT_ONCE], self.times[first + 1 :][:_AT_ONCE]
            half = 0.5 * (right - left)
            t = (left + half)[:, None] + half[:, None] * _NODES
            values = found.at(self.at(t.ravel()), self.driven_at(t.ravel())).reshape(t.shape)
            total[first + 1 : first + 1 + half.size] = half * (values @ _WEIGHTS)
        return np.cumsum(total)

    def settled(self, within: float = 0.01) -> Settled:
        """What the run settled to: an equilibrium, a cycle, whole turns, or nothing yet; and how well.

        within: what may still be missing, as a share of the amplitudes (equilibrium: of the run's range).
        """
        if self.ended in (RunEnded.RAN_AWAY, RunEnded.STEP_TOO_SMALL) or not len(self):
            return unsettled(self.states, self.ended.value)
        return settled(self.pieces, self.states, self.turning, self.tolerance, within)

    def to_xarray(self, times: Any = None) -> Any:
        """An xarray.Dataset of all states (and driven parameters) over time, with units where the model names them.

        times (N,): None takes the ends of the steps. Raises InputError for times outside.
        """
        import xarray

        t = self.times if times is None else np.asarray(times, dtype=float)
        if t.ndim != 1:
            raise InputError(f"times must be one row of numbers; got shape {t.shape}")
        columns = dict(zip(self.states, self.at(t).T, strict=True))
        columns |= dict(zip(self.driven_names, self.driven_at(t).T, strict=True))
        attributes = {
            "ended": self.ended.value,
            "note": self.note,
            "tolerance": self.tolerance,
            **self.parameters,
        }
        return xarray.Dataset(
            {name: ("time", values, self._unit(name)) for name, values in columns.items()},
            coords={"time": ("time", t, self._unit("time"))},
            attrs=attributes,
        )

    def __repr__(self) -> str:
        engines = (
            ", ".join(f"{count} {name} steps" for name, count in self.steps.items() if count) or "no step"
        )
        end = zip(self.states, self.end, strict=True)
        state = ", ".join(f"{name} = {value:.6g}" for name, value in end)
        events = "".join(f"; {len(found)} x '{name}'" for name, found in self.events.items())
        outside = sum(one.duration for one in self.outside)
        beyond = f"; beyond the model's limits for {outside:.4g}" if self.outside else ""
        why = f"{self.ended.value} ({self.note})" if self.note else self.ended.value
        return (
            f"<trajectory to t = {self.duration:.6g}: {engines}; {why}{events}{beyond}; at the end {state}>"
        )

    def _unit(self, name: str) -> dict[str, str]:
        return {"units": self.units[name]} if name in self.units else {}

    def _driven_coefficients(self) -> np.ndarray:
        return np.zeros((len(self), 0, 4)) if self.driven is None else self.driven.coefficients

    def _function(self, function: Callable[[Any, Any], Any], what: str) -> Function:
        return Function(function, self.states, self.parameters, self.driven_names, what)
