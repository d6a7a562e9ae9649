"""How many limit cycles are stable at each wind speed and damping: counted across the curves that limit them.

Along a line of constant damping the number of stable cycles changes only at a Hopf point, a fold of cycles, a
Neimark-Sacker point or a period doubling with no other multiplier outside. By how much, the branches walked at some
damping ratios tell; the same side of a curve is the stable one until its next special point.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from rainwind.dynamics.diagram_results import drawn
from rainwind.dynamics.orbit_results import OrbitBranch
from rainwind.dynamics.results import SpecialPoint
from rainwind.studies.cycle_curves import RATIO, SPEED, CycleCurves, Row, crossings
from rainwind.studies.hopf_curves import HopfPiece

_FLAT = 0.1  # of the window
_NEAR = 5e-3  # of the window: a label this near to a curve lies on it


@dataclass(frozen=True, eq=False)
class Limit:
    """A piece of a curve over speed (m,) and ratio (m,) on which cycles gain or lose their stability.

    gain: stable cycles on its right side less those on its left, as it runs; None where no branch crosses it.
    """

    kind: str
    speed: np.ndarray
    ratio: np.ndarray
    gain: int | None = None


@dataclass(frozen=True, eq=False)
class CycleField:
    """Stable cycles on a grid: speed (m,), ratio (k,), count (k, m); the pieces of curves that limit them.

    isolated: (ratio, speed) of folds between stable and unstable cycles that no branch from a Hopf point passes.
    """

    speed: np.ndarray
    ratio: np.ndarray
    count: np.ndarray
    limits: tuple[Limit, ...]
    faults: tuple[str, ...] = field(default=())
    isolated: tuple[tuple[float, float], ...] = field(default=())

    def at(self, speed: float, ratio: float) -> int:
        """The number of stable cycles at one place, from the limits."""
        return int(_count(self.limits, ratio, np.array([speed]))[0])

    def ranges(self, ratio: float) -> list[tuple[float, float]]:
        """The ranges of speeds (m/s) at which some cycle is stable at one damping ratio, from the limits."""
        cuts = sorted({at for limit in self.limits if limit.gain for at, _ in _passages(limit, ratio)})
        edges = [float(self.speed[0]), *cuts, float(self.speed[-1])]
        found: list[tuple[float, float]] = []
        for a, b in pairwise(edges):
            if b > a and self.at(0.5 * (a + b), ratio) > 0:
                joins = bool(found) and found[-1][1] == a
                found.append((found.pop()[0] if joins else a, b))
        return found


def cycle_field(
    found: CycleCurves,
    hopf: Sequence[HopfPiece],
    degenerate: Sequence[SpecialPoint],
    speeds: tuple[float, float],
    ratios: tuple[float, float],
    shape: tuple[int, int] = (500, 400),
) -> CycleField:
    """The field in a window of speeds (m/s) and ratios, of `shape` points in speed and ratio.

    degenerate: generalised Hopf points, beyond which a Hopf curve's cycles are born unstable. faults: where the count
    differs from that of a walked branch.
    """
    groups = [
        [Limit(curve.kind, x, y) for n, x, y in found.pieces(curve) if n == 0] for curve in found.curves
    ]
    groups += [[part] for piece in hopf if piece.others == 0 for part in _cut(piece, degenerate)]
    votes: dict[int, list[int]] = {}
    near = _NEAR * (speeds[1] - speeds[0])
    every = [limit for group in groups for limit in group]
    for row in found.rows:
        for kind, speed, gain in _changes(row):
            best = None
            for limit in every:
                if limit.kind != kind:
                    continue
                for at, up in _passages(limit, row.ratio):
                    if abs(at - speed) < near and (best is None or abs(at - speed) < best[0]):
                        best = (abs(at - speed), limit, up)
            if best is not None:
                votes.setdefault(id(best[1]), []).append(best[2] * gain)
    limits = tuple(limit for group in groups for limit in _settled(group, votes))
    speed = np.linspace(*speeds, shape[0])
    ratio = np.linspace(*ratios, shape[1])
    count = np.array([_count(limits, r, speed) for r in ratio])
    isolated = tuple(_isolated(found.rows, limits, near))
    faults = [*_faults(found.rows, limits, near, isolated), *_torn(speed, ratio, count)]
    return CycleField(speed, ratio, count, limits, tuple(faults), isolated)


def _torn(speed: np.ndarray, ratio: np.ndarray, count: np.ndarray) -> list[str]:
    """Where the count changes along a level line: no curve is so flat, so a piece of one is missing or miscounted."""
    said = []
    for k in range(1, len(ratio) - 1):  # no curve passes the window's edge
        changed = np.concatenate([[False], count[k] != count[k + 1], [False]])
        starts, ends = np.flatnonzero(changed[1:] != changed[:-1]).reshape(-1, 2).T
        longest = int(np.argmax(ends - starts)) if starts.size else 0
        if starts.size and ends[longest] - starts[longest] > _FLAT * len(speed):
            a, b = speed[starts[longest]], speed[ends[longest] - 1]
            said.append(f"at {100 * ratio[k]:.3g} % it changes all along {a:.1f} to {b:.1f} m/s")
    return said


def _isolated(rows: Sequence[Row], limits: Sequence[Limit], near: float) -> Iterator[tuple[float, float]]:
    """Where a curve of folds passes a row's ratio, but no branch of the row passes the fold."""
    for row in rows:
        labels = [speed for kind, speed, _ in _changes(row) if kind == "lpc"]
        for limit in limits:
            if limit.kind == "lpc" and limit.gain:
                for at, _ in _passages(limit, row.ratio):
                    if not any(abs(at - speed) < near for speed in labels):
                        yield row.ratio, at


def _cut(piece: HopfPiece, degenerate: Sequence[SpecialPoint]) -> list[Limit]:
    """A piece of a Hopf curve cut at the generalised Hopf points on it."""
    cuts = []
    for point in degenerate:
        gaps = np.hypot(
            (piece.speed - point.parameter) / max(np.ptp(piece.speed), 1e-12),
            (piece.ratio - point.parameters[RATIO]) / max(np.ptp(piece.ratio), 1e-12),
        )
        if gaps.min() < 0.05:
            cuts.append(int(gaps.argmin()))
    edges = [0, *sorted(cuts), len(piece.speed) - 1]
    return [
        Limit("hopf", piece.speed[a : b + 1], piece.ratio[a : b + 1]) for a, b in pairwise(edges) if b > a
    ]


def _changes(row: Row) -> list[tuple[str, float, int]]:
    """Kind, speed and gain of the labels of a row's branches: stable cycles above that speed less those below."""
    found = []
    for branch in row.branches:
        s, speed, stable = branch.arclength, branch.parameter, branch.stable
        labels = sorted(branch.special, key=lambda p: p.arclength)
        edges = [-np.inf, *(p.arclength for p in labels), np.inf]
        for k, point in enumerate(labels, 1):
            gain = 0
            for low, high, nearest in ((edges[k - 1], edges[k], -1), (edges[k], edges[k + 1], 0)):
                inside = np.flatnonzero((s > low) & (s < high))
                if inside.size:
                    # the count in the middle: points beside a label may sit on the circle to rounding
                    if np.median(stable[inside]):
                        gain += int(np.sign(speed[inside[nearest]] - point.parameter))
                elif point.kind != "hopf":
                    break  # two labels without a cycle between them: this one says nothing
            else:
                found.append((point.kind, point.parameter, gain))
    return found


def _passages(limit: Limit, ratio: float) -> list[tuple[float, int]]:
    """Where a curve passes a ratio: the speeds, and whether it goes up (1) or down (-1) there."""
    ways = np.append(np.sign(np.diff(limit.ratio)), 0.0)
    above = limit.ratio > ratio
    hits = np.flatnonzero(above[:-1] != above[1:])
    speeds = crossings(ratio, limit.ratio, limit.speed)
    return [(speed, int(ways[k])) for k, (speed,) in zip(hits, speeds, strict=True)]


def _settled(group: list[Limit], votes: dict[int, list[int]]) -> list[Limit]:
    """The pieces of one curve with their gain; one that no branch crosses takes its neighbour's."""
    gains = [int(np.sign(np.sum(votes[id(limit)]))) if id(limit) in votes else None for limit in group]
    order = [*range(1, len(group)), *range(len(group) - 2, -1, -1)]
    for k, before in pairwise([0, *order]):
        touching = any(
            group[k].speed[a] == group[before].speed[b] and group[k].ratio[a] == group[before].ratio[b]
            for a, b in ((-1, 0), (0, -1))
        )
        if gains[before] is None and gains[k] is not None and touching:
            gains[before] = gains[k]
    return [replace(limit, gain=gain) for limit, gain in zip(group, gains, strict=True)]


def _count(limits: Sequence[Limit], ratio: float, speed: np.ndarray) -> np.ndarray:
    count = np.zeros(speed.size, dtype=int)
    for limit in limits:
        if limit.gain:
            for at, up in _passages(limit, ratio):
                count[speed > at] += up * limit.gain
    return count


def _faults(
    rows: Sequence[Row],
    limits: Sequence[Limit],
    near: float,
    isolated: Sequence[tuple[float, float]],
) -> list[str]:
    """Where the count differs from that of the branches, half-way between their labels.

    Cycles beside an isolated fold are on no branch: there the count may be higher.
    """
    said = []
    for row in rows:
        edges = sorted({speed for _, speed, _ in _changes(row)})
        middles = [0.5 * (a + b) for a, b in pairwise(edges) if b - a > 4 * near]
        for speed in middles:
            mine = int(_count(limits, row.ratio, np.array([speed]))[0])
            walked = sum(_stable_at(branch, speed) for branch in row.branches)
            apart = any(ratio == row.ratio for ratio, _ in isolated)
            if mine < walked or (mine > walked and not apart):
                said.append(
                    f"at {speed:.3f} m/s, {100 * row.ratio:.4g} %: {walked} stable cycles walked, {mine} counted"
                )
    return said


def _stable_at(branch: OrbitBranch, speed: float) -> int:
    found = 0
    for unstable, (x,) in drawn(branch, SPEED):
        if unstable == 0:
            found += int(np.sum((x[:-1] > speed) != (x[1:] > speed)))
    return found
