"""The range of wind speed over the direction of the wind, as a polar picture with its bands."""

import numpy as np
from matplotlib.axes import Axes

from rainwind.engineering.answers import ModeAnswer
from rainwind.plotting import style

__all__ = ["draw"]

_NAMES = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


def draw(mode: ModeAnswer, axes: Axes, observed: tuple[float, float], highest: float) -> Axes:
    """North up, clockwise, where the wind comes from; the radius is the wind speed in m/s up to `highest`.

    Light: from the low end of the lower bound to the high end of the upper; dark: from middle to middle. observed: two
    circles. axes: polar.
    """
    axes.set_theta_zero_location("N")  # type: ignore[attr-defined]
    axes.set_theta_direction(-1)  # type: ignore[attr-defined]
    width = 2 * np.pi / len(mode.directions)
    for (low, high), color, label in (
        ((mode.speed_low[:, 0], mode.speed_high[:, 2]), "#BFD9EA", "band, at its widest (5 to 95 %)"),
        ((mode.speed_low[:, 1], mode.speed_high[:, 1]), style.BLUE, "middle of the band"),
    ):
        there = np.isfinite(low) & np.isfinite(high)
        axes.bar(
            mode.directions[there], (high - low)[there], width, low[there], color=color, linewidth=0, label=label,
            zorder=2,
        )  # fmt: skip
    round_ = np.linspace(0, 2 * np.pi, 181)
    for k, speed in enumerate(observed):
        label = f"observed: {observed[0]:g} and {observed[1]:g} m/s" if k == 0 else None
        axes.plot(
            round_, np.full_like(round_, speed), color=style.VERMILION, linestyle=style.DASHED, label=label
        )
    axes.set_ylim(0, highest)
    axes.set_xticks(np.arange(8) * np.pi / 4, _NAMES)
    axes.tick_params(axis="x", pad=0.0)
    axes.tick_params(axis="y", labelsize=6.5, labelcolor="#404040")
    axes.set_yticks([speed for speed in (10, 20, 30, 40, 60, 80, 100) if speed <= highest])
    axes.set_rlabel_position(_free(mode))  # type: ignore[attr-defined]
    for label in axes.get_yticklabels():
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.4})
        label.set_zorder(6)
    axes.grid(color="#A8A8A8", linewidth=0.4)
    axes.set_axisbelow(False)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.07), ncols=1, borderaxespad=0.0)
    return axes


def _free(mode: ModeAnswer) -> float:
    """Degrees half way between two names where fewest samples have a range."""
    angles = np.arange(8) * 45.0 + 22.5
    shares = [
        float(mode.share[np.argmin(np.abs(np.angle(np.exp(1j * (mode.directions - a)))))])
        for a in np.radians(angles)
    ]
    return float(angles[int(np.argmin(shares))])
