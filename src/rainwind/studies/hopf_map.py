"""Where the equilibria lose stability over wind speed and damping, down to 0.02 %: beyond the paper's figure 9.

What the model says there, with the default coefficients: real stays live at damping ratios of 0.05 to 0.2 %. Near
16.4 m/s and 0.09 % two Hopf curves of D cross (Hopf-Hopf; the frequencies are within 1 %, y and z being tuned alike).
Below that point D is unstable at every wind speed above the fold. Between it and 0.11 % D is stable in a gap only; the
second pair stays unstable up to 40 m/s, the end of the map: no upper limit of the wind speed. Tests pin AUTO-07p's
Hopf-Hopf and fold-Hopf points. All of it is linear theory of the model, whose coefficients are reconstructed.
"""

from dataclasses import dataclass
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.branches import NAMES, mark
from rainwind.plotting.regions import draw_fold, roomiest, shade_absent
from rainwind.studies import paper
from rainwind.studies.branch_tables import diagram_tables
from rainwind.studies.equilibrium_map import speed_window
from rainwind.studies.stability_diagram import StabilityDiagram, stability_diagram

PERCENT = 100.0
_SHADES = {2: "#F6C9A8", 4: "#DE8F63"}
_TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True, eq=False)
class Result:
    """The diagram with all Hopf curves on A, B, C and D.

    hopf_hopf: speed (m/s) and ratio of each such point. unlimited_below: the damping ratio below which D is unstable
    at the highest speed of the map, None where it is stable there at every ratio. unstable_everywhere_below: the ratio
    below which D is unstable at every speed above the fold, None without one.
    """

    diagram: StabilityDiagram
    hopf_hopf: tuple[tuple[float, float], ...]
    unlimited_below: float | None
    unstable_everywhere_below: float | None

    @property
    def statement(self) -> str:
        """In words, what the map shows."""
        diagram = self.diagram
        last, lowest = diagram.speeds[1], PERCENT * diagram.ratios[0]
        if diagram.equilibria["D"] is None:
            return f"There is no upper rivulet D between {diagram.speeds[0]:g} and {last:g} m/s."
        said = [
            f"Hopf–Hopf point at {speed:.2f} m/s and {PERCENT * ratio:.3f} %."
            for speed, ratio in self.hopf_hopf
        ]
        if self.unlimited_below is not None:
            said.append(
                f"Below {PERCENT * self.unlimited_below:.3f} % D is unstable at {last:g} m/s, the end of the map: "
                "no upper limit of the wind speed there."
            )
        if self.unstable_everywhere_below is not None:
            said.append(
                f"Below {PERCENT * self.unstable_everywhere_below:.3f} % D is unstable at every wind speed above "
                f"{diagram.onset or diagram.speeds[0]:.2f} m/s."
            )
        on_d = any(piece.letter == "D" for piece in diagram.pieces)
        if self.unlimited_below is None and on_d and diagram.critical is not None:
            speed, ratio = diagram.critical
            said.append(
                f"D is unstable in a limited range of wind speeds, below a damping of {PERCENT * ratio:.3f} % "
                f"(reached at {speed:.2f} m/s)."
            )
        return " ".join(said) or f"D has no Hopf point above a damping ratio of {lowest:g} %."


def compute(
    model: RivuletModel | None = None,
    *,
    speeds: tuple[float, float] | None = None,
    ratios: tuple[float, float] | None = None,
) -> Result:
    """All Hopf curves in a window of speeds (m/s; default: to five times the onset) and damping ratios."""
    model = model or paper.model()
    speeds = speeds or speed_window(model, paper.MAP_REACH)
    diagram = stability_diagram(
        model,
        speeds,
        ratios or paper.MAP_RATIOS,
        letters="ABCD",
        shape=(240, 160),
        ds=0.02,
        grow=ratios is None,
    )
    points = tuple(
        (p.parameter, p.parameters["section.damping_ratio"]) for p in diagram.points if p.kind == "hh"
    )
    return Result(diagram, points, _unlimited_below(diagram), _everywhere_below(diagram))


def _unlimited_below(diagram: StabilityDiagram) -> float | None:
    """Bisection in the damping ratio at the window's end."""
    low, high = diagram.ratios
    if diagram.field is None or not diagram.unstable_at_end(low):
        return None
    if diagram.unstable_at_end(high):
        return high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if diagram.unstable_at_end(middle) else (low, middle)
    return 0.5 * (low + high)


def _everywhere_below(diagram: StabilityDiagram) -> float | None:
    """The lowest ratio on D's limit of stability, if D is unstable at all speeds below it."""
    if diagram.field is None or not np.all(diagram.field.count[0, 1:] > 0):
        return None
    limits = [piece.ratio for piece in diagram.pieces if piece.letter == "D" and piece.others == 0]
    return float(min(ratio.min() for ratio in limits)) if limits else None


def draw(result: Result, figure: Figure) -> Figure:
    """A logarithmic axis of damping; the shades count the unstable pairs of D."""
    diagram = result.diagram
    (low, high), (bottom, top) = diagram.speeds, (PERCENT * r for r in diagram.ratios)
    with style.journal(figure, width="double", height=100):
        axes = figure.add_subplot()
        axes.set_yscale("log")
        axes.set(xlim=(low, high), ylim=(bottom, top), xlabel=style.UNDISTURBED, ylabel=style.DAMPING)
        axes.yaxis.set_major_locator(FixedLocator([t for t in _TICKS if bottom <= t <= top]))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
        figure.supxlabel(fill(result.statement, 125), fontsize=7.0, x=0.01, ha="left")
        if diagram.equilibria["D"] is None or diagram.field is None:
            shade_absent(axes, low, high, bottom, top)
            style.note(axes, "no equilibrium D in this window", color=style.BLACK)
            return figure
        field = diagram.field
        for count, color in _SHADES.items():
            if (field.count >= count).any():
                axes.contourf(
                    field.speed,
                    PERCENT * field.ratio,
                    field.count,
                    levels=[count - 1, 10],
                    colors=[color],
                    zorder=0,
                )
        onset = diagram.onset
        if onset is not None:
            shade_absent(axes, low, onset, bottom, top)
            draw_fold(axes, onset, bottom, top)
        _curves(result, axes)
        _texts(result, axes)
    return figure


_LOOKS = {
    "D": (style.BLACK, "-"), "C": (style.VERMILION, style.DASHED), "B": (style.BLUE, style.DOTTED),
    "A": (style.GREEN, style.DASH_DOTTED), "": (style.GREY, "-"),
}  # fmt: skip


def _curves(result: Result, axes: Axes) -> None:
    seen = set()
    for piece in result.diagram.pieces:
        color, line = _LOOKS[piece.letter]
        label = None if piece.letter in seen else f"Hopf on {piece.letter or 'another'}"
        seen.add(piece.letter)
        axes.plot(piece.speed, PERCENT * piece.ratio, color=color, linestyle=line, label=label)
    kinds = set()
    for point in result.diagram.points:
        ratio = PERCENT * point.parameters["section.damping_ratio"]
        mark(axes, point.kind, point.parameter, ratio)
        if point.kind not in kinds:
            axes.lines[-1].set_label(NAMES[point.kind])
        kinds.add(point.kind)
    live = [PERCENT * r for r in paper.LIVE_RATIOS]
    for ratio in live:
        axes.axhline(ratio, color=style.GREY, linewidth=0.5, linestyle=style.DASHED, zorder=0.9)
    if axes.get_legend_handles_labels()[0]:
        axes.figure.legend(loc="outside upper left", ncols=6, columnspacing=1.4)  # type: ignore[union-attr]


def _texts(result: Result, axes: Axes) -> None:
    diagram = result.diagram
    low, high = diagram.speeds
    onset = diagram.onset or low
    middle = PERCENT * float(np.sqrt(paper.LIVE_RATIOS[0] * paper.LIVE_RATIOS[1]))
    axes.text(high - 0.01 * (high - low), PERCENT * paper.LIVE_RATIOS[1], "real stays: 0.05 to 0.2 %", fontsize=7,
              ha="right", va="bottom")  # fmt: skip
    if onset > low:
        axes.text(0.5 * (low + onset), middle, "no\nD", ha="center", va="center")
    names = {0: "D stable", 2: "one pair of D unstable", 4: "two pairs\nunstable"}
    field = diagram.field
    if field is None:
        return
    for count, name in names.items():
        inside = np.where(_crossed(result), False, field.count == count)
        place = roomiest(field.speed, field.ratio, inside, shape=1.3)
        if place is not None:
            axes.text(place[0], PERCENT * place[1], name, ha="center", va="center", fontsize=7.5)


def _crossed(result: Result) -> np.ndarray:
    """The cells of the field that another line passes: no place for text."""
    field = result.diagram.field
    assert field is not None
    crossed = np.zeros(field.count.shape, dtype=bool)
    for ratio in paper.LIVE_RATIOS:
        crossed[np.abs(np.log(field.ratio / ratio)) < 0.08] = True
    for piece in result.diagram.pieces:
        if piece.letter != "D":
            columns = np.clip(np.searchsorted(field.speed, piece.speed), 0, field.speed.size - 1)
            rows = np.clip(np.searchsorted(field.ratio, piece.ratio), 0, field.ratio.size - 1)
            crossed[rows, columns] = True
    return crossed


def tables(result: Result) -> dict[str, Table]:
    """Fold, all Hopf curves with their equilibrium, special points, and the count of unstable eigenvalues of D."""
    return diagram_tables(result.diagram)
