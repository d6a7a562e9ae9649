"""Elementary functions of W lanes at once, in LLVM code: values and second values as in `operations.py`."""

import math
from typing import Any

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.machine_code import Writer


def operate(w: Writer, code: int, a: Any, b: Any) -> tuple[Any, Any]:
    """The value of an operation that is no arithmetic, and what stands beside it (None where nothing does)."""
    if code == op.SQRT:
        return w.root(a), None
    if code == op.EXP:
        return w.each("exp", a), None
    if code == op.LOG:
        return w.each("log", a), None
    if code == op.POWER:
        return w.each("pow", a, b), None
    if code == op.SINCOS:
        return w.each("sin", a), w.each("cos", a)
    if code == op.SINHCOSH:
        return w.each("sinh", a), w.each("cosh", a)
    one = w.number(1.0)
    if code == op.TAN:
        t = w.each("tan", a)
        return t, w.fma(t, t, one)
    if code == op.TANH:
        t = w.each("tanh", a)
        return t, w.fma(w.b.fneg(t), t, one)
    if code == op.ATAN:
        return w.each("atan", a), w.fma(a, a, one)
    if code in (op.ASIN, op.ACOS):
        return w.each("asin" if code == op.ASIN else "acos", a), w.root(w.fma(w.b.fneg(a), a, one))
    if code == op.ERF:
        gauss = w.each("exp", w.b.fneg(w.b.fmul(a, a)))
        return w.each("erf", a), w.b.fmul(w.number(2.0 / math.sqrt(math.pi)), gauss)
    if code == op.ATAN2:
        return w.each("atan2", a, b), w.fma(a, a, w.b.fmul(b, b))
    raise NotImplementedError(f"opcode {code}")


def rough_log2(w: Writer, a: Any) -> Any:
    """log2 of positive normal numbers, to 1.2e-4 (interpolated at Chebyshev points)."""
    bits = w.b.bitcast(a, w.bits)
    exponent = w.b.sub(w.b.lshr(bits, w.whole(52)), w.whole(1023))
    mantissa = w.b.or_(w.b.and_(bits, w.whole((1 << 52) - 1)), w.whole(1023 << 52))
    return w.b.fadd(w.b.sitofp(exponent, w.vector), _horner(w, w.b.bitcast(mantissa, w.vector), _LOG2))


def rough_exp2(w: Writer, a: Any) -> Any:
    """2^a for |a| <= 1000, to 1e-7 (interpolated at Chebyshev points)."""
    whole = w.nearest(w.smaller(w.larger(a, w.number(-1000.0)), w.number(1000.0)))
    power = _horner(w, w.b.fsub(a, whole), _EXP2)
    shift = w.b.shl(w.b.add(w.b.fptosi(whole, w.bits), w.whole(1023)), w.whole(52))
    return w.b.fmul(power, w.b.bitcast(shift, w.vector))


def _horner(w: Writer, x: Any, coefficients: tuple[float, ...]) -> Any:
    total = w.number(coefficients[-1])
    for c in reversed(coefficients[:-1]):
        total = w.fma(total, x, w.number(c))
    return total


_LOG2 = (
    -2.4983531488141586,
    4.029211391071475,
    -2.0783351682517304,
    0.6260321821639458,
    -0.07844067620915011,
)
_EXP2 = (
    1.0000000754548972, 0.6931471880262273, 0.2402210748530968, 0.05550357114222094, 0.009676031918255982,
    0.001339086336353527,
)  # fmt: skip
