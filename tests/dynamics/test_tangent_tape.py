"""Derivatives written as tapes against J from `kernels/tangents.py`, which differentiates while it runs."""

import numpy as np
import pytest
from tests.dynamics.test_taylor_code import FUNCTIONS, STARTS, P

import rainwind as rw
from rainwind.dynamics.kernels.tangents import jacobians
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.system import as_system
from rainwind.dynamics.tangent_tape import with_tangents
from rainwind.dynamics.tape import Tape, trace


def assert_is_jacobian(tape: Tape, states: np.ndarray, parameters: np.ndarray, many: int) -> None:
    n = len(tape.states)
    v = np.random.default_rng(1).normal(size=(len(states), many, n))
    inputs = np.hstack([states, np.tile(parameters, (len(states), 1))])
    f, j = jacobians(*tape.arrays, inputs, np.arange(n))
    both = with_tangents(tape, many)
    assert both.states[:n] == tape.states
    assert len(both.states) == n * (1 + many)
    wide = np.hstack([states, v.reshape(len(states), -1), inputs[:, n:]])
    found = values(*both.arrays, wide)
    np.testing.assert_allclose(found[:, :n], f, rtol=1e-13, atol=1e-13)
    expected = np.einsum("pij,pkj->pki", j, v).reshape(len(states), -1)
    scale = np.maximum(1.0, np.abs(expected).max())
    np.testing.assert_allclose(found[:, n:] / scale, expected / scale, atol=2e-14)


@pytest.mark.parametrize("many", [1, 2])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_operation(name, many):
    assert_is_jacobian(trace(FUNCTIONS[name], ("u", "v"), P), STARTS, np.array([*P.values()]), many)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_twice(name):
    """A tangent is a tape like any other: it has a tangent itself."""
    tape = with_tangents(trace(FUNCTIONS[name], ("u", "v"), P))
    states = np.hstack([STARTS, STARTS[::-1] + 0.3])
    assert_is_jacobian(tape, states, np.array([*P.values()]), 1)


@pytest.mark.parametrize("outside", ["extend", "blend"])
def test_the_rivulet_model(outside):
    system = as_system(rw.paper_model(outside=outside))
    states = np.random.default_rng(3).normal(scale=0.3, size=(20, 6))
    assert_is_jacobian(system.tape, states, np.array([*system.parameters.values()]), 6)


def test_constants_leave_nothing():
    """Operations of parameters alone have no derivative, and none is recorded."""
    tape = trace(lambda x, p: (rw.sin(p.a) * x.u + rw.exp(p.b),), ("u",), P)
    both = with_tangents(tape)
    assert len(both.operations) == len(tape.operations) + 1
