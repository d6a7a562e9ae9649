"""What an ensemble leaves behind: a few numbers for each of its trajectories."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rainwind.dynamics.trajectory import RunEnded
from rainwind.errors import InputError
from rainwind.parameters import unknown_name

_ENDED = tuple(RunEnded)
_SHOWN = 3


@dataclass(frozen=True)
class Failure:
    """A trajectory that did not reach the end: its number, why, when, the state there, its start and what it varied."""

    number: int
    ended: RunEnded
    time: float
    note: str
    state: Mapping[str, float]
    start: Mapping[str, float]
    varied: Mapping[str, float]

    def __str__(self) -> str:
        varied = ", ".join(f"{name} = {value:.6g}" for name, value in (self.varied or self.start).items())
        return f"number {self.number} ({varied}): {self.ended.value} at t = {self.time:.6g}{self.note}"


@dataclass(frozen=True, eq=False, repr=False)
class Ensemble:
    """N trajectories, reduced to a few numbers each.

    varied: what was varied, name -> (N,); fixed: all other parameters; starts, final: first and last states (N, n);
    times (N,): when each ended, NaN where it was not computed; values: arrays (N,) or (N, columns) of all reductions;
    columns: the names of their columns. shape: of the grid, (N,) where there is none; axes: its values by name.
    interrupted: whether the work was stopped; `done` says which trajectories were computed. note: why.
    steps (N, 2): of the Taylor and the Rosenbrock method.
    `run["amplitude"]` is (N, columns), `run["amplitude", "y"]`, `run["settled"]`, `run["wind.speed"]`, `run["y"]`
    (final) are (N,); `run.on_grid(...)` gives the same in the shape of the grid.
    """

    states: tuple[str, ...]
    varied: Mapping[str, np.ndarray]
    fixed: Mapping[str, float]
    starts: np.ndarray
    final: np.ndarray
    times: np.ndarray
    codes: np.ndarray
    limits: np.ndarray
    limit_names: tuple[str, ...]
    steps: np.ndarray
    values: Mapping[str, np.ndarray]
    columns: Mapping[str, tuple[str, ...] | None]
    duration: float
    tolerance: float
    shape: tuple[int, ...]
    axes: Mapping[str, np.ndarray] = field(default_factory=dict)
    interrupted: bool = False
    note: str = ""
    units: Mapping[str, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def parameters(self) -> dict[str, np.ndarray]:
        """All parameters, name -> (N,); those that were not varied are the same everywhere."""
        found = {name: np.full(len(self), value) for name, value in self.fixed.items()}
        return found | {name: v for name, v in self.varied.items() if name not in self.states}

    @property
    def done(self) -> np.ndarray:
        """Which trajectories were computed (N,) bool."""
        return self.codes >= 0

    @property
    def finished(self) -> np.ndarray:
        """Which reached the end of the duration (N,) bool."""
        return self.codes == _ENDED.index(RunEnded.DURATION)

    @property
    def ended(self) -> np.ndarray:
        """Why each ended (N,), `RunEnded`; INTERRUPTED where it was not computed."""
        names = np.empty(len(_ENDED) + 1, dtype=object)
        names[:] = [*_ENDED, RunEnded.INTERRUPTED]
        return names[self.codes]  # -1 is the last one

    @property
    def failures(self) -> tuple[Failure, ...]:
        """Every trajectory that was computed and did not reach the end."""
        return tuple(self._failures())

    def _failures(self) -> Iterator[Failure]:
        for i in np.flatnonzero(self.done & ~self.finished).tolist():
            limit = f" ({self.limit_names[self.limits[i]]})" if self.limits[i] >= 0 else ""
            yield Failure(
                i, _ENDED[self.codes[i]], float(self.times[i]), limit, self._named(self.final[i]),
                self._named(self.starts[i]), {name: float(v[i]) for name, v in self.varied.items()},
            )  # fmt: skip

    def _named(self, state: np.ndarray) -> dict[str, float]:
        return dict(zip(self.states, state.tolist(), strict=True))

    def __getitem__(self, key: str | tuple[str, str]) -> np.ndarray:
        name, column = key if isinstance(key, tuple) else (key, None)
        if column is None and name not in self.values:
            if name in self.varied and name not in self.states:
                return self.varied[name]
            if name in self.fixed:
                return np.full(len(self), self.fixed[name])
            if name in self.states:
                return self.final[:, self.states.index(name)]
        if name not in self.values:
            raise unknown_name(name, [*self.values, *self.varied, *self.states], "result")
        if column is None:
            return self.values[name]
        names = self.columns[name]
        if names is None:
            raise InputError(f"'{name}' is one number a trajectory; it has no columns")
        if column not in names:
            raise unknown_name(column, names, f"column of '{name}'")
        return self.values[name][:, names.index(column)]

    def on_grid(self, key: str | tuple[str, str] | np.ndarray) -> np.ndarray:
        """A result, or any array (N, ...), in the shape of the grid."""
        array = np.asarray(key) if isinstance(key, np.ndarray) else self[key]
        return array.reshape(*self.shape, *array.shape[1:])

    def where(self, mask: Any) -> "Ensemble":
        """Only the trajectories that a mask (N,) bool, or numbers, choose; on no grid any more."""
        chosen = np.arange(len(self))[np.asarray(mask)]
        return Ensemble(
            self.states, {k: v[chosen] for k, v in self.varied.items()}, self.fixed, self.starts[chosen],
            self.final[chosen], self.times[chosen], self.codes[chosen], self.limits[chosen], self.limit_names,
            self.steps[chosen], {k: v[chosen] for k, v in self.values.items()}, self.columns, self.duration,
            self.tolerance, (chosen.size,), {}, self.interrupted, self.note, self.units,
        )  # fmt: skip

    def to_xarray(self) -> Any:
        """An xarray.Dataset along the grid's axes, or along "trajectory"; columns that are states along "state"."""
        import xarray

        grid = bool(self.axes)
        dimensions = tuple(self.axes) if grid else ("trajectory",)
        coords: dict[str, Any] = {"state": list(self.states)}
        if grid:
            coords |= {name: (name, values, self._unit(name)) for name, values in self.axes.items()}
        else:
            coords |= {
                name: ("trajectory", v, self._unit(name))
                for name, v in self.varied.items()
                if name not in self.states
            }
        data: dict[str, Any] = {
            "start": ((*dimensions, "state"), self.on_grid(self.starts)),
            "final": ((*dimensions, "state"), self.on_grid(self.final)),
            "end_time": (dimensions, self.on_grid(self.times), self._unit("time")),
            "ended": (dimensions, self.on_grid(np.array([one.value for one in self.ended]))),
        }
        for name, array in self.values.items():
            names = self.columns[name]
            if names is None:
                data[name] = (dimensions, self.on_grid(array))
                continue
            along = "state" if names == self.states else f"column of {name}"
            if along != "state":
                coords[along] = list(names)
            data[name] = ((*dimensions, along), self.on_grid(array))
        facts = {"duration": self.duration, "tolerance": self.tolerance, "note": self.note, **self.fixed}
        return xarray.Dataset(data, coords, {**facts, "interrupted": int(self.interrupted)})

    def _unit(self, name: str) -> dict[str, str]:
        return {"units": self.units[name]} if name in self.units else {}

    def __repr__(self) -> str:
        many, done = len(self), int(self.done.sum())
        shape = f" on a grid of {' x '.join(map(str, self.shape))}" if self.axes else ""
        what = ", ".join(self.varied) or "starts"
        lines = [f"<{many} trajectories of {self.duration:g}{shape}, {what} varied"]
        if done < many:
            lines.append(f"  {done} computed{': ' + self.note if self.note else ''}")
        failed = np.flatnonzero(self.done & ~self.finished)
        if failed.size:
            lines.append(f"  {failed.size} did not reach the end:")
            for _, failure in zip(range(_SHOWN), self._failures(), strict=False):
                lines.append(f"    {failure}")
            if failed.size > _SHOWN:
                lines.append("    ...")
        lines += [f"  {name}: {self._range(name)}" for name in self.values]
        return "\n".join(lines) + ">"

    def _range(self, name: str) -> str:
        """The least and the largest value of each column."""
        array, names = self.values[name], self.columns[name]
        parts = []
        for k, label in enumerate(names or ("",)):
            column = array if names is None else array[:, k]
            known = column[np.isfinite(column)]
            where = f"{known.min():.4g} to {known.max():.4g}" if known.size else "nowhere known"
            parts.append(f"{label} {where}".strip())
        return ", ".join(parts)
