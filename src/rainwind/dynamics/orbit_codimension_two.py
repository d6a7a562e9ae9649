"""Codimension-two points on curves of orbits: cpc, gpd, ch, r1 to r4, foldflip, lpns, pdns, nsns."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from rainwind.dynamics.continuation import zero_between
from rainwind.dynamics.inspection import Changes, Probe
from rainwind.dynamics.kernels.exponents import matched
from rainwind.dynamics.orbit_bifurcations import Complex, OrbitInspector, near_circle
from rainwind.dynamics.orbit_curve_equations import OrbitCurveEquations, OrbitCurveNode
from rainwind.dynamics.orbit_normal_forms import near_resonance, ns_coefficient, pd_coefficient
from rainwind.dynamics.orbit_results import OrbitPoint
from rainwind.dynamics.results import Certificate

# nodes from one look at the normal-form coefficient of pd and ns to the next: it costs as much as several nodes
_STRIDE = 4
SMALLEST_ANGLE = 1e-3  # rad from 0 or pi at which an ns curve is taken to end in a 1:1 or 1:2 resonance
_DOUBLE = 0.1  # between exponents: nearer ones may be a double root that rounding has parted


def curve_inspector(problem: OrbitCurveEquations) -> OrbitInspector:
    """Reads a curve of lpc, pd or ns."""
    continuous = {"lpc": (True, False), "pd": (False, False), "ns": (False, True)}[problem.kind]
    return OrbitInspector(
        problem,
        continuous,
        _CLASSIFY[problem.kind],
        _locate,
        watch=lambda node: free_exponents(problem, node),
    )


def free_exponents(problem: OrbitCurveEquations, node: Any) -> Complex:
    """The exponents of a node but those that the curve holds on the unit circle.

    At 1:1 and 1:2 another one meets the one held. The two part like the root of the error, their sum does not: the free
    one is the sum.
    """
    rest = node.eigenvalues
    angle = problem.angle(node.u)
    if problem.kind == "ns":
        for sign in (1.0, -1.0):
            rest = np.delete(rest, np.argmin(np.abs(away_from(sign * angle, rest))))
        return near_circle(rest)
    away = away_from(angle, rest)
    held, *others = np.argsort(np.abs(away))
    if others and abs(away[others[0]]) < _DOUBLE:
        both = away[held] + away[others[0]]
        rest = rest.copy()
        rest[others[0]] = both.real + 1j * (angle + np.round(both.imag, 9))  # a real multiplier stays real
    return near_circle(np.delete(rest, held))


def away_from(angle: float, exponents: Complex) -> Complex:
    """Exponents less i angle, their imaginary parts in [-pi, pi)."""
    return exponents.real + 1j * (np.mod(exponents.imag - angle + np.pi, 2.0 * np.pi) - np.pi)


def _on_lpc(changes: Changes) -> str | None:
    shape = (changes.tests[0], len(changes.real), len(changes.negative), len(changes.pairs))
    return {
        (True, 0, 0, 0): "cpc", (False, 1, 0, 0): "r1", (False, 0, 1, 0): "foldflip", (False, 0, 0, 2): "lpns",
    }.get(shape)  # fmt: skip


def _on_pd(changes: Changes) -> str | None:
    shape = (len(changes.real), len(changes.negative), len(changes.pairs))
    return {(1, 0, 0): "foldflip", (0, 1, 0): "r2", (0, 0, 2): "pdns"}.get(shape)


def _on_ns(changes: Changes) -> str | None:
    shape = (changes.tests[1], len(changes.real), len(changes.negative), len(changes.pairs))
    return {
        (True, 0, 0, 0): "r34", (False, 1, 0, 0): "lpns", (False, 0, 1, 0): "pdns", (False, 0, 0, 2): "nsns",
    }.get(shape)  # fmt: skip


_CLASSIFY = {"lpc": _on_lpc, "pd": _on_pd, "ns": _on_ns}


def _locate(
    problem: OrbitCurveEquations, kind: str, a: Probe, b: Probe, changes: Changes
) -> OrbitPoint | None:
    """The zero of the one value that vanishes at this kind of point, along corrected points of the curve."""
    column = changes.column

    def value(node: OrbitCurveNode) -> float:
        if column is None:
            return float(node.tests[0 if kind == "cpc" else 1])
        return float(matched(a.watched, free_exponents(problem, node))[column].real)

    node = zero_between(problem, a.node, b.node, value)
    if node is None:
        return None
    if kind == "r34":
        kind = "r3" if abs(np.cos(problem.angle(node.u)) + 0.5) < 0.25 else "r4"
    return describe(problem, kind, node, value(node))


def describe(
    problem: OrbitCurveEquations, kind: str, node: OrbitCurveNode, here: float, **more: Any
) -> OrbitPoint:
    """A labelled point of a curve with its certificate."""
    orbit = problem.orbit(node)
    checks = {"value that vanishes": (here, 1e-6)}
    # where multipliers meet on the circle they move like the root of the error, their mean does not
    meeting = 2 if kind in ("r1", "r2") and problem.kind != "ns" else 1
    away = away_from(problem.angle(node.u), node.eigenvalues)
    nearest = np.mean(away[np.argsort(np.abs(away))[:meeting]])
    checks["critical multiplier"] = (float(abs(nearest)), 1e-3 if kind == "foldflip" else 1e-6)
    return OrbitPoint(
        kind, problem.system.states, orbit.profile[0], orbit.parameters, problem.along, node.eigenvalues,
        node.arclength, Certificate(orbit.residual, checks, {"mesh error": orbit.mesh_error}),
        orbit=orbit, angle=problem.angle(node.u) if problem.kind == "ns" else None, **more,
    )  # fmt: skip


@dataclass(frozen=True)
class _Looked:
    """A node at which the normal-form coefficient was computed."""

    node: OrbitCurveNode
    coefficient: float

    def changes_to(self, other: "_Looked") -> bool:
        """Whether the coefficient has another sign there; zero counts as negative."""
        known = np.isfinite(self.coefficient) and np.isfinite(other.coefficient)
        return bool(known and (self.coefficient > 0) != (other.coefficient > 0))


def degenerate_points(problem: OrbitCurveEquations, nodes: Sequence[OrbitCurveNode]) -> list[OrbitPoint]:
    """Where the normal-form coefficient of a pd or ns curve vanishes: gpd or ch.

    It is looked at every few nodes, so that two zeros between looks are missed.
    """
    if problem.kind == "lpc":
        return []
    looks = [_Looked(node, coefficient(problem, node)) for node in [*nodes[::_STRIDE], *nodes[-1:]]]
    position = {id(node): i for i, node in enumerate(nodes)}
    points = []
    for a, b in pairwise(looks):
        if not a.changes_to(b):
            continue
        between = nodes[position[id(a.node)] : position[id(b.node)] + 1]
        for first, last in pairwise([_Looked(node, coefficient(problem, node)) for node in between]):
            if first.changes_to(last):
                points += _zero_of_coefficient(problem, first, last)
    return points


def coefficient(problem: OrbitCurveEquations, node: OrbitCurveNode) -> float:
    """The normal-form coefficient at a node of a pd or ns curve."""
    here = problem.on(node.grid)
    if problem.kind == "pd":
        return pd_coefficient(here, node.u)
    angle = problem.angle(node.u)
    return float("nan") if near_resonance(angle) else ns_coefficient(here, node.u, angle)


def _zero_of_coefficient(problem: OrbitCurveEquations, a: _Looked, b: _Looked) -> list[OrbitPoint]:
    here = problem.on(b.node.grid)
    probe = curve_inspector(here).on_grid(Probe(a.node, free_exponents(here, a.node), np.zeros(0)))
    if probe is None:
        return []
    node = zero_between(here, probe.node, b.node, lambda node: coefficient(here, node))
    if node is None:
        return []
    left = coefficient(here, node)
    if not abs(left) < 1e-3 * max(abs(a.coefficient), abs(b.coefficient)):
        return []  # a change of sign through a pole
    point = describe(here, "gpd" if problem.kind == "pd" else "ch", node, left)
    return [replace(point, coefficient=left)]
