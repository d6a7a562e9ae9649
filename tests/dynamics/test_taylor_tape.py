"""A tape written anew means the same, and has fewer products of two things that move."""

import numpy as np
import pytest
from tests.dynamics.test_taylor_code import FUNCTIONS, STARTS, P

import rainwind as rw
from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.system import as_system
from rainwind.dynamics.tape import Tape, trace
from rainwind.dynamics.taylor_tape import for_taylor, moving_slots


def products(tape: Tape, driven: tuple[int, ...] = ()) -> tuple[int, int]:
    """How many products of two different moving slots there are, and how many squares."""
    moves = moving_slots(tape, driven)
    rows = [r for r in tape.operations.tolist() if r[0] == op.MUL and moves[r[2]] and moves[r[3]]]
    return sum(r[2] != r[3] for r in rows), sum(r[2] == r[3] for r in rows)


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("driven", [(), (2,), (2, 3, 4)])
def test_same_values(name, driven):
    tape = trace(FUNCTIONS[name], ("u", "v"), P)
    inputs = np.hstack([STARTS, np.tile([*P.values()], (3, 1))])
    found = values(*for_taylor(tape, driven).arrays, inputs)
    np.testing.assert_allclose(found, values(*tape.arrays, inputs), rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize(("outside", "most"), [("extend", (15, 5)), ("blend", (18, 5))])
def test_the_rivulet_model(outside, most):
    system = as_system(rw.paper_model(outside=outside))
    tape = for_taylor(system.tape)
    assert tuple(products(tape)) <= most
    assert sum(products(system.tape)) >= sum(most) + 5
    inputs = system.inputs(np.random.default_rng(0).normal(scale=0.4, size=(50, 6)))
    expected = values(*system.tape.arrays, inputs)
    scale = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(values(*tape.arrays, inputs) / scale, expected / scale, atol=1e-14)


def test_polynomials_of_one_argument_share_powers():
    """Two of degree 4 need x^2, x^3, x^4: one product and two squares, where Horner's form has six products."""

    def rhs(x, p):
        return (
            p.a + x.u * (p.b + x.u * (p.a + x.u * (2.0 - 0.5 * x.u))),
            1.0 + x.u * (p.a - x.u * (p.b - x.u * (3.0 + p.a * x.u))),
        )

    tape = trace(rhs, ("u", "v"), P)
    assert products(tape) == (6, 0)
    assert products(for_taylor(tape)) == (1, 2)


def test_a_shifted_argument_is_not_multiplied_out():
    """(u - 3)^4 near u = 3: in powers of u, rounding would be all that is left."""

    def rhs(x, p):
        s = x.u - 3.0
        return (s * (s * (s * (2.0 * s))), x.v)

    tape = for_taylor(trace(rhs, ("u", "v"), P))
    inputs = np.array([[3.0 + 1e-6, 0.0, *P.values()]])
    s = inputs[0, 0] - 3.0
    assert values(*tape.arrays, inputs)[0, 0] == pytest.approx(2.0 * s**4, rel=1e-14)


def test_constant_factors_leave_products():
    tape = for_taylor(trace(lambda x, p: ((p.a * x.u) * (x.v / p.b), (-x.u) * x.v), ("u", "v"), P))
    assert products(tape) == (1, 0)


def test_nothing_that_moves():
    tape = for_taylor(trace(lambda x, p: (p.a, 2.0), ("u", "v"), P))
    assert values(*tape.arrays, np.array([[0.0, 0.0, *P.values()]])).tolist() == [[P["a"], 2.0]]
