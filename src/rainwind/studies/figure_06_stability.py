"""Figure 6 (section 4.2): the largest real part of the eigenvalues of D over the wind speed, U_H1 and U_H2.

The paper has D change stability twice, at U_H1 near 8 m/s and at U_H2 = 14.8 m/s. With our coefficients D is already
unstable where it is born in the fold, and the low Hopf point lies on C, just above the fold: the second panel shows
it. A test pins U_H2 (T4) and, on C, AUTO-07p's Hopf point.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rainwind.dynamics.results import SpecialPoint
from rainwind.io.results import Column, Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.branches import label_points, mark
from rainwind.studies import paper
from rainwind.studies.branch_tables import equilibrium_tables
from rainwind.studies.equilibrium_map import EquilibriumMap, Side, equilibrium_map, speed_window


@dataclass(frozen=True, eq=False)
class Result:
    """Growth of small disturbances of D and C.

    growth: letter -> speeds (m,) in m/s and the largest real part (m,) in 1/s; oscillating: the same of the
    eigenvalues that are not real, which cross the axis at a Hopf point, near the fold.
    """

    equilibria: EquilibriumMap
    growth: dict[str, tuple[np.ndarray, np.ndarray]]
    oscillating: dict[str, tuple[np.ndarray, np.ndarray]]

    @property
    def hopf_on_d(self) -> tuple[SpecialPoint, ...]:
        """Hopf points on D by rising speed: U_H2 is the last."""
        side = self.equilibria["D"]
        return side.points("hopf") if side else ()

    @property
    def hopf_on_c(self) -> tuple[SpecialPoint, ...]:
        """Hopf points on C."""
        side = self.equilibria["C"]
        return side.points("hopf") if side else ()


def compute(model: RivuletModel | None = None, *, speeds: tuple[float, float] | None = None) -> Result:
    """Eigenvalues along D and C in the window `speeds` (m/s), by default around the model's onset."""
    model = model or paper.model()
    known = equilibrium_map(model, speeds or speed_window(model))
    growth = {letter: _along(side, pairs=False) for letter in ("C", "D") if (side := known[letter])}
    oscillating = {}
    if known.onset is not None:
        close = equilibrium_map(model, (0.98 * known.onset, 1.06 * known.onset), ds=0.005)
        oscillating = {letter: _along(side, pairs=True) for letter in ("C", "D") if (side := close[letter])}
    return Result(known, growth, oscillating)


def _along(side: Side, *, pairs: bool) -> tuple[np.ndarray, np.ndarray]:
    """Speeds and largest real parts, of the pairs alone or of all eigenvalues; with the fold at its end."""
    speed = np.concatenate([side.branch.parameter[side.inside], [p.parameter for p in side.folds]])
    values = np.vstack([side.branch.eigenvalues[side.inside], *(p.eigenvalues for p in side.folds)])
    real = np.where(np.imag(values) != 0, np.real(values), -np.inf) if pairs else np.real(values)
    largest = real.max(axis=1)
    order = np.argsort(speed)
    return speed[order], np.where(np.isfinite(largest), largest, np.nan)[order]


def draw(result: Result, figure: Figure) -> Figure:
    """D over the whole range, and the oscillating pair of C and D near the fold."""
    with style.journal(figure, width="double", height=66):
        whole, near = figure.subplots(1, 2, gridspec_kw={"width_ratios": (1.6, 1.0)})
        style.panel(whole, "a", "equilibrium D")
        style.panel(near, "b", "oscillating pair near the fold")
        for axes in (whole, near):
            axes.axhline(0.0, color=style.GREY, linewidth=0.5)
            axes.set_xlabel(style.UNDISTURBED)
        whole.set_ylabel(r"largest real part max Re $\lambda$ (1/s)")
        near.set_ylabel(r"Re $\lambda$ (1/s)")
        whole.set_xlim(result.equilibria.speeds)
        if "D" not in result.growth:
            style.note(whole, "no upper rivulet D in this window")
            near.set_axis_off()
            near.set_title("")
            style.below(figure, result.equilibria.notes, letters=130)
            return figure
        _whole(result, whole)
        _near(result, near)
        style.below(figure, result.equilibria.notes, letters=130)
    return figure


def _whole(result: Result, axes: Axes) -> None:
    speed, growth = result.growth["D"]
    for part, line in ((growth > 0, style.DASHED), (growth <= 0, "-")):
        axes.plot(speed, np.where(part, growth, np.nan), color=style.BLACK, linestyle=line)
    # far from the fold a real eigenvalue or a fast wind may dwarf what matters
    axes.margins(y=0.12)
    onset = result.equilibria.onset
    if onset is not None:
        start = float(growth[0])
        mark(axes, "fold", onset, start)
        unstable = "unstable" if start > 1e-6 else "stable"
        bottom, top = axes.get_ylim()
        part = (start - bottom) / (top - bottom)
        axes.annotate(
            f"fold\n{onset:.2f} m/s:\nD is born\n{unstable}", (onset, start), xytext=(-7, 4 if part > 0.75 else 0),
            textcoords="offset points", ha="right", va="top" if part > 0.75 else "center", fontsize=7,
        )  # fmt: skip
    # of the Hopf points only those where the drawn curve itself crosses zero
    crossed = [p for p in result.hopf_on_d if p.eigenvalues.real.max() < 1e-5]
    for point in crossed:
        mark(axes, "hopf", point.parameter, 0.0)
    names = ["Hopf"] * len(crossed)
    if crossed and np.interp(crossed[-1].parameter * 1.01, speed, growth) < 0:
        names[-1] = r"$U_{{H2}}$"
    low, high = axes.get_xlim()
    for point, name in zip(crossed, names, strict=True):
        # the curve comes down from the left: below it there is room on that side
        right = point.parameter > low + 0.6 * (high - low)
        text = [(point.parameter, 0.0, f"{point.parameter:.2f}")]
        label_points(
            axes,
            text,
            pattern=name + " = {} m/s",
            offset=-4.0 if right else 5.0,
            side="right" if right else "left",
        )


def _near(result: Result, axes: Axes) -> None:
    onset = result.equilibria.onset
    hopf = [p.parameter for p in result.hopf_on_c]
    if onset is None:
        axes.set_axis_off()
        return
    reach = onset + max(0.03 * onset, *(2.5 * (speed - onset) for speed in hopf[:1]), 0.0)
    at = onset + 0.62 * (reach - onset)
    middle = {letter: float(np.interp(at, *pair)) for letter, pair in result.oscillating.items()}
    for letter, color in (("C", style.VERMILION), ("D", style.BLACK)):
        if letter not in result.oscillating:
            continue
        speed, value = result.oscillating[letter]
        offset = 4 if middle[letter] == max(middle.values()) else -9
        shown = speed <= 1.02 * reach
        axes.plot(speed[shown], value[shown], color=color)
        axes.annotate(
            letter, (at, middle[letter]), xytext=(0, offset), textcoords="offset points",
            color=color, fontweight="bold", ha="center",
        )  # fmt: skip
    span = reach - onset
    axes.set_xlim(onset - 0.15 * span, reach)
    axes.margins(y=0.15)
    speed, value = result.oscillating["D"]
    if np.isfinite(value[0]):
        mark(axes, "fold", onset, float(value[0]))
    for point in result.hopf_on_c:
        if point.parameter <= reach:
            mark(axes, "hopf", point.parameter, 0.0, color=style.VERMILION)
            axes.annotate(
                f"Hopf on C,\n{point.parameter:.3f} m/s", (point.parameter, 0.0), xytext=(3, 4),
                textcoords="offset points", fontsize=7, color=style.VERMILION,
            )  # fmt: skip


def tables(result: Result) -> dict[str, Table]:
    """The equilibria with their largest real parts; the oscillating pairs of C and D."""
    found = equilibrium_tables(result.equilibria)
    for letter, (speed, value) in result.oscillating.items():
        found[f"oscillating_{letter}"] = Table(
            {
                "wind_speed": Column(speed, "m/s", "undisturbed wind speed"),
                "real_part": Column(value, "1/s", "largest real part of the eigenvalues that are not real"),
            }
        )
    return found


def summary(result: Result) -> list[str]:
    """Plain sentences: where D begins, its Hopf points, and the notes."""
    known = result.equilibria
    said = known.existence()
    if known.reach is None:
        return [*said, *known.notes]
    at = ", ".join(f"{point.parameter:.2f}" for point in result.hopf_on_d)
    said.append(
        f"Hopf points on D at {at} m/s." if at else f"D has no Hopf point up to {known.speeds[1]:g} m/s."
    )
    return [*said, *known.notes]
