"""From a start to a finished branch or curve of orbits: walk, read the labels, join the halves."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.continuation import Walk
from rainwind.dynamics.monitors import Event, Monitor, events_between
from rainwind.dynamics.monitors import values as values_of
from rainwind.dynamics.orbit_bifurcations import OrbitInspector
from rainwind.dynamics.orbit_equations import USELESS, OrbitEquations, OrbitNode
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.results import Ended, Unexplained
from rainwind.errors import InputError, is_interrupt

_LOOKS = 12
_STILL = (12, 1e-9)  # so many orbits in a row; of the parameter's unit
_TWIN = 1e-3  # of log mu: beside the trivial multiplier a second one is 1, to the root of rounding
_SAME = 1e-5  # in units: how near to its start a closed walk comes

Progress = Callable[[Orbit, int], None]
Passed = Callable[[OrbitNode, OrbitNode, int], tuple[Ended | None, list[Any]]]


@dataclass(frozen=True)
class Route:
    """How far a walk along orbits goes, and what it reads.

    window: bounds of unknowns, by number; passed(a, b, count): why a step from node a to node b ends the walk, if it
    does, and the points to label there; begins: whether the start itself is an orbit of the branch; limit: nodes a
    direction; longest: period.
    """

    problem: OrbitEquations
    window: dict[int, tuple[float, float]]
    inspector: OrbitInspector
    ds: float
    passed: Passed
    begins: bool = True
    limit: int = 5000
    longest: float = np.inf
    progress: Progress | None = None
    monitors: tuple[Monitor, ...] = ()


@dataclass
class Half:
    """One direction of a branch, its arclength counted from the start."""

    nodes: list[OrbitNode]
    orbits: list[Orbit]
    ended: Ended
    points: list[Any]
    gaps: list[Unexplained]


def check_mesh(mesh: Mesh | None) -> None:
    """Raises InputError for a mesh that is none."""
    if mesh is not None and not isinstance(mesh, Mesh):
        raise InputError(f"mesh must be a Mesh, for example Mesh(intervals=40, degree=4); got {mesh!r}")


def walked(route: Route, start: OrbitNode) -> Half:
    """Walk from a node in its tangent's direction until something ends it, then read the labels."""
    problem = route.problem
    walk = Walk(problem, start, ds=route.ds, window=route.window)
    nodes, orbits = ([start], [problem.on(start.grid).orbit(start)]) if route.begins else ([], [])
    before, points, ended = start, [], None
    stops = [monitor for monitor in route.monitors if monitor.at_zero == "stop"]
    try:
        for node in walk:
            ended, points = route.passed(before, node, len(nodes))
            if ended is Ended.CLOSED and orbits:
                nodes.append(replace(start, arclength=node.arclength))
                orbits.append(orbits[0])
            if ended is not None:
                break
            orbit = problem.on(node.grid).orbit(node)
            ended = _unusable(problem, orbit)
            if ended is not None:
                break
            events = _events(route, stops, before, node) if nodes else []
            if events:
                node, ended = events[0].node, Ended.AT_CONDITION
                orbit = problem.on(node.grid).orbit(node)
                points = [_label(problem, events[0])]
            nodes.append(node)
            orbits.append(orbit)
            if route.progress is not None:
                route.progress(orbit, len(orbits))
            if ended is None and orbit.period > route.longest:
                ended = Ended.HOMOCLINIC
            elif ended is None and _vertical(route, nodes, orbits):
                ended = Ended.FAMILY
            elif ended is None and len(nodes) >= route.limit:
                ended = Ended.TOO_MANY_POINTS
            if ended is not None:
                break
            before = node
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
        ended = Ended.INTERRUPTED
    if walk.ended is Ended.STEP_TOO_SMALL and ended is None and orbits and _coarse(problem, orbits[-1]):
        ended = Ended.MESH_AT_LIMIT
    found, gaps = route.inspector.read(nodes)
    labelled = [monitor for monitor in route.monitors if monitor.at_zero == "label"]
    if labelled:
        for a, b in pairwise(nodes):
            points += [_label(problem, event) for event in _events(route, labelled, a, b)]
    return Half(nodes, orbits, ended or walk.ended, [*found, *points], gaps)  # type: ignore[arg-type]


def _vertical(route: Route, nodes: Sequence[OrbitNode], orbits: Sequence[Orbit]) -> bool:
    """Whether the parameter has stood still, to rounding, over the last orbits: a whole family at one value."""
    if len(nodes) <= _STILL[0] or len(route.problem.along) > 1:
        return False
    # towards a homoclinic orbit it stands still too, but no second multiplier is 1 there
    if any(np.abs(orbit.exponents).min(initial=np.inf) > _TWIN for orbit in orbits[-_STILL[0] :]):
        return False
    last = nodes[-_STILL[0] :]
    values = [route.problem.on(node.grid).parts(node.u)[2][0] for node in last]
    far = last[-1].arclength - last[0].arclength > 2.0 * route.ds
    return far and bool(np.ptp(values) < _STILL[1] * route.problem.parameter_units[0])


def _events(route: Route, monitors: Sequence[Monitor], a: OrbitNode, b: OrbitNode) -> list[Event]:
    """The zeros of monitors between two neighbouring nodes."""
    if not monitors:
        return []
    here = route.problem.on(b.grid)
    before, after = ([m.value(route.problem.on(node.grid).orbit(node)) for m in monitors] for node in (a, b))
    if all((x > 0) == (y > 0) for x, y in zip(before, after, strict=True)):
        return []
    moved = route.inspector.on(b.grid).node_on_grid(a)
    if moved is None:
        return []
    return events_between(monitors, here, moved, b, before, after, here.orbit)


def _label(problem: OrbitEquations, event: Event) -> OrbitPoint:
    orbit = problem.on(event.node.grid).orbit(event.node)
    return OrbitPoint(
        "event", problem.system.states, orbit.profile[0], orbit.parameters, problem.along, orbit.exponents,
        event.node.arclength, event.certificate(orbit.residual), note=event.monitor.name, orbit=orbit,
    )  # fmt: skip


def _coarse(problem: OrbitEquations, orbit: Orbit) -> bool:
    """Whether the mesh is as fine as allowed and yet too coarse to go on."""
    return len(orbit.grid.lengths) >= problem.mesh.most and orbit.mesh_error > 0.1 * USELESS


def _unusable(problem: OrbitEquations, orbit: Orbit) -> Ended | None:
    """Why an orbit may not be kept: the model refuses a state of it, or no mesh allowed is fine enough."""
    refusal = problem.system.refusal
    if refusal is not None and any(
        refusal(x, orbit.parameters) is not None for x in orbit.profile[:: orbit.grid.degree]
    ):
        return Ended.REFUSED
    if len(orbit.grid.lengths) >= problem.mesh.most and orbit.mesh_error > USELESS:
        return Ended.MESH_AT_LIMIT
    return None


def both_ways(route: Route, start: OrbitNode) -> list[Half]:
    """The halves of a branch: backward, if it is not closed, and forward."""
    ahead = walked(route, start)
    if ahead.ended in (Ended.CLOSED, Ended.INTERRUPTED):
        return [ahead]
    problem = route.problem.on(start.grid)
    turned = problem.correct(start, start.u, -start.tangent)
    if turned is None:
        return [ahead]
    return [walked(route, replace(turned, arclength=0.0)), ahead]


def joined(kind: str, route: Route, halves: list[Half], first: Ended, extra: list[Any]) -> OrbitBranch:
    """Both halves in one direction, the arclength counted from the first point.

    first: how the branch ends where it began, if there is one half; extra: more points to label.
    """
    problem = route.problem
    forward = halves[-1]
    nodes, orbits = list(forward.nodes), list(forward.orbits)
    lengths = [node.arclength for node in nodes]
    rates = [problem.tangent_parameters(node) for node in nodes]
    points, gaps = extra + list(forward.points), list(forward.gaps)
    if len(halves) == 2:
        back = halves[0]
        orbits = back.orbits[:0:-1] + orbits
        lengths = [-node.arclength for node in back.nodes[:0:-1]] + lengths
        rates = [-problem.tangent_parameters(node) for node in back.nodes[:0:-1]] + rates
        points = [replace(p, arclength=-p.arclength) for p in back.points] + points
        gaps = [
            replace(
                g, between=(-g.between[1], -g.between[0]), parameters=g.parameters[::-1], change=-g.change
            )
            for g in back.gaps[::-1]
        ] + gaps
    points = sorted(points, key=lambda p: p.arclength)
    shift = min([*lengths[:1], *(p.arclength for p in points[:1])], default=0.0)
    return OrbitBranch(
        kind=kind,
        states=problem.system.states,
        along=problem.along,
        parameters=dict(problem.system.parameters),
        orbits=tuple(orbits),
        arclength=np.array(lengths) - shift,
        tangent_parameter=np.array(rates).reshape(len(orbits), len(problem.along)),
        special=tuple(replace(p, arclength=p.arclength - shift) for p in points),
        ended=(halves[0].ended if len(halves) == 2 else first, forward.ended),
        unexplained=tuple(replace(g, between=(g.between[0] - shift, g.between[1] - shift)) for g in gaps),
        recorded=values_of(route.monitors, orbits),
    )


def swing_turned(problem: OrbitEquations, a: OrbitNode, b: OrbitNode) -> bool:
    """Whether the orbit shrank to a point between two nodes and came out on the other side of it."""
    last = problem.on(b.grid)
    x = last.profile(b.u)
    if np.max(np.abs(x[len(x) // 3] - x[0]) / problem.units) > 10.0 * (b.arclength - a.arclength):
        return False  # too large to have shrunk in this step
    swings = [
        x - last.grid.quadrature @ x for x in (last.profile(on_grid_of(problem, a, b)), last.profile(b.u))
    ]
    return product(last, *swings) < 0


def swing_size(problem: OrbitEquations, node: OrbitNode) -> float:
    """The root mean square of an orbit about its mean, states in their units."""
    here = problem.on(node.grid)
    x = here.profile(node.u)
    swing = x - here.grid.quadrature @ x
    return float(np.sqrt(product(here, swing, swing)))


def on_grid_of(problem: OrbitEquations, node: OrbitNode, other: OrbitNode) -> np.ndarray:
    """A node's unknowns, interpolated on the grid of another."""
    return node.u if node.grid is other.grid else problem.on(node.grid).moved(node.u, other.grid)


def product(problem: OrbitEquations, x: np.ndarray, y: np.ndarray) -> float:
    """The mean product of two profiles over the period, states in their units."""
    return float(problem.grid.quadrature @ np.sum(x * y / problem.units**2, axis=1))


def back_at_start(problem: OrbitEquations, a: OrbitNode, b: OrbitNode, start: OrbitNode) -> Ended | None:
    """Whether the walk passes its start between a and b: CLOSED in the start's direction, else REVISITED."""
    if not _passes(problem, a, b, start):
        return None
    rates = [problem.tangent_parameters(node) for node in (start, b)]
    return Ended.CLOSED if float(rates[0] @ rates[1]) >= 0.0 else Ended.REVISITED


def _passes(problem: OrbitEquations, a: OrbitNode, b: OrbitNode, start: OrbitNode) -> bool:
    """Whether the walk passes its start between a and b: by quantities that no shift along the orbit changes.

    A point between a and b is looked at where the start may lie off their chord only because the curve bends.
    """
    v0 = _invariants(problem.on(start.grid), start)
    here = problem.on(b.grid)
    first: Any = replace(a, u=on_grid_of(problem, a, b), tangent=b.tangent, grid=b.grid)
    last: Any = b
    for _ in range(_LOOKS):
        va, vb = (_invariants(here, node) for node in (first, last))
        step = vb - va
        length = float(np.linalg.norm(step))
        fraction = float((v0 - va) @ step) / length**2 if length else -1.0
        if not -0.1 <= fraction < 1.1:
            return False
        offset = float(np.linalg.norm(va + fraction * step - v0))
        if offset < _SAME:
            return 0.0 <= fraction < 1.0
        if offset > 0.5 * length:
            return False
        inside = min(max(fraction, 0.05), 0.95)
        u = first.u + inside * (last.u - first.u)
        found = here.correct(b, u, b.tangent)
        if found is None:
            return False
        vm = _invariants(here, found)
        before = float((v0 - vm) @ step) < 0.0
        first, last = (first, found) if before else (found, last)
    return False


def _invariants(problem: OrbitEquations, node: OrbitNode) -> np.ndarray:
    """Parameters, period, means and root mean squares, in their units."""
    x, period, p = problem.parts(node.u)
    weight = problem.grid.quadrature
    mean = weight @ x
    swing = np.sqrt(weight @ (x - mean) ** 2)
    parts = (
        p / problem.parameter_units,
        [period / problem.period_unit],
        mean / problem.units,
        swing / problem.units,
    )
    return np.concatenate(parts)
