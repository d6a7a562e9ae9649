"""Periodic orbits as a curve H(u) = 0: collocation, periodicity, and an integral phase condition."""

from dataclasses import dataclass, field

import numpy as np

from rainwind.dynamics.collocation import Grid
from rainwind.dynamics.kernels import chain as ends
from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.kernels.values import specialised, values
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.system import System

NEWTON_LIMIT = 8


@dataclass(frozen=True, slots=True)
class OrbitNode(Node):
    """A periodic orbit on a walk: u holds the profile at all nodes of the grid, the period and the free parameters.

    eigenvalues (n - 1,): log mu of all multipliers but the trivial one; trivial: log of that one as computed.
    """

    grid: Grid = None  # type: ignore[assignment]  # always given
    trivial: complex = 0j


@dataclass(frozen=True, eq=False)
class Linearised:
    """The collocation equations linearised at a profile, condensed (`kernels/collocation.py`)."""

    f: np.ndarray  # (N m, n) at the Gauss points
    by: np.ndarray  # (N m, n, n + q)
    steps: np.ndarray
    factors: np.ndarray
    orders: np.ndarray
    sign: float


@dataclass(frozen=True, eq=False)
class OrbitEquations:
    """Orbits of a system on one grid, with some free parameters: what a walk along them needs.

    units (n,), period_unit, (q,): one unit of arclength in each state, in the period and in each parameter. The
    arclength of a profile is its root mean square over the period.
    """

    system: System
    along: tuple[str, ...]
    grid: Grid
    units: np.ndarray
    period_unit: float
    parameter_units: np.ndarray
    tolerance: float = 1e-9
    scale: np.ndarray = field(init=False, repr=False)
    _tape: tuple = field(init=False, repr=False)

    def __post_init__(self) -> None:
        system = self.system
        free = np.array([system.number(name) for name in self.along], dtype=np.int64)
        inputs = system.inputs(np.zeros(len(system.states)))
        varies = np.zeros(inputs.size, dtype=bool)
        varies[: len(system.states)] = True
        varies[free] = True
        operations, template, outputs = system.tape.arrays
        tape = (*specialised(operations, template, inputs, varies), outputs)
        profile = (self.units / np.sqrt(self.grid.quadrature)[:, None]).ravel()
        object.__setattr__(self, "scale", np.concatenate([profile, [self.period_unit], self.parameter_units]))
        object.__setattr__(self, "_tape", (tape, inputs, free))

    # -- the parts of u ---------------------------------------------------------------------------------------------

    @property
    def n(self) -> int:
        """Number of states."""
        return len(self.system.states)

    @property
    def profile_size(self) -> int:
        """Number of unknowns of the profile."""
        return (len(self.grid.lengths) * self.grid.degree + 1) * self.n

    def profile(self, u: np.ndarray) -> np.ndarray:
        """The profile (N m + 1, n) in u."""
        return u[: self.profile_size].reshape(-1, self.n)

    def parts(self, u: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
        """Profile (N m + 1, n), period and free parameters (q,) in u."""
        size = self.profile_size
        return u[:size].reshape(-1, self.n), float(u[size]), u[size + 1 : size + 1 + len(self.along)]

    # -- the equations ----------------------------------------------------------------------------------------------

    def linearise(self, u: np.ndarray) -> Linearised:
        """Everything about the collocation equations at u."""
        x, period, p = self.parts(u)
        basis = self.grid.basis
        f, by = kernel.linearised(*self._tape, basis.values, x, p)
        steps, factors, orders, sign = kernel.condense(
            basis.values, basis.slopes, self.grid.lengths, x, period, f, by
        )
        return Linearised(f, by, steps, factors, orders, sign)

    def defects(self, u: np.ndarray) -> np.ndarray:
        """The collocation equations (N, m n) at u."""
        x, period, p = self.parts(u)
        basis = self.grid.basis
        return kernel.defects(*self._tape, basis.values, basis.slopes, self.grid.lengths, x, period, p)

    def phase_row(self, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """The row of the phase condition: the integral of slope(x) times a disturbance, states in their units.

        Where the profile is a point (at a Hopf point) the direction of the branch gives the slope.
        """
        slope = self.grid.slopes_at_points(x)
        if np.max(np.abs(slope) / self.units) < 1e-9:
            slope = self.grid.slopes_at_points(direction)
        row = self.grid.row(slope / self.units**2).ravel()
        return row / np.linalg.norm(row * self.scale[: row.size])

    def correct(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> OrbitNode | None:
        """The orbit in the hyperplane through u across the tangent; None when Newton fails."""
        size, count = self.profile_size, len(self.along) + 1
        across = tangent / self.scale
        rows = np.zeros((2, size))
        corner = np.zeros((2, count))
        rows[0] = self.phase_row(self.profile(u), self.profile(tangent * self.scale))
        rows[1], corner[1] = across[:size], across[size:]
        target = np.array([rows[0] @ u[:size], across @ u])
        right = np.zeros((2, 2))
        right[1, 1] = 1.0
        u = u.copy()
        converged = False
        for iteration in range(NEWTON_LIMIT):
            at = self.linearise(u)
            right[:, 0] = target - [rows[0] @ u[:size], across @ u]
            x, lam, sign, _ = ends.solve_periodic(at.steps, rows, corner, right)
            step = np.concatenate([x[:, :, 0].ravel(), lam[:, 0]])
            if not np.all(np.isfinite(step)):
                return None
            if not converged:
                u += step
            length = self.change(step, u)
            if converged:
                turned = np.concatenate([x[:, :, 1].ravel(), lam[:, 1]]) / self.scale
                turned /= np.linalg.norm(turned)
                exponents, trivial = self.exponents(u, at)
                tests = np.array([turned[size + 1], sign * at.sign])
                return OrbitNode(u, turned, 0.0, iteration, tests, exponents, None, self.grid, trivial)
            converged = length < self.tolerance
        return None

    def change(self, step: np.ndarray, u: np.ndarray) -> float:
        """The size of a step: the largest change of any unknown, as a share of its unit and its own size."""
        size = self.profile_size
        units = np.concatenate([[self.period_unit], self.parameter_units])
        profile = np.max(np.abs(self.profile(step)) / (self.units + np.abs(self.profile(u))))
        rest = np.max(np.abs(step[size:]) / (units + np.abs(u[size:]))) if step.size > size else 0.0
        return float(max(profile, rest))

    def exponents(self, u: np.ndarray, at: Linearised) -> tuple[np.ndarray, complex]:
        """log mu of the nontrivial multipliers (n - 1,), and of the trivial one."""
        from rainwind.dynamics.floquet import log_multipliers_of

        return log_multipliers_of(self.transitions(at), self.flow(u))

    def transitions(self, at: Linearised) -> np.ndarray:
        """G_j (N, n, n)."""
        n = self.n
        return np.ascontiguousarray(at.steps[:, -n:, :n])

    def flow(self, u: np.ndarray) -> np.ndarray:
        """f at the mesh points (N + 1, n)."""
        x, _, p = self.parts(u)
        tape, inputs, free = self._tape
        points = x[:: self.grid.degree]
        at = np.tile(inputs, (len(points), 1))
        at[:, : self.n] = points
        at[:, free] = p
        return values(*tape, at)
