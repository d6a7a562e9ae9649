"""Figure 5 (section 4.1): the rivulet angle of the equilibria A, B, C and D over the wind speed.

Our reading: the axis is the undisturbed wind speed (equal to the normal speed in the sample case, gamma = 0); the
order in phi is B < D < C < A, inferred. The text prints the fold at 8 m/s: a test pins it (T2), and the number and
kind of the equilibria (T1).
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.branches import draw_branch, label_points
from rainwind.studies import paper
from rainwind.studies.branch_tables import equilibrium_tables
from rainwind.studies.equilibrium_map import EquilibriumMap, equilibrium_map, speed_window


@dataclass(frozen=True, eq=False)
class Result:
    """All equilibria over wind speed."""

    equilibria: EquilibriumMap

    @property
    def onset(self) -> float | None:
        """The fold in which D begins, m/s; None without D."""
        return self.equilibria.onset


def compute(model: RivuletModel | None = None, *, speeds: tuple[float, float] | None = None) -> Result:
    """Walk every branch of equilibria through the window `speeds` (m/s), by default around the model's onset."""
    model = model or paper.model()
    return Result(equilibrium_map(model, speeds or speed_window(model)))


def draw(result: Result, figure: Figure) -> Figure:
    """Angles in degrees: stable solid, unstable dashed, fold and Hopf points marked, branches named."""
    known = result.equilibria
    with style.journal(figure, width="single", height=72):
        axes = figure.add_subplot()
        for branch in known.branches:
            draw_branch(branch, axes, "phi", scale=np.degrees(1.0))
        for side in known.outside:
            speed, state = side.states()
            axes.plot(speed, np.degrees(state[:, 1]), color=style.ABSENT, linewidth=6.0, zorder=0.5)
        axes.set(xlim=known.speeds, xlabel=style.UNDISTURBED, ylabel=r"rivulet angle $\phi$ (°)")
        low, high = axes.get_ylim()
        axes.set_ylim(min(-30.0, low), max(240.0, high))
        axes.set_yticks(np.arange(-90, 361, 45))
        axes.set_ylim(min(-30.0, low), max(240.0, high))
        for side in known.sides:
            if side.letter:
                speed, state = side.states()
                upper = side.letter == "D"  # its Hopf points are named above it
                at = speed[0] + (0.92 if upper else 0.8) * (speed[-1] - speed[0])
                angle = np.degrees(np.interp(at, speed, state[:, 1]))
                axes.annotate(
                    side.letter, (at, angle), xytext=(0, -4 if upper else 3), textcoords="offset points", ha="center",
                    va="top" if upper else "baseline", fontweight="bold",
                )  # fmt: skip
        _name_points(result, axes)
        grey = ["grey: outside the coefficients' range"] if known.outside else []
        style.below(figure, [*grey, *known.notes])
    return figure


def _name_points(result: Result, axes: Axes) -> None:
    upper, across = result.equilibria["D"], result.equilibria["C"]
    if upper is None:
        style.note(axes, "no upper rivulet D in this window", y=0.62)
        return
    fold = result.equilibria.fold
    if fold is not None:
        axes.annotate(
            f"fold\n{fold.parameter:.2f} m/s", (fold.parameter, np.degrees(fold["phi"])), xytext=(-5, 4),
            textcoords="offset points", ha="right", va="top", fontsize=7,
        )  # fmt: skip
    for side in (across, upper):
        found = [
            (point.parameter, float(np.degrees(point["phi"])), f"{point.parameter:.2f}")
            for point in (side.points("hopf") if side else ())
        ]
        # next to the fold there is room on the left only
        near = [p for p in found if p[0] < 1.1 * (result.onset or 0.0)]
        label_points(
            axes, near, pattern="Hopf\n{} m/s", offset=5.0 if side is across else -16.0, side="right"
        )
        label_points(axes, [p for p in found if p not in near], pattern="Hopf {} m/s", offset=5.0)


def summary(result: Result) -> list[str]:
    """Plain sentences: where D begins and ends, and the notes."""
    return [*result.equilibria.existence(), *result.equilibria.notes]


def tables(result: Result) -> dict[str, Table]:
    """The equilibria by letter and the special points."""
    return equilibrium_tables(result.equilibria)
