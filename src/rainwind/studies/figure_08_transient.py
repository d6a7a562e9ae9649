"""Figure 8 (section 4.3): from a small disturbance of the upper rivulet to the limit cycle; y, z and phi over time.

The paper shows 9 m/s, where the limit cycle is reached after more than five minutes. With our coefficients no cycle
is stable at 9 m/s: the rivulet swings further and further, passes C after three minutes and falls to A. The paper's
picture is drawn at 12 m/s, where a cycle is reached. Start: D at rest, the cable 1 mm off. Shaded: from the lowest to
the highest value of each period of the cable.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from rainwind.dynamics.extremes import extremes_between
from rainwind.dynamics.trajectory import Trajectory
from rainwind.io.results import Column, Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import equilibrium_map, speed_window
from rainwind.studies.figure_07_limit_cycles import SHOWN as PARTS
from rainwind.studies.transients import Transient, in_words, transient

SHOWN = PARTS[:2]  # of the onset speed: 9 m/s, the paper's, and 12 m/s
_BEFORE, _AFTER, _LOOPS = 12.0, 6.0, 4.0  # periods drawn one by one: about the fall, and of the cycle
_POINTS = 60  # a period, in what is drawn one by one and in the tables
_STATES = {"y": (r"$y$ (m)", 1.0), "z": (r"$z$ (m)", 1.0), "phi": (r"$\phi$ (°)", float(np.degrees(1.0)))}
_BAND, _LEVEL = "#A9C5DA", "#4D4D4D"
_UNITS = {"y": "m", "phi": "rad", "z": "m"}
_MEANING = {"y": "cross-wind displacement", "phi": "rivulet angle", "z": "in-wind displacement"}


@dataclass(frozen=True, eq=False)
class Result:
    """A run at each of the wind speeds (m/s); None where there is no D."""

    model: RivuletModel
    runs: dict[float, Transient | None]

    @property
    def period(self) -> float:
        """The cable's own period, over which extremes are taken, s."""
        return 1.0 / self.model.section.frequency_y


def compute(model: RivuletModel | None = None, *, speeds: tuple[float, ...] | None = None) -> Result:
    """A run from D at each of `speeds` (m/s), by default at 9/8 and 12/8 of the onset speed."""
    model = model or paper.model()
    if speeds is None:
        window = speed_window(model)
        onset = equilibrium_map(model, window).onset or window[0]
        speeds = tuple(round(part * onset, 1) for part in SHOWN)
    return Result(model, {speed: transient(model, speed) for speed in speeds})


def draw(result: Result, figure: Figure) -> Figure:
    """A column for each wind speed: y, z and phi over the whole run, and below the periods that matter one by one."""
    states = [name for name in _STATES if name in result.model.states]
    with style.journal(figure, width="double", height=36.0 * (len(states) + 1) + 14.0):
        grid = figure.add_gridspec(len(states) + 1, len(result.runs))
        letters = iter("abcdefghijkl")
        rows: list[list[Axes]] = [[] for _ in range(len(states) + 1)]
        for row in range(len(states) + 1):
            for column, (speed, one) in enumerate(result.runs.items()):
                axes = figure.add_subplot(grid[row, column])
                rows[row].append(axes)
                style.panel(axes, next(letters), _title(row, len(states), speed, one))
                if one is None:
                    style.note(axes, f"no upper rivulet D at {speed:g} m/s")
                elif row < len(states):
                    _whole(result, one, axes, states[row], names=row == len(states) - 1)
                else:
                    _closely(result, one, axes)
        for row, name in zip(rows, [*states, "phi"], strict=True):
            row[0].set_ylabel(_STATES[name][0])
        for row in rows[: len(states) - 1]:
            _together(row)
        for axes in [*rows[len(states) - 1], *rows[-1]]:
            axes.set_xlabel("time (s)")
        _legend(result, figure)
    return figure


def _title(row: int, states: int, speed: float, one: Transient | None) -> str:
    if row == 0:
        ends = {
            "cycle": "to a limit cycle",
            "": "no end within the run",
            "turning": "the rivulet turns for ever",
        }
        return (
            f"{speed:g} m/s" if one is None else f"{speed:g} m/s: {ends.get(one.end, f'falls to {one.end}')}"
        )
    if row < states or one is None:
        return ""
    if np.isfinite(one.lost):
        return "the fall, close up"
    return "the cycle, close up" if one.end == "cycle" else "the end, close up"


def _until(result: Result, one: Transient) -> float:
    """How much of a run is drawn: until a good while after it has ended where it ends."""
    if not np.isfinite(one.since) or one.end == "D":
        return one.run.duration
    tidy, longer = 50.0 * result.period, 1.3 if one.end == "cycle" else 1.6
    return min(one.run.duration, tidy * np.ceil(longer * one.since / tidy))


def _whole(result: Result, one: Transient, axes: Axes, name: str, *, names: bool) -> None:
    """One state over the run, from the lowest to the highest value of each period; what it comes to."""
    until, scale, i = _until(result, one), _STATES[name][1], one.run.states.index(name)
    edges = np.arange(0.0, until + 0.5 * result.period, result.period)
    edges = edges[edges <= one.run.duration]
    low, high = (scale * side[:, i] for side in extremes_between(one.run, edges))
    middle = 0.5 * (edges[:-1] + edges[1:])
    axes.fill_between(middle, low, high, color=_BAND, linewidth=0.0)
    axes.plot(middle, low, color=style.BLACK, linewidth=0.5)
    axes.plot(middle, high, color=style.BLACK, linewidth=0.5)
    axes.set_xlim(0.0, until)
    if one.cycle is not None:
        for level in scale * one.cycle.extremes[:, i]:
            axes.axhline(level, color=style.VERMILION, linewidth=0.8, linestyle=style.DASHED)
    if name == "phi":
        _levels(one, axes)
    for time in (one.since if one.end == "cycle" else np.nan, one.lost):
        if np.isfinite(time):
            axes.axvline(time, color=style.GREEN, linewidth=0.8)
    if names:
        _times(one, axes)


def _times(one: Transient, axes: Axes) -> None:
    """At the lines of time, what happens."""
    found = []
    if np.isfinite(one.lost):
        found.append((one.lost, f"passes C\n{one.lost:.0f} s"))
    if one.end == "cycle":
        found.append((one.since, f"within 1 %\n{one.since:.0f} s"))
    for time, text in found:
        axes.annotate(
            text, (time, 0.5), xycoords=("data", "axes fraction"), xytext=(4, 0), textcoords="offset points",
            fontsize=7, color=style.GREEN, ha="left", va="center",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )  # fmt: skip


def _levels(one: Transient, axes: Axes) -> None:
    """The angles of the equilibria, with their letters at the right."""
    swing = np.degrees(one.run["phi"])
    for letter, rest in one.rest.items():
        angle = float(np.degrees(rest["phi"]))
        if swing.min() - 15.0 < angle < swing.max() + 15.0:
            axes.axhline(angle, color=_LEVEL, linewidth=0.6, zorder=2.2)
            axes.annotate(
                letter, (1.0, angle), xycoords=("axes fraction", "data"), xytext=(2, 0),
                textcoords="offset points", fontsize=7, color=_LEVEL, va="center",
            )  # fmt: skip


def _closely(result: Result, one: Transient, axes: Axes) -> None:
    """The rivulet's angle about the fall, or over the last periods."""
    if np.isfinite(one.lost):
        since, until = one.lost - _BEFORE * result.period, one.lost + _AFTER * result.period
    else:
        until = _until(result, one)
        since = until - _LOOPS * result.period
    since, until = max(since, 0.0), min(until, one.run.duration)
    t = np.linspace(since, until, int(_POINTS * (until - since) / result.period) + 1)
    axes.plot(t, np.degrees(one.run.at(t)[:, one.run.states.index("phi")]), color=style.BLACK, linewidth=0.9)
    axes.set_xlim(since, until)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, integer=True))
    if np.isfinite(one.lost):
        axes.axvline(one.lost, color=style.GREEN, linewidth=0.8)
        _levels(one, axes)
        return
    axes.axhline(float(np.degrees(one.rest["D"]["phi"])), color=_LEVEL, linewidth=0.6)
    axes.annotate(
        "D", (1.0, float(np.degrees(one.rest["D"]["phi"]))), xycoords=("axes fraction", "data"), xytext=(2, 0),
        textcoords="offset points", fontsize=7, color=_LEVEL, va="center",
    )  # fmt: skip


def _together(row: list[Axes]) -> None:
    """The same scale in all panels of a row."""
    ends = [axes.get_ylim() for axes in row if axes.lines]
    for axes in row:
        if ends:
            axes.set_ylim(min(low for low, _ in ends), max(high for _, high in ends))


def _legend(result: Result, figure: Figure) -> None:
    handles: list[Line2D | Patch] = [
        Patch(facecolor=_BAND, edgecolor=style.BLACK, linewidth=0.5, label="lowest to highest of each period")
    ]
    ends = [one.end for one in result.runs.values() if one is not None]
    if "cycle" in ends:
        handles.append(
            Line2D([], [], color=style.VERMILION, linestyle=style.DASHED, linewidth=0.8, label="the limit cycle's ends")
        )  # fmt: skip
    handles.append(Line2D([], [], color=_LEVEL, linewidth=0.6, label="equilibria A to D"))
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))


def tables(result: Result) -> dict[str, Table]:
    """Each run as drawn: extremes of each period, the periods drawn one by one, and where each ended."""
    found = {"ends": _ends(result)}
    for speed, one in result.runs.items():
        if one is not None:
            found[f"periods_{speed:g}".replace(".", "_")] = _periods(result, one)
            found[f"course_{speed:g}".replace(".", "_")] = _course(
                one.run, _until(result, one), result.period
            )
    return found


def _ends(result: Result) -> Table:
    runs = [one for one in result.runs.values() if one is not None]
    return Table(
        {
            "wind_speed": Column(np.array([one.speed for one in runs]), "m/s", "undisturbed wind speed"),
            "end": Column(np.array([one.end for one in runs], dtype=object), "", "where the run ended"),
            "since": Column(np.array([one.since for one in runs]), "s", "time from which on it is there"),
            "lost": Column(np.array([one.lost for one in runs]), "s", "time at which the rivulet passes C"),
            "duration": Column(np.array([one.run.duration for one in runs]), "s", "time computed"),
            "disturbance": Column(np.array([one.disturbance for one in runs]), "m", "of y at D at the start"),
        }
    )


def _periods(result: Result, one: Transient) -> Table:
    edges = np.arange(0.0, one.run.duration, result.period)
    low, high = extremes_between(one.run, edges)
    columns = {"time": Column(0.5 * (edges[:-1] + edges[1:]), "s", "middle of the period")}
    for i, name in enumerate(one.run.states[: len(one.run.states) // 2]):
        for of, side in (("min", low), ("max", high)):
            columns[f"{of}_{name}"] = Column(
                side[:, i], _UNITS[name], f"{of} over the period, {_MEANING[name]}"
            )
    return Table(columns, {"wind_speed": one.speed})


def _course(run: Trajectory, until: float, period: float) -> Table:
    t = np.arange(0.0, until, 4.0 * period / _POINTS)
    columns = {"time": Column(t, "s", "time")}
    for name, values in zip(run.states, run.at(t).T, strict=True):
        what = name.removesuffix("_dot")
        rate = what != name
        columns[name] = Column(
            values, _UNITS[what] + "/s" * rate, ("rate of the " if rate else "") + _MEANING[what]
        )
    return Table(columns)


def summary(result: Result) -> list[str]:
    """For each wind speed where the run ended and after how long."""
    return [
        f"There is no upper rivulet D at {speed:g} m/s." if one is None else in_words(one)
        for speed, one in result.runs.items()
    ]
