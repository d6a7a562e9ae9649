"""Normal forms of cycles at fold (lpc), period doubling (pd) and Neimark-Sacker (ns): b, c and Re d.

Kuznetsov, Govaerts, Doedel & Dhooge, SIAM J. Numer. Anal. 43 (2005) 1407: the centre manifold round a cycle x0(tau) of
period T is parametrised by xi and by a time tau along the cycle, so that the flow on it does not depend on tau. With
A = f_x(x0(tau)), ' = d/dtau, L h = h' - A h, and forms B, C at x0(tau), each order in xi of du/dt = f(u) is one linear
equation.

lpc: u = x0 + xi v + xi^2 h / 2 + ...,  dtau/dt = 1 - k xi + a xi^2,  dxi/dt = b xi^2; all functions have period T.

    L v = k f,                                                                                  (1)
    L h = B(v, v) + 2 k v' - 2 a f - 2 b v,                                                     (2)
    b = <w, B(v, v) + 2 k v'> / 2,            <w, v> = 1.                                       (3)

pd: u = x0 + xi v + xi^2 h / 2 + xi^3 g / 6 + ...,  dtau/dt = 1 + a xi^2,  dxi/dt = c xi^3; v, g change sign over T.

    L v = 0,                 v(T) = -v(0),                                                      (4)
    L h + 2 a f = B(v, v),   h(T) = h(0),                                                       (5)
    L g = C(v, v, v) + 3 B(v, h) - 6 a v' - 6 c v,                                              (6)
    c = <w, C(v, v, v) + 3 B(v, h) - 6 a v'> / 6,            <w, v> = 1.                        (7)

ns, z = exp(i angle): u = x0 + xi v + xi* v* + xi^2 h20 / 2 + |xi|^2 h11 + xi*^2 h20* / 2 + xi^2 xi* g / 2 + ...,
dtau/dt = 1 + a |xi|^2,  dxi/dt = d xi |xi|^2.

    L v = 0,                 v(T) = z v(0),                                                     (8)
    L h20 = B(v, v),         h20(T) = z^2 h20(0),                                               (9)
    L h11 + a f = B(v, v*),  h11(T) = h11(0),                                                   (10)
    L g = C(v, v, v*) + 2 B(v, h11) + B(v*, h20) - 2 a v' - 2 d v,                              (11)
    d = <w, C(v, v, v*) + 2 B(v, h11) + B(v*, h20) - 2 a v'> / 2,            <w, v> = 1.        (12)

w spans the null space of L's adjoint (with v's boundary condition; in (3) also <w, f> = 0): what makes (2), (6), (11)
solvable. h and h11 are fixed up to multiples of f, which change nothing. As published, (1) has k = 1 and xi is scaled
to suit; here k may vanish, as it does where neighbouring cycles have equal periods, and v is normalised alike in all:

    mean over the period of |v / units|^2 = 1;  in (1) also mean of <v / units, f / units> = 0.   (13)

xi is then the amplitude of the critical disturbance in those units. The article's integral of |v|^2 over T is 1, and
its c and Re d are ours divided by T. Other units or coordinates change the size of a coefficient, never its sign; that
of b turns with v (`lpc_form`).

Discretised, L is the matrix of `sparse_collocation`, bordered by f where f is in its kernel, w its left null vector, so
that the solvability conditions are those of the discrete equations themselves; B and C come from the tape.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from rainwind.dynamics.kernels.jets import directional
from rainwind.dynamics.kernels.tangents import second_orders
from rainwind.dynamics.orbit_equations import OrbitEquations
from rainwind.dynamics.sparse_collocation import bordered, factored, operator, solve

# how near to a strong resonance k no coefficient is given, rad; at small angles other terms matter only very near
RESONANCE = {1: np.radians(0.1), 2: np.radians(1.0), 3: np.radians(1.0), 4: np.radians(1.0)}


@dataclass(frozen=True, eq=False)
class OrbitForm:
    """A normal-form coefficient of a cycle, and the critical disturbance it belongs to.

    direction (N m + 1, n): v in states, complex at ns. border: the border scalar of the equations of v, zero at the
    bifurcation itself. Both coefficient and border are nan where the equations are singular or resonant.
    """

    coefficient: float
    direction: np.ndarray
    border: float


def lpc_coefficient(problem: OrbitEquations, u: np.ndarray) -> float:
    """b of eq. (3) at a fold of cycles (1/time), zero at a cusp of cycles; sign as `lpc_form` says."""
    return lpc_form(problem, u).coefficient


def pd_coefficient(problem: OrbitEquations, u: np.ndarray) -> float:
    """c of eq. (7) at a period doubling (1/time); negative: the doubled cycle takes over the stability."""
    return pd_form(problem, u).coefficient


def ns_coefficient(problem: OrbitEquations, u: np.ndarray, angle: float) -> float:
    """Re d of eq. (12) at a Neimark-Sacker point (1/time); negative: the torus takes over the stability.

    nan within one degree (k = 1: 0.1) of angles 2 pi j / k with k = 1, 2, 3, 4, where other terms come in.
    """
    return ns_form(problem, u, angle).coefficient


def lpc_form(problem: OrbitEquations, u: np.ndarray, like: np.ndarray | None = None) -> OrbitForm:
    """Eqs. (1) and (3). v is the side to which cycles drift when the first free parameter grows, or that of `like`.

    So b < 0 says that the two cycles exist above the critical parameter, and v then leads to the stable one of the two
    (if all other multipliers are inside). Along a curve, where the parameter may turn back, give the last v as `like`.
    """
    cycle = _Cycle(problem, u)
    matrix = bordered(
        cycle.operator(1.0), cycle.column(-cycle.f / cycle.speed), cycle.row(cycle.f / cycle.speed), [[0.0]]
    )
    found, left, border = _null_vectors(matrix)
    v, k = cycle.nodes(found[:-1]), found[-1] / (problem.parts(u)[1] * cycle.speed)
    length = cycle.length(v)
    v, k = v / length, k / length
    points = cycle.points(v)
    by_v = cycle.second(points)
    right = np.einsum("jab,jb->ja", by_v, points) + 2.0 * k * cycle.slopes(v)
    w = cycle.weights(left)
    with np.errstate(divide="ignore", invalid="ignore"):
        b = 0.5 * np.vdot(w, right) / np.vdot(w, points)
        drift = np.vdot(w, cycle.by_parameter) / np.vdot(w, points)
    turn = np.sign(drift) if like is None else np.sign(cycle.inner(v, like / problem.units))
    return OrbitForm(float(turn * b), turn * v * problem.units, border)


def pd_form(problem: OrbitEquations, u: np.ndarray) -> OrbitForm:
    """Eqs. (4), (5) and (7)."""
    cycle = _Cycle(problem, u)
    found, left, border = _null_vectors(cycle.operator(-1.0))
    v = cycle.nodes(found)
    v /= cycle.length(v)
    points = cycle.points(v)
    by_v = cycle.second(points)
    h, double = cycle.periodic(np.einsum("jab,jb->ja", by_v, points))
    right = cycle.third(points[None])[0] + 3.0 * np.einsum("jab,jb->ja", by_v, cycle.points(h))
    right -= 3.0 * double * cycle.slopes(v)  # 6 a v'
    w = cycle.weights(left)
    with np.errstate(divide="ignore", invalid="ignore"):
        c = np.vdot(w, right) / np.vdot(w, points) / 6.0
    return OrbitForm(float(c), v * problem.units, border)


def ns_form(problem: OrbitEquations, u: np.ndarray, angle: float) -> OrbitForm:
    """Eqs. (8), (9), (10) and (12)."""
    cycle, z = _Cycle(problem, u), np.exp(1j * angle)
    found, left, border = _null_vectors(cycle.operator(z))
    v = cycle.nodes(found)
    v /= cycle.length(v)
    if near_resonance(angle):
        return OrbitForm(np.nan, v * problem.units, border)
    points = cycle.points(v)
    re, im = np.real(points), np.imag(points)
    by_v = cycle.second(re) + 1j * cycle.second(im)
    h11, a = cycle.periodic(np.einsum("jab,jb->ja", by_v, points.conj()).real)
    h20 = cycle.turned(z**2, np.einsum("jab,jb->ja", by_v, points))
    right = 2.0 * np.einsum("jab,jb->ja", by_v, cycle.points(h11)) - 2.0 * a * cycle.slopes(v)
    right += np.einsum("jab,jb->ja", by_v.conj(), cycle.points(h20))
    # C(v, v, v*) for v = p + i q is C(p, p, p) + C(p, q, q) + i (C(p, p, q) + C(q, q, q))
    ppp, qqq, plus, minus = cycle.third(np.stack([re, im, re + im, re - im]))
    pqq, ppq = (plus + minus - 2.0 * ppp) / 6.0, (plus - minus - 2.0 * qqq) / 6.0
    right += ppp + pqq + 1j * (ppq + qqq)
    w = cycle.weights(left)
    with np.errstate(divide="ignore", invalid="ignore"):
        d = 0.5 * np.vdot(w, right) / np.vdot(w, points)
    return OrbitForm(float(d.real), v * problem.units, border)


def near_resonance(angle: float) -> bool:
    """Whether an angle lies within one degree of 2 pi j / k for some k = 2, 3, 4, or a tenth for k = 1."""
    turns = angle / (2.0 * np.pi)
    # the multiples of 2 pi / k that are none of 2 pi / 1
    return any(
        abs(turns - j / k) * 2.0 * np.pi < RESONANCE[k if j % k else 1]
        for k in RESONANCE
        for j in (round(turns * k),)
    )


class _Cycle:
    """A cycle at its Gauss points, states divided by their units, derivatives by time."""

    def __init__(self, problem: OrbitEquations, u: np.ndarray) -> None:
        x, self.period, p = problem.parts(u)
        system, units, at = problem.system, problem.units, problem.linearise(u)
        n = problem.n
        self.grid, self.units, self.tape = problem.grid, units, system.tape.arrays
        self.f = at.f / units
        self.speed = float(np.sqrt(self.mean(self.f, self.f)))
        self.jacobian = at.by[:, :, :n] * units / units[:, None]
        self.by_parameter = at.by[:, :, n] / units
        self.inputs = system.inputs(
            self.grid.at_points(x).reshape(-1, n), dict(zip(problem.along, p.tolist(), strict=True))
        )

    def operator(self, z: complex) -> sparse.csc_array:
        """T L with the boundary condition h(T) = z h(0)."""
        return operator(self.grid, self.jacobian, self.period, z)

    def nodes(self, flat: np.ndarray) -> np.ndarray:
        """A profile (N m + 1, n) from its unknowns one after the other."""
        return flat.reshape(-1, self.units.size)

    def points(self, v: np.ndarray) -> np.ndarray:
        """A profile at the Gauss points (N m, n)."""
        return self.grid.at_points(v).reshape(-1, self.units.size)

    def slopes(self, v: np.ndarray) -> np.ndarray:
        """A profile's derivative by time at the Gauss points (N m, n)."""
        return self.grid.slopes_at_points(v).reshape(-1, self.units.size) / self.period

    def mean(self, a: np.ndarray, b: np.ndarray) -> float:
        """The mean over the period of Re <a, b>, both at the Gauss points (N m, n)."""
        weights = (self.grid.lengths[:, None] * self.grid.basis.weights).ravel()
        return float(weights @ np.sum(np.real(a.conj() * b), axis=1))

    def inner(self, a: np.ndarray, b: np.ndarray) -> float:
        """The same of two profiles."""
        return self.mean(self.points(a), self.points(b))

    def length(self, v: np.ndarray) -> float:
        """The norm of eq. (13)."""
        return float(np.sqrt(self.inner(v, v)))

    def weights(self, left: np.ndarray) -> np.ndarray:
        """w (N m, n), quadrature included, from a left null vector: its entries at the collocation rows."""
        return left[: self.f.size].reshape(self.f.shape)

    def column(self, at_points: np.ndarray) -> np.ndarray:
        """A column beside the operator: the right-hand side `at_points` of the collocation rows."""
        return np.append(at_points.ravel(), np.zeros(self.units.size))[:, None]

    def row(self, at_points: np.ndarray) -> np.ndarray:
        """A row below the operator: the mean of <at_points, h>."""
        return self.grid.row(at_points.reshape(-1, self.grid.degree, self.units.size)).reshape(1, -1)

    def periodic(self, right: np.ndarray) -> tuple[np.ndarray, float]:
        """h and a number s with L h + s f = right, h(T) = h(0) and mean <f, h> = 0."""
        direction = self.f / self.speed
        matrix = bordered(self.operator(1.0), self.column(direction), self.row(direction), [[0.0]])
        found = _solved(matrix, np.append(self.column(self.period * right).ravel(), 0.0))
        return self.nodes(found[:-1]), float(found[-1].real) / (self.period * self.speed)

    def turned(self, z: complex, right: np.ndarray) -> np.ndarray:
        """h with L h = right, h(T) = z h(0)."""
        return self.nodes(_solved(self.operator(z), self.column(self.period * right).ravel()))

    def second(self, v: np.ndarray) -> np.ndarray:
        """The matrices B(v, .) (N m, n, n) for real v (N m, n)."""
        n, states = self.units.size, np.arange(self.units.size)
        along = np.zeros((len(v), 1, self.inputs.shape[1]))
        along[:, 0, :n] = v * self.units
        pairs = zip(self.inputs, along, strict=True)
        found = np.array([second_orders(*self.tape, at, states, vector)[2][0] for at, vector in pairs])
        return found * self.units / self.units[:, None]

    def third(self, vectors: np.ndarray) -> np.ndarray:
        """C(v, v, v) (k, N m, n) for real vectors (k, N m, n)."""
        along = np.zeros((vectors.shape[1], len(vectors), self.inputs.shape[1]))
        along[:, :, : self.units.size] = np.swapaxes(vectors, 0, 1) * self.units
        pairs = zip(self.inputs, along, strict=True)
        found = np.array([directional(*self.tape, at, vector, 3) for at, vector in pairs])
        return np.swapaxes(found, 0, 1) / self.units


def _solved(matrix: sparse.csc_array, right: np.ndarray) -> np.ndarray:
    """The solution of the equations, not a number where they are singular."""
    factors = factored(matrix)
    return np.full(right.shape, np.nan) if factors is None else solve(factors, matrix, right)


def _null_vectors(matrix: sparse.csc_array) -> tuple[np.ndarray, np.ndarray, float]:
    """Right and left null vectors (k,), of length 1, of a matrix of rank k - 1; |border scalar|: 0 if they are that.

    M v + p g = 0, q* v = 1 and the adjoint equations (Govaerts 2000, sec. 3.2), the borders turned to the answer once.
    """
    k = matrix.indptr.size - 1
    p, q = (np.random.default_rng(seed).normal(size=k) for seed in (0, 1))
    border, last = np.inf, np.append(np.zeros(k), 1.0)
    for _ in range(2):
        whole = bordered(matrix, p.reshape(-1, 1), q.conj().reshape(1, -1), [[0.0]])
        factors = factored(whole)
        if factors is None:
            return np.full(k, np.nan), np.full(k, np.nan), np.nan
        right = solve(factors, whole, last)
        left = solve(factors, whole, last, adjoint=True)
        length = float(np.linalg.norm(right[:-1]))
        q, p = right[:-1] / length, left[:-1] / np.linalg.norm(left[:-1])
        border = float(abs(right[-1])) / length
    return q, p, border
