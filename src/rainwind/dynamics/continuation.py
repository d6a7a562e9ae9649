"""The pseudo-arclength walk along a curve H(u) = 0 with one unknown too many, as an iterator.

Whoever walks decides when to stop. Step control is the same for compiled problems (`Equations`) and for any
other object that can correct a predicted point: Newton across the tangent, a step repeated at half its length
when the tangent turns too much or the correction is too long.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from rainwind.dynamics.kernels import march as kernel
from rainwind.dynamics.kernels import screening
from rainwind.dynamics.kernels.equations import equations
from rainwind.dynamics.kernels.values import specialised
from rainwind.dynamics.results import Ended
from rainwind.dynamics.system import System

_NEWTON_LIMIT = 10


@dataclass(frozen=True, slots=True)
class Node:
    """A point of the curve: u (N,), unit tangent in scaled unknowns (N,), arclength from the start of the walk.

    tests: values whose signs reveal special points; eigenvalues (n,); borders: left, below and weights of a
    minimally augmented system.
    """

    u: np.ndarray
    tangent: np.ndarray
    arclength: float = 0.0
    iterations: int = 0
    tests: np.ndarray = field(default_factory=lambda: np.zeros(0))
    eigenvalues: np.ndarray = field(default_factory=lambda: np.zeros(0, complex))
    borders: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None


class Problem(Protocol):
    """What a walk needs: scales of the unknowns, and a way back to the curve."""

    @property
    def scale(self) -> np.ndarray:
        """The size (N,) of one unit of each unknown."""
        ...

    def correct(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> Node | None:
        """The node in the hyperplane through u across the tangent; None when Newton fails."""
        ...


@dataclass(frozen=True, eq=False)
class Equations:
    """A compiled problem: equilibria, folds, Hopf points or branch points of a system (`kernels/equations.py`)."""

    kind: int
    system: System
    along: tuple[str, ...]
    scale: np.ndarray
    tolerance: float = 1e-8

    def __post_init__(self) -> None:
        system = self.system
        free = np.array([system.number(name) for name in self.along], dtype=np.int64)
        inputs = system.inputs(np.zeros(len(system.states)))
        varies = np.zeros(inputs.size, dtype=bool)
        varies[: len(system.states)] = True
        varies[free] = True
        operations, template, outputs = system.tape.arrays
        tape = (*specialised(operations, template, inputs, varies), outputs)
        object.__setattr__(self, "_packed", (self.kind, tape, inputs, free))

    def no_borders(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Borders of equations that need none."""
        empty = np.zeros((len(self.system.states), 0))
        return empty, empty, np.zeros((2, 4))

    def correct(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> Node | None:
        """The node in the hyperplane through u across the tangent; None when Newton fails."""
        everywhere = np.full(len(self.along), np.inf)
        status, nodes, _, iterations = self._march(
            near.borders or self.no_borders(), u, tangent, -everywhere, everywhere, 0.0, 1.0, 1
        )
        return replace(nodes[0], iterations=iterations) if status != kernel.STEP_TOO_SMALL else None

    def derivatives(self, u: np.ndarray, borders: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
        """The Jacobian (m, len(u)) of the equations at u."""
        return equations(*self._packed, *borders, u)[1]  # type: ignore[attr-defined]

    def solve(
        self, u: np.ndarray, borders: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
    ) -> tuple[np.ndarray, float] | None:
        """Newton on as many equations as unknowns, to rounding: the solution and the largest |F|, or None."""
        found, u, residual = kernel.solve(
            *self._packed,
            *(borders or self.no_borders()),
            u,
            self.scale,
            1e-11,
            2 * _NEWTON_LIMIT,  # type: ignore[attr-defined]
        )
        return (u, residual) if found else None

    def march(
        self, node: Node, lower: np.ndarray, upper: np.ndarray, step: float, largest: float, count: int
    ) -> "tuple[int, Nodes, float]":
        """Up to `count` nodes in one compiled call: status, nodes, the next step's length."""
        borders = node.borders or self.no_borders()
        status, nodes, step, _ = self._march(
            borders, node.u, node.tangent, lower, upper, step, largest, count
        )
        return status, replace(nodes, arclength=node.arclength + nodes.arclength), step

    def inputs(self, u: np.ndarray) -> np.ndarray:
        """States and parameters (N, i) as the kernels take them, from unknowns u (N, .)."""
        _, _, inputs, free = self._packed  # type: ignore[attr-defined]
        at = np.tile(inputs, (len(u), 1))
        n = len(self.system.states)
        at[:, :n] = u[:, :n]
        at[:, free] = u[:, n : n + len(free)]
        return at

    def _march(
        self, borders: tuple, u: np.ndarray, tangent: np.ndarray, lower: np.ndarray, upper: np.ndarray,
        step: float, largest: float, count: int,
    ) -> "tuple[int, Nodes, float, int]":  # fmt: skip
        tolerance = self.tolerance if step else 1e-3 * self.tolerance
        status, done, us, tangents, steps, tests, lefts, belows, weightss, step, iterations = kernel.march(
            *self._packed, *borders, u, tangent, self.scale, lower, upper, step, largest,  # type: ignore[attr-defined]
            smallest_step(largest), tolerance, _NEWTON_LIMIT, count,
        )  # fmt: skip
        spectra = screening.spectra(*self._packed[1], self.inputs(us[:done]))  # type: ignore[attr-defined]
        borders = (lefts[:done], belows[:done], weightss[:done])
        nodes = Nodes(us[:done], tangents[:done], np.cumsum(steps[:done]), tests[:done], spectra, borders)
        return status, nodes, step, iterations


@dataclass(frozen=True, eq=False)
class Nodes(Sequence):
    """Nodes side by side: arrays with one row a node."""

    u: np.ndarray
    tangent: np.ndarray
    arclength: np.ndarray
    tests: np.ndarray
    eigenvalues: np.ndarray
    borders: tuple[np.ndarray, ...]

    def __len__(self) -> int:
        return len(self.arclength)

    def __getitem__(self, i):  # noqa: ANN001, ANN204  # a node for a number, nodes for a slice
        borders = tuple(b[i] for b in self.borders)
        if isinstance(i, slice):
            return Nodes(
                self.u[i], self.tangent[i], self.arclength[i], self.tests[i], self.eigenvalues[i], borders
            )
        return Node(
            self.u[i],
            self.tangent[i],
            float(self.arclength[i]),
            0,
            self.tests[i],
            self.eigenvalues[i],
            borders,
        )  # type: ignore[arg-type]  # a node of three borders

    @staticmethod
    def of(nodes: Sequence[Node]) -> "Nodes":
        """Single nodes side by side."""
        return Nodes(
            np.array([n.u for n in nodes]),
            np.array([n.tangent for n in nodes]),
            np.array([n.arclength for n in nodes]),
            np.array([n.tests for n in nodes]),
            np.array([n.eigenvalues for n in nodes]),
            tuple(np.array([n.borders[k] for n in nodes]) for k in range(3)) if nodes[0].borders else (),
        )

    def followed_by(self, other: "Nodes") -> "Nodes":
        """These nodes and then the others."""
        join = np.concatenate
        return Nodes(
            join([self.u, other.u]), join([self.tangent, other.tangent]), join([self.arclength, other.arclength]),
            join([self.tests, other.tests]), join([self.eigenvalues, other.eigenvalues]),
            tuple(join([a, b]) for a, b in zip(self.borders, other.borders, strict=True)),
        )  # fmt: skip


def smallest_step(largest: float) -> float:
    """The step's length at which a walk gives up."""
    return 1e-7 * largest


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

    def __iter__(self) -> Iterator[Node]:
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
                yield self._stopped_at_bound(nodes, node)
                self.ended = Ended.AT_BOUND
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

    def _plain(self) -> Iterator[Node]:
        problem, node, step = self.problem, self.start, self.ds
        while True:
            predicted = node.u + step * node.tangent * problem.scale
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
            new = replace(new, arclength=node.arclength + step)
            if any(not low <= new.u[k] <= high for k, (low, high) in self.window.items()):
                yield self._stopped_at_bound(Nodes.of([new]), node)[-1]
                self.ended = Ended.AT_BOUND
                return
            yield new
            step = kernel.next_step(step, new.iterations, cosine, self.ds)
            node = new

    def _stopped_at_bound(self, nodes: Nodes, before: Node) -> Nodes:
        """The nodes with the last one, which lies outside the window, moved back onto the bound."""
        a = nodes[-2] if len(nodes) > 1 else before
        b = nodes[-1]
        passed = {
            k: low if b.u[k] < low else high
            for k, (low, high) in self.window.items()
            if not low <= b.u[k] <= high
        }
        fraction, number = min(((bound - a.u[k]) / (b.u[k] - a.u[k]), k) for k, bound in passed.items())
        bound = passed[number]
        across = np.zeros_like(b.tangent)
        across[number] = 1.0
        u = a.u + fraction * (b.u - a.u)
        u[number] = bound
        found = self.problem.correct(a, u, across)
        if found is None:
            # nearly tangent to the bound: the secant's hyperplane is within a step of it
            found = self.problem.correct(a, u, a.tangent)
        if found is None:
            return nodes[:-1]
        if found.tangent @ b.tangent < 0:
            found = self.problem.correct(a, found.u, a.tangent) or b
        arclength = a.arclength + fraction * (b.arclength - a.arclength)
        found = replace(found, arclength=arclength)
        last = Nodes.of([found])
        return nodes[:-1].followed_by(last) if len(nodes) > 1 else last


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
