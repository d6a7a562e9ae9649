"""Where a branch passes a value of its parameter: the equilibria and orbits there, computed at exactly that value.

Between two neighbours the guess is their interpolation; Newton goes from it with the parameter fixed. Where that
leaves the neighbours (close to a fold) the value is sought along the branch instead.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.continuation import zero_between
from rainwind.dynamics.equations import Equations
from rainwind.dynamics.equilibria import as_equilibrium
from rainwind.dynamics.kernels.equations import EQUILIBRIUM
from rainwind.dynamics.newton import solve_equilibrium, state_scale
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.orbit_equations import OrbitEquations, OrbitNode
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.results import Branch, Equilibrium
from rainwind.dynamics.system import System

_AT = 1e-9  # of the branch's span: a point this near to the value is there
_ALIKE = 2e-3  # of an orbit's size: two orbits of different branches that differ less all along are one
_SAME = 2e-5  # the same for orbits of one branch, which may be close to each other at a fold


def equilibria_at(system: System, branch: Branch, value: float) -> list[Equilibrium]:
    """Every equilibrium of a branch at one value of its parameter."""
    along = branch.along[0]
    system = system.with_parameters({along: value})
    places = [
        (s, np.append(x, p)) for s, x, p in zip(branch.arclength, branch.state, branch.parameter, strict=True)
    ]
    places += [(p.arclength, np.append(p.state, p.parameter)) for p in branch.special]
    points = np.array([u for _, u in sorted(places, key=lambda place: place[0])])
    span = float(np.ptp(points[:, -1])) or 1.0
    scale = np.append(state_scale(np.abs(branch.state).max(axis=0)), span)
    problem = Equations(EQUILIBRIUM, system, (along,), scale)
    found: list[Equilibrium] = []
    for i, j in _brackets(points[:, -1] - value, _AT * span):
        state = _equilibrium_between(problem, points[i], points[j], value)
        if state is not None and not any(same_state(state, other.state) for other in found):
            found.append(as_equilibrium(system, state))
    return found


def _equilibrium_between(problem: Equations, a: np.ndarray, b: np.ndarray, value: float) -> np.ndarray | None:
    system, scale = problem.system, problem.scale
    chord = (b - a) / scale
    length = float(np.linalg.norm(chord))
    if not length:
        found = solve_equilibrium(system, a[:-1])
        near = found is not None and np.linalg.norm((found[0] - a[:-1]) / scale[:-1]) < 1e-3
        return found[0] if near and found is not None else a[:-1]
    guess = a + (value - a[-1]) / (b[-1] - a[-1]) * (b - a)
    found = solve_equilibrium(system, guess[:-1])
    if found is not None and np.linalg.norm((found[0] - guess[:-1]) / scale[:-1]) < 0.2 * length:
        return found[0]
    secant = chord / length
    node = zero_between(problem, Node(a, secant), Node(b, secant, length), lambda node: node.u[-1] - value)
    return None if node is None else node.u[:-1]


def orbits_at(
    system: System,
    branch: OrbitBranch,
    value: float,
    *,
    like: Orbit | None = None,
    birth: OrbitPoint | None = None,
) -> list[Orbit]:
    """Every orbit of a branch at one value of its parameter; with `like`, only where its period and means fit.

    birth: the period doubling in which the branch begins.
    """
    along = branch.along[0]
    system = system.with_parameters({along: value})
    places: list[tuple[float, Orbit]] = list(zip(branch.arclength.tolist(), branch.orbits, strict=True))
    places += [(p.arclength, p.orbit) for p in branch.special if isinstance(p, OrbitPoint)]
    orbits = [orbit for _, orbit in sorted(places, key=lambda place: place[0])]
    parameter = np.array([orbit.parameters[along] for orbit in orbits])
    span = float(np.ptp(parameter)) if len(orbits) else 0.0
    found: list[Orbit] = []
    for i, j in _brackets(parameter - value, _AT * (span or 1.0)):
        if like is not None and not _fits(orbits[i], orbits[j], like):
            continue
        orbit = _orbit_between(system, along, orbits[i], orbits[j], value, span or 1.0)
        if orbit is not None and not any(same_orbit(orbit, other, alike=_SAME) for other in found):
            found.append(orbit)
    if like is None:
        for orbit in _beside_birth(system, branch, value, birth):
            if not any(same_orbit(orbit, other) for other in found):
                found.append(orbit)
    return found


def _orbit_between(system: System, along: str, a: Orbit, b: Orbit, value: float, unit: float) -> Orbit | None:
    problem = _problem(system, along, b, unit)
    first, last = _unknowns(a, along, b.grid), _unknowns(b, along, b.grid)
    chord = (last - first) / problem.scale
    length = float(np.linalg.norm(chord))
    part = (value - first[-1]) / (last[-1] - first[-1]) if first[-1] != last[-1] else 1.0
    node = _at_value(problem, first + part * (last - first), value, 0.5 * length + 1e-3)
    if node is None and length:
        secant = chord / length
        start = OrbitNode(first, secant, grid=b.grid)
        end = OrbitNode(last, secant, length, grid=b.grid)
        near = zero_between(problem, start, end, lambda node: node.u[-1] - value)
        # in the fold itself only the orbit beside the value is to be had
        node = near and (_at_value(problem, near.u.copy(), value, 1e-3 * length) or near)
    return None if node is None else problem.orbit(node)


def _at_value(problem: OrbitEquations, guess: np.ndarray, value: float, most: float) -> OrbitNode | None:
    """The orbit that Newton reaches from a guess with the parameter fixed, if it lies no farther than `most`."""
    guess[-1] = value
    across = np.zeros_like(guess)
    across[-1] = 1.0
    node = problem.correct(OrbitNode(guess, across, grid=problem.grid), guess, across)
    near = node is not None and np.linalg.norm((node.u - guess) / problem.scale) < most
    return node if near else None


def _beside_birth(
    system: System, branch: OrbitBranch, value: float, birth: OrbitPoint | None
) -> Iterator[Orbit]:
    """The orbit between a Hopf point or period doubling and the branch's first orbit: size goes like a square root."""
    along = branch.along[0]
    for point in [*branch.points("hopf"), *([birth] if birth is not None else [])]:
        if not len(branch):
            return
        first = branch.orbits[0 if point is birth or point.arclength <= branch.arclength[0] else -1]
        here, beyond = point.parameter, first.parameters[along]
        if not min(here, beyond) < value < max(here, beyond):
            continue
        problem = _problem(system, along, first, abs(beyond - here) or 1.0)
        u = _unknowns(first, along, first.grid)
        if isinstance(point, OrbitPoint):
            mother = doubled(point.orbit)
            origin = mother.grid.at(mother.profile, first.grid.nodes)
        else:
            origin = np.tile(point.state, (len(first.profile), 1))
        part = (value - here) / (beyond - here)
        shift = first.grid.quadrature @ (first.profile - origin)
        swing = first.profile - origin - shift
        u[: first.profile.size] = (origin + part * shift + np.sqrt(part) * swing).ravel()
        node = _at_value(problem, u, value, float("inf"))
        if node is not None:
            orbit = problem.orbit(node)
            size = np.abs(orbit.profile - origin - part * shift).max() / np.abs(swing).max()
            if 1e-3 < size < 1.5:
                yield orbit


def _problem(system: System, along: str, orbit: Orbit, unit: float) -> OrbitEquations:
    units = state_scale(np.abs(orbit.profile).max(axis=0))
    mesh = Mesh(len(orbit.grid.lengths), orbit.grid.degree)
    return OrbitEquations(system, (along,), orbit.grid, units, orbit.period, np.array([unit]), mesh)


def _unknowns(orbit: Orbit, along: str, grid: Grid) -> np.ndarray:
    profile = orbit.profile if orbit.grid is grid else orbit.grid.at(orbit.profile, grid.nodes)
    return np.concatenate([profile.ravel(), [orbit.period, orbit.parameters[along]]])


def _brackets(level: np.ndarray, zero: float) -> Iterator[tuple[int, int]]:
    """Numbers of the points between which a level vanishes, twice the same where it does in a point."""
    at = np.abs(level) <= zero
    for i in range(len(level)):
        if at[i]:
            yield i, i
        elif i + 1 < len(level) and not at[i + 1] and level[i] * level[i + 1] < 0:
            yield i, i + 1


def lies_on(system: System, branch: OrbitBranch, orbit: Orbit) -> bool:
    """Whether an orbit belongs to a branch."""
    value = orbit.parameters[branch.along[0]]
    return any(same_orbit(orbit, other) for other in orbits_at(system, branch, value, like=orbit))


def same_state(a: np.ndarray, b: np.ndarray, turns: np.ndarray | None = None) -> bool:
    """Whether two equilibria are one; turns (n,): which states are angles, that count modulo 2 pi."""
    difference = a - b
    if turns is not None:
        difference = np.where(turns, difference - 2 * np.pi * np.round(difference / (2 * np.pi)), difference)
    return bool(np.all(np.abs(difference) <= 1e-6 * state_scale(a)))


def same_orbit(a: Orbit, b: Orbit, *, alike: float = _ALIKE) -> bool:
    """Whether two orbits are one, whatever their phases: nowhere farther apart than this part of their size."""
    if abs(a.period - b.period) > 1e-4 * a.period:
        return False
    phases = np.arange(256) / 256
    x, y = a.grid.at(a.profile, phases), b.grid.at(b.profile, phases)
    size = float(np.ptp(x, axis=0).max())
    if np.any(np.abs(x.mean(axis=0) - y.mean(axis=0)) > alike * (size + 1e-3)):
        return False
    spectrum = np.conj(np.fft.rfft(x, axis=0)) * np.fft.rfft(y, axis=0)
    shift = float(np.argmax(np.fft.irfft(spectrum, 256, axis=0).sum(axis=1)))
    for width in (0.5, 0.05, 0.005):  # samples within which the best shift lies
        found = []
        for step in np.linspace(-width, width, 21).tolist():
            moved = b.grid.at(b.profile, np.mod(phases + (shift + step) / 256, 1.0))
            found.append((float(np.max(np.abs(moved - x))), step))
        if min(found)[0] < alike * size + 1e-9:
            return True
        shift += min(found)[1]
    return False


def _fits(a: Orbit, b: Orbit, like: Orbit) -> bool:
    """Whether period, means and sizes of an orbit are like those of two neighbours, or between them."""
    va, vb, v = (_invariants(orbit) for orbit in (a, b, like))
    slack = np.abs(vb - va) + 0.02 * np.maximum(np.abs(va), np.abs(vb)) + 1e-6
    return bool(np.all(v >= np.minimum(va, vb) - slack) and np.all(v <= np.maximum(va, vb) + slack))


def _invariants(orbit: Orbit) -> np.ndarray:
    weight = orbit.grid.quadrature
    mean = weight @ orbit.profile
    return np.concatenate([[orbit.period], mean, np.sqrt(weight @ (orbit.profile - mean) ** 2)])


def doubled(orbit: Orbit) -> Orbit:
    """An orbit traced twice."""
    grid = Grid(np.concatenate([0.5 * orbit.grid.times, 0.5 + 0.5 * orbit.grid.times[1:]]), orbit.grid.degree)
    profile = np.vstack([orbit.profile, orbit.profile[1:]])
    return replace(orbit, grid=grid, profile=profile, period=2.0 * orbit.period)
