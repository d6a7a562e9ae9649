"""Maps of what happens in the long run: coloured cells, a colour and a pattern for each kind, and their legend."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from rainwind.plotting import style

# of the numbers in studies/long_time.py, in their order: told apart in grey too
FACES = ("#E3E3E3", "#FFFFFF", "#F6C9A8", style.BLUE, style.VERMILION, style.GREEN, "#9A9A9A", style.BLACK)
HATCHES = (None, None, None, "....", "xxxx", "\\\\\\\\", "////", None)
MISSING = "not computed"
_EDGE = "#606060"


def draw_cells(
    axes: Axes,
    x: np.ndarray,
    y: np.ndarray,
    numbers: np.ndarray,
    *,
    faces: Sequence[str] = FACES,
    hatches: Sequence[str | None] = HATCHES,
) -> Axes:
    """Cells of a grid x (m,), y (k,) coloured by numbers (k, m); those below zero, not computed, have a dot."""
    colours = ListedColormap(list(faces))
    norm = BoundaryNorm(np.arange(len(faces) + 1) - 0.5, len(faces))
    shown = np.ma.masked_less(numbers, 0)
    axes.pcolormesh(x, y, shown, cmap=colours, norm=norm, shading="nearest", rasterized=True, zorder=0.2)
    for number, hatch in enumerate(hatches):
        if hatch and np.any(numbers == number):
            _hatch(axes, x, y, numbers == number, hatch)
    if np.any(numbers < 0):
        rows, columns = np.nonzero(numbers < 0)
        axes.plot(x[columns], y[rows], ".", color=style.GREY, markersize=0.8, zorder=0.3)
    axes.set(xlim=_ends(x), ylim=_ends(y))
    return axes


def handles(
    names: Mapping[int, str], *, faces: Sequence[str] = FACES, hatches: Sequence[str | None] = HATCHES
) -> list[Patch]:
    """A patch for the legend for each number that there is."""
    return [
        Patch(facecolor=faces[k], edgecolor=_EDGE, linewidth=0.4, hatch=hatches[k], label=name)
        for k, name in names.items()
    ]


def draw_amplitudes(axes: Axes, x: np.ndarray, y: np.ndarray, sizes: np.ndarray, label: str) -> Axes:
    """Sizes (k, m) in shades, nan left blank, with their scale beside the axes."""
    mesh = axes.pcolormesh(
        x, y, np.ma.masked_invalid(sizes), cmap="viridis_r", vmin=0.0, shading="nearest", rasterized=True, zorder=0.2
    )  # fmt: skip
    figure = axes.get_figure()
    if figure is not None:
        bar = figure.colorbar(mesh, ax=axes, pad=0.02, fraction=0.06)
        bar.set_label(label)
        bar.outline.set_linewidth(0.5)  # type: ignore[operator]
    axes.set(xlim=_ends(x), ylim=_ends(y))
    return axes


def _hatch(axes: Axes, x: np.ndarray, y: np.ndarray, where: np.ndarray, hatch: str) -> None:
    dx, dy = np.diff(_ends(x))[0] / x.size, np.diff(_ends(y))[0] / y.size
    for i, row in enumerate(where):
        edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(int)))
        for first, last in edges.reshape(-1, 2):
            axes.fill_between(
                [x[first] - dx / 2, x[last - 1] + dx / 2], y[i] - dy / 2, y[i] + dy / 2,
                facecolor="none", edgecolor="white", hatch=hatch, linewidth=0.0, zorder=0.25,
            )  # fmt: skip


def _ends(values: np.ndarray) -> tuple[float, float]:
    """The outer edges of the first and the last cell."""
    if values.size == 1:
        return float(values[0]) - 0.5, float(values[0]) + 0.5
    half = 0.5 * (values[-1] - values[0]) / (values.size - 1)
    return float(values[0] - half), float(values[-1] + half)
