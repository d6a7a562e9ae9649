"""Damping added to each mode over the coefficient of a damper, with what is wanted and what was chosen."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from rainwind.engineering.damper_curve import DamperCurve
from rainwind.plotting import style

COLORS = (style.BLUE, style.VERMILION, style.GREEN, style.ORANGE, style.BLACK, style.GREY)


def draw(
    curve: DamperCurve,
    axes: Axes,
    *,
    chosen: float | None = None,
    targets: Mapping[int, float] | None = None,
    asymptote: bool = True,
) -> Axes:
    """Ratios in per cent over the coefficient in kNs/m, exact and thick; Krenk's asymptote thin.

    chosen: coefficient in Ns/m, a grey vertical line. targets: mode -> ratio, dotted in the mode's colour; one line
    where all modes have one target.
    """
    over = curve.coefficients / 1e3
    for i, mode in enumerate(curve.modes):
        color = COLORS[i % len(COLORS)]
        style_ = style.LINES[(i // len(COLORS)) % len(style.LINES)]
        axes.plot(over, 100 * curve.ratios[:, i], style_, color=color, label=f"mode {mode}", zorder=3)
        if asymptote:
            axes.plot(over, 100 * curve.asymptote[:, i], color=color, linewidth=0.45, zorder=2)
    if asymptote:
        axes.plot([], [], color=style.GREY, linewidth=0.45, label="asymptote")
    top = 100 * max(curve.ratios.max(), *(targets or {}).values(), 0.0)
    wanted = {mode: 100 * ratio for mode, ratio in (targets or {}).items()}
    if len(set(wanted.values())) == 1:
        axes.axhline(
            next(iter(wanted.values())), color=style.GREY, linestyle=style.DASHED, label="wanted", zorder=1
        )
    else:
        for mode, ratio in wanted.items():
            color = COLORS[curve.modes.index(mode) % len(COLORS)] if mode in curve.modes else style.GREY
            axes.axhline(
                ratio,
                color=color,
                linestyle=style.DASHED,
                linewidth=0.8,
                label=f"wanted, mode {mode}",
                zorder=1,
            )
    if chosen is not None:
        axes.axvline(
            chosen / 1e3,
            color=style.GREY,
            linewidth=1.6,
            alpha=0.55,
            zorder=0.5,
            label=f"chosen: {chosen / 1e3:.3g}",
        )
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_xlim(over[0], over[-1])
    axes.set_ylim(0.0, 1.08 * top if top > 0 else 1.0)
    axes.set_xlabel("damper coefficient $c$ (kNs/m)")
    axes.set_ylabel(r"added damping ratio (%)")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
    axes.set_title(_title(curve), loc="left")
    return axes


def _title(curve: DamperCurve) -> str:
    support = (
        "" if np.isinf(curve.support_stiffness) else f", support {curve.support_stiffness / 1e6:.3g} MN/m"
    )
    return f"stay {curve.cable}, damper at {curve.position:.3g} m{support}"
