"""Stability limits of one model and its variants in one diagram: what figures 10 and 11 are made of."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from rainwind.io.results import Table
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.regions import draw_fold
from rainwind.studies.branch_tables import diagram_tables
from rainwind.studies.stability_diagram import StabilityDiagram, stability_diagram

PERCENT = 100.0
RATIOS = (0.0, 0.02)


@dataclass(frozen=True, eq=False)
class Variant:
    """One model of a panel: what the legend calls it, and its diagram."""

    label: str
    diagram: StabilityDiagram

    @property
    def onset(self) -> float | None:
        """The fold's speed, m/s."""
        return self.diagram.onset

    @property
    def critical_damping(self) -> float | None:
        """The largest damping ratio at which D loses stability; None where it never does."""
        return self.diagram.critical[1] if self.diagram.critical else None

    def width(self, ratio: float) -> float:
        """From the fold to the upper Hopf point of D at a damping ratio, m/s; 0 where D is stable.

        NaN where D is unstable up to the window's end.
        """
        hopf = self.diagram.hopf_speeds(ratio)
        if self.onset is None or not hopf:
            return 0.0
        side = self.diagram.equilibria["D"]
        unstable = side is not None and self.diagram.unstable_at_end(ratio)
        return float("nan") if unstable else hopf[-1] - self.onset


@dataclass(frozen=True, eq=False)
class Panel:
    """Variants drawn together: a title and the parameter that differs."""

    name: str
    title: str
    variants: tuple[Variant, ...]


def panel(
    name: str,
    title: str,
    models: Sequence[tuple[str, RivuletModel]],
    speeds: tuple[float, float],
    ratios: tuple[float, float] = RATIOS,
) -> Panel:
    """The diagrams of labelled models in one window."""
    return Panel(name, title, tuple(Variant(label, _diagram(m, speeds, ratios)) for label, m in models))


@lru_cache(maxsize=32)
def _diagram(
    model: RivuletModel, speeds: tuple[float, float], ratios: tuple[float, float]
) -> StabilityDiagram:
    # the model itself stands in every panel
    return stability_diagram(model, speeds, ratios, shape=None)


def scaled(model: RivuletModel, names: Sequence[str], factors: Sequence[float]) -> list[RivuletModel]:
    """Copies with the parameters times each factor."""
    own = model.parameters
    return [model.with_parameters({name: factor * own[name] for name in names}) for factor in factors]


def draw_panel(axes: Axes, shown: Panel, speeds: tuple[float, float], top: float) -> Axes:
    """Fold up to where the region of instability leaves it, Hopf curves of D, one line style for each variant."""
    for variant, color, line in zip(shown.variants, style.CYCLE, style.LINES, strict=False):
        diagram = variant.diagram
        limits = [p for p in diagram.pieces if p.letter == "D" and p.others == 0]
        drawn = axes.plot([], [], color=color, linestyle=line, label=variant.label)[0]
        if variant.onset is None:
            drawn.set_label(f"{variant.label}: no D here")
            continue
        critical = PERCENT * (variant.critical_damping or 0.0)
        if critical < 0.01 * top:
            above = f"above about {critical:.1g} %" if critical else "at every damping"
            drawn.set_linestyle(style.DASH_DOTTED)
            drawn.set_label(f"{variant.label}\n(fold; D stable {above})")
            draw_fold(axes, variant.onset, 0.0, top, color=color)
            continue
        for piece in limits:
            speed, ratio = piece.speed, PERCENT * piece.ratio
            if min(speed[0], speed[-1]) < variant.onset * (1 + 1e-6):
                # the region's edge goes on down the fold, in one stroke
                order = slice(None) if speed[0] < speed[-1] else slice(None, None, -1)
                speed = np.concatenate([[variant.onset], speed[order]])
                ratio = np.concatenate([[0.0], ratio[order]])
            axes.plot(speed, ratio, color=color, linestyle=line)
    axes.set(xlim=speeds, ylim=(0.0, top), xlabel=style.UNDISTURBED)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.legend(loc="upper right", borderaxespad=0.3, title=shown.title, title_fontsize=7.0, alignment="left")
    return axes


def highest(panels: Sequence[Panel]) -> float:
    """The top of the axes in per cent: a little above every critical damping, 1 % if there is none."""
    found = [v.critical_damping for p in panels for v in p.variants if v.critical_damping is not None]
    return float(np.ceil(PERCENT * max(found) * 12) / 10) if found else 1.0


def panel_notes(panels: Sequence[Panel]) -> list[str]:
    """What a reader must know of the variants' D, each once; what the legend says is left out."""
    diagrams = [variant.diagram for shown in panels for variant in shown.variants]
    notes = [
        note
        for diagram in diagrams
        for note in diagram.notes
        if "is not D" not in note and not note.startswith(("no upper rivulet", "D has no Hopf"))
    ]
    beyond = sum(any("is not D" in note for note in diagram.notes) for diagram in diagrams)
    if beyond:
        notes.append(
            f"in {beyond} of {len(diagrams)} diagrams another equilibrium lies outside the coefficients' range; "
            "it is not D"
        )
    return list(dict.fromkeys(notes))


def panel_summary(panels: Sequence[Panel]) -> list[str]:
    """Plain sentences: fold and critical damping of every variant, and the notes."""
    said = []
    for shown in panels:
        for variant in shown.variants:
            label = " ".join(variant.label.replace("$", "").replace("\\phi", "phi").split())
            critical = variant.critical_damping
            limit = (
                f"critical damping {PERCENT * critical:.3g} %"
                if critical is not None
                else "no Hopf point on D"
            )
            begins = (
                f"fold {variant.onset:.2f} m/s, {limit}" if variant.onset is not None else "no fold of D here"
            )
            said.append(f"{shown.name.replace('_', ' ')}, {label}: {begins}.")
    return [*said, *(f"{note[0].upper()}{note[1:]}." for note in panel_notes(panels))]


def panel_tables(panels: Sequence[Panel]) -> dict[str, Table]:
    """The tables of every variant's diagram, as panel_number_table."""
    return {
        f"{shown.name}_{number}_{name}": Table(
            table.columns, {**table.attributes, "variant": " ".join(variant.label.split())}
        )
        for shown in panels
        for number, variant in enumerate(shown.variants, 1)
        for name, table in diagram_tables(variant.diagram).items()
    }
