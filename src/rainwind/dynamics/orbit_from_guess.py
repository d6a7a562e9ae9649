"""The orbit that Newton reaches from a guess: on a mesh of its own, with as many intervals as it needs."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.kernels.chain import solve_periodic
from rainwind.dynamics.orbit_equations import OrbitEquations, OrbitNode
from rainwind.dynamics.orbit_results import Orbit
from rainwind.dynamics.system import System

CLOSED = 1e-3  # of its range: apart no more, the ends of a guess belong together
APPROACHES, LONGEST_STEP = 40, 0.2  # of Newton's method from afar; the step in each unknown's size
FINE = 1e-6  # estimated error of the profile above which the mesh gets more intervals
REFINEMENTS = 8
_NO_PARAMETER = "(none)"

Guess = Callable[[np.ndarray], np.ndarray]
"""Phases in [0, 1] (k,) -> states (k, n); the ends need not meet."""


def orbit_near(
    system: System, guess: Guess, period: float, mesh: Mesh, *, patient: bool = True
) -> Orbit | None:
    """The orbit that Newton reaches from a guess by phase on [0, 1], which need not close; its least period."""
    found = _on_adapted_mesh(system, guess, period, mesh, mesh.intervals, patient)
    if found is None and gap_of(guess) < CLOSED:  # then it is the mesh's fault
        found = _on_adapted_mesh(system, guess, period, mesh, min(4 * mesh.intervals, mesh.most), patient)
    for _ in range(4):
        parts = _repeats(found) if found is not None else 1
        if found is None or parts == 1:
            return found
        whole = found
        found = _on_adapted_mesh(
            system,
            lambda s, o=whole, k=parts: o.at(o.period * s / k),
            whole.period / parts,
            mesh,
            mesh.intervals,
            patient,
        )
    return found


def _on_adapted_mesh(
    system: System, guess: Guess, period: float, mesh: Mesh, many: int, patient: bool
) -> Orbit | None:
    """The orbit that Newton reaches, beginning with as many intervals."""
    free = system
    if not system.parameters:  # the equations need one, if only to hold it
        free = System(lambda x, p: system.rhs(x, {}), system.states, {_NO_PARAMETER: 1.0})
    along = next(iter(free.parameters))
    value = free.parameters[along]
    grid, x = _first_mesh(guess, mesh.degree, many)
    for turn in range(REFINEMENTS):
        units = np.maximum(1.0, np.abs(x).max(axis=0))
        problem = OrbitEquations(free, (along,), grid, units, period, np.array([max(1.0, abs(value))]), mesh)
        u = np.concatenate([x.ravel(), [period, value]])
        tangent = np.zeros(u.size)
        tangent[-1] = 1.0  # across it lie the orbits of this parameter
        with np.errstate(all="ignore"):
            node = problem.correct(OrbitNode(u, tangent, grid=grid), u, tangent)
            if node is None and turn == 0 and patient:
                nearer = _approached(problem, u)
                node = (
                    None
                    if nearer is None
                    else problem.correct(OrbitNode(nearer, tangent, grid=grid), nearer, tangent)
                )
        if node is None:
            return None
        x, period, _ = problem.parts(node.u)
        if not 0.0 < period < np.inf:
            return None
        error, many = problem.mesh_error(x), len(grid.lengths)
        if turn == REFINEMENTS - 1 or (turn > 0 and (error < FINE or many >= mesh.most)):
            return replace(problem.orbit(node), parameters=dict(system.parameters))
        # the error falls like intervals^-(degree + 1)
        growth = (2.0 * error / FINE) ** (1.0 / (mesh.degree + 1)) if error > FINE else 1.0
        many = min(int(np.ceil(many * min(growth, 2.0))), mesh.most)
        other = grid.adapted(x, np.maximum(1.0, np.abs(x).max(axis=0)), many)
        x, grid = grid.at(x, other.nodes), other
    return None


def _approached(problem: OrbitEquations, u: np.ndarray) -> np.ndarray | None:
    """Nearer to an orbit of the same parameter by Newton's method with steps cut short; None where it goes nowhere."""
    size = problem.profile_size
    for _ in range(APPROACHES):
        at = problem.linearise(u)
        rows, corner = np.zeros((2, size)), np.zeros((2, 2))
        rows[0] = problem.phase_row(u, u)
        corner[1, 1] = 1.0
        profile, rest, *_ = solve_periodic(at.steps, rows, corner, np.zeros((2, 1)))
        step = np.concatenate([profile.ravel(), rest.ravel()])
        length = problem.change(step, u)
        if not np.isfinite(length):
            return None
        u = u + min(1.0, LONGEST_STEP / length) * step if length > 0.0 else u
        if not u[size] > 0.0:
            return None
        if length < 1e-3:
            return u
    return None


def _first_mesh(guess: Guess, degree: int, many: int) -> tuple[Grid, np.ndarray]:
    """A mesh whose intervals share time and way evenly, and the guess on it, closed."""
    phases = np.linspace(0.0, 1.0, 50 * many + 1)
    states = guess(phases)
    gap = states[-1] - states[0]
    spread = np.maximum(np.ptp(states, axis=0), 1e-300)
    way = np.linalg.norm(np.diff(states, axis=0) / spread, axis=1)
    mass = np.concatenate([[0.0], np.cumsum(way / max(way.sum(), 1e-300) + np.diff(phases))])
    times = np.interp(np.linspace(0.0, mass[-1], many + 1), mass, phases)
    times[0], times[-1] = 0.0, 1.0
    grid = Grid(times, degree)
    return grid, guess(grid.nodes) - grid.nodes[:, None] * gap


def gap_of(guess: Guess) -> float:
    """How far the ends of a guess are apart, as a share of its range."""
    states = guess(np.linspace(0.0, 1.0, 201))
    spread = np.maximum(np.ptp(states, axis=0), 1e-300)
    return float(np.max(np.abs(states[-1] - states[0]) / spread))


def _repeats(orbit: Orbit) -> int:
    """How many times the orbit goes round within its period."""
    phases = np.linspace(0.0, 1.0, 200, endpoint=False)
    here = orbit.at(orbit.period * phases)
    spread = np.maximum(np.ptp(here, axis=0), 1e-300)
    error = max(1e-6, 100.0 * orbit.mesh_error)
    for parts in (2, 3, 5, 7):
        there = orbit.at(orbit.period * (phases + 1.0 / parts))
        if np.max(np.abs(there - here) / spread) < error:
            return parts
    return 1
