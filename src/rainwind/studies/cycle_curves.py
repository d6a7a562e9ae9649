"""Curves of folds of cycles, Neimark-Sacker points and period doublings over wind speed and damping (section 5).

They start from the labelled cycles of the branches born at C's and D's Hopf points, walked at several damping ratios,
for an isolated curve meets no other. Each curve is walked once. Cycles that close after several periods of the cable
are left out.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.diagram_results import same_point
from rainwind.dynamics.orbit_curves import continue_lpc, continue_ns, continue_pd
from rainwind.dynamics.orbit_results import OrbitBranch, OrbitPoint
from rainwind.dynamics.orbits import continue_orbits
from rainwind.dynamics.results import Ended, SpecialPoint, pieces_between
from rainwind.errors import RainwindError
from rainwind.physics.model import RivuletModel
from rainwind.studies.equilibrium_map import equilibrium_map
from rainwind.studies.hopf_curves import ALONG
from rainwind.studies.walks import whole

SPEED, RATIO = ALONG
# the same curves and points as with 60 intervals and half the steps, see docs/paper.md
MESH, STEP = Mesh(30), 0.2
STEPS = {"lpc": 0.1, "ns": 0.1, "pd": 0.2}  # along the curves
SCANNED = (
    0.03,
    0.0435,
    0.072,
    0.135,
    0.245,
    0.6,
)  # parts of the critical damping at which branches are walked
CONTINUE = {"lpc": continue_lpc, "ns": continue_ns, "pd": continue_pd}
_KEPT = 8
_MORE, _BELOW = 4, 0.02  # rows added below points where a fold is missing, by this part of their ratio
_LIMIT = 800  # points a direction
_SAME_SPEED, _SAME_SIZE, _SAME_PERIOD = 2e-3, 0.05, 1e-3  # of the window, of the size, of the period
_SAME_POINT = 1e-3  # of the curves' extent
_NEAR = 0.35  # of the curves' extent and of the size: an ns curve ends in a resonance no farther than this

Progress = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Row:
    """The branches of cycles at one damping ratio, from the Hopf points of C and D."""

    ratio: float
    branches: tuple[OrbitBranch, ...]

    def points(self, kind: str) -> tuple[OrbitPoint, ...]:
        """The labelled cycles of one kind, by rising speed."""
        found = (p for branch in self.branches for p in branch.points(kind))
        return tuple(sorted(found, key=lambda p: p.parameter))


@dataclass(frozen=True, eq=False)
class CycleCurves:
    """Every curve found, kind lpc, ns or pd, and the rows they were started from, by rising damping.

    notes: what could not be started, in sentences.
    """

    rows: tuple[Row, ...]
    curves: tuple[OrbitBranch, ...]
    notes: tuple[str, ...] = ()

    def of(self, kind: str) -> tuple[OrbitBranch, ...]:
        """The curves of one kind."""
        return tuple(curve for curve in self.curves if curve.kind == kind)

    def points(self, kind: str | None = None) -> tuple[OrbitPoint, ...]:
        """The codimension-2 points, each once, by rising speed.

        A 1:1 resonance comes from the fold curve that it lies on: from the ns curve it is only extrapolated.
        """
        found = []
        for curve in self.curves:
            for point in curve.special:
                if kind not in (None, point.kind) or not isinstance(point, OrbitPoint):
                    continue
                if curve.kind == "ns" and point.kind == "r1" and self.resonance_at(point):
                    continue
                if not any(self._same(point, other) for other in found):
                    found.append(point)
        return tuple(sorted(found, key=lambda p: p.parameter))

    def _same(self, a: OrbitPoint, b: OrbitPoint) -> bool:
        """Whether two labels stand for one point, met on two curves."""
        width = [float(np.ptp(np.concatenate([c[name] for c in self.curves]))) or 1.0 for name in ALONG]
        apart = [abs(a.parameters[n] - b.parameters[n]) / w for n, w in zip(ALONG, width, strict=True)]
        sizes = [p.orbit.amplitude["y"] for p in (a, b)]
        return (
            a.kind == b.kind and max(apart) < _SAME_POINT and np.ptp(sizes) < _SAME_SIZE * max(*sizes, 1e-9)
        )

    def resonance_at(self, end: OrbitPoint) -> OrbitPoint | None:
        """The 1:1 resonance on a fold curve in which an ns curve ends; None if none is near."""
        return next((true for one, true in self._resonances if one is end), None)

    @cached_property
    def _resonances(self) -> list[tuple[OrbitPoint, OrbitPoint]]:
        """Each extrapolated end of an ns curve with the resonance nearest to it, each taken once, nearest first."""
        if not self.curves:
            return []
        width = [float(np.ptp(np.concatenate([c[name] for c in self.curves]))) or 1.0 for name in ALONG]
        size = max(float(c["y"].max()) for c in self.curves)

        def place(point: OrbitPoint) -> np.ndarray:
            at = [point.orbit.parameters[name] / w for name, w in zip(ALONG, width, strict=True)]
            return np.array([*at, point.orbit.amplitude["y"] / size])

        ends = [p for c in self.of("ns") for p in c.special if isinstance(p, OrbitPoint) and p.kind == "r1"]
        known = [p for c in self.of("lpc") for p in c.points("r1")]
        gaps = sorted(
            (float(np.linalg.norm(place(end) - place(point))), i, k)
            for i, end in enumerate(ends)
            for k, point in enumerate(known)
        )
        taken: dict[int, int] = {}
        for gap, i, k in gaps:
            if gap < _NEAR and i not in taken and k not in taken.values():
                taken[i] = k
        return [(ends[i], known[k]) for i, k in taken.items()]

    def pieces(self, curve: OrbitBranch) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
        """A curve cut at its points: (multipliers outside besides the critical, speeds, ratios), drawn to its ends."""
        cuts = [p for p in curve.special if isinstance(p, OrbitPoint)]
        at_cuts = [[p.parameters[name] for name in ALONG] for p in cuts]
        columns = [curve[name] for name in ALONG]
        places = [p.arclength for p in cuts]
        found = list(pieces_between(curve.arclength, _others(curve), places, at_cuts, columns))
        for k, end in ((0, curve.ended[0]), (-1, curve.ended[1])):
            point = curve.special[k] if curve.special else None
            if end is Ended.AT_RESONANCE and isinstance(point, OrbitPoint):
                true = self.resonance_at(point)
                for column, name in zip(found[k][1], ALONG, strict=True):
                    column[k] = column[k] if true is None else true.parameters[name]
        yield from ((count, speed, ratio) for count, (speed, ratio) in found)

    def soft(self, curve: OrbitBranch) -> list[bool | None]:
        """Of each piece of an ns curve, whether tori are born stable on it (supercritical); None where unknown.

        From the coefficient at one cycle of the rows; it changes its sign at ch.
        """
        cuts = [p for p in curve.special if isinstance(p, OrbitPoint)]
        found: list[bool | None] = [None] * len(list(self.pieces(curve)))
        known = [p for row in self.rows for p in row.points("ns") if np.isfinite(p.coefficient or np.nan)]
        at = next(((p, s) for p in known if (s := place_on(curve, p)) is not None), None)
        if curve.kind != "ns" or at is None:
            return found
        point, s = at
        here = int(np.sum([cut.arclength < s for cut in cuts])) - int(bool(cuts) and cuts[0].arclength <= 0.0)
        for k in range(len(found)):
            low, high = sorted((k, here))
            between = cuts[int(bool(cuts) and cuts[0].arclength <= 0.0) :][low:high]
            turned = sum(cut.kind == "ch" for cut in between) % 2 == 1
            found[k] = ((point.coefficient or 0.0) < 0) != turned
        return found

    def audit(self) -> list[str]:
        """What the curves say against themselves, and what could not be started."""
        return [fault for curve in self.curves for fault in curve.audit()] + list(self.notes)


def _others(curve: OrbitBranch) -> np.ndarray:
    """The number of multipliers outside the circle (N,) besides those that the curve holds on it, to rounding."""
    held = 2 if curve.kind == "ns" else 1
    real = np.take_along_axis(
        curve.exponents.real, np.argsort(np.abs(curve.exponents.real), axis=1)[:, held:], axis=1
    )
    return np.sum(real > 0, axis=1)


_found: dict[tuple[Any, ...], CycleCurves] = {}


def cycle_curves(
    model: RivuletModel,
    speeds: tuple[float, float],
    ratios: tuple[float, float],
    scanned: Sequence[float],
    *,
    mesh: Mesh = MESH,
    finer: float = 1.0,
    progress: Progress | None = None,
) -> CycleCurves:
    """The curves in a window of speeds (m/s) and damping ratios, from branches at the ratios `scanned`.

    Computed once for a model and a window, and then remembered. finer: divides all steps. progress: told what is
    done next, in words.
    """
    at = tuple(sorted({float(ratio) for ratio in scanned if ratios[0] < ratio < ratios[1]}))
    key = (model, speeds, ratios, at, mesh, finer)
    if key not in _found:
        while len(_found) >= _KEPT:
            del _found[next(iter(_found))]
        _found[key] = _cycle_curves(model, speeds, ratios, at, mesh, finer, progress or (lambda what: None))
    return _found[key]


def _cycle_curves(
    model: RivuletModel,
    speeds: tuple[float, float],
    ratios: tuple[float, float],
    scanned: Sequence[float],
    mesh: Mesh,
    finer: float,
    progress: Progress,
) -> CycleCurves:
    rows: list[Row] = []
    curves: list[tuple[OrbitPoint, OrbitBranch]] = []
    notes: list[str] = []
    until = {SPEED: speeds, RATIO: ratios}
    # from the highest damping: there the curves are long and few
    queue = sorted(scanned, reverse=True)
    more = _MORE
    while queue:
        ratio = queue.pop(0)
        progress(f"limit cycles at {100 * ratio:.3g} % damping")
        row = Row(ratio, tuple(_branches(model, speeds, ratio, mesh, STEP / finer, notes)))
        rows.append(row)
        for kind, follow in CONTINUE.items():
            for point in row.points(kind):
                if any(passes(curve, point, speeds) for _, curve in curves):
                    continue
                progress(f"{kind} curve from {point.parameter:.2f} m/s, {100 * ratio:.3g} %")
                try:
                    ds = STEPS[kind] / finer
                    curve = whole(follow(model, ALONG, start=point, until=until, ds=ds, limit=_LIMIT))
                except (RainwindError, np.linalg.LinAlgError) as error:
                    notes.append(f"{kind} at {point.parameter:.4f} m/s, {100 * ratio:.4g} %: {error}")
                    continue
                if not any(passes(curve, start, speeds) for start, _ in curves):
                    curves.append((point, curve))
        if not queue and more:
            walked = [one.ratio for one in rows]
            missed = _without_fold([curve for _, curve in curves], speeds)
            queue = [r for r in missed if all(abs(r / other - 1.0) > _BELOW for other in walked)][:1]
            more -= 1
    rows.sort(key=lambda one: one.ratio)
    return CycleCurves(tuple(rows), tuple(curve for _, curve in curves), tuple(notes))


def _without_fold(curves: Sequence[OrbitBranch], speeds: tuple[float, float]) -> list[float]:
    """Ratios just below points at which a fold of cycles meets an ns or pd curve, but no lpc curve was found there."""
    folds = [curve for curve in curves if curve.kind == "lpc"]
    points = [
        p for c in curves if c.kind in ("ns", "pd") for p in c.points() if p.kind in ("lpns", "foldflip")
    ]
    return sorted(
        (1.0 - _BELOW) * p.parameters[RATIO]
        for p in points
        if not any(passes(fold, replace(p, kind="lpc"), speeds) for fold in folds)
    )[::-1]


def _branches(
    model: RivuletModel,
    speeds: tuple[float, float],
    ratio: float,
    mesh: Mesh,
    step: float,
    notes: list[str],
) -> Iterator[OrbitBranch]:
    """The branches of cycles from the Hopf points of C and D, each once."""
    at = model.with_parameters({RATIO: ratio})
    known = equilibrium_map(at, speeds)
    hopf = [p for letter in ("C", "D") if (side := known[letter]) for p in side.points("hopf")]
    reached: list[SpecialPoint] = []
    for start in sorted(hopf, key=lambda point: point.parameter):
        if any(same_point(start, point, 1e-6 * (speeds[1] - speeds[0])) for point in reached):
            continue
        try:
            branch = whole(continue_orbits(at, SPEED, start=start, until=speeds, ds=step, mesh=mesh))
        except (RainwindError, np.linalg.LinAlgError) as error:
            notes.append(f"cycles from {start.parameter:.4f} m/s, {100 * ratio:.4g} %: {error}")
            continue
        reached += branch.points("hopf")
        if len(branch) > 1:
            yield branch


def passes(curve: OrbitBranch, point: OrbitPoint, speeds: tuple[float, float]) -> bool:
    """Whether a curve goes through a labelled cycle."""
    return place_on(curve, point, _SAME_SPEED * (speeds[1] - speeds[0])) is not None


def place_on(curve: OrbitBranch, point: OrbitPoint, near: float = 0.03) -> float | None:
    """The arclength at which a curve goes through a labelled cycle: the same speed, size and period at its ratio.

    near: how far the speeds may differ, m/s.
    """
    if curve.kind != point.kind:
        return None
    size = point.orbit.amplitude["y"]
    columns = (curve.arclength, curve[SPEED], curve["y"], curve["period"])
    for s, speed, y, period in crossings(point.parameters[RATIO], curve[RATIO], *columns):
        if (
            abs(speed - point.parameter) < near
            and abs(y - size) < _SAME_SIZE * size
            and abs(period / point.orbit.period - 1.0) < _SAME_PERIOD
        ):
            return s
    return None


def crossings(level: float, over: np.ndarray, *columns: np.ndarray) -> Iterator[tuple[float, ...]]:
    """The columns where `over` passes a level, between points along straight lines."""
    above = over > level
    for k in np.flatnonzero(above[:-1] != above[1:]):
        t = (level - over[k]) / (over[k + 1] - over[k])
        yield tuple(float(column[k] + t * (column[k + 1] - column[k])) for column in columns)
