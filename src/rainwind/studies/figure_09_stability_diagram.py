"""Figure 9 (section 5): stability of the equilibrium D over wind speed and damping of the cable.

Three regions: no equilibrium D (left of the fold), D stable, D unstable. The linear curves only: the fold and the Hopf
curve on D; the paper's curves of limit cycles are not computed here. Our reading: the sample case is the line at 0.2 %,
the axis the undisturbed wind speed. Tests pin the fold (8 m/s, T2), the critical damping (0.7 %, T8) and AUTO-07p's
fold-Hopf and Hopf-Hopf points. At the fold-Hopf point the Hopf curve passes from D to C: below it, D is unstable from
the fold on.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.branches import mark
from rainwind.plotting.regions import draw_fold, draw_hopf, shade_absent, shade_unstable
from rainwind.studies import paper
from rainwind.studies.branch_tables import diagram_tables
from rainwind.studies.stability_diagram import StabilityDiagram, stability_diagram

PERCENT = 100.0


@dataclass(frozen=True, eq=False)
class Result:
    """The diagram, and the damping ratio of the model it was computed for."""

    diagram: StabilityDiagram
    sample_ratio: float


def compute(
    model: RivuletModel | None = None,
    *,
    speeds: tuple[float, float] | None = None,
    ratios: tuple[float, float] | None = None,
) -> Result:
    """The diagram in a window of speeds (m/s) and damping ratios, by default around the model's onset."""
    model = model or paper.model()
    sample = model.section.damping_ratio
    chosen = ratios or paper.RATIOS
    diagram = stability_diagram(model, speeds, chosen)
    needed = 1.3 * max(sample, diagram.critical[1] if diagram.critical else 0.0)
    if ratios is None and needed > chosen[1]:
        # a curve cut off at the window's top has its end there; three times as high is the next try
        diagram = stability_diagram(model, diagram.speeds, (0.0, max(needed, 3 * chosen[1])))
    return Result(diagram, sample)


def draw(result: Result, figure: Figure) -> Figure:
    """Regions shaded and named, damping in per cent."""
    diagram = result.diagram
    (low, high), (bottom, top) = diagram.speeds, (PERCENT * r for r in diagram.ratios)
    with style.journal(figure, width="single", height=76):
        axes = figure.add_subplot()
        axes.set(xlim=(low, high), ylim=(bottom, top), xlabel=style.UNDISTURBED, ylabel=style.DAMPING)
        onset = diagram.onset
        if diagram.equilibria["D"] is None:
            shade_absent(axes, low, high, bottom, top)
            style.note(axes, "no equilibrium D\nin this window", color=style.BLACK)
            return figure
        if diagram.field is not None:
            shade_unstable(axes, diagram.field.speed, PERCENT * diagram.field.ratio, diagram.field.growth)
        if onset is not None:
            shade_absent(axes, low, onset, bottom, top)
            draw_fold(axes, onset, bottom, top)
        for piece in diagram.pieces:
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
    small = {"fontsize": 7.0}
    if onset > low:
        axes.text(0.5 * (low + onset), 0.55 * top, "no\nequilibrium\nD", ha="center", va="center")
        axes.text(
            onset + 0.012 * (high - low), 0.97 * top, f"fold {onset:.2f} m/s", ha="left", va="top", **small
        )
    unstable = diagram.field is not None and bool((diagram.field.count > 0).any())
    if not unstable:
        axes.text(0.5 * (onset + high), 0.5 * top, "D stable at every damping", ha="center", va="center")
        return
    box = {"facecolor": style.UNSTABLE, "edgecolor": "none", "pad": 1.5}
    axes.text(onset + 0.22 * (high - onset), 0.3 * top, "D unstable", ha="center", va="center", bbox=box)
    axes.text(onset + 0.72 * (high - onset), 0.62 * top, "D stable", ha="center", va="center")
    if diagram.critical is not None:
        speed, ratio = diagram.critical
        if ratio < 0.95 * diagram.ratios[1]:
            axes.annotate(
                f"critical damping {PERCENT * ratio:.2f} %", (speed, PERCENT * ratio), xytext=(10, 5),
                textcoords="offset points", **small,
            )  # fmt: skip
    for point in diagram.points:
        ratio = PERCENT * point.parameters["section.damping_ratio"]
        if point.kind == "zh":
            axes.annotate(
                "fold–Hopf", (point.parameter, ratio), xytext=(-5, 0), textcoords="offset points", ha="right",
                va="center", **small,
            )  # fmt: skip
        elif point.kind == "hh":
            axes.annotate(
                "Hopf–Hopf", (point.parameter, ratio), xytext=(2, 5), textcoords="offset points", ha="left",
                **small,
            )  # fmt: skip
    on_c = [piece for piece in diagram.pieces if piece.letter == "C"]
    if on_c:
        piece = on_c[0]
        at = int(np.argmin(np.abs(PERCENT * piece.ratio - 0.08 * top)))
        axes.annotate(
            "Hopf on C", (float(piece.speed[at]), PERCENT * float(piece.ratio[at])), xytext=(-10, -2),
            textcoords="offset points", ha="right", arrowprops={"arrowstyle": "-", "linewidth": 0.4}, **small,
        )  # fmt: skip
    if diagram.ratios[0] < result.sample_ratio < diagram.ratios[1]:
        sample = PERCENT * result.sample_ratio
        axes.axhline(sample, color=style.BLUE, linewidth=0.7, linestyle=style.DASHED)
        axes.text(
            high - 0.012 * (high - low), sample, f"this case: {sample:.3g} %", ha="right", va="bottom",
            color=style.BLUE, **small,
        )  # fmt: skip


def tables(result: Result) -> dict[str, Table]:
    """Fold, Hopf curves, special points and the field."""
    return diagram_tables(result.diagram)
