"""Folds, period doublings and Neimark-Sacker points of orbits as a curve H(u) = 0 in two parameters."""

from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.kernels import chain
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.orbit_conditions import (
    SCALARS,
    Condition,
    OrbitBorders,
    condition,
    null_profile,
    refreshed,
    slope_by_angle,
    slopes,
    start_borders,
)
from rainwind.dynamics.orbit_equations import NEWTON_LIMIT, Linearised, OrbitEquations, OrbitNode

_ROUNDING = 1e-7  # of Newton's steps on a curve, below which they may be rounding


@dataclass(frozen=True, slots=True)
class OrbitCurveNode(OrbitNode):
    """A point of the curve; critical: the border vectors, kept turned to the null vectors."""

    critical: OrbitBorders = None  # type: ignore[assignment]  # always given


@dataclass(frozen=True, eq=False, kw_only=True)
class OrbitCurveEquations(OrbitEquations):
    """Orbits at which the scalars of one kind vanish (`orbit_conditions`), with two free parameters.

    kind: lpc, pd or ns; at ns the last unknown of u is the angle of the critical multipliers.
    """

    kind: str

    @property
    def extras(self) -> int:
        """The angle."""
        return 1 if self.kind == "ns" else 0

    def angle(self, u: np.ndarray) -> float:
        """The angle of the critical pair: 0 at lpc, pi at pd."""
        return float(u[-1]) if self.kind == "ns" else (np.pi if self.kind == "pd" else 0.0)

    def correct(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> OrbitCurveNode | None:
        """The point of the curve in the hyperplane through u across the tangent; None when Newton fails."""
        size, scalars = self.profile_size, SCALARS[self.kind]
        count = 1 + len(self.along) + self.extras
        across = tangent / self.scale
        rows, corner = np.zeros((count, size)), np.zeros((count, count))
        rows[0] = self.phase_row(u, tangent * self.scale)
        rows[-1], corner[-1] = across[:size], across[size:]
        target = np.array([rows[0] @ u[:size], across @ u])
        right = np.zeros((count, 2))
        right[-1, 1] = 1.0
        predicted, u = u, u.copy()
        borders = near.critical if isinstance(near, OrbitCurveNode) else None
        sizes: list[float] = []
        for iteration in range(NEWTON_LIMIT):
            at = self.linearise(u)
            try:
                if borders is None:
                    borders = start_borders(self, u, at, self.kind, self.angle(u))
                found = condition(self, u, at, self.kind, borders, self.angle(u))
            except np.linalg.LinAlgError:
                return None
            by = slopes(self, u, found)
            rows[1:-1], corner[1:-1, : by.shape[1] - size] = by[:, :size], by[:, size:]
            if self.extras:
                corner[1:-1, -1] = slope_by_angle(found)
            right[0, 0] = target[0] - rows[0] @ u[:size]
            right[1:-1, 0] = -found.values
            right[-1, 0] = target[1] - across @ u
            steps = at.steps
            if self.extras:  # the angle has no part in the orbit's own equations
                steps = np.ascontiguousarray(np.insert(steps, steps.shape[2] - 1, 0.0, axis=2))
            x, lam, _, _ = chain.solve_periodic(steps, rows, corner, right)
            step = np.concatenate([x[:, :, 0].ravel(), lam[:, 0]])
            if not np.all(np.isfinite(step)):
                return None
            u += step
            if self.settled(sizes) or self.stalled(sizes):
                if self.collapsed(u, predicted):
                    return None
                turned = np.concatenate([x[:, :, 1].ravel(), lam[:, 1]]) / self.scale
                turned /= np.linalg.norm(turned)
                return self._node(near, u, turned, iteration, at, found, by[:scalars])
            sizes.append(self.change(step, u))
        return None

    def stalled(self, sizes: list[float]) -> bool:
        """Whether Newton's steps are rounding already: small, and no longer shrinking.

        Where orbits vanish, towards a generalised Hopf point, rounding of the bordered systems grows as they shrink;
        no step would ever be below the tolerance.
        """
        return len(sizes) > 2 and max(sizes[-3:]) < _ROUNDING and sizes[-1] > 0.1 * sizes[-3]

    def _node(
        self,
        near: Node,
        u: np.ndarray,
        tangent: np.ndarray,
        iterations: int,
        at: Linearised,
        found: Condition,
        by: np.ndarray,
    ) -> OrbitCurveNode:
        exponents, trivial, liouville = self.floquet(u, at)
        tests = np.zeros(2)
        if self.kind == "lpc":
            # the derivative of g along the null vector: the quadratic coefficient but for its size
            scale = self.scale[: self.profile_size + 1]
            along = np.append(null_profile(found).ravel(), found.rest[0, 0]) / scale
            tests[0] = (by[0, : scale.size] * scale) @ along / np.linalg.norm(along)
        elif self.kind == "ns":
            angle = self.angle(u)
            tests[1] = np.cos(angle) * (np.cos(angle) + 0.5)  # 1:4 and 1:3
        return OrbitCurveNode(
            u, tangent, 0.0, iterations, tests, exponents, None, self.grid, trivial, liouville, self.age_after(near),
            float(np.max(np.abs(self.defects(u)))), refreshed(found),
        )  # fmt: skip
