"""A diagram of everything in one parameter: equilibria black, orbits blue, stable solid, unstable dashed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from rainwind.dynamics.diagram_results import Diagram
from rainwind.dynamics.orbit_results import OrbitBranch, OrbitPoint
from rainwind.dynamics.results import Ended, SpecialPoint
from rainwind.plotting import style
from rainwind.plotting.branches import MARKERS, NAMES

ORBIT_MARKERS: Mapping[str, Mapping[str, Any]] = {
    "lpc": {"marker": "s", "markerfacecolor": style.BLUE},
    "pd": {"marker": "^", "markerfacecolor": style.VERMILION},
    "ns": {"marker": "D", "markerfacecolor": "white"},
    "bp": {"marker": "x"},
}
ORBIT_NAMES = {
    "lpc": "LPC, fold of orbits", "pd": "PD, period doubling", "ns": "NS, Neimark–Sacker point",
    "bp": "branch point of orbits",
}  # fmt: skip
_EQUILIBRIUM_NAMES = {**NAMES, "hopf": "Hopf point"}
_SHORT = {"fold": "fold", "hopf": "Hopf", "bp": "BP"}
_STOPPED = "stopped by the user before its end: branches are missing"
_VIBRATES = "#DCEBF5"
_BESIDE = (  # places of a name: offset in parts of the axes from the mark to the text's lower edge, its alignment
    (0.0, 0.035, "center"), (-0.01, 0.0, "right"), (0.01, 0.0, "left"), (-0.01, -0.08, "right"),
    (0.01, -0.08, "left"), (0.0, -0.12, "center"), (-0.01, 0.05, "right"), (0.01, 0.05, "left"),
    (0.0, 0.12, "center"),
)  # fmt: skip
_ALIGNED = {"center": 0.5, "right": 1.0, "left": 0.0}
_WORST = 15.0  # a place that costs more is none
_CROWD = 14  # labelled points: of more, only those on branches born at Hopf points are named


@dataclass(frozen=True)
class Panel:
    """One state as an axis: amplitude (half peak-to-peak of orbits, equilibria at zero) or its extreme values."""

    of: str
    label: str
    scale: float = 1.0
    amplitude: bool = False


def draw_diagram(
    diagram: Diagram, axes: Axes, panel: Panel, *, scale: float = 1.0, named: Sequence[SpecialPoint] = ()
) -> Axes:
    """One panel of a diagram; scale: of the parameter; named: points that carry name and value, where there is room."""
    along = diagram.along
    for low, high in vibrating(diagram):
        axes.axvspan(scale * low, scale * high, color=_VIBRATES, linewidth=0, zorder=0)
    if panel.amplitude:
        _draw_rest(diagram, axes, scale)
    else:
        for branch in diagram.equilibria:
            for unstable, (x, y) in diagram.pieces(branch, along, panel.of):
                _line(axes, scale * x, panel.scale * y, style.BLACK, unstable)
    for orbits in diagram.orbits:
        names = (panel.of,) if panel.amplitude else (f"max {panel.of}", f"min {panel.of}")
        for unstable, (x, *columns) in diagram.pieces(orbits, along, *names):
            for y in columns:
                _line(axes, scale * x, panel.scale * y, color_of(orbits), unstable)
    axes.set_xlim(scale * diagram.until[0], scale * diagram.until[1])
    axes.margins(y=0.12)
    places = []
    for point in diagram.points():
        for y in _heights(point, panel):
            _mark(axes, point, scale * point.parameter, panel.scale * y)
            places.append((point, scale * point.parameter, panel.scale * y))
    _name(axes, places, named)
    return axes


def draw_panels(
    diagram: Diagram,
    figure: Figure,
    panels: Sequence[Panel],
    *,
    label: str = "",
    scale: float = 1.0,
    noun: str = "orbit",
    note: str = "",
) -> Figure:
    """All panels one above the other under one legend; label, scale: of the parameter; noun: what an orbit is here;
    note: below all. A diagram that was interrupted says so above the first panel."""
    with style.journal(figure, width="double", height=32.0 + 46.0 * len(panels)):
        column = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        points, done = _worth_naming(diagram), []
        for axes, panel, letter in zip(column, panels, "abcdefgh", strict=False):
            named = [p for p in points if p not in done and _heights(p, panel)]
            draw_diagram(diagram, axes, panel, scale=scale, named=named)
            done += named
            axes.set_ylabel(panel.label)
            style.panel(axes, letter)
        column[-1].set_xlabel(label or diagram.along)
        handles = legend_of(diagram, noun=noun)
        figure.legend(handles=handles, loc="outside upper center", ncols=min(4, len(handles)))
        if diagram.interrupted:
            column[0].set_title(_STOPPED, loc="right", color=style.VERMILION, pad=4.0)
        style.below(figure, [note] if note else [], letters=140)
    return figure


def legend_of(diagram: Diagram, *, noun: str = "orbit") -> list[Any]:
    """What is to be explained: only what the diagram has."""
    handles: list[Any] = []
    for branches, color, name in (
        (diagram.equilibria, style.BLACK, "equilibrium"),
        ([b for b in diagram.orbits if not _doubled(b)], style.BLUE, noun),
        ([b for b in diagram.orbits if _doubled(b)], style.VERMILION, f"{noun} of period 2, 4, ..."),
    ):
        counts = [count for branch in branches for count, _ in diagram.pieces(branch, diagram.along)]
        for stable in (True, False):
            if any((count == 0) is stable for count in counts):
                words = f"{name}, {'stable' if stable else 'unstable'}"
                handles.append(
                    Line2D([], [], color=color, linestyle="-" if stable else style.DASHED, label=words)
                )
    if vibrating(diagram):
        handles.append(Patch(facecolor=_VIBRATES, label=f"a stable {noun} exists"))
    kinds = {(point.kind, isinstance(point, OrbitPoint)): point for point in diagram.points()}
    for (kind, of_orbit), point in sorted(kinds.items(), key=lambda item: item[0][1]):
        name = str((ORBIT_NAMES if of_orbit else _EQUILIBRIUM_NAMES).get(kind, kind)).replace("orbit", noun)
        handles.append(Line2D([], [], linestyle="", **_look(point), label=name))
    return handles


def vibrating(diagram: Diagram) -> list[tuple[float, float]]:
    """Ranges of the parameter over which some orbit is stable."""
    found: list[tuple[float, float]] = []
    for piece in diagram.stable_ranges():
        if piece.orbits:
            low = found.pop()[0] if found and found[-1][1] == piece.low else piece.low
            found.append((low, piece.high))
    return found


def color_of(branch: OrbitBranch) -> str:
    """Blue for orbits born at Hopf points, vermilion for those that branched off at period doublings."""
    return style.VERMILION if _doubled(branch) else style.BLUE


def _doubled(branch: OrbitBranch) -> bool:
    return branch.ended[0] is Ended.REVISITED


def _draw_rest(diagram: Diagram, axes: Axes, scale: float) -> None:
    """Rest is amplitude zero: solid where some equilibrium is stable."""
    edges = [(piece.low, piece.high, bool(piece.equilibria)) for piece in diagram.stable_ranges()]
    for low, high, stable in edges:
        x = scale * np.array([low, high])
        # drawn a little thicker: the frame runs just below
        axes.plot(
            x, [0, 0], color=style.BLACK, linestyle="-" if stable else style.DASHED, linewidth=1.2, zorder=2
        )


def _line(axes: Axes, x: np.ndarray, y: np.ndarray, color: str, unstable: int) -> None:
    axes.plot(
        x, y, color=color, linestyle=style.DASHED if unstable else "-", linewidth=0.8 if unstable else 1.3,
        zorder=2 if unstable else 3,
    )  # fmt: skip


def _heights(point: SpecialPoint, panel: Panel) -> list[float]:
    """Where a point is marked: one height, or both extremes of an orbit; no fold of equilibria among amplitudes."""
    k = point.states.index(panel.of)
    if isinstance(point, OrbitPoint):
        low, high = point.orbit.extremes[:, k].tolist()
        return [0.5 * (high - low)] if panel.amplitude else [high, low]
    if panel.amplitude:
        return [0.0] if point.kind == "hopf" else []
    return [float(point.state[k])]


def _look(point: SpecialPoint) -> dict[str, Any]:
    if isinstance(point, OrbitPoint):
        look, color = ORBIT_MARKERS.get(point.kind, {"marker": "*"}), style.BLUE
        color = style.VERMILION if point.kind == "pd" else color
    else:
        look, color = MARKERS.get(point.kind, {"marker": "*"}), style.BLACK
    return {"color": color, "markeredgewidth": 0.8, **look}


def _mark(axes: Axes, point: SpecialPoint, x: float, y: float) -> None:
    axes.plot([x], [y], linestyle="", zorder=5, clip_on=False, **_look(point))


def _worth_naming(diagram: Diagram) -> list[SpecialPoint]:
    """All points, or where they are many those on branches that begin at a Hopf point."""
    points = list(diagram.points())
    if len(points) <= _CROWD:
        return points
    side = [p for b in diagram.orbits if b.ended[0] is not Ended.AT_HOPF for p in b.special]
    return [point for point in points if point not in side]


def _name(
    axes: Axes, places: Sequence[tuple[SpecialPoint, float, float]], named: Sequence[SpecialPoint]
) -> None:
    """Name and value beside each point where there is room: off other names and marks, off curves if possible."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    size, origin = np.array([right - left, top - bottom]), np.array([left, bottom])
    marks = (np.array([(x, y) for _, x, y in places]).reshape(-1, 2) - origin) / size
    ink = (_ink(axes) - origin) / size
    taken: list[np.ndarray] = []
    for (point, x, _), at in zip(places, marks, strict=True):
        if point not in named:
            continue
        named = [other for other in named if other is not point]  # once, not at both extremes
        words = f"{_short(point)} {x:.{decimals(right - left)}f}"
        width, height = 0.0105 * len(words), 0.09
        best: tuple[float, Any] = (_WORST, None)
        for k, (du, dv, side) in enumerate(_BESIDE):
            low = at + np.array([du - _ALIGNED[side] * width, dv])
            box = np.array([low, low + np.array([width, height])])
            others = np.all(marks == at, axis=1) == 0
            if box.min() < 0.005 or box.max() > 0.995 or any(_overlap(box, other) for other in taken):
                continue
            # nearer to its own mark than to another one
            reach = np.linalg.norm((marks - np.clip(marks, *box)) * [1.0, 0.3], axis=1)
            unclear = bool(np.any(reach[others] < reach[~others].min() + 0.004)) if others.any() else False
            cost = k + 1.5 * min(_within(ink, box), 6) + 12.0 * unclear
            if cost < best[0]:
                best = (cost, (box, du, dv, side))
        if best[1] is not None:
            box, du, dv, side = best[1]
            taken.append(box)
            axes.text(
                at[0] + du, at[1] + dv, words, transform=axes.transAxes, ha=side, va="bottom", fontsize=6.5
            )


def _short(point: SpecialPoint) -> str:
    return point.kind.upper() if isinstance(point, OrbitPoint) else _SHORT.get(point.kind, point.kind)


def _ink(axes: Axes) -> np.ndarray:
    """Points on all curves of the axes, close to each other (N, 2)."""
    found = [np.zeros((0, 2))]
    for line in axes.lines:
        xy = np.asarray(line.get_xydata(), dtype=float)
        if len(xy) > 1:
            t = np.arange(len(xy))
            dense = np.linspace(0, len(xy) - 1, 400)
            found.append(np.column_stack([np.interp(dense, t, column) for column in xy.T]))
    return np.vstack(found)


def _within(points: np.ndarray, box: np.ndarray) -> int:
    return int(np.sum(np.all((points > box[0]) & (points < box[1]), axis=1)))


def decimals(span: float) -> int:
    """Decimals that show a thousandth of a range."""
    return max(0, int(np.ceil(2.5 - np.log10(span)))) if span > 0 else 3


def _overlap(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(np.all(a[0] < b[1]) and np.all(b[0] < a[1]))
