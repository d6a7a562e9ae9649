"""The machine code's Taylor coefficients against those of `kernels/jets.py`, which interprets the tape as it stands."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.jets import run_jets
from rainwind.dynamics.system import as_system
from rainwind.dynamics.tape import Tape, trace
from rainwind.dynamics.taylor import TaylorEngine
from rainwind.dynamics.taylor_tape import for_taylor, moving_slots

P = {"a": 0.7, "b": -1.3, "e": 0.31}
STARTS = np.array([[0.37, -0.52], [0.61, 0.24], [0.15, 0.44]])
FUNCTIONS = {
    "add": lambda x, p: (x.u + x.v, x.u + p.a),
    "subtract": lambda x, p: (x.u - x.v, p.a - x.u),
    "multiply": lambda x, p: (x.u * x.v + p.a * x.u, x.u * x.u * x.v - p.b * x.v),
    "divide": lambda x, p: (x.u / (2.0 + x.v), p.a / (x.u + 1.5) - x.v / p.b),
    "divide by itself": lambda x, p: (1.0 / (1.0 / (2.0 + x.v) + x.u), -x.v / p.b),
    "power": lambda x, p: ((1.0 + x.u) ** 2.7, (2.0 + x.v) ** -0.3 * p.a),
    "moving powers": lambda x, p: ((2.0 + x.u) ** (p.e + x.v), p.a**x.u),
    "negative": lambda x, p: (-x.u, -(x.u * x.v)),
    "sqrt": lambda x, p: (rw.sqrt(1.0 + x.u), rw.sqrt(2.0 + x.v * x.u)),
    "exp": lambda x, p: (rw.exp(x.u), rw.exp(-x.v * x.u)),
    "log": lambda x, p: (rw.log(1.0 + x.u), rw.log(2.0 + x.v * x.u)),
    "sin, cos": lambda x, p: (rw.sin(x.u) * rw.cos(x.v), rw.cos(3.0 * x.u) + p.a),
    "sinh, cosh": lambda x, p: (rw.sinh(x.u), rw.cosh(x.v) * rw.sinh(x.v)),
    "tan": lambda x, p: (rw.tan(x.u), rw.tan(x.v * x.u)),
    "tanh": lambda x, p: (rw.tanh(x.u), rw.tanh(3.0 * x.v - x.u)),
    "atan": lambda x, p: (rw.atan(x.u), rw.atan(2.0 * x.v * x.u)),
    "asin, acos": lambda x, p: (rw.asin(x.u), rw.acos(x.v * x.u)),
    "erf": lambda x, p: (rw.erf(x.u), rw.erf(2.0 * x.v - x.u)),
    "atan2": lambda x, p: (rw.atan2(x.u, x.v), rw.atan2(x.v, p.a) + rw.atan2(p.b, x.u)),
    "Horner": lambda x, p: (
        p.a + x.u * (p.b + x.u * (p.e - x.u * (1.5 + 0.3 * x.u))),
        -x.v * (2.0 * x.v) - (x.u - 3.0) * ((x.u - 3.0) * (p.a + p.b * (x.u - 3.0))),
    ),
    "constants": lambda x, p: (p.a * p.b, 3.0),
    "other states": lambda x, p: (x.v, -x.u),
}  # fmt: skip


def by_jets(tape: Tape, state: np.ndarray, parameters: np.ndarray, order: int) -> np.ndarray:
    """All outputs' coefficients (outputs, order + 1), the states' own in place of their derivatives."""
    n, inputs = state.size, state.size + parameters.size
    slots = np.zeros((tape.template.size, order + 1))
    slots[:, 0] = tape.template
    slots[:inputs, 0] = *state, *parameters
    for k in range(order + 1):
        part = np.ascontiguousarray(slots[:, : k + 1])
        run_jets(tape.operations, part)
        if k < order:
            slots[:n, k + 1] = part[tape.outputs[:n], k] / (k + 1)
        slots[n + parameters.size :, : k + 1] = part[n + parameters.size :]
    return np.concatenate([slots[:n], slots[tape.outputs[n:]]])


def by_machine_code(
    tape: Tape, states: np.ndarray, parameters: np.ndarray, order: int, lanes: int
) -> np.ndarray:
    engine = TaylorEngine(tape, 1e-9, order=order, lanes=lanes)
    pieces, _ = engine.pieces(states, 1e-9, parameters)
    return np.array([one.coefficients[0] for one in pieces])


def assert_equal_to_rounding(found: np.ndarray, expected: np.ndarray, scale: float = 1.0) -> None:
    # what rounding does to coefficient k grows with the k-th power of the inverse radius of convergence
    k = np.arange(expected.shape[-1])
    radius = np.max(np.abs(expected[..., 1:]) ** (1.0 / k[1:]), axis=(-2, -1), keepdims=True)
    size = np.maximum(np.abs(expected), np.maximum(1.0, radius) ** k)
    assert np.max(np.abs(found - expected) / size) < scale * 2e-14


@pytest.mark.parametrize("lanes", [1, 4, 8])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_operation(name, lanes):
    tape = trace(FUNCTIONS[name], ("u", "v"), P)
    parameters = np.array([*P.values()])
    found = by_machine_code(tape, STARTS, parameters, 13, lanes)
    expected = np.array([by_jets(tape, x, parameters, 13) for x in STARTS])
    assert_equal_to_rounding(found, expected)


def test_every_opcode_is_among_them():
    tapes = [trace(f, ("u", "v"), P) for f in FUNCTIONS.values()]
    moving = [for_taylor(t) for t in tapes]
    met = {int(row[0]) for t in moving for row in t.operations if moving_slots(t)[row[1]]}
    assert met | {op.DIV} == {
        value for name, value in vars(op).items() if isinstance(value, int) and name != "FIRST_WITH_TWO"
    }


@pytest.mark.parametrize("outside", ["extend", "blend"])
@pytest.mark.parametrize("order", [2, 3, 12, 20])
def test_the_rivulet_model(outside, order):
    system = as_system(rw.paper_model(outside=outside))
    parameters = np.array([*system.parameters.values()])
    states = np.random.default_rng(3).normal(scale=0.3, size=(11, 6))
    found = by_machine_code(system.tape, states, parameters, order, 8)
    expected = np.array([by_jets(system.tape, x, parameters, order) for x in states])
    assert_equal_to_rounding(found, expected, 10.0)


def test_more_outputs_than_states():
    def rhs(x, p):
        return x.v, -x.u + p.a * x.v

    def events(x, p):
        return x.v, rw.sin(x.u * x.v), p.b, x.u - 0.2

    tape = trace(lambda x, p: (*rhs(x, p), *events(x, p)), ("u", "v", "#0", "#1", "#2", "#3"), P)
    both = Tape(("u", "v"), tape.parameters, *without_inputs(tape, 2, 4))
    parameters = np.array([*P.values()])
    found = by_machine_code(both, STARTS, parameters, 9, 4)
    expected = np.array([by_jets(both, x, parameters, 9) for x in STARTS])
    assert found.shape == (3, 6, 10)
    assert_equal_to_rounding(found, expected)


def without_inputs(tape: Tape, first: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A tape's arrays without some inputs that nothing uses."""
    number = np.arange(tape.template.size)
    number[first + count :] -= count
    operations = tape.operations.copy()
    operations[:, 1:] = number[operations[:, 1:]]
    return operations, np.delete(tape.template, np.arange(first, first + count)), number[tape.outputs]


def test_an_angle_without_its_whole_turns():
    """atan2(sin 7u, cos 7u) moves like 7u: u' = 7u - 2 pi m has coefficients in closed form, exact to rounding."""
    tape = trace(lambda x, p: (rw.atan2(rw.sin(7.0 * x.u), rw.cos(7.0 * x.u)),), ("u",), ())
    starts = np.array([[0.37], [0.61], [-5.0]])
    found = by_machine_code(tape, starts, np.zeros(0), 12, 4)[:, 0]
    first = np.angle(np.exp(7j * starts[:, 0]))
    k = np.arange(1, 13)
    expected = first[:, None] * 7.0 ** (k - 1) / np.cumprod(k)
    np.testing.assert_allclose(found[:, 1:], expected, rtol=1e-14)
