"""A tape of a system with small disturbances beside it: x' = f(x, p) and v' = J(x, p) v for one or more v.

Forward differentiation (Griewank & Walther, Evaluating Derivatives, ch. 3), operation by operation; what comes out is
a tape like any other, so that whatever integrates x integrates its variational equations too.
"""

from math import pi, sqrt
from typing import Any

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.tape import Symbol, Tape, _Recorder


def with_tangents(tape: Tape, directions: int = 1) -> Tape:
    """States x (n), then v_1 (n), ..., v_k (n), named `name, direction 1` and so on; parameters as they are.

    The tape's outputs beyond its states follow last, without derivatives.
    """
    return _Differentiation(tape, directions).run()


_SECOND_IS_KNOWN = frozenset((op.SINCOS, op.SINHCOSH))


class _Differentiation:
    """Values and derivatives of all slots; a derivative of zero is the number 0.0, and no operation is recorded."""

    def __init__(self, tape: Tape, directions: int) -> None:
        self.tape, self.many = tape, directions
        n, m = len(tape.states), len(tape.parameters)
        self.states = (
            *tape.states, *(f"{name}, direction {k + 1}" for k in range(directions) for name in tape.states)
        )  # fmt: skip
        self.r = r = _Recorder(len(self.states) + m)
        first = int(tape.operations[0, 1]) if len(tape.operations) else tape.template.size
        self.value: dict[int, Any] = {i: float(tape.template[i]) for i in range(n + m, first)}
        self.value |= {i: Symbol(r, ("in", i if i < n else i + n * directions)) for i in range(n + m)}
        self.along: dict[int, list[Any]] = {i: [0.0] * directions for i in range(n, first)}
        self.along |= {i: [Symbol(r, ("in", n + k * n + i)) for k in range(directions)] for i in range(n)}

    def run(self) -> Tape:
        rows = self.tape.operations.tolist()
        angles = {z: a for code, z, a, _ in rows if code == op.SINCOS}
        for code, z, a, b in rows:
            whole_turns = code == op.ATAN2 and b == a + 1 and a in angles
            self._record(code, z, a, b)
            self.along[z] = self.along[angles[a]] if whole_turns else self._derivative(code, z, a, b)
            if code in _SECOND_IS_KNOWN:
                sign = -1.0 if code == op.SINCOS else 1.0
                self.along[z + 1] = self._times(sign, self._times(self.value[z], self.along[a]))
        n, outputs = len(self.tape.states), self.tape.outputs.tolist()
        found = [self.value[i] for i in outputs[:n]]
        found += [self.along[i][k] for k in range(self.many) for i in outputs[:n]]
        found += [self.value[i] for i in outputs[n:]]
        return self.r.finish(self.states, self.tape.parameters, [self.r.key(value) for value in found])

    def _record(self, code: int, z: int, a: int, b: int) -> None:
        r, x, y = self.r, self.value[a], self.value[b]
        if code in (op.ADD, op.SUB, op.MUL, op.DIV):
            self.value[z] = r.binary(code, x, y)
        elif code == op.NEG:
            self.value[z] = r.unary(code, x)
        else:
            keys = (r.key(x), r.key(y)) if code in op.BINARY else (r.key(x),)
            self.value[z] = r.record(code, *keys)
            if code in _SECOND_IS_KNOWN:
                self.value[z + 1] = r.record(code, *keys, second=True)

    def _derivative(self, code: int, z: int, a: int, b: int) -> list[Any]:
        r, value, u, v = self.r, self.value, self.along[a], self.along[b]
        x, y, f = value[a], value[b], value[z]
        if code in (op.ADD, op.SUB):
            return self._sum(code, u, v)
        if code == op.MUL:
            return self._sum(op.ADD, self._times(y, u), self._times(x, v))
        if code == op.DIV:
            return self._over(self._sum(op.SUB, u, self._times(f, v)), y)
        if code == op.NEG:
            return self._times(-1.0, u)
        if code == op.POWER:
            return self._times(r.binary(op.DIV, r.binary(op.MUL, y, f), x), u)
        if code == op.SQRT:
            return self._over(self._times(0.5, u), f)
        if code == op.EXP:
            return self._times(f, u)
        if code == op.LOG:
            return self._over(u, x)
        s = self._beside(code, z, a, b)
        if code == op.ATAN2:
            return self._over(self._sum(op.SUB, self._times(y, u), self._times(x, v)), s)
        if code in (op.ATAN, op.ASIN):
            return self._over(u, s)
        if code == op.ACOS:
            return self._over(self._times(-1.0, u), s)
        return self._times(s, u)  # sin, sinh, tan, tanh, erf

    def _beside(self, code: int, z: int, a: int, b: int) -> Any:
        """What the derivative of an operation needs beside its value: the second slot, as operations of its own.

        Only sine and hyperbolic sine have a second slot that others than `jets.py` differentiate.
        """
        r, x, y, f = self.r, self.value[a], self.value[b], self.value[z]
        square = lambda one: r.binary(op.MUL, one, one)  # noqa: E731
        if code in _SECOND_IS_KNOWN:
            return self.value[z + 1]
        if code == op.ATAN2:
            return r.binary(op.ADD, square(x), square(y))
        if code in (op.TAN, op.ATAN):
            return r.binary(op.ADD, 1.0, square(f if code == op.TAN else x))
        if code == op.ERF:
            gauss = r.elementary("exp", (r.unary(op.NEG, square(x)),))
            return r.binary(op.MUL, 2.0 / sqrt(pi), gauss)
        rest = r.binary(op.SUB, 1.0, square(f if code == op.TANH else x))
        return rest if code == op.TANH else r.elementary("sqrt", (rest,))

    def _times(self, factor: Any, w: list[Any]) -> list[Any]:
        r = self.r
        if isinstance(factor, float) and factor == -1.0:
            return [-one if isinstance(one, float) else r.unary(op.NEG, one) for one in w]
        return [0.0 if _is_zero(one) else r.binary(op.MUL, factor, one) for one in w]

    def _over(self, w: list[Any], divisor: Any) -> list[Any]:
        return [0.0 if _is_zero(one) else self.r.binary(op.DIV, one, divisor) for one in w]

    def _sum(self, code: int, u: list[Any], v: list[Any]) -> list[Any]:
        return [self.r.binary(code, one, other) for one, other in zip(u, v, strict=True)]


def _is_zero(value: Any) -> bool:
    return isinstance(value, float) and value == 0.0
