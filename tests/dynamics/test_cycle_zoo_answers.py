"""The cycle zoo's answers, proved without the code they are there to test.

Orbits by Fourier differentiation, multipliers by Magnus' series along the exact orbit, places of special points by
scanning the multipliers, criticality by the side on which the other cycles lie, van der Pol by two integrators, loops
by SymPy.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import rainwind as rw
from rainwind.dynamics import cycle_zoo
from rainwind.dynamics.cycle_zoo import planar
from rainwind.dynamics.cycle_zoo.van_der_pol import TABLE

ZOO = cycle_zoo.everything()
EXACT = [name for name in ZOO if name != "alpha loop" and not name.startswith("van der pol")]


def places(known):
    low, high = known.until
    return [
        known.system.parameters[known.along],
        *(low + share * (high - low) for share in (0.13, 0.52, 0.87)),
    ]


def some_cycles(known):
    return [cycle for value in places(known) for cycle in known.cycles({known.along: value})]


def residual(known, cycle, points=256):
    """Largest |x' - f(x)|, the derivative from the orbit's Fourier coefficients."""
    times = np.arange(points) * cycle.period / points
    x = cycle.at(times)
    numbers = np.fft.fftfreq(points, 1 / points)
    numbers[points // 2] = 0
    derivative = np.fft.ifft(
        2j * np.pi / cycle.period * numbers[:, None] * np.fft.fft(x, axis=0), axis=0
    ).real
    f = known.system.f(x, cycle.parameters)
    return np.abs(derivative - f).max() / max(1.0, np.abs(f).max())


def monodromy(known, cycle, steps=300):
    """The variational equation along the exact orbit by Magnus' series of order 6 (Blanes et al. 2009, eq. 253)."""
    h = cycle.period / steps
    nodes = h * (0.5 + np.sqrt(0.15) * np.array([-1, 0, 1]))
    times = (np.arange(steps)[:, None] * h + nodes).ravel()
    a = known.system.jacobian(cycle.at(times), cycle.parameters)
    a1, a2, a3 = a.reshape(steps, 3, *a.shape[1:]).swapaxes(0, 1)
    b0, b1, b2 = h * a2, h * np.sqrt(15) / 3 * (a3 - a1), h * 10 / 3 * (a3 - 2 * a2 + a1)

    def bracket(x, y):
        return x @ y - y @ x

    c1 = bracket(b0, b1)
    c2 = -bracket(b0, 2 * b2 + c1) / 60
    found = np.eye(len(known.system.states))
    for factor in expm(b0 + b2 / 12 + bracket(-20 * b0 - b2 + c1, b1 + c2) / 240):
        found = factor @ found
    return found


def multiplier_error(known, cycle):
    """How far the computed multipliers are from the exact ones, each taken once, relative to the largest."""
    found, worst = list(np.linalg.eigvals(monodromy(known, cycle))), 0.0
    scale = max(1.0, np.abs(cycle.multipliers).max())
    for multiplier in cycle.multipliers:
        nearest = min(found, key=lambda other: abs(other - multiplier))
        found.remove(nearest)
        worst = max(worst, abs(nearest - multiplier) / scale)
    return worst


@pytest.mark.parametrize("name", EXACT)
def test_cycles_solve_the_equations_and_their_period_is_the_least(name):
    known = ZOO[name]
    assert known.start.branch == known.branch
    for cycle in some_cycles(known):
        # the level curve is nearly homoclinic at the window's end: its harmonics need more points
        assert residual(known, cycle) < 1e-10
        at = cycle.at(np.arange(2) * cycle.period)
        np.testing.assert_allclose(at[1], at[0], atol=1e-10 * max(1.0, np.abs(at).max()))
        for part in (2, 3, 5):
            assert np.abs(cycle.at(cycle.period / part) - at[0]).max() > 1e-2 * np.abs(at).max() / part


@pytest.mark.parametrize("name", EXACT)
def test_multipliers_are_those_of_the_variational_equation(name):
    known = ZOO[name]
    for cycle in some_cycles(known):
        assert multiplier_error(known, cycle) < 1e-7
        times = np.arange(2000) * cycle.period / 2000
        trace = np.trace(known.system.jacobian(cycle.at(times), cycle.parameters), axis1=-2, axis2=-1)
        total = cycle.exponents.sum().real  # Liouville: also for multipliers that underflow
        assert total == pytest.approx(cycle.period * trace.mean(), rel=1e-9, abs=1e-9)


def test_the_checks_see_a_wrong_answer():
    known = ZOO["forced oscillator"]
    cycle = known.start
    assert residual(known, replace(cycle, period=cycle.period * 1.001)) > 1e-5
    assert residual(known, replace(cycle, parameters={**cycle.parameters, "damping": 0.0501})) > 1e-5
    assert multiplier_error(known, replace(cycle, exponents=cycle.exponents * 1.00001)) > 1e-6


@pytest.mark.parametrize("name", EXACT)
def test_a_disguise_changes_neither_cycles_nor_multipliers(name):
    known, rng = ZOO[name], np.random.default_rng(7)
    n = len(known.system.states)
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0]
    hidden = cycle_zoo.disguised(known, turn @ np.diag(10 ** rng.uniform(-0.5, 0.5, n)), 0.2)
    assert residual(hidden, hidden.start) < 1e-9
    if name != "stiff":  # rates of 1e6 and coordinates that mix them: Magnus' steps would have to be shorter
        assert multiplier_error(hidden, hidden.start) < 1e-6


# --- special points ----------------------------------------------------------------------------------


def critical(answer):
    """The exponents, modulo 2 pi i, that a cycle must have beside the trivial one."""
    one, flip = [0.0], [1j * np.pi]
    pairs = [sign * 1j * angle for angle in np.atleast_1d(answer.angle or []) for sign in (1, -1)]
    return {
        "lpc": one, "bp": one, "cpc": one, "pd": flip, "gpd": flip, "ns": pairs, "ch": pairs, "r3": pairs, "r4": pairs,
        "r1": one * 2, "r2": flip * 2, "foldflip": one + flip, "lpns": one + pairs, "pdns": flip + pairs, "nsns": pairs,
    }[answer.kind]  # fmt: skip


def distance(exponent, target):
    off = exponent - target
    return abs(complex(off.real, np.angle(np.exp(1j * off.imag))))


def lack(cycle, targets):
    """How far the cycle is from having these exponents; the trivial one is spoken for."""
    left, worst = list(cycle.exponents), 0.0
    for target in [0.0, *targets]:
        nearest = min(left, key=lambda exponent: distance(exponent, target))
        left.remove(nearest)
        worst = max(worst, distance(nearest, target))
    return worst


ANSWERS = [(name, answer) for name, known in ZOO.items() for answer in known.answers]
CURVES = [(name, curve) for name, known in ZOO.items() for curve in known.curves]


@pytest.mark.parametrize(("name", "answer"), ANSWERS)
def test_the_multipliers_at_a_special_point(name, answer):
    known = ZOO[name]
    assert known.until[0] < answer.at[known.along] < known.until[1]
    assert len(critical(answer)) == (2 if answer.kind == "ns" else 1)
    # a double root of the equation for the cycle has half the digits
    assert min(lack(cycle, critical(answer)) for cycle in known.cycles(answer.at, known.branch)) < 1e-6


def unstable(cycle):
    return int(np.sum(cycle.exponents.real > 1e-9))


def cells(grid, values):
    """Numbers of the intervals of the grid that hold these values."""
    return {int(np.searchsorted(grid, value)) for value in values if grid[0] < value < grid[-1]}


def changes(signatures):
    return {k + 1 for k, (before, after) in enumerate(pairwise(signatures)) if before != after}


@pytest.mark.parametrize("name", EXACT)
def test_no_special_point_of_a_branch_is_missing(name):
    """Along the window the unstable multipliers, or the cycles, change in number at the answers only."""
    known = ZOO[name]
    grid = np.linspace(*known.until, 487) + 1e-7
    found = [
        sorted(unstable(cycle) for cycle in known.cycles({known.along: value}, known.branch))
        for value in grid
    ]
    ends = [value for value in (known.hopf, known.homoclinic) if value is not None]
    assert changes(found) == cells(grid, [answer.at[known.along] for answer in known.answers] + ends)


def on_curve(known, curve, free):
    """All parameters of the curve's points at this value of its first parameter."""
    low, high = curve.until[curve.along[1]]
    middle, half = (low + high) / 2, (high - low) / 2

    def at(value):
        return {**known.system.parameters, curve.along[0]: free, curve.along[1]: value}

    # beyond the window too, so that leaving it is no event
    grid = np.linspace(middle - 3.01 * half, middle + 3 * half, 700)
    sizes = [curve.equation(at(value)) for value in grid]
    return [
        at(brentq(lambda value: curve.equation(at(value)), low, high, xtol=1e-15, rtol=1e-14))
        for (low, a), (high, b) in pairwise(zip(grid, sizes, strict=True))
        if a * b < 0
    ]


def critical_cycles(known, curve, parameters):
    """(the critical exponents, the others) of the cycles with the curve's defining condition."""
    for cycle in known.cycles(parameters, known.branch):
        left = list(cycle.exponents)
        left.remove(min(left, key=abs))
        if curve.kind == "ns":
            pairs = [(a, b) for k, a in enumerate(left) for b in left[:k]]
            pair = min(pairs, key=lambda pair: distance(sum(pair), 0.0))
            # of two pairs on the circle one is wanted: the same at every point of the curve is what counts
            chosen, size = list(pair), distance(sum(pair), 0.0)
        else:
            target = {"lpc": 0.0, "pd": 1j * np.pi}[curve.kind]
            chosen = [min(left, key=lambda exponent: distance(exponent, target))]
            size = distance(chosen[0], target)
        if size < 3e-5:  # at a fold the equation for the cycle has a double root: half the digits
            for exponent in chosen:
                left.remove(exponent)
            yield chosen, left


@pytest.mark.parametrize(("name", "curve"), CURVES)
def test_the_answers_of_a_curve(name, curve):
    known = ZOO[name]
    starts = [answer for answer in known.answers if answer.kind == curve.kind]
    assert starts
    for answer in (*starts, *curve.answers):
        parameters = {**known.system.parameters, **answer.at}
        assert curve.equation(parameters) == pytest.approx(0.0, abs=1e-12)
        assert all(curve.until[key][0] < parameters[key] < curve.until[key][1] for key in curve.along)
        assert min(lack(cycle, critical(answer)) for cycle in known.cycles(parameters, known.branch)) < 1e-6


@pytest.mark.parametrize(("name", "curve"), CURVES)
def test_no_special_point_of_a_curve_is_missing(name, curve):
    """Along it the other multipliers cross the unit circle, and the pair passes a resonance, at the answers only."""
    known = ZOO[name]
    grid = np.linspace(*curve.until[curve.along[0]], 300)
    found, seen = [], 0
    for free in grid:
        signature = []
        for parameters in on_curve(known, curve, free):
            for chosen, others in critical_cycles(known, curve, parameters):
                count = sum(exponent.real > 1e-9 for exponent in others)
                real = max(abs(exponent.real) for exponent in chosen) > 1e-4
                angle = abs(np.angle(np.exp(1j * chosen[0].imag)))
                sector = int(np.searchsorted([np.pi / 2, 2 * np.pi / 3], angle)) if curve.kind == "ns" else 0
                signature.append((count, -1 if real and curve.kind == "ns" else sector))
        seen += bool(signature)
        found.append(sorted(signature))
    assert seen > 100
    marks = {"r1", "r2", "r3", "r4", "foldflip", "lpns", "pdns", "nsns"}
    if name == "zero-hopf" and curve.kind == "ns":
        marks.add("ch")  # where the curve turns in its first parameter
    expected = [answer.at[curve.along[0]] for answer in curve.answers if answer.kind in marks]
    if name == "bautin":
        expected.append(0.0)  # where the cycle has shrunk to the equilibrium
    assert changes(found) == cells(grid, expected)


# --- criticality -------------------------------------------------------------------------------------


def softness(known, at, step):
    """Whether the doubled cycle beside a pd point, the smallest, lies where the single one is unstable to it."""
    beside = []
    for sign in (1, -1):
        changed = {**at, known.along: at[known.along] + sign * step}
        single = min(known.cycles(changed, "main"), key=lambda c: distance(flip(c), 1j * np.pi))
        beside += [(amplitude(c), bool(flip(single).real > 0)) for c in known.cycles(changed, "doubled")]
    return min(beside)[1] if beside else None


def flip(cycle):
    """The exponent next to the multiplier -1."""
    return min(cycle.exponents, key=lambda exponent: distance(exponent, 1j * np.pi))


def amplitude(cycle):
    """How far half a doubled period leads away."""
    return np.linalg.norm(cycle.at(cycle.period / 2) - cycle.at(0.0)) / 2


@pytest.mark.parametrize(("name", "answer"), [a for a in ANSWERS if a[1].kind == "pd"])
def test_on_which_side_of_a_period_doubling_the_doubled_cycles_are(name, answer):
    known = ZOO[name]
    assert softness(known, answer.at, 1e-4) is answer.soft


@pytest.mark.parametrize(("name", "curve"), [c for c in CURVES if c[1].kind == "pd"])
def test_criticality_changes_along_a_curve_of_period_doublings_where_it_should(name, curve):
    """The cubic coefficient vanishes at gpd, and is infinite at foldflip and r2."""
    known, grid = ZOO[name], np.linspace(*curve.until[curve.along[0]], 300)
    found = []
    for free in grid:
        (place,) = on_curve(known, curve, free)
        found.append(softness(known, {key: place[key] for key in curve.along}, 1e-7))
    assert None not in found
    expected = [a.at[curve.along[0]] for a in curve.answers if a.kind in ("gpd", "foldflip", "r2")]
    assert changes(found) == cells(grid, expected)


@pytest.mark.parametrize(("name", "at"), [(n, a.at) for n, c in CURVES for a in c.answers if a.kind == "cpc"])
def test_three_cycles_meet_at_a_cusp(name, at):
    known, far = ZOO[name], 0.05
    assert len(known.cycles({**at, "a": far})) == 3
    assert [len(known.cycles({**at, "a": -far})), len(known.cycles({**at, "b": far}))] == [1, 1]
    for cycle in known.cycles({**at, "a": far}):  # all of them near the origin of the cubic
        assert abs(cycle.exponents.real).min() == 0
        nearest = np.sort(abs(cycle.exponents.real))[1]
        assert 0 < nearest < 10 * far * cycle.period


def test_criticality_changes_at_the_chenciner_point():
    signs = []
    for nu in (-sympy.Rational(1, 100), sympy.Rational(1, 100)):
        square = Z1**2 + Z2**2
        growth = nu * square - square**2  # of zoo.bautin, at mu = 0
        f = [growth * Z1 - Z2, Z1 + growth * Z2]
        signs.append(first_lyapunov(f, [Z1, Z2], [0, 0], 1))
    assert signs == pytest.approx([-0.02, 0.02])


def first_lyapunov(f, x, at, omega):
    """l1 by Kuznetsov's eq. (5.62), in numbers of 30 digits."""
    subs = dict(zip(x, at, strict=True))
    a = sympy.Matrix(f).jacobian(x).subs(subs).evalf(30)
    q = sympy.Matrix([a[0, 1], sympy.I * omega - a[0, 0]])
    p = sympy.Matrix([a[1, 0], -sympy.I * omega - a[0, 0]])
    q, p = (q / q.norm()).evalf(30), p.evalf(30)
    p = (p / sympy.conjugate((p.H * q)[0])).evalf(30)

    def form(*vectors):
        total = [0] * len(f)
        for k, component in enumerate(f):
            for index in np.ndindex(*(len(x),) * len(vectors)):
                d = component
                for i in index:
                    d = sympy.diff(d, x[i])
                total[k] += d.subs(subs) * sympy.prod([v[i] for v, i in zip(vectors, index, strict=True)])
        return sympy.Matrix(total)

    bar = q.conjugate()
    total = (
        form(q, q, bar)
        - 2 * form(q, a.LUsolve(form(q, bar)))
        + form(bar, (2 * sympy.I * omega * sympy.eye(2) - a).LUsolve(form(q, q)))
    )
    return float(sympy.re((p.H * total)[0].evalf(20)) / (2 * omega))


Z1, Z2 = sympy.symbols("z1 z2", real=True)


@pytest.mark.parametrize("name", ["1:2, ns", "1:2, doubled"])
def test_criticality_of_the_neimark_sacker_points_of_the_resonance(name):
    known = ZOO[name]
    (answer,) = known.answers
    q = sympy.nsimplify(known.system.parameters["q"])
    a = sympy.nsimplify(answer.at["a"])
    f = [Z2, -(q + Z1**2) * Z1 + (2 * a - Z1**2) * Z2]
    at, omega = ([0, 0], sympy.sqrt(q)) if q > 0 else ([sympy.sqrt(-q), 0], sympy.sqrt(-2 * q))
    assert (first_lyapunov(f, [Z1, Z2], at, omega) < 0) is answer.soft


def test_criticality_of_the_doubled_neimark_sacker_point_of_the_fold_flip():
    known = ZOO["fold-flip, doubled"]
    (answer,) = known.answers
    a, e, b = (
        sympy.nsimplify(value)
        for value in (known.system.parameters["a"], known.system.parameters["e"], answer.at["b"])
    )
    at = [-a / 2, sympy.sqrt(a / 2)]
    f = [b - Z1**2 - e * Z2**2, (a + Z1 - Z2**2) * Z2]
    omega = sympy.sqrt(a * (e - a))
    assert (first_lyapunov(f, [Z1, Z2], at, omega) < 0) is answer.soft


# --- loops and van der Pol ---------------------------------------------------------------------------

X, Y, MU, H = sympy.symbols("x y mu h", real=True)


def derivatives(known, **parameters):
    named = cycle_zoo.Named({**known.system.parameters, **parameters})
    return known.system.rhs(cycle_zoo.Named({"x": X, "y": Y}), named)


def test_the_alpha_loop_is_homoclinic_at_zero():
    f, g = (sympy.nsimplify(value) for value in derivatives(ZOO["alpha loop"], mu=0))
    loop = X**2 * (1 - X) - Y**2
    cofactor = sympy.cancel((sympy.diff(loop, X) * f + sympy.diff(loop, Y) * g) / loop)
    assert sympy.denom(cofactor) == 1  # the curve is invariant
    assert sympy.Matrix([f, g]).jacobian([X, Y]).subs({X: 0, Y: 0}).eigenvals() == {1: 1, -3: 1}
    # and no equilibrium lies on its closed part, 0 < x <= 1
    for x, y in sympy.solve([f, g], [X, Y]):
        assert not (0 < x <= 1) or sympy.simplify(loop.subs({X: x, Y: y})) != 0


def test_the_hopf_point_of_the_alpha_loop():
    f, g = (sympy.nsimplify(value) for value in derivatives(ZOO["alpha loop"], mu=MU))
    x = sympy.solve(sympy.diff(f, X) + sympy.diff(g, Y), X)[0]
    y = sympy.solve(f.subs(X, x), Y)[0]
    equation = sympy.Poly(sympy.numer(sympy.together(g.subs({X: x, Y: y}))), MU)
    root = min(equation.nroots(n=20), key=lambda root: abs(root - sympy.Float("0.07614")))
    assert float(root) == pytest.approx(ZOO["alpha loop"].hopf, abs=1e-15)


def test_the_alpha_loop_has_a_cycle_between_the_loop_and_the_hopf_point():
    """Its period grows like |ln mu| as mu -> 0 (the stable cycle attracts what starts beside the equilibrium)."""
    system, periods = ZOO["alpha loop"].system, []

    def crossing(_, x):
        return x[1] - 0.1

    crossing.direction = 1
    for mu in (0.05, 0.01, 0.001):
        run = solve_ivp(
            lambda _, x, mu=mu: system.f(x, {"mu": mu}), (0, 200), [0.8, 0.11], "DOP853",
            events=crossing, rtol=1e-10, atol=1e-12,
        )  # fmt: skip
        gaps = np.diff(run.t_events[0])
        assert gaps[-1] == pytest.approx(gaps[-2], rel=1e-6)
        periods.append(gaps[-1])
    assert periods[0] < periods[1] < periods[2]
    # the time near the saddle of unstable rate 1: ln 10 more for a tenth of mu
    assert periods[2] - periods[1] == pytest.approx(np.log(10), rel=0.15)


def test_the_level_curve():
    f, g = derivatives(ZOO["level curve"], h=H)
    energy = Y**2 / 2 + X**2 / 2 - X**3 / 3
    rate = sympy.diff(energy, X) * f + sympy.diff(energy, Y) * g
    slope = sympy.diff(energy, X) ** 2 + sympy.diff(energy, Y) ** 2
    assert sympy.simplify(sympy.nsimplify(rate) + 2 * (energy - H) * slope) == 0
    for h in (1e-3, 0.05, 0.16, 1 / 6 - 1e-6):
        (cycle,) = ZOO["level curve"].cycles({"h": h})
        e1, e2, e3 = np.sort(np.roots([2 / 3, -1, 0, 2 * h]).real)
        # x = e1 + (e2 - e1) sin^2 u takes the square roots away
        time, _ = quad(
            lambda u, e1=e1, e2=e2, e3=e3: 2 / np.sqrt(2 / 3 * (e3 - e1 - (e2 - e1) * np.sin(u) ** 2)),
            0, np.pi / 2, epsabs=1e-12, epsrel=1e-12, limit=500,
        )  # fmt: skip
        assert cycle.period == pytest.approx(2 * time, rel=1e-7)
    assert ZOO["level curve"].homoclinic == 1 / 6


@pytest.mark.parametrize("mu", TABLE)
def test_van_der_pol_by_another_integrator(mu):
    period, amplitude_there, exponent = TABLE[mu]

    def rhs(_, x):
        return x[1], mu * (1 - x[0] ** 2) * x[1] - x[0], mu * (1 - x[0] ** 2)

    def crest(_, x):
        return x[1]

    crest.direction = -1
    for method, tolerance in (("DOP853", 1e-13), ("LSODA", 1e-12)):
        run = solve_ivp(
            rhs, (0, 1.01 * period), [amplitude_there, 0, 0], method, events=crest, rtol=tolerance, atol=1e-13
        )
        (time, state) = run.t_events[0][-1], run.y_events[0][-1]
        assert time == pytest.approx(period, rel=1e-10 if method == "DOP853" else 1e-8)
        assert state[0] == pytest.approx(amplitude_there, rel=1e-9)
        assert state[2] == pytest.approx(exponent, rel=1e-8)


def test_van_der_pol_against_the_literature():
    # Andersen & Geer (1982): the frequency in powers of mu^2; Dorodnitsyn (1947): two terms for large mu
    omega = 1 - 0.1**2 / 16 + 17 * 0.1**4 / 3072 + 35 * 0.1**6 / 884736
    assert TABLE[0.1][0] == pytest.approx(2 * np.pi / omega, rel=1e-10)
    for mu, period in ((1.0, 6.6632868593), (5.0, 11.6122306677), (10.0, 19.0783695669)):
        assert TABLE[mu][0] == pytest.approx(period, abs=6e-11)
    for mu in (10.0, 20.0):
        first = (3 - 2 * np.log(2)) * mu + 3 * 2.338107410459767 * mu ** (-1 / 3)
        assert abs(TABLE[mu][0] - first) < np.log(mu) / mu * 2


@pytest.mark.parametrize("name", ["van der pol", "van der pol, classical"])
def test_van_der_pol_is_the_same_in_both_forms(name):
    known = ZOO[name]
    for mu in TABLE:
        (cycle,) = known.cycles({"mu": mu})
        x = cycle.at(np.linspace(0, cycle.period * 0.999999, 5))
        assert x[0, 0] == pytest.approx(x[-1, 0], rel=1e-5)
    assert residual(known, known.start) < 1e-8
    assert multiplier_error(known, known.start) < 1e-8


@pytest.mark.parametrize("name", [name for name, known in ZOO.items() if known.equilibrium])
def test_the_hopf_point_where_a_branch_is_born(name):
    known = ZOO[name]
    branch = rw.continue_equilibria(
        known.system, known.along, start=known.equilibrium, until=known.until, ds=0.05
    )
    found = [point.parameter for point in branch.points("hopf")]
    assert any(value == pytest.approx(known.hopf, abs=1e-9) for value in found)


def test_the_alpha_loop_s_number_is_a_root():
    m = planar.ALPHA_LOOP_HOPF
    assert 576 * m**4 - 384 * m**3 + 652 * m**2 - 376 * m + 25 == pytest.approx(0, abs=1e-12)
