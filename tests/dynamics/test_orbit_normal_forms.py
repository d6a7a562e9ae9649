"""Normal forms of cycles against closed forms, hidden by a polynomial change of coordinates, and against equilibria.

In the coordinates y = M p(x), p_i = x_i + bend x_0 x_(i-1), a disturbance v becomes M p'(x) v, of another length, and
nothing else changes: b, c, Re d of the plain system, divided by that length once or twice, are the answer.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import cycle_zoo, zoo
from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.cycle_zoo import suspended
from rainwind.dynamics.normalforms import fold_coefficient, lyapunov_coefficient
from rainwind.dynamics.orbit_equations import OrbitEquations
from rainwind.dynamics.orbit_normal_forms import (
    lpc_coefficient,
    lpc_form,
    near_resonance,
    ns_coefficient,
    ns_form,
    pd_coefficient,
    pd_form,
)
from rainwind.dynamics.sparse_collocation import newton_step

PHASES = (np.arange(512) + 0.5) / 512


@dataclass(frozen=True)
class Case:
    """A critical cycle and disturbance by phase, in plain coordinates; value: for a disturbance so long."""

    kind: str
    rhs: Any
    along: tuple[str, ...]
    parameters: dict[str, float]
    period: float
    cycle: Any
    disturbance: Any
    value: float
    angle: float = 0.0

    @property
    def n(self):
        return len(self.cycle(0.0))


def fold_of_cycles(shear=0.3, along=("b1",), up=1.0):
    """r' = r (b1 + b2 r^2 - r^4), theta' = 1.3 + shear r^2, z' = -0.6 z: r = r0 + xi has xi' = -4 r0^3 xi^2."""
    b2 = 1.4
    r0 = np.sqrt(b2 / 2)
    turn = 1.3 + shear * r0**2

    def rhs(x, p):
        square = x[0] ** 2 + x[2] ** 2
        g, theta = up * p.b1 + p.b2 * square - square**2, 1.3 + shear * square
        return g * x[0] - theta * x[2], -0.6 * x[1], theta * x[0] + g * x[2]

    def circle(radius):
        return lambda s: radius * np.array([np.cos(2 * np.pi * s), 0.0 * s, np.sin(2 * np.pi * s)])

    parameters = {"b1": -up * b2**2 / 4, "b2": b2}
    return Case("lpc", rhs, along, parameters, 2 * np.pi / turn, circle(r0), circle(1.0), -4.0 * up * r0**3)


def doubling(b):
    """A plane w = R(theta / 2) z round the unit circle, z1' = a z1 + b z1^3 + z2, z2' = -0.6 z2: xi = z1 has c = b."""
    carrier, shear = 1.7, 0.31

    def rhs(x, p):
        u, v, c, s = x
        square = (u**2 * (1 + c) + v**2 * (1 - c)) / 2 + u * v * s
        g, turn, radial = p.a + b * square, carrier + shear * square, 1 - c**2 - s**2
        mean, stretch, slant, spin = (g - 0.6) / 2, (g + 0.6) / 2, 0.5, turn / 2 - 0.5
        cosine, sine = stretch * c - slant * s, stretch * s + slant * c
        return (
            (mean + cosine) * u + (sine - spin) * v,
            (sine + spin) * u + (mean - cosine) * v,
            radial * c - turn * s,
            turn * c + radial * s,
        )

    def cycle(s):
        return np.array([0.0 * s, 0.0 * s, np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)])

    def disturbance(s):
        return np.array([np.cos(np.pi * s), np.sin(np.pi * s), 0.0 * s, 0.0 * s])

    return Case("pd", rhs, ("a",), {"a": 0.0}, 2 * np.pi / carrier, cycle, disturbance, b)


def torus(k):
    """w' = (m + 0.8 i) w - (k + 0.4 i) w |w|^2 + (1 + c) z, z' = -0.5 z, round a circle: w = xi has Re d = -k."""
    carrier, shear, spin = 2.3, 0.27, 0.8

    # z moves w's adjoint alone, and c lets its product with v' have a mean
    def rhs(x, p):
        u, v, c, s, z = x
        square = u**2 + v**2
        growth, theta, turn = p.m - k * square, spin - 0.4 * square, carrier + shear * square
        radial = 1 - c**2 - s**2
        return (
            growth * u - theta * v + (1 + c) * z,
            theta * u + growth * v,
            radial * c - turn * s,
            turn * c + radial * s,
            -0.5 * z,
        )

    def cycle(s):
        o = 0.0 * s
        return np.array([o, o, np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), o])

    period = 2 * np.pi / carrier

    def disturbance(s):
        wave, o = 0.5 * np.exp(1j * spin * period * s), 0.0 * s
        return np.array([wave, -1j * wave, o, o, o])

    return Case("ns", rhs, ("m",), {"m": 0.0}, period, cycle, disturbance, -k, spin * period)


CASES = {
    "lpc": fold_of_cycles(),
    "lpc, equal periods": fold_of_cycles(shear=0.0),
    "lpc, downward": fold_of_cycles(up=-1.0),
    "lpc in two parameters": fold_of_cycles(along=("b2", "b1")),
    "soft pd": doubling(-0.9),
    "hard pd": doubling(0.4),
    "soft ns": torus(0.7),
    "hard ns": torus(-0.3),
}
BEND = 0.25


def bent(x):
    return np.array([x[0], *(x[1:] + BEND * x[0] * x[:-1])])


def bent_by(x, v):
    return np.array([v[0], *(v[1:] + BEND * (v[0] * x[:-1] + x[0] * v[:-1]))])


def matrix_of(n):
    return np.eye(n) + 0.3 * np.random.default_rng(n).normal(size=(n, n))


def hidden(case):
    """The system in the coordinates y."""
    n, m = case.n, matrix_of(case.n)
    inverse = np.linalg.inv(m)

    def rhs(y, p):
        straight = [sum(inverse[i, j] * y[j] for j in range(n)) for i in range(n)]
        x = [straight[0]]
        for i in range(1, n):
            x.append(straight[i] - BEND * x[0] * x[i - 1])
        f = case.rhs(x, p)
        g = [f[0]] + [f[i] + BEND * (f[0] * x[i - 1] + x[0] * f[i - 1]) for i in range(1, n)]
        return [sum(m[i, j] * g[j] for j in range(n)) for i in range(n)]

    return rw.System(rhs, tuple(f"y{i}" for i in range(n)), case.parameters)


def units_of(n):
    return 0.4 + 0.5 * np.arange(1, n + 1)


def orbit(case, grid):
    """The collocation's own solution: through the exact one, across the disturbance at lpc, at the parameters else."""
    n, m = case.n, matrix_of(case.n)
    problem = OrbitEquations(
        hidden(case), case.along, grid, units_of(n), case.period, np.ones(len(case.along))
    )
    x = case.cycle(grid.nodes)
    profile = (m @ bent(x)).T
    free = [case.parameters[name] for name in case.along]
    u = np.concatenate([profile.ravel(), [case.period], free])
    rows, corner = (
        np.zeros((1 + len(free), problem.profile_size)),
        np.zeros((1 + len(free), 1 + len(free))),
    )
    rows[0] = problem.phase_row(profile, profile)
    if case.kind == "lpc":
        v = (m @ bent_by(x, case.disturbance(grid.nodes))).T
        rows[1] = grid.row(grid.at_points(v)).ravel()
    else:
        corner[1, 1] = 1.0
    if len(free) > 1:
        corner[2, 1] = 1.0
    size = problem.profile_size
    target = rows @ u[:size] + corner @ u[size:]
    for _ in range(5):
        right = target - rows @ u[:size] - corner @ u[size:]
        at = problem.linearise(u)
        dx, lam = newton_step(at, grid, u[size], problem.defects(u), rows, corner, right[:, None])
        u = u + np.concatenate([dx.ravel(), lam.ravel()])
    assert np.abs(problem.defects(u)).max() < 1e-9
    return problem, u


def expected(case):
    """The value for a disturbance of length 1 in the coordinates y; and the disturbance (512, n)."""
    x, m = case.cycle(PHASES), matrix_of(case.n)
    v = (m @ bent_by(x, case.disturbance(PHASES))).T
    if case.kind == "lpc":
        spectrum = np.fft.fft((m @ bent(x)).T, axis=0)
        numbers = np.fft.fftfreq(512, 1 / 512)[:, None]
        f = np.fft.ifft(2j * np.pi * numbers * spectrum, axis=0).real
        v = v - np.sum(v * f) / np.sum(f**2) * f
    length = np.sqrt(np.mean(np.sum(np.abs(v) ** 2, axis=1)))
    power = 1 if case.kind == "lpc" else 2
    return case.value / length**power, v / length


def form(case, problem, u):
    if case.kind == "ns":
        return ns_form(problem, u, case.angle)
    return (lpc_form if case.kind == "lpc" else pd_form)(problem, u)


@pytest.mark.parametrize("name", CASES)
def test_values_in_closed_form(name):
    case = CASES[name]
    problem, u = orbit(case, Grid.even(Mesh(24, 6)))
    found = form(case, problem, u)
    value, v = expected(case)
    assert found.coefficient == pytest.approx(value, rel=1e-8)
    assert found.border < 1e-8
    side = np.vdot(direction := problem.grid.at(found.direction, PHASES), v)
    if name == "lpc, downward":
        assert side < 0  # v leads where a growing parameter drives
    elif case.kind == "lpc":
        assert side > 0
    assert direction * side / abs(side) == pytest.approx(v, abs=1e-6 * np.abs(v).max())


@pytest.mark.parametrize("degree", [3, 4])
@pytest.mark.parametrize("name", ["lpc", "soft pd", "soft ns"])
def test_the_error_falls_with_the_mesh(name, degree):
    case = CASES[name]
    errors = []
    for intervals in (8, 16, 32):
        problem, u = orbit(case, Grid.even(Mesh(intervals, degree)))
        errors.append(abs(form(case, problem, u).coefficient / expected(case)[0] - 1))
    assert np.log2(errors[0] / errors[2]) / 2 > degree


def exact(known, answer, grid=None):
    """The equations and the zoo's exact cycle with the critical multiplier; and that cycle."""
    grid = grid or Grid.even(Mesh(24, 8))
    critical = 1j * {"lpc": 0.0, "pd": np.pi}.get(answer.kind, answer.angle)

    def distance(cycle):
        return np.sort(np.abs(cycle.multipliers - np.exp(critical)))[int(answer.kind == "lpc")]

    cycle = min(known.cycles(answer.at), key=distance)
    n, names = len(known.system.states), (known.along,)
    # the parameter where the answer is may lie in another than the free one
    problem = OrbitEquations(
        known.system.with_parameters(answer.at), names, grid, np.ones(n), cycle.period, np.ones(1)
    )
    profile = cycle.at(cycle.period * grid.nodes)
    free = problem.system.parameters[known.along]
    return problem, np.concatenate([profile.ravel(), [cycle.period, free]]), cycle


def without_shear(known):
    """The same with one period for all cycles: then disturbances have no part along the cycle."""
    return known.system.with_parameters({"shear": 0.0})


HOPF = {
    "brusselator": (zoo.brusselator, suspended.brusselator),
    "lorenz": (zoo.lorenz, suspended.lorenz),
    "predator-prey": (zoo.predator_prey, suspended.predator_prey),
    "bogdanov-takens": (zoo.bogdanov_takens, suspended.bogdanov_takens),
    "zero-hopf": (zoo.zero_hopf, suspended.zero_hopf),
}


@pytest.mark.parametrize("name", HOPF)
def test_a_hopf_point_carried_round_a_circle_keeps_its_coefficient(name):
    """Re d = omega l1: both are of the disturbance of length 1, and l1 comes from the equilibrium's own formula."""
    base, known = (make() for make in HOPF[name])
    known = replace(known, system=without_shear(known))
    answer = next(a for a in known.answers if a.kind == "ns")
    problem, u, cycle = exact(known, answer)
    state, rates = cycle.at(0.0)[2:], cycle.exponents / cycle.period
    omega = float(rates.imag[np.argmin(np.abs(rates.real) + (rates.imag <= 0.1))])
    here = {k: problem.system.parameters[k] for k in base.system.parameters}
    l1 = lyapunov_coefficient(base.system, state, here, omega)
    assert ns_coefficient(problem, u, omega * cycle.period) == pytest.approx(omega * l1, rel=1e-8)
    assert ns_coefficient(problem, u, -omega * cycle.period) == pytest.approx(omega * l1, rel=1e-8)


@pytest.mark.parametrize(
    ("base", "known"), [(zoo.cusp(), suspended.cusp()), (zoo.closed_loop(), suspended.closed_loop())]
)
def test_a_fold_carried_round_a_circle_keeps_its_coefficient(base, known):
    """b = w'B(v, v) / (2 w'v), towards a growing parameter."""
    known = replace(known, system=without_shear(known))
    for answer in known.answers:
        problem, u, cycle = exact(known, answer)
        here = {k: problem.system.parameters[k] for k in base.system.parameters}
        a, product, w = fold_coefficient(base.system, cycle.at(0.0)[2:], here)
        drift = w @ base.system.jacobian_parameters(cycle.at(0.0)[2:], [known.along], here)[:, 0]
        assert lpc_coefficient(problem, u) == pytest.approx(a / product * np.sign(drift / product), rel=1e-7)


ZOO = cycle_zoo.everything()
DECIDED = [
    (name, k) for name, known in ZOO.items() for k, a in enumerate(known.answers) if a.soft is not None
]
FOLDS = [(name, k) for name, known in ZOO.items() for k, a in enumerate(known.answers) if a.kind == "lpc"]


@pytest.mark.parametrize("hide", [False, True])
@pytest.mark.parametrize(("name", "k"), DECIDED)
def test_the_sign_says_on_which_side_the_others_lie(name, k, hide):
    known = ZOO[name]
    n = len(known.system.states)
    known = cycle_zoo.disguised(known, matrix_of(n), 0.1) if hide else known
    answer = known.answers[k]
    problem, u, _ = exact(known, answer)
    found = pd_form(problem, u) if answer.kind == "pd" else ns_form(problem, u, answer.angle)
    assert (found.coefficient < 0) == answer.soft
    assert found.border < 1e-6


@pytest.mark.parametrize(("name", "k"), FOLDS)
def test_the_sign_says_on_which_side_the_two_cycles_are(name, k):
    known = ZOO[name]
    answer = known.answers[k]
    problem, u, _ = exact(known, answer)
    above, below = (
        len(known.cycles({**answer.at, known.along: answer.at[known.along] + step})) for step in (1e-3, -1e-3)
    )
    assert abs(above - below) == 2
    assert (lpc_coefficient(problem, u) < 0) == (above > below)


def test_a_direction_given_decides_the_side():
    case = CASES["lpc"]
    problem, u = orbit(case, Grid.even(Mesh(12, 4)))
    found = lpc_form(problem, u)
    assert lpc_form(problem, u, like=found.direction).coefficient == found.coefficient
    other = lpc_form(problem, u, like=-found.direction)
    assert other.coefficient == -found.coefficient
    assert (other.direction == -found.direction).all()


def test_there_is_no_coefficient_near_strong_resonance():
    case = CASES["soft ns"]
    problem, u = orbit(case, Grid.even(Mesh(8, 4)))
    for angle in (0.001, np.pi - 0.01, 2 * np.pi / 3 + 0.01, np.pi / 2 - 0.01, -np.pi / 2, 4 * np.pi / 3):
        assert near_resonance(angle)
        assert np.isnan(ns_coefficient(problem, u, angle))
    for angle in (0.02, np.pi - 0.02, 2 * np.pi / 3 + 0.02, np.pi / 2 - 0.02, 2 * np.pi / 5):
        assert not near_resonance(angle)


def test_an_answer_that_is_not_a_number_is_no_error():
    """A profile that has run away gives nan, not an exception."""
    case = CASES["soft pd"]
    problem, u = orbit(case, Grid.even(Mesh(8, 4)))
    u = u.copy()
    u[3] = np.nan
    assert np.isnan(pd_coefficient(problem, u))
    assert np.isnan(lpc_coefficient(problem, u))
    assert np.isnan(ns_coefficient(problem, u, 1.0))
