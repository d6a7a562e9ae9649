"""Stays and rigs on which rain-wind vibrations were observed: what the assessment says beside what was seen.

docs/validation.md has the picture, the tables and what follows from them.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from rainwind.engineering.answers import Band, ModeAnswer
from rainwind.plotting import style
from rainwind.studies.field_comparison import TOP, Comparison, Result, compute
from rainwind.studies.field_tables import markdown, tables

__all__ = ["Comparison", "Result", "compute", "draw", "markdown", "summary", "tables"]

PERCENT = 100.0
_SEEN, _MODEL = style.VERMILION, style.BLUE


def draw(result: Result, figure: Figure) -> Figure:
    """Wind speeds and amplitudes: of each case what was seen, below it the model's bands mode by mode."""
    with style.journal(figure, width="double", height=130):
        speeds, amplitudes = figure.subplots(1, 2, sharey=True, width_ratios=(1.35, 1.0))
        places: list[tuple[float, str]] = []
        at = 0.0
        for number, one in enumerate(result.cases):
            top = at - 0.5
            places.append((at, f"{one.case.name}"))
            _seen(one, speeds, amplitudes, at)
            for mode in one.modes:
                at += 0.8
                places.append((at, f"mode {mode.number}"))
                _model(one, mode, speeds, amplitudes, at)
            if number % 2:
                for axes in (speeds, amplitudes):
                    axes.axhspan(top, at + 0.55, color=style.ABSENT, linewidth=0, zorder=0)
            at += 1.1
        _finish(figure, speeds, amplitudes, places, at)
    return figure


def _seen(one: Comparison, speeds: Axes, amplitudes: Axes, at: float) -> None:
    low, high = one.case.speeds
    speeds.plot([low, high], [at, at], color=_SEEN, linewidth=4.0, solid_capstyle="butt")
    if one.case.amplitude is not None:
        d = one.case.cable.diameter
        least, most = (value / d for value in one.case.amplitude)
        if least < most:
            amplitudes.plot([least, most], [at, at], color=_SEEN, linewidth=4.0, solid_capstyle="butt")
        else:
            amplitudes.plot([most], [at], color=_SEEN, marker="D", markersize=4.5, linestyle="none")


def _model(one: Comparison, mode: ModeAnswer, speeds: Axes, amplitudes: Axes, at: float) -> None:
    seen = one.case.mode in (None, mode.number)
    color = _MODEL if seen else style.GREY
    begin, end = mode.range_low, mode.range_high
    # thin: unstable in the middle of the band; thick: where that may begin
    speeds.plot([begin.middle, end.middle], [at, at], color=color, linewidth=0.8)
    if end.middle > TOP - 1e-6:
        speeds.plot([TOP], [at], color=color, marker=">", markersize=3.6, clip_on=False)
    elif np.isfinite(end.middle):
        speeds.plot([end.middle], [at], color=color, marker="|", markersize=5.0)
    _band(speeds, begin, at, color)
    _band(amplitudes, one.amplitude(mode), at, color)


def _band(axes: Axes, band: Band, at: float, color: str) -> None:
    axes.plot([band.low, band.high], [at, at], color=color, linewidth=3.0, solid_capstyle="butt", alpha=0.55)
    axes.plot([band.middle], [at], color=style.BLACK, marker="|", markersize=6.5, markeredgewidth=1.3)


def _finish(
    figure: Figure, speeds: Axes, amplitudes: Axes, places: list[tuple[float, str]], end: float
) -> None:
    style.panel(speeds, "a", "where vibrations begin, and go on to")
    style.panel(amplitudes, "b", "how large, at the speeds observed")
    speeds.set(xlim=(0.0, TOP), ylim=(end - 0.4, -0.8), xlabel=style.UNDISTURBED)
    amplitudes.set(xlabel="amplitude, half peak to peak (diameters)")
    amplitudes.set_xlim(left=-0.1)
    speeds.set_yticks([place for place, _ in places], [name for _, name in places])
    for label, (_, name) in zip(speeds.get_yticklabels(), places, strict=True):
        label.set_fontsize(6.6 if name.startswith("mode") else 7.5)
    for axes in (speeds, amplitudes):
        axes.tick_params(axis="y", length=0.0)
    thick: dict[str, Any] = {"linewidth": 3.0, "alpha": 0.55}
    handles = [
        Line2D([], [], color=_SEEN, linewidth=4.0, label="observed"),
        Line2D([], [], color=_MODEL, label="model, 5 to 95 %: begin (a), amplitude (b)", **thick),
        Line2D([], [], color=style.GREY, label="the same, a mode not observed", **thick),
        Line2D([], [], color=style.BLACK, marker="|", markersize=6.5, markeredgewidth=1.3, linestyle="none",
               label="middle of the model's band"),
        Line2D([], [], color=_MODEL, linewidth=0.8, marker=">", markersize=3.6,
               label=f"to the middle of its end (arrow: > {TOP:.0f} m/s)"),
    ]  # fmt: skip
    figure.legend(handles=handles, loc="outside upper left", ncols=3, columnspacing=1.6)


def summary(result: Result) -> list[str]:
    """A sentence for each case: onset beside observation, and the damping needed beside the rule."""
    return [_sentence(one) for one in result.cases]


def _sentence(one: Comparison) -> str:
    case, first = one.case, one.modes[0]
    low, high = case.speeds
    need, rule = first.damping_needed_observed.middle, first.rule_damping
    return (
        f"{case.name}: vibrations were observed at {low:g} to {high:g} m/s; in mode 1 the model's begin at "
        f"{first.range_low.middle:.1f} m/s ({first.range_low.low:.1f} to {first.range_low.high:.1f}), and in "
        f"{PERCENT * first.unlimited:.0f} % of the samples they do not end below {TOP:g} m/s. Damping needed at the "
        f"observed speeds: {PERCENT * need:.2f} %, PTI's rule: {PERCENT * rule:.2f} %."
    )
