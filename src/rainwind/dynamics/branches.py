"""From a start to a finished branch: walk both ways, read the labels, join the halves."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from rainwind.dynamics.continuation import Walk
from rainwind.dynamics.equations import Equations
from rainwind.dynamics.inspection import Inspector
from rainwind.dynamics.kernels.equations import HOPF
from rainwind.dynamics.kernels.screening import unstable_counts
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.monitors import Event, Monitor, checked, events_between
from rainwind.dynamics.monitors import values as values_of
from rainwind.dynamics.nodes import Node, Nodes
from rainwind.dynamics.results import Branch, Ended, Equilibrium, SpecialPoint, Unexplained
from rainwind.dynamics.system import System, number
from rainwind.errors import InputError, is_interrupt


def window_of(system: System, name: str, until: Sequence[float]) -> tuple[float, float]:
    """The bounds (low, high) of a parameter, both of which the model allows. Raises InputError."""
    try:
        low, high = until
    except (TypeError, ValueError):
        raise InputError(f"until for {name} must be two numbers (low, high); got {until!r}") from None
    low, high = number(low, f"the lower bound of {name}"), number(high, f"the upper bound of {name}")
    if not low < high:
        raise InputError(f"until for {name} = ({low:g}, {high:g}): the first must be the smaller")
    for bound in (low, high):
        try:
            system.allowed({name: bound})
        except InputError as error:
            raise InputError(
                f"until for {name} = ({low:g}, {high:g}) leaves what the model allows: {error}"
            ) from None
    return low, high


def check_steps(ds: float, limit: int) -> None:
    """Raises InputError for a step or a limit that is not positive."""
    if number(ds, "ds") <= 0:
        raise InputError(f"ds = {ds!r}: the step of arclength must be a positive number")
    if number(limit, "limit") < 1:
        raise InputError(f"limit = {limit}: at least one point a direction is needed")


def check_states(system: System, start: Any) -> None:
    """Raises InputError for a start that belongs to another system."""
    if start.states != system.states:
        raise InputError(
            f"start has the states {', '.join(start.states)}, the system has {', '.join(system.states)}; "
            "give a point of this system"
        )


def follow(
    kind: str,
    problem: Equations,
    start: Node,
    window: dict[int, tuple[float, float]],
    inspector: Inspector,
    *,
    ds: float,
    limit: int,
    monitors: Sequence[Monitor] = (),
) -> Branch:
    """Walk from a node both ways within the window and label what lies between."""
    system = problem.system
    monitors = checked(monitors, (*system.states, *system.parameters))
    ahead = _half(problem, start, window, inspector, ds, limit, monitors)
    halves = [ahead]
    if ahead.ended not in (Ended.CLOSED, Ended.INTERRUPTED):
        turned = problem.correct(start, start.u, -start.tangent)
        if turned is not None:
            halves.insert(
                0, _half(problem, replace(turned, arclength=0.0), window, inspector, ds, limit, monitors)
            )
    return _joined(kind, problem, halves)


class _Half:
    """One direction of a branch, its arclength counted from the start."""

    def __init__(
        self,
        nodes: Nodes,
        ended: Ended,
        points: list[SpecialPoint],
        gaps: list[Unexplained],
        recorded: dict[str, np.ndarray],
    ) -> None:
        self.nodes, self.ended, self.points, self.gaps = nodes, ended, points, gaps
        self.recorded = recorded


def _half(
    problem: Equations,
    start: Node,
    window: dict[int, tuple[float, float]],
    inspector: Inspector,
    ds: float,
    limit: int,
    monitors: Sequence[Monitor],
) -> _Half:
    stops = [monitor for monitor in monitors if monitor.at_zero == "stop"]
    walk = Walk(problem, start, ds=ds, window=window)
    parts = [Nodes.of([start])]
    count, ended, stop = 0, None, None
    try:
        for nodes in walk.chunks():
            nodes, ended = _cut(problem, start, parts[-1], nodes, count)
            if stops:
                nodes, stop = _up_to_event(problem, parts[-1][-1], nodes, stops)
                ended = ended if stop is None else Ended.AT_CONDITION
            if len(nodes):
                parts.append(nodes)
            count += len(nodes)
            if ended is None and count >= limit:
                ended = Ended.TOO_MANY_POINTS
            if ended is not None:
                break
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
        ended = Ended.INTERRUPTED
    everything = parts[0]
    for part in parts[1:]:
        everything = everything.followed_by(part)
    points, gaps = inspector.labels(everything)
    ended = ended or walk.ended
    events = [*_events(problem, everything, monitors), *([stop] if stop is not None else [])]
    points = sorted([*points, *(_label(problem, event) for event in events)], key=lambda p: p.arclength)
    if problem.kind == HOPF:
        everything, points, gaps, ended = _up_to_bogdanov_takens(everything, points, gaps, ended)
    recorded = values_of(monitors, [_point(problem, node) for node in everything] if monitors else [])
    return _Half(everything, ended, points, gaps, recorded)  # type: ignore[arg-type]


def _point(problem: Equations, node: Node) -> Equilibrium:
    """A node as a result."""
    system, n = problem.system, len(problem.system.states)
    residual = float(np.max(np.abs(values(*system.tape.arrays, problem.inputs(node.u[None, :])))))
    eigenvalues = node.eigenvalues[np.argsort(-node.eigenvalues.real, kind="stable")]
    parameters = {**system.parameters, **problem.named(node.u)}
    return Equilibrium(system.states, node.u[:n], parameters, eigenvalues, residual)


def _up_to_event(
    problem: Equations, before: Node, nodes: Nodes, stops: Sequence[Monitor]
) -> tuple[Nodes, Event | None]:
    """The nodes up to the first zero of a monitor that stops the walk, that one included; all where there is none."""
    as_point = partial(_point, problem)
    a, first = before, [monitor.value(as_point(before)) for monitor in stops]
    for i, b in enumerate(nodes):
        last = [monitor.value(as_point(b)) for monitor in stops]
        for event in events_between(stops, problem, a, b, first, last, as_point):
            # a walk that begins in a zero does not end there at once
            if event.node.arclength > 1e-9:
                end = Nodes.of([event.node])
                return nodes[:i].followed_by(end) if i else end, event
        a, first = b, last
    return nodes, None


def _events(problem: Equations, nodes: Nodes, monitors: Sequence[Monitor]) -> list[Event]:
    """Every zero of the monitors that label, between the nodes."""
    monitors = [monitor for monitor in monitors if monitor.at_zero == "label"]
    as_point = partial(_point, problem)
    rows = [[monitor.value(as_point(node)) for monitor in monitors] for node in nodes] if monitors else []
    found: list[Event] = []
    for i, (before, after) in enumerate(pairwise(rows)):
        if any((x > 0) != (y > 0) for x, y in zip(before, after, strict=True)):
            found += events_between(monitors, problem, nodes[i], nodes[i + 1], before, after, as_point)
    return found


def _label(problem: Equations, event: Event) -> SpecialPoint:
    at = _point(problem, event.node)
    return SpecialPoint(
        "event", at.states, at.state, at.parameters, problem.along, at.eigenvalues, event.node.arclength,
        event.certificate(at.residual), note=event.monitor.name,
    )  # fmt: skip


def _cut(
    problem: Equations, start: Node, walked: Nodes, nodes: Nodes, count: int
) -> tuple[Nodes, Ended | None]:
    """The nodes up to where the curve closes on its start or the model refuses a state, and which of both."""
    if not len(nodes):
        return nodes, None
    before = walked[-1]
    levels = ((np.vstack([before.u, nodes.u]) - start.u) / problem.scale) @ start.tangent
    # where the curve goes through the start's hyperplane in the start's direction: is it at the start itself?
    for i in np.flatnonzero((levels[:-1] < 0) & (levels[1:] >= 0)).tolist():
        if count + i <= 2 or nodes.tangent[i] @ start.tangent < 0.9:
            continue
        a = nodes[i - 1] if i else before
        fraction = levels[i] / (levels[i] - levels[i + 1])
        there = problem.correct(a, a.u + fraction * (nodes.u[i] - a.u), start.tangent)
        if there is not None and np.linalg.norm((there.u - start.u) / problem.scale) < 1e-6:
            end = replace(start, arclength=float(nodes.arclength[i] - levels[i + 1]))
            return nodes[:i].followed_by(Nodes.of([end])), Ended.CLOSED
    refusal = problem.system.refusal
    if refusal is not None:
        n = len(problem.system.states)
        for i, u in enumerate(nodes.u):
            changed = dict(zip(problem.along, u[n:], strict=False))
            if refusal(u[:n], {**problem.system.parameters, **changed}) is not None:
                return nodes[:i], Ended.REFUSED
    return nodes, None


def _up_to_bogdanov_takens(
    nodes: Nodes, points: list[SpecialPoint], gaps: list[Unexplained], ended: Ended | None
) -> tuple[Nodes, list[SpecialPoint], list[Unexplained], Ended | None]:
    """A Hopf curve only as far as it is one."""
    ends = [point for point in points if point.kind == "bt"]
    if not ends:
        return nodes, points, gaps, ended
    last = ends[0].arclength
    nodes = nodes[: int(np.searchsorted(nodes.arclength, last))]
    points = [point for point in points if point.arclength <= last]
    gaps = [gap for gap in gaps if gap.between[0] < last]
    return nodes, points, gaps, Ended.AT_BT


def _turned(half: _Half) -> _Half:
    """The same points in the other direction."""
    nodes = half.nodes[::-1]
    nodes = replace(nodes, arclength=-nodes.arclength, tangent=-nodes.tangent)
    points = [replace(p, arclength=-p.arclength) for p in half.points[::-1]]
    gaps = [
        replace(g, between=(-g.between[1], -g.between[0]), parameters=g.parameters[::-1], change=-g.change)
        for g in half.gaps[::-1]
    ]
    return _Half(
        nodes, half.ended, points, gaps, {name: column[::-1] for name, column in half.recorded.items()}
    )


def _joined(kind: str, problem: Equations, halves: list[_Half]) -> Branch:
    """Both halves in one direction, the arclength counted from the first point."""
    forward = halves[-1]
    nodes, points, gaps, recorded = forward.nodes, forward.points, forward.gaps, forward.recorded
    if len(halves) == 2:
        backward = _turned(halves[0])
        nodes = backward.nodes[:-1].followed_by(nodes)
        points, gaps = backward.points + points, backward.gaps + gaps
        recorded = {k: np.append(backward.recorded[k][:-1], column) for k, column in recorded.items()}
    system, n, q = problem.system, len(problem.system.states), len(problem.along)
    u, shift = nodes.u, float(nodes.arclength[0])
    residual = np.max(np.abs(values(*system.tape.arrays, problem.inputs(u))), axis=1)
    return Branch(
        kind=kind,
        states=system.states,
        along=problem.along,
        parameters=dict(system.parameters),
        state=u[:, :n].copy(),
        free=u[:, n : n + q].copy(),
        tangent=(nodes.tangent * problem.scale)[:, : n + q],
        eigenvalues=nodes.eigenvalues,
        unstable=unstable_counts(problem.kind, nodes.eigenvalues, u[:, -1].copy()),
        arclength=nodes.arclength - shift,
        residual=residual,
        special=tuple(replace(p, arclength=p.arclength - shift) for p in points),
        ended=(halves[0].ended, forward.ended),
        unexplained=tuple(replace(g, between=(g.between[0] - shift, g.between[1] - shift)) for g in gaps),
        recorded=recorded,
    )
