"""Where the equilibria lose stability over wind speed and damping, down to 0.02 %: beyond the paper's figure 9.

What the model says there, with the default coefficients: real stays live at damping ratios of 0.05 to 0.2 %. Near
16.4 m/s and 0.09 % two Hopf curves of D cross (Hopf-Hopf; the frequencies are within 1 %, y and z being tuned alike).
Below that point D is unstable at every wind speed from the fold to 40 m/s, the end of the map. Between it and 0.11 % D
is stable in a gap only; the second pair is still unstable at 40 m/s, and at 0.05 % also at 60, 100 and 200 m/s, where
the eigenvalues were computed: no upper limit was found. Tests pin AUTO-07p's Hopf-Hopf and fold-Hopf points. All of it
is linear theory of the model, whose coefficients are reconstructed.
"""

from dataclasses import dataclass
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from rainwind.dynamics.equilibria import find_equilibrium
from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.branches import NAMES, mark
from rainwind.plotting.regions import draw_fold, roomiest, shade_absent
from rainwind.studies import paper
from rainwind.studies.branch_tables import diagram_tables
from rainwind.studies.equilibrium_map import equilibrium_map, speed_window
from rainwind.studies.hopf_curves import ALONG
from rainwind.studies.stability_diagram import DAMPING_ALIKE, StabilityDiagram, sentences, stability_diagram

PERCENT = 100.0
_BEYOND = (1.5, 2.5, 5.0)  # parts of the highest speed at which D is looked at beyond the map
_SHADES = {2: "#F6C9A8", 4: "#DE8F63"}
_TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True, eq=False)
class Result:
    """The diagram with all Hopf curves on A, B, C and D.

    hopf_hopf: speed (m/s) and ratio of each such point. unlimited_below: the damping ratio below which D is unstable
    at the highest speed of the map, None where it is stable or absent there at every ratio. unstable_everywhere_below:
    the ratio below which D is unstable at every speed of the map where it is, None without one. beyond: a ratio, and
    higher speeds at which D was looked at, each with whether it is unstable there.
    """

    diagram: StabilityDiagram
    hopf_hopf: tuple[tuple[float, float], ...]
    unlimited_below: float | None
    unstable_everywhere_below: float | None
    beyond: tuple[float, tuple[tuple[float, bool], ...]] | None = None

    @property
    def statement(self) -> str:
        """In words, what the map shows."""
        diagram = self.diagram
        last, lowest = diagram.speeds[1], PERCENT * diagram.ratios[0]
        notes = [f"{note[0].upper()}{note[1:]}." for note in diagram.notes]
        reach = diagram.reach
        if reach is None:
            none = f"There is no upper rivulet D between {diagram.speeds[0]:g} and {last:g} m/s."
            return " ".join([none, *(note for note in notes if not note.startswith("No upper rivulet"))])
        said = [
            f"Hopf–Hopf point at {speed:.2f} m/s and {PERCENT * ratio:.3f} %."
            for speed, ratio in self.hopf_hopf
        ]
        if self.unlimited_below is not None:
            said.append(
                f"Below {PERCENT * self.unlimited_below:.3f} % D is unstable at {last:g} m/s, the end of this map"
                f"{self._beyond}."
            )
        if self.unstable_everywhere_below is not None:
            said.append(
                f"Below {PERCENT * self.unstable_everywhere_below:.3f} % D is unstable at every wind speed of this map "
                f"where it exists, {reach[0]:.2f} to {reach[1]:.4g} m/s."
            )
        on_d = any(piece.letter == "D" for piece in diagram.pieces)
        if self.unlimited_below is None and on_d and diagram.critical is not None:
            speed, ratio = diagram.critical
            said.append(
                f"In this map D is unstable only below a damping of {PERCENT * ratio:.3f} % "
                f"(reached at {speed:.2f} m/s)."
            )
        if not said:
            said = [f"D has no Hopf point above a damping ratio of {lowest:g} %."]
        return " ".join([*said, *notes])

    @property
    def _beyond(self) -> str:
        """What was found at higher speeds, to go on with in a sentence."""
        if self.beyond is None:
            return ""
        ratio, looked = self.beyond
        percent = f"{PERCENT * ratio:.2g} %"
        if all(unstable for _, unstable in looked):
            speeds = ", ".join(f"{speed:g}" for speed, _ in looked)
            speeds = " and ".join(speeds.rsplit(", ", 1))
            return f", and no upper limit was found: at {percent} it is still unstable at {speeds} m/s"
        first = next(speed for speed, unstable in looked if not unstable)
        return f"; at {percent} it is stable at {first:g} m/s"


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
    unlimited = _unlimited_below(diagram)
    return Result(diagram, points, unlimited, _everywhere_below(diagram), _looked_beyond(diagram, unlimited))


def _unlimited_below(diagram: StabilityDiagram) -> float | None:
    """The highest ratio of the field's last column that is unstable from the lowest on, then by bisection."""
    field = diagram.field
    if field is None or not diagram.reaches_end or field.count[0, -1] == 0:
        return None
    rows = int(np.argmin(np.append(field.count[:, -1] > 0, False)))
    if rows == len(field.ratio):
        return diagram.ratios[1]
    low, high = float(field.ratio[rows - 1]), float(field.ratio[rows])
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if diagram.unstable_at_end(middle) else (low, middle)
    return 0.5 * (low + high)


def _everywhere_below(diagram: StabilityDiagram) -> float | None:
    """The lowest ratio on D's limit of stability, if D is unstable at all speeds below it."""
    field = diagram.field
    if field is None or not np.all(field.count[0, 1:-1] > 0):
        return None
    limits = [piece.ratio for piece in diagram.pieces if piece.letter == "D" and piece.others == 0]
    if not limits:
        return None
    # no more than one row of the field away from what is shaded
    rows = int(np.argmin(np.append(np.all(field.count[:, 1:-1] > 0, axis=1), False)))
    highest = field.ratio[min(rows, len(field.ratio) - 1)]
    return float(np.clip(min(ratio.min() for ratio in limits), field.ratio[rows - 1], highest))


def _looked_beyond(
    diagram: StabilityDiagram, unlimited: float | None
) -> tuple[float, tuple[tuple[float, bool], ...]] | None:
    """D followed to five times the map's highest speed, at the lowest damping of real stays."""
    ratio = paper.LIVE_RATIOS[0]
    side = diagram.equilibria["D"]
    if unlimited is None or side is None or not diagram.ratios[0] <= ratio < unlimited:
        return None
    end = diagram.speeds[1]
    at = diagram.model.with_parameters({ALONG[0]: end, ALONG[1]: ratio})
    wide = equilibrium_map(at, (end, _BEYOND[-1] * end))["D"]
    looked = []
    for speed in (factor * end for factor in _BEYOND):
        state = wide.at(speed) if wide else None
        if state is None:
            break
        found = find_equilibrium(at.with_parameters({ALONG[0]: speed}), state)
        looked.append((speed, bool(found.eigenvalues.real.max() > 0)))
    return (ratio, tuple(looked)) if looked else None


def draw(result: Result, figure: Figure) -> Figure:
    """A logarithmic axis of damping; the shades count the unstable pairs of D."""
    diagram = result.diagram
    (low, high), (bottom, top) = diagram.speeds, (PERCENT * r for r in diagram.ratios)
    with style.journal(figure, width="double", height=100):
        axes = figure.add_subplot()
        axes.set_yscale("log")
        axes.set(xlim=(low, high), ylim=(bottom, top), xlabel=style.UNDISTURBED)
        axes.set_ylabel(style.DAMPING if diagram.own_ratio is not None else DAMPING_ALIKE)
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
        shade_absent(axes, low, float(field.speed[0]), bottom, top)
        if not diagram.reaches_end:
            shade_absent(axes, float(field.speed[-1]), high, bottom, top)
        if diagram.onset is not None:
            draw_fold(axes, diagram.onset, bottom, top)
            axes.lines[-1].set_label("fold, where D begins")
        _curves(result, axes)
        _texts(result, axes)
    return figure


_LOOKS = {
    "D": (style.BLACK, "-"), "C": (style.VERMILION, style.DASHED), "B": (style.BLUE, style.DOTTED),
    "A": (style.GREEN, style.DASH_DOTTED),
}  # fmt: skip


def _curves(result: Result, axes: Axes) -> None:
    seen = set()
    for piece in result.diagram.pieces:
        if piece.letter not in _LOOKS:  # an equilibrium without a name
            continue
        color, line = _LOOKS[piece.letter]
        label = None if piece.letter in seen else f"Hopf on {piece.letter}"
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
    own = result.diagram.own_ratio
    if own is not None and result.diagram.ratios[0] <= own <= result.diagram.ratios[1]:
        percent = f"{PERCENT * own:.3g} %"
        axes.axhline(
            PERCENT * own, color=style.BLUE, linewidth=0.8, zorder=0.9, label=f"this case: {percent}"
        )
    if axes.get_legend_handles_labels()[0]:
        axes.figure.legend(loc="outside upper left", ncols=5, columnspacing=1.4)  # type: ignore[union-attr]


def _texts(result: Result, axes: Axes) -> None:
    diagram = result.diagram
    low, high = diagram.speeds
    onset = diagram.onset or low
    middle = PERCENT * float(np.sqrt(paper.LIVE_RATIOS[0] * paper.LIVE_RATIOS[1]))
    axes.text(high - 0.01 * (high - low), PERCENT * paper.LIVE_RATIOS[1], "real stays: 0.05 to 0.2 %", fontsize=7,
              ha="right", va="bottom")  # fmt: skip
    if onset > low + 0.03 * (high - low):
        axes.text(0.5 * (low + onset), middle, "no\nD", ha="center", va="center")
    beyond = diagram.reach[1] if diagram.reach else high
    if beyond < high - 0.05 * (high - low):
        axes.text(0.5 * (beyond + high), middle, diagram.why_it_ends, ha="center", va="center", fontsize=7)
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
    own = result.diagram.own_ratio
    for ratio in (*paper.LIVE_RATIOS, *([own] if own else [])):
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


def summary(result: Result) -> list[str]:
    """Plain sentences: the map's statement, and what holds at the case's own damping."""
    said = sentences(result.diagram)
    return [*(line for line in said if line not in result.statement), result.statement]
