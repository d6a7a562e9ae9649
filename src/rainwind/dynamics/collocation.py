"""Piecewise polynomials on a mesh of [0, 1]: nodes, Gauss points, quadrature, and how to spread the mesh anew."""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from rainwind.dynamics.kernels import profiles as kernel
from rainwind.errors import InputError


@dataclass(frozen=True)
class Mesh:
    """How finely an orbit is computed: intervals, each with a polynomial of some degree (Gauss points).

    The error at mesh points falls like intervals^(-2 degree), between them like intervals^-(degree + 1). Where the
    estimated error is too large, intervals are added up to `most` (by default sixteen times as many).
    """

    intervals: int = 40
    degree: int = 4
    most: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "most", self.most or 16 * self.intervals)
        for name, value, low, high in (
            ("intervals", self.intervals, 4, 100_000),
            ("degree", self.degree, 2, 12),
            ("most", self.most, self.intervals, 1_600_000),
        ):
            if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
                raise InputError(f"Mesh: {name} must be a whole number from {low} to {high}; got {value!r}")


@dataclass(frozen=True, eq=False)
class Basis:
    """Lagrange polynomials on m + 1 Chebyshev nodes of [0, 1], seen from the m Gauss points.

    nodes (m + 1,); points, weights (m,): Gauss quadrature; values, slopes (m, m + 1) of the polynomials at the points;
    quadrature (m + 1,): weights of the nodes; barycentric (m + 1,); top (m + 1,): derivative of order m; error: the
    largest integral of prod (t - t_i) / m! from the interval's start.
    """

    nodes: np.ndarray
    points: np.ndarray
    weights: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    quadrature: np.ndarray
    barycentric: np.ndarray
    top: np.ndarray
    error: float

    def at(self, t: np.ndarray) -> np.ndarray:
        """Values (len(t), m + 1) of the polynomials at t in [0, 1]."""
        difference = t[:, None] - self.nodes
        hit = difference == 0.0
        ratio = self.barycentric / np.where(hit, 1.0, difference)
        found = ratio / ratio.sum(axis=1, keepdims=True)
        rows = hit.any(axis=1)
        found[rows] = hit[rows]
        return found


@cache
def basis(degree: int) -> Basis:
    """The basis of one degree."""
    m = degree
    nodes = (1.0 - np.cos(np.pi * np.arange(m + 1) / m)) / 2.0
    x, weights = legendre.leggauss(m)
    points = (x + 1.0) / 2.0
    barycentric = np.array([1.0 / np.prod(c - np.delete(nodes, k)) for k, c in enumerate(nodes)])
    # monomials about the middle of the interval: well conditioned at the degrees allowed
    powers = np.arange(m + 1)
    coefficients = np.linalg.inv((2.0 * nodes[:, None] - 1.0) ** powers)  # (power, polynomial)
    values = x[:, None] ** powers @ coefficients
    slopes = 2.0 * (powers * x[:, None] ** np.maximum(powers - 1, 0)) @ coefficients
    integral = np.where(powers % 2 == 0, 1.0 / (powers + 1.0), 0.0)
    factorial = float(np.prod(np.arange(1, m + 1)))
    product = np.polynomial.Polynomial.fromroots(points).integ()
    error = float(np.max(np.abs(product(np.linspace(0.0, 1.0, 101)) - product(0.0)))) / factorial
    top = coefficients[m] * 2.0**m * factorial
    return Basis(
        nodes, points, weights / 2.0, np.ascontiguousarray(values), np.ascontiguousarray(slopes),
        integral @ coefficients, barycentric, top, error,
    )  # fmt: skip


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
class Grid:
    """A mesh of [0, 1] and the degree of its polynomials. Profiles x (N m + 1, ...) are values at all nodes."""

    times: np.ndarray  # (N + 1,)
    degree: int

    @staticmethod
    def even(mesh: Mesh) -> "Grid":
        """Intervals of equal length."""
        return Grid(np.linspace(0.0, 1.0, mesh.intervals + 1), mesh.degree)

    @cached_property
    def lengths(self) -> np.ndarray:
        """h (N,)."""
        return np.diff(self.times)

    @property
    def basis(self) -> Basis:
        """The polynomials of one interval."""
        return basis(self.degree)

    @cached_property
    def nodes(self) -> np.ndarray:
        """The times (N m + 1,) of all nodes."""
        inner = self.times[:-1, None] + self.lengths[:, None] * self.basis.nodes[:-1]
        return np.append(inner.ravel(), self.times[-1])

    @cached_property
    def quadrature(self) -> np.ndarray:
        """Weights (N m + 1,) of the nodes: the integral of a profile over [0, 1]."""
        m = self.degree
        weights = np.zeros(len(self.lengths) * m + 1)
        for k, weight in enumerate(self.basis.quadrature):
            weights[k : k + len(self.lengths) * m : m] += weight * self.lengths
        return weights

    def pieces(self, x: np.ndarray) -> np.ndarray:
        """A profile (N m + 1, ...) interval by interval (N, m + 1, ...)."""
        return x[self._numbers]

    @cached_property
    def _numbers(self) -> np.ndarray:
        """The nodes of each interval (N, m + 1)."""
        return np.arange(len(self.lengths))[:, None] * self.degree + np.arange(self.degree + 1)

    def at_points(self, x: np.ndarray) -> np.ndarray:
        """A profile at the Gauss points (N, m, ...)."""
        return np.einsum("ik,jk...->ji...", self.basis.values, self.pieces(x))

    def slopes_at_points(self, x: np.ndarray) -> np.ndarray:
        """A profile's derivative by time at the Gauss points (N, m, ...)."""
        h = self.lengths.reshape(-1, 1, *(1,) * (x.ndim - 1))
        return np.einsum("ik,jk...->ji...", self.basis.slopes, self.pieces(x)) / h

    def row(self, at_points: np.ndarray) -> np.ndarray:
        """The row (N m + 1, n) whose product with a profile is the integral of at_points (N, m, n) times it."""
        return self.at_nodes(at_points * (self.lengths[:, None] * self.basis.weights)[:, :, None])

    def at_nodes(self, at_points: np.ndarray) -> np.ndarray:
        """The row (N m + 1, n) whose product with a profile is that of at_points (N, m, n) with its Gauss points."""
        m, many = self.degree, len(self.lengths)
        nodal = np.einsum("ik,jin->jkn", self.basis.values, at_points)
        found = np.zeros((many * m + 1, at_points.shape[-1]))
        found[:-1] = nodal[:, :-1].reshape(many * m, -1)
        found[m::m] += nodal[:, -1]
        return found

    def at(self, x: Any, times: np.ndarray) -> Any:
        """A profile (N m + 1, ...), real or complex, at times (k,) in [0, 1]."""
        if np.iscomplexobj(x):
            return self.at(x.real, times) + 1j * self.at(x.imag, times)
        flat = np.ascontiguousarray(x).reshape(len(x), -1)
        found = kernel.interpolated(self.times, self.basis.nodes, self.basis.barycentric, flat, times)
        return found.reshape(len(times), *x.shape[1:])

    def next_derivative(self, x: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """The size (N,) of the derivative of order m + 1 in each interval, states divided by `scale`.

        The derivative of order m is constant in each interval; its differences between neighbours, round the
        period, estimate the next one (de Boor 1973; AUTO does the same).
        """
        return kernel.next_derivative(self.basis.top, self.lengths, x, scale)

    def error(self, x: np.ndarray, scale: np.ndarray) -> float:
        """An estimate of the largest error of a profile anywhere, states divided by `scale`.

        Between mesh points the error is the derivative of order m + 1 times h^(m + 1) times the largest value of
        the integral of prod (t - t_i) / m! over the interval.
        """
        size = self.lengths ** (self.degree + 1) * self.next_derivative(x, scale)
        return float(self.basis.error * np.max(size))

    def adapted(self, x: np.ndarray, scale: np.ndarray, intervals: int | None = None) -> "Grid":
        """The mesh on which the profile's error is spread evenly, with as many intervals or another number."""
        m, h = self.degree, self.lengths
        density = self.next_derivative(x, scale) ** (1.0 / (m + 1))
        # a floor keeps intervals where nothing happens from growing without end
        density = np.maximum(density, 0.1 * float(density @ h)) + 1e-300
        mass = np.concatenate([[0.0], np.cumsum(density * h)])
        many = intervals or len(h)
        times = np.interp(np.linspace(0.0, mass[-1], many + 1), mass, self.times)
        times[0], times[-1] = 0.0, 1.0
        return Grid(times, m)

    def refitted(self, x: np.ndarray, mesh: Mesh) -> tuple["Grid", np.ndarray]:
        """The mesh asked for, spread for a profile, and the profile on it."""
        grid = Grid(
            self.adapted(x, np.maximum(1.0, np.abs(x).max(axis=0)), mesh.intervals).times, mesh.degree
        )
        return grid, self.at(x, grid.nodes)

    def has(self, mesh: Mesh) -> bool:
        """Whether this is as many intervals of the degree as asked for."""
        return self.degree == mesh.degree and len(self.lengths) == mesh.intervals
