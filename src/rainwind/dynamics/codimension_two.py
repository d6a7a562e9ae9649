"""Codimension-two points on curves of folds and Hopf points: cusp, bt, gh, zh, hh."""

import numpy as np

from rainwind.dynamics.continuation import zero_between
from rainwind.dynamics.equations import Equations
from rainwind.dynamics.inspection import Changes, Inspector, Probe
from rainwind.dynamics.kernels import screening as kernel
from rainwind.dynamics.kernels.equations import FOLD
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.newton import spectrum
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.normalforms import lyapunov_coefficient
from rainwind.dynamics.results import Certificate, SpecialPoint

# f_y = f_z makes Hopf-Hopf points close to 1:1 the rule in this field: normal forms diverge there
_NEAR_RESONANCE = 0.05
_STRONG = ((1, 1), (1, 2), (1, 3))


def fold_curve_inspector(problem: Equations) -> Inspector:
    """Reads a curve of folds: tests are the quadratic coefficient and w'v."""
    return Inspector(problem, (True, True), _on_fold_curve, _locate)


def hopf_curve_inspector(problem: Equations) -> Inspector:
    """Reads a curve of Hopf points: tests are kappa and l1 det J, which vanishes where l1 does but has no poles."""
    return Inspector(problem, (True, True), _on_hopf_curve, _locate)


def _on_fold_curve(changes: Changes) -> str | None:
    cusp, bt = changes.tests
    return {
        (True, False, 0, 0): "cusp",
        (False, True, 1, 0): "bt",
        (False, False, 0, 2): "zh",
    }.get((cusp, bt, len(changes.real), len(changes.pairs)))


def _on_hopf_curve(changes: Changes) -> str | None:
    bt, gh = changes.tests
    if bt:
        return "bt" if not (changes.real or changes.pairs) else None
    return {
        (True, 0, 0): "gh",
        (False, 1, 0): "zh",
        (True, 1, 0): "zh",  # l1 det J may pass zero close by
        (False, 0, 2): "hh",
    }.get((gh, len(changes.real), len(changes.pairs)))


def _locate(problem: Equations, kind: str, a: Probe, b: Probe, changes: Changes) -> SpecialPoint | None:
    """The zero of the one value that vanishes at this kind of point, along corrected points of the curve."""
    column = _column(problem, kind, changes)

    def value(node: Node) -> float:
        if column < 0:
            return float(node.tests[column])
        watched = kernel.watched(problem.kind, node.eigenvalues, node.u[-1])
        return float(kernel.matched(a.watched, watched)[column].real)

    node = zero_between(problem, a.node, b.node, value)
    if node is None:
        return None
    here = value(node)
    if kind == "gh" and abs(here) > 1e-3 * min(abs(value(a.node)), abs(value(b.node))):
        return None  # a change of sign through a pole
    return _described(problem, kind, node, here, abs(value(a.node) - value(b.node)))


def _column(problem: Equations, kind: str, changes: Changes) -> int:
    """Which value vanishes: a watched eigenvalue's number, or -2, -1 for the two tests."""
    if kind in ("zh", "hh"):
        return (changes.real or changes.pairs)[0]
    first = kind == "cusp" or (kind == "bt" and problem.kind != FOLD)
    return -2 if first else -1


def _described(problem: Equations, kind: str, node: Node, here: float, swing: float) -> SpecialPoint:
    system, n = problem.system, len(problem.system.states)
    state = node.u[:n].copy()
    free = dict(zip(problem.along, node.u[n : n + 2].tolist(), strict=True))
    inputs = system.inputs(state, free)
    residual = float(np.max(np.abs(values(*system.tape.arrays, inputs[None, :]))))
    jacobian = system.jacobian(state, free)
    eigenvalues = spectrum(jacobian)
    size = float(np.linalg.norm(jacobian))
    # a double zero moves like the root of the error
    tolerance = (1e-6 if kind == "bt" else 1e-7) * max(1.0, size)
    omega: float | tuple[float, ...] | None = None
    lyapunov, note = None, ""
    vanishes = {
        "cusp": "quadratic coefficient",
        "bt": "w'v" if problem.kind == FOLD else "omega squared",
        "gh": "first Lyapunov coefficient times det J",
    }.get(kind, "real part of the second crossing")
    checks = {vanishes: (here, 1e-7 * max(swing, 1e-3) + 1e-12)}
    if problem.kind != FOLD and node.u[-1] > 0:
        omega = float(np.sqrt(node.u[-1]))
        checks["real part of the pair"] = (_nearest(eigenvalues, omega), tolerance)
    if problem.kind == FOLD or kind == "zh":
        checks["smallest eigenvalue"] = (float(np.min(np.abs(eigenvalues))), tolerance)
    if kind == "gh" and isinstance(omega, float):
        lyapunov = lyapunov_coefficient(system, state, free, omega)
    if kind == "zh" and problem.kind == FOLD:
        pairs = eigenvalues[eigenvalues.imag > 0]
        omega = float(pairs[np.argmin(np.abs(pairs.real))].imag)
        note = "" if omega > 1e-8 * size else "frequency zero"
    if kind == "hh":
        others = kernel.watched(problem.kind, eigenvalues, node.u[-1])
        others = others[others.imag > 0]
        second = float(others[np.argmin(np.abs(others.real))].imag)
        omega = (float(np.sqrt(node.u[-1])), second)
        note = _resonance(*omega)
    return SpecialPoint(
        kind, system.states, state, {**system.parameters, **free}, problem.along, eigenvalues, node.arclength,
        Certificate(residual, checks), omega, lyapunov, None, note,
    )  # fmt: skip


def _nearest(eigenvalues: np.ndarray, omega: float) -> float:
    return float(eigenvalues[np.argmin(np.abs(eigenvalues - 1j * omega))].real)


def _resonance(first: float, second: float) -> str:
    """The frequency ratio, and whether it is so near a strong resonance that no normal form holds."""
    ratio = max(first, second) / min(first, second)
    note = f"frequency ratio {ratio:.4f}"
    for p, q in _STRONG:
        if abs(ratio - q / p) < _NEAR_RESONANCE * q / p:
            return f"{note}, near {p}:{q} resonance: normal-form coefficients mean nothing here"
    return note
