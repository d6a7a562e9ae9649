"""Equilibria: find them, follow them in one parameter."""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from rainwind.dynamics.bifurcations import equilibrium_inspector
from rainwind.dynamics.branches import check_states, check_steps, follow, window_of
from rainwind.dynamics.continuation import Walk
from rainwind.dynamics.equations import Equations, smallest_step
from rainwind.dynamics.kernels.equations import EQUILIBRIUM
from rainwind.dynamics.monitors import Monitor
from rainwind.dynamics.newton import null_vectors, solve_equilibrium, spectrum, state_scale
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.results import Branch, Equilibria, Equilibrium, SpecialPoint
from rainwind.dynamics.system import System, as_system
from rainwind.errors import ComputationError, InputError
from rainwind.parameters import unknown_name


def find_equilibria(model: Any, *, starts: Sequence[Any] | None = None) -> Equilibria:
    """All equilibria of a model that can list them (`all_states`), polished by Newton.

    `.complete` says whether these are certainly all. For another system give `starts`, states from which Newton
    goes: those it reaches are returned, each once, and no completeness is claimed. Raises InputError when neither
    is there.
    """
    system = as_system(model)
    listed: Any = starts
    complete, note = False, "found from the given starts: there may be others"
    if starts is None:
        if system.all_states is None:
            raise InputError(
                "this system cannot list all its equilibria; give starts=[...], states to search from"
            )
        listed = system.all_states(system.parameters)
        complete = bool(getattr(listed, "certified", True))
        note = "" if complete else "two equilibria may coincide, so that one may be missing"
    found: list[Equilibrium] = []
    for start in listed:
        solution = solve_equilibrium(system, system.state(start))
        known = solution is not None and any(
            np.allclose(solution[0], other.state, rtol=1e-9, atol=1e-12) for other in found
        )
        if solution is not None and not known:
            found.append(as_equilibrium(system, solution[0]))
        elif starts is None:
            complete, note = False, "Newton could not tell apart or confirm every equilibrium that was listed"
    return Equilibria(tuple(found), complete, note)


def find_equilibrium(model: Any, start: Any = None) -> Equilibrium:
    """The equilibrium that Newton reaches from `start` (default: the zero state). Raises ComputationError."""
    system = as_system(model)
    guess = system.state({} if start is None else start)
    solution = solve_equilibrium(system, guess)
    if solution is None:
        raise ComputationError(
            f"Newton found no equilibrium from {dict(zip(system.states, guess.tolist(), strict=True))}"
        )
    return as_equilibrium(system, solution[0])


def continue_equilibria(
    model: Any,
    along: str,
    *,
    until: tuple[float, float],
    start: Any = None,
    ds: float = 0.05,
    limit: int = 20_000,
    monitors: Sequence[Monitor] = (),
) -> Branch:
    """The branch of equilibria through `start` in one parameter, within the window `until`, in both directions.

    start: a state by name or in order (Newton goes from there at the model's parameter value), an Equilibrium, or a
    special point; a branch point leads onto the other branch. ds: first and largest step of arclength; states count
    as they are (divided by their start where that exceeds 1), the window counts as 20. limit: points a direction.
    monitors: functions of the point to record, label or stop at (`Monitor`).
    Raises InputError for bad input and ComputationError when not even the start could be computed.
    """
    check_steps(ds, limit)
    problem, node, window = _start(model, along, start, until, ds)
    inspector = equilibrium_inspector(problem)
    return follow("equilibria", problem, node, window, inspector, ds=ds, limit=limit, monitors=monitors)


def walk_equilibria(
    model: Any,
    along: str,
    *,
    until: tuple[float, float],
    start: Any = None,
    ds: float = 0.05,
    upward: bool = True,
) -> Iterator[Equilibrium]:
    """Equilibria one after another along a branch, in one direction; whoever walks decides when to stop.

    Arguments and errors as `continue_equilibria`; upward: begin towards larger values of the parameter. Nothing is
    labelled: `continue_equilibria` does that.
    """
    check_steps(ds, 1)
    problem, node, window = _start(model, along, start, until, ds)
    turned = node if upward else problem.correct(node, node.u, -node.tangent)
    if turned is None:
        raise ComputationError(f"the walk could not be started towards smaller {along}")
    n = len(problem.system.states)
    return (
        as_equilibrium(problem.system.with_parameters({along: float(point.u[n])}), point.u[:n])
        for point in itertools.chain([turned], Walk(problem, turned, ds=ds, window=window))
    )


def _start(
    model: Any, along: str, start: Any, until: tuple[float, float], ds: float
) -> tuple[Equations, Node, dict[int, tuple[float, float]]]:
    """The problem of a branch, its first node and its window. Raises InputError and ComputationError."""
    system = as_system(model)
    if not isinstance(along, str) or along not in system.parameters:
        raise unknown_name(str(along), system.parameters, "parameter")
    low, high = window_of(system, along, until)
    value = system.parameters[along]
    if isinstance(start, Equilibrium | SpecialPoint):
        check_states(system, start)
        system = system.with_parameters({k: v for k, v in start.parameters.items() if k in system.parameters})
        value = system.parameters[along]
    if not low <= value <= high:
        raise InputError(
            f"start: {along} = {value:g} lies outside until = ({low:g}, {high:g}); move one of them"
        )
    guess = system.state(
        start.state if isinstance(start, Equilibrium | SpecialPoint) else ({} if start is None else start)
    )
    scale = np.append(state_scale(guess), (high - low) / 20.0)
    problem = Equations(EQUILIBRIUM, system, (along,), scale)
    u = np.append(guess, value)
    if isinstance(start, SpecialPoint) and start.crossing is not None:
        tangent = start.crossing / scale
        tangent /= np.linalg.norm(tangent)
        node = _beside(problem, u, tangent, ds)
    else:
        if not isinstance(start, SpecialPoint):
            solution = solve_equilibrium(system, guess)
            if solution is None:
                raise ComputationError(
                    f"Newton found no equilibrium at {along} = {value:g} from "
                    f"{dict(zip(system.states, guess.tolist(), strict=True))}; give another start"
                )
            u = np.append(solution[0], value)
        tangent = null_vectors(problem.derivatives(u) * scale, 1)[1][:, 0]
        if tangent[-1] < 0:
            tangent = -tangent
        node = problem.correct(Node(u, tangent), u, tangent)
    if node is None:
        raise ComputationError(f"the branch could not be started at {along} = {value:g}")
    return problem, node, {len(system.states): (low, high)}


def as_equilibrium(system: System, state: np.ndarray) -> Equilibrium:
    """A state that rests, with its eigenvalues and residual."""
    eigenvalues = spectrum(system.jacobian(state))
    residual = float(np.max(np.abs(system.f(state))))
    return Equilibrium(system.states, state, dict(system.parameters), eigenvalues, residual)


def _beside(problem: Equations, u: np.ndarray, tangent: np.ndarray, ds: float) -> Node | None:
    """A node of the other branch beside a branch point; in the point itself Newton's matrix is singular."""
    step = ds / 2
    while step > smallest_step(ds):
        predicted = u + step * tangent * problem.scale
        node = problem.correct(Node(u, tangent), predicted, tangent)
        if node is not None and np.linalg.norm((node.u - predicted) / problem.scale) < step / 2:
            return node
        step /= 2
    return None
