"""Where the upper rivulet D is stable: fold, Hopf curves and regions over wind speed and damping, for any model."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rainwind.dynamics.results import Branch, SpecialPoint
from rainwind.dynamics.system import as_system
from rainwind.physics.model import RivuletModel
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import EquilibriumMap, equilibrium_map, speed_window
from rainwind.studies.hopf_curves import ALONG, HopfPiece, critical_point, fold_curve, hopf_curves, pieces_of
from rainwind.studies.stability_field import Field, stability_field


@dataclass(frozen=True, eq=False)
class StabilityDiagram:
    """Linear stability over undisturbed wind speed (m/s) and damping ratio.

    fold: the curve on which D is born, None where no D is. hopf: whole curves; pieces: the same, cut where they pass
    from one equilibrium to another. points: zh, hh, gh, bt, once each. critical: speed and ratio of the highest
    point of the Hopf curve on D. cycle_curves: bifurcations of limit cycles, none in the linear theory.
    """

    model: RivuletModel
    speeds: tuple[float, float]
    ratios: tuple[float, float]
    equilibria: EquilibriumMap
    fold: Branch | None
    hopf: tuple[Branch, ...]
    pieces: tuple[HopfPiece, ...]
    points: tuple[SpecialPoint, ...]
    critical: tuple[float, float] | None
    field: Field | None
    notes: tuple[str, ...] = ()
    cycle_curves: tuple[Branch, ...] = ()

    @property
    def onset(self) -> float | None:
        """The speed above which D exists, m/s."""
        return self.equilibria.onset

    def hopf_speeds(self, ratio: float, letter: str = "D") -> tuple[float, ...]:
        """The speeds of the Hopf points of one equilibrium at a damping ratio, interpolated on the curves."""
        found = [
            float(
                piece.speed[i] + (ratio - piece.ratio[i]) / np.diff(piece.ratio)[i] * np.diff(piece.speed)[i]
            )
            for piece in self.pieces
            if piece.letter == letter
            for i in np.flatnonzero(np.diff(np.sign(piece.ratio - ratio)))
        ]
        return tuple(sorted(found))

    def unstable_at_end(self, ratio: float) -> bool:
        """Whether D, at the highest wind speed of the window, is unstable at this damping ratio."""
        side = self.equilibria["D"]
        if side is None:
            return False
        speeds, states = side.states()
        end = {ALONG[0]: float(speeds[-1]), ALONG[1]: ratio}
        values = np.linalg.eigvals(as_system(self.model).jacobian(states[-1], end))
        return bool(values.real.max() > 0)

    def audit(self) -> list[str]:
        """What the branches and curves say against themselves."""
        curves = [*self.equilibria.branches, *self.hopf, *([self.fold] if self.fold else [])]
        return [fault for curve in curves for fault in curve.audit()]


def stability_diagram(
    model: RivuletModel,
    speeds: tuple[float, float] | None = None,
    ratios: tuple[float, float] = paper.RATIOS,
    *,
    letters: Sequence[str] = ("C", "D"),
    shape: tuple[int, int] | None = (160, 100),
    ds: float = 0.05,
    grow: bool = True,
) -> StabilityDiagram:
    """The diagram of one model; `speeds` are chosen around its onset if left out.

    Hopf curves start from all Hopf points that the branches of `letters` pass at several damping ratios. shape:
    points of the field in speed and ratio, None for no field. grow: raise the window's top, fourfold
    and no more than to critical damping, while the Hopf curve of D leaves through it. A model without D gives a
    diagram that says so.
    """
    model, notes = _one_ratio(model)
    speeds = speeds or speed_window(model)
    known = equilibrium_map(model, speeds)
    hopf, pieces, fold = [], [], None
    if known["D"] is None:
        notes += (f"no upper rivulet D between {speeds[0]:g} and {speeds[1]:g} m/s",)
    else:
        fold = fold_curve(known, ratios)
        hopf = hopf_curves(known, fold, ratios, letters, ds)
        pieces = [piece for curve in hopf for piece in pieces_of(known, curve)]
        if not any(piece.letter == "D" for piece in pieces):
            notes += ("D has no Hopf point in this window",)
    on_d = [float(piece.ratio.max()) for piece in pieces if piece.letter == "D"]
    if grow and on_d and max(on_d) > 0.98 * ratios[1] and ratios[1] < 0.5:
        higher = (ratios[0], 4 * ratios[1])
        return stability_diagram(model, speeds, higher, letters=letters, shape=shape, ds=ds)
    critical = critical_point(known, [piece for piece in pieces if piece.letter == "D"], ratios)
    points = _once([*(p for c in hopf for p in c.special), *(fold.special if fold else ())])
    field = stability_field(known, ratios, shape) if shape and known["D"] else None
    return StabilityDiagram(
        model, speeds, ratios, known, fold, tuple(hopf), tuple(pieces), points, critical, field, notes
    )


def _one_ratio(model: RivuletModel) -> tuple[RivuletModel, tuple[str, ...]]:
    """The diagram varies one damping ratio: those set apart for y and z give way, and a note says so."""
    section = model.section
    if section.damping_ratio_y is None and section.damping_ratio_z is None:
        return model, ()
    together = replace(section, damping_ratio_y=None, damping_ratio_z=None)
    return replace(model, section=together), ("one damping ratio for y and z, unlike in the case",)


def _once(points: Sequence[SpecialPoint]) -> tuple[SpecialPoint, ...]:
    found: list[SpecialPoint] = []
    for point in points:
        same = [p for p in found if p.kind == point.kind]
        if not any(
            np.allclose([p.parameters[n] for n in ALONG], [point.parameters[n] for n in ALONG], rtol=1e-5)
            for p in same
        ):
            found.append(point)
    return tuple(found)
