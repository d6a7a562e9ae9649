"""Curves of bifurcations of cycles in a plane, what is stable between them, and their special points."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from rainwind.plotting import branches, style

LINES = {"lpc": "-", "ns": style.DASHED, "pd": style.DOTTED}
COLORS = {"lpc": style.BLUE, "ns": style.VERMILION, "pd": style.GREEN}
WORDS = {"lpc": "fold of cycles (LPC)", "ns": "Neimark–Sacker (NS)", "pd": "period doubling (PD)"}
STABLE_CYCLES = (style.UNSTABLE, "#E8925C")  # one, two and more
MARKERS: dict[str, dict[str, Any]] = {
    "zh": dict(branches.MARKERS["zh"]),
    "hh": dict(branches.MARKERS["hh"]),
    "gh": dict(branches.MARKERS["gh"]),
    "cpc": {"marker": "*", "markersize": 4.6},
    "ch": {"marker": "o", "markersize": 2.4},
    "r1": {"marker": "h", "markerfacecolor": "white", "markersize": 4.2},
    "gpd": {"marker": "v", "markersize": 3.0},
    "r2": {"marker": "8", "markersize": 3.4},
    "r3": {"marker": ">", "markersize": 3.4},
    "r4": {"marker": "s", "markersize": 3.0},
    "foldflip": {"marker": "<", "markersize": 3.4},
    "lpns": {"marker": "X", "markersize": 3.8},
    "pdns": {"marker": "P", "markersize": 3.8},
    "nsns": {"marker": "d", "markersize": 3.8},
}
NAMES = {
    "zh": "fold–Hopf", "hh": "Hopf–Hopf", "gh": "generalised Hopf", "cpc": "cusp of cycles",
    "ch": "Chenciner", "r1": "resonance 1:1", "gpd": "generalised doubling", "r2": "resonance 1:2",
    "r3": "resonance 1:3", "r4": "resonance 1:4", "foldflip": "fold–flip", "lpns": "fold–NS",
    "pdns": "doubling–NS", "nsns": "double NS",
}  # fmt: skip
NOTHING = "#FBE9DC"  # D unstable and no cycle stable, hatched
_WIDTHS = (0.6, 1.3)


def shade_counts(axes: Axes, speed: np.ndarray, ratio: np.ndarray, count: np.ndarray) -> None:
    """Where one cycle is stable and where several are, over speed (m,) and ratio (k,) as drawn; count (k, m)."""
    for least, color in enumerate(STABLE_CYCLES, 1):
        if count.max() >= least:
            axes.contourf(
                speed, ratio, (count >= least).astype(float), levels=[0.5, 1.5], colors=[color], zorder=0.65
            )


def draw_curve(
    axes: Axes, kind: str, speed: np.ndarray, ratio: np.ndarray, *, limit: bool, soft: bool = False
) -> None:
    """A piece of a curve of one kind: thick where cycles gain or lose stability on it, thin elsewhere.

    soft: an ns curve on which stable tori are born.
    """
    axes.plot(
        speed, ratio, color=COLORS[kind], linestyle="-" if soft else LINES[kind], linewidth=_WIDTHS[limit],
        zorder=2.5 if limit else 2.0,
    )  # fmt: skip


def mark_points(axes: Axes, points: Iterable[tuple[str, float, float]]) -> None:
    """Special points (kind, speed, ratio) inside the window of the axes."""
    (low, high), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    for kind, x, y in points:
        if low <= x <= high and bottom <= y <= top:
            axes.plot([x], [y], zorder=5, clip_on=False, **_look(kind))


def _look(kind: str) -> dict[str, Any]:
    return {"linestyle": "", "color": style.BLACK, "markeredgewidth": 0.8, **MARKERS[kind]}


def legend_handles(
    kinds: Sequence[str], points: Sequence[str], counts: Sequence[int]
) -> list[Line2D | Patch]:
    """Handles for the curves, the regions and the special points that a figure shows."""
    handles: list[Line2D | Patch] = [
        Line2D([], [], color=style.BLACK, linewidth=1.2, label="Hopf on D"),
        *(
            Line2D([], [], color=COLORS[kind], linestyle=LINES[kind], linewidth=1.3, label=WORDS[kind])
            for kind in kinds
        ),
    ]
    if "ns" in kinds:
        handles.insert(
            -1 if "pd" in kinds else len(handles),
            Line2D([], [], color=COLORS["ns"], linewidth=1.3, label="NS, tori suspected beside"),
        )
    words = ("one stable cycle", "two or more")
    handles += [Patch(facecolor=STABLE_CYCLES[k - 1], label=words[k - 1]) for k in counts]
    handles.append(
        Patch(facecolor=NOTHING, edgecolor="#B98A66", hatch="////", linewidth=0.0, label="D unstable, no stable cycle")
    )  # fmt: skip
    handles.append(
        Line2D([], [], color=style.GREY, linewidth=_WIDTHS[0], label="thin: cycles unstable anyway")
    )
    return [*handles, *(Line2D([], [], label=NAMES[kind], **_look(kind)) for kind in points)]
