"""The pseudo-arclength walk along a curve H(u) = 0 with one unknown too many, as an iterator.

Whoever walks decides when to stop. Step control is the same for compiled problems (`Equations`) and for any
other object that can correct a predicted point: Newton across the tangent, a step repeated at half its length
when the tangent turns too much or the correction is too long.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

import numpy as np
from scipy.optimize import toms748

from rainwind.dynamics.equations import Equations, smallest_step
from rainwind.dynamics.kernels import march as kernel
from rainwind.dynamics.nodes import Node, Nodes
from rainwind.dynamics.results import Ended


class Problem(Protocol):
    """What a walk needs: scales of the unknowns, and a way back to the curve."""

    @property
    def scale(self) -> np.ndarray:
        """The size (N,) of one unit of each unknown."""
        ...

    def correct(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> Node | None:
        """The node in the hyperplane through u across the tangent; None when Newton fails."""
        ...


@runtime_checkable
class Adapting(Protocol):
    """A problem that may go on in other unknowns after a step, such as a profile on another mesh."""

    def adapted(self, node: Any, bend: np.ndarray) -> tuple[Any, Any, np.ndarray]:
        """The problem to go on with, and the node and its tangent's turn per length in its unknowns."""
        ...

    def refined(self, node: Any, bend: np.ndarray, new: Any) -> tuple[Any, Any, np.ndarray] | None:
        """The same to repeat the step from node to new with, in unknowns that suit it better; None if these do."""
        ...


class Walk:
    """Nodes one after another from a start; `ended` says why there are no more.

    problem: what to follow; start: a node on the curve, whose tangent gives the direction; ds: the first and
    largest step; window: the range of each free parameter, as numbers of unknowns with lower and upper bounds.
    """

    def __init__(
        self,
        problem: Problem,
        start: Node,
        *,
        ds: float,
        window: dict[int, tuple[float, float]] | None = None,
    ) -> None:
        self.problem, self.start, self.ds = problem, start, ds
        self.window = window or {}
        self.ended: Ended | None = None

    def __iter__(self) -> Iterator[Any]:
        if not isinstance(self.problem, Equations):
            yield from self._plain()
            return
        for nodes in self.chunks():
            yield from nodes

    def chunks(self) -> Iterator[Nodes]:
        """The same nodes, many at a time."""
        if isinstance(self.problem, Equations):
            yield from self._compiled(self.problem)
        else:
            yield from (Nodes.of([node]) for node in self._plain())

    def _compiled(self, problem: Equations) -> Iterator[Nodes]:
        n = len(problem.system.states)
        bounds = np.array([self.window.get(n + k, (-np.inf, np.inf)) for k in range(len(problem.along))])
        node, step, count = self.start, self.ds, 32
        while self.ended is None:
            status, nodes, step = problem.march(
                node, bounds[:, 0].copy(), bounds[:, 1].copy(), step, self.ds, count
            )
            if status == kernel.LEFT_WINDOW:
                before = nodes[-2] if len(nodes) > 1 else node
                last, self.ended = self._stopped_at_bound(before, nodes[-1])
                nodes = nodes[:-1]
                if last is not None:
                    nodes = nodes.followed_by(Nodes.of([last])) if len(nodes) else Nodes.of([last])
                yield nodes
                return
            if status == kernel.STEP_TOO_SMALL:
                self.ended = Ended.STEP_TOO_SMALL
            if len(nodes):
                node = nodes[-1]
                if not np.all(np.abs(node.u / problem.scale) < 1e8):
                    self.ended = Ended.NOT_FINITE
                yield nodes
            # few at first, so that who stops early pays little
            count = min(2 * count, 512)

    def _plain(self) -> Iterator[Any]:
        node, step = self.start, self.ds
        bend = np.zeros_like(node.u)  # the tangent's turn per length of the step before
        adapting: Any = self.problem if isinstance(self.problem, Adapting) else None
        while True:
            problem = self.problem
            predicted = node.u + step * (node.tangent + 0.5 * step * bend) * problem.scale
            new = problem.correct(node, predicted, node.tangent)
            cosine = 0.0 if new is None else float(new.tangent @ node.tangent)
            if (
                new is None
                or cosine < kernel.MOST_TURN
                or np.linalg.norm((new.u - predicted) / problem.scale) > kernel.MOST_CORRECTION * step
            ):
                step *= 0.5
                if step < smallest_step(self.ds):
                    self.ended = Ended.STEP_TOO_SMALL
                    return
                continue
            if adapting is not None and (finer := adapting.refined(node, bend, new)) is not None:
                adapting, node, bend = finer
                self.problem = adapting
                continue
            new = replace(new, arclength=node.arclength + step)
            if any(not low <= new.u[k] <= high for k, (low, high) in self.window.items()):
                last, self.ended = self._stopped_at_bound(node, new)
                if last is not None:
                    yield last
                return
            if not np.all(np.abs(new.u / problem.scale) < 1e8):
                self.ended = Ended.NOT_FINITE
                return
            bend = (new.tangent - node.tangent) / step
            yield new
            step = kernel.next_step(step, new.iterations, cosine, self.ds)
            node = new
            if adapting is not None:
                adapting, node, bend = adapting.adapted(node, bend)
                self.problem = adapting

    def _stopped_at_bound(self, a: Any, b: Any) -> tuple[Any | None, Ended]:
        """The node on the bound between a and b, which lies outside the window; None where a is on the bound.

        Where no solution is found there (the equations may have a pole at it) the walk has failed before the bound.
        """
        passed = {
            k: low if b.u[k] < low else high
            for k, (low, high) in self.window.items()
            if not low <= b.u[k] <= high
        }
        fraction, number = min(((bound - a.u[k]) / (b.u[k] - a.u[k]), k) for k, bound in passed.items())
        across = np.zeros_like(b.tangent)
        across[number] = 1.0
        u = a.u + fraction * (b.u - a.u)
        u[number] = passed[number]
        found = self.problem.correct(a, u, across)
        step = np.linalg.norm((b.u - a.u) / self.problem.scale)
        if found is None or not np.linalg.norm((found.u - u) / self.problem.scale) < step:
            return None, Ended.STEP_TOO_SMALL
        if np.allclose(found.u / self.problem.scale, a.u / self.problem.scale, rtol=0.0, atol=1e-12):
            return None, Ended.AT_BOUND  # the walk began on the bound
        if found.tangent @ b.tangent < 0:
            found = self.problem.correct(a, found.u, a.tangent) or b
        return replace(found, arclength=a.arclength + fraction * (b.arclength - a.arclength)), Ended.AT_BOUND


def point_between(problem: Problem, a: Node, b: Node, fraction: float) -> Node | None:
    """The node at a fraction of the arclength between two neighbours, from the cubic through both."""
    h = b.arclength - a.arclength
    t = fraction
    ua, ub = a.u / problem.scale, b.u / problem.scale
    guess = (
        (1 + 2 * t) * (1 - t) ** 2 * ua
        + t * (1 - t) ** 2 * h * a.tangent
        + t * t * (3 - 2 * t) * ub
        + t * t * (t - 1) * h * b.tangent
    )
    across = (1 - t) * a.tangent + t * b.tangent
    node = problem.correct(a, guess * problem.scale, across / np.linalg.norm(across))
    return None if node is None else replace(node, arclength=a.arclength + fraction * h)


def zero_between(problem: Problem, a: Any, b: Any, value: Callable[[Any], float]) -> Any:
    """The node between two neighbours where a value of the node vanishes, or None.

    Where one end lies on the zero, so that its value is mere rounding, that end is the node.
    """

    def at(fraction: float) -> Any:
        if fraction in (0.0, 1.0):
            return a if fraction == 0.0 else b
        node = point_between(problem, a, b, fraction)
        if node is None:
            raise _Lost
        return node

    first, last = value(a), value(b)
    if first * last > 0:
        fraction = 0.0 if abs(first) < abs(last) else 1.0
        if min(abs(first), abs(last)) > 1e-9 * max(abs(first), abs(last)):
            return None
        return at(fraction)
    small = 1e-12 * max(abs(first), abs(last))

    def settled(fraction: float) -> float:
        found = value(at(fraction))
        return 0.0 if abs(found) < small else found  # else the bracket would be narrowed for nothing

    try:
        return at(toms748(settled, 0.0, 1.0, xtol=1e-12, maxiter=60))  # type: ignore[arg-type]
    except (_Lost, RuntimeError, ValueError):
        return None


class _Lost(Exception):
    """Newton failed between two nodes."""
