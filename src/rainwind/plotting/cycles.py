"""Branches of limit cycles as lines by their stability, jumps as arrows, and the cycles themselves."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from rainwind.dynamics.diagram_results import drawn
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch
from rainwind.plotting import branches, style

MARKERS: Mapping[str, Mapping[str, Any]] = {
    "hopf": branches.MARKERS["hopf"],
    "bp": branches.MARKERS["bp"],
    "lpc": {"marker": "s", "markerfacecolor": style.BLACK, "markersize": 3.4},
    "ns": {"marker": "D", "markerfacecolor": "white"},
    "pd": {"marker": "^", "markerfacecolor": "white", "markersize": 4.0},
}
NAMES = {
    "hopf": "Hopf", "lpc": "fold of cycles", "ns": "Neimark–Sacker", "pd": "period doubling", "bp": "branch point",
}  # fmt: skip
# by how many multipliers lie outside the unit circle: 0, 1, 2 and more
LINES = ("-", style.DASHED, style.DOTTED)
COLORS = (style.BLACK, style.VERMILION, style.BLUE)
WORDS = ("stable", "unstable: 1 multiplier outside", "unstable: 2 or more outside")


def draw_cycles(
    branch: OrbitBranch, axes: Axes, of: str = "y", *, against: str | None = None, scale: float = 1.0
) -> Axes:
    """A column (times `scale`) against a parameter, by stability; labelled cycles and Hopf points marked."""
    against = against or branch.along[0]
    for unstable, (x, y) in drawn(branch, against, of):
        k = min(unstable, 2)
        axes.plot(x, scale * y, color=COLORS[k], linestyle=LINES[k], linewidth=1.2 if k == 0 else 0.9)
    for point in branch.points():
        if point.kind == "hopf":
            _mark(axes, "hopf", point[against], 0.0 if of in branch.states else scale * point[of.split()[-1]])
        else:
            _mark(axes, point.kind, point[against], scale * point.orbit.amplitude[of])
    return axes


def _mark(axes: Axes, kind: str, x: float, y: float) -> None:
    axes.plot(
        [x],
        [y],
        linestyle="",
        color=style.BLACK,
        markeredgewidth=0.8,
        zorder=5,
        clip_on=False,
        **MARKERS[kind],
    )


_PLACES = ((1, 0), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1), (0, 1), (0, -1))
_LETTER, _HEIGHT, _GAP = 0.0165, 0.055, 0.018  # of a label, in parts of an axes half a page wide
_CROWDED = 400.0  # of the 1600 points that stand for a text


def label_clear(axes: Axes, points: Sequence[tuple[float, float, str]]) -> None:
    """A text beside each point (x, y, text), on the side with fewest lines, within the axes' present limits.

    A text that would lie on another one is left out.
    """
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    size = np.array([right - left, top - bottom])
    corner = np.array([left, bottom])
    drawn_on = []
    for line in axes.lines:
        xy = (np.column_stack([line.get_xdata(), line.get_ydata()]).astype(float) - corner) / size
        steps = np.linspace(0.0, 1.0, 8)[:, None, None]
        between = xy[:-1] + steps * np.diff(xy, axis=0) if len(xy) > 1 else xy[None]
        drawn_on.append(between.reshape(-1, 2))
    ink = np.vstack(drawn_on) if drawn_on else np.zeros((0, 2))
    for x, y, text in points:
        at = (np.array([x, y]) - corner) / size
        half = 0.5 * np.array([_LETTER * len(text), _HEIGHT])
        boxes = [at + np.array(side) * (half + _GAP) for side in _PLACES]
        cost = [_cost(middle, half, ink) for middle in boxes]
        if min(cost) > _CROWDED:
            continue
        middle = boxes[int(np.argmin(cost))]
        axes.text(
            float(middle[0]),
            float(middle[1]),
            text,
            transform=axes.transAxes,
            ha="center",
            va="center",
            fontsize=7,
        )
        grid = np.linspace(-1.0, 1.0, 40)  # a text over a text is worse than over a line
        ink = np.vstack([ink, middle + half * np.array([(a, b) for a in grid for b in grid])])


def _cost(middle: np.ndarray, half: np.ndarray, ink: np.ndarray) -> float:
    outside = np.maximum(np.abs(middle - 0.5) + half - 0.5, 0.0).sum()
    return float(np.sum(np.all(np.abs(ink - middle) < half, axis=1)) + 1e5 * outside)


def draw_jump(axes: Axes, at: float, start: float, end: float) -> None:
    """An arrow from where a stable branch ends to where the vibration goes."""
    axes.annotate(
        "", (at, end), xytext=(at, start), zorder=4,
        arrowprops={"arrowstyle": "-|>", "linewidth": 0.8, "color": style.GREEN, "mutation_scale": 7.0,
                    "shrinkA": 2.0, "shrinkB": 0.0},
    )  # fmt: skip


def legend_of(counts: Sequence[int], kinds: Sequence[str], *, jumps: bool = False) -> list[Line2D]:
    """Handles for a legend: the stabilities and the kinds of point that a figure shows."""
    shown = sorted({min(count, 2) for count in counts})
    handles = [Line2D([], [], color=COLORS[k], linestyle=LINES[k], label=WORDS[k]) for k in shown]
    handles += [marker_of(kind) for kind in kinds]
    if jumps:
        handles.append(Line2D([], [], color=style.GREEN, marker=r"$\downarrow$", linestyle="", label="jump"))
    return handles


def marker_of(kind: str) -> Line2D:
    """A legend's handle for one kind of special point."""
    return Line2D(
        [], [], linestyle="", color=style.BLACK, markeredgewidth=0.8, label=NAMES[kind], **MARKERS[kind]
    )


def draw_orbit(orbit: Orbit, axes: Axes, x: str, y: str, *, points: int = 400) -> Axes:
    """One cycle in the plane of two states, its line by its stability."""
    path = orbit.at(np.linspace(0.0, orbit.period, points))
    k = min(orbit.unstable, 2)
    i, j = orbit.states.index(x), orbit.states.index(y)
    axes.plot(path[:, i], path[:, j], color=COLORS[k], linestyle=LINES[k], linewidth=1.2 if k == 0 else 0.9)
    return axes


def draw_time(orbit: Orbit, axes: Axes, of: str, *, from_top_of: str, scale: float = 1.0) -> Axes:
    """A state (times `scale`) over one period in parts of it, from where another state is largest."""
    phase = np.linspace(0.0, 1.0, 401)
    path = orbit.at(orbit.period * phase)
    start = phase[np.argmax(path[:, orbit.states.index(from_top_of)])]
    values = orbit.at(orbit.period * (phase + start))[:, orbit.states.index(of)]
    k = min(orbit.unstable, 2)
    axes.plot(phase, scale * values, color=COLORS[k], linestyle=LINES[k], linewidth=1.2 if k == 0 else 0.9)
    return axes
