"""Figure 9 (section 5): stability of the equilibrium D and of the limit cycles over wind speed and damping.

Left of the fold there is no equilibrium D; where D is unstable, a limit cycle may be stable or none: the curves of
folds of cycles, Neimark-Sacker points and period doublings say where. Our reading: the sample case is the line at
0.2 %, the axis the undisturbed wind speed. Tests pin the fold (8 m/s, T2), the critical damping (0.7 %, T8), AUTO-07p's
fold-Hopf and Hopf-Hopf points and its folds of cycles. At the fold-Hopf point the Hopf curve passes from D to C: below
it, D is unstable from the fold on. Without stable cycles the rivulet falls to A, but for narrow bands of tori beside
supercritical Neimark-Sacker points.
"""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rainwind.dynamics.orbit_results import OrbitPoint
from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.cycle_curves import (
    LINES,
    NAMES,
    NOTHING,
    draw_curve,
    legend_handles,
    mark_points,
    shade_counts,
)
from rainwind.plotting.regions import draw_fold, draw_hopf, roomiest, shade_absent, shade_unstable
from rainwind.studies import paper
from rainwind.studies.branch_tables import diagram_tables
from rainwind.studies.cycle_curve_tables import cycle_curve_tables
from rainwind.studies.cycle_curves import RATIO, SCANNED, SPEED, Progress, cycle_curves
from rainwind.studies.cycle_field import CycleField, cycle_field
from rainwind.studies.equilibrium_names import LETTERS
from rainwind.studies.stability_diagram import DAMPING_ALIKE, StabilityDiagram, sentences, stability_diagram
from rainwind.studies.stability_sentences import cycle_sentences

PERCENT = 100.0


@dataclass(frozen=True, eq=False)
class Result:
    """The diagram, with its curves of cycles, and where cycles are stable; None where D has no Hopf point.

    sample_ratio: the damping ratio of the model it was computed for; None if y and z have each their own.
    """

    diagram: StabilityDiagram
    sample_ratio: float | None
    stable: CycleField | None = None

    @property
    def points(self) -> tuple[OrbitPoint, ...]:
        """The codimension-2 points of the curves of cycles, each once."""
        return self.diagram.cycle_curves.points() if self.diagram.cycle_curves else ()


def compute(
    model: RivuletModel | None = None,
    *,
    speeds: tuple[float, float] | None = None,
    ratios: tuple[float, float] | None = None,
    cycles: bool = True,
    progress: Progress | None = None,
) -> Result:
    """The diagram in a window of speeds (m/s) and damping ratios, by default around the model's onset.

    cycles: whether limit cycles are followed too, which takes most of the time. progress: told what is computed next,
    in words.
    """
    model = model or paper.model()
    sample = model.section.damping_ratio
    window = ratios or (0.0, max(paper.RATIOS[1], 1.25 * sample))
    diagram = stability_diagram(model, speeds, window, grow=ratios is None)
    if not cycles or not any(piece.letter == "D" for piece in diagram.pieces):
        return Result(diagram, diagram.own_ratio)
    top = diagram.critical[1] if diagram.critical is not None else diagram.ratios[1]
    scanned = [part * top for part in SCANNED]
    if diagram.own_ratio is not None:
        scanned.append(diagram.own_ratio)
    curves = cycle_curves(diagram.model, diagram.speeds, diagram.ratios, scanned, progress=progress)
    degenerate = [point for point in diagram.points if point.kind == "gh"]
    stable = cycle_field(curves, diagram.pieces, degenerate, diagram.speeds, diagram.ratios)
    return Result(replace(diagram, cycle_curves=curves), diagram.own_ratio, stable)


def draw(result: Result, figure: Figure) -> Figure:
    """Regions shaded and named, damping in per cent; with cycles, panels into the crowded parts beside it."""
    diagram = result.diagram
    cycles = diagram.cycle_curves is not None and len(diagram.cycle_curves.curves) > 0
    with style.journal(figure, width="double" if cycles else "single", height=112 if cycles else 76):
        doubts = result.stable.faults if result.stable is not None else ()
        doubt = (f"the count of stable cycles is doubtful: {doubts[0]}",) if doubts else ()
        notes = (*diagram.notes, *doubt)
        if not cycles:
            _whole(result, figure.add_subplot())
        else:
            # notes would lie on a legend below
            _panels(result, figure, legend="upper" if notes else "lower")
        style.below(figure, notes, letters=130 if cycles else 66)
    return figure


def _panels(result: Result, figure: Figure, *, legend: Literal["upper", "lower"]) -> None:
    """The whole window on the left; the upper corner and low damping on the right; one legend above or below."""
    boxes = [box for box in (upper_corner(result), low_damping(result)) if box is not None]
    grid = figure.add_gridspec(
        max(1, len(boxes)), 2 if boxes else 1, width_ratios=(1.0, 1.05) if boxes else None
    )
    first = figure.add_subplot(grid[:, 0])
    _whole(result, first)
    style.panel(first, "a")
    for k, (letter, box) in enumerate(zip("bc", boxes, strict=False)):
        axes = figure.add_subplot(grid[k, 1])
        _regions(result, axes, box)
        style.panel(axes, letter, "low damping" if box[1][0] == 0.0 else "the upper part of the NS curve")
        (x0, x1), (y0, y1) = box
        first.plot([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], color=style.GREY, linewidth=0.5, zorder=1.5)
        wide = x1 - x0 > 0.5 * float(np.ptp(first.get_xlim()))
        first.annotate(
            letter, (x0 if wide else x1, y1), xytext=(1 if wide else -1, 1), textcoords="offset points",
            ha="left" if wide else "right", fontsize=7, color="#505050",
        )  # fmt: skip
    curves, stable = result.diagram.cycle_curves, result.stable
    assert curves is not None
    assert stable is not None
    kinds = [kind for kind in LINES if curves.of(kind)]
    codim2 = [kind for kind in NAMES if any(kind == k for k, _, _ in _marks(result))]
    counts = [1, 2] if stable.count.max() > 1 else [1]
    place = "outside upper center" if legend == "upper" else "outside lower center"
    figure.legend(
        handles=legend_handles(kinds, codim2, counts), loc=place, ncols=4, borderpad=0.2,
        columnspacing=1.2, handlelength=2.3,
    )  # fmt: skip


def _marks(result: Result) -> list[tuple[str, float, float]]:
    """Kind, speed and damping in per cent of every special point, those where curves of cycles merely end left out."""
    linear = [p for p in result.diagram.points if p.kind in ("zh", "hh", "gh")]
    own = [p for p in result.points if p.kind not in ("zh", "gh")]
    return [(p.kind, p.parameter, PERCENT * p.parameters[RATIO]) for p in (*linear, *own)]


Box = tuple[tuple[float, float], tuple[float, float]]


def upper_corner(result: Result) -> Box | None:
    """Speeds and per cent around the points above half of the highest NS point; None with fewer than two."""
    curves = result.diagram.cycle_curves
    tops = [PERCENT * float(c[RATIO].max()) for c in curves.of("ns")] if curves else []
    found = [(x, y) for kind, x, y in _marks(result) if tops and 0.5 * max(tops) < y]
    if len(found) < 2:
        return None
    x, y = np.array(found).T
    top, wide = max(float(y.max()), *tops), float(np.ptp(x))
    tall = top - float(y.min())
    return (float(x.min()) - 0.08 * wide, float(x.max()) + 0.2 * wide), (
        float(y.min()) - 0.12 * tall,
        top + 0.2 * tall,
    )


def low_damping(result: Result) -> Box | None:
    """The speeds of all cycles, and damping up to the points below a fifth of the critical; None without such."""
    diagram = result.diagram
    if diagram.critical is None or diagram.cycle_curves is None or diagram.ratios[0] > 0:
        return None
    limit = 0.2 * PERCENT * diagram.critical[1]
    found = [y for _, _, y in _marks(result) if y < limit]
    if not found:
        return None
    speed = min(float(c[SPEED].min()) for c in diagram.cycle_curves.curves)
    low = max(diagram.speeds[0], speed - 0.03 * (diagram.speeds[1] - diagram.speeds[0]))
    return (low, diagram.speeds[1]), (0.0, 1.35 * max(found))


def _whole(result: Result, axes: Axes) -> None:
    diagram = result.diagram
    window = (diagram.speeds, (PERCENT * diagram.ratios[0], PERCENT * diagram.ratios[1]))
    _regions(result, axes, window)
    if diagram.equilibria["D"] is None:
        style.note(axes, "no equilibrium D\nin this window", color=style.BLACK)
    else:
        _name(result, axes)


def _regions(result: Result, axes: Axes, box: Box) -> None:
    """Regions and curves in a window of speeds and per cent."""
    diagram, stable = result.diagram, result.stable
    (low, high), (bottom, top) = box
    axes.set(xlim=(low, high), ylim=(bottom, top), xlabel=style.UNDISTURBED)
    axes.set_ylabel(style.DAMPING if result.sample_ratio is not None else DAMPING_ALIKE)
    onset = diagram.onset
    if diagram.equilibria["D"] is None:
        shade_absent(axes, low, high, bottom, top)
        return
    if diagram.field is not None:
        color = style.UNSTABLE if stable is None else NOTHING
        shade_unstable(
            axes, diagram.field.speed, PERCENT * diagram.field.ratio, diagram.field.growth, color=color
        )
    if diagram.reach is not None:
        shade_absent(axes, low, diagram.reach[0], bottom, top)
    if diagram.reach is not None and not diagram.reaches_end:
        shade_absent(axes, diagram.reach[1], high, bottom, top)
    if stable is not None:
        shade_counts(axes, stable.speed, PERCENT * stable.ratio, stable.count)
    if onset is not None:
        draw_fold(axes, onset, bottom, top)
    for piece in diagram.pieces:
        if piece.letter in ("C", "D"):
            draw_hopf(
                axes, piece.speed, PERCENT * piece.ratio, on_d=piece.letter == "D", limit=piece.others == 0
            )
    curves = diagram.cycle_curves
    if curves is None:
        mark_points(axes, [mark for mark in _marks(result) if mark[0] != "gh"])
        return
    for curve in curves.curves:
        for (others, speed, ratio), soft in zip(curves.pieces(curve), curves.soft(curve), strict=True):
            limit = others == 0
            draw_curve(axes, curve.kind, speed, PERCENT * ratio, limit=limit, soft=limit and soft is True)
    mark_points(axes, _marks(result))
    axes.set(xlim=(low, high), ylim=(bottom, top))


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
    if result.stable is not None:
        _name_cycles(result, axes)
    unstable = roomiest(field.speed, field.ratio, free & (field.count > 0), shape=1.0, least=0.04)
    stable = roomiest(field.speed, field.ratio, free & (field.count == 0), shape=1.0, least=0.04)
    if unstable is not None and result.stable is None:
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
    # with cycles the legend names them
    for point in diagram.points if result.stable is None else ():
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


def _name_cycles(result: Result, axes: Axes) -> None:
    """Names inside the regions where a cycle is stable and where nothing near D is."""
    diagram, stable = result.diagram, result.stable
    assert stable is not None
    assert diagram.field is not None
    field = diagram.field
    inside = (stable.speed > field.speed[0]) & (stable.speed < field.speed[-1])
    i = np.abs(field.ratio[:, None] - stable.ratio).argmin(axis=0)
    k = np.abs(field.speed[:, None] - stable.speed).argmin(axis=0)
    unstable = (field.count[np.ix_(i, k)] > 0) & inside
    free = np.ones_like(unstable)
    if result.sample_ratio is not None:
        free &= np.abs(stable.ratio[:, None] - result.sample_ratio) > 0.035 * diagram.ratios[1]
    for mask, words in (
        ((stable.count > 0) & unstable, "stable\ncycle"),
        ((stable.count == 0) & unstable, "no\nstable\ncycle"),
    ):
        at = roomiest(stable.speed, stable.ratio, mask & free, shape=1.0, least=0.02)
        if at is not None:
            color = NOTHING if words.startswith("no") else "none"
            axes.text(
                at[0], PERCENT * at[1], words, ha="center", va="center", zorder=3.0, fontsize=7.0,
                bbox={"facecolor": color, "edgecolor": "none", "pad": 1.0},
            )  # fmt: skip


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
    """Plain sentences: fold, critical damping, which damping stops everything, cycles, the letters, and notes."""
    said = sentences(result.diagram)
    if result.stable is not None:
        marks = [(kind, speed, 0.01 * percent) for kind, speed, percent in _marks(result)]
        said += cycle_sentences(result.diagram, result.stable, result.sample_ratio, marks)
    return [*said, LETTERS]


def tables(result: Result) -> dict[str, Table]:
    """Fold, Hopf curves, special points and the field; curves of cycles, their points, where cycles are stable."""
    found = diagram_tables(result.diagram)
    curves, stable = result.diagram.cycle_curves, result.stable
    if curves is not None and stable is not None:
        found |= cycle_curve_tables(curves, stable)
    return found
