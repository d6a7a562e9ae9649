"""Branches of equilibria and Hopf curves as lines: stable solid, unstable dashed, special points marked."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes

from rainwind.dynamics.results import Branch
from rainwind.plotting import style

MARKERS: Mapping[str, Mapping[str, Any]] = {
    "fold": {"marker": "s", "markerfacecolor": "white"},
    "hopf": {"marker": "o", "markerfacecolor": "white"},
    "bp": {"marker": "x"},
    "zh": {"marker": "D", "markerfacecolor": "white"},
    "hh": {"marker": "^", "markerfacecolor": "white"},
    "gh": {"marker": "v", "markerfacecolor": "white"},
    "bt": {"marker": "p", "markerfacecolor": "white"},
    "cusp": {"marker": "*"},
}
NAMES = {
    "fold": "fold", "hopf": "Hopf", "bp": "branch point", "zh": "fold–Hopf", "hh": "Hopf–Hopf",
    "gh": "generalised Hopf", "bt": "Bogdanov–Takens", "cusp": "cusp",
}  # fmt: skip


def draw_branch(
    branch: Branch,
    axes: Axes,
    of: str = "phi",
    *,
    against: str | None = None,
    scale: float = 1.0,
    color: str = style.BLACK,
) -> Axes:
    """A state (times `scale`) against a parameter: stable parts solid, unstable dashed, special points marked."""
    against = against or branch.along[0]
    for unstable, (x, y) in branch.pieces(against, of):
        axes.plot(x, scale * y, color=color, linestyle=style.DASHED if unstable else "-", linewidth=1.0)
    for point in branch.points():
        mark(axes, point.kind, point[against], scale * point[of], color=color)
    return axes


def label_points(
    axes: Axes,
    points: Sequence[tuple[float, float, str]],
    *,
    offset: float,
    pattern: str = "{}",
    side: str = "center",
    gap: float = 0.3,
) -> None:
    """One label at a point, or at several closer than `gap` of the width: `pattern` with their values (x, y, value).

    offset: in points above, or (negative) below. side: left, center or right of the text stands at the point; near
    an edge of the axes the text goes inward.
    """
    low, high = axes.get_xlim()
    groups: list[list[tuple[float, float, str]]] = []
    for point in sorted(points):
        if groups and point[0] - groups[-1][-1][0] < gap * (high - low):
            groups[-1].append(point)
        else:
            groups.append([point])
    for group in groups:
        x, y, _ = group[len(group) // 2]
        part = (x - low) / (high - low)
        align = "right" if part > 0.75 else "left" if part < 0.15 and side == "center" else side
        shift = {"left": 3, "right": -3}.get(align, 0) if side != "center" else 0
        axes.annotate(
            pattern.format(", ".join(value for _, _, value in group)), (x, y), xytext=(shift, offset),
            textcoords="offset points", ha=align, va="bottom" if offset > 0 else "top", fontsize=7,
        )  # fmt: skip


def mark(axes: Axes, kind: str, x: float, y: float, *, color: str = style.BLACK) -> None:
    """One special point."""
    axes.plot(
        [x], [y], linestyle="", color=color, markeredgewidth=0.8, zorder=5, clip_on=False, **MARKERS[kind]
    )
