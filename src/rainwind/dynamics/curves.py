"""Curves of folds and of Hopf points in two parameters, with the codimension-two points on them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rainwind.dynamics.bifurcations import fold_borders, hopf_borders, solve_fold, solve_hopf
from rainwind.dynamics.branches import check_states, check_steps, follow, window_of
from rainwind.dynamics.codimension_two import fold_curve_inspector, hopf_curve_inspector
from rainwind.dynamics.equations import Equations
from rainwind.dynamics.kernels.equations import FOLD, HOPF
from rainwind.dynamics.monitors import Monitor
from rainwind.dynamics.newton import null_vectors, state_scale
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.results import Branch, SpecialPoint
from rainwind.dynamics.system import System, as_system
from rainwind.errors import ComputationError, InputError
from rainwind.parameters import unknown_name


def continue_fold(
    model: Any,
    along: Sequence[str],
    *,
    start: SpecialPoint,
    until: Mapping[str, tuple[float, float]],
    ds: float = 0.05,
    limit: int = 20_000,
    monitors: Sequence[Monitor] = (),
) -> Branch:
    """The curve of folds through a fold (or cusp, Bogdanov-Takens, fold-Hopf point) in two parameters.

    until: a window for each parameter, which counts as 20 units of arclength. Special points: cusp, bt, zh. monitors:
    functions of the point to record, label or stop at. Raises InputError for bad input and ComputationError when the
    curve could not be started.
    """
    _allowed(start, ("fold", "cusp", "bt", "zh"), "continue_fold")
    return _curve("fold", as_system(model), along, start, until, ds, limit, monitors)


def continue_hopf(
    model: Any,
    along: Sequence[str],
    *,
    start: SpecialPoint,
    until: Mapping[str, tuple[float, float]],
    ds: float = 0.05,
    limit: int = 20_000,
    monitors: Sequence[Monitor] = (),
) -> Branch:
    """The curve of Hopf points through a Hopf point in two parameters.

    Special points: gh, zh, hh, and bt, where the curve ends (beyond lie neutral saddles). At a point with two
    pairs (hh) the pair of the first frequency is followed. Arguments and errors as `continue_fold`.
    """
    _allowed(start, ("hopf", "gh", "zh", "hh"), "continue_hopf")
    return _curve("hopf", as_system(model), along, start, until, ds, limit, monitors)


def _curve(
    kind: str,
    system: System,
    along: Sequence[str],
    start: SpecialPoint,
    until: Mapping[str, tuple[float, float]],
    ds: float,
    limit: int,
    monitors: Sequence[Monitor],
) -> Branch:
    check_steps(ds, limit)
    check_states(system, start)
    system, along, window = at_start(system, along, start, until)
    n = len(system.states)
    scale = np.append(state_scale(start.state), [(high - low) / 20.0 for low, high in window])
    jacobian = system.jacobian(start.state)
    values = np.array([system.parameters[name] for name in along])
    if kind == "fold":
        polished = solve_fold(system, along[:1], np.append(start.state, values[0]), scale[: n + 1])
        borders, extra = fold_borders(jacobian), np.zeros(0)
    else:
        omega = start.omega[0] if isinstance(start.omega, tuple) else start.omega
        if omega is None:
            raise InputError(f"a {start.kind} point without a frequency cannot start a Hopf curve")
        polished = solve_hopf(system, along[:1], np.append(start.state, values[0]), omega, scale[: n + 1])
        borders, extra = hopf_borders(jacobian, omega), np.array([omega**2])
        # kappa counts in units of its own size, so that a slow and a fast oscillation take like steps
        scale = np.append(scale, max(1.0, omega**2))
    u = np.concatenate([start.state, values, extra])
    if polished is not None and np.max(np.abs((polished[0][: n + 1] - u[: n + 1]) / scale[: n + 1])) < 0.1:
        u[: n + 1] = polished[0][: n + 1]
        if kind == "hopf":
            u[-1] = polished[0][-1]
    problem = Equations(FOLD if kind == "fold" else HOPF, system, along, scale)
    tangent = null_vectors(problem.derivatives(u, borders) * scale, 1)[1][:, 0]
    # ordered by the first parameter where it changes, else by the second
    first = n if abs(tangent[n]) > 1e-9 else n + 1
    tangent = tangent if tangent[first] >= 0 else -tangent
    node = problem.correct(Node(u, tangent, borders=borders), u, tangent)
    if node is None:
        raise ComputationError(f"the {kind} curve could not be started from {start}")
    inspector = (fold_curve_inspector if kind == "fold" else hopf_curve_inspector)(problem)
    numbered = {n + k: bounds for k, bounds in enumerate(window)}
    return follow(kind, problem, node, numbered, inspector, ds=ds, limit=limit, monitors=monitors)


def at_start(
    system: System, along: Sequence[str], start: SpecialPoint, until: Mapping[str, tuple[float, float]]
) -> tuple[System, tuple[str, ...], list[tuple[float, float]]]:
    """The system at the start's parameters, the free ones' names and windows. Raises InputError."""
    along = (along,) if isinstance(along, str) else tuple(along)
    windows = windows_of(system, along, until)
    known = {name: value for name, value in start.parameters.items() if name in system.parameters}
    system = system.with_parameters(known)
    for name, (low, high) in zip(along, windows, strict=True):
        if not low <= system.parameters[name] <= high:
            raise InputError(
                f"start: {name} = {system.parameters[name]:g} lies outside until = ({low:g}, {high:g}); "
                "move one of them"
            )
    return system, along, windows


def windows_of(
    system: System, along: tuple[str, ...], until: Mapping[str, tuple[float, float]]
) -> list[tuple[float, float]]:
    """The windows of two parameters, in their order. Raises InputError."""
    if len(along) != 2 or along[0] == along[1]:
        raise InputError(f"a curve needs two different parameters, for example ('a', 'b'); got {along!r}")
    if not isinstance(until, Mapping):
        raise InputError(
            f"until needs a window by name, for example {{'{along[0]}': (low, high), ...}}; got {until!r}"
        )
    for name in (*along, *until):
        if name not in system.parameters:
            raise unknown_name(name, system.parameters, "parameter")
    if set(until) != set(along):
        raise InputError(
            f"until needs a window (low, high) for each of {', '.join(along)}; got {', '.join(until)}"
        )
    return [window_of(system, name, until[name]) for name in along]


def _allowed(start: Any, kinds: tuple[str, ...], caller: str) -> None:
    if not isinstance(start, SpecialPoint) or start.kind not in kinds:
        given = start.kind if isinstance(start, SpecialPoint) else type(start).__name__
        raise InputError(f"{caller} starts from a special point ({', '.join(kinds)}); got {given}")
