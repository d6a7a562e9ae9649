"""Zeros of functions of the state along a trajectory: while it runs, or afterwards on its pieces."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from rainwind.dynamics.kernels.values import specialised, values
from rainwind.dynamics.kernels.zeros import find_zeros
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.tape import Tape, trace_function
from rainwind.errors import InputError
from rainwind.parameters import unknown_name

_ROOM = 256


@dataclass(frozen=True)
class Event:
    """A function of the state that is watched for zeros: `Event("highest", lambda x, p: x.y_dot, direction=-1)`.

    function(x, p) -> number, of states and parameters by name, smooth, called once with symbols. direction: 1 only
    where it rises through zero, -1 only where it falls, 0 both. terminal: the first one ends the run, exactly there.
    A zero at the very start of a run does not count. Raises InputError.
    """

    name: str
    function: Callable[[Any, Any], Any]
    direction: int = 0
    terminal: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise InputError(f"Event: name must be a word; got {self.name!r}")
        if not callable(self.function):
            raise InputError(f"Event '{self.name}': function must be callable, (x, p) -> number")
        if isinstance(self.direction, bool) or self.direction not in (-1, 0, 1):
            raise InputError(
                f"Event '{self.name}': direction = {self.direction!r}; choose 1 (rising), -1 (falling) or 0 (both)"
            )
        if not isinstance(self.terminal, bool):
            raise InputError(f"Event '{self.name}': terminal = {self.terminal!r} must be True or False")


@dataclass(frozen=True, eq=False, repr=False)
class Crossings:
    """Zeros of one function along a trajectory, by time: times (m,), state (m, n), rising (m,) bool."""

    name: str
    states: tuple[str, ...]
    times: np.ndarray
    state: np.ndarray
    rising: np.ndarray

    def __len__(self) -> int:
        return len(self.times)

    def __getitem__(self, name: str) -> np.ndarray:
        """One state at the crossings (m,)."""
        if name not in self.states:
            raise unknown_name(name, self.states, "state")
        return self.state[:, self.states.index(name)]

    def __repr__(self) -> str:
        where = f", t = {self.times[0]:.6g} ... {self.times[-1]:.6g}" if len(self) else ""
        return f"<{len(self)} crossings of '{self.name}'{where}>"

    def of(self, direction: int) -> "Crossings":
        """Those that rise (1), those that fall (-1), or all (0)."""
        keep = self.rising == (direction > 0) if direction else np.ones(len(self), dtype=bool)
        return Crossings(self.name, self.states, self.times[keep], self.state[keep], self.rising[keep])

    def before(self, t: float) -> "Crossings":
        """Those up to a time."""
        keep = self.times <= t
        return Crossings(self.name, self.states, self.times[keep], self.state[keep], self.rising[keep])


def joined(parts: Sequence[Crossings]) -> Crossings:
    """Crossings of one function, part by part."""
    columns = [
        np.concatenate([getattr(part, name) for part in parts]) for name in ("times", "state", "rising")
    ]
    return Crossings(parts[0].name, parts[0].states, *columns)


def checked(events: Any) -> tuple[Event, ...]:
    """Events under names of their own. Raises InputError."""
    events = (events,) if isinstance(events, Event) else tuple(events)
    for event in events:
        if not isinstance(event, Event):
            raise InputError(f"events are rw.Event(name, function); got {event!r}")
    names = [event.name for event in events]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise InputError(f"two events are called '{twice[0]}'; give each a name of its own")
    return events


class Function:
    """A function of states and parameters, traced once, at given parameters some of which are driven.

    kept: the tape is remembered for the next run, as a model's own functions may be; a user's may have changed by then.
    """

    def __init__(
        self, function: Callable[[Any, Any], Any], states: tuple[str, ...], parameters: Mapping[str, float],
        driven: Sequence[str], what: str, kept: bool = False,
    ) -> None:  # fmt: skip
        trace = _kept_tape if kept else trace_function
        self.tape: Tape = trace(function, states, tuple(parameters), what)
        n, names = len(states), list(parameters)
        self.numbers = np.array([n + names.index(name) for name in driven], dtype=np.int64)
        self._inputs = np.concatenate([np.zeros(n), np.array(list(parameters.values()), dtype=float)])
        free = np.arange(self._inputs.size) < n
        free[self.numbers] = True
        self.operations, self.template = specialised(
            self.tape.operations, self.tape.template, self._inputs, free
        )

    def at(self, states: np.ndarray, driven: np.ndarray) -> np.ndarray:
        """Values (N,) at states (N, n) and driven parameters (N, m)."""
        return values(*self.tape.arrays, self.inputs(states, driven))[:, 0]

    def inputs(self, states: np.ndarray, driven: np.ndarray) -> np.ndarray:
        """States and all parameters as the kernels take them."""
        found = np.tile(self._inputs, (len(states), 1))
        found[:, : states.shape[1]] = states
        found[:, self.numbers] = driven
        return found


@lru_cache(maxsize=32)
def _kept_tape(
    function: Callable[..., Any], states: tuple[str, ...], parameters: tuple[str, ...], what: str
) -> Tape:
    return trace_function(function, states, parameters, what)


class Watch:
    """One event along a run, piece by piece; it remembers the sign so far."""

    def __init__(self, event: Event, states: tuple[str, ...], function: Function) -> None:
        self.event, self._states, self._function, self._sign = event, states, function, 0

    def crossings(self, pieces: Pieces, driven: np.ndarray, end: np.ndarray) -> Crossings:
        """The zeros along the next pieces (k of them), with driven (k, m, 4) and the state at their end."""
        f, room = self._function, _ROOM
        parts, first = [none(self.event.name, self._states)], 0
        while first < len(pieces):
            at, piece = np.empty(room), np.empty(room, dtype=np.int64)
            rising = np.empty(room, dtype=np.bool_)
            count, self._sign, looked = find_zeros(
                f.operations, f.template, f.tape.outputs[0], pieces.times[first:], pieces.coefficients[first:],
                f.numbers, driven[first:], end, self._sign, at, piece, rising,
            )  # fmt: skip
            at, piece, rising = at[:count], piece[:count] + first, rising[:count]
            powers = at[:, None] ** np.arange(pieces.degree + 1)
            state = np.einsum("kij,kj->ki", pieces.coefficients[piece], powers)
            parts.append(Crossings(self.event.name, self._states, pieces.times[piece] + at, state, rising))
            first += looked
            room = room if looked else 2 * room
        return joined(parts).of(self.event.direction)


def none(name: str, states: tuple[str, ...]) -> Crossings:
    """No crossing at all."""
    return Crossings(name, states, np.zeros(0), np.zeros((0, len(states))), np.zeros(0, dtype=bool))
