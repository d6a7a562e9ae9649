"""Special points of a branch of periodic orbits: which kind, exactly where, and a certificate for each."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics import floquet
from rainwind.dynamics.continuation import zero_between
from rainwind.dynamics.inspection import Changes, Inspector, Probe, pace
from rainwind.dynamics.kernels import chain
from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.kernels.screening import hasty
from rainwind.dynamics.orbit_conditions import Condition, condition, null_profile, refreshed, start_borders
from rainwind.dynamics.orbit_equations import Linearised, OrbitEquations, OrbitNode
try:
    from rainwind.dynamics.orbit_normal_forms import lpc_coefficient, ns_coefficient, pd_coefficient
except ImportError:
    lpc_coefficient = pd_coefficient = ns_coefficient = lambda *a: float("nan")
from rainwind.dynamics.orbit_results import OrbitPoint
from rainwind.dynamics.results import Certificate, Unexplained

Complex = NDArray[np.complex128]

FARTHEST = -12.0  # log|mu| below which nothing is watched: what is far inside the circle only makes noise


@dataclass(frozen=True)
class OrbitInspector(Inspector):
    """Reads a branch of orbits in one parameter: folds, period doublings, Neimark-Sacker and branch points."""

    most_probes: int = 60

    def watched(self, before: Complex, node: OrbitNode) -> Complex:  # type: ignore[override]
        """The exponents of a node in the order of those before."""
        return self.in_order(before, watched(node))

    def in_order(self, before: Complex, after: Complex) -> Complex:
        """Exponents in the order of those before."""
        return floquet.matched(before, after)

    def sorted_changes(self, changes: Changes, a: Probe, b: Probe) -> Changes:
        """Crossings of two negative multipliers are apart from those of a complex pair."""
        negative = tuple(k for k in changes.pairs if np.pi == abs(a.watched[k].imag) == abs(b.watched[k].imag))
        return replace(changes, negative=negative, pairs=tuple(k for k in changes.pairs if k not in negative))


def orbit_inspector(problem: OrbitEquations) -> OrbitInspector:
    """Reads orbits on the problem's grid."""
    return OrbitInspector(
        problem, (True, False), _classify, lambda *event: _locate(problem, *event)
    )


def watched(node: OrbitNode) -> Complex:
    """The exponents that may cross the unit circle."""
    return np.maximum(node.eigenvalues.real, FARTHEST) + 1j * node.eigenvalues.imag


def labels(problem: OrbitEquations, nodes: list[OrbitNode]) -> tuple[list[OrbitPoint], list[Unexplained]]:
    """All special points between the nodes of a walk, and the changes that none explains."""
    points: list[OrbitPoint] = []
    unexplained: list[Unexplained] = []
    if len(nodes) < 2:
        return points, unexplained
    probes = [Probe(nodes[0], watched(nodes[0]), np.zeros(problem.n + 1))]
    for node in nodes[1:]:
        ordered = floquet.matched(probes[-1].watched, watched(node))
        probes.append(Probe(node, ordered, np.zeros(problem.n + 1)))
    paces = [pace(a, b) for a, b in zip(probes[:-1], probes[1:], strict=True)]
    continuous = np.array([True, False])
    last = len(paces) - 1
    for i, (a, b) in enumerate(zip(probes[:-1], probes[1:], strict=True)):
        # the pace just before the interval and just after it
        a, b = replace(a, pace=paces[max(i - 1, 0)]), replace(b, pace=paces[min(i + 1, last)])
        length = b.node.arclength - a.node.arclength
        changed = np.any((a.values > 0) != (b.values > 0))
        if not changed and not hasty(a.values, b.values, np.maximum(a.pace, b.pace), length, continuous):
            continue
        here = problem.on(b.node.grid)
        a = _on_grid(here, a)
        if a is not None:
            orbit_inspector(here).explain(a, b, points, unexplained)
    return sorted(points, key=lambda p: p.arclength), sorted(unexplained, key=lambda u: u.between)


def _on_grid(problem: OrbitEquations, a: Probe) -> Probe | None:
    """A probe on the problem's grid."""
    node: OrbitNode = a.node  # type: ignore[assignment]
    if node.grid is problem.grid:
        return a
    before = problem.on(node.grid)
    u = before.moved(node.u, problem.grid)
    tangent = before.moved(node.tangent * before.scale, problem.grid) / problem.scale
    found = problem.correct(node, u, tangent / np.linalg.norm(tangent))
    if found is None:
        return None
    ordered = floquet.matched(a.watched, watched(found))
    return replace(a, node=replace(found, arclength=node.arclength), watched=ordered)


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
    column = (changes.real or changes.negative or changes.pairs or (None,))[0]

    def value(node: OrbitNode) -> float:
        if kind == "lpc" or column is None:
            return float(node.tests[0])
        return float(floquet.matched(a.watched, watched(node))[column].real)

    node = zero_between(problem, a.node, b.node, value)
    return None if node is None else describe(problem, kind, node, value(node))


def describe(problem: OrbitEquations, kind: str, node: OrbitNode, here: float) -> OrbitPoint:
    """A labelled orbit with normal-form coefficient, certificate and the direction of the other branch."""
    at = problem.linearise(node.u)
    orbit = problem.orbit(node)
    exponents = node.eigenvalues
    angle = coefficient = direction = None
    checks = {"value that vanishes": (here, 1e-7)}
    if kind == "ns":
        pairs = exponents[(exponents.imag > 0) & (exponents.imag < np.pi)]
        angle = float(pairs[np.argmin(np.abs(pairs.real))].imag)
    found = bordered(problem, node.u, at, kind, angle or 0.0)
    checks["bordered determinant"] = (float(np.max(np.abs(found.values))), 1e-6)
    if kind != "lpc":  # there the trivial multiplier is double, and moves like the root of the error
        checks["trivial multiplier"] = (abs(node.trivial), max(1e-6, 10 * orbit.mesh_error))
    if kind == "lpc":
        coefficient = lpc_coefficient(problem, node.u)
    elif kind == "pd":
        coefficient = pd_coefficient(problem, node.u)
        profile = null_profile(at, found)
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
    return condition(problem, u, at, kind, refreshed(found, at), angle)


def crossing(problem: OrbitEquations, node: OrbitNode, at: Linearised) -> np.ndarray:
    """The null vector across the branch's own tangent at a branch point, by inverse iteration."""
    size, count = problem.profile_size, 1 + len(problem.along)
    across = node.tangent / problem.scale
    rows, corner = np.zeros((2, size)), np.zeros((2, count))
    rows[0] = problem.phase_row(problem.profile(node.u), problem.profile(node.tangent * problem.scale))
    rows[1], corner[1] = across[:size], across[size:]
    random = np.random.default_rng(0)
    steps = at.steps.copy()
    right = random.normal(size=(*steps.shape[:2], 1))
    kernel.solve_inside(at.factors, at.orders, right, right_found := np.empty_like(right))
    steps[:, :, -1] = right_found[:, :, 0]
    x, lam, _, _ = chain.solve_periodic(steps, rows, corner, np.zeros((2, 1)))
    vector = np.concatenate([x[:, :, 0].ravel(), lam[:, 0]])
    return vector / np.linalg.norm(vector / problem.scale)
