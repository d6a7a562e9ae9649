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

    mean over the period of |v|^2 = 1;  in (1) also mean of <v, f> = 0.                           (13)

xi is then the amplitude of the critical disturbance in the model's own units. The article's integral of |v|^2 over T
is 1, and its c and Re d are ours divided by T. Other units or coordinates change the size of a coefficient, never its
sign; that of b turns with v (`lpc_form`).

Discretised, L is the collocation's own operator, w its left null vector, so that the solvability conditions are those
of the discrete equations themselves. All is solved on the chain reduced to its ends (`orbit_chain`), bordered by f
where f is in L's kernel. B and C come from the tape.
"""

from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.kernels.collocation import gauss_inputs
from rainwind.dynamics.kernels.conditions import second_along, third_along
from rainwind.dynamics.orbit_chain import Chain
from rainwind.dynamics.orbit_equations import OrbitEquations

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
    v, k, w, border = cycle.fold()
    points = cycle.points(v)
    (by_v,) = cycle.second(points)
    right = np.einsum("jab,jb->ja", by_v, points) + 2.0 * k * cycle.slopes(v)
    with np.errstate(divide="ignore", invalid="ignore"):
        b = 0.5 * np.vdot(w, right) / np.vdot(w, points)
        drift = np.vdot(w, cycle.by_parameter) / np.vdot(w, points)
    turn = np.sign(drift) if like is None else np.sign(cycle.mean(points, cycle.points(like)))
    return OrbitForm(float(turn * b), turn * v, border)


def pd_form(problem: OrbitEquations, u: np.ndarray) -> OrbitForm:
    """Eqs. (4), (5) and (7)."""
    cycle = _Cycle(problem, u)
    v, w, border = cycle.critical(-1.0)
    points = cycle.points(v)
    (by_v,) = cycle.second(points)
    h, double = cycle.periodic(np.einsum("jab,jb->ja", by_v, points))
    right = cycle.third(points)[0] + 3.0 * np.einsum("jab,jb->ja", by_v, cycle.points(h))
    right -= 3.0 * double * cycle.slopes(v)  # 6 a v'
    with np.errstate(divide="ignore", invalid="ignore"):
        c = np.vdot(w, right) / np.vdot(w, points) / 6.0
    return OrbitForm(float(c), v, border)


def ns_form(problem: OrbitEquations, u: np.ndarray, angle: float) -> OrbitForm:
    """Eqs. (8), (9), (10) and (12)."""
    cycle, z = _Cycle(problem, u), np.exp(1j * angle)
    v, w, border = cycle.critical(z)
    if near_resonance(angle):
        return OrbitForm(np.nan, v, border)
    points = cycle.points(v)
    re, im = np.real(points), np.imag(points)
    by_re, by_im = cycle.second(re, im)
    by_v = by_re + 1j * by_im
    h11, a = cycle.periodic(np.einsum("jab,jb->ja", by_v, points.conj()).real)
    h20 = cycle.turned(z**2, np.einsum("jab,jb->ja", by_v, points))
    right = 2.0 * np.einsum("jab,jb->ja", by_v, cycle.points(h11)) - 2.0 * a * cycle.slopes(v)
    right += np.einsum("jab,jb->ja", by_v.conj(), cycle.points(h20))
    # C(v, v, v*) for v = p + i q is C(p, p, p) + C(p, q, q) + i (C(p, p, q) + C(q, q, q))
    ppp, qqq, plus, minus = cycle.third(re, im, re + im, re - im)
    pqq, ppq = (plus + minus - 2.0 * ppp) / 6.0, (plus - minus - 2.0 * qqq) / 6.0
    right += ppp + pqq + 1j * (ppq + qqq)
    with np.errstate(divide="ignore", invalid="ignore"):
        d = 0.5 * np.vdot(w, right) / np.vdot(w, points)
    return OrbitForm(float(d.real), v, border)


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
    """A cycle at its Gauss points; derivatives are by time."""

    def __init__(self, problem: OrbitEquations, u: np.ndarray) -> None:
        x, self.period, p = problem.parts(u)
        tape, inputs, free = problem.tape
        n, at = problem.n, problem.linearise(u)
        self.grid, self.n, self.tape, self.units = problem.grid, n, tape, problem.units
        self.chain = Chain(at, n)
        self.rows = np.max(np.abs(self.chain.ends[:, : 2 * n]) * np.tile(self.units, 2), axis=1)
        self.f, self.flow = at.f, problem.flow(u)[0]  # at the Gauss points, and at the start
        self.speed = float(np.sqrt(self.mean(self.f, self.f)))
        self.by_parameter = at.by[:, :, n]
        self.inputs = gauss_inputs(inputs, free, self.grid.basis.values, x, p)

    def critical(self, z: complex) -> tuple[np.ndarray, np.ndarray, float]:
        """v of length 1 with L v = 0, v(T) = z v(0); w, quadrature included; how far z is from a multiplier."""
        start, zeta, border = _null_vectors(self.chain.around(z), self.units, self.rows)
        v = self.chain.nodes(start, z * start)
        with np.errstate(invalid="ignore"):
            v = v / self.length(v)
        return v, self.chain.adjoint(zeta).conj(), border

    def fold(self) -> tuple[np.ndarray, float, np.ndarray, float]:
        """v and k of eq. (1), w of eq. (3), and how far they are from a solution."""
        n, flow = self.n, self.flow
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n], matrix[:n, n] = self.chain.around(1.0), -self.chain.by_lambda[:, 0]
        matrix[n, :n] = flow / np.linalg.norm(flow)  # shifts along the orbit have their turn below
        units, rows = np.append(self.units, self.period), np.append(self.rows, np.max(self.units))
        found, zeta, border = _null_vectors(matrix, units, rows)
        v = self.chain.nodes(found[:n], found[:n], found[n:])
        shift = self.chain.nodes(flow, flow)
        v -= self.mean(self.points(v), self.f) / self.mean(self.points(shift), self.f) * shift
        length = self.length(v)
        return v / length, float(found[n]) / (self.period * length), self.chain.adjoint(zeta[:n]), border

    def points(self, v: np.ndarray) -> np.ndarray:
        """A profile at the Gauss points (N m, n)."""
        return self.grid.at_points(v).reshape(-1, self.n)

    def slopes(self, v: np.ndarray) -> np.ndarray:
        """A profile's derivative by time at the Gauss points (N m, n)."""
        return self.grid.slopes_at_points(v).reshape(-1, self.n) / self.period

    def mean(self, a: np.ndarray, b: np.ndarray) -> float:
        """The mean over the period of Re <a, b>, both at the Gauss points (N m, n)."""
        weights = (self.grid.lengths[:, None] * self.grid.basis.weights).ravel()
        return float(weights @ np.sum(np.real(a.conj() * b), axis=1))

    def length(self, v: np.ndarray) -> float:
        """The norm of eq. (13)."""
        points = self.points(v)
        return float(np.sqrt(self.mean(points, points)))

    def periodic(self, right: np.ndarray) -> tuple[np.ndarray, float]:
        """h and a number s with L h + s f = right, h(T) = h(0) and mean <f, h> = 0."""
        row = self.grid.row(self.f.reshape(-1, self.grid.degree, self.n) / self.speed)
        h, by_period = self.chain.periodic(self.period * right, row)
        return h, -by_period / self.period

    def turned(self, z: complex, right: np.ndarray) -> np.ndarray:
        """h with L h = right, h(T) = z h(0)."""
        return self.chain.turned(z, self.period * right)

    def second(self, *vectors: np.ndarray) -> np.ndarray:
        """The matrices B(v, .) (k, N m, n, n) for real vectors (N m, n)."""
        return second_along(self.tape, self.inputs, np.stack(vectors))

    def third(self, *vectors: np.ndarray) -> np.ndarray:
        """C(v, v, v) (k, N m, n) for real vectors (N m, n)."""
        return third_along(self.tape, self.inputs, np.stack(vectors))


def _null_vectors(
    matrix: np.ndarray, units: np.ndarray, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """x, y with M x = 0 and y' M = 0 (no conjugates) for M (k, k) of rank k - 1; its least singular value.

    units, rows (k,): the sizes of unknowns and equations. All are not a number where the matrix is.
    """
    if not np.all(np.isfinite(matrix)):
        none = np.full(units.shape, np.nan, dtype=matrix.dtype)
        return none, none, np.nan
    left, sizes, right = np.linalg.svd(matrix * units / rows[:, None])
    return units * right[-1].conj(), left[:, -1].conj() / rows, float(sizes[-1])
