"""Periodic orbits: follow them in one parameter, from a Hopf point, an orbit or a labelled orbit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rainwind.dynamics.bifurcations import describe as describe_equilibrium
from rainwind.dynamics.bifurcations import solve_hopf
from rainwind.dynamics.branches import check_states, check_steps, window_of
from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.equations import smallest_step
from rainwind.dynamics.monitors import Monitor, checked
from rainwind.dynamics.newton import state_scale
from rainwind.dynamics.orbit_bifurcations import orbit_inspector
from rainwind.dynamics.orbit_equations import OrbitEquations, OrbitNode
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.orbit_walks import (
    Progress,
    Route,
    back_at_start,
    both_ways,
    check_mesh,
    joined,
    on_grid_of,
    product,
    swing_turned,
    walked,
)
from rainwind.dynamics.results import Ended, SpecialPoint
from rainwind.dynamics.system import System, as_system, number
from rainwind.errors import ComputationError, InputError
from rainwind.parameters import unknown_name


def continue_orbits(
    model: Any,
    along: str,
    *,
    start: Any,
    until: tuple[float, float],
    ds: float = 0.05,
    mesh: Mesh | None = None,
    longest: float = 100.0,
    limit: int = 5000,
    progress: Progress | None = None,
    monitors: Sequence[Monitor] = (),
) -> OrbitBranch:
    """The branch of periodic orbits through `start` in one parameter, within the window `until`.

    start: a Hopf point of a branch of equilibria; an Orbit (as `find_orbit` gives); or a labelled orbit: pd leads to
    the orbits of twice the period, bp onto the other branch, lpc and ns onto the branch that they lie on.
    ds: first and largest step of arclength: the root mean square of the states over a period, with the period in units
    of itself and the window as 20. mesh: intervals and degree of the collocation. longest: the walk ends where the
    period has grown by this factor. limit: points a direction. progress(orbit, count) is called after every orbit.
    monitors: functions of the orbit to record, label or stop at (`Monitor`).
    Raises InputError for bad input and ComputationError when not even the start could be computed.
    """
    check_steps(ds, limit)
    if number(longest, "longest") <= 1.0:
        raise InputError(f"longest = {longest!r}: the factor by which the period may grow must be above 1")
    problem, node, beginning = _start(as_system(model), along, start, until, ds, mesh)

    def passed(a: OrbitNode, b: OrbitNode, count: int) -> tuple[Ended | None, list[Any]]:
        return _passed(problem, beginning, node, a, b, count)

    watched = checked(monitors, (*problem.system.states, *problem.system.parameters, "period"))
    born = beginning.kind in ("hopf", "pd")  # the start itself is no orbit of this branch
    route = Route(
        problem, problem.window([window_of(problem.system, along, until)]), orbit_inspector(problem), ds, passed,
        not born, limit, longest * problem.parts(node.u)[1], progress, watched,
    )  # fmt: skip
    halves = [walked(route, node)] if born else both_ways(route, node)
    first = {"hopf": Ended.AT_HOPF, "pd": Ended.REVISITED}.get(beginning.kind, halves[0].ended)
    extra = [replace(beginning.point, arclength=0.0, along=problem.along)] if beginning.kind == "hopf" else []  # type: ignore[type-var]
    return joined("orbits", route, halves, first, extra)


@dataclass(frozen=True)
class _Beginning:
    """Where a walk began: the kind of its start, and the labelled point it left, if any."""

    kind: str  # hopf, orbit, pd, bp
    point: SpecialPoint | None = None


def _passed(
    problem: OrbitEquations, beginning: _Beginning, start: OrbitNode, a: OrbitNode, b: OrbitNode, count: int
) -> tuple[Ended | None, list[Any]]:
    """What the step from a to b went through that ends the walk: a Hopf point, the mother branch, the start."""
    if not count:
        return None, []
    if swing_turned(problem, a, b):
        return Ended.AT_HOPF, _hopf_at_end(problem, a, b)
    if beginning.kind == "pd":
        here = problem.on(b.grid)
        halves = [_half_period_difference(here, here.profile(u)) for u in (on_grid_of(problem, a, b), b.u)]
        if product(here, *halves) < 0:
            return Ended.REVISITED, []
    return (back_at_start(problem, a, b, start) if beginning.kind == "orbit" and count >= 3 else None), []


def _half_period_difference(problem: OrbitEquations, x: np.ndarray) -> np.ndarray:
    """x(t + T/2) - x(t): zero where the orbit has half the period."""
    grid = problem.grid
    return grid.at(x, np.mod(grid.nodes + 0.5, 1.0)) - x


def _hopf_at_end(problem: OrbitEquations, a: OrbitNode, b: OrbitNode) -> list[SpecialPoint]:
    """The Hopf point between two orbits on both sides of it, where Newton finds it nearby."""
    (xa, period, pa), (xb, _, pb) = problem.on(a.grid).parts(a.u), problem.on(b.grid).parts(b.u)
    means = [problem.on(node.grid).grid.quadrature @ x for node, x in ((a, xa), (b, xb))]
    guess = np.append(0.5 * (means[0] + means[1]), 0.5 * (pa[0] + pb[0]))
    scale = np.append(state_scale(guess[:-1]), problem.parameter_units[0])
    found = solve_hopf(problem.system, problem.along, guess, 2.0 * np.pi / period, scale)
    if found is None or np.max(np.abs((found[0][:-1] - guess) / scale)) > 0.1:
        return []
    u, residual = found
    parameters = {**problem.system.parameters, problem.along[0]: float(u[problem.n])}
    arclength = 0.5 * (a.arclength + b.arclength)
    point = describe_equilibrium(
        problem.system, "hopf", u[: problem.n], parameters, problem.along, arclength, residual, u[-1:]
    )
    return [point]


def _start(
    system: System, along: str, start: Any, until: Sequence[float], ds: float, mesh: Mesh | None
) -> tuple[OrbitEquations, OrbitNode, _Beginning]:
    """The problem of a branch of orbits and its first node. Raises InputError and ComputationError."""
    if not isinstance(along, str) or along not in system.parameters:
        raise unknown_name(str(along), system.parameters, "parameter")
    low, high = window_of(system, along, until)  # type: ignore[arg-type]
    check_mesh(mesh)
    kind = getattr(start, "kind", "orbit")
    hopf = isinstance(start, SpecialPoint) and not isinstance(start, OrbitPoint)
    if not isinstance(start, Orbit | OrbitPoint) and not (hopf and kind == "hopf"):
        given = f"a {kind} point" if hopf else type(start).__name__
        raise InputError(
            f"orbits start from a Hopf point, an Orbit (see find_orbit) or a labelled orbit; got {given}"
        )
    check_states(system, start)
    system = system.with_parameters({k: v for k, v in start.parameters.items() if k in system.parameters})
    value = system.parameters[along]
    if not low <= value <= high:
        raise InputError(
            f"start: {along} = {value:g} lies outside until = ({low:g}, {high:g}); move one of them"
        )
    unit = (high - low) / 20.0
    if not isinstance(start, Orbit | OrbitPoint):
        return _from_hopf(system, along, start, unit, mesh or Mesh())
    point = start if isinstance(start, OrbitPoint) else None
    orbit: Orbit = start.orbit if isinstance(start, OrbitPoint) else start
    kind = kind if kind in ("pd", "bp") else "orbit"
    grid, x, period = orbit.grid, orbit.profile, orbit.period
    if kind == "pd":
        grid = Grid(np.concatenate([0.5 * grid.times, 0.5 + 0.5 * grid.times[1:]]), grid.degree)
        x, period = np.vstack([x, x[1:]]), 2.0 * period
    if mesh is None:
        mesh = Mesh(len(grid.lengths), grid.degree)
    units = np.maximum(1.0, np.abs(x).max(axis=0))
    if grid.degree != mesh.degree or (kind == "orbit" and not grid.has(mesh)):
        grid, x = grid.refitted(x, mesh)
    problem = OrbitEquations(system, (along,), grid, units, period, np.array([unit]), mesh)
    u = np.concatenate([x.ravel(), [period, value]])
    switched = point if kind in ("pd", "bp") else None
    node = (
        _beside(problem, u, _direction(problem, switched, kind), ds) if switched else first_node(problem, u)
    )
    if node is None or (switched is None and not low - unit < node.u[-1] < high + unit):
        raise ComputationError(
            f"Newton does not find an orbit from the start at {along} = {value:g}; give a nearer one, or a finer mesh"
        )
    return problem, node, _Beginning(kind, point)


def _from_hopf(
    system: System, along: str, start: SpecialPoint, unit: float, mesh: Mesh
) -> tuple[OrbitEquations, OrbitNode, _Beginning]:
    """The Hopf point as an orbit without size; the branch leaves it along the critical eigenvector."""
    scale = np.append(state_scale(start.state), unit)
    value = system.parameters[along]
    guess = np.append(start.state, value)
    omega = start.omega[0] if isinstance(start.omega, tuple) else float(start.omega or 0.0)
    found = solve_hopf(system, (along,), guess, omega, scale)
    if found is None:
        raise ComputationError(f"Newton did not find the Hopf point again at {along} = {value:g}")
    state, value, omega = found[0][:-2], float(found[0][-2]), float(np.sqrt(found[0][-1]))
    eigenvalues, vectors = np.linalg.eig(system.jacobian(state, {along: value}))
    q = vectors[:, np.argmin(np.abs(eigenvalues - 1j * omega))]
    grid = Grid.even(mesh)
    period = 2.0 * np.pi / omega
    problem = OrbitEquations(system, (along,), grid, state_scale(state), period, np.array([unit]), mesh)
    swing = np.real(q * np.exp(2j * np.pi * grid.nodes)[:, None])
    u = np.concatenate([np.tile(state, len(swing)), [period, value]])
    tangent = np.append(swing.ravel(), [0.0, 0.0]) / problem.scale
    node = OrbitNode(u, tangent / np.linalg.norm(tangent), grid=grid)
    return problem, node, _Beginning("hopf", start)


def first_node(problem: OrbitEquations, u: np.ndarray) -> OrbitNode | None:
    """The orbit that Newton reaches from u at the same parameter, or at a fold at the same size."""
    tangents = []
    for k in (-1, problem.profile_size):
        tangent = np.zeros_like(u)
        tangent[k] = 1.0
        tangents.append(tangent)
    x = problem.profile(u)
    swing = np.append((x - problem.grid.quadrature @ x).ravel(), np.zeros(u.size - x.size)) / problem.scale
    length = float(np.linalg.norm(swing))
    if not length > 0.0:
        return None
    tangents.insert(1, swing / length)
    for tangent in tangents:
        node = problem.correct(OrbitNode(u, tangent, grid=problem.grid), u, tangent)
        if node is not None:
            node = node if node.tangent[-1] >= 0 else problem.correct(node, node.u, -node.tangent)
        if node is not None:
            return replace(node, arclength=0.0)
    return None


def _direction(problem: OrbitEquations, start: OrbitPoint, kind: str) -> np.ndarray:
    """The other branch's direction at a labelled orbit, in the unknowns of the problem."""
    direction = start.direction
    if direction is None:
        raise InputError(f"this {start.kind} point does not know the direction of its other branch")
    n = problem.n
    profile = direction[: start.orbit.profile.size].reshape(-1, n)
    rest = np.append(direction[profile.size], direction[profile.size + 1 :][:1])
    if kind == "pd":  # the critical disturbance changes its sign after one period
        profile = np.vstack([profile, -profile[1:]])
    tangent = np.append(profile.ravel(), rest) / problem.scale
    return tangent / np.linalg.norm(tangent)


def _beside(problem: OrbitEquations, u: np.ndarray, tangent: np.ndarray, ds: float) -> OrbitNode | None:
    """An orbit of the other branch beside a labelled one, in which itself Newton's matrix is singular.

    tangent: across the branch that was left, but not always along the other one. What turns away from that tangent
    as far as the chord from the labelled orbit does lies on a branch that crosses; what turns twice as far, on an arc
    of the branch that was left.
    """
    step = ds / 2
    while step > smallest_step(ds):
        node = problem.correct(
            OrbitNode(u, tangent, grid=problem.grid), u + step * tangent * problem.scale, tangent
        )
        if node is not None:
            chord = (node.u - u) / problem.scale
            length = float(np.linalg.norm(chord))
            turned = float(node.tangent @ tangent) * length / step
            if length < 2.0 * ds and 0.7 < abs(turned) < 1.4:
                return replace(node, tangent=np.sign(turned) * node.tangent, arclength=length)
        step /= 2
    return None
