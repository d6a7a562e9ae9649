"""Figure 11 (section 5): the stability limits of D for other rivulet masses, coefficients, and two degrees of freedom.

The masses are ours (0.1, 0.2, 0.3 kg/m). Of the paper's other coefficients, Gu & Lu's (2001), the moment is lost, so
that its curve cannot be reproduced (T14: impossible): shown are our other sets, and Gu & Lu's lift and drag, from
memory, with OUR moment, at h = 6 mm, m_R = 0.08 kg/m, gamma = 45°. With these D is stable above a damping of
0.001 %: no instability of any practical meaning. Tests pin the signs: a lighter rivulet has a lower onset and critical
damping (T12); with two degrees of freedom (y, phi) the onset is the same and the unstable region smaller (T13).
"""

from dataclasses import dataclass, replace
from math import pi
from textwrap import fill

from matplotlib.figure import Figure

from rainwind.io.results import Table
from rainwind.physics.coefficient_files import load_coefficients
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import speed_window
from rainwind.studies.variations import (
    Panel,
    draw_panel,
    highest,
    panel,
    panel_notes,
    panel_summary,
    panel_tables,
    scaled,
)

GU_LU = "Gu & Lu lift and drag,\nour moment"


@dataclass(frozen=True, eq=False)
class Result:
    """The three panels, over the same window of wind speeds (m/s)."""

    mass: Panel
    coefficients: Panel
    degrees_of_freedom: Panel
    speeds: tuple[float, float]

    @property
    def panels(self) -> tuple[Panel, Panel, Panel]:
        """All, in the order of drawing."""
        return self.mass, self.coefficients, self.degrees_of_freedom


def compute(model: RivuletModel | None = None, *, speeds: tuple[float, float] | None = None) -> Result:
    """Diagrams of the variants in one window, by default around the model's own onset."""
    model = model or paper.model()
    speeds = speeds or speed_window(model)
    masses = scaled(model, ["rivulet.mass"], paper.FACTORS_OF_MASS)
    sets = [(model.coefficients.name, model)]
    for name in ("reconstructed", "reconstructed-cubic", "reconstructed-linear"):
        if name != model.coefficients.name:
            sets.append((name, replace(model, coefficients=load_coefficients(name))))
    sets.append((GU_LU, gu_lu_with_our_moment()))
    two = [
        (
            rf"{n} ($y$, $\phi$, $z$)" if n == 3 else rf"{n} ($y$, $\phi$)",
            replace(model, degrees_of_freedom=n),
        )
        for n in (3, 2)
    ]
    return Result(
        panel("mass", r"rivulet mass $m_R$", [(f"{m.rivulet.mass:.3g} kg/m", m) for m in masses], speeds),
        panel("coefficients", "coefficients", sets, speeds),
        panel("degrees_of_freedom", "degrees of freedom", two, speeds),
        speeds,
    )


def gu_lu_with_our_moment() -> RivuletModel:
    """The sample case with Gu & Lu's lift and drag, h = 6 mm, 0.08 kg/m, gamma = 45°, and OUR moment curve.

    No reproduction of the paper's curve: Gu & Lu's moment is lost, their lift and drag are from memory.
    """
    lift_and_drag = load_coefficients("gu-lu-2001-lift-drag")
    ours = load_coefficients("reconstructed")
    changed = replace(paper.model(), coefficients=lift_and_drag.with_moment_of(ours))
    return changed.with_parameters({"rivulet.height": 0.006, "rivulet.mass": 0.08, "wind.yaw": pi / 4})


def draw(result: Result, figure: Figure) -> Figure:
    """Three panels with one scale of damping."""
    with style.journal(figure, width="double", height=76):
        top = highest(result.panels)
        panels = figure.subplots(1, 3, sharey=True, gridspec_kw={"width_ratios": (1.0, 1.35, 1.0)})
        for axes, shown, letter in zip(panels, result.panels, "abc", strict=True):
            draw_panel(axes, shown, result.speeds, top)
            style.panel(axes, letter)
            axes.set_xlabel(r"wind speed $U$ (m/s)")
            if letter == "a":
                axes.set_ylabel(style.DAMPING)
        figure.supxlabel(
            r"$U$ is the undisturbed wind speed. Gu & Lu lift and drag with our moment: $h$ = 6 mm, $m_R$ = 0.08 kg/m, "
            "$\\gamma$ = 45°; not the paper's curve,\nbecause Gu & Lu's moment is lost."
            + "".join("\n" + fill(note, 130) for note in panel_notes(result.panels)),
            fontsize=7.0, x=0.01, ha="left",
        )  # fmt: skip
    return figure


def summary(result: Result) -> list[str]:
    """Plain sentences: fold and critical damping of every variant, and the notes."""
    return panel_summary(result.panels)


def tables(result: Result) -> dict[str, Table]:
    """Every variant's fold, Hopf curves and special points."""
    return panel_tables(result.panels)
