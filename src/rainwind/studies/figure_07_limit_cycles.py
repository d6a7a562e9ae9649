"""Figure 7 (section 4.3): amplitudes of the limit cycles in y and z over the wind speed, and the cycles themselves.

The paper has one stable cycle at 8-10.7 and 12.7-14.8 m/s and two, with an unstable one, between. With our coefficients
the folds of cycles lie there, but the in-wind cycles are saddles: only the cross-wind ones are stable, from a
Neimark-Sacker point up to the Hopf point. Amplitudes are half the peak-to-peak values. Tests pin AUTO-07p's folds of
cycles, its Neimark-Sacker point and the three cycles at 12 m/s.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import floor, log10

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.ticker import MaxNLocator

from rainwind.dynamics.diagram_results import drawn
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.results import Equilibrium
from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.cycles import draw_cycles, draw_jump, draw_orbit, draw_time, label_clear, legend_of
from rainwind.studies import paper
from rainwind.studies.cycle_map import SPEED, CycleMap, cycle_map
from rainwind.studies.cycle_tables import cycle_tables
from rainwind.studies.equilibrium_names import LETTERS, with_letter

SHOWN = (9 / 8, 12 / 8, 14 / 8)  # the paper's 9, 12, 14 m/s, as multiples of the onset speed
_SPREAD = (1 / 6, 1 / 2, 5 / 6)  # parts of the speeds with cycles: drawn are these if one of those has none
_LEAST = (22.0, 9.0)  # mm: a panel that equal scales would make smaller has none
_ONE_PERIOD = 1.5  # a cycle is doubled where its period is this much longer than the shortest
_SIDE = 1e-3  # of the window: how far beyond its end a stable branch's jump is looked up


@dataclass(frozen=True)
class Jump:
    """Where a stable branch of cycles ends although the wind speed goes on: at `speed`, upwards or downwards.

    start, end: amplitudes (y, z) before and after in m; to: "cycle" or the letter of the equilibrium it goes to.
    """

    speed: float
    rising: bool
    kind: str
    start: tuple[float, float]
    end: tuple[float, float]
    to: str


@dataclass(frozen=True, eq=False)
class Result:
    """All cycles, those at the chosen wind speeds (m/s), and the jumps."""

    cycles: CycleMap
    shown: dict[float, tuple[Orbit, ...]]
    jumps: tuple[Jump, ...]


def compute(model: RivuletModel | None = None, *, speeds: tuple[float, float] | None = None) -> Result:
    """Every branch of cycles in the window `speeds` (m/s), by default around the model's onset."""
    known = cycle_map(model or paper.model(), speeds)
    return Result(known, {speed: known.cycles(speed) for speed in _chosen(known)}, tuple(_jumps(known)))


def _chosen(known: CycleMap) -> list[float]:
    """Three wind speeds at which there are cycles: the paper's multiples of the onset if it has them, else others."""
    spans = _joined([(float(b.parameter.min()), float(b.parameter.max())) for b in known.branches])
    total = sum(high - low for low, high in spans)
    if total <= 0.0:
        return []
    onset = known.equilibria.onset or known.equilibria.speeds[0]
    usual = [round(factor * onset, 1) for factor in SHOWN]
    if all(any(low < speed < high for low, high in spans) for speed in usual):
        return usual
    digits = max(1, 1 - floor(log10(total / 10)))
    return sorted({round(_along(spans, part * total), digits) for part in _SPREAD})


def _joined(spans: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Overlapping ranges made one."""
    found: list[tuple[float, float]] = []
    for low, high in sorted(spans):
        if found and low <= found[-1][1]:
            low, high = found[-1][0], max(high, found.pop()[1])
        found.append((low, high))
    return found


def _along(spans: list[tuple[float, float]], distance: float) -> float:
    """The speed at a distance from the start of several ranges, gaps left out."""
    for low, high in spans:
        if distance <= high - low:
            return low + distance
        distance -= high - low
    return spans[-1][1]


def _jumps(known: CycleMap) -> list[Jump]:
    """A stable branch that ends at a fold of cycles, or at another point that is hard (subcritical)."""
    low, high = known.equilibria.speeds
    found = []
    for branch in known.branches:
        pieces = list(branch.pieces(SPEED))
        counts = [unstable for unstable, _ in pieces]
        cuts = [p for p in branch.special if isinstance(p, OrbitPoint)]
        for (before, after), point in zip(pairwise(counts), cuts, strict=False):
            # an unknown coefficient is nan: no jump is claimed
            hard = point.kind == "lpc" or (point.coefficient is not None and point.coefficient > 0)
            if (before == 0) == (after == 0) or not hard:
                continue
            k = cuts.index(point) + (after == 0)
            middle = float(np.median(pieces[k][1][0]))
            rising = middle < point.parameter
            beyond = point.parameter + (1 if rising else -1) * _SIDE * (high - low)
            if low < beyond < high:
                found.append(_jump(known, point, rising, beyond))
    return sorted(found, key=lambda jump: jump.speed)


def _jump(known: CycleMap, point: OrbitPoint, rising: bool, beyond: float) -> Jump:
    """To the cycle with the nearest amplitude, else to D, else to A: which it is depends on the start."""
    here = _sizes(point.orbit)
    stable = known.attractors(beyond)
    cycles = [_sizes(one) for _, one in stable if isinstance(one, Orbit)]
    if cycles:
        end = min(cycles, key=lambda size: abs(size[0] - here[0]) + abs(size[1] - here[1]))
        return Jump(point.parameter, rising, point.kind, here, end, "cycle")
    letters = sorted((name for name, one in stable if isinstance(one, Equilibrium)), reverse=True)
    return Jump(point.parameter, rising, point.kind, here, (0.0, 0.0), letters[0] if letters else "")


def _sizes(orbit: Orbit) -> tuple[float, float]:
    size = orbit.amplitude
    return size["y"], size.get("z", 0.0)


def draw(result: Result, figure: Figure) -> Figure:
    """Amplitudes above; below, for each chosen wind speed, the cycles in the y-z plane and the rivulet's angle."""
    known = result.cycles
    if not known.branches:
        with style.journal(figure, width="single", height=60):
            axes = figure.add_subplot()
            axes.set(xlim=known.equilibria.speeds, xlabel=style.UNDISTURBED, ylabel="half amplitude (m)")
            axes.set_yticks([])
            style.note(axes, "no limit cycle is born in this window")
            style.below(figure, known.equilibria.notes)
        return figure
    states = known.branches[0].states
    wide = "z" in states
    count = max(1, len(result.shown))
    with style.journal(figure, width="double", height=142 if wide else 108):
        grid = figure.add_gridspec(
            3 if wide else 2, 2 * count, height_ratios=(1.5, 0.62, 0.75) if wide else (1.5, 0.8)
        )
        top = [figure.add_subplot(grid[0, :count] if wide else grid[0, :])]
        if wide:
            top.append(figure.add_subplot(grid[0, count:]))
        for axes, name, letter in zip(top, ("y", "z"), "ab", strict=False):
            _amplitudes(result, axes, name, letter)
        _legend(result, figure)
        _cycles(result, figure, grid, wide)
        style.below(figure, (*known.equilibria.notes, *known.diagram.notes), letters=130)
    return figure


def _amplitudes(result: Result, axes: Axes, name: str, letter: str) -> None:
    known = result.cycles
    what = {"y": "cross-wind", "z": "in-wind"}[name]
    style.panel(axes, letter, f"{what} amplitude")
    for branch in known.branches:
        draw_cycles(branch, axes, name)
    diameter = known.equilibria.model.section.diameter
    low, high = known.equilibria.speeds
    axes.set(xlim=(low, high), xlabel=style.UNDISTURBED, ylabel=rf"half amplitude of ${name}$ (m)")
    axes.set_ylim(bottom=0.0)
    axes.set_ylim(top=1.08 * axes.get_ylim()[1])
    axes.axhline(diameter, color=style.GREY, linewidth=0.5, zorder=0)
    axes.annotate(
        r"$d$", (high, diameter), xytext=(-3, 2), textcoords="offset points", ha="right", fontsize=7,
        color=style.GREY,
    )  # fmt: skip
    k = ("y", "z").index(name)
    for jump in result.jumps:
        draw_jump(axes, jump.speed, jump.start[k], jump.end[k])
        if jump.to not in ("cycle", "") and name == "y":
            axes.annotate(
                f"to {jump.to}", (jump.speed, 0.1 * jump.start[k]), xytext=(4, 0), textcoords="offset points",
                ha="left", va="center", fontsize=7, color=style.GREEN,
            )  # fmt: skip
    for speed in result.shown:
        axes.plot([speed], [0.0], marker="|", markersize=7, color=style.GREY, clip_on=False, zorder=1)
    _name_points(known, axes, name)


def _name_points(known: CycleMap, axes: Axes, name: str) -> None:
    """Speeds at the Hopf points and at the labelled cycles of the branches born there."""
    named: list[tuple[float, float, str]] = []
    (low, high), top = axes.get_xlim(), axes.get_ylim()[1]
    for branch in known.singles:
        for point in branch.points():
            x, y = point.parameter, point.orbit.amplitude[name] if isinstance(point, OrbitPoint) else 0.0
            if not any(abs(x - a) < 0.008 * (high - low) and abs(y - b) < 0.06 * top for a, b, _ in named):
                named.append((x, y, f"{x:.2f}"))
    label_clear(axes, named)


def _legend(result: Result, figure: Figure) -> None:
    known = result.cycles
    counts = [unstable for branch in known.branches for unstable, _ in drawn(branch, SPEED)]
    kinds = [kind for kind in ("hopf", "lpc", "ns", "pd") if any(b.points(kind) for b in known.branches)]
    handles = legend_of(counts, kinds, jumps=bool(result.jumps))
    figure.legend(
        handles=handles, loc="outside upper center", ncols=(len(handles) + 1) // 2, handlelength=2.6
    )


def _cycles(result: Result, figure: Figure, grid: GridSpec, wide: bool) -> None:
    known = result.cycles
    letters = iter("cdefghij" if wide else "bcdefghi")
    rows: list[list[Axes]] = [[], []]
    for column, (speed, orbits) in enumerate(result.shown.items()):
        cell = slice(2 * column, 2 * column + 2)
        if wide:
            axes = figure.add_subplot(grid[1, cell])
            style.panel(axes, next(letters), f"{speed:g} m/s")
            for orbit in orbits[::-1]:
                draw_orbit(orbit, axes, "z", "y")
            axes.set_xlabel("$z$ (m), leeward")
            rows[0].append(axes)
    for column, (speed, orbits) in enumerate(result.shown.items()):
        axes = figure.add_subplot(grid[-1, 2 * column : 2 * column + 2])
        style.panel(axes, next(letters), f"{speed:g} m/s")
        if not orbits:
            style.note(axes, "no limit cycle at this wind speed")
        for orbit in orbits[::-1]:
            draw_time(orbit, axes, "phi", from_top_of="y", scale=float(np.degrees(1.0)))
        side = known.equilibria["D"]
        at = side.at(speed) if side else None
        if at is not None:
            axes.axhline(float(np.degrees(at[1])), color=style.GREY, linewidth=0.6)
            axes.annotate(
                "D", (1.0, float(np.degrees(at[1]))), xytext=(2, 0), textcoords="offset points", fontsize=7,
                ha="left", va="center", color=style.GREY, annotation_clip=False,
            )  # fmt: skip
        axes.set(xlim=(0.0, 1.0), xlabel="time / period, from the largest $y$")
        rows[1].append(axes)
    for row, label in zip(rows, ("$y$ (m),\ndownward", "rivulet angle\n" + r"$\phi$ (°)"), strict=True):
        if row:
            row[0].set_ylabel(label)
            _together(row, aspect=label.startswith("$y$"), size=(150.0 / len(row), 24.0))


def _together(row: list[Axes], *, aspect: bool, size: tuple[float, float]) -> None:
    """The same window in all panels of a row, with equal scales unless they leave too little of it.

    size: about the room of a panel, mm; where equal scales leave less, there are fewer ticks.
    """
    ends = [(axes.get_xlim(), axes.get_ylim()) for axes in row if axes.lines]
    if not ends:
        return
    x = (min(e[0][0] for e in ends), max(e[0][1] for e in ends))
    y = (min(e[1][0] for e in ends), max(e[1][1] for e in ends))
    wide, tall = x[1] - x[0], y[1] - y[0]
    scale = min(size[0] / wide, size[1] / tall)
    equal = aspect and scale * wide > _LEAST[0] and scale * tall > _LEAST[1]
    room = (scale * wide, scale * tall) if equal else size
    for axes in row:
        axes.set(xlim=x, ylim=y)
        axes.xaxis.set_major_locator(MaxNLocator(int(np.clip(room[0] / 11.0, 1, 5))))
        axes.yaxis.set_major_locator(MaxNLocator(int(np.clip(room[1] / 6.0, 2, 4))))
        if equal:
            axes.set_aspect("equal", adjustable="box")


def tables(result: Result) -> dict[str, Table]:
    """Every branch, its labelled cycles, what is stable where, and the cycles drawn."""
    return cycle_tables(result.cycles, result.shown)


def summary(result: Result) -> list[str]:
    """Plain sentences: where cycles are, where stable, what is stable besides, and the jumps."""
    known = result.cycles
    if not known.branches:
        return [*known.equilibria.existence(), "No limit cycle is born in this window."]
    said = known.equilibria.existence()
    for one in known.ranges():
        parts = [with_letter(letter) for letter in one.equilibria]
        parts += [f"a limit cycle of period {o.period:.3g} s ({_said(o)} half way)" for o in one.cycles]
        said.append(f"{one.low:.2f} to {one.high:.2f} m/s: stable {' and '.join(parts) or 'nothing found'}.")
    for kind, words in (
        ("lpc", "Folds of cycles"),
        ("ns", "Neimark–Sacker points"),
        ("pd", "Period doublings"),
    ):
        if points := known.points(kind):
            said.append(f"{words} at {', '.join(f'{p.parameter:.2f}' for p in points)} m/s.")
    for jump in result.jumps:
        goes = "rises above" if jump.rising else "falls below"
        to = {"cycle": "to another cycle", "": "away"}.get(jump.to, f"to equilibrium {jump.to}")
        said.append(f"Where the wind {goes} {jump.speed:.2f} m/s the stable vibration ends and jumps {to}.")
    return [*said, LETTERS, *known.equilibria.notes, *known.diagram.notes]


def _said(orbit: Orbit) -> str:
    return ", ".join(f"{name} {orbit.amplitude[name]:.2f} m" for name in ("y", "z") if name in orbit.states)


def simple_branches(known: CycleMap) -> tuple[OrbitBranch, ...]:
    """The branches whose cycles close after about one period of the cable."""
    shortest = min((float(b["period"].min()) for b in known.branches), default=0.0)
    return tuple(b for b in known.branches if b["period"].max() < _ONE_PERIOD * shortest)
