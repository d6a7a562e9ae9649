"""Figure 9 (section 5): stability of the equilibrium D over wind speed and damping of the cable.

Three regions: no equilibrium D (left of the fold), D stable, D unstable. The linear curves only: the fold and the Hopf
curve on D; the paper's curves of limit cycles are not computed here. Our reading: the sample case is the line at 0.2 %,
the axis the undisturbed wind speed. Tests pin the fold (8 m/s, T2), the critical damping (0.7 %, T8) and AUTO-07p's
fold-Hopf and Hopf-Hopf points. At the fold-Hopf point the Hopf curve passes from D to C: below it, D is unstable from
the fold on.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.branches import mark
from rainwind.plotting.regions import draw_fold, draw_hopf, roomiest, shade_absent, shade_unstable
from rainwind.studies import paper
from rainwind.studies.branch_tables import diagram_tables
from rainwind.studies.stability_diagram import DAMPING_ALIKE, StabilityDiagram, sentences, stability_diagram

PERCENT = 100.0


@dataclass(frozen=True, eq=False)
class Result:
    """The diagram, and the damping ratio of the model it was computed for; None if y and z have each their own."""

    diagram: StabilityDiagram
    sample_ratio: float | None


def compute(
    model: RivuletModel | None = None,
    *,
    speeds: tuple[float, float] | None = None,
    ratios: tuple[float, float] | None = None,
) -> Result:
    """The diagram in a window of speeds (m/s) and damping ratios, by default around the model's onset."""
    model = model or paper.model()
    sample = model.section.damping_ratio
    window = ratios or (0.0, max(paper.RATIOS[1], 1.25 * sample))
    diagram = stability_diagram(model, speeds, window, grow=ratios is None)
    return Result(diagram, diagram.own_ratio)


def draw(result: Result, figure: Figure) -> Figure:
    """Regions shaded and named, damping in per cent."""
    diagram = result.diagram
    (low, high), (bottom, top) = diagram.speeds, (PERCENT * r for r in diagram.ratios)
    with style.journal(figure, width="single", height=76):
        axes = figure.add_subplot()
        axes.set(xlim=(low, high), ylim=(bottom, top), xlabel=style.UNDISTURBED)
        axes.set_ylabel(style.DAMPING if result.sample_ratio is not None else DAMPING_ALIKE)
        style.below(figure, diagram.notes)
        onset = diagram.onset
        if diagram.equilibria["D"] is None:
            shade_absent(axes, low, high, bottom, top)
            style.note(axes, "no equilibrium D\nin this window", color=style.BLACK)
            return figure
        if diagram.field is not None:
            shade_unstable(axes, diagram.field.speed, PERCENT * diagram.field.ratio, diagram.field.growth)
        if diagram.reach is not None:
            shade_absent(axes, low, diagram.reach[0], bottom, top)
        if diagram.reach is not None and not diagram.reaches_end:
            shade_absent(axes, diagram.reach[1], high, bottom, top)
        if onset is not None:
            draw_fold(axes, onset, bottom, top)
        for piece in diagram.pieces:
            if piece.letter not in ("C", "D"):
                continue
            draw_hopf(
                axes, piece.speed, PERCENT * piece.ratio, on_d=piece.letter == "D", limit=piece.others == 0
            )
        for point in diagram.points:
            if point.kind in ("zh", "hh"):
                mark(axes, point.kind, point.parameter, PERCENT * point.parameters["section.damping_ratio"])
        _name(result, axes)
    return figure


def _name(result: Result, axes: Axes) -> None:
    diagram = result.diagram
    low, high = diagram.speeds
    top = PERCENT * diagram.ratios[1]
    onset = diagram.onset if diagram.onset is not None else low
    small: dict[str, Any] = {"fontsize": 7.0}
    room = onset > low + 0.13 * (high - low)
    if room:
        axes.text(0.5 * (low + onset), 0.55 * top, "no\nequilibrium\nD", ha="center", va="center")
    if onset > low:
        shift = (-0.012 if room else 0.012) * (high - low)
        axes.text(
            onset + shift,
            0.97 * top,
            f"fold\n{onset:.2f} m/s",
            ha="right" if room else "left",
            va="top",
            **small,
        )
    beyond = diagram.reach[1] if diagram.reach else high
    if beyond < high - 0.05 * (high - low):
        axes.text(0.5 * (beyond + high), 0.55 * top, diagram.why_it_ends, ha="center", va="center")
    field = diagram.field
    if field is None or not (field.count > 0).any():
        axes.text(0.5 * (onset + beyond), 0.5 * top, "D stable at every damping", ha="center", va="center")
        return
    box: dict[str, Any] = {"facecolor": style.UNSTABLE, "edgecolor": "none", "pad": 1.5}
    free = _free(result)
    unstable = roomiest(field.speed, field.ratio, free & (field.count > 0), shape=1.0, least=0.04)
    stable = roomiest(field.speed, field.ratio, free & (field.count == 0), shape=1.0, least=0.04)
    if unstable is not None:
        axes.text(
            unstable[0], PERCENT * unstable[1], "D unstable", ha="center", va="center", bbox=box, zorder=0.7
        )
    if stable is not None:
        axes.text(stable[0], PERCENT * stable[1], "D stable", ha="center", va="center")
    if diagram.critical is not None and diagram.critical[1] < 0.95 * diagram.ratios[1]:
        speed, ratio = diagram.critical
        what = "critical damping" if unstable is not None else "D unstable below"
        right = speed < low + 0.6 * (high - low)
        axes.annotate(
            f"{what} {PERCENT * ratio:.2f} %", (speed, PERCENT * ratio), xytext=(10 if right else -6, 5),
            textcoords="offset points", ha="left" if right else "right", **small,
            bbox={"facecolor": style.STABLE, "edgecolor": "none", "pad": 0.5} if unstable is None else None,
        )  # fmt: skip
    for point in diagram.points:
        ratio = PERCENT * point.parameters["section.damping_ratio"]
        if point.kind == "zh" and ratio > 0.15 * top:
            axes.annotate(
                "fold–Hopf", (point.parameter, ratio), xytext=(-5, 0), textcoords="offset points", ha="right",
                va="center", **small,
            )  # fmt: skip
        elif point.kind == "hh":
            edge = point.parameter > low + 0.75 * (high - low)
            axes.annotate(
                "Hopf–Hopf", (high if edge else point.parameter, ratio), xytext=(-3 if edge else 2, 8 if edge else 5),
                textcoords="offset points", ha="right" if edge else "left", **small,
            )  # fmt: skip
    on_c = [piece for piece in diagram.pieces if piece.letter == "C"]
    if on_c and max(float(piece.ratio.max()) for piece in on_c) > 0.2 * diagram.ratios[1]:
        piece = on_c[0]
        at = int(np.argmin(np.abs(PERCENT * piece.ratio - 0.08 * top)))
        axes.annotate(
            "Hopf on C", (float(piece.speed[at]), PERCENT * float(piece.ratio[at])), xytext=(-10, -2),
            textcoords="offset points", ha="right", arrowprops={"arrowstyle": "-", "linewidth": 0.4}, **small,
        )  # fmt: skip
    if result.sample_ratio is not None and diagram.ratios[0] < result.sample_ratio < diagram.ratios[1]:
        sample = PERCENT * result.sample_ratio
        axes.axhline(sample, color=style.BLUE, linewidth=0.7, linestyle=style.DASHED)
        axes.set_title(f"dashed: this case, {sample:.3g} %", loc="right", color=style.BLUE, pad=3.0, **small)


def _free(result: Result) -> np.ndarray:
    """The cells of the field without a line or a label: no text across those."""
    diagram = result.diagram
    field = diagram.field
    assert field is not None
    ratio, speed = field.ratio[:, None] / diagram.ratios[1], field.speed[None, :]
    width = diagram.speeds[1] - diagram.speeds[0]
    free = np.ones(field.count.shape, dtype=bool)
    if result.sample_ratio is not None:
        free &= np.abs(ratio - result.sample_ratio / diagram.ratios[1]) > 0.035
    if diagram.critical is not None:
        at, top = diagram.critical[0], diagram.critical[1] / diagram.ratios[1]
        label = (ratio > top - 0.02) & (ratio < top + 0.12)
        free &= ~(label & (np.abs(speed - at) < 0.55 * width))
    # half a text's width from either end
    return free & (speed > field.speed[0] + 0.11 * width) & (speed < field.speed[-1] - 0.12 * width)


def summary(result: Result) -> list[str]:
    """Plain sentences: fold, critical damping, where D is unstable at the case's damping, and notes."""
    return sentences(result.diagram)


def tables(result: Result) -> dict[str, Table]:
    """Fold, Hopf curves, special points and the field."""
    return diagram_tables(result.diagram)
