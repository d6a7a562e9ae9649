"""Special points of a branch of periodic orbits: which kind, exactly where, and a certificate for each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics.collocation import Grid
from rainwind.dynamics.continuation import zero_between
from rainwind.dynamics.inspection import Changes, Inspector, Probe
from rainwind.dynamics.kernels import chain
from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.kernels.exponents import matched
from rainwind.dynamics.kernels.screening import hasty_intervals
from rainwind.dynamics.orbit_conditions import (
    Condition,
    adjoint,
    condition,
    null_profile,
    refreshed,
    slopes,
    start_borders,
)
from rainwind.dynamics.orbit_equations import NEWTON_LIMIT, Linearised, OrbitEquations, OrbitNode
from rainwind.dynamics.orbit_normal_forms import lpc_coefficient, ns_coefficient, pd_coefficient
from rainwind.dynamics.orbit_results import OrbitPoint
from rainwind.dynamics.orbit_trust import LOST, WRONG, lost_in_rounding
from rainwind.dynamics.results import Certificate, Unexplained

Complex = NDArray[np.complex128]

_TORN = 1e-4  # of arclength: how far apart the traces of a branch point that a mesh has torn may lie
FARTHEST = -12.0  # log|mu| below which nothing is watched: what is far inside the circle only makes noise


@dataclass(frozen=True)
class OrbitInspector(Inspector):
    """Reads orbits of a walk: a branch in one parameter (`BranchInspector`) or, with another `watch`, a curve in two.

    watch: the exponents of a node that may cross the unit circle.
    """

    most_probes: int = 60
    watch: Callable[[OrbitNode], Complex] = lambda node: near_circle(node.eigenvalues)

    def watched(self, before: Complex, node: Any) -> Complex:
        """The exponents of a node in the order of those before."""
        return self.in_order(before, self.watch(node))

    def in_order(self, before: Complex, after: Complex) -> Complex:
        """Exponents in the order of those before."""
        return matched(before, after)

    def sorted_changes(self, changes: Changes, a: Probe, b: Probe) -> Changes:
        """Crossings of two negative multipliers are apart from those of a complex pair."""
        negative = tuple(
            k for k in changes.pairs if np.pi == abs(a.watched[k].imag) == abs(b.watched[k].imag)
        )
        return replace(changes, negative=negative, pairs=tuple(k for k in changes.pairs if k not in negative))

    def read(self, nodes: Sequence[Any]) -> tuple[list[OrbitPoint], list[Unexplained]]:
        """All special points between the nodes of a walk, and the changes that none explains."""
        points: list[OrbitPoint] = []
        unexplained: list[Unexplained] = []
        if len(nodes) < 2:
            return points, unexplained
        watched = [self.watch(nodes[0])]
        for node in nodes[1:]:
            watched.append(self.watched(watched[-1], node))
        values = np.hstack([np.real(watched), [node.tests for node in nodes]])
        arclength = np.array([node.arclength for node in nodes])
        pace = np.abs(np.diff(values, axis=0)) / np.maximum(np.abs(np.diff(arclength)), 1e-300)[:, None]
        # the pace just before each interval and just after it
        before, after = np.vstack([pace[:1], pace[:-1]]), np.vstack([pace[1:], pace[-1:]])
        flags = np.any((values[1:] > 0) != (values[:-1] > 0), axis=1)
        flags |= hasty_intervals(values, np.maximum(before, after), arclength, np.array(self.continuous))
        for i in np.flatnonzero(flags).tolist():
            here = self.on(nodes[i + 1].grid)
            a = here.on_grid(Probe(nodes[i], watched[i], before[i]))
            if a is not None:
                here.explain(a, Probe(nodes[i + 1], watched[i + 1], after[i]), points, unexplained)
        return sorted(points, key=lambda p: p.arclength), sorted(unexplained, key=lambda u: u.between)

    def on(self, grid: Grid) -> "OrbitInspector":
        """The same on another grid."""
        return self if grid is self.problem.grid else replace(self, problem=self.problem.on(grid))

    def on_grid(self, a: Probe) -> Probe | None:
        """A probe on the problem's grid; None where Newton does not find the orbit there."""
        if a.node.grid is self.problem.grid:  # type: ignore[attr-defined]
            return a
        node = self.node_on_grid(a.node)
        return None if node is None else replace(a, node=node, watched=self.watched(a.watched, node))

    def node_on_grid(self, node: Any) -> Any:
        """A node on the problem's grid, or None."""
        if node.grid is self.problem.grid:
            return node
        before = self.problem.on(node.grid)
        u = before.moved(node.u, self.problem.grid)
        tangent = before.moved(node.tangent * before.scale, self.problem.grid) / self.problem.scale
        found = self.problem.correct(node, u, tangent / np.linalg.norm(tangent))
        return None if found is None else replace(found, arclength=node.arclength)


@dataclass(frozen=True)
class BranchInspector(OrbitInspector):
    """Reads a branch in one parameter, whose mesh may turn it or tear a branch point apart."""

    def sorted_changes(self, changes: Changes, a: Probe, b: Probe) -> Changes:
        """A turn with nothing that crosses is the mesh's: the parameter hardly moves near a homoclinic orbit."""
        if changes.tests == (True, False) and not (changes.real or changes.pairs):
            return Changes((False, False), (), ())
        return super().sorted_changes(changes, a, b)

    def _unsettled(self, a: Probe, b: Probe, turns: bool) -> bool:
        """As of equilibria, without the tests of an orbit that is lost in rounding."""
        if lost_in_rounding(a.node.doubt) or lost_in_rounding(b.node.doubt):  # type: ignore[attr-defined]
            a, b = (replace(p, node=replace(p.node, tests=np.ones(2)), pace=p.pace.copy()) for p in (a, b))
            a.pace[-2:] = b.pace[-2:] = 0.0
        return super()._unsettled(a, b, turns)

    def explain(self, a: Probe, b: Probe, points: list[Any], unexplained: list[Unexplained]) -> None:
        """As of equilibria; changes crowded at one place may be a branch point that the mesh has torn apart."""
        found: list[Any] = []
        gaps: list[Unexplained] = []
        super().explain(a, b, found, gaps)
        if gaps and max(g.between[1] for g in gaps) - min(g.between[0] for g in gaps) < _TORN:
            at = gaps[0].between[0]
            fraction = (at - a.node.arclength) / (b.node.arclength - a.node.arclength)
            point = _locate_branch_point(self.problem, a, b, fraction)
            if point is not None and point.certificate.holds:
                found, gaps = [*found, point], []
        points += found
        unexplained += gaps


def near_circle(exponents: Complex) -> Complex:
    """Exponents with those far inside the circle cut off: their changes are noise."""
    return np.asarray(np.maximum(exponents.real, FARTHEST) + 1j * exponents.imag, dtype=np.complex128)


def orbit_inspector(problem: OrbitEquations) -> BranchInspector:
    """Reads a branch of orbits in one parameter: lpc, pd, ns, bp."""
    return BranchInspector(problem, (True, False), _classify, _locate)


def _classify(changes: Changes) -> str | None:
    turn, sign = changes.tests
    shape = (turn, sign, len(changes.real), len(changes.negative), len(changes.pairs))
    return {
        (True, False, 1, 0, 0): "lpc",
        (False, True, 1, 0, 0): "bp",
        (True, True, 0, 0, 0): "bp",  # the branch born at a pitchfork, which turns there
        (True, True, 1, 0, 0): "bp",
        (False, False, 0, 1, 0): "pd",
        (False, False, 0, 0, 2): "ns",
    }.get(shape)


def _locate(problem: OrbitEquations, kind: str, a: Probe, b: Probe, changes: Changes) -> OrbitPoint | None:
    """The zero of the one value that vanishes at this kind of point, along corrected orbits."""
    if kind == "bp":
        fraction = 0.5
        if changes.real:
            va, vb = (probe.watched[changes.real[0]].real for probe in (a, b))
            fraction = va / (va - vb)
        return _locate_branch_point(problem, a, b, fraction)
    column = changes.column

    def value(node: OrbitNode) -> float:
        if kind == "lpc" or column is None:
            return float(node.tests[0])
        return float(matched(a.watched, near_circle(node.eigenvalues))[column].real)

    node = zero_between(problem, a.node, b.node, value)
    return None if node is None else describe(problem, kind, node, value(node))


def _locate_branch_point(problem: OrbitEquations, a: Probe, b: Probe, fraction: float) -> OrbitPoint | None:
    """Newton on the defining equations from a fraction of the way; None if it ends outside the interval.

    A mesh parts the two branches by about its error. With an unfolding term in the equations there is a point of both,
    and the term's size says how far it is from one of the discrete equations themselves.
    """
    na, nb = a.node, b.node
    found = solve_branch_point(problem, na.u + fraction * (nb.u - na.u))
    if found is None:
        return None
    u, unfolding = found
    offset, step = (u - na.u) / problem.scale, (nb.u - na.u) / problem.scale
    length = float(np.linalg.norm(step))
    ahead = float(step @ offset) / length
    if not -1e-3 * length <= ahead <= 1.001 * length or np.linalg.norm(offset) > 1.5 * length:
        return None
    exponents, trivial, liouville = problem.floquet(u, problem.linearise(u))
    arclength = na.arclength + ahead / length * (nb.arclength - na.arclength)
    tangent = step / length
    node = OrbitNode(
        u, tangent, arclength, eigenvalues=exponents, grid=problem.grid, trivial=trivial, liouville=liouville,
        residual=float(np.max(np.abs(problem.defects(u)))),
    )  # fmt: skip
    return describe(problem, "bp", node, float(np.min(np.abs(exponents))), unfolding)


def solve_branch_point(problem: OrbitEquations, u: np.ndarray) -> tuple[np.ndarray, float] | None:
    """A branch point of orbits from a guess of profile, period and parameter: u and the unfolding, or None.

    Unknown beside u is b in F + b psi = 0, psi the left null vector of the first guess; two scalars vanish.
    """
    size = problem.profile_size
    rows, corner = np.zeros((3, size)), np.zeros((3, 3))
    rows[0] = problem.phase_row(u, u)
    target = rows[0] @ u[:size]
    u, b = u.copy(), 0.0
    borders = direction = None
    sizes: list[float] = []
    try:
        for _ in range(2 * NEWTON_LIMIT):
            at = problem.linearise(u)
            if borders is None:
                borders = start_borders(problem, u, at, "bp")
            found = condition(problem, u, at, "bp", borders)
            if direction is None:
                direction = adjoint(found).reshape(*at.steps.shape[:2], 1)
                direction /= np.max(np.abs(direction))
            by = slopes(problem, u, found)
            rows[1:], corner[1:, :2] = by[:, :size], by[:, size : size + 2]
            inside = np.empty_like(direction)
            kernel.solve_inside(at.factors, at.orders, -direction, inside)
            steps = np.insert(at.steps, at.steps.shape[2] - 1, inside[:, :, 0], axis=2)
            steps[:, :, -1] += b * inside[:, :, 0]
            right = np.concatenate([[target - rows[0] @ u[:size]], -found.values])[:, None]
            x, lam, _, _ = chain.solve_periodic(np.ascontiguousarray(steps), rows, corner, right)
            step = np.concatenate([x[:, :, 0].ravel(), lam[:2, 0]])
            if not np.all(np.isfinite(step)):
                return None
            u += step
            b += float(lam[2, 0])
            if problem.settled(sizes):
                return u, b
            sizes.append(problem.change(step, u))
    except np.linalg.LinAlgError:
        pass
    return None


def describe(
    problem: OrbitEquations, kind: str, node: OrbitNode, here: float, unfolding: float = 0.0
) -> OrbitPoint:
    """A labelled orbit with normal-form coefficient, certificate and the direction of the other branch."""
    at = problem.linearise(node.u)
    orbit = problem.orbit(node)
    exponents = node.eigenvalues
    angle = coefficient = direction = None
    error = 10.0 * orbit.mesh_error
    checks = {"value that vanishes": (here, max(1e-7, error) if kind == "bp" else 1e-7)}
    if kind == "bp":
        checks["unfolding"] = (unfolding, max(1e-7, error))
    if kind == "ns":
        pairs = exponents[(exponents.imag > 0) & (exponents.imag < np.pi)]
        angle = float(pairs[np.argmin(np.abs(pairs.real))].imag)
    found = bordered(problem, node.u, at, kind, angle or 0.0)
    checks["bordered determinant"] = (float(np.max(np.abs(found.values))), max(1e-6, error))
    checks["trivial multiplier"] = (node.trivial_error, LOST if kind in ("lpc", "bp") else WRONG)
    if kind == "lpc":
        coefficient = lpc_coefficient(problem, node.u)
    elif kind == "pd":
        coefficient = pd_coefficient(problem, node.u)
        profile = null_profile(found)
        direction = np.append(profile.ravel(), np.zeros(1 + len(problem.along)))
    elif kind == "ns":
        coefficient = ns_coefficient(problem, node.u, float(angle or 0.0))
    else:
        direction = crossing(problem, node, at)
    return OrbitPoint(
        kind, problem.system.states, orbit.profile[0], orbit.parameters, problem.along, exponents, node.arclength,
        Certificate(orbit.residual, checks, {"mesh error": orbit.mesh_error}),
        orbit=orbit, angle=angle, coefficient=coefficient, direction=direction,
    )  # fmt: skip


def bordered(problem: OrbitEquations, u: np.ndarray, at: Linearised, kind: str, angle: float) -> Condition:
    """The bordered scalars of a kind at a point where they vanish, with borders of its own."""
    borders = start_borders(problem, u, at, kind, angle)
    found = condition(problem, u, at, kind, borders, angle)
    return condition(problem, u, at, kind, refreshed(found), angle)


def crossing(problem: OrbitEquations, node: OrbitNode, at: Linearised) -> np.ndarray:
    """The null vector across the branch's own tangent at a branch point, by inverse iteration."""
    size, count = problem.profile_size, 1 + len(problem.along)
    across = node.tangent / problem.scale
    rows, corner = np.zeros((2, size)), np.zeros((2, count))
    rows[0] = problem.phase_row(node.u, node.tangent * problem.scale)
    rows[1], corner[1] = across[:size], across[size:]
    random = np.random.default_rng(0)
    steps = at.steps.copy()
    right = random.normal(size=(*steps.shape[:2], 1))
    kernel.solve_inside(at.factors, at.orders, right, right_found := np.empty_like(right))
    steps[:, :, -1] = right_found[:, :, 0]
    x, lam, _, _ = chain.solve_periodic(steps, rows, corner, np.zeros((2, 1)))
    vector = np.concatenate([x[:, :, 0].ravel(), lam[:, 0]])
    return vector / np.linalg.norm(vector / problem.scale)
