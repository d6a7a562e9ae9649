"""Scalars that vanish at bifurcations of periodic orbits, with their derivatives: minimally augmented systems.

The linearised collocation equations L phi - f phi_T - T f_p phi_p = 0 with phi(1) - z phi(0) + w g = 0 and one row
v'(phi(0), phi_T, phi_p) = 1 define g; it vanishes where the operator without borders is singular (Doedel, Govaerts &
Kuznetsov, SIAM J. Numer. Anal. 41 (2003) 401). z = 1 with phi_T at a fold of cycles (lpc), with phi_T and phi_p at a
branch point (bp), where there are two rows v and two scalars; z = -1 at a period doubling (pd); z = exp(i theta) and
phi_T at a Neimark-Sacker point (ns), where g is complex. Where phi_T is unknown, one more row forbids shifts along
the orbit. With psi from the transposed system dg = -psi' d(operator) phi.

The chain of intervals is reduced to its ends first, so that everything here is a dense system of 2 n + a few unknowns
(x_0, x_N, phi_T, phi_p, g), and multipliers of any size do no harm.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.kernels.conditions import contracted
from rainwind.dynamics.orbit_chain import Chain
from rainwind.dynamics.orbit_equations import Linearised, OrbitEquations

Complex = NDArray[np.complex128]

# phi_T, phi_p among the unknowns; with phi_T the trivial multiplier is no root, which at small angles of an ns matters
EXTRA = {"lpc": 1, "pd": 0, "ns": 1, "bp": 2}
SCALARS = {"lpc": 1, "pd": 1, "ns": 2, "bp": 2}  # real conditions


@dataclass(frozen=True, eq=False)
class OrbitBorders:
    """w (n,); v (rows, n + extra); point (n,): phi(0) across it, so that no shift along the orbit counts."""

    left: np.ndarray
    below: np.ndarray
    point: np.ndarray


@dataclass(frozen=True, eq=False)
class Condition:
    """The scalars g (rows,) of one kind at an orbit, with the null vectors of the bordered system.

    first, last (n, rows): phi at both ends; rest (extra, rows): phi_T, phi_p; nu (n,), zeta (n,): multipliers of the
    boundary rows and of the reduced chain.
    """

    kind: str
    g: Any
    z: complex
    first: Any
    last: Any
    rest: Any
    nu: Any
    zeta: Any
    chain: Chain

    @property
    def values(self) -> np.ndarray:
        """The scalars as real numbers (conditions,)."""
        return np.array([self.g[0].real, self.g[0].imag]) if self.kind == "ns" else self.g.real


# (a, b, sign) of the real part and of the imaginary part of psi' phi, from parts a of psi and b of phi
_PRODUCTS = (((0, 0, 1.0), (1, 1, -1.0)), ((0, 1, 1.0), (1, 0, 1.0)))


def multiplier_of(kind: str, angle: float) -> complex:
    """z of a kind."""
    return {"lpc": 1.0, "bp": 1.0, "pd": -1.0}.get(kind, complex(np.cos(angle), np.sin(angle)))


def condition(
    problem: OrbitEquations,
    u: np.ndarray,
    at: Linearised,
    kind: str,
    borders: OrbitBorders,
    angle: float = 0.0,
) -> Condition:
    """The scalars of one kind at u, where `at` is the linearisation there."""
    n, extra = problem.n, EXTRA[kind]
    chain = Chain(at, n)
    z = multiplier_of(kind, angle)
    rows = borders.below.shape[0]
    point = 1 if extra else 0
    size = 2 * n + extra + 1
    a = np.zeros((size, size), dtype=complex if kind == "ns" else float)
    a[:n, : 2 * n] = chain.ends[:, : 2 * n]
    a[:n, 2 * n : 2 * n + extra] = -chain.by_lambda[:, :extra]
    a[n : 2 * n, :n] = -z * np.eye(n)
    a[n : 2 * n, n : 2 * n] = np.eye(n)
    a[n : 2 * n, -1] = borders.left
    if point:
        a[2 * n, :n] = borders.point
    a[2 * n + point :, :n] = borders.below[:, :n]
    a[2 * n + point :, 2 * n : 2 * n + extra] = borders.below[:, n:]
    right = np.zeros((size, rows))
    right[size - rows :] = np.eye(rows)
    solution = np.linalg.solve(a, right)
    last = np.zeros(size)
    last[-1] = 1.0
    adjoint = np.linalg.solve(a.T, last)
    return Condition(
        kind, solution[-1], z, solution[:n], solution[n : 2 * n], solution[2 * n : 2 * n + extra],
        adjoint[n : 2 * n], adjoint[:n], chain,
    )  # fmt: skip


def refreshed(found: Condition) -> OrbitBorders:
    """Borders turned to the null vectors, so that the bordered system stays well conditioned."""
    phi = np.vstack([found.first, found.rest]).T  # (rows, n + extra)
    if found.kind == "bp":
        q, _ = np.linalg.qr(phi.T)
        below = q.T
    else:
        below = np.conj(phi) / np.linalg.norm(phi)
    f = found.chain.at.f[0]
    return OrbitBorders(np.conj(found.nu) / np.linalg.norm(found.nu), below, f / np.linalg.norm(f))


def start_borders(
    problem: OrbitEquations, u: np.ndarray, at: Linearised, kind: str, angle: float = 0.0
) -> OrbitBorders:
    """Borders from scratch: random ones, turned to the null vectors a few times."""
    n, extra = problem.n, EXTRA[kind]
    random = np.random.default_rng(0)
    rows = 2 if kind == "bp" else 1
    borders = OrbitBorders(
        random.normal(size=n) / n,
        random.normal(size=(rows, n + extra)) / n,
        at.f[0] / np.linalg.norm(at.f[0]),
    )
    for _ in range(4):
        borders = refreshed(condition(problem, u, at, kind, borders, angle))
    return borders


def null_profile(found: Condition, column: int = 0) -> np.ndarray:
    """phi at all nodes (N m + 1, n), complex at a Neimark-Sacker point."""
    first, last, rest = (values[:, column] for values in (found.first, found.last, found.rest))
    return found.chain.nodes(first, last, rest)


def adjoint(found: Condition) -> np.ndarray:
    """The multipliers psi (N m, n) of all collocation equations, complex at a Neimark-Sacker point."""
    return found.chain.adjoint(found.zeta)


def slopes(problem: OrbitEquations, u: np.ndarray, found: Condition) -> np.ndarray:
    """Derivatives of the real scalars by (profile, period, free parameters): (conditions, len)."""
    n, size = problem.n, problem.profile_size
    x, period, p = problem.parts(u)
    psis = _real(adjoint(found))
    tape, inputs, free = problem.tape
    grid = problem.grid
    points = kernel.gauss_inputs(inputs, free, grid.basis.values, x, p)
    found_slopes = []
    for column in range(found.g.size):
        phi = grid.at_points(null_profile(found, column)).reshape(-1, n)
        rest = np.zeros((1 + len(free), 1), dtype=found.first.dtype)
        rest[: len(found.rest), 0] = found.rest[:, column]
        phis, rests = _real(phi), _real(rest)
        # sums psi_a' (d operator) phi_b over all Gauss points, for all a and b
        by_state, by_period, by_parameter = contracted(
            tape, points, free, phis, np.ascontiguousarray(rests[:, :, 0]), psis, period
        )
        for terms in _PRODUCTS if found.kind == "ns" else (_PRODUCTS[0][:1],):
            row = np.zeros(size + 1 + len(free))
            at_points = sum(sign * by_state[a, b] for a, b, sign in terms)
            row[:size] = grid.at_nodes(np.reshape(at_points, (-1, grid.degree, n))).ravel()
            row[size] = sum(sign * by_period[a, b] for a, b, sign in terms)
            row[size + 1 :] = sum(sign * by_parameter[a, b] for a, b, sign in terms)
            found_slopes.append(row)
    return np.array(found_slopes)


def _real(values: Any) -> np.ndarray:
    """Real and imaginary parts as rows of a new first axis; of real values only these."""
    return np.stack([values.real, values.imag]) if np.iscomplexobj(values) else values[None]


def slope_by_angle(found: Condition) -> np.ndarray:
    """Derivatives of Re g and Im g by the angle of a Neimark-Sacker point (2,)."""
    slope = 1j * found.z * (found.nu @ found.first[:, 0])
    return np.array([slope.real, slope.imag])
