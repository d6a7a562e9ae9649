"""Hopf curves over wind speed and damping, cut into pieces by the equilibrium that they lie on; the fold of D."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rainwind.dynamics.curves import continue_fold, continue_hopf
from rainwind.dynamics.equilibria import continue_equilibria
from rainwind.dynamics.results import Branch, SpecialPoint
from rainwind.errors import ComputationError
from rainwind.studies.equilibrium_map import EquilibriumMap
from rainwind.studies.walks import whole

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


def hopf_curves(
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
            starts += whole(walked).points("hopf")
    until = {ALONG[0]: known.speeds, ALONG[1]: ratios}
    while starts:
        point = starts.pop(0)
        if any(_on_curve(curve, point) for curve in curves):
            continue
        try:
            curve = whole(continue_hopf(known.model, ALONG, start=point, until=until, ds=ds))
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


def pieces_of(known: EquilibriumMap, curve: Branch) -> list[HopfPiece]:
    """A Hopf curve cut at its special points, each piece with the letter of the equilibrium it lies on."""
    found = []
    columns = (*ALONG, *curve.states)
    for others, (speed, ratio, *states) in curve.pieces(*columns):
        i = len(speed) // 2
        letter = known.letter_near(float(speed[i]), np.array([column[i] for column in states]))
        found.append(HopfPiece(letter, speed, ratio, others))
    return found


def fold_curve(known: EquilibriumMap, ratios: tuple[float, float]) -> Branch | None:
    """The curve of the fold in which D begins; None without one."""
    point = known.fold
    if point is None:
        return None
    ratio = point.parameters[ALONG[1]]
    if not ratios[0] <= ratio <= ratios[1]:
        # statics do not depend on damping: the fold is the same at any ratio
        inside = {**point.parameters, ALONG[1]: 0.5 * sum(ratios)}
        point = replace(point, parameters=inside)
    until = {ALONG[0]: known.speeds, ALONG[1]: ratios}
    return whole(continue_fold(known.model, ALONG, start=point, until=until, ds=0.5))


def critical_point(
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
        near = whole(continue_equilibria(at, ALONG[0], start=state, until=window)).points("hopf")
        start = min(near, key=lambda p: abs(p.parameter - speed), default=None)
        if start is None:
            return speed, ratio
        until = {ALONG[0]: window, ALONG[1]: (0.98 * ratio, 1.01 * ratio)}
        fine = whole(continue_hopf(at, ALONG, start=start, until=until))
    except ComputationError:
        return speed, ratio
    return _where_largest(fine), fine.extremum(ALONG[1])


def _where_largest(curve: Branch) -> float:
    """The speed of the largest damping ratio, by a parabola through three points."""
    ratio, speed = curve[ALONG[1]], curve.parameter
    i = min(max(int(ratio.argmax()), 1), len(curve) - 2)
    a, b, _ = np.polyfit(speed[i - 1 : i + 2] - speed[i], ratio[i - 1 : i + 2], 2)
    return float(speed[i] - b / (2 * a))
