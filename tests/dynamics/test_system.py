"""f, J, J_p, B and C of a System against SymPy; the eigenvalue kernel against LAPACK."""

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import rainwind as rw
from rainwind.dynamics.kernels.spectrum import eigenvalues
from rainwind.dynamics.system import as_system


def rhs(x, p, sin=rw.sin, exp=rw.exp):
    return (
        p.a * x.y - sin(x.x * x.z) + p.b**2 * x.x,
        x.x**2 * x.y - p.a * x.z**3 + exp(-x.y),
        x.x * x.y * x.z + p.b * sin(x.z),
    )


SYSTEM = rw.System(rhs, ("x", "y", "z"), {"a": 1.3, "b": -0.4})
SYMBOLS = sympy.symbols("x y z a b")
AT = (0.3, -0.8, 1.1, 1.3, -0.4)


class Names:
    def __init__(self, **values):
        self.__dict__.update(values)


F = sympy.Matrix(
    rhs(
        Names(**dict(zip("xyz", SYMBOLS[:3], strict=True))),
        Names(a=SYMBOLS[3], b=SYMBOLS[4]),
        sympy.sin,
        sympy.exp,
    )
)


def exact(form):
    return np.array(form.subs(dict(zip(SYMBOLS, AT, strict=True))).evalf(30).tolist(), dtype=complex)


def along(form, *vectors):
    for v in vectors:
        form = form.jacobian(SYMBOLS[:3]) * sympy.Matrix(v)
    return exact(form)[:, 0]


def test_values_and_jacobians():
    x = np.array(AT[:3])
    np.testing.assert_allclose(SYSTEM.f(x), exact(F)[:, 0].real, rtol=1e-14)
    np.testing.assert_allclose(
        SYSTEM.jacobian(x), exact(F.jacobian(SYMBOLS[:3])).real, rtol=1e-13, atol=1e-15
    )
    np.testing.assert_allclose(
        SYSTEM.jacobian_parameters(x, ["b", "a"]),
        exact(F.jacobian([SYMBOLS[4], SYMBOLS[3]])).real,
        rtol=1e-13,
        atol=1e-15,
    )


vectors = st.lists(st.floats(-2, 2).map(lambda v: round(v, 3)), min_size=3, max_size=3)
complex_vectors = st.tuples(vectors, vectors).map(lambda v: np.array(v[0]) + 1j * np.array(v[1]))


@settings(max_examples=15, deadline=None, derandomize=True)
@given(complex_vectors, complex_vectors, complex_vectors)
def test_second_and_third_derivatives_along_complex_vectors(u, v, w):
    x = np.array(AT[:3])
    size = 1e-12 * (1 + np.linalg.norm(u)) * (1 + np.linalg.norm(v)) * (1 + np.linalg.norm(w)) * 10
    np.testing.assert_allclose(SYSTEM.second(x, u, v), along(F, u, v), atol=size)
    np.testing.assert_allclose(SYSTEM.third(x, u, v, w), along(F, u, v, w), atol=size)
    np.testing.assert_allclose(SYSTEM.third(x, w, v, u), SYSTEM.third(x, u, v, w), atol=size)


def test_many_points_at_once_and_other_parameters():
    x = np.random.default_rng(1).normal(size=(4, 5, 3))
    assert SYSTEM.f(x).shape == (4, 5, 3)
    assert SYSTEM.jacobian(x).shape == (4, 5, 3, 3)
    np.testing.assert_array_equal(SYSTEM.jacobian(x)[2, 3], SYSTEM.jacobian(x[2, 3]))
    other = SYSTEM.with_parameters({"a": 2.0})
    np.testing.assert_array_equal(other.f(x), SYSTEM.f(x, {"a": 2.0}))
    assert SYSTEM.parameters["a"] == 1.3
    assert other.tape is SYSTEM.tape


def test_a_model_by_shape_shares_its_tape():
    model = rw.paper_model()
    assert as_system(model).tape is as_system(rw.paper_model()).tape


def nasty(rng, n):
    kind = rng.integers(8)
    a = rng.normal(size=(n, n))
    if kind == 1:
        a *= 10 ** rng.uniform(-8, 8, (n, 1))
    elif kind == 2:
        d = 10 ** rng.uniform(-6, 6, n)
        a = d[:, None] * a / d
    elif kind == 3:
        a = np.diag(rng.normal(size=n)) + np.diag(rng.normal(size=n - 1), 1)
    elif kind == 4:
        a = a - a.T
    elif kind == 5:
        a[rng.random((n, n)) < 0.6] = 0.0
    elif kind == 6:
        a = np.eye(n)[rng.permutation(n)] * rng.choice([-1.0, 1.0], n)
    elif kind == 7:
        a = np.outer(a[0], a[-1])
    return a


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6, 9])
def test_eigenvalues_against_lapack(n):
    """The distance, greatest after pairing, is measured by the backward error: rounding times condition."""
    rng = np.random.default_rng(n)
    for _ in range(600):
        a = nasty(rng, n) if n > 1 else rng.normal(size=(1, 1))
        found, expected = eigenvalues(a), np.linalg.eigvals(a)
        np.testing.assert_array_equal(np.sort_complex(found), np.sort_complex(found.conj()))
        size = np.linalg.norm(a)
        # each is the eigenvalue of a matrix within rounding of a, after balancing at best
        for value in found:
            smallest = np.linalg.svd(a - value * np.eye(n), compute_uv=False)[-1]
            assert smallest <= 1e-13 * size
        assert abs(found.sum() - expected.sum()) <= 1e-12 * size


@pytest.mark.parametrize(
    "matrix",
    [np.zeros((3, 3)), np.eye(4), np.diag([1e-12, 1.0, 1e12]), np.array([[0.0, 1.0], [0.0, 0.0]])],
)
def test_eigenvalues_in_closed_form(matrix):
    np.testing.assert_allclose(
        np.sort(eigenvalues(matrix).real), np.sort(np.diag(matrix)), rtol=1e-12, atol=1e-12
    )


def test_eigenvalues_of_what_is_not_finite_are_not_numbers():
    assert np.all(np.isnan(eigenvalues(np.array([[np.nan, 1.0], [0.0, 1.0]]))))
