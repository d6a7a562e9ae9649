"""Points of a curve as a walk leaves them: one by one, or side by side."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import overload

import numpy as np
from numpy.typing import NDArray

Borders = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Left, below and weights of a minimally augmented system (`kernels/equations.py`)."""


@dataclass(frozen=True, slots=True)
class Node:
    """A point of the curve: u (N,), unit tangent in scaled unknowns (N,), arclength from the start of the walk.

    tests: values whose signs reveal special points; eigenvalues (n,); borders: left, below and weights of a
    minimally augmented system.
    """

    u: np.ndarray
    tangent: np.ndarray
    arclength: float = 0.0
    iterations: int = 0
    tests: np.ndarray = field(default_factory=lambda: np.zeros(0))
    eigenvalues: NDArray[np.complex128] = field(default_factory=lambda: np.zeros(0, complex))
    borders: Borders | None = None


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes side by side: arrays with one row a node."""

    u: np.ndarray
    tangent: np.ndarray
    arclength: np.ndarray
    tests: np.ndarray
    eigenvalues: NDArray[np.complex128]
    borders: tuple[np.ndarray, ...]

    def __len__(self) -> int:
        return len(self.arclength)

    @overload
    def __getitem__(self, i: int) -> Node: ...

    @overload
    def __getitem__(self, i: slice) -> "Nodes": ...

    def __getitem__(self, i: int | slice) -> "Node | Nodes":
        fields = (self.u[i], self.tangent[i], self.arclength[i], self.tests[i], self.eigenvalues[i])
        borders = tuple(b[i] for b in self.borders)
        if isinstance(i, slice):
            return Nodes(*fields, borders)  # type: ignore[arg-type]  # slices of arrays are arrays
        u, tangent, arclength, tests, eigenvalues = fields
        return Node(u, tangent, float(arclength), 0, tests, eigenvalues, borders or None)  # type: ignore[arg-type]

    def __iter__(self) -> Iterator[Node]:
        return (self[i] for i in range(len(self)))

    @staticmethod
    def of(nodes: Sequence[Node]) -> "Nodes":
        """Single nodes side by side."""
        return Nodes(
            np.array([n.u for n in nodes]),
            np.array([n.tangent for n in nodes]),
            np.array([n.arclength for n in nodes]),
            np.array([n.tests for n in nodes]),
            np.array([n.eigenvalues for n in nodes]),
            tuple(np.array(column) for column in zip(*(n.borders or () for n in nodes), strict=True)),
        )

    def followed_by(self, other: "Nodes") -> "Nodes":
        """These nodes and then the others."""
        join = np.concatenate
        return Nodes(
            join([self.u, other.u]), join([self.tangent, other.tangent]), join([self.arclength, other.arclength]),
            join([self.tests, other.tests]), join([self.eigenvalues, other.eigenvalues]),
            tuple(join([a, b]) for a, b in zip(self.borders, other.borders, strict=True)),
        )  # fmt: skip
