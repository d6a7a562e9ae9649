"""The linearised collocation equations as one sparse matrix: slower than the condensed chain, and independent of it.

Unknowns: a disturbance at all nodes, node by node ((N m + 1) n), then extra scalars. Rows: at every Gauss point
x' - T J x, then x(1) - x(0), then the extra ones. It steps in where the residual of `kernels/chain.py` says that its
answer is poor.
"""

from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from rainwind.dynamics.collocation import Grid, Linearised


def operator(grid: Grid, jacobian: np.ndarray, period: float) -> sparse.csc_array:
    """The square matrix of x' - T J x at the Gauss points and of x(1) - x(0).

    jacobian (N m, n, n) at the Gauss points, by time (not by phase).
    """
    basis, h = grid.basis, grid.lengths
    many, m, n = h.size, grid.degree, jacobian.shape[-1]
    blocks = -period * basis.values[:, :, None, None] * jacobian.reshape(many, m, 1, n, n)
    states = np.arange(n)
    blocks[..., states, states] += (basis.slopes / h[:, None, None])[..., None]  # (N, m, m + 1, n, n)
    interval, point, node, r, c = np.ix_(*map(np.arange, blocks.shape))
    rows = np.broadcast_to((interval * m + point) * n + r, blocks.shape).ravel()
    columns = np.broadcast_to((interval * m + node) * n + c, blocks.shape).ravel()
    last = many * m * n + states
    entries = np.concatenate([blocks.ravel(), np.ones(n), np.full(n, -1.0)])
    where = np.concatenate([rows, last, last]), np.concatenate([columns, last, states])
    found = sparse.csc_array(sparse.coo_array((entries, where), shape=(last[-1] + 1, last[-1] + 1)))
    found.eliminate_zeros()
    return found


def bordered(matrix: sparse.csc_array, columns: Any, rows: Any, corner: Any) -> sparse.csc_array:
    """The matrix (k, k) with columns (k, c), rows (c, k) and a corner (c, c)."""
    parts = [[matrix, sparse.csc_array(columns)], [sparse.csc_array(rows), sparse.csc_array(corner)]]
    return sparse.csc_array(sparse.block_array(parts))


def factored(matrix: sparse.csc_array) -> SuperLU | None:
    """Sparse LU factors with partial pivoting; None for a matrix that is singular or not finite."""
    if not np.all(np.isfinite(matrix.data)):
        return None
    try:
        return splu(matrix)
    except RuntimeError:  # exactly singular
        return None


def solve(
    factors: SuperLU, matrix: sparse.csc_array, right: np.ndarray, *, adjoint: bool = False
) -> np.ndarray:
    """The solution for right (k, ...), refined once; of the conjugate transposed equations if `adjoint`."""
    side, matrix = ("H", matrix.conj().T) if adjoint else ("N", matrix)
    right = right.astype(matrix.dtype)
    x = factors.solve(right, side)
    return x + factors.solve(right - matrix @ x, side)


def newton_step(
    at: Linearised,
    grid: Grid,
    period: float,
    residual: np.ndarray,
    rows: np.ndarray,
    corner: np.ndarray,
    right: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """What `kernels.chain.solve_periodic` finds: x (N m + 1, n, k) and lambda (c, k); not a number where singular.

    residual (N, m n): the collocation equations themselves, with their sign, solved for in the first column alone;
    rows (c, (N m + 1) n), corner (c, c) and right (c, k): the extra rows. lambda = (T, p), its columns -f and -T f_p.
    """
    n, (c, k) = at.f.shape[1], right.shape
    size = residual.size + n
    columns = np.zeros((size, c))
    columns[:-n, 0] = -at.f.ravel()
    columns[:-n, 1:] = -period * at.by[:, :, n:].reshape(residual.size, c - 1)
    matrix = bordered(operator(grid, at.by[:, :, :n], period), columns, rows, corner)
    b = np.zeros((size + c, k))
    b[: residual.size, 0] = -residual.ravel()
    b[size:] = right
    factors = factored(matrix)
    x = np.full(b.shape, np.nan) if factors is None else solve(factors, matrix, b)
    return x[:size].reshape(-1, n, k), x[size:]
