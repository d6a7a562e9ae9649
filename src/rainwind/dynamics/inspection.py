"""From nodes to labels: find every event between neighbouring nodes, whatever the step's length.

Sign functions and the count of unstable eigenvalues work together. An interval is clear when no watched value
changes sign and none can have crossed zero and come back at the pace it moves; it holds one event when the changes
fit exactly one kind and the crossing is nearly straight. Every other interval is halved, until it is too short or
too many probes were spent.
"""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics.continuation import point_between
from rainwind.dynamics.kernels import screening as kernel
from rainwind.dynamics.nodes import Node, Nodes
from rainwind.dynamics.results import SpecialPoint, Unexplained

Complex = NDArray[np.complex128]

_SHORTEST = 1e-9  # of arclength
# the middle, or where the curve bends too sharply for Newton, as near to either end as need be
_INSIDE = (0.5, 0.25, 0.75, 0.0625, 0.9375, 0.004, 0.996)
_STRAIGHT = 0.2


@dataclass(frozen=True, slots=True)
class Probe:
    """A node with its watched eigenvalues in the order of its neighbour's, and the pace of all watched values."""

    node: Node
    watched: Complex  # (k,)
    pace: np.ndarray  # (k + 2,) travel per arclength

    @property
    def values(self) -> np.ndarray:
        """Real parts of the watched eigenvalues, then the two test values (k + 2,)."""
        return np.concatenate([self.watched.real, self.node.tests])

    @property
    def count(self) -> int:
        """How many watched eigenvalues are unstable."""
        return int(np.sum(self.watched.real > 0))


@dataclass(frozen=True, slots=True)
class Changes:
    """What changed sign between two probes."""

    tests: tuple[bool, bool]
    real: tuple[int, ...]  # watched real eigenvalues; of orbits, positive real multipliers
    pairs: tuple[int, ...]  # watched complex eigenvalues, both of a pair
    negative: tuple[int, ...] = ()  # of orbits, negative real multipliers

    @property
    def column(self) -> int | None:
        """Number of the watched value that changed, or of the first of several; None where only tests changed."""
        return (self.real or self.negative or self.pairs or (None,))[0]

    @property
    def any(self) -> bool:
        """Whether anything changed."""
        return any(self.tests) or bool(self.real or self.pairs or self.negative)


@dataclass(frozen=True)
class Inspector:
    """How one kind of curve is read.

    continuous: whether each test value is continuous or only a sign; classify: Changes -> kind of point, or None
    where they fit none; locate: problem, kind, two probes, changes -> the point, or None when it could not be located
    there.
    """

    problem: Any
    continuous: tuple[bool, bool]
    classify: Callable[[Changes], str | None]
    locate: Callable[[Any, str, Probe, Probe, Changes], Any]
    most_probes: int = 500  # in one interval: values that only look like crossings could ask for millions

    def labels(self, nodes: Nodes) -> tuple[list[SpecialPoint], list[Unexplained]]:
        """All special points between the nodes, and the changes that none explains."""
        continuous = np.array(self.continuous)
        flags, ordered, pace = kernel.screen(
            self.problem.kind, nodes.u, nodes.arclength, nodes.tests, nodes.eigenvalues, continuous
        )
        points: list[SpecialPoint] = []
        unexplained: list[Unexplained] = []
        if not len(flags):
            return points, unexplained
        # the pace just before each interval and just after it; outside the walk there is none, so measure it
        first, last = (Probe(nodes[i], ordered[i], pace[i]) for i in (0, len(nodes) - 1))
        second, last_but_one = (Probe(nodes[i], ordered[i], pace[i]) for i in (1, len(nodes) - 2))
        before = np.vstack([self.pace_at(first, second), pace[1:-1]])
        after = np.vstack([pace[2:], self.pace_at(last, last_but_one)])
        values = np.hstack([ordered.real, nodes.tests])
        flags |= kernel.hasty_intervals(values, np.maximum(before, after), nodes.arclength, continuous)
        for i in np.flatnonzero(flags).tolist():
            a = Probe(nodes[i], ordered[i], before[i])
            b = Probe(nodes[i + 1], ordered[i + 1], after[i])
            self.explain(a, b, points, unexplained)
        return sorted(points, key=lambda p: p.arclength), sorted(unexplained, key=lambda u: u.between)

    def pace_at(self, end: Probe, neighbour: Probe) -> np.ndarray:
        """The pace right at one end of an interval."""
        near = self.between(end, neighbour, (0.01,))
        return end.pace if near is None else pace(end, near)

    def explain(self, a: Probe, b: Probe, points: list[Any], unexplained: list[Unexplained]) -> None:
        """Add what happens between two probes: points, and changes that none explains."""
        # breadth first: noise in one part must not use up the probes of another
        intervals, probes = deque([(a, b)]), 0
        while intervals:
            a, b = intervals.popleft()
            changes = self._changes(a, b)
            kind = self.classify(changes) if changes.any else None
            unsettled = self._unsettled(a, b, kind == "bp" and not changes.real)
            if not changes.any and not unsettled:
                continue
            length = b.node.arclength - a.node.arclength
            middle = self.between(a, b, _INSIDE) if length > _SHORTEST and probes < self.most_probes else None
            probes += 1
            point = None
            if kind and (middle is None or (not unsettled and self._straight(a, middle, b, changes))):
                point = self.locate(self.problem, kind, a, b, changes)
            if point is not None:
                points.append(point)
            elif middle is not None:
                # the second half's eigenvalues follow the middle's order
                last = Probe(b.node, self.in_order(middle.watched, b.watched), b.pace)
                intervals += [(a, middle), (middle, last)]
            elif b.count != a.count or kind not in (None, "gh") or length > _SHORTEST:
                where = (self.problem.named(a.node.u), self.problem.named(b.node.u))
                unexplained.append(
                    Unexplained((a.node.arclength, b.node.arclength), where, b.count - a.count)
                )

    def between(self, a: Probe, b: Probe, fractions: Sequence[float]) -> Probe | None:
        """A probe between two others at the first of some fractions where Newton finds the curve, or None."""
        length = abs(b.node.arclength - a.node.arclength)
        for fraction in fractions:
            node = point_between(self.problem, a.node, b.node, fraction)
            if node is None or max(self._distance(a.node, node), self._distance(node, b.node)) > length:
                continue
            watched = self.watched(a.watched, node)
            middle = Probe(node, watched, np.zeros_like(a.pace))
            return replace(middle, pace=np.maximum(pace(a, middle), pace(middle, b)))
        return None

    def watched(self, before: Complex, node: Node) -> Complex:
        """The watched eigenvalues of a node in the order of those before, and of their signs while mere rounding."""
        watched = kernel.watched(self.problem.kind, node.eigenvalues, node.u[-1])
        return kernel.signed(before, self.in_order(before, watched), node.eigenvalues)

    def in_order(self, before: Complex, after: Complex) -> Complex:
        """Watched eigenvalues in the order of those before."""
        return kernel.matched(before, after)

    def _distance(self, a: Node, b: Node) -> float:
        return float(np.max(np.abs((b.u - a.u) / self.problem.scale)))

    def _changes(self, a: Probe, b: Probe) -> Changes:
        # a value of exactly zero counts as negative, so that a node right on an event hides nothing
        crossed = np.flatnonzero((a.watched.real > 0) != (b.watched.real > 0))
        real = tuple(int(k) for k in crossed if a.watched[k].imag == 0 == b.watched[k].imag)
        pairs = tuple(int(k) for k in crossed if k not in real)
        fold, branch = (a.node.tests > 0) != (b.node.tests > 0)
        return self.sorted_changes(Changes((bool(fold), bool(branch)), real, pairs), a, b)

    def sorted_changes(self, changes: Changes, a: Probe, b: Probe) -> Changes:
        """Changes as this kind of curve tells them apart."""
        return changes

    def _unsettled(self, a: Probe, b: Probe, turns: bool) -> bool:
        """Whether values may have crossed twice; turns: the branch turns at a pitchfork."""
        before, after = a.values, b.values
        if turns:  # the critical eigenvalue touches zero there
            before[np.argmin(np.abs(a.watched.real) + np.abs(b.watched.real))] = 0.0
        length = b.node.arclength - a.node.arclength
        return kernel.hasty(before, after, np.maximum(a.pace, b.pace), length, np.array(self.continuous))

    def _straight(self, a: Probe, middle: Probe, b: Probe, changes: Changes) -> bool:
        """Whether what changes sign does so once: nearly straight through the middle."""
        columns = [*changes.real, *changes.pairs, *changes.negative]
        if not columns:
            columns = [len(a.watched) + k for k in (0, 1) if changes.tests[k] and self.continuous[k]][:1]
        for k in columns:
            va, vm, vb = a.values[k], middle.values[k], b.values[k]
            if abs(vm - (va + vb) / 2) > _STRAIGHT * abs(vb - va):
                return False
        return True


def pace(a: Probe, b: Probe) -> np.ndarray:
    """How fast the values change between two probes."""
    return np.abs(b.values - a.values) / max(abs(b.node.arclength - a.node.arclength), 1e-300)
