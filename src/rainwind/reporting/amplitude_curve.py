"""The amplitude of a mode over the wind speed, with its band."""

import numpy as np
from matplotlib.axes import Axes

from rainwind.engineering.answers import ModeAnswer
from rainwind.plotting import style

__all__ = ["draw"]


def draw(mode: ModeAnswer, axes: Axes, observed: tuple[float, float], accepted: float | None = None) -> Axes:
    """Half peak to peak in m over the wind speed at the reference height: band and middle; without dampers dashed.

    observed: the speeds at which rivulets have been seen, shaded. accepted: amplitude in m, a line.
    """
    axes.axvspan(*observed, color=style.ABSENT, linewidth=0, zorder=0, label="rivulets observed")
    undamped = mode.amplitudes_undamped
    if undamped is not None:
        _band(axes, mode.speeds, undamped, style.VERMILION, "#F3D6C2", style.DASHED, ", without dampers")
    _band(axes, mode.speeds, mode.amplitudes, style.BLUE, "#9CC4DF", "-", "")
    if accepted is not None:
        axes.axhline(
            accepted, color=style.BLACK, linestyle=style.DOTTED, linewidth=0.9, label="accepted", zorder=3
        )
    axes.set_ylim(0, None)
    low, high = min(observed[0], mode.speeds.min()), max(observed[1], mode.speeds.max())
    axes.set_xlim(low - 0.5, high + 0.5)
    axes.set_xlabel("wind speed at the reference height (m/s)")
    axes.set_ylabel("amplitude (m)")
    return axes


def _band(
    axes: Axes, speeds: np.ndarray, values: np.ndarray, color: str, light: str, dashes: object, of: str
) -> None:
    low, middle, high = values.T
    axes.fill_between(speeds, low, high, color=light, linewidth=0, zorder=1, label=f"5 to 95 %{of}")
    axes.plot(speeds, middle, color=color, linestyle=dashes, zorder=2, label=f"middle{of}")  # type: ignore[arg-type]
