"""Where the upper rivulet D is stable: fold, Hopf curves and regions over wind speed and damping, for any model."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from rainwind.dynamics.results import Branch, SpecialPoint
from rainwind.dynamics.system import as_system
from rainwind.physics.model import RivuletModel
from rainwind.studies import paper
from rainwind.studies.cycle_curves import CycleCurves
from rainwind.studies.equilibrium_map import EquilibriumMap, equilibrium_map, speed_window
from rainwind.studies.hopf_curves import ALONG, HopfPiece, critical_point, fold_curve, hopf_curves, pieces_of
from rainwind.studies.stability_field import Field, stability_field

DAMPING_ALIKE = r"damping ratio $\xi$, the same in y and z (%)"


@dataclass(frozen=True, eq=False)
class StabilityDiagram:
    """Linear stability over undisturbed wind speed (m/s) and damping ratio.

    model: with one damping ratio for y and z, which is varied; case: the model as given.

    fold: the curve on which D is born, None where no D is. hopf: whole curves; pieces: the same, cut where they pass
    from one equilibrium to another. points: zh, hh, gh, bt, once each. critical: speed and ratio of the highest
    point of the Hopf curve on D. cycle_curves: bifurcations of limit cycles, where they were asked for.
    """

    model: RivuletModel
    case: RivuletModel
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
    cycle_curves: CycleCurves | None = None

    @property
    def onset(self) -> float | None:
        """The speed above which D exists, m/s."""
        return self.equilibria.onset

    @property
    def reach(self) -> tuple[float, float] | None:
        """The speeds between which D is there, inside the coefficients' range, m/s; the field's span."""
        return self.equilibria.reach

    @property
    def own_ratio(self) -> float | None:
        """The case's damping ratio; None where it has two, for y and z."""
        return self.case.section.damping_ratio if self.case == self.model else None

    @property
    def reaches_end(self) -> bool:
        """Whether D is there, inside the coefficients' range, up to the window's highest speed."""
        return self.reach is not None and self.reach[1] > self.speeds[1] - 1e-9

    @property
    def why_it_ends(self) -> str:
        """What is beyond `reach`, in a few words for a diagram."""
        side = self.equilibria["D"]
        goes_on = side is not None and self.reach is not None and side.states()[0][-1] > self.reach[1] + 1e-9
        return "outside the\ncoefficients'\nrange" if goes_on else "no\nequilibrium\nD"

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
        """Whether D, at the highest wind speed of the window, is there and unstable at this damping ratio."""
        side = self.equilibria["D"]
        if side is None or not self.reaches_end:
            return False
        end = {ALONG[0]: self.speeds[1], ALONG[1]: ratio}
        values = np.linalg.eigvals(as_system(self.model).jacobian(side.states()[1][-1], end))
        return bool(values.real.max() > 0)

    def audit(self) -> list[str]:
        """What the branches and curves say against themselves."""
        curves = [*self.equilibria.branches, *self.hopf, *([self.fold] if self.fold else [])]
        cycles = self.cycle_curves.audit() if self.cycle_curves is not None else []
        return [fault for curve in curves for fault in curve.audit()] + cycles


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
    case = model
    model, notes = _one_ratio(case)
    speeds = speeds or speed_window(model)
    known = equilibrium_map(model, speeds)
    notes += known.notes
    hopf, pieces, fold = [], [], None
    if known["D"] is None:
        notes += (f"no upper rivulet D between {speeds[0]:g} and {speeds[1]:g} m/s",)
    else:
        fold = fold_curve(known, ratios)
        hopf = hopf_curves(known, fold, ratios, letters, ds)
        pieces = _distinct([piece for curve in hopf for piece in pieces_of(known, curve)])
        if not any(piece.letter == "D" for piece in pieces):
            notes += ("D has no Hopf point in this window",)
    on_d = [float(piece.ratio.max()) for piece in pieces if piece.letter == "D"]
    if grow and on_d and max(on_d) > 0.98 * ratios[1] and ratios[1] < 0.5:
        higher = (ratios[0], 4 * ratios[1])
        return stability_diagram(case, speeds, higher, letters=letters, shape=shape, ds=ds)
    critical = critical_point(known, [piece for piece in pieces if piece.letter == "D"], ratios)
    points = _once([*(p for c in hopf for p in c.special), *(fold.special if fold else ())])
    field = stability_field(known, ratios, shape) if shape and known["D"] else None
    return StabilityDiagram(
        model, case, speeds, ratios, known, fold, tuple(hopf), tuple(pieces), points, critical, field, notes
    )


def _one_ratio(model: RivuletModel) -> tuple[RivuletModel, tuple[str, ...]]:
    """The diagram varies one damping ratio: those set apart for y and z give way, and a note says so."""
    section = model.section
    if section.damping_ratio_y is None and section.damping_ratio_z is None:
        return model, ()
    together = replace(section, damping_ratio_y=None, damping_ratio_z=None)
    y, z = (
        100 * (section.damping_ratio if own is None else own)
        for own in (section.damping_ratio_y, section.damping_ratio_z)
    )
    note = f"varied here: one damping ratio, the same for y and z; the case itself has {y:.3g} % in y, {z:.3g} % in z"
    return replace(model, section=together), (note,)


def _distinct(pieces: Sequence[HopfPiece]) -> list[HopfPiece]:
    """Each piece once: two Hopf curves that cross near a 1:1 resonance may end on the same one of them."""
    found: list[HopfPiece] = []
    for piece in pieces:
        alike = [p for p in found if (p.letter, p.others) == (piece.letter, piece.others)]
        if not any(np.allclose(_corners(p), _corners(piece), rtol=1e-4, atol=1e-7) for p in alike):
            found.append(piece)
    return found


def _corners(piece: HopfPiece) -> list[float]:
    """Both ends of a piece, the slower first, and its highest damping ratio."""
    ends = sorted((float(piece.speed[k]), float(piece.ratio[k])) for k in (0, -1))
    return [*ends[0], *ends[1], float(piece.ratio.max())]


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


def sentences(diagram: StabilityDiagram) -> list[str]:
    """The diagram in plain sentences: fold, critical damping, where D is unstable at the case's damping, notes."""
    low, high = diagram.speeds
    notes = [f"{note[0].upper()}{note[1:]}." for note in diagram.notes]
    if diagram.reach is None:
        return notes or [f"There is no upper rivulet D between {low:g} and {high:g} m/s."]
    said = []
    if diagram.onset is not None:
        said.append(f"The upper rivulet D exists above {diagram.onset:.2f} m/s (fold).")
    else:
        said.append(
            f"The upper rivulet D exists from {diagram.reach[0]:.4g} m/s on, the start of this window."
        )
    if diagram.critical is not None:
        speed, ratio = diagram.critical
        said.append(f"Critical damping: {100 * ratio:.3f} %, at {speed:.2f} m/s; above it D is stable here.")
    own = diagram.own_ratio
    damping = f"{100 * own:.3g} %" if own is not None else "apart in y and z"
    what = f"At the case's damping, {damping},"
    ranges = [f"{a:.2f} to {b:.2f} m/s" for a, b in unstable_speeds(diagram)]
    if ranges:
        said.append(f"{what} D is unstable from {' and from '.join(ranges)} (looked at up to {high:g} m/s).")
    else:
        said.append(f"{what} D is stable at every speed up to {diagram.reach[1]:.4g} m/s.")
    return said + notes


def unstable_speeds(diagram: StabilityDiagram) -> list[tuple[float, float]]:
    """The ranges of speeds at which D is unstable with the case's own damping, between Hopf points, m/s."""
    known = diagram.equilibria
    if diagram.own_ratio is None:  # apart in y and z: the case's own walk
        known = equilibrium_map(diagram.case, diagram.speeds)
    side, reach = known["D"], known.reach
    if side is None or reach is None:
        return []
    hopf = [p.parameter for p in side.points("hopf") if reach[0] < p.parameter < reach[1]]
    cuts = [reach[0], *hopf, reach[1]]
    speed = side.branch.parameter[side.inside]
    unstable = side.branch.unstable[side.inside]
    found: list[tuple[float, float]] = []
    for a, b in pairwise(cuts):
        if unstable[np.argmin(np.abs(speed - 0.5 * (a + b)))] == 0:
            continue
        if found and found[-1][1] == a:
            found[-1] = (found[-1][0], b)
        else:
            found.append((a, b))
    return found
