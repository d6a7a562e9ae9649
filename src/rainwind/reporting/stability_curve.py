"""Stability diagram of a mode: the damping below which small vibrations grow, over the wind speed."""

from matplotlib.axes import Axes

from rainwind.engineering.answers import ModeAnswer
from rainwind.plotting import style

__all__ = ["draw"]


def draw(mode: ModeAnswer, axes: Axes, observed: tuple[float, float]) -> Axes:
    """Damping in per cent of critical over the wind speed at the reference height, in the worst direction.

    Below the middle of the band half of the samples are unstable. Lines: the damping there is, without dampers where
    there are some, and that by the PTI rule. observed: the speeds at which rivulets have been seen, shaded.
    """
    speeds, needed = mode.stability_speeds, mode.stability_needed
    axes.axvspan(*observed, color=style.ABSENT, linewidth=0, zorder=0, label="rivulets observed")
    if speeds is not None and needed is not None:
        low, middle, high = 100.0 * needed.T
        axes.fill_between(
            speeds, low, high, color="#F3D6C2", linewidth=0, zorder=1, label="needed, 5 to 95 %"
        )
        axes.plot(speeds, middle, color=style.VERMILION, zorder=2, label="needed, middle")
        axes.set_xlim(speeds[0], speeds[-1])
    axes.axhline(
        100.0 * mode.damping_total, color=style.BLACK, linewidth=1.0, label="damping there is", zorder=3
    )
    if mode.damping_total > mode.damping_own:
        axes.axhline(
            100.0 * mode.damping_own, color=style.BLACK, linestyle=style.DASHED, linewidth=0.8,
            label="damping without dampers", zorder=3,
        )  # fmt: skip
    axes.axhline(
        100.0 * mode.rule_damping,
        color=style.BLUE,
        linestyle=style.DOTTED,
        linewidth=1.0,
        label="PTI rule",
        zorder=3,
    )
    axes.set_ylim(0.0, None)
    axes.set_xlabel("wind speed at the reference height (m/s)")
    axes.set_ylabel("damping ratio (%)")
    return axes
