"""A tape as heyoka expressions, one to one, and heyoka's batch integrator on it. heyoka is no dependency."""

import math
from typing import Any

import numpy as np

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.system import System

try:
    import heyoka
except ImportError:
    heyoka: Any = None

_NAMES = {
    op.SQRT: "sqrt", op.EXP: "exp", op.LOG: "log", op.TAN: "tan", op.TANH: "tanh", op.ATAN: "atan", op.ASIN: "asin",
    op.ACOS: "acos", op.ERF: "erf", op.ATAN2: "atan2",
}  # fmt: skip
_PAIRS = {op.SINCOS: ("sin", "cos"), op.SINHCOSH: ("sinh", "cosh")}


def equations(system: System) -> list[tuple[Any, Any]]:
    """(variable, derivative) of each state, with the system's parameters as numbers."""
    tape = system.tape
    variables = heyoka.make_vars(*system.states)
    values: list[Any] = [*variables, *map(float, system.parameters.values())]
    values += map(float, tape.template[len(values) :])
    for code, z, a, b in tape.operations.tolist():
        x, y = values[a], values[b]
        if code in (op.ADD, op.SUB, op.MUL, op.DIV, op.POWER):
            values[z] = _ARITHMETIC[code](x, y)
        elif code == op.NEG:
            values[z] = -x
        elif code in _PAIRS:
            values[z], values[z + 1] = (_apply(name, x) for name in _PAIRS[code])
        else:
            values[z] = _apply(_NAMES[code], *((x, y) if code in op.BINARY else (x,)))
    return [(v, _expression(values[z])) for v, z in zip(variables, tape.outputs.tolist(), strict=True)]


def integrator(
    system: System, tolerance: float, lanes: int, *, tangents: bool = False, compensated: bool = False
) -> Any:
    """heyoka's adaptive batch integrator; with tangents, of x and the variational equations of first order."""
    rhs: Any = equations(system)
    if tangents:
        rhs = heyoka.var_ode_sys(rhs, heyoka.var_args.vars, order=1)
    start = np.zeros((len(system.states), lanes))
    return heyoka.taylor_adaptive_batch(rhs, start, tol=tolerance, high_accuracy=compensated)


def _apply(name: str, *arguments: Any) -> Any:
    if all(isinstance(value, float) for value in arguments):
        return getattr(math, name)(*arguments)
    return getattr(heyoka, name)(*(_expression(value) for value in arguments))


def _expression(value: Any) -> Any:
    return heyoka.expression(value) if isinstance(value, float) else value


_ARITHMETIC = {
    op.ADD: lambda x, y: x + y, op.SUB: lambda x, y: x - y, op.MUL: lambda x, y: x * y, op.DIV: lambda x, y: x / y,
    op.POWER: lambda x, y: x**y,
}  # fmt: skip


def propagate(run: Any, starts: np.ndarray, duration: float) -> np.ndarray:
    """Integrate (N, n) starts, a batch at a time: (N, n) ends."""
    width = run.batch_size
    ends = np.empty_like(starts)
    for first in range(0, len(starts), width):
        batch = starts[first : first + width]
        run.set_time(0.0)
        run.state[:] = np.resize(batch, (width, starts.shape[1])).T
        run.propagate_until([duration] * width)
        ends[first : first + width] = run.state.T[: len(batch)]
    return ends
