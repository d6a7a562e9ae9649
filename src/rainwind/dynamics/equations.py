"""A system's equations for equilibria, folds, Hopf points and branch points, ready for the compiled walk."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rainwind.dynamics.kernels import march as kernel
from rainwind.dynamics.kernels import screening
from rainwind.dynamics.kernels.equations import equations
from rainwind.dynamics.kernels.values import specialised
from rainwind.dynamics.nodes import Borders, Node, Nodes
from rainwind.dynamics.system import System

_NEWTON_LIMIT = 10


def packed(system: System, along: tuple[str, ...]) -> tuple[Any, np.ndarray, np.ndarray]:
    """What the kernels take: the tape for these free parameters, all inputs (i,), the free ones' numbers (q,)."""
    free = np.array([system.number(name) for name in along], dtype=np.int64)
    inputs = system.inputs(np.zeros(len(system.states)))
    varies = np.zeros(inputs.size, dtype=bool)
    varies[: len(system.states)] = True
    varies[free] = True
    operations, template, outputs = system.tape.arrays
    return (*specialised(operations, template, inputs, varies), outputs), inputs, free


@dataclass(frozen=True, eq=False)
class Equations:
    """A compiled problem: equilibria, folds, Hopf points or branch points of a system (`kernels/equations.py`)."""

    kind: int
    system: System
    along: tuple[str, ...]
    scale: np.ndarray
    tolerance: float = 1e-8
    _packed: tuple = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_packed", (self.kind, *packed(self.system, self.along)))

    def no_borders(self) -> Borders:
        """Borders of equations that need none."""
        empty = np.zeros((len(self.system.states), 0))
        return empty, empty, np.zeros((2, 4))

    def correct(self, near: Node, u: np.ndarray, tangent: np.ndarray) -> Node | None:
        """The node in the hyperplane through u across the tangent; None when Newton fails."""
        anywhere = np.full(len(self.along), np.inf)
        status, found, spectra, _, iterations = self._march(
            near, u, tangent, -anywhere, anywhere, 0.0, 1.0, 1
        )
        if status == kernel.STEP_TOO_SMALL:
            return None
        us, tangents, _, tests, *borders = (values[0] for values in found)
        return Node(us, tangents, 0.0, iterations, tests, spectra[0], tuple(borders))  # type: ignore[arg-type]

    def derivatives(self, u: np.ndarray, borders: Borders | None = None) -> np.ndarray:
        """The Jacobian (m, len(u)) of the equations at u."""
        return equations(*self._packed, *(borders or self.no_borders()), u)[1]

    def solve(self, u: np.ndarray, borders: Borders | None = None) -> tuple[np.ndarray, float] | None:
        """Newton on as many equations as unknowns, to rounding: the solution and the largest |F|, or None."""
        found, u, residual = kernel.solve(
            *self._packed,
            *(borders or self.no_borders()),
            u,
            self.scale,
            1e-11,
            2 * _NEWTON_LIMIT,
        )
        return (u, residual) if found else None

    def march(
        self, node: Node, lower: np.ndarray, upper: np.ndarray, step: float, largest: float, count: int
    ) -> "tuple[int, Nodes, float]":
        """Up to `count` nodes in one compiled call: status, nodes, the next step's length."""
        status, found, spectra, step, _ = self._march(
            node, node.u, node.tangent, lower, upper, step, largest, count
        )
        us, tangents, steps, tests, *borders = found
        nodes = Nodes(us, tangents, node.arclength + np.cumsum(steps), tests, spectra, tuple(borders))
        return status, nodes, step

    def inputs(self, u: np.ndarray) -> np.ndarray:
        """States and parameters (N, i) as the kernels take them, from unknowns u (N, .)."""
        _, _, inputs, free = self._packed
        at = np.tile(inputs, (len(u), 1))
        n = len(self.system.states)
        at[:, :n] = u[:, :n]
        at[:, free] = u[:, n : n + len(free)]
        return at

    def named(self, u: np.ndarray) -> dict[str, float]:
        """The free parameters in u, by name."""
        n = len(self.system.states)
        return {name: float(u[n + k]) for k, name in enumerate(self.along)}

    def _march(
        self, near: Node, u: np.ndarray, tangent: np.ndarray, lower: np.ndarray, upper: np.ndarray,
        step: float, largest: float, count: int,
    ) -> tuple[int, list[np.ndarray], np.ndarray, float, int]:  # fmt: skip
        _, tape, inputs, free = self._packed
        status, done, *found, step, iterations = kernel.march(
            *self._packed, *(near.borders or self.no_borders()), u, tangent, self.scale, lower, upper,
            step, largest, smallest_step(largest), self.tolerance, _NEWTON_LIMIT, count,
        )  # fmt: skip
        found = [values[:done] for values in found]
        return status, found, screening.spectra(tape, inputs, free, found[0]), step, iterations


def smallest_step(largest: float) -> float:
    """The step's length at which a walk gives up."""
    return 1e-7 * largest
