"""Periodic orbits as a curve H(u) = 0: collocation, periodicity, and an integral phase condition."""

from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from rainwind.dynamics import sparse_collocation as sparse
from rainwind.dynamics.collocation import Grid, Linearised, Mesh
from rainwind.dynamics.equations import packed
from rainwind.dynamics.floquet import by_orthogonal_iteration, log_of_defect
from rainwind.dynamics.kernels import chain
from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.kernels import orbit_newton as newton
from rainwind.dynamics.kernels.periodic_schur import log_multipliers
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.orbit_results import Orbit, error_of
from rainwind.dynamics.orbit_trust import (
    LOST,
    NONE,
    UNSURE,
    WRONG,
    Doubt,
    coarsening_is_safe,
    doubt,
    intervals_for,
    lost_in_rounding,
    mesh_is_to_blame,
    stiffness,
    trivial_error,
    words,
)
from rainwind.dynamics.system import System

NEWTON_LIMIT = 8
_STEPS_ON_A_GRID = 3
# of the estimated error, in units of max(1, |state|): more intervals above, fewer below, not accepted above
_COARSE, _FINE, USELESS = 1e-5, 1e-10, 1e-2


@dataclass(frozen=True, slots=True)
class OrbitNode(Node):
    """A periodic orbit on a walk: u holds the profile at all nodes of the grid, the period and the free
    parameters.

    eigenvalues (n - 1,): log mu of all multipliers but the trivial one; trivial: log of that one as computed;
    liouville: sum of the other log|mu| less the integral of trace J; age: steps since the grid was last
    adapted; residual: the largest defect before Newton's last step; doubt: why the trivial multiplier is
    wrong, where it is.
    """

    grid: Grid = None  # type: ignore[assignment]  # always given
    trivial: complex = 0j
    liouville: float = 0.0
    age: int = 0
    residual: float = 0.0
    doubt: Doubt = field(default=NONE, kw_only=True)

    @property
    def trivial_error(self) -> float:
        """How far the trivial multiplier is from 1, as `orbit_trust.trivial_error` has it."""
        return trivial_error(self.trivial, self.eigenvalues)


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
    recent: list[Any] = field(default_factory=list, repr=False, kw_only=True)  # on other grids

    def __post_init__(self) -> None:
        rest = [[self.period_unit], self.parameter_units, np.ones(self.extras)]
        profile = (self.units / np.sqrt(self.grid.quadrature)[:, None]).ravel()
        object.__setattr__(self, "scale", np.concatenate([profile, *rest]))
        if self.tape:  # a copy on another grid
            return
        object.__setattr__(self, "tape", packed(self.system, self.along))

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
        """Derivatives of the free parameters by arclength (q,), whatever the grid."""
        last = node.tangent.size - self.extras
        return node.tangent[last - len(self.along) : last] * self.parameter_units

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
            residual=node.residual,
            doubt=words(node.trivial, node.doubt, node.liouville, node.eigenvalues),
        )

    # -- the grid -----------------------------------------------------------------------------------------------------

    def mesh_error(self, x: np.ndarray) -> float:
        """The estimated error of a profile, in units of max(1, |state|)."""
        return error_of(self.grid, x)

    def on(self, grid: Grid) -> Self:
        """The same problem on another grid."""
        if grid is self.grid:
            return self
        for problem in self.recent:
            if problem.grid is grid:
                return problem
        other = replace(self, grid=grid)
        self.recent[:] = [other, *self.recent[:3]]
        return other

    def moved(self, vectors: np.ndarray, grid: Grid) -> np.ndarray:
        """Unknowns (..., len) of this grid (or changes of them) as unknowns on another grid."""
        several, size = vectors.shape[:-1], self.profile_size
        profiles = np.moveaxis(vectors[..., :size].reshape(*several, -1, self.n), -2, 0)
        found = np.moveaxis(self.grid.at(profiles, grid.nodes), 0, -2)
        return np.concatenate([found.reshape(*several, -1), vectors[..., size:]], axis=-1)

    def adapted(self, node: OrbitNode, bend: np.ndarray) -> tuple["OrbitEquations", OrbitNode, np.ndarray]:
        """Every few steps the orbit on a grid that spreads its error evenly, with more intervals where it must."""
        if node.age < _STEPS_ON_A_GRID:
            return self, node, bend
        x, many = self.profile(node.u), len(self.grid.lengths)
        error = self.mesh_error(x)
        if error > _COARSE and many < self.mesh.most:
            many = min(int(1.5 * many), self.mesh.most)
        elif error < _FINE and many > self.mesh.intervals and self._coarsening_is_safe(node):
            many = max(int(many / 1.5), self.mesh.intervals)
        return self._moved_to(self._spread_for(x, many), node, bend)

    def refined(
        self, node: OrbitNode, bend: np.ndarray, new: OrbitNode
    ) -> tuple["OrbitEquations", OrbitNode, np.ndarray] | None:
        """A node and its bend on a mesh fine enough for the next one's multipliers; None where this one is."""
        if abs(new.trivial) < WRONG and abs(new.liouville) < UNSURE:
            return None
        many, error = len(self.grid.lengths), new.trivial_error
        if error > WRONG and not mesh_is_to_blame(
            error, self._doubt(new) if new.doubt is NONE else new.doubt
        ):
            error = 0.0
        missing = stiffness(new.liouville, new.eigenvalues)
        wanted = intervals_for(many, self.grid.degree, error, missing, self.mesh.most)
        return (
            self._moved_to(self._spread_for(self.profile(new.u), wanted), node, bend)
            if wanted > many
            else None
        )

    def _coarsening_is_safe(self, node: OrbitNode) -> bool:
        return coarsening_is_safe(node.trivial_error, node.liouville, node.eigenvalues, self.grid.degree)

    def _spread_for(self, x: np.ndarray, many: int) -> Grid:
        """A grid of so many intervals for a profile."""
        return self.grid.adapted(x, np.maximum(1.0, np.abs(x).max(axis=0)), many)

    def _moved_to(
        self, grid: Grid, node: OrbitNode, bend: np.ndarray
    ) -> tuple["OrbitEquations", OrbitNode, np.ndarray]:
        other = self.on(grid)
        u, tangent, bend = self.moved(np.stack([node.u, node.tangent * self.scale, bend * self.scale]), grid)
        tangent = tangent / other.scale
        tangent /= np.linalg.norm(tangent)
        return other, replace(node, u=u, tangent=tangent, grid=grid, age=0), bend / other.scale

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

    @property
    def rule(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gauss weights, values and slopes of the basis, as the kernels take them."""
        basis = self.grid.basis
        return basis.weights, basis.values, basis.slopes

    def phase_row(self, u: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """The row of the phase condition: the integral of slope(x) times a disturbance, states in their units.

        Where the profile is a point (at a Hopf point) the direction of the branch gives the slope.
        """
        profile = np.ascontiguousarray(u[: self.profile_size])
        return newton.reference_row(self.rule, self.grid.lengths, profile, direction, self.scale, self.units)

    def correct(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> OrbitNode | None:
        """The orbit in the hyperplane through u across the tangent; None when Newton fails."""
        node = self._by_chain(near, u, tangent)
        if isinstance(node, int):
            return self._correct_by_sparse_matrix(near, u, tangent) if node == newton.POOR else None
        lately = near.doubt is not NONE if isinstance(near, OrbitNode) else False
        return self._doubted(node, near, tangent) if lately or not abs(node.trivial) < WRONG else node

    def _by_chain(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> OrbitNode | int:
        """`correct` by the condensed chain; 0 where Newton fails, POOR where the linear algebra does."""
        iterations, found, turned, sign, exponents, trivial, liouville, residual = newton.correct(
            *self.tape,
            self.rule,
            self.grid.lengths,
            u,
            tangent,
            self.scale,
            self.units,
            self.tolerance,
            NEWTON_LIMIT,
        )
        if iterations == newton.POOR:
            return newton.POOR
        if iterations == 0 or not (np.isfinite(residual) and np.all(np.isfinite(turned))):
            return 0
        if self.collapsed(found, u):
            return 0
        if np.any(np.isnan(exponents)):
            exponents, _, liouville = self.floquet(found, self.linearise(found))
        tests = np.array([turned[self.profile_size + 1], sign])
        return OrbitNode(
            found, turned, 0.0, iterations, tests, exponents, None, self.grid, log_of_defect(trivial),
            liouville, self.age_after(near), residual,
        )  # fmt: skip

    def _doubted(self, node: OrbitNode, near: Node, tangent: np.ndarray) -> OrbitNode:
        """A node whose trivial multiplier looks wrong, corrected once more, and what is the matter.

        What is at hand is of the profile before Newton's last step. The difference is below Newton's
        tolerance, but the orbit may magnify it as it does the errors of the mesh.
        """
        again = self._by_chain(near, node.u, tangent)
        if isinstance(again, OrbitNode):
            node = replace(again, iterations=node.iterations)
        why = self._doubt(node)
        if node.trivial_error < WRONG and why.rounding < 0.01 * LOST:
            return node
        # signs of the parameter's direction and of the determinant are noise then: labels show by exponents alone
        lost = lost_in_rounding(why) and near.tests.size
        return replace(node, doubt=why, tests=near.tests if lost else node.tests)

    def _doubt(self, node: OrbitNode) -> Doubt:
        at, flow = self.linearise(node.u), self.flow(node.u)
        factors = kernel.deflated(at.steps, flow)
        return doubt(at.steps, flow, factors, node.trivial, node.eigenvalues)

    def _correct_by_sparse_matrix(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> OrbitNode | None:
        """`correct` with one sparse matrix for all equations: slow, for where an interval's own are singular."""
        size, predicted = self.profile_size, u
        across = tangent / self.scale
        rows = np.stack([self.phase_row(u, tangent * self.scale), across[:size]])
        corner = np.stack([np.zeros(u.size - size), across[size:]])
        target = np.array([rows[0] @ u[:size], across @ u])
        right = np.zeros((2, 2))
        right[1, 1] = 1.0
        u, sizes = u.copy(), list[float]()
        for iteration in range(2 * NEWTON_LIMIT):
            at = self.linearise(u)
            right[:, 0] = target - [rows[0] @ u[:size], across @ u]
            x, lam = sparse.newton_step(at, self.grid, self.parts(u)[1], self.defects(u), rows, corner, right)
            step = np.concatenate([x[:, :, 0].ravel(), lam[:, 0]])
            if not np.all(np.isfinite(step)):
                return None
            u += step
            if self.settled(sizes):
                turned = np.concatenate([x[:, :, 1].ravel(), lam[:, 1]]) / self.scale
                turned /= np.linalg.norm(turned)
                exponents, trivial, liouville = self.floquet(u, self.linearise(u))
                # the determinant's sign is not at hand: branch points show by their exponents alone
                tests = np.array([turned[size + 1], near.tests[1] if near.tests.size else 1.0])
                residual = float(np.max(np.abs(self.defects(u))))
                found = OrbitNode(
                    u, turned, 0.0, iteration, tests, exponents, None, self.grid, trivial, liouville,
                    self.age_after(near), residual,
                )  # fmt: skip
                return None if self.collapsed(u, predicted) else found
            sizes.append(self.change(step, u))
        return None

    def swing(self, u: np.ndarray) -> float:
        """The largest peak-to-peak value of any state, in its unit."""
        return float(np.max(np.ptp(self.profile(u), axis=0) / self.units))

    def collapsed(self, u: np.ndarray, predicted: np.ndarray) -> bool:
        """Whether Newton fell on an equilibrium, which solves the equations too, with any period."""
        x = self.profile(u)
        if np.max(np.abs(x[len(x) // 3] - x[0]) / self.units) > 1e-3:
            return False
        return not self.swing(u) > max(1e-6 * self.swing(predicted), 1e-10)

    def age_after(self, near: Node) -> int:
        """Steps since the grid was adapted, one step after another node."""
        return near.age + 1 if isinstance(near, OrbitNode) and near.grid is self.grid else 1

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

    def floquet(self, u: np.ndarray, at: Linearised) -> tuple[np.ndarray, complex, float]:
        """log mu of the nontrivial multipliers (n - 1,) and of the trivial one, and the Liouville error."""
        flow = self.flow(u)
        factors = kernel.deflated(at.steps, flow)
        exponents = log_multipliers(factors)
        if np.any(np.isnan(exponents)) and np.all(np.isfinite(factors)):
            exponents = by_orthogonal_iteration(factors)
        trivial = log_of_defect(newton.trivial_defect(chain.reduce_chain(at.steps, self.n)[0], flow[0]))
        _, period, _ = self.parts(u)
        traces = np.trace(at.by[:, :, : self.n], axis1=1, axis2=2).reshape(-1, self.grid.degree)
        integral = period * float(self.grid.lengths @ traces @ self.grid.basis.weights)
        return exponents, trivial, float(exponents.real.sum() - integral)

    def flow(self, u: np.ndarray) -> np.ndarray:
        """f at the mesh points (N + 1, n)."""
        x, _, p = self.parts(u)
        tape, inputs, free = self.tape
        points = x[:: self.grid.degree]
        at = np.tile(inputs, (len(points), 1))
        at[:, : self.n] = points
        at[:, free] = p
        return values(*tape, at)
