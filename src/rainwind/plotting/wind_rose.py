"""Wind rose: hours a year of each direction, stacked by speed, and those of them in a range of vibration hatched."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from rainwind.engineering.climate import WindRose
from rainwind.errors import InputError
from rainwind.plotting import style

__all__ = ["draw"]

_NAMES = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
_WIDE = 0.94  # of a sector


def draw(
    rose: WindRose,
    axes: Axes,
    *,
    low: np.ndarray | None = None,
    high: np.ndarray | None = None,
    what: str = "range of vibration",
) -> Axes:
    """Bars towards where the wind comes from, north up and clockwise; the slowest wind is in the middle.

    axes: polar ones, `figure.subplots(subplot_kw={"projection": "polar"})`. low, high: (d,) m/s of each direction, nan
    for none: the hours between them are hatched, taken as evenly spread within a bin of speed, and the rim is marked
    in these directions, in which few hours may lie. what: name of that range. Raises InputError.
    """
    if axes.name != "polar":
        raise InputError("a wind rose needs polar axes: subplot_kw={'projection': 'polar'}")
    count = len(rose.directions)
    if (low is None) != (high is None) or (low is not None and np.shape(low) != np.shape(rose.directions)):
        raise InputError(
            f"low and high must both be given, one of each for the {count} directions of the rose"
        )
    axes.set_theta_zero_location("N")  # type: ignore[attr-defined]
    axes.set_theta_direction(-1)  # type: ignore[attr-defined]
    width = _WIDE * 2 * np.pi / count
    inner = np.zeros(count)
    handles = []
    for k, color in enumerate(_blues(rose.edges.size - 1)):
        bars = {"width": width, "bottom": inner, "color": color, "edgecolor": "white", "linewidth": 0.2}
        axes.bar(rose.directions, rose.hours[:, k], **bars, zorder=2)
        handles.append(Patch(facecolor=color, label=_label(rose.edges, k)))
        inner = inner + rose.hours[:, k]
    top = 1.08 * float(inner.max()) or 1.0
    if low is not None and high is not None:
        low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
        there = np.isfinite(low) & np.isfinite(high)
        _hatch(axes, rose, low, high, there, width, what)
        axes.bar(rose.directions[there], 0.025 * top, 2 * np.pi / count, top, color=style.VERMILION, zorder=3)
        handles.append(Patch(facecolor="none", edgecolor=style.VERMILION, hatch="/////", label=what))
        top *= 1.025
    axes.set_ylim(0, top)
    _frame(axes, handles, rose)
    return axes


def _hatch(
    axes: Axes,
    rose: WindRose,
    low: np.ndarray,
    high: np.ndarray,
    there: np.ndarray,
    width: float,
    what: str,
) -> None:
    summed = np.concatenate([np.zeros((len(rose.directions), 1)), np.cumsum(rose.hours, axis=1)], axis=1)
    for d in np.flatnonzero(there):
        first, last = np.interp([low[d], high[d]], rose.edges, summed[d])
        if last > first:
            axes.bar(
                rose.directions[d], last - first, width, first, fill=False, edgecolor=style.VERMILION,
                hatch="//////", linewidth=0.7, zorder=4, label=what,
            )  # fmt: skip


def _frame(axes: Axes, handles: list[Patch], rose: WindRose) -> None:
    axes.set_xticks(np.arange(8) * np.pi / 4, _NAMES)
    axes.tick_params(axis="x", pad=0.0)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 2.5, 5, 10], prune="lower"))
    axes.set_rlabel_position(_quietest(rose))  # type: ignore[attr-defined]
    axes.tick_params(axis="y", labelsize=6.5, labelcolor="#404040")
    for label in axes.get_yticklabels():
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.4})
    axes.grid(color="#C8C8C8", linewidth=0.4)
    axes.set_axisbelow(True)
    axes.set_title("hours a year by direction of the wind", loc="left", pad=9.0)
    if rose.calm > 0:
        slow = f"below {rose.edges[0]:g}" if rose.edges[0] > 0 else "calm"
        handles = [*handles, Patch(facecolor="none", edgecolor="none", label=f"{slow}: {rose.calm:.0f} h")]
    axes.legend(
        handles=handles, title="wind speed (m/s)", title_fontsize=7.0, alignment="left", loc="upper center", ncols=3,
        bbox_to_anchor=(0.5, -0.1), borderaxespad=0.0, handlelength=1.4, handleheight=1.1, columnspacing=1.4,
    )  # fmt: skip


def _quietest(rose: WindRose) -> float:
    """Degrees of the line between two named directions, where the labels of the circles hide the least."""
    angles = np.arange(8) * 45 + 22.5
    away = np.abs((np.degrees(rose.directions)[None] - angles[:, None] + 180) % 360 - 180)
    near = away <= max(12.0, 180 / len(rose.directions))
    return float(angles[np.argmin(np.where(near, rose.hours.sum(axis=1), 0.0).max(axis=1))])


def _label(edges: np.ndarray, k: int) -> str:
    return f"{edges[k]:g} to {edges[k + 1]:g}" if k + 2 < edges.size else f"{edges[k]:g} and more"


def _blues(count: int) -> list[str]:
    """From light to dark, told apart in grey."""
    blue = np.array(to_rgb(style.BLUE))
    tints = [1 - 0.25 * (1 - blue), 0.45 * blue]
    shares = np.linspace(0, 1, count) if count > 1 else [0.5]
    mid = blue
    ends = [(tints[0], mid, 2 * s) if s < 0.5 else (mid, tints[1], 2 * s - 1) for s in shares]
    return [to_hex(tuple((1 - t) * a + t * b)) for a, b, t in ends]
