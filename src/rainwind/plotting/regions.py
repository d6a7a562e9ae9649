"""Planes of wind speed and damping: shaded regions of stability, the fold and Hopf curves."""

import numpy as np
from matplotlib.axes import Axes
from scipy.ndimage import distance_transform_edt

from rainwind.plotting import style


def shade_absent(axes: Axes, low: float, onset: float, bottom: float, top: float) -> None:
    """A region without an upper rivulet, left of the fold or beyond D's end."""
    axes.fill_between([low, onset], bottom, top, color=style.ABSENT, linewidth=0, zorder=0)


def shade_unstable(
    axes: Axes,
    speed: np.ndarray,
    ratio: np.ndarray,
    growth: np.ndarray,
    *,
    hatch: str | None = "////",
    color: str = style.UNSTABLE,
) -> None:
    """The region where `growth` (k, m) is positive, cross-hatched, over speed (m,) and ratio (k,) as drawn."""
    if growth.max() <= 0:
        return
    levels = [0.0, float(growth.max()) * 1.01]
    axes.contourf(speed, ratio, growth, levels=levels, colors=[color], zorder=0.5)
    if hatch:
        over = axes.contourf(speed, ratio, growth, levels=levels, colors="none", hatches=[hatch], zorder=0.6)
        over.set_edgecolor("#B98A66")


def draw_fold(axes: Axes, onset: float, bottom: float, top: float, *, color: str = style.BLACK) -> None:
    """The fold: statics do not depend on damping, so the line is upright."""
    axes.plot([onset, onset], [bottom, top], color=color, linestyle=style.DASH_DOTTED, linewidth=1.0)


def draw_hopf(
    axes: Axes,
    speed: np.ndarray,
    ratio: np.ndarray,
    *,
    on_d: bool,
    limit: bool = True,
    color: str = style.BLACK,
) -> None:
    """A piece of a Hopf curve: on D solid where it limits stability, else thin; on other equilibria dotted."""
    line, width = ("-", 1.2 if limit else 0.7) if on_d else (style.DOTTED, 0.9)
    axes.plot(speed, ratio, color=color if on_d else style.GREY, linestyle=line, linewidth=width)


def roomiest(
    x: np.ndarray, y: np.ndarray, inside: np.ndarray, *, shape: float = 2.2, least: float = 0.02
) -> tuple[float, float] | None:
    """The place (x, y) deepest inside a region (len(y), len(x)), for a text `shape` times as tight across as upward.

    y is evenly spaced as drawn, x need not be. None where the region fills less than the part `least`.
    """
    even = np.linspace(x[0], x[-1], x.size)
    inside = inside[:, np.abs(x[None, :] - even[:, None]).argmin(axis=1)]
    if inside.mean() < least:
        return None
    sampling = (shape / inside.shape[0], 1.0 / inside.shape[1])
    depth = np.asarray(distance_transform_edt(np.pad(inside, 1), sampling=sampling))[1:-1, 1:-1]
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return float(even[j]), float(y[i])
