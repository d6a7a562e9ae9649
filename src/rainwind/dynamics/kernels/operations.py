"""What one operation of a tape does: its value and its first and second partial derivatives."""

import math

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.compiling import inlined

_TWO_OVER_SQRT_PI = 2.0 / math.sqrt(math.pi)


@inlined
def operate(code, a, b):
    """The value of an operation and, where it fills two slots, the second value (else 0)."""
    if code == op.ADD:
        return a + b, 0.0
    if code == op.MUL:
        return a * b, 0.0
    if code == op.SUB:
        return a - b, 0.0
    if code == op.DIV:
        return a / b, 0.0
    if code == op.NEG:
        return -a, 0.0
    if code == op.SINCOS:
        return math.sin(a), math.cos(a)
    if code == op.ATAN2:
        return math.atan2(a, b), a * a + b * b
    if code == op.TANH:
        t = math.tanh(a)
        return t, 1.0 - t * t
    if code == op.EXP:
        return math.exp(a), 0.0
    if code == op.SQRT:
        return math.sqrt(a), 0.0
    if code == op.LOG:
        return math.log(a), 0.0
    if code == op.POWER:
        return a**b, 0.0
    if code == op.ATAN:
        return math.atan(a), 1.0 + a * a
    if code == op.TAN:
        t = math.tan(a)
        return t, 1.0 + t * t
    if code == op.SINHCOSH:
        return math.sinh(a), math.cosh(a)
    if code == op.ASIN:
        return math.asin(a), math.sqrt(1.0 - a * a)
    if code == op.ACOS:
        return math.acos(a), math.sqrt(1.0 - a * a)
    return math.erf(a), _TWO_OVER_SQRT_PI * math.exp(-a * a)


@inlined
def partials(code, a, b, z, second):
    """First partials f_a, f_b and the first derivative g_a of the second slot."""
    if code == op.ADD:
        return 1.0, 1.0, 0.0
    if code == op.MUL:
        return b, a, 0.0
    if code == op.SUB:
        return 1.0, -1.0, 0.0
    if code == op.DIV:
        return 1.0 / b, -z / b, 0.0
    if code == op.NEG:
        return -1.0, 0.0, 0.0
    if code == op.SINCOS:
        return second, 0.0, -z
    if code == op.ATAN2:
        return b / second, -a / second, 0.0
    if code == op.EXP:
        return z, 0.0, 0.0
    if code == op.SQRT:
        return 0.5 / z, 0.0, 0.0
    if code == op.LOG:
        return 1.0 / a, 0.0, 0.0
    if code == op.POWER:
        return b * a ** (b - 1.0), 0.0, 0.0
    if code == op.SINHCOSH:
        return second, 0.0, z
    if code in (op.ATAN, op.ASIN):
        return 1.0 / second, 0.0, 0.0
    if code == op.ACOS:
        return -1.0 / second, 0.0, 0.0
    return second, 0.0, 0.0  # tan, tanh, erf


@inlined
def second_partials(code, a, b, z, second):
    """Second partials f_aa, f_ab, f_bb and the second derivative g_aa of the second slot."""
    if code == op.MUL:
        return 0.0, 1.0, 0.0, 0.0
    if code in (op.ADD, op.SUB, op.NEG):
        return 0.0, 0.0, 0.0, 0.0
    if code == op.DIV:
        return 0.0, -1.0 / (b * b), 2.0 * z / (b * b), 0.0
    if code == op.SINCOS:
        return -z, 0.0, 0.0, -second
    if code == op.ATAN2:
        mixed = 2.0 * a * b / (second * second)
        return -mixed, (a * a - b * b) / (second * second), mixed, 0.0
    if code == op.EXP:
        return z, 0.0, 0.0, 0.0
    if code == op.SQRT:
        return -0.25 / (z * a), 0.0, 0.0, 0.0
    if code == op.LOG:
        return -1.0 / (a * a), 0.0, 0.0, 0.0
    if code == op.POWER:
        return b * (b - 1.0) * a ** (b - 2.0), 0.0, 0.0, 0.0
    if code == op.SINHCOSH:
        return z, 0.0, 0.0, second
    if code == op.TAN:
        return 2.0 * z * second, 0.0, 0.0, 0.0
    if code == op.TANH:
        return -2.0 * z * second, 0.0, 0.0, 0.0
    if code == op.ATAN:
        return -2.0 * a / (second * second), 0.0, 0.0, 0.0
    if code == op.ASIN:
        return a / second**3, 0.0, 0.0, 0.0
    if code == op.ACOS:
        return -a / second**3, 0.0, 0.0, 0.0
    return -2.0 * a * second, 0.0, 0.0, 0.0  # erf
