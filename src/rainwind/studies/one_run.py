"""One trajectory of any case over time: y, z, the rivulet's angle and the wind; as picture, table and animation."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rainwind.dynamics.extremes import extremes_between
from rainwind.dynamics.results import Equilibrium
from rainwind.dynamics.settled import Settled
from rainwind.dynamics.simulate import simulate
from rainwind.dynamics.trajectory import RunEnded, Trajectory
from rainwind.errors import InputError
from rainwind.io.results import Column, Table, save_csv
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.animation import Scene, animate, frames
from rainwind.studies.equilibrium_map import equilibria_by_letter
from rainwind.studies.run_words import DURATION, WindGiven, start_from_text, wind_from_text

_BAND = "#A9C5DA"
_ONE_BY_ONE = 40.0  # periods: up to this many are drawn as a line, more as a band
_SAMPLES = 50  # a period, in lines and tables
_FILM = 10.0  # s, of an animation where nothing else is said
_STATES = {"y": (r"$y$ (m)", 1.0), "z": (r"$z$ (m)", 1.0), "phi": (r"$\phi$ (°)", float(np.degrees(1.0)))}
_UNITS = {
    "y": "m", "phi": "rad", "z": "m", "y_dot": "m/s", "phi_dot": "rad/s", "z_dot": "m/s",
    "wind.speed": "m/s", "wind.vertical_speed": "m/s",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Result:
    """A run, its wind, and the start in words."""

    model: RivuletModel
    wind: WindGiven
    start: str
    run: Trajectory
    settled: Settled | None

    @property
    def period(self) -> float:
        """The cable's own period, s."""
        return 1.0 / self.model.section.frequency_y

    @property
    def interrupted(self) -> bool:
        """Whether the user stopped it."""
        return self.run.ended is RunEnded.INTERRUPTED


def compute(
    model: RivuletModel,
    *,
    wind: str | None = None,
    duration: float | None = None,
    start: str | None = None,
    progress: Callable[[int, int, str], None] | None = None,
) -> Result:
    """One run: wind and start as typed, duration in s (by default 300 s, of a wind record all of it). InputError."""
    given = wind_from_text(wind, model, duration)
    if duration is None:
        duration = given.until if np.isfinite(given.until) else DURATION
    state, words = start_from_text(start, model, given)
    run = simulate(model, state, duration=duration, parameters=given.parameters, progress=progress)
    # under a wind that varies nothing settles
    settled = run.settled() if len(run) and not given.varies and run.finished else None
    return Result(model, given, words, run, settled)


def draw(result: Result, figure: Figure) -> Figure:
    """The states over time, above them the wind where it varies; long runs as the band from lowest to highest."""
    names = [name for name in _STATES if name in result.run.states]
    rows = len(names) + result.wind.varies
    with style.journal(figure, width="double", height=34.0 * rows + 14.0):
        title = f"from {result.start}" + ("" if result.wind.varies else f", at {result.wind.words}")
        panels = list(np.atleast_1d(figure.subplots(rows, 1, sharex=True)))
        letters = iter("abcde")
        if result.wind.varies:
            axes = panels.pop(0)
            style.panel(axes, next(letters), f"wind: {result.wind.words}")
            t = np.linspace(0.0, result.run.duration, 2000)
            column = result.run.driven_names.index("wind.speed")
            axes.plot(t, result.run.driven_at(t)[:, column], color=style.BLUE, linewidth=0.8)
            axes.set_ylabel(r"$U$ (m/s)")
        for axes, name in zip(panels, names, strict=True):
            style.panel(axes, next(letters), title if name == "y" else "")
            _state(result, axes, name)
        panels[-1].set(xlabel="time (s)", xlim=(0.0, result.run.duration))
        style.below(figure, _remarks(result), letters=130)
    return figure


def _state(result: Result, axes: Axes, name: str) -> None:
    label, scale = _STATES[name]
    run, i = result.run, result.run.states.index(name)
    if run.duration <= _ONE_BY_ONE * result.period:
        t = np.linspace(0.0, run.duration, int(_SAMPLES * run.duration / result.period) + 2)
        axes.plot(t, scale * run.at(t)[:, i], color=style.BLACK, linewidth=0.8)
    else:
        edges = np.linspace(0.0, run.duration, int(run.duration / result.period) + 1)
        low, high = (scale * side[:, i] for side in extremes_between(run, edges))
        middle = 0.5 * (edges[:-1] + edges[1:])
        axes.fill_between(middle, low, high, color=_BAND, linewidth=0.0)
        for side in (low, high):
            axes.plot(middle, side, color=style.BLACK, linewidth=0.5)
    axes.set_ylabel(label)
    if name == "phi":
        _equilibria(result, axes)


def _equilibria(result: Result, axes: Axes) -> None:
    """The equilibria at the wind speed, where it is one, within what the panel shows."""
    if result.wind.varies:
        return
    low, high = axes.get_ylim()
    for letter, one in _letters(result).items():
        angle = float(np.degrees(one["phi"]))
        if low < angle < high:
            axes.axhline(angle, color=style.BLACK, linewidth=0.5, zorder=2.5)
            axes.annotate(
                letter, (1.0, angle), xycoords=("axes fraction", "data"), xytext=(2, 0),
                textcoords="offset points", fontsize=7, color=style.GREY, va="center",
            )  # fmt: skip


def _letters(result: Result) -> dict[str, Equilibrium]:
    return equilibria_by_letter(result.model.with_parameters({"wind.speed": result.wind.first}))


def _remarks(result: Result) -> list[str]:
    run = result.run
    said = []
    if run.duration > _ONE_BY_ONE * result.period:
        said.append("shaded: from the lowest to the highest value of each period of the cable")
    if run.outside:
        since = min(one.since for one in run.outside)
        beyond = sum(one.duration for one in run.outside)
        low, high = np.degrees(result.model.coefficients.valid)
        said.append(
            f"for {beyond:.4g} s, first at {since:.4g} s, the angle of attack is outside {low:.4g}° to {high:.4g}°, "
            f"where the coefficients '{result.model.coefficients.name}' hold"
        )
    if run.ended is not RunEnded.DURATION:
        said.append(f"it ended after {run.duration:.4g} s: {run.ended.value}")
    return said


def summary(result: Result) -> list[str]:
    """In sentences: what was run, what it came to, and what the reader must know."""
    run = result.run
    said = [f"Wind {result.wind.words}, {run.duration:.6g} s, from {result.start}."]
    if len(run):
        said.append(_came_to(result))
    return said + [
        f"{words[0].upper()}{words[1:]}." for words in _remarks(result) if not words.startswith("shaded")
    ]


def _came_to(result: Result) -> str:
    run, found = result.run, result.settled
    names = [name for name in ("y", "z", "phi") if name in run.states]
    if found is not None and found.kind == "equilibrium":
        at = ", ".join(f"{name} {_read(name, found.mean[name])}" for name in names)
        near = [
            letter for letter, one in _letters(result).items()
            if abs((one["phi"] - found.mean["phi"] + np.pi) % (2 * np.pi) - np.pi) < 0.02
        ]  # fmt: skip
        return f"It comes to rest{f' at {near[0]}' if near else ''}: {at}."
    if found is not None and found.kind in ("cycle", "whole turns"):
        size = ", ".join(f"{name} ±{_read(name, found.amplitude[name])}" for name in names)
        turning = " with whole turns of the rivulet" if found.kind == "whole turns" else ""
        return (
            f"It vibrates steadily{turning} from about {found.since:.0f} s on: period {found.period:.4f} s, half "
            f"peak-to-peak {size}."
        )
    since = max(0.0, run.duration - 10.0 * result.period)
    low, high = extremes_between(run, np.array([since, run.duration]))
    last = ", ".join(
        f"{name} {_read(name, low[0, run.states.index(name)])} to {_read(name, high[0, run.states.index(name)])}"
        for name in names
    )
    why = f" ({found.note})" if found is not None and found.note else ""
    settled = "It has not settled" + why + ". " if found is not None else ""
    span = "In its last 10 periods" if since > 0.0 else "In all"
    return f"{settled}{span}: {last}."


def _read(name: str, value: float) -> str:
    return f"{np.degrees(value):.1f}°" if name == "phi" else f"{round(value, 4) + 0.0:.4f} m"


def tables(result: Result) -> dict[str, Table]:
    """The states, and the wind where it varies, over time."""
    run = result.run
    t = np.append(np.arange(0.0, run.duration, result.period / _SAMPLES), run.duration)
    columns = {"time": Column(t, "s", "time")}
    for names, values in ((run.states, run.at(t)), (run.driven_names, run.driven_at(t))):
        for name, column in zip(names, values.T, strict=True):
            columns[name] = Column(column, _UNITS.get(name, ""), name)
    return {"run": Table(columns)}


def save(result: Result, path: Path) -> None:
    """Draw it into an image file. OSError where it cannot be written."""
    style.save(draw(result, Figure()), path)


def save_table(result: Result, path: Path) -> None:
    """Write the states over time as CSV. InputError."""
    save_csv(path, tables(result)["run"])


def film(
    result: Result,
    path: Path,
    span: tuple[float, float] | None = None,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Write an animation of part of the run (s); by default its last 10 s, of a steady vibration whole periods.

    Raises InputError for a span outside the run, or too long; OSError where the file cannot be written.
    """
    since, until = span or _last(result)
    run = result.run
    if not 0.0 <= since < until <= run.duration:
        raise InputError(f"--span {since:g} s to {until:g} s is not inside the run, 0 to {run.duration:g} s")
    count = frames(path.suffix.lower(), until - since)
    # without the last moment: in a loop it is the first one again
    t = since + (until - since) * np.arange(count) / count
    x = dict(zip(run.states, run.at(t).T, strict=True))
    wind = np.full(count, result.wind.first)
    if "wind.speed" in run.driven_names:
        wind = run.driven_at(t)[:, run.driven_names.index("wind.speed")]
    diameter = result.model.section.diameter
    scene = Scene(
        t, x["y"], x.get("z", np.zeros(count)), x["phi"], wind, diameter,
        0.5 * (diameter + result.model.rivulet.height), title=f"wind {result.wind.words}",
    )  # fmt: skip
    animate(scene, path, progress=progress)


def _last(result: Result) -> tuple[float, float]:
    end = result.run.duration
    length = min(_FILM * result.period, end)
    if result.settled is not None and result.settled.period and result.settled.kind == "cycle":
        whole = max(1, round(0.4 * _FILM * result.period / result.settled.period)) * result.settled.period
        length = min(whole, end)
    return end - length, end
