"""From nodes to labels: find every event between neighbouring nodes, whatever the step's length.

Sign functions and the count of unstable eigenvalues work together. An interval is clear when no watched value
changes sign and none can have crossed zero and come back at the pace it moves; it holds one event when the changes
fit exactly one kind and the crossing is nearly straight. Every other interval is halved, until it is too short or
too many probes were spent.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.continuation import Equations, Node, Nodes, point_between
from rainwind.dynamics.kernels import screening as kernel
from rainwind.dynamics.results import SpecialPoint, Unexplained

_SHORTEST = 1e-9  # of arclength
_MOST_PROBES = (
    500  # in one interval between nodes: values that only look like crossings could ask for millions
)
_STRAIGHT = 0.2
_ROUNDING = 1e-13  # of a real part, as a share of the largest eigenvalue


@dataclass(frozen=True, slots=True)
class Probe:
    """A node with its watched eigenvalues in the order of its neighbour's, and the pace of all watched values."""

    node: Node
    watched: np.ndarray  # (k,) complex
    pace: np.ndarray  # (k + 2,) travel per arclength

    @property
    def values(self) -> np.ndarray:
        """Real parts of the watched eigenvalues, then the two test values (k + 2,)."""
        return np.concatenate([self.watched.real, self.node.tests])

    @property
    def rounding(self) -> float:
        """Real parts smaller than this have no sign."""
        return _ROUNDING * float(np.max(np.abs(self.node.eigenvalues)))

    @property
    def count(self) -> int:
        """How many watched eigenvalues are unstable."""
        return int(np.sum(self.watched.real > 0))


@dataclass(frozen=True, slots=True)
class Changes:
    """What changed sign between two probes."""

    tests: tuple[bool, bool]
    real: tuple[int, ...]  # watched real eigenvalues
    pairs: tuple[int, ...]  # watched complex eigenvalues, both of a pair

    @property
    def any(self) -> bool:
        """Whether anything changed."""
        return any(self.tests) or bool(self.real or self.pairs)


@dataclass(frozen=True)
class Inspector:
    """How one kind of curve is read.

    continuous: whether each test value is continuous or only a sign; classify: Changes -> kind of point, or None
    where they fit none; locate: kind, two probes, changes -> the point, or None when it could not be located there.
    """

    problem: Equations
    continuous: tuple[bool, bool]
    classify: Callable[[Changes], str | None]
    locate: Callable[[str, Probe, Probe, Changes], SpecialPoint | None]

    def labels(self, nodes: Nodes) -> tuple[list[SpecialPoint], list[Unexplained]]:
        """All special points between the nodes, and the changes that none explains."""
        flags, ordered, pace = kernel.screen(
            self.problem.kind,
            nodes.u,
            nodes.arclength,
            nodes.tests,
            nodes.eigenvalues,
            np.array(self.continuous),
        )
        points: list[SpecialPoint] = []
        unexplained: list[Unexplained] = []
        for i in np.flatnonzero(flags):
            a = Probe(nodes[int(i)], ordered[i], pace[i])
            b = Probe(nodes[int(i) + 1], ordered[i + 1], pace[i + 1])
            self._explain(a, b, points, unexplained)
        return sorted(points, key=lambda p: p.arclength), sorted(unexplained, key=lambda u: u.between)

    def _explain(
        self, a: Probe, b: Probe, points: list[SpecialPoint], unexplained: list[Unexplained]
    ) -> None:
        # breadth first: noise in one part must not use up the probes of another
        intervals, probes = deque([(a, b)]), 0
        while intervals:
            a, b = intervals.popleft()
            changes = self._changes(a, b)
            unsettled = self._unsettled(a, b)
            if not changes.any and not unsettled:
                continue
            length = b.node.arclength - a.node.arclength
            middle = self.between(a, b, 0.5) if length > _SHORTEST and probes < _MOST_PROBES else None
            probes += 1
            kind = self.classify(changes) if changes.any else None
            point = None
            if kind and (middle is None or not unsettled and self._straight(a, middle, b, changes)):
                point = self.locate(kind, a, b, changes)
            if point is not None:
                points.append(point)
            elif middle is not None:
                # the second half's eigenvalues follow the middle's order
                last = Probe(b.node, kernel.matched(middle.watched, b.watched), b.pace)
                intervals += [(a, middle), (middle, last)]
            elif b.count != a.count:
                where = (self._parameters(a.node), self._parameters(b.node))
                unexplained.append(
                    Unexplained((a.node.arclength, b.node.arclength), where, b.count - a.count)
                )

    def between(self, a: Probe, b: Probe, fraction: float) -> Probe | None:
        """A probe between two others; None where Newton fails."""
        node = point_between(self.problem, a.node, b.node, fraction)
        if node is None:
            return None
        watched = kernel.matched(a.watched, kernel.watched(self.problem.kind, node.eigenvalues, node.u[-1]))
        middle = Probe(node, watched, np.zeros_like(a.pace))
        pace = np.abs(middle.values - a.values) / max(node.arclength - a.node.arclength, 1e-300)
        return Probe(node, watched, pace)

    def _changes(self, a: Probe, b: Probe) -> Changes:
        # a value of exactly zero counts as negative, so that a node right on an event hides nothing
        crossed = np.flatnonzero(((a.watched.real > 0) != (b.watched.real > 0)) & ~self._noise(a, b))
        real = tuple(int(k) for k in crossed if a.watched[k].imag == 0 == b.watched[k].imag)
        pairs = tuple(int(k) for k in crossed if k not in real)
        fold, branch = (a.node.tests > 0) != (b.node.tests > 0)
        return Changes((bool(fold), bool(branch)), real, pairs)

    @staticmethod
    def _noise(a: Probe, b: Probe) -> np.ndarray:
        """Which watched eigenvalues stay on the imaginary axis to rounding (k,)."""
        return np.maximum(np.abs(a.watched.real), np.abs(b.watched.real)) <= min(a.rounding, b.rounding)

    def _unsettled(self, a: Probe, b: Probe) -> bool:
        before, after = a.values, b.values
        off = np.concatenate([self._noise(a, b), ~np.array(self.continuous)])
        before[off] = after[off] = 0.0
        length = b.node.arclength - a.node.arclength
        return bool(kernel.unsettled(before, after, np.maximum(a.pace, b.pace), length))

    def _straight(self, a: Probe, middle: Probe, b: Probe, changes: Changes) -> bool:
        """Whether what changes sign does so once: nearly straight through the middle."""
        columns = [*changes.real, *changes.pairs]
        if not columns:
            columns = [len(a.watched) + k for k in (0, 1) if changes.tests[k] and self.continuous[k]]
        for k in columns:
            va, vm, vb = a.values[k], middle.values[k], b.values[k]
            if abs(vm - (va + vb) / 2) > _STRAIGHT * abs(vb - va):
                return False
        return True

    def _parameters(self, node: Node) -> dict[str, float]:
        n = len(self.problem.system.states)
        return {name: float(node.u[n + k]) for k, name in enumerate(self.problem.along)}
