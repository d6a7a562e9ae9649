"""Curves of folds, period doublings and Neimark-Sacker points of orbits in two parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from rainwind.dynamics.branches import check_states, check_steps
from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.curves import at_start
from rainwind.dynamics.monitors import Monitor, checked
from rainwind.dynamics.newton import solve_equilibrium, spectrum
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.orbit_codimension_two import (
    SMALLEST_ANGLE,
    curve_inspector,
    degenerate_points,
    describe,
)
from rainwind.dynamics.orbit_curve_equations import OrbitCurveEquations, OrbitCurveNode
from rainwind.dynamics.orbit_results import OrbitBranch, OrbitPoint
from rainwind.dynamics.orbit_walks import (
    Half,
    Progress,
    Route,
    back_at_start,
    both_ways,
    check_mesh,
    joined,
    swing_size,
    swing_turned,
)
from rainwind.dynamics.results import Ended
from rainwind.dynamics.system import System, as_system
from rainwind.errors import ComputationError, InputError

Windows = Mapping[str, tuple[float, float]]

_FAR = 0.1  # units between two extrapolations of a point that are one
_APART = 1.5  # ratio of the sizes of orbits from which one extrapolates


def continue_lpc(
    model: Any,
    along: Sequence[str],
    *,
    start: OrbitPoint,
    until: Windows,
    ds: float = 0.05,
    mesh: Mesh | None = None,
    limit: int = 5000,
    progress: Progress | None = None,
    monitors: Sequence[Monitor] = (),
) -> OrbitBranch:
    """The curve of folds of cycles through a fold (lpc, or cpc, lpns on such a curve) in two parameters.

    until: a window for each parameter, which counts as 20 units of arclength; the rest as `continue_orbits`. Special
    points: cpc, r1, foldflip, lpns; gh where the curve ends in a generalised Hopf point. Raises InputError for bad
    input and ComputationError when the curve could not be started.
    """
    _allowed(start, ("lpc", "cpc", "lpns"), "continue_lpc")
    return _curve("lpc", as_system(model), along, start, until, ds, mesh, limit, progress, monitors)


def continue_pd(
    model: Any,
    along: Sequence[str],
    *,
    start: OrbitPoint,
    until: Windows,
    ds: float = 0.05,
    mesh: Mesh | None = None,
    limit: int = 5000,
    progress: Progress | None = None,
    monitors: Sequence[Monitor] = (),
) -> OrbitBranch:
    """The curve of period doublings through one (pd, or gpd, pdns on such a curve) in two parameters.

    Special points: gpd, r2, foldflip, pdns. Arguments and errors as `continue_lpc`.
    """
    _allowed(start, ("pd", "gpd", "pdns"), "continue_pd")
    return _curve("pd", as_system(model), along, start, until, ds, mesh, limit, progress, monitors)


def continue_ns(
    model: Any,
    along: Sequence[str],
    *,
    start: OrbitPoint,
    until: Windows,
    ds: float = 0.05,
    mesh: Mesh | None = None,
    limit: int = 5000,
    progress: Progress | None = None,
    monitors: Sequence[Monitor] = (),
) -> OrbitBranch:
    """The curve of Neimark-Sacker points through one (ns, or ch, r3, r4 on such a curve) in two parameters.

    Special points: ch, r3, r4, lpns, pdns, nsns; r1 and r2 where the curve ends, for beyond them the multipliers are
    real. Arguments and errors as `continue_lpc`.
    """
    _allowed(start, ("ns", "ch", "r3", "r4", "nsns"), "continue_ns")
    return _curve("ns", as_system(model), along, start, until, ds, mesh, limit, progress, monitors)


def _curve(
    kind: str,
    system: System,
    along: Sequence[str],
    start: OrbitPoint,
    until: Windows,
    ds: float,
    mesh: Mesh | None,
    limit: int,
    progress: Progress | None,
    monitors: Sequence[Monitor],
) -> OrbitBranch:
    check_steps(ds, limit)
    check_mesh(mesh)
    check_states(system, start)
    system, along, bounds = at_start(system, along, start, until)
    problem, node = _first(kind, system, along, start, bounds, mesh)

    def passed(a: Any, b: Any, count: int) -> tuple[Ended | None, list[Any]]:
        if swing_turned(problem, a, b):
            return Ended.AT_HOPF, []
        return (back_at_start(problem, a, b, node) if count >= 3 else None), []

    watched = checked(monitors, (*system.states, *system.parameters, "period"))
    window = problem.window(bounds)
    if kind == "ns":
        window[-1] = (SMALLEST_ANGLE, np.pi - SMALLEST_ANGLE)
    inspector = curve_inspector(problem)
    route = Route(problem, window, inspector, ds, passed, limit=limit, progress=progress, monitors=watched)
    halves = both_ways(route, node)
    for half in halves:
        half.points += degenerate_points(problem, half.nodes)  # type: ignore[arg-type]
        _name_the_end(problem, half)
    return joined(kind, route, halves, halves[0].ended, [])


def _first(
    kind: str,
    system: System,
    along: tuple[str, ...],
    start: OrbitPoint,
    bounds: list[tuple[float, float]],
    mesh: Mesh | None,
) -> tuple[OrbitCurveEquations, OrbitCurveNode]:
    """The problem of a curve and its first node, its tangent towards a larger first parameter."""
    orbit, grid, x = start.orbit, start.orbit.grid, start.orbit.profile
    units = np.maximum(1.0, np.abs(x).max(axis=0))
    if mesh is not None and not grid.has(mesh):
        grid, x = grid.refitted(x, mesh)
    mesh = mesh or Mesh(len(grid.lengths), grid.degree)
    parameter_units = np.array([(high - low) / 20.0 for low, high in bounds])
    problem = OrbitCurveEquations(system, along, grid, units, orbit.period, parameter_units, mesh, kind=kind)
    values = [system.parameters[name] for name in along]
    angle = [float(start.angle or 0.0)] if kind == "ns" else []
    u = np.concatenate([x.ravel(), [orbit.period], values, angle])
    first = problem.profile_size + 1
    for k in (first + 1, first):  # the second parameter held first: the start was found in the first
        tangent = np.zeros_like(u)
        tangent[k] = 1.0
        node = problem.correct(Node(u, tangent), u, tangent)
        if node is not None:
            break
    else:
        raise ComputationError(f"the {kind} curve could not be started from {start}")
    lead = first if abs(node.tangent[first]) > 1e-9 else first + 1
    if node.tangent[lead] < 0:
        node = problem.correct(node, node.u, -node.tangent) or node
    return problem, node


def _name_the_end(problem: OrbitCurveEquations, half: Half) -> None:
    """An ns curve ends at angle 0 or pi in a resonance or, where the orbits vanish too, in a fold-Hopf point.

    An lpc curve whose orbits vanish ends in a generalised Hopf point.
    """
    if problem.kind == "lpc" and half.ended in (Ended.AT_HOPF, Ended.STEP_TOO_SMALL):
        point = _generalised_hopf(problem, half.nodes)  # type: ignore[arg-type]
        if point is not None:
            half.points.append(point)
            half.ended = Ended.AT_HOPF
            # where orbits vanish the second multiplier comes to 1 too, and rounding decides on signs
            small = 4.0 * swing_size(problem, half.nodes[-1])
            vanishing = min(n.arclength for n in half.nodes if swing_size(problem, n) <= small)
            half.gaps = [gap for gap in half.gaps if gap.change or gap.between[0] < vanishing]
    if problem.kind != "ns" or half.ended is not Ended.AT_BOUND or len(half.nodes) < 2:
        return
    nodes: list[Any] = half.nodes[-2:]
    angles = [problem.angle(node.u) for node in nodes]
    kind = "r1" if angles[-1] < 0.5 * np.pi else "r2"
    offsets = [angle if kind == "r1" else np.pi - angle for angle in angles]
    if offsets[-1] > 1.01 * SMALLEST_ANGLE:
        return
    sizes = [swing_size(problem, node) for node in nodes]
    slope = (sizes[0] - sizes[1]) / (offsets[0] - offsets[1])
    if kind == "r1" and abs(sizes[1] - slope * offsets[1]) < 0.1 * abs(slope * offsets[1]):
        kind = "zh"
    here = problem.on(nodes[-1].grid)
    values = np.array([list(problem.on(node.grid).named(node.u).values()) for node in nodes])
    # parameters are smooth in the square of the angle: on to zero along the cubic through both nodes and slopes
    squares = np.square(offsets)
    rates = [problem.tangent_parameters(node) / node.tangent[-1] for node in nodes]
    by_angle = np.array(rates) / problem.scale[-1] * (-1.0 if kind == "r2" else 1.0)
    slopes = by_angle / (2.0 * np.array(offsets)[:, None])
    at_end = CubicHermiteSpline(squares[::-1], values[::-1], slopes[::-1])(0.0)
    point = describe(here, kind, nodes[-1], 0.0, note=f"extrapolated from an angle of {offsets[1]:.2g} rad")
    parameters = {**point.parameters, **dict(zip(problem.along, at_end.tolist(), strict=True))}
    half.points.append(replace(point, parameters=parameters))
    half.ended = Ended.AT_RESONANCE if kind != "zh" else Ended.AT_HOPF


def _generalised_hopf(problem: OrbitCurveEquations, nodes: list[OrbitCurveNode]) -> OrbitPoint | None:
    """The generalised Hopf point to which the orbits of an lpc curve shrink, extrapolated; None where they do not."""
    sizes, few = np.zeros(0), list[Any]()
    for node in reversed(
        nodes
    ):  # those near the end lie too close together: apart, their rounding matters less
        size = swing_size(problem, node)
        if not few or size > _APART * sizes[0]:
            few, sizes = [node, *few], np.append(size, sizes)
        if len(few) == 3:
            break
    if len(few) < 3 or not sizes[2] < 0.5:
        return None
    squares = sizes**2
    values = np.array([list(problem.on(node.grid).named(node.u).values()) for node in few])
    # parameters and the mean state are smooth in the square of the size
    at_end = [float(np.polynomial.Polynomial.fit(squares, column, 2)(0.0)) for column in values.T]
    linear = [float(np.polynomial.Polynomial.fit(squares[1:], column, 1)(0.0)) for column in values[1:].T]
    last: Any = nodes[-1]
    here = problem.on(last.grid)
    x, period, _ = here.parts(last.u)
    rest = solve_equilibrium(
        problem.system.with_parameters(dict(zip(problem.along, at_end, strict=True))),
        here.grid.quadrature @ x,
    )
    if rest is None:
        return None
    values_there = spectrum(problem.system.jacobian(rest[0], dict(zip(problem.along, at_end, strict=True))))
    omega = 2.0 * np.pi / period
    nearest = values_there[np.argmin(np.abs(values_there - 1j * omega))]
    if abs(nearest.real) > 0.01 * omega:
        return None
    spread = max(
        abs(a - b) / unit for a, b, unit in zip(at_end, linear, problem.parameter_units, strict=True)
    )
    if spread > _FAR:
        return None
    point = describe(here, "gh", last, 0.0, note=f"extrapolated from orbits of size {sizes[-1]:.2g}")
    checks = {"real part of the pair": (float(nearest.real), 0.01 * omega), "extrapolation": (spread, _FAR)}
    parameters = {**point.parameters, **dict(zip(problem.along, at_end, strict=True))}
    certificate = replace(point.certificate, checks=checks)
    return replace(point, parameters=parameters, certificate=certificate)


def _allowed(start: Any, kinds: tuple[str, ...], caller: str) -> None:
    if not isinstance(start, OrbitPoint) or start.kind not in kinds:
        given = getattr(start, "kind", type(start).__name__)
        raise InputError(f"{caller} starts from a labelled orbit ({', '.join(kinds)}); got {given}")
