"""Where the upper rivulet D is stable: fold, Hopf curves and regions over wind speed and damping, for any model."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rainwind.dynamics.curves import continue_fold, continue_hopf
from rainwind.dynamics.equilibria import continue_equilibria
from rainwind.dynamics.kernels.tangents import jacobians
from rainwind.dynamics.results import Branch, SpecialPoint
from rainwind.dynamics.system import as_system
from rainwind.errors import ComputationError
from rainwind.physics.model import RivuletModel
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import EquilibriumMap, equilibrium_map, speed_window

ALONG = ("wind.speed", "section.damping_ratio")
_SCANNED = (0.03, 0.1, 0.3, 0.65)  # parts of the window of damping at which Hopf points are looked for
_COARSE = 0.1


@dataclass(frozen=True, eq=False)
class HopfPiece:
    """A part of a Hopf curve on one equilibrium: its letter, speeds (m/s) and damping ratios (m,).

    others: number of eigenvalues right of the imaginary axis besides the critical pair; 0 on a stability limit.
    """

    letter: str
    speed: np.ndarray
    ratio: np.ndarray
    others: int


@dataclass(frozen=True, eq=False)
class Field:
    """Linear stability of D on a grid: speed (m,), ratio (k,), growth and count (k, m).

    growth: largest real part of the eigenvalues in 1/s; count: number of eigenvalues with positive real part.
    """

    speed: np.ndarray
    ratio: np.ndarray
    growth: np.ndarray
    count: np.ndarray


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
        fold = _fold_curve(known, ratios)
        hopf = _hopf_curves(known, fold, ratios, letters, ds)
        pieces = [piece for curve in hopf for piece in _pieces(known, curve)]
        if not any(piece.letter == "D" for piece in pieces):
            notes += ("D has no Hopf point in this window",)
    on_d = [float(piece.ratio.max()) for piece in pieces if piece.letter == "D"]
    if grow and on_d and max(on_d) > 0.98 * ratios[1] and ratios[1] < 0.5:
        higher = (ratios[0], 4 * ratios[1])
        return stability_diagram(model, speeds, higher, letters=letters, shape=shape, ds=ds)
    critical = _critical(known, [piece for piece in pieces if piece.letter == "D"], ratios)
    points = _once([*(p for c in hopf for p in c.special), *(fold.special if fold else ())])
    field = _field(known, ratios, shape) if shape and known["D"] else None
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


def _hopf_curves(
    known: EquilibriumMap,
    fold: Branch | None,
    ratios: tuple[float, float],
    letters: Sequence[str],
    ds: float,
) -> list[Branch]:
    """From the Hopf points met at several ratios, from fold-Hopf points, and from the other pair of each Hopf-Hopf."""
    curves: list[Branch] = []
    sides = [side for letter in letters if (side := known[letter]) is not None]
    starts = list(fold.points("zh")) if fold else []
    for branch in {id(side.branch): side.branch for side in sides}.values():
        for part in _SCANNED:
            ratio = ratios[0] + part * (ratios[1] - ratios[0])
            middle = len(branch) // 2
            at = known.model.with_parameters({ALONG[0]: float(branch.parameter[middle]), ALONG[1]: ratio})
            walked = continue_equilibria(
                at, ALONG[0], start=branch.state[middle], until=known.speeds, ds=_COARSE
            )
            starts += walked.points("hopf")
    until = {ALONG[0]: known.speeds, ALONG[1]: ratios}
    while starts:
        point = starts.pop(0)
        if any(_on_curve(curve, point) for curve in curves):
            continue
        try:
            curve = continue_hopf(known.model, ALONG, start=point, until=until, ds=ds)
        except ComputationError:  # a point at the window's very edge
            continue
        curves.append(curve)
        starts += [replace(p, omega=p.omega[::-1]) for p in curve.points("hh") if isinstance(p.omega, tuple)]
    return curves


def _on_curve(curve: Branch, point: SpecialPoint) -> bool:
    """Whether a curve passes the point: same ratio, and there the same speed, state and frequency."""
    for s in curve.at(ALONG[1], point.parameters[ALONG[1]]):
        speed = np.interp(s, curve.arclength, curve.parameter)
        state = [np.interp(s, curve.arclength, column) for column in curve.state.T]
        if abs(speed - point.parameter) < 0.02 * point.parameter and np.allclose(
            state, point.state, atol=0.02
        ):
            i = int(np.argmin(np.abs(curve.arclength - s)))
            critical = curve.eigenvalues[i][np.argmin(np.abs(curve.eigenvalues[i] - 1j * _omega(point)))]
            if abs(critical.real) < 1e-6 * abs(critical):
                return True
    return False


def _omega(point: SpecialPoint) -> float:
    omega = point.omega[0] if isinstance(point.omega, tuple) else point.omega
    return float(omega or 0.0)


def _pieces(known: EquilibriumMap, curve: Branch) -> list[HopfPiece]:
    found = []
    columns = (*ALONG, *curve.states)
    for others, (speed, ratio, *states) in curve.pieces(*columns):
        i = len(speed) // 2
        letter = known.letter_near(float(speed[i]), np.array([column[i] for column in states]))
        found.append(HopfPiece(letter, speed, ratio, others))
    return found


def _fold_curve(known: EquilibriumMap, ratios: tuple[float, float]) -> Branch | None:
    upper = known["D"]
    if upper is None or not upper.folds:
        return None
    point = min(upper.folds, key=lambda p: p.parameter)
    ratio = point.parameters[ALONG[1]]
    if not ratios[0] <= ratio <= ratios[1]:
        # statics do not depend on damping: the fold is the same at any ratio
        inside = {**point.parameters, ALONG[1]: 0.5 * sum(ratios)}
        point = replace(point, parameters=inside)
    return continue_fold(
        known.model, ALONG, start=point, until={ALONG[0]: known.speeds, ALONG[1]: ratios}, ds=0.5
    )


def _critical(
    known: EquilibriumMap, pieces: Sequence[HopfPiece], ratios: tuple[float, float]
) -> tuple[float, float] | None:
    """The top of the Hopf curve on D: coarse from the curve's points, then followed in a narrow window."""
    if not pieces:
        return None
    top = max(pieces, key=lambda piece: float(piece.ratio.max()))
    i = int(top.ratio.argmax())
    speed, ratio = float(top.speed[i]), float(top.ratio[i])
    side = known["D"]
    state = side.at(speed) if side else None
    if i in (0, len(top.ratio) - 1) or state is None:
        return speed, ratio
    window = (max(known.speeds[0], 0.85 * speed), min(known.speeds[1], 1.15 * speed))
    at = known.model.with_parameters({ALONG[0]: speed, ALONG[1]: 0.99 * ratio})
    try:
        near = continue_equilibria(at, ALONG[0], start=state, until=window).points("hopf")
        start = min(near, key=lambda p: abs(p.parameter - speed), default=None)
        if start is None:
            return speed, ratio
        until = {ALONG[0]: window, ALONG[1]: (0.98 * ratio, 1.01 * ratio)}
        fine = continue_hopf(at, ALONG, start=start, until=until)
    except ComputationError:
        return speed, ratio
    return _where_largest(fine), fine.extremum(ALONG[1])


def _where_largest(curve: Branch) -> float:
    """The speed of the largest damping ratio, by a parabola through three points."""
    ratio, speed = curve[ALONG[1]], curve.parameter
    i = min(max(int(ratio.argmax()), 1), len(curve) - 2)
    a, b, _ = np.polyfit(speed[i - 1 : i + 2] - speed[i], ratio[i - 1 : i + 2], 2)
    return float(speed[i] - b / (2 * a))


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


def _field(known: EquilibriumMap, ratios: tuple[float, float], shape: tuple[int, int]) -> Field | None:
    side = known["D"]
    if side is None:
        return None
    speeds, states = side.states()
    # even in arclength near the fold, where the state moves fast, and even in speed elsewhere
    part = np.linspace(0.0, 1.0, shape[0])
    speed = speeds[0] + (speeds[-1] - speeds[0]) * part * (0.3 + 0.7 * part)
    state = np.array([np.interp(speed, speeds, column) for column in states.T]).T
    low, high = ratios
    ratio = np.geomspace(low, high, shape[1]) if low > 0 else np.linspace(low, high, shape[1])
    system = as_system(known.model)
    inputs = system.inputs(np.tile(state, (len(ratio), 1)))
    inputs[:, system.number(ALONG[0])] = np.tile(speed, len(ratio))
    inputs[:, system.number(ALONG[1])] = np.repeat(ratio, len(speed))
    matrices = jacobians(*system.tape.arrays, inputs, np.arange(len(system.states)))[1]
    values = np.linalg.eigvals(matrices).real.reshape(len(ratio), len(speed), -1)
    # the fold's own zero eigenvalue says nothing about its sides
    values[np.abs(values) < 1e-7] = -np.inf
    return Field(speed, ratio, values.max(axis=-1), np.sum(values > 0, axis=-1))
