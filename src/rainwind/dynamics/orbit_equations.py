"""Periodic orbits as a curve H(u) = 0: collocation, periodicity, and an integral phase condition."""

from dataclasses import dataclass, field, replace

import numpy as np

from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.floquet import nontrivial_exponents, trivial_exponent
from rainwind.dynamics.kernels import chain as ends
from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.kernels.values import specialised, values
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.orbit_results import Orbit, error_of
from rainwind.dynamics.system import System

NEWTON_LIMIT = 8
_STEPS_ON_A_GRID = 3
# of the estimated error, in units of max(1, |state|): more intervals above, fewer below, not accepted above
_COARSE, _FINE, USELESS = 1e-5, 1e-10, 1e-2
_CHORD = 1e-2  # size of Newton's step below which the next one may use the same matrix


@dataclass(frozen=True, slots=True)
class OrbitNode(Node):
    """A periodic orbit on a walk: u holds the profile at all nodes of the grid, the period and the free parameters.

    eigenvalues (n - 1,): log mu of all multipliers but the trivial one; trivial: log of that one as computed;
    liouville: sum of all log|mu| less the integral of trace J; age: steps since the grid was last adapted.
    """

    grid: Grid = None  # type: ignore[assignment]  # always given
    trivial: complex = 0j
    liouville: float = 0.0
    age: int = 0


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
    mesh: Mesh = field(default_factory=Mesh)
    tolerance: float = 1e-9
    scale: np.ndarray = field(init=False, repr=False)
    tape: tuple = field(default=(), repr=False, kw_only=True)

    def __post_init__(self) -> None:
        rest = [[self.period_unit], self.parameter_units, np.ones(self.extras)]
        profile = (self.units / np.sqrt(self.grid.quadrature)[:, None]).ravel()
        object.__setattr__(self, "scale", np.concatenate([profile, *rest]))
        if self.tape:  # a copy on another grid
            return
        system = self.system
        free = np.array([system.number(name) for name in self.along], dtype=np.int64)
        inputs = system.inputs(np.zeros(len(system.states)))
        varies = np.zeros(inputs.size, dtype=bool)
        varies[: len(system.states)] = True
        varies[free] = True
        operations, template, outputs = system.tape.arrays
        tape = (*specialised(operations, template, inputs, varies), outputs)
        object.__setattr__(self, "tape", (tape, inputs, free))

    @property
    def extras(self) -> int:
        """Unknowns behind the free parameters."""
        return 0

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

    def named(self, u: np.ndarray) -> dict[str, float]:
        """The free parameters in u, by name."""
        return dict(zip(self.along, self.parts(u)[2].tolist(), strict=True))

    def window(self, bounds: list[tuple[float, float]]) -> dict[int, tuple[float, float]]:
        """The bounds of the free parameters, by number counted from the end of u, whatever the grid."""
        return {k - len(bounds) - self.extras: bound for k, bound in enumerate(bounds)}

    def tangent_parameters(self, node: Node) -> np.ndarray:
        """Derivatives of the free parameters by arclength (q,)."""
        return self.parts(node.tangent * self.scale)[2]

    def orbit(self, node: OrbitNode) -> Orbit:
        """A node as a result."""
        x, period, _ = self.parts(node.u)
        return Orbit(
            states=self.system.states,
            parameters={**self.system.parameters, **self.named(node.u)},
            period=period,
            grid=self.grid,
            profile=x.copy(),
            exponents=node.eigenvalues,
            trivial=node.trivial,
            liouville=node.liouville,
            residual=float(np.max(np.abs(self.defects(node.u)))),
        )

    # -- the grid -----------------------------------------------------------------------------------------------------

    def mesh_error(self, x: np.ndarray) -> float:
        """The estimated error of a profile, in units of max(1, |state|)."""
        return error_of(self.grid, x)

    def on(self, grid: Grid) -> "OrbitEquations":
        """The same problem on another grid."""
        return self if grid is self.grid else replace(self, grid=grid)

    def moved(self, vector: np.ndarray, grid: Grid) -> np.ndarray:
        """Unknowns of this grid (or a change of them) as unknowns on another grid."""
        profile = self.grid.at(self.profile(vector), grid.nodes)
        return np.concatenate([profile.ravel(), vector[self.profile_size :]])

    def adapted(self, node: OrbitNode, bend: np.ndarray) -> tuple["OrbitEquations", OrbitNode, np.ndarray]:
        """Every few steps the orbit on a grid that spreads its error evenly, with more intervals where it must."""
        if node.age < _STEPS_ON_A_GRID:
            return self, node, bend
        x, many = self.profile(node.u), len(self.grid.lengths)
        error = self.mesh_error(x)
        if error > _COARSE and many < self.mesh.most:
            many = min(int(1.5 * many), self.mesh.most)
        elif error < _FINE and many > self.mesh.intervals:
            many = max(int(many / 1.5), self.mesh.intervals)
        grid = self.grid.adapted(x, np.maximum(1.0, np.abs(x).max(axis=0)), many)
        other = self.on(grid)
        u = self.moved(node.u, grid)
        tangent = self.moved(node.tangent * self.scale, grid) / other.scale
        bend = self.moved(bend * self.scale, grid) / other.scale
        tangent /= np.linalg.norm(tangent)
        return other, replace(node, u=u, tangent=tangent, grid=grid, age=0), bend

    # -- the equations ----------------------------------------------------------------------------------------------

    def linearise(self, u: np.ndarray) -> Linearised:
        """Everything about the collocation equations at u."""
        x, period, p = self.parts(u)
        basis = self.grid.basis
        f, by = kernel.linearised(*self.tape, basis.values, x, p)
        steps, factors, orders, sign = kernel.condense(
            basis.values, basis.slopes, self.grid.lengths, x, period, f, by
        )
        return Linearised(f, by, steps, factors, orders, sign)

    def defects(self, u: np.ndarray) -> np.ndarray:
        """The collocation equations (N, m n) at u."""
        x, period, p = self.parts(u)
        basis = self.grid.basis
        return kernel.defects(*self.tape, basis.values, basis.slopes, self.grid.lengths, x, period, p)

    def phase_row(self, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """The row of the phase condition: the integral of slope(x) times a disturbance, states in their units.

        Where the profile is a point (at a Hopf point) the direction of the branch gives the slope.
        """
        b = self.grid.basis
        if np.max(np.ptp(x, axis=0) / self.units) < 1e-9:
            x = direction
        row = kernel.phase_row(b.weights, b.values, b.slopes, self.grid.lengths, x, self.units)
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
        sizes: list[float] = []
        for iteration in range(NEWTON_LIMIT):
            last = self.settled(sizes)
            right[:, 0] = target - [rows[0] @ u[:size], across @ u]
            if last or not 0 < iteration < 3 or sizes[-1] > _CHORD:
                at = self.linearise(u)
                x, lam, sign, reduced = ends.solve_periodic(at.steps, rows, corner, right)
            else:  # near the orbit the matrix of the step before does
                self.restate(at, u)
                x, lam = ends.solve_periodic_again(at.steps, rows, reduced, right)
            step = np.concatenate([x[:, :, 0].ravel(), lam[:, 0]])
            if not np.all(np.isfinite(step)):
                return None
            u += step
            if last:
                turned = np.concatenate([x[:, :, 1].ravel(), lam[:, 1]]) / self.scale
                turned /= np.linalg.norm(turned)
                tests = np.array([turned[size + 1], sign * at.sign])
                age = near.age + 1 if isinstance(near, OrbitNode) and near.grid is self.grid else 1
                exponents, trivial, liouville = self.floquet(u, at, reduced[0])
                return OrbitNode(
                    u, turned, 0.0, iteration, tests, exponents, None, self.grid, trivial, liouville, age
                )
            sizes.append(self.change(step, u))
        return None

    def restate(self, at: Linearised, u: np.ndarray) -> None:
        """Put the equations' value at another u into the linearisation's last column, its matrix as it is."""
        right = -self.defects(u)[:, :, None]
        found = np.empty_like(right)
        kernel.solve_inside(at.factors, at.orders, right, found)
        at.steps[:, :, -1] = found[:, :, 0]

    def settled(self, sizes: list[float]) -> bool:
        """Whether the error after Newton's last step is below the tolerance, foretold from the steps' sizes.

        One more step is made then all the same: it comes with the tangent.
        """
        if not sizes or sizes[-1] < self.tolerance:
            return bool(sizes)
        return len(sizes) > 1 and sizes[-1] * (sizes[-1] / sizes[-2]) < 0.1 * self.tolerance

    def change(self, step: np.ndarray, u: np.ndarray) -> float:
        """The size of a step: the largest change of any unknown, as a share of its unit and its own size."""
        size = self.profile_size
        units = self.scale[size:]
        profile = np.max(np.abs(self.profile(step)) / (self.units + np.abs(self.profile(u))))
        rest = np.max(np.abs(step[size:]) / (units + np.abs(u[size:]))) if step.size > size else 0.0
        return float(max(profile, rest))

    def floquet(
        self, u: np.ndarray, at: Linearised, reduced: np.ndarray | None = None
    ) -> tuple[np.ndarray, complex, float]:
        """log mu of the nontrivial multipliers (n - 1,), that of the trivial one, and the Liouville error.

        reduced: the chain's ends, if they are known already.
        """
        flow = self.flow(u)
        exponents = nontrivial_exponents(at.steps, flow)
        reduced = ends.reduce_chain(at.steps, self.n)[0] if reduced is None else reduced
        trivial = trivial_exponent(reduced, flow[0])
        _, period, _ = self.parts(u)
        traces = np.trace(at.by[:, :, : self.n], axis1=1, axis2=2).reshape(-1, self.grid.degree)
        integral = period * float(self.grid.lengths @ traces @ self.grid.basis.weights)
        return exponents, trivial, float(exponents.real.sum() + trivial.real - integral)

    def flow(self, u: np.ndarray) -> np.ndarray:
        """f at the mesh points (N + 1, n)."""
        x, _, p = self.parts(u)
        tape, inputs, free = self.tape
        points = x[:: self.grid.degree]
        at = np.tile(inputs, (len(points), 1))
        at[:, : self.n] = points
        at[:, free] = p
        return values(*tape, at)
