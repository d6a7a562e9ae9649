"""Quasi-static wind sweeps up and down (section 4.3): what vibrates depends on where the wind came from.

The wind rises or falls in steps, each held until the vibration has settled, with a push of 1 mm at each; where much
changes, the steps become finer, down to 0.01 m/s. Symbols: what the sweep settles to. Lines behind: the limit cycles of
figure 7. Near a point where the vibration begins or becomes unstable it settles ever more slowly; what had not after 50
minutes is marked. The paper has jumps at 10.7 m/s (falling wind) and 12.7 m/s (rising wind), each to another vibration.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from rainwind.dynamics.diagram_results import drawn
from rainwind.dynamics.results import Equilibrium
from rainwind.dynamics.sweeps import Level, Sweep, SweepEnded, sweep
from rainwind.errors import InputError
from rainwind.io.results import Column, Table, save_csv
from rainwind.io.units import KINDS, from_text
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.branches import draw_branch
from rainwind.plotting.cycles import COLORS, LINES, NAMES, draw_cycles, draw_jump, legend_of
from rainwind.studies import paper
from rainwind.studies.cycle_map import SPEED, CycleMap, cycle_map
from rainwind.studies.equilibrium_map import speed_window

STEP, FINEST = 0.5, 0.01  # m/s
PUSH = 1e-3  # m, of y at each step
_HOLD, _LONGEST = 60.0, 3000.0  # periods of the cable
_SWING = 0.5  # rad: what counts as large for the rivulet's angle; for y and z the diameter does
_VIBRATES = 0.02  # of the diameter: what is smaller is called rest
_LOOK = {  # by whether the wind rises: marker, colour, word
    True: (">", style.BLUE, "rising wind"),
    False: ("<", style.VERMILION, "falling wind"),
}
# where it had not settled
_CROSS: dict[str, Any] = {
    "linestyle": "", "marker": "x", "markersize": 4.0, "markeredgewidth": 0.7, "color": "black", "zorder": 4,
}  # fmt: skip
_LOST = "an equilibrium without a letter"
_UNITS = {"y": "m", "phi": "rad", "z": "m"}


Told = Callable[[float, str], None]


@dataclass(frozen=True)
class Jump:
    """A jump of a sweep: the wind speed between its two levels (m/s), what was there before and after, in words.

    kind, point: the nearest point at which something of the map of limit cycles ends or changes its stability; start,
    end: half peak-to-peak (y, z) in m.
    """

    rising: bool
    speed: float
    resolution: float
    before: str
    after: str
    kind: str
    point: float
    start: tuple[float, float]
    end: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Result:
    """The cycles from continuation, the sweeps, each with where it began in words, and all jumps."""

    cycles: CycleMap
    speeds: tuple[float, float]
    sweeps: tuple[Sweep, ...]
    began: tuple[str, ...]
    jumps: tuple[Jump, ...]

    @property
    def interrupted(self) -> bool:
        """Whether the user stopped it."""
        return any(one.ended is SweepEnded.INTERRUPTED for one in self.sweeps)


def compute(
    model: RivuletModel | None = None,
    *,
    speeds: tuple[float, float] | None = None,
    step: float = STEP,
    finest: float = FINEST,
    progress: Callable[[str], None] | None = None,
    told: Told | None = None,
) -> Result:
    """Sweeps over `speeds` (m/s), by default figure 7's.

    Up from everything that is stable at the low end, down from everything at the high end, and back from just before
    each jump. step: the longest between two wind speeds; finest: to which jumps are closed in. progress(words) and
    told(share done, words) are called often. Ctrl-C keeps what is done.
    """
    model = model or paper.model()
    usual = speed_window(model)
    low, high = speeds or usual
    # a narrow window has no Hopf point from which to follow the cycles in it
    known = cycle_map(model, (min(low, usual[0]), max(high, usual[1])))
    starts = [
        (end, other, one.state if isinstance(one, Equilibrium) else one.profile[0], name)
        for end, other in ((low, high), (high, low))
        for name, one in known.attractors(end)
    ]
    found: list[Sweep] = []
    began: list[str] = []
    while starts:
        first, last, state, name = starts.pop(0)
        if any(_passed(one, first, last, state) for one in found):
            continue
        words = f"from {_noun(name)} at {first:.2f} m/s"
        done, total = len(found), len(found) + 1 + len(starts)

        def at(value: float, first: float = first, last: float = last, done: int = done, total: int = total,
               words: str = words) -> None:  # fmt: skip
            now = f"{'up' if last > first else 'down'} {words}: {value:.2f} m/s"
            if progress is not None:
                progress(now)
            if told is not None:
                told((done + (value - first) / (last - first)) / total, now)

        one = _one(model, first, last, state, step, finest, at)
        found.append(one)
        began.append(words)
        if one.ended is SweepEnded.INTERRUPTED:
            break
        for jump in one.jumps:
            back = low if one.rising else high
            if jump.before.value not in (low, high):
                starts.append((jump.before.value, back, jump.before.state, _name(known, jump.before)))
    jumps = [jump for one in found for jump in _jumps(known, one)]
    return Result(known, (low, high), tuple(found), tuple(began), tuple(jumps))


def step_from_text(text: str) -> float:
    """The longest step of the wind speed (m/s), as typed. Raises InputError."""
    try:
        try:
            found = float(text)
        except ValueError:
            found = from_text(text, KINDS["speed"])
        if not FINEST <= found <= 10.0:
            raise InputError(f"is not from {FINEST:g} to 10 m/s")
    except InputError as error:
        raise InputError(f"--step '{text}' {error}") from error
    return found


def _one(
    model: RivuletModel, first: float, last: float, state: np.ndarray, step: float, finest: float,
    progress: Callable[[float], None],
) -> Sweep:  # fmt: skip
    period, diameter = 1.0 / model.section.frequency_y, model.section.diameter
    return sweep(
        model,
        SPEED,
        start=state,
        until=(first, last),
        step=step,
        finest=finest,
        scales={"phi": _SWING} | {name: diameter for name in ("y", "z") if name in model.states},
        push={"y": PUSH},
        hold=_HOLD * period,
        tolerance=1e-8,
        longest=_LONGEST * period,
        progress=progress,
    )


def _passed(one: Sweep, first: float, last: float, state: np.ndarray) -> bool:
    """Whether a sweep went from this state already: the same way, through it."""
    if one.rising != (last > first):
        return False
    gaps = [np.abs(level.state - state).max() for level in one.levels if abs(level.value - first) < 1e-9]
    return bool(gaps) and min(gaps) < 1e-3


def _name(known: CycleMap, level: Level) -> str:
    """What a level is, in a word: the letter of the equilibrium, or "cycle"."""
    if _size(known, level) > _VIBRATES * known.equilibria.model.section.diameter:
        return "cycle"
    return known.equilibria.letter_near(level.value, level.middle)


def _noun(name: str) -> str:
    return {"cycle": "a vibration", "": _LOST}.get(name, name)


def _size(known: CycleMap, level: Level) -> float:
    return max(_sizes(known, level))


def _sizes(known: CycleMap, level: Level) -> tuple[float, float]:
    states = known.equilibria.model.states
    y, z = (float(level.amplitude[states.index(name)]) if name in states else 0.0 for name in ("y", "z"))
    return y, z


def _jumps(known: CycleMap, one: Sweep) -> list[Jump]:
    found = []
    points = [
        *((p.kind, p.parameter) for kind in NAMES for p in known.diagram.points(kind)),
        *(("fold", p.parameter) for side in known.equilibria.sides for p in side.folds),
    ]
    for jump in one.jumps:
        kind, at = min(points, key=lambda point: abs(point[1] - jump.value), default=("", float("nan")))
        # what had not settled yet is named after what it comes to
        later = [
            level
            for level in one.levels
            if jump.after is not None
            and abs(level.value - jump.before.value) >= (abs(jump.after.value - jump.before.value))
            and level.steady
            and (level.value > jump.value) == one.rising
        ]
        after = "nowhere" if jump.after is None else _name(known, (*later, jump.after)[0])
        width = abs(jump.value - jump.before.value)
        end = (0.0, 0.0) if jump.after is None else _sizes(known, jump.after)
        found.append(
            Jump(
                one.rising, jump.value, width, _name(known, jump.before), after, kind, at,
                _sizes(known, jump.before), end,
            )
        )  # fmt: skip
    return found


def draw(result: Result, figure: Figure) -> Figure:
    """Amplitudes of y and z and the rivulet's angle over wind speed: both directions, arrows where they jump."""
    known = result.cycles
    names = [name for name in ("y", "z", "phi") if name in known.equilibria.model.states]
    with style.journal(figure, width="double", height=84.0):
        panels = figure.subplots(1, len(names))
        for axes, name, letter in zip(panels, names, "abc", strict=False):
            _behind(known, axes, name)
            axes.set(xlim=result.speeds, xlabel=style.UNDISTURBED)
            if name == "phi":
                _angle(result, axes, letter)
            else:
                _amplitude(result, axes, name, letter)
        _legend(result, figure)
        notes = [one.note for one in result.sweeps if one.note]
        if result.interrupted:
            notes.append("stopped by the user before its end")
        style.below(figure, (*known.equilibria.notes, *notes), letters=130)
    return figure


def _behind(known: CycleMap, axes: Axes, name: str) -> None:
    """The branches from continuation, faint."""
    degrees = float(np.degrees(1.0))
    if name == "phi":
        for branch in known.equilibria.branches:
            draw_branch(branch, axes, "phi", scale=degrees)
        for branch in known.branches:
            for unstable, (x, *sides) in drawn(branch, SPEED, "min phi", "max phi"):
                for side in sides:
                    axes.plot(
                        x, degrees * side, color=COLORS[min(unstable, 2)], linestyle=LINES[min(unstable, 2)]
                    )
    else:
        for branch in known.branches:
            draw_cycles(branch, axes, name)
    for line in list(axes.lines):
        if line.get_linestyle() == "None":
            line.remove()
        else:
            line.set(alpha=0.4, linewidth=0.9, zorder=1.0)


def _amplitude(result: Result, axes: Axes, name: str, letter: str) -> None:
    style.panel(axes, letter, {"y": "cross-wind amplitude", "z": "in-wind amplitude"}[name])
    axes.set_ylabel(rf"half amplitude of ${name}$ (m)")
    for one in result.sweeps:
        _symbols(axes, one, one[name])
    k = ("y", "z").index(name)
    for jump in result.jumps:
        if jump.after != "nowhere":
            draw_jump(axes, jump.speed, jump.start[k], jump.end[k])
        if name == "y":
            _label(axes, jump)
    axes.set_ylim(bottom=0.0)


def _symbols(axes: Axes, one: Sweep, values: np.ndarray) -> None:
    """One symbol for each level, crossed out where it had not settled."""
    marker, color, _ = _LOOK[one.rising]
    axes.plot(
        one.values, values, linestyle="", marker=marker, markersize=2.6, color=color, zorder=3,
        markeredgewidth=0.5, markerfacecolor="white" if one.rising else color, clip_on=False,
    )  # fmt: skip
    slow = np.array([not level.steady for level in one.levels], dtype=bool)
    axes.plot(one.values[slow], values[slow], **_CROSS)


def _label(axes: Axes, jump: Jump) -> None:
    """The jump's speed and where it goes, beside its arrow."""
    to = "away" if jump.after == "nowhere" else f"to {'a cycle' if jump.after == 'cycle' else jump.after}"
    left = axes.transData.transform((jump.speed, 0.0))[0] < axes.bbox.x0 + 0.5 * axes.bbox.width
    axes.annotate(
        f"{jump.speed:.2f} m/s\n{to}", (jump.speed, 0.5 * (jump.start[0] + jump.end[0])),
        xytext=(-4 if left else 4, 0), textcoords="offset points", ha="right" if left else "left", va="center",
        fontsize=7, color=style.GREEN,
    )  # fmt: skip


def _angle(result: Result, axes: Axes, letter: str) -> None:
    style.panel(axes, letter, "rivulet angle, lowest to highest")
    axes.set_ylabel(r"$\phi$ (°)")
    seen: list[float] = []
    for one in result.sweeps:
        low, high = np.degrees(one["min phi"]), np.degrees(one["max phi"])
        for side in (low, high):
            _symbols(axes, one, side)
        seen += [float(low.min()), float(high.max())] if len(one.levels) else []
        for jump in one.jumps:
            if jump.after is not None:
                i = one.states.index("phi")
                draw_jump(
                    axes, jump.value, *(float(np.degrees(at.middle[i])) for at in (jump.before, jump.after))
                )
    if seen:
        low, high = min(seen), max(seen)
        axes.set_ylim(low - 0.08 * (high - low) - 5.0, high + 0.08 * (high - low) + 5.0)
    for side in result.cycles.equilibria.sides:
        speed = result.speeds[1] - 0.02 * (result.speeds[1] - result.speeds[0])
        at = side.at(speed)
        if (
            side.letter
            and at is not None
            and min(seen, default=0.0) < np.degrees(at[1]) < max(seen, default=0.0)
        ):
            axes.annotate(
                side.letter, (result.speeds[1], float(np.degrees(at[1]))), xytext=(3, 0),
                textcoords="offset points", va="center", fontsize=7, annotation_clip=False,
            )  # fmt: skip


def _legend(result: Result, figure: Figure) -> None:
    handles = [
        Line2D(
            [], [], linestyle="", marker=_LOOK[rising][0], color=_LOOK[rising][1], markersize=3.6,
            markerfacecolor="white" if rising else _LOOK[rising][1], label=_LOOK[rising][2],
        )
        for rising in (True, False)
        if any(one.rising == rising for one in result.sweeps)
    ]  # fmt: skip
    if any(not level.steady for one in result.sweeps for level in one.levels):
        handles.append(Line2D([], [], **_CROSS, label=f"not settled after {_patience(result):.0f} min"))
    counts = [unstable for branch in result.cycles.branches for unstable, _ in branch.pieces(SPEED)]
    handles += legend_of(counts, (), jumps=bool(result.jumps))
    figure.legend(
        handles=handles, loc="outside upper center", ncols=(len(handles) + 1) // 2, handlelength=2.2
    )


def tables(result: Result) -> dict[str, Table]:
    """Each sweep with its levels, and the jumps beside the nearest points from continuation."""
    found = {f"sweep_{k}_{'up' if s.rising else 'down'}": _table(s, words) for k, (s, words) in enumerate(
        zip(result.sweeps, result.began, strict=True), 1)}  # fmt: skip
    jumps = result.jumps
    found["jumps"] = Table(
        {
            "direction": Column(np.array([_way(j) for j in jumps], dtype=object), "", "of the wind"),
            "wind_speed": Column(np.array([j.speed for j in jumps]), "m/s", "undisturbed wind speed of the jump"),
            "resolution": Column(np.array([j.resolution for j in jumps]), "m/s", "either way"),
            "before": Column(np.array([j.before for j in jumps], dtype=object), "", "what it leaves"),
            "after": Column(np.array([j.after for j in jumps], dtype=object), "", "where it goes"),
            "kind": Column(np.array([j.kind for j in jumps], dtype=object), "", "nearest point of the limit cycles"),
            "point": Column(np.array([j.point for j in jumps]), "m/s", "its wind speed"),
        }
    )  # fmt: skip
    return found


def _way(jump: Jump) -> str:
    return "up" if jump.rising else "down"


def _table(one: Sweep, words: str) -> Table:
    columns = {
        "wind_speed": Column(one.values, "m/s", "undisturbed wind speed"),
        "held": Column(np.array([level.held for level in one.levels]), "s", "time until it had settled"),
        "steady": Column(np.array([int(level.steady) for level in one.levels]), "", "whether it had"),
    }
    for name in one.states[: len(one.states) // 2]:
        for of in ("min", "max"):
            columns[f"{of}_{name}"] = Column(one[f"{of} {name}"], _UNITS.get(name, ""), f"{of} of {name}")
    return Table(columns, {"began": words, "ended": one.ended.value})


def save(result: Result, path: Path) -> None:
    """Draw it into an image file. OSError where it cannot be written."""
    style.save(draw(result, Figure()), path)


def save_tables(result: Result, image: Path) -> list[Path]:
    """Write every table beside the image, as `sweep_jumps.csv`; the files' names. InputError."""
    paths = []
    for name, table in tables(result).items():
        paths.append(image.with_name(f"{image.stem}_{name}.csv"))
        save_csv(paths[-1], table)
    return paths


def summary(result: Result) -> list[str]:
    """In sentences: each sweep, its jumps, and which points of the limit cycles they are."""
    said = []
    for one, words in zip(result.sweeps, result.began, strict=True):
        way = "Rising" if one.rising else "Falling"
        if not one.levels:
            continue
        last = one.levels[-1]
        end = _name(result.cycles, last)
        course = "; ".join(_said(jump) for jump in _jumps(result.cycles, one)) or "no jump"
        where = f"at {last.value:.2f} m/s {'it vibrates' if end == 'cycle' else f'it is at rest at {end or _LOST}'}"
        said.append(f"{way} wind {words}: {course}; {where}.")
        if one.ended is not SweepEnded.AT_END:
            said.append(f"This sweep ended early: {one.note or one.ended.value}.")
        slow = [level.value for level in one.levels if not level.steady]
        if slow:
            said.append(
                f"At {len(slow)} of its {len(one.levels)} wind speeds, {_between(slow)}, it had not settled after "
                f"{_patience(result):.0f} min: it changes slowly there, and amplitudes are those of the last minute."
            )
    return said


def _patience(result: Result) -> float:
    """How long a level was held at most (min), but for those before a jump."""
    return _LONGEST / result.cycles.equilibria.model.section.frequency_y / 60.0


def _between(speeds: list[float]) -> str:
    """Wind speeds in words, those less than 0.5 m/s apart together."""
    speeds = sorted(speeds)
    groups = np.split(np.array(speeds), np.flatnonzero(np.diff(speeds) > STEP) + 1)
    return " and ".join(
        f"{g[0]:.2f} m/s" if f"{g[0]:.2f}" == f"{g[-1]:.2f}" else f"{g[0]:.2f} to {g[-1]:.2f} m/s"
        for g in groups
    )


def _said(jump: Jump) -> str:
    kinds = {"fold": "fold of equilibria", **NAMES}
    before, after = (_noun(one) for one in (jump.before, jump.after))
    return (
        f"at {jump.speed:.3f} m/s (±{jump.resolution:.3f}) it jumps from {before} to {after}; the nearest point of the "
        f"limit cycles is the {kinds.get(jump.kind, jump.kind)} at {jump.point:.3f} m/s"
    )
