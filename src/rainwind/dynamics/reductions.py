"""What an ensemble keeps of each trajectory: a few numbers, gathered while it runs, so that memory stays bounded."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, pi
from typing import Any, Protocol, runtime_checkable

import numpy as np

from rainwind.dynamics.kernels import reductions as kernel
from rainwind.dynamics.system import number
from rainwind.dynamics.taylor import Block
from rainwind.errors import InputError
from rainwind.parameters import unknown_name

_RING = 32  # crossings of a section that are remembered
_TURN = 2.0 * pi
SETTLED = ("not settled", "equilibrium", "oscillation", "whole turns")


@dataclass(frozen=True)
class View:
    """What reductions look at: names of the rows of a block (states of the model first), the run's end, the states
    that count modulo a full turn, the tolerance."""

    rows: tuple[str, ...]
    states: tuple[str, ...]
    duration: float
    turning: tuple[str, ...]
    tolerance: float

    def row(self, name: str) -> int:
        """The number of a row. Raises InputError."""
        if name not in self.rows:
            raise unknown_name(name, self.rows, "state or observable")
        return self.rows.index(name)

    def numbers(self, names: tuple[str, ...]) -> np.ndarray:
        """The numbers of some rows, of all states where none is named."""
        return np.array([self.row(name) for name in names or self.states], dtype=np.int64)

    def window(self, since: float, until: float | None, what: str) -> tuple[float, float]:
        """A window of time within the run. Raises InputError."""
        since = number(since, f"{what}: since")
        end = self.duration if until is None else number(until, f"{what}: until")
        if not 0.0 <= since < end <= self.duration:
            raise InputError(
                f"{what}: the window from {since:g} to {end:g} does not lie within the run, 0 to {self.duration:g}; "
                "give 0 <= since < until <= duration"
            )
        return since, end


class Gathered(Protocol):
    """What is gathered of N trajectories on their way."""

    def take(self, block: Block, cuts: np.ndarray) -> None:
        """Some more steps; what lies after a trajectory's cut does not count."""
        ...

    def found(self) -> dict[str, np.ndarray]:
        """Arrays (N, ...) by name."""
        ...


@runtime_checkable
class Marked(Protocol):
    """One that wants to know the growth of disturbances (N,), whenever trajectories `jobs` are at a stop."""

    def mark(self, t: float, jobs: np.ndarray, growth: np.ndarray) -> None:
        """At time t."""
        ...


class Reduction(Protocol):
    """Anything that `ensemble(reduce=...)` takes."""

    @property
    def name(self) -> str:
        """Goes before the names of its arrays, unless empty."""
        ...

    def check(self, view: View) -> dict[str, tuple[str, ...] | None]:
        """The names of its arrays, each with the names of its columns, or None for one number a trajectory."""
        ...

    def gather(self, view: View, many: int) -> Gathered:
        """Nothing gathered yet."""
        ...


def _names(of: Any, what: str) -> tuple[str, ...]:
    names = (of,) if isinstance(of, str) else tuple(of)
    if not all(isinstance(name, str) for name in names):
        raise InputError(f"{what}: of = {of!r} must be names of states or observables")
    return names


@dataclass(frozen=True)
class Extremes:
    """Lowest and highest value of each state over a window of time, exact on the trajectory's polynomials.

    Arrays "lowest", "highest", "amplitude" (half peak-to-peak), each (N, columns). of: states or observables, all
    states where empty; until: None is the end of the run. NaN for a trajectory that ended before the window's end.
    """

    of: tuple[str, ...] | str = ()
    since: float = 0.0
    until: float | None = None
    name: str = ""

    def check(self, view: View) -> dict[str, tuple[str, ...] | None]:
        """Names of arrays and columns."""
        view.window(self.since, self.until, "Extremes")
        names = _names(self.of, "Extremes") or view.states
        view.numbers(names)
        return dict.fromkeys(("lowest", "highest", "amplitude"), names)

    def gather(self, view: View, many: int) -> Gathered:
        """Nothing yet."""
        return _Extremes(view.numbers(_names(self.of, "")), *view.window(self.since, self.until, ""), many)


class _Extremes:
    def __init__(self, rows: np.ndarray, since: float, until: float, many: int) -> None:
        self.rows, self.since, self.until = rows, since, until
        self.low, self.high = np.full((many, rows.size), np.inf), np.full((many, rows.size), -np.inf)

    def take(self, block: Block, cuts: np.ndarray) -> None:
        kernel.extremes(*_arrays(block), self.rows, self.since, self.until, cuts, self.low, self.high)

    def found(self) -> dict[str, np.ndarray]:
        return {"lowest": self.low, "highest": self.high, "amplitude": 0.5 * (self.high - self.low)}


@dataclass(frozen=True)
class Mean:
    """Mean and root mean square of each state over a window of time.

    Arrays "mean", "rms" (of the value itself) and "deviation" (root mean square of what differs from the mean), each
    (N, columns). Arguments as `Extremes`.
    """

    of: tuple[str, ...] | str = ()
    since: float = 0.0
    until: float | None = None
    name: str = ""

    def check(self, view: View) -> dict[str, tuple[str, ...] | None]:
        """Names of arrays and columns."""
        view.window(self.since, self.until, "Mean")
        names = _names(self.of, "Mean") or view.states
        view.numbers(names)
        return dict.fromkeys(("mean", "rms", "deviation"), names)

    def gather(self, view: View, many: int) -> Gathered:
        """Nothing yet."""
        return _Mean(view.numbers(_names(self.of, "")), *view.window(self.since, self.until, ""), many, True)


class _Mean:
    def __init__(self, rows: np.ndarray, since: float, until: float, many: int, squares: bool) -> None:
        self.rows, self.since, self.until, self.squares = rows, since, until, squares
        self.total, self.duration = np.zeros((many, 2 * rows.size)), np.zeros(many)

    def take(self, block: Block, cuts: np.ndarray) -> None:
        kernel.integrals(
            *_arrays(block), self.rows, self.since, self.until, cuts, self.squares, self.total, self.duration
        )

    def found(self) -> dict[str, np.ndarray]:
        with np.errstate(invalid="ignore", divide="ignore"):
            per = self.total / self.duration[:, None]
        mean, square = np.split(per, 2, axis=1)
        return {
            "mean": mean,
            "rms": np.sqrt(square),
            "deviation": np.sqrt(np.maximum(square - mean * mean, 0.0)),
        }


@dataclass(frozen=True)
class Returns:
    """Times between crossings of a plane, and after how many of them the state comes back: the period.

    of: a state or observable, or weights by name; value: where their sum crosses it (None: the turning points of
    `of` instead); direction: 1 rising (of turning points: lowest), -1 falling (highest), 0 both. within: how near,
    as a share of each state's range in the window, counts as back.
    Arrays (N,): "returns" (how many crossings), "first_return", "last_return" (their times), "return_time" (mean
    between two), "return_spread" (their standard deviation), "shortest_return", "longest_return", "period" (NaN where
    the state did not come back within the last 31 crossings), "period_error" (how near it came, as a share).
    """

    of: str | Mapping[str, float]
    value: float | None = None
    direction: int = -1
    since: float = 0.0
    until: float | None = None
    within: float = 1e-3
    name: str = ""

    def check(self, view: View) -> dict[str, tuple[str, ...] | None]:
        """Names of arrays."""
        view.window(self.since, self.until, "Returns")
        if isinstance(self.direction, bool) or self.direction not in (-1, 0, 1):
            raise InputError(
                f"Returns: direction = {self.direction!r}; choose 1 (rising), -1 (falling) or 0 (both)"
            )
        if not 0.0 < number(self.within, "Returns: within") < 1.0:
            raise InputError(f"Returns: within = {self.within!r}; give a share between 0 and 1")
        if self.value is not None:
            number(self.value, "Returns: value")
        self._weights(view)
        return dict.fromkeys(
            (
                "returns", "first_return", "last_return", "return_time", "return_spread", "shortest_return",
                "longest_return", "period", "period_error",
            )
        )  # fmt: skip

    def gather(self, view: View, many: int) -> Gathered:
        """Nothing yet."""
        return _Returns(self, view, many)

    def _weights(self, view: View) -> np.ndarray:
        weights = np.zeros(len(view.rows))
        of = {self.of: 1.0} if isinstance(self.of, str) else self.of
        if not isinstance(of, Mapping) or not of:
            raise InputError(f"Returns: of = {self.of!r} must be the name of a state, or weights by name")
        for name, weight in of.items():
            weights[view.row(name)] = number(weight, f"Returns: the weight of '{name}'")
        if not np.any(weights):
            raise InputError("Returns: all weights are zero, which is no plane")
        return weights


class _Returns:
    def __init__(self, asked: Returns, view: View, many: int) -> None:
        n = len(view.states)
        self.asked, self.window = asked, view.window(asked.since, asked.until, "")
        self.weights = asked._weights(view)
        self.whole = np.array([name in view.turning for name in view.states])
        self.kept = np.zeros((many, 8))
        self.kept[:, kernel.SHORTEST] = np.inf
        self.times, self.states = np.zeros((many, _RING)), np.zeros((many, _RING, n))
        self.low, self.high = np.full((many, n), np.inf), np.full((many, n), -np.inf)

    def take(self, block: Block, cuts: np.ndarray) -> None:
        value = self.asked.value
        kernel.sections(
            *_arrays(block), self.weights, 0.0 if value is None else float(value), value is None,
            self.asked.direction, *self.window, cuts, self.kept, self.times, self.states, self.low, self.high,
        )  # fmt: skip

    def found(self) -> dict[str, np.ndarray]:
        kept, many = self.kept, len(self.kept)
        count = kept[:, kernel.COUNT]
        with np.errstate(invalid="ignore", divide="ignore"):
            ranges = np.where(self.high > self.low, self.high - self.low, 0.0)
            sizes = np.maximum(np.abs(self.high), np.abs(self.low))
            units = np.maximum(np.where(self.whole, np.minimum(ranges, _TURN), ranges), 1e-9 * sizes)
            units[~(units > 0.0)] = np.inf
            mean = kept[:, kernel.SUM] / (count - 1.0)
            spread = np.sqrt(np.maximum(kept[:, kernel.SQUARES] / (count - 1.0) - mean * mean, 0.0))
        periods, gaps = np.empty(many), np.empty(many)
        kernel.recurrences(kept, self.times, self.states, units, self.whole, self.asked.within, periods, gaps)
        some, two = count > 0, count > 1
        columns = {
            "returns": count, "first_return": np.where(some, kept[:, kernel.FIRST], np.nan),
            "last_return": np.where(some, kept[:, kernel.LAST], np.nan), "return_time": np.where(two, mean, np.nan),
            "return_spread": np.where(two, spread, np.nan),
            "shortest_return": np.where(two, kept[:, kernel.SHORTEST], np.nan),
            "longest_return": np.where(two, kept[:, kernel.LONGEST], np.nan),
        }  # fmt: skip
        return {**columns, "period": periods, "period_error": gaps}


@dataclass(frozen=True)
class TimeTo:
    """When a state or an observable first reaches a level: array "time_to" (N,), NaN where it never does.

    both_sides: its modulus counts. A trajectory that starts there has the time `since`. until: None is the run's end.
    """

    of: str
    level: float
    both_sides: bool = False
    since: float = 0.0
    until: float | None = None
    name: str = ""

    def check(self, view: View) -> dict[str, tuple[str, ...] | None]:
        """Names of arrays."""
        view.window(self.since, self.until, "TimeTo")
        view.row(self.of)
        if self.both_sides and not number(self.level, "TimeTo: level") > 0.0:
            raise InputError(f"TimeTo: level = {self.level!r}; a modulus reaches levels above zero")
        number(self.level, "TimeTo: level")
        return {"time_to": None}

    def gather(self, view: View, many: int) -> Gathered:
        """Nothing yet."""
        return _TimeTo(self, view, many)


class _TimeTo:
    def __init__(self, asked: TimeTo, view: View, many: int) -> None:
        self.levels = (asked.level, -asked.level) if asked.both_sides else (asked.level,)
        self.row, self.window = view.row(asked.of), view.window(asked.since, asked.until, "")
        self.times = np.full((many, len(self.levels)), np.nan)

    def take(self, block: Block, cuts: np.ndarray) -> None:
        for k, level in enumerate(self.levels):
            kernel.first_time(
                *_arrays(block),
                self.row,
                float(level),
                1.0 if k == 0 else -1.0,
                *self.window,
                cuts,
                self.times[:, k],
            )

    def found(self) -> dict[str, np.ndarray]:
        return {"time_to": np.fmin.reduce(self.times, axis=1)}


@dataclass(frozen=True)
class Settled:
    """Whether a trajectory has settled, from its last two windows of time: the extremes of both compared.

    window: the length of each, None: a fifth of the run; longer than a period. within: how near, as a share of the
    amplitude, is settled. An equilibrium is what is left of the run's range, no more than that share, and shrinks.
    Arrays: "settled" (N,), the number in `rw.SETTLED` = ("not settled", "equilibrium", "oscillation", "whole
    turns"); "change" (N,), the largest change of an extreme value from one window to the next as a share of the
    amplitude; "swing" (N, n), half peak-to-peak in the last window; "turns" (N, n), whole turns gained over it.
    A torus or chaos whose windows look alike is an oscillation too: `Lyapunov` and `Returns` tell them apart.
    """

    window: float | None = None
    within: float = 0.01
    name: str = ""

    def check(self, view: View) -> dict[str, tuple[str, ...] | None]:
        """Names of arrays and columns."""
        if (
            self.window is not None
            and not 0.0 < number(self.window, "Settled: window") <= 0.5 * view.duration
        ):
            raise InputError(
                f"Settled: two windows of {self.window!r} do not fit into a run of {view.duration:g}; give at most "
                f"{0.5 * view.duration:g}"
            )
        if not 0.0 < number(self.within, "Settled: within") < 1.0:
            raise InputError(f"Settled: within = {self.within!r}; give a share between 0 and 1")
        return {"settled": None, "change": None, "swing": view.states, "turns": view.states}

    def gather(self, view: View, many: int) -> Gathered:
        """Nothing yet."""
        return _Settled(self, view, many)


class _Settled:
    def __init__(self, asked: Settled, view: View, many: int) -> None:
        self.asked, self.view = asked, view
        end, width = view.duration, view.duration / 5.0 if asked.window is None else float(asked.window)
        rows = view.numbers(())
        self.edges = end - 2.0 * width, end - width, end
        windows = (self.edges[:2], self.edges[1:])
        self.extremes = [_Extremes(rows, *window, many) for window in windows]
        self.ends = np.full((3, many, rows.size), np.nan)
        self.low, self.high = np.full((many, rows.size), np.inf), np.full((many, rows.size), -np.inf)
        self.rows = rows

    def take(self, block: Block, cuts: np.ndarray) -> None:
        kernel.ranges(*_arrays(block), self.rows, cuts, self.low, self.high)
        for part in self.extremes:
            part.take(block, cuts)
        for edge, states in zip(self.edges, self.ends, strict=True):
            kernel.states_at(*_arrays(block), self.rows, edge, cuts, states)

    def found(self) -> dict[str, np.ndarray]:
        view, within = self.view, self.asked.within
        turning = np.array([name in view.turning for name in view.states])
        with np.errstate(invalid="ignore", divide="ignore"):
            before, last = (0.5 * (part.high - part.low) for part in self.extremes)
            gained = [self.ends[1] - self.ends[0], self.ends[2] - self.ends[1]]
            turns = np.where(turning, np.round(gained[1] / _TURN), 0.0) + 0.0
            ranges = np.where(self.high > self.low, self.high - self.low, 0.0)
            sizes = np.maximum(np.abs(self.high), np.abs(self.low))
            noise = 1e3 * view.tolerance * np.where(sizes > 0.0, sizes, 1.0)
            units = np.maximum(last, 1e-3 * ranges + noise)
            first, second = self.extremes
            change = np.maximum(np.abs(second.low - first.low), np.abs(second.high - first.high)) / units
            # of a state that goes round, only how fast it does is looked at
            round_ = np.abs(turns) > 0.0
            speed = np.abs(gained[1] - gained[0]) / np.maximum(np.abs(gained[1]), _TURN)
            change = np.where(round_, np.maximum(speed - _TURN / np.abs(gained[1]), 0.0), change)
            worst = change.max(axis=1)
            share = 2.0 * last / np.maximum(ranges, noise)
            rest = np.all((share <= within) & ((last < 0.9 * before) | (last <= noise)), axis=1)
        kind = np.where(worst <= within, np.where(np.any(round_, axis=1), 3.0, 2.0), 0.0)
        kind = np.where(rest & ~np.any(round_, axis=1), 1.0, kind)
        return {"settled": kind, "change": worst, "swing": last, "turns": turns}


@dataclass(frozen=True)
class Lyapunov:
    """The largest Lyapunov exponent over a window of time: array "lyapunov" (N,), per unit of time.

    The growth of one small disturbance, followed beside the state (Benettin et al., Meccanica 15 (1980) 9).
    "half_lyapunov" (N,) is that of the window's second half alone: how much both differ says how sure the number is.
    Positive: chaos; zero: a cycle or a torus; negative: an equilibrium. NaN where the disturbance died out so fast that
    its rate was lost in rounding.
    """

    since: float = 0.0
    until: float | None = None
    name: str = field(default="")

    def check(self, view: View) -> dict[str, tuple[str, ...] | None]:
        """Names of arrays."""
        view.window(self.since, self.until, "Lyapunov")
        return {"lyapunov": None, "half_lyapunov": None}

    def gather(self, view: View, many: int) -> Gathered:
        """Nothing yet."""
        return _Lyapunov(*view.window(self.since, self.until, ""), many)


class _Lyapunov:
    def __init__(self, since: float, until: float, many: int) -> None:
        self.edges = since, 0.5 * (since + until), until
        self.values = np.full((3, many), np.nan)
        if since == 0.0:
            self.values[0] = 0.0

    def take(self, block: Block, cuts: np.ndarray) -> None:
        pass

    def mark(self, t: float, jobs: np.ndarray, growth: np.ndarray) -> None:
        for edge, values in zip(self.edges, self.values, strict=True):
            if t == edge:
                values[jobs] = growth[jobs]

    def found(self) -> dict[str, np.ndarray]:
        (a, b, c), (first, middle, last) = self.edges, self.values
        return {"lyapunov": (last - first) / (c - a), "half_lyapunov": (last - middle) / (c - b)}


def stops(reductions: Sequence[Reduction], view: View, longest: float) -> tuple[float, ...]:
    """The times at which disturbances are shortened: where exponents begin and end, and as often as `longest` says."""
    edges = {view.duration}
    for one in reductions:
        if isinstance(one, Lyapunov):
            since, until = view.window(one.since, one.until, "")
            edges |= {since, 0.5 * (since + until), until}
    found: list[float] = []
    for a, b in pairwise(sorted(edges | {0.0})):
        parts = ceil((b - a) / longest)
        found += [a + (b - a) * k / parts for k in range(1, parts)] + [b]
    return tuple(found)


def _arrays(block: Block) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    return block.trajectories, block.times, block.steps, block.coefficients


BY_NAME: dict[str, Reduction] = {
    "extremes": Extremes(),
    "mean": Mean(),
    "settled": Settled(),
    "lyapunov": Lyapunov(),
}


def listed(reduce: Any) -> list[Any]:
    """One reduction or several. Raises InputError for what is neither."""
    if isinstance(reduce, str) or hasattr(reduce, "gather"):
        return [reduce]
    if not isinstance(reduce, Iterable):
        raise InputError(
            f"reduce takes {', '.join(BY_NAME)}, or objects such as rw.Extremes(since=200); got {reduce!r}"
        )
    return list(reduce)


def checked(reduce: Any, view: View) -> tuple[tuple[Reduction, ...], dict[str, tuple[str, ...] | None]]:
    """Reductions, and the names and columns of their arrays. Raises InputError."""
    found: list[Reduction] = []
    columns: dict[str, tuple[str, ...] | None] = {}
    for one in listed(reduce):
        if isinstance(one, str):
            if one not in BY_NAME:
                raise unknown_name(one, BY_NAME, "reduction")
            one = BY_NAME[one]
        if not all(hasattr(one, part) for part in ("check", "gather", "name")):
            raise InputError(
                f"reduce takes {', '.join(BY_NAME)}, or objects such as rw.Extremes(since=200); got {one!r}"
            )
        for name, names in one.check(view).items():
            label = f"{one.name} {name}" if one.name else name
            if label in columns:
                raise InputError(
                    f"two reductions give '{label}'; give one of them a name, {type(one).__name__}(name='late')"
                )
            columns[label] = names
        found.append(one)
    return tuple(found), columns
