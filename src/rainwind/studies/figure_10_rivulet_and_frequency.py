"""Figure 10 (section 5): the stability limits of D for three rivulet frictions and three frequencies of the cable.

The paper's values are not in its text: ours are half, one and two times the sample case's, d_phi = 0.025, 0.05, 0.1 Nms
per metre and f = 0.5, 1, 2 Hz, in both directions. Tests pin the signs: more friction gives a wider range of speeds, a
lower critical damping and the same onset (T10); the onset does not depend on the frequency (T11).
"""

from dataclasses import dataclass

from matplotlib.figure import Figure

from rainwind.io.results import Table
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


@dataclass(frozen=True, eq=False)
class Result:
    """The two panels, over the same window of wind speeds (m/s)."""

    friction: Panel
    frequency: Panel
    speeds: tuple[float, float]


def compute(model: RivuletModel | None = None, *, speeds: tuple[float, float] | None = None) -> Result:
    """Diagrams of the variants in one window, by default around the model's own onset."""
    model = model or paper.model()
    speeds = speeds or speed_window(model)
    frictions = scaled(model, ["rivulet.friction"], paper.FACTORS_OF_FRICTION)
    both = ["section.frequency_y", "section.frequency_z"]
    frequencies = scaled(model, both, paper.FACTORS_OF_FREQUENCY)
    return Result(
        panel(
            "friction", r"rivulet friction $d_\phi$",
            [(f"{m.rivulet.friction:.3g} Nms per metre", m) for m in frictions], speeds,
        ),
        panel("frequency", r"frequency of the cable", [(_frequency(m), m) for m in frequencies], speeds),
        speeds,
    )  # fmt: skip


def _frequency(model: RivuletModel) -> str:
    y, z = model.section.frequency_y, model.section.frequency_z
    return f"{y:.3g} Hz" if y == z else f"{y:.3g} Hz (y), {z:.3g} Hz (z)"


def draw(result: Result, figure: Figure) -> Figure:
    """Two panels side by side."""
    with style.journal(figure, width="double", height=72):
        left, right = figure.subplots(1, 2)
        for axes, shown, letter in ((left, result.friction, "a"), (right, result.frequency, "b")):
            draw_panel(axes, shown, result.speeds, highest([shown]))
            style.panel(axes, letter)
            axes.set_ylabel(style.DAMPING)
        style.below(figure, panel_notes([result.friction, result.frequency]), letters=130)
    return figure


def summary(result: Result) -> list[str]:
    """Plain sentences: fold and critical damping of every variant, and the notes."""
    return panel_summary([result.friction, result.frequency])


def tables(result: Result) -> dict[str, Table]:
    """Every variant's fold, Hopf curves and special points."""
    return panel_tables([result.friction, result.frequency])
