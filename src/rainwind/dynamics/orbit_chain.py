"""The linearised equations of an orbit reduced to its ends: disturbances, adjoints, answers to right-hand sides.

Interval by interval the equations are x_(j+1) = G_j x_j + g_j lambda + rho_j; `kernels/chain.py` reduces them to
P x_0 + Q x_N = d lambda + e. Whatever is asked of an orbit's disturbances is then a small dense system, and multipliers
of any size do no harm.
"""

from typing import Any

import numpy as np

from rainwind.dynamics.collocation import Linearised
from rainwind.dynamics.kernels import chain
from rainwind.dynamics.kernels import collocation as kernel


class Chain:
    """The chain of an orbit with n states, linearised in `at`. Vectors and profiles may be complex.

    lambda is the period and the free parameters. For kernels the real and imaginary parts are columns.
    """

    def __init__(self, at: Linearised, n: int) -> None:
        self.at, self.n = at, n
        self.ends, self._tops, self._elimination, _ = chain.reduce_chain(at.steps, n)

    def around(self, z: complex) -> np.ndarray:
        """P + z Q (n, n): its null vectors are x_0 of disturbances with x_N = z x_0."""
        n = self.n
        return self.ends[:, :n] + z * self.ends[:, n : 2 * n]

    @property
    def by_lambda(self) -> np.ndarray:
        """d (n, 1 + q)."""
        return self.ends[:, 2 * self.n : -1]

    def nodes(self, first: np.ndarray, last: np.ndarray, rest: np.ndarray | None = None) -> np.ndarray:
        """The disturbance at all nodes (N m + 1, n) from its ends (n,) and lambda, whose missing parts are zero."""
        lam = np.zeros(self.by_lambda.shape[1], dtype=first.dtype)
        if rest is not None:
            lam[: len(rest)] = rest
        first, last, lam = _columns(first), _columns(last), _columns(lam)
        none = np.zeros((*self._tops.shape[:2], first.shape[1]))
        mesh = chain.mesh_points(self._tops, none, first, last, lam)
        return _whole(chain.all_nodes(self.at.steps, mesh, lam, np.zeros(first.shape[1])))

    def adjoint(self, zeta: np.ndarray) -> np.ndarray:
        """The multipliers psi (N m, n) of all collocation equations from those (n,) of the reduced ones."""
        mu = chain.multipliers_of_rows(self._elimination, _columns(zeta))
        right = np.zeros((*self.at.steps.shape[:2], mu.shape[2]))
        right[:, -self.n :] = mu
        found = kernel.solve_inside_transposed(self.at.factors, self.at.orders, right)
        return _whole(found).reshape(-1, self.n)

    def turned(self, z: complex, right: np.ndarray) -> np.ndarray:
        """The profile (N m + 1, n) for a right-hand side (N m, n) of the collocation equations, with x_N = z x_0."""
        inside = self._inside(right)
        inner, e = chain.reduce_right(self._elimination, np.ascontiguousarray(inside[:, -self.n :]))
        try:
            first = np.linalg.solve(self.around(z), _whole(e))
        except np.linalg.LinAlgError:
            return np.full((len(right) + 1, self.n), np.nan)
        lam = np.zeros((self.by_lambda.shape[1], inside.shape[2]))
        mesh = chain.mesh_points(self._tops, inner, _columns(first), _columns(z * first), lam)
        parts = [
            chain.all_nodes(
                self._steps(inside[:, :, k]),
                mesh[:, :, k : k + 1].copy(),
                lam[:, k : k + 1].copy(),
                np.ones(1),
            )
            for k in range(inside.shape[2])
        ]
        return _whole(np.concatenate(parts, axis=2))

    def periodic(self, right: np.ndarray, row: np.ndarray) -> tuple[np.ndarray, float]:
        """The periodic profile for a real right-hand side right + l f with row (N m + 1, n) times it zero; and l."""
        count = self.by_lambda.shape[1]
        rows, corner = np.zeros((count, row.size)), np.eye(count)
        rows[0], corner[0, 0] = row.ravel(), 0.0
        steps = self._steps(self._inside(right)[:, :, 0])
        x, lam, _, _ = chain.solve_periodic(steps, rows, corner, np.zeros((count, 1)))
        return x[:, :, 0], float(lam[0, 0])

    def _inside(self, right: np.ndarray) -> np.ndarray:
        """Each interval's own answer (N, m n, .) to a right-hand side."""
        columns = _columns(right.reshape(self.at.steps.shape[:2]))
        found = np.empty_like(columns)
        kernel.solve_inside(self.at.factors, self.at.orders, columns, found)
        return found

    def _steps(self, rho: np.ndarray) -> np.ndarray:
        """The intervals' steps with another last column (N, m n)."""
        steps = self.at.steps.copy()
        steps[:, :, -1] = rho
        return steps


def _columns(x: Any) -> np.ndarray:
    """Real and imaginary parts along a new last axis; of real values only these."""
    return np.stack([x.real, x.imag], axis=-1) if np.iscomplexobj(x) else np.ascontiguousarray(x[..., None])


def _whole(columns: np.ndarray) -> np.ndarray:
    """The opposite of `_columns`."""
    return columns[..., 0] + 1j * columns[..., 1] if columns.shape[-1] == 2 else columns[..., 0]
