"""From nodes to labels: find every event between neighbouring nodes, whatever the step's length.

Sign functions and the count of unstable eigenvalues work together. An interval is clear when no watched value
changes sign and none can have crossed zero and come back at the pace it moves; it holds one event when the changes
fit exactly one kind and the crossing is nearly straight. Every other interval is halved.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.continuation import Equations, Node, Nodes, point_between
from rainwind.dynamics.kernels import march as kernel
from rainwind.dynamics.results import SpecialPoint, Unexplained

_DEEPEST = 16
_STRAIGHT = 0.2


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
            self._explain(a, b, 0, points, unexplained)
        return points, unexplained

    def _explain(
        self, a: Probe, b: Probe, depth: int, points: list[SpecialPoint], unexplained: list[Unexplained]
    ) -> None:
        length = b.node.arclength - a.node.arclength
        changes = self._changes(a, b)
        if not changes.any and not self._unsettled(a, b, changes, length):
            return
        middle = self.between(a, b, 0.5)
        kind = self.classify(changes) if changes.any else None
        if (
            kind
            and middle
            and self._straight(a, middle, b, changes)
            and not self._unsettled(a, b, changes, length)
        ):
            point = self.locate(kind, a, b, changes)
            if point is not None:
                points.append(point)
                return
        if depth < _DEEPEST and middle is not None:
            # the second half's eigenvalues follow the middle's order
            b = Probe(b.node, kernel.matched(middle.watched, b.watched), b.pace)
            self._explain(a, middle, depth + 1, points, unexplained)
            self._explain(middle, b, depth + 1, points, unexplained)
            return
        point = self.locate(kind, a, b, changes) if kind else None
        if point is not None:
            points.append(point)
        elif b.count != a.count:
            where = tuple(self._parameters(p.node) for p in (a, b))
            between = (a.node.arclength, b.node.arclength)
            unexplained.append(Unexplained(between, where, b.count - a.count))  # type: ignore[arg-type]

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
        crossed = np.flatnonzero(a.watched.real * b.watched.real < 0)
        real = tuple(k for k in crossed if a.watched[k].imag == 0 == b.watched[k].imag)
        tests = tuple(bool(s) for s in a.node.tests * b.node.tests < 0)
        return Changes(tests, real, tuple(k for k in crossed if k not in real))  # type: ignore[arg-type]

    def _unsettled(self, a: Probe, b: Probe, changes: Changes, length: float) -> bool:
        before, after = a.values, b.values
        off = np.concatenate([np.zeros(len(before) - 2, bool), ~np.array(self.continuous)])
        before[off] = after[off] = 0.0
        return bool(kernel.unsettled(before, after, np.maximum(a.pace, b.pace), length))

    def _straight(self, a: Probe, middle: Probe, b: Probe, changes: Changes) -> bool:
        """Whether what changes sign does so once: nearly straight through the middle."""
        columns = [*changes.real, *changes.pairs]
        columns += [len(a.watched) + k for k in (0, 1) if changes.tests[k] and self.continuous[k]]
        for k in columns:
            va, vm, vb = a.values[k], middle.values[k], b.values[k]
            if abs(vm - (va + vb) / 2) > _STRAIGHT * abs(vb - va):
                return False
        return True

    def _parameters(self, node: Node) -> dict[str, float]:
        n = len(self.problem.system.states)
        return {name: float(node.u[n + k]) for k, name in enumerate(self.problem.along)}
