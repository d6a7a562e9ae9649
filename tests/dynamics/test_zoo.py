"""Every special point of the zoo at its exact place, whatever the step's length, the direction and the coordinates."""

import numpy as np
import pytest
import sympy
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rainwind as rw
from rainwind.dynamics import zoo

STEPS = (0.01, 0.05, 0.2, 1.0)
ZOO = zoo.everything()


def follow(known: zoo.Known, ds: float, system=None, **changes):
    options = {"start": known.start, "until": known.until, **changes}
    return rw.continue_equilibria(system or known.system, known.along, ds=ds, **options)


def follow_curve(known: zoo.Known, curve: zoo.KnownCurve, start, ds: float):
    continue_curve = rw.continue_fold if curve.kind == "fold" else rw.continue_hopf
    return continue_curve(known.system, curve.along, start=start, until=curve.until, ds=ds)


def assert_found(branch, answers, tolerance=1e-9):
    """The labels are the answers: as many, and each within the tolerance."""
    assert branch.audit() == []
    left = list(branch.points())
    for answer in answers:
        near = [
            p
            for p in left
            if p.kind == answer.kind
            and all(abs(p.parameters[k] - v) < tolerance for k, v in answer.at.items())
        ]
        assert near, f"{answer} is missing among {[str(p) for p in left]}"
        left.remove(near[0])
        assert near[0].certificate.holds, str(near[0].certificate)
        if answer.omega is not None:
            assert sorted(np.atleast_1d(near[0].omega)) == pytest.approx(
                sorted(np.atleast_1d(answer.omega)), rel=1e-7
            )
        if answer.lyapunov is not None:
            assert near[0].lyapunov == pytest.approx(answer.lyapunov, rel=1e-6, abs=1e-7)
    assert not left, f"too many: {[str(p) for p in left]}"


@pytest.mark.parametrize("ds", STEPS)
@pytest.mark.parametrize("name", ZOO)
def test_the_points_of_a_branch(name, ds):
    assert_found(follow(ZOO[name], ds), ZOO[name].answers)


CURVES = [(name, k) for name, known in ZOO.items() for k in range(len(known.curves))]


@pytest.mark.parametrize("ds", STEPS)
@pytest.mark.parametrize(("name", "number"), CURVES)
def test_the_points_of_a_curve_from_each_of_its_points(name, number, ds):
    known = ZOO[name]
    curve = known.curves[number]
    for start in follow(known, 0.05).points(curve.kind):
        assert_found(follow_curve(known, curve, start, ds), curve.answers)


@pytest.mark.parametrize("share", [0.01, 0.37, 0.99])
@pytest.mark.parametrize("name", ["hopf", "two oscillators 1e-3", "double crossing 1e-3", "stiff"])
def test_the_start_does_not_matter(name, share):
    known = ZOO[name]
    low, high = known.until
    system = known.system.with_parameters({known.along: low + share * (high - low)})
    for ds in STEPS:
        assert_found(follow(known, ds, system), known.answers)


@pytest.mark.parametrize("factor", [0.6, 3.0, 40.0])
@pytest.mark.parametrize("name", ["brusselator", "cusp", "hopf", "zero-hopf", "double crossing 1e-3"])
def test_the_window_does_not_matter(name, factor):
    known = ZOO[name]
    places = [answer.at[known.along] for answer in known.answers] + [known.system.parameters[known.along]]
    # at its narrowest the window still holds all points
    low, high = known.until
    narrow, wide = min(places) - 0.05 * (high - low), max(places) + 0.05 * (high - low)
    until = (
        (min(factor * low, narrow), max(factor * high, wide)) if low < 0 else (low / factor, factor * wide)
    )
    until = (min(until[0], narrow), max(until[1], wide))
    for ds in (0.05, 1.0):
        assert_found(follow(known, ds, until=until), known.answers, tolerance=3e-9)


def test_the_curve_of_the_cusp_is_its_closed_form():
    known = zoo.cusp()
    curve = follow_curve(known, known.curves[0], follow(known, 0.05).points("fold")[0], 0.1)
    np.testing.assert_allclose(27 * curve["b"] ** 2, 4 * curve["a"] ** 3, atol=1e-9)


def test_the_hopf_curve_of_lorenz_is_its_closed_form():
    known = zoo.lorenz()
    curve = follow_curve(known, known.curves[0], follow(known, 0.05).points("hopf")[0], 0.1)
    sigma, beta = curve["sigma"], 8 / 3
    np.testing.assert_allclose(curve["rho"], sigma * (sigma + beta + 3) / (sigma - beta - 1), rtol=1e-9)


def test_the_hopf_curve_of_the_brusselator_is_its_closed_form():
    known = zoo.brusselator()
    curve = follow_curve(known, known.curves[0], follow(known, 0.05).points("hopf")[0], 0.1)
    np.testing.assert_allclose(curve["b"], 1 + curve["a"] ** 2, rtol=1e-9)


def test_the_hopf_curve_of_predator_and_prey_is_its_closed_form():
    known = zoo.predator_prey()
    curve = follow_curve(known, known.curves[0], follow(known, 0.05).points("hopf")[0], 0.1)
    prey = curve["d"] / (curve["a"] - curve["d"])
    np.testing.assert_allclose(curve["k"], 1 + 2 * prey, rtol=1e-9)


def test_lorenz_is_hard():
    for hopf in follow(zoo.lorenz(), 0.05).points("hopf"):
        assert hopf.parameter == pytest.approx(470 / 19, abs=1e-9)
        assert hopf.lyapunov > 0


@pytest.mark.parametrize("ds", STEPS)
@pytest.mark.parametrize(
    ("name", "closed_form"),
    [("transcritical", lambda mu: mu), ("pitchfork", lambda mu: np.sqrt(np.maximum(mu, 0)))],
)
def test_a_branch_point_leads_onto_the_other_branch(name, closed_form, ds):
    known = ZOO[name]
    (bp,) = follow(known, ds).points("bp")
    other = follow(known, ds, start=bp)
    assert_found(other, known.answers)
    np.testing.assert_allclose(np.abs(other["x"]), np.abs(closed_form(other["mu"])), atol=1e-7)
    assert np.ptp(other["x"]) > 1


def test_the_loop_is_closed():
    for ds in STEPS:
        loop = follow(ZOO["closed loop"], ds)
        assert rw.Ended.CLOSED in loop.ended
        np.testing.assert_allclose(loop["x"] ** 2 + loop["p"] ** 2, 1, atol=1e-10)
        np.testing.assert_allclose(loop.state[0], loop.state[-1], atol=1e-10)


@pytest.mark.parametrize(
    ("first", "second", "near"), [(1.0, 1.001, True), (1.0, 2.3, False), (1.0, 2.02, True)]
)
def test_hopf_hopf_says_when_it_is_near_resonance(first, second, near):
    known = zoo.hopf_hopf(first, second)
    curve = follow_curve(known, known.curves[0], follow(known, 0.05).points("hopf")[0], 0.05)
    (point,) = curve.points("hh")
    assert ("resonance" in point.note) == near


@pytest.mark.parametrize("c", [-2.0, 0.3])
@pytest.mark.parametrize("omega", [0.2, 1.0, 7.0])
def test_lyapunov_coefficient_of_the_normal_form(c, omega):
    known = zoo.hopf(c, omega)
    assert_found(follow(known, 0.2), known.answers)


# --- the closed forms themselves, by SymPy -----------------------------------------------------------


def first_lyapunov(f, x, at, omega):
    """Kuznetsov, 3rd ed., eq. (5.34), exactly; |q| = 1."""
    f, here, n = sympy.Matrix(f), dict(zip(x, at, strict=True)), len(x)
    a = f.jacobian(x).subs(here)
    eye = sympy.eye(n)
    q = sympy.simplify(a - sympy.I * omega * eye).nullspace(simplify=True)[0]
    p = sympy.simplify(a.T + sympy.I * omega * eye).nullspace(simplify=True)[0]
    q = q / sympy.sqrt(sympy.simplify((q.H * q)[0]))
    p = p / sympy.conjugate(sympy.simplify((p.H * q)[0]))

    def form(*vectors):
        total = f
        for v in vectors:
            total = total.jacobian(x) * v
        return total.subs(here)

    bar = q.conjugate()
    total = (
        form(q, q, bar)
        - 2 * form(q, a.LUsolve(form(q, bar)))
        + form(bar, (2 * sympy.I * omega * eye - a).LUsolve(form(q, q)))
    )
    return sympy.simplify(sympy.re(sympy.simplify((p.H * total)[0])) / (2 * omega))


X, Y = sympy.symbols("x y", real=True)


def rhs_of(known, **values):
    """A zoo system's right-hand side with SymPy's symbols."""

    class Names:
        def __init__(self, d):
            self.__dict__.update(d)

    return list(known.system.rhs(Names({"x": X, "y": Y}), Names({**known.system.parameters, **values})))


def test_closed_form_of_the_brusselator():
    a = sympy.Rational(3, 2)
    found = first_lyapunov(rhs_of(zoo.brusselator(), a=a, b=1 + a**2), [X, Y], [a, (1 + a**2) / a], a)
    assert float(found) == pytest.approx(zoo.brusselator(1.5).answers[0].lyapunov, rel=1e-14)


def test_closed_form_of_bogdanov_takens():
    b2, s = -sympy.Rational(9, 16), sympy.Rational(-3, 2)
    w = sympy.Rational(3, 4)
    found = first_lyapunov(rhs_of(zoo.bogdanov_takens(), b1=0, b2=b2, s=s), [X, Y], [0, 0], w)
    assert float(found) == pytest.approx(zoo.bogdanov_takens(-9 / 16, -1.5).answers[0].lyapunov, rel=1e-14)


def test_closed_form_of_predator_and_prey():
    d, prey = sympy.Rational(1, 2), sympy.Rational(3, 2)
    a, k = d * (1 + prey) / prey, 1 + 2 * prey
    y = (1 - prey / k) * (1 + prey) / a
    f = rhs_of(zoo.predator_prey(), a=a, d=d, k=k)
    found = first_lyapunov(f, [X, Y], [prey, y], sympy.sqrt(d / k))
    assert float(found) == pytest.approx(zoo.predator_prey(0.5, 1.5).answers[1].lyapunov, rel=1e-12)


# --- other coordinates, other parameters -------------------------------------------------------------


class Named:
    """Values by name or number, as rhs expects them."""

    def __init__(self, values):
        self._values = values

    def __getattr__(self, name):
        return self._values[name]

    __getitem__ = __getattr__


def transformed(system, matrix, shift, factor, offset, moved):
    """The system in y = matrix x + shift, with the parameters moved = (value - offset) / factor."""
    inverse = np.linalg.inv(matrix)
    n = len(shift)

    def rhs(y, p):
        x = {
            name: sum(inverse[i, j] * (y[j] - shift[j]) for j in range(n))
            for i, name in enumerate(system.states)
        }
        parameters = {
            name: factor * p[name] + offset if name in moved else p[name] for name in system.parameters
        }
        f = system.rhs(Named(x), Named(parameters))
        return [sum(matrix[i, j] * f[j] for j in range(n)) for i in range(n)]

    values = {
        name: (value - offset) / factor if name in moved else value
        for name, value in system.parameters.items()
    }
    return rw.System(rhs, tuple(f"y{i}" for i in range(n)), values)


MOVABLE = [name for name in ZOO if name not in ("stiff", "scaled", "double crossing 1e-6")]


@settings(
    max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.differing_executors]
)
@given(
    name=st.sampled_from(MOVABLE),
    seed=st.integers(0, 10**6),
    factor=st.floats(0.1, 10),
    offset=st.floats(-2, 2),
    ds=st.floats(0.01, 1.0),
)
def test_labels_do_not_depend_on_coordinates(name, seed, factor, offset, ds):
    known = ZOO[name]
    rng = np.random.default_rng(seed)
    n = len(known.start)
    turn, turn_again = (np.linalg.qr(rng.normal(size=(n, n)))[0] for _ in range(2))
    matrix = turn @ np.diag(10 ** rng.uniform(-0.7, 0.7, n)) @ turn_again
    shift = rng.normal(size=n)
    moved = {known.along} | {parameter for curve in known.curves for parameter in curve.along}
    system = transformed(known.system, matrix, shift, factor, offset, moved)

    def back(at):
        return {k: (v - offset) / factor for k, v in at.items()}

    def window(bounds):
        return tuple((bound - offset) / factor for bound in bounds)

    def expected(answers):
        """Frequencies stay; Lyapunov coefficients scale with |q|."""
        return [zoo.Answer(a.kind, back(a.at), a.omega) for a in answers]

    branch = rw.continue_equilibria(
        system, known.along, start=matrix @ np.array(known.start) + shift, until=window(known.until), ds=ds
    )
    assert_found(branch, expected(known.answers), tolerance=1e-7 / factor)
    for curve in known.curves:
        start = branch.points(curve.kind)[0]
        continue_curve = rw.continue_fold if curve.kind == "fold" else rw.continue_hopf
        until = {k: window(bounds) for k, bounds in curve.until.items()}
        found = continue_curve(system, curve.along, start=start, until=until, ds=ds)
        assert_found(found, expected(curve.answers), tolerance=1e-6 / factor)
