"""Newton's method for one equilibrium, and null vectors to start a walk from."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from rainwind.dynamics.equations import Equations
from rainwind.dynamics.kernels.equations import EQUILIBRIUM
from rainwind.dynamics.system import System


def solve_equilibrium(system: System, guess: np.ndarray) -> tuple[np.ndarray, float] | None:
    """The equilibrium that Newton reaches from a guess (n,), and its residual; None where it does not converge.

    Where plain Newton runs away, Powell's hybrid method brings the guess near first.
    """
    problem = Equations(EQUILIBRIUM, system, (), state_scale(guess))
    solution = problem.solve(guess)
    if solution is None or not np.all(np.isfinite(solution[0])):
        with np.errstate(all="ignore"):
            near = root(system.f, guess, jac=system.jacobian, method="hybr")
        solution = problem.solve(near.x) if np.all(np.isfinite(near.x)) else None
    return solution if solution is not None and np.all(np.isfinite(solution[0])) else None


def state_scale(state: np.ndarray) -> np.ndarray:
    """One unit of arclength in each state: 1, or the state itself where that is larger."""
    return np.maximum(1.0, np.abs(state))


def spectrum(jacobian: np.ndarray) -> NDArray[np.complex128]:
    """The eigenvalues of J (n, n) by descending real part (n,)."""
    eigenvalues: NDArray[np.complex128] = np.asarray(np.linalg.eigvals(jacobian), dtype=np.complex128)
    return eigenvalues[np.argsort(-eigenvalues.real)]


def null_vectors(matrix: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The `count` most nearly null directions of a matrix (m, k): left (m, count) and right (k, count)."""
    u, _, vt = np.linalg.svd(matrix)
    return u[:, -count:].copy(), vt[-count:].T.copy()
