"""Polynomials, tables and expressions as coefficient curves."""

from math import cosh, erf, exp, log, pi, sin, sqrt

import numpy as np
import pytest

from rainwind.errors import InputError
from rainwind.physics import CoefficientSet, Expression, Polynomial, Table, paper_model


def test_polynomial_of_any_degree():
    assert Polynomial((2.0,))(0.3) == 2.0
    assert Polynomial([1, -2, 0, 4])(-0.5) == pytest.approx(1 + 1 - 0.5, abs=1e-15)


def test_table_of_a_polynomial_is_that_polynomial():
    alpha = np.linspace(-1.5, 0.2, 12)
    table = Table(tuple(alpha), tuple(Polynomial((1.0, 2.0, -3.0, 0.5))(alpha)), degree=3)
    assert table.fit_error < 1e-13
    assert table(-2.0) == pytest.approx(1 - 4 - 12 - 4, abs=1e-11)
    assert table(np.array([[0.1]])).shape == (1, 1)


@pytest.mark.parametrize("degree", [0, 1, 2, 5])
def test_table_fits_of_low_degree(degree):
    """The fit is the least-squares polynomial that NumPy finds in powers."""
    alpha = np.linspace(-1.0, 1.5, 9)
    value = np.cos(2 * alpha)
    table = Table(tuple(alpha), tuple(value), degree=degree, allowed_error=2.0)
    expected = np.polyval(np.polyfit(alpha, value, degree), alpha)
    np.testing.assert_allclose(np.broadcast_to(table(alpha), alpha.shape), expected, atol=1e-12)
    assert table.fit_error == pytest.approx(np.max(np.abs(expected - value)), rel=1e-9)


def test_a_bad_fit_is_refused_with_its_error():
    alpha = np.linspace(-1.5, 0.0, 21)
    with pytest.raises(InputError, match=r"degree 2 misses the table by 0\.\d+.*choose another degree"):
        Table(tuple(alpha), tuple(np.sign(alpha + 0.7)), degree=2)


def test_expressions_are_the_formulas_they_say():
    x = -0.7
    for text, value in {
        "0.3*sin(2*alpha) + 0.1": 0.3 * sin(2 * x) + 0.1,
        "alpha**3 - alpha**-2": x**3 - x**-2,
        "-(alpha - pi)/2e0": -(x - pi) / 2,
        "exp(alpha)*erf(alpha)/cosh(alpha)": exp(x) * erf(x) / cosh(x),
        "log(1 + alpha**2)": log(1 + x**2),
        "sqrt(+2)*alpha**0": sqrt(2),
        "atan2(alpha, 1)*tanh(alpha)": np.arctan(x) * np.tanh(x),
    }.items():
        assert Expression(text)(x) == pytest.approx(value, rel=1e-14), text
    np.testing.assert_allclose(Expression("alpha**5")(np.array([1.0, 2.0])), [1, 32])


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')", "alpha.real", "(lambda: 1)()", "[alpha][0]", "beta", "open(alpha)",
        "alpha if alpha else 1", "sin(alpha, 1)", "atan2(alpha)", "sin(x=alpha)", "alpha**alpha",
        "alpha**0.5", "alpha**99",
        "9**(9**9)", "abs(alpha)", "alpha // 2", "alpha % 2", "alpha < 1", "'text'",
        "True", "1j", "", "sin(", "1" * 2000, "alpha**True", "1" + "0" * 400,
    ],
)  # fmt: skip
def test_anything_else_is_refused_and_never_run(text):
    with pytest.raises(InputError, match="expression"):
        Expression(text)


def test_deeply_nested_expressions_are_refused():
    text = "(" * 450 + "alpha" + ")" * 450
    with pytest.raises(InputError, match="not a formula"):
        Expression(text)


def test_a_set_takes_every_form_of_curve():
    alpha = tuple(np.linspace(-1.6, 0.1, 20))
    table = Table(alpha, tuple(np.sin(alpha)), degree=7)
    mixed = CoefficientSet("mixed", "test", "artificial", (-1.5, 0.0), table, "1 + alpha**2", [0.1, 0.2])
    np.testing.assert_allclose(mixed.at(-0.5, "extend"), (sin(-0.5), 1.25, 0.0), atol=1e-7)
    assert len(paper_model(mixed).all_states()) >= 2
    assert hash(mixed) == hash(
        CoefficientSet("mixed", "test", "artificial", (-1.5, 0.0), table, "1 + alpha**2", [0.1, 0.2])
    )
