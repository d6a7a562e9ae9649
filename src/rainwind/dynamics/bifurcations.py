"""Special points of a branch of equilibria: which kind, exactly where, and a certificate for each."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rainwind.dynamics.equations import Equations
from rainwind.dynamics.inspection import Changes, Inspector, Probe
from rainwind.dynamics.kernels.equations import BRANCH, FOLD, HOPF, hopf_weights
from rainwind.dynamics.kernels.tangents import second_order
from rainwind.dynamics.newton import null_vectors, spectrum
from rainwind.dynamics.normalforms import critical_plane, fold_coefficient, lyapunov_coefficient
from rainwind.dynamics.results import Certificate, SpecialPoint
from rainwind.dynamics.system import System

Borders = tuple[np.ndarray, np.ndarray, np.ndarray]


def equilibrium_inspector(problem: Equations) -> Inspector:
    """Reads a branch of equilibria in one parameter: folds, Hopf points, branch points."""
    return Inspector(problem, (True, False), _classify, _locate)


def _classify(changes: Changes) -> str | None:
    fold, branch = changes.tests
    shape = (fold, branch, len(changes.real), len(changes.pairs))
    return {
        (True, False, 1, 0): "fold",
        (False, True, 1, 0): "bp",
        (True, True, 0, 0): "bp",  # the branch born at a pitchfork, which turns there
        (True, True, 1, 0): "bp",
        (False, False, 0, 2): "hopf",
    }.get(shape)


def _locate(problem: Equations, kind: str, a: Probe, b: Probe, changes: Changes) -> SpecialPoint | None:
    """Newton on the defining equations from the secant's crossing; None if it ends outside the interval."""
    system, n = problem.system, len(problem.system.states)
    column = (changes.real or changes.pairs or (None,))[0]
    fraction = 0.5
    if column is not None:
        va, vb = a.watched[column].real, b.watched[column].real
        fraction = va / (va - vb)
    guess = a.node.u + fraction * (b.node.u - a.node.u)
    if kind == "bp":
        found = _solve_branch_point(problem, guess)
    elif kind == "fold":
        found = solve_fold(system, problem.along, guess, problem.scale)
    else:
        pair = changes.pairs[0]
        omega = abs((1 - fraction) * a.watched[pair].imag + fraction * b.watched[pair].imag)
        found = solve_hopf(system, problem.along, guess, omega, problem.scale)
    if found is None or not np.all(np.isfinite(found[0])):
        return None
    u, residual = found
    # the interval holds one event: a point outside belongs to another one
    offset = (u[: n + 1] - a.node.u) / problem.scale
    length = float(a.node.tangent @ ((b.node.u - a.node.u) / problem.scale))
    ahead = float(a.node.tangent @ offset)
    margin = 1e-3 * length + 1e-10
    if not -margin <= ahead <= length + margin or np.max(np.abs(offset)) > 1.5 * length + margin:
        return None
    parameters = {**system.parameters, problem.along[0]: float(u[n])}
    point = describe(
        system, kind, u[:n], parameters, problem.along, a.node.arclength + ahead, residual, u[n + 1 :]
    )
    if kind == "bp":
        point = replace(point, crossing=_crossing(problem, u[: n + 1], a.node.tangent))
    return point


def solve_fold(
    system: System, along: tuple[str, ...], guess: np.ndarray, scale: np.ndarray
) -> tuple[np.ndarray, float] | None:
    """A fold from a guess (n + 1,) of state and parameter: (u, residual) or None."""
    return Equations(FOLD, system, along, scale).solve(guess, fold_borders(_jacobian(system, along, guess)))


def solve_hopf(
    system: System, along: tuple[str, ...], guess: np.ndarray, omega: float, scale: np.ndarray
) -> tuple[np.ndarray, float] | None:
    """A Hopf point from a guess (n + 1,) and its frequency: (u of n + 2 with kappa last, residual) or None."""
    borders = hopf_borders(_jacobian(system, along, guess), omega)
    u = np.append(guess, omega**2)
    found = Equations(HOPF, system, along, np.append(scale, max(1.0, omega**2))).solve(u, borders)
    return found if found is not None and found[0][-1] > 0 else None


def _solve_branch_point(problem: Equations, guess: np.ndarray) -> tuple[np.ndarray, float] | None:
    d = problem.derivatives(guess)
    w, _ = null_vectors(d, 1)
    _, below = null_vectors(d, 2)
    weights = np.zeros((2, 4))
    equations = Equations(BRANCH, problem.system, problem.along, np.append(problem.scale, 1.0))
    return equations.solve(np.append(guess, 0.0), (w, below, weights))


def _crossing(problem: Equations, u: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """The direction of the other branch at a branch point: the algebraic bifurcation equation.

    On the null space p1, p2 of [J, f_p], with the left null vector w, both tangents a p1 + b p2 solve
    c11 a^2 + 2 c12 a b + c22 b^2 = 0, c_ij = w'B(p_i, p_j), derivatives by states and parameter.
    """
    system, n, scale = problem.system, len(problem.system.states), problem.scale
    at = system.inputs(u[:n], {problem.along[0]: u[n]})
    directions = np.append(np.arange(n), system.number(problem.along[0]))
    w, basis = null_vectors(problem.derivatives(u) * scale, 2)
    c = np.empty((2, 2))
    for i in range(2):
        along = np.zeros(at.size)
        along[directions] = basis[:, i] * scale
        _, _, mixed = second_order(*system.tape.arrays, at, directions, along)
        c[i] = w[:, -1] @ mixed @ (basis * scale[:, None])
    # both roots from the eigenvectors of c, whose eigenvalues have opposite signs where two branches cross
    values, vectors = np.linalg.eigh((c + c.T) / 2)
    size = np.sqrt(np.abs(values))
    candidates = []
    for sign in (1.0, -1.0):
        t = basis @ vectors @ np.array([size[1], sign * size[0]])
        candidates.append(t / np.linalg.norm(t))
    return min(candidates, key=lambda t: abs(t @ tangent)) * scale


def fold_borders(jacobian: np.ndarray) -> Borders:
    """Borders of a fold from the most nearly null vectors of J."""
    left, below = null_vectors(jacobian, 1)
    return left, below, np.zeros((2, 4))


def hopf_borders(jacobian: np.ndarray, omega: float) -> Borders:
    """Borders of a Hopf point from the eigenvectors of J nearest to +- i omega."""
    left, below = (critical_plane(matrix, omega) for matrix in (jacobian.T, jacobian))
    return left, below, hopf_weights(np.ascontiguousarray(jacobian), below, left)


def describe(
    system: System,
    kind: str,
    state: np.ndarray,
    parameters: Mapping[str, float],
    along: tuple[str, ...],
    arclength: float,
    residual: float,
    extra: np.ndarray,
) -> SpecialPoint:
    """A fold, Hopf or branch point of a branch with normal-form coefficient and certificate."""
    free = {name: parameters[name] for name in along}
    jacobian = system.jacobian(state, free)
    eigenvalues = spectrum(jacobian)
    size = float(np.linalg.norm(jacobian))
    by_parameter = system.jacobian_parameters(state, along[:1], free)[:, 0]
    omega = lyapunov = None
    checks: dict[str, tuple[float, float]] = {}
    margins: dict[str, float] = {}
    if kind == "hopf":
        omega = float(np.sqrt(extra[0]))
        nearest = eigenvalues[np.argmin(np.abs(eigenvalues - 1j * omega))]
        checks["real part of the pair"] = (float(nearest.real), 1e-8 * size)
        checks["omega against the eigenvalue"] = (float(abs(nearest.imag) - omega), 1e-8 * size)
        lyapunov = lyapunov_coefficient(system, state, free, omega)
    elif kind == "fold":
        checks["smallest eigenvalue"] = (float(np.min(np.abs(eigenvalues))), 1e-6 * max(1.0, size))
        a, _, w = fold_coefficient(system, state, free)
        margins["quadratic coefficient"] = a
        margins["w'f_p"] = float(w @ by_parameter)
    else:
        singular = np.linalg.svd(np.column_stack([jacobian, by_parameter]), compute_uv=False)
        checks["smallest singular value of [J, f_p]"] = (float(singular[-1]), 1e-8 * max(1.0, size))
        checks["unfolding"] = (float(extra[0]), 1e-9)
    return SpecialPoint(
        kind, system.states, state.copy(), dict(parameters), along, eigenvalues, arclength,
        Certificate(residual, checks, margins), omega, lyapunov,
    )  # fmt: skip


def _jacobian(system: System, along: tuple[str, ...], guess: np.ndarray) -> np.ndarray:
    n = len(system.states)
    return system.jacobian(guess[:n], dict(zip(along, guess[n:], strict=False)))
