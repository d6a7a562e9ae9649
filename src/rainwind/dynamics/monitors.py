"""Functions of the user along any walk: recorded at every point, their zeros located and labelled, or the walk's end.

One implementation for equilibria, curves and orbits. A walk hands over its nodes and says what a node is as a result
(`as_point`): the monitors' functions see an Equilibrium or an Orbit, never a node.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rainwind.dynamics.continuation import zero_between
from rainwind.dynamics.results import Certificate
from rainwind.errors import InputError

AsPoint = Callable[[Any], Any]
_PRECISION = 1e-9


@dataclass(frozen=True)
class Monitor:
    """A function of the point, watched along a walk: `Monitor("lift", lambda e: e["phi"] - 0.6, "label")`.

    function(point) -> float, where the point is an Equilibrium, or an Orbit on branches of orbits. It becomes a
    column of the branch under its name. at_zero: "record" does nothing more; "label" adds a special point of kind
    "event" where it changes its sign, located to 1e-9 of the step; "stop" ends the walk there, in that very point.
    Two zeros between neighbouring points hide each other: a smaller ds tells them apart.
    """

    name: str
    function: Callable[[Any], float]
    at_zero: Literal["record", "label", "stop"] = "record"

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise InputError(f"Monitor: name must be a word; got {self.name!r}")
        if not callable(self.function):
            raise InputError(f"Monitor '{self.name}': function must be callable, point -> number")
        if self.at_zero not in ("record", "label", "stop"):
            raise InputError(
                f"Monitor '{self.name}': at_zero = {self.at_zero!r}; choose record, label or stop"
            )

    def value(self, point: Any) -> float:
        """The function's value. Raises InputError where it gives no single number."""
        found = np.asarray(self.function(point))
        if found.size != 1 or found.dtype.kind not in "biuf":
            raise InputError(f"Monitor '{self.name}': the function must give one real number; got {found!r}")
        return float(found.reshape(()))


@dataclass(frozen=True, eq=False)
class Event:
    """A zero of a monitor between two nodes: the node there, the value left over, and the largest one beside it."""

    monitor: Monitor
    node: Any
    value: float
    beside: float

    def certificate(self, residual: float) -> Certificate:
        """What vanishes there, against the values at the neighbours: a function that jumps does not hold."""
        return Certificate(residual, {self.monitor.name: (self.value, _PRECISION * self.beside)})


def checked(monitors: Sequence[Monitor], taken: Sequence[str]) -> tuple[Monitor, ...]:
    """The monitors, each under a name of its own. taken: names of columns that a branch has. Raises InputError."""
    monitors = (monitors,) if isinstance(monitors, Monitor) else tuple(monitors)
    names = list(taken)
    for monitor in monitors:
        if not isinstance(monitor, Monitor):
            raise InputError(f"monitors are rw.Monitor(name, function); got {monitor!r}")
        if monitor.name in names:
            raise InputError(
                f"Monitor '{monitor.name}': a column of this name is there already; choose another"
            )
        names.append(monitor.name)
    return monitors


def values(monitors: Sequence[Monitor], points: Sequence[Any]) -> dict[str, np.ndarray]:
    """The column (N,) of each monitor over some points."""
    return {m.name: np.array([m.value(point) for point in points], dtype=float) for m in monitors}


def events_between(
    monitors: Sequence[Monitor], problem: Any, a: Any, b: Any, before: Sequence[float], after: Sequence[float],
    as_point: AsPoint,
) -> list[Event]:  # fmt: skip
    """Zeros between two neighbouring nodes of one problem (and one mesh), by rising arclength.

    before, after: the values of all monitors at a and b, so that none is computed twice. Nothing is found for those
    that only record, nor where a value is not finite.
    """
    found = []
    for monitor, first, last in zip(monitors, before, after, strict=True):
        # a zero right on a node belongs to one side, so that it is found once
        if monitor.at_zero == "record" or (first > 0) == (last > 0) or not np.isfinite([first, last]).all():
            continue

        def value(node: Any, monitor: Monitor = monitor) -> float:
            return monitor.value(as_point(node))

        node = zero_between(problem, a, b, value)
        if node is not None:
            found.append(Event(monitor, node, value(node), max(abs(first), abs(last))))
    return sorted(found, key=lambda event: event.node.arclength)
