"""Elementary functions of W lanes at once, in LLVM code: values and second values as in `operations.py`.

An argument is reduced to a short interval, where a polynomial is as good as the function; the polynomials were
interpolated at Chebyshev points in 60 digits. Errors stay below three units in the last place (tests). Where an
argument is out of the ordinary, such as an angle above 1e9 or a logarithm of zero, its lane takes the C library's
value.
"""

import math
from collections.abc import Sequence
from typing import Any

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.machine_code import INT, Writer

_LARGEST_ANGLE = 1e9


def operate(w: Writer, code: int, a: Any, b: Any) -> tuple[Any, Any]:
    """The value of an operation that is no arithmetic, and what stands beside it (None where nothing does)."""
    one = w.number(1.0)
    if code == op.SQRT:
        return w.root(a), None
    if code == op.EXP:
        return exp(w, a), None
    if code == op.LOG:
        return log(w, a), None
    if code == op.POWER:
        return w.each("pow", a, b), None
    if code == op.SINCOS:
        return sin_cos(w, a)
    if code == op.SINHCOSH:
        return sinh_cosh(w, a)
    if code == op.TAN:
        sine, cosine = sin_cos(w, a)
        t = w.b.fdiv(sine, cosine)
        return t, w.fma(t, t, one)
    if code == op.TANH:
        t = tanh(w, a)
        return t, w.fma(w.b.fneg(t), t, one)
    if code == op.ATAN:
        return atan2(w, a, one), w.fma(a, a, one)
    if code in (op.ASIN, op.ACOS):
        side = w.root(w.b.fmul(w.b.fsub(one, a), w.b.fadd(one, a)))
        return (atan2(w, a, side) if code == op.ASIN else atan2(w, side, a)), side
    if code == op.ERF:
        gauss = exp(w, w.b.fneg(w.b.fmul(a, a)))
        return w.each("erf", a), w.b.fmul(w.number(2.0 / math.sqrt(math.pi)), gauss)
    if code == op.ATAN2:
        return atan2(w, a, b), w.fma(a, a, w.b.fmul(b, b))
    raise NotImplementedError(f"opcode {code}")


def sin_cos(w: Writer, x: Any) -> tuple[Any, Any]:
    """sin x, cos x: x less a whole number of quarter turns, pi / 2 being taken in three parts."""
    b = w.b
    n = w.nearest(b.fmul(x, w.number(2.0 / math.pi)))
    minus = b.fneg(n)
    r = x
    for part in _HALF_PI:
        r = w.fma(minus, w.number(part), r)
    z = b.fmul(r, r)
    sine = w.fma(b.fmul(r, z), _horner(w, z, _SIN), r)
    # 1 - z/2 + rest, with what its first rounding loses
    half = b.fmul(z, w.number(0.5))
    first = b.fsub(w.number(1.0), half)
    rest = w.fma(b.fmul(z, z), _horner(w, z, _COS), b.fsub(b.fsub(w.number(1.0), first), half))
    cosine = b.fadd(first, rest)
    quarter = b.fptosi(n, w.bits)
    odd = b.icmp_signed("!=", b.and_(quarter, w.whole(1)), w.whole(0))
    found = []
    for one, other, turn in ((sine, cosine, quarter), (cosine, sine, b.add(quarter, w.whole(1)))):
        sign = b.shl(b.and_(turn, w.whole(2)), w.whole(62))
        value = b.bitcast(b.select(odd, other, one), w.bits)
        found.append(b.bitcast(b.xor(value, sign), w.vector))
    rare = b.fcmp_unordered(">", w.absolute(x), w.number(_LARGEST_ANGLE))
    return _or_library(w, rare, found, ("sin", "cos"), (x,))


def exp(w: Writer, x: Any) -> Any:
    """e^x = 2^n e^r with |r| <= log(2) / 2."""
    b = w.b
    bounded = w.smaller(w.larger(x, w.number(-760.0)), w.number(720.0))
    n = w.nearest(b.fmul(bounded, w.number(1.0 / math.log(2.0))))
    minus = b.fneg(n)
    r = bounded
    for part in _LOG_2:
        r = w.fma(minus, w.number(part), r)
    value = b.fadd(w.number(1.0), w.fma(b.fmul(r, r), _horner(w, r, _EXP), r))
    # in two factors, since 2^n may be no normal number where the result is one
    whole = b.fptosi(n, w.bits)
    half = b.ashr(whole, w.whole(1))
    value = b.fmul(b.fmul(value, _power_of_two(w, half)), _power_of_two(w, b.sub(whole, half)))
    return b.select(b.fcmp_unordered("uno", x, x), x, value)


def log(w: Writer, x: Any) -> Any:
    """log x = e log 2 + log(1 + f), sqrt(1/2) < 1 + f < sqrt 2, by the series of atanh at f / (2 + f)."""
    b = w.b
    bits = b.bitcast(x, w.bits)
    # the exponent counted from sqrt(1/2)
    shifted = b.add(bits, w.whole((1023 << 52) - _SQRT_HALF_BITS))
    e = b.sub(b.lshr(shifted, w.whole(52)), w.whole(1023))
    mantissa = b.bitcast(b.sub(bits, b.shl(e, w.whole(52))), w.vector)
    f = b.fsub(mantissa, w.number(1.0))
    s = b.fdiv(f, b.fadd(w.number(2.0), f))
    z = b.fmul(s, s)
    half = b.fmul(b.fmul(w.number(0.5), f), f)
    # log(1 + f) = f - (half - s (half + R))
    rest = b.fmul(s, w.fma(z, _horner(w, z, _LOG), half))
    e = b.sitofp(e, w.vector)
    rest = w.fma(e, w.number(_LOG_2[1]), rest)
    value = w.fma(e, w.number(_LOG_2[0]), b.fsub(f, b.fsub(half, rest)))
    fine = b.and_(b.fcmp_ordered(">=", x, w.number(2.0**-1022)), b.fcmp_ordered("<", x, w.number(math.inf)))
    return _or_library(w, b.not_(fine), [value], ("log",), (x,))[0]


def atan2(w: Writer, y: Any, x: Any) -> Any:
    """The angle of (x, y): K pi / 4 plus or minus atan t, |t| < tan(pi / 8), by one division."""
    b = w.b
    high, wide = w.absolute(y), w.absolute(x)
    steep = b.fcmp_ordered(">", high, wide)
    longer, shorter = b.select(steep, high, wide), b.select(steep, wide, high)
    middle = b.fcmp_ordered(">", shorter, b.fmul(longer, w.number(math.sqrt(2.0) - 1.0)))
    top = b.select(middle, b.fsub(shorter, longer), shorter)
    t = b.fdiv(top, b.select(middle, b.fadd(shorter, longer), longer))
    z = b.fmul(t, t)
    angle = w.fma(b.fmul(t, z), _horner(w, z, _ATAN), t)
    eighths = b.select(middle, w.number(1.0), w.number(0.0))
    angle = b.select(steep, b.fneg(angle), angle)
    eighths = b.select(steep, b.fsub(w.number(2.0), eighths), eighths)
    left = b.icmp_signed("<", b.bitcast(x, w.bits), w.whole(0))
    angle = b.select(left, b.fneg(angle), angle)
    eighths = b.select(left, b.fsub(w.number(4.0), eighths), eighths)
    # K pi / 4 in two parts
    first = b.fmul(eighths, w.number(_QUARTER_PI[0]))
    rest = w.fma(eighths, w.number(_QUARTER_PI[1]), w.fma(eighths, w.number(_QUARTER_PI[0]), b.fneg(first)))
    angle = b.fadd(first, b.fadd(angle, rest))
    sign = b.and_(b.bitcast(y, w.bits), w.whole(-(1 << 63)))
    angle = b.bitcast(b.or_(b.bitcast(angle, w.bits), sign), w.vector)
    fine = b.and_(
        b.fcmp_ordered(">", longer, w.number(2.0**-1000)), b.fcmp_ordered("<", longer, w.number(2.0**1000))
    )
    rare = b.or_(b.not_(fine), b.fcmp_unordered("uno", y, x))
    return _or_library(w, rare, [angle], ("atan2",), (y, x))[0]


def tanh(w: Writer, x: Any) -> Any:
    """tanh x: a polynomial near zero, else 1 - 2 / (e^(2 |x|) + 1)."""
    b = w.b
    size = w.absolute(x)
    z = b.fmul(x, x)
    near = w.fma(b.fmul(x, z), _horner(w, z, _TANH), x)
    power = exp(w, b.fadd(size, size))
    far = b.fsub(w.number(1.0), b.fdiv(w.number(2.0), b.fadd(power, w.number(1.0))))
    return b.select(b.fcmp_ordered("<", size, w.number(0.55)), near, _with_sign_of(w, far, x))


def sinh_cosh(w: Writer, x: Any) -> tuple[Any, Any]:
    """sinh x, cosh x, from e^|x|; sinh by a polynomial near zero."""
    b = w.b
    size = w.absolute(x)
    z = b.fmul(x, x)
    near = w.fma(b.fmul(x, z), _horner(w, z, _SINH), x)
    power = b.fmul(w.number(0.5), exp(w, size))
    inverse = b.fdiv(w.number(0.25), power)
    far = _with_sign_of(w, b.fsub(power, inverse), x)
    found = [b.select(b.fcmp_ordered("<", size, w.number(1.0)), near, far), b.fadd(power, inverse)]
    rare = b.fcmp_unordered(">", size, w.number(700.0))
    return _or_library(w, rare, found, ("sinh", "cosh"), (x,))


def rough_log2(w: Writer, a: Any) -> Any:
    """log2 of positive normal numbers, to 1.2e-4."""
    bits = w.b.bitcast(a, w.bits)
    exponent = w.b.sub(w.b.lshr(bits, w.whole(52)), w.whole(1023))
    mantissa = w.b.or_(w.b.and_(bits, w.whole((1 << 52) - 1)), w.whole(1023 << 52))
    return w.b.fadd(w.b.sitofp(exponent, w.vector), _horner(w, w.b.bitcast(mantissa, w.vector), _ROUGH_LOG2))


def rough_exp2(w: Writer, a: Any) -> Any:
    """2^a for |a| <= 1000, to 1e-7."""
    n = w.nearest(w.smaller(w.larger(a, w.number(-1000.0)), w.number(1000.0)))
    power = _horner(w, w.b.fsub(a, n), _ROUGH_EXP2)
    return w.b.fmul(power, _power_of_two(w, w.b.fptosi(n, w.bits)))


def _power_of_two(w: Writer, n: Any) -> Any:
    """2^n for whole numbers n, -1022 <= n <= 1023."""
    return w.b.bitcast(w.b.shl(w.b.add(n, w.whole(1023)), w.whole(52)), w.vector)


def _with_sign_of(w: Writer, value: Any, x: Any) -> Any:
    sign = w.b.and_(w.b.bitcast(x, w.bits), w.whole(-(1 << 63)))
    return w.b.bitcast(w.b.or_(w.b.bitcast(value, w.bits), sign), w.vector)


def _horner(w: Writer, x: Any, coefficients: tuple[float, ...]) -> Any:
    total = w.number(coefficients[-1])
    for c in reversed(coefficients[:-1]):
        total = w.fma(total, x, w.number(c))
    return total


def _or_library(
    w: Writer, rare: Any, values: list[Any], names: Sequence[str], arguments: Sequence[Any]
) -> tuple[Any, ...]:
    """Values where a lane is as usual, those of the C library where it is rare."""
    b = w.b
    slowly, after = b.append_basic_block("slowly"), b.append_basic_block("usual")
    before = b.block
    b.cbranch(b.icmp_signed("!=", w.mask(rare), INT(0)), slowly, after)
    b.position_at_end(slowly)
    slow = [
        b.select(rare, w.each(name, *arguments), value) for name, value in zip(names, values, strict=True)
    ]
    b.branch(after)
    b.position_at_end(after)
    found = []
    for value, other in zip(values, slow, strict=True):
        phi = b.phi(w.vector)
        phi.add_incoming(value, before)
        phi.add_incoming(other, slowly)
        found.append(phi)
    return tuple(found)


_HALF_PI = (1.5707963267948966, 6.123233995736766e-17, -1.4973849048591698e-33)
_QUARTER_PI = (0.7853981633974483, 3.061616997868383e-17)
_LOG_2 = (0.6931471805599453, 2.3190468138462996e-17)
_SQRT_HALF_BITS = 0x3FE6A09E667F3BCD
# (sin x / x - 1) / x^2 and (cos x - 1 + x^2 / 2) / x^4 in powers of x^2, |x| < pi / 4
_SIN = (
    -0.16666666666666666, 0.008333333333333331, -0.00019841269841265017, 2.755731921930192e-06,
    -2.5052106219521895e-08, 1.6058529572267877e-10, -7.586576588171073e-13,
)  # fmt: skip
_COS = (
    0.041666666666666664, -0.0013888888888888887, 2.4801587301584618e-05, -2.7557319221382114e-07,
    2.087675578389404e-09, -1.1470459749675607e-11, 4.745804889760674e-14,
)  # fmt: skip
# (e^x - 1 - x) / x^2, |x| < log(2) / 2
_EXP = (
    0.5, 0.16666666666666666, 0.04166666666666668, 0.008333333333333333, 0.0013888888888879004,
    0.00019841269841263252, 2.480158733663095e-05, 2.7557319247344507e-06, 2.755726307730941e-07,
    2.5052070959803662e-08, 2.091821231913398e-09, 1.6086677666787362e-10,
)  # fmt: skip
# (log((1 + s) / (1 - s)) / s - 2) / s^2 in powers of s^2, |s| < 3 - 2 sqrt 2
_LOG = (
    0.6666666666666666, 0.4000000000000094, 0.2857142857076445, 0.2222222240054776, 0.181817947008978,
    0.15386290534658992, 0.13267418596474884, 0.1310072138350349,
)  # fmt: skip
# (atan x / x - 1) / x^2 in powers of x^2, |x| < tan(pi / 8)
_ATAN = (
    -0.3333333333333333, 0.199999999999998, -0.14285714285658824, 0.1111111110505757, -0.09090908748635232,
    0.07692296234491514, -0.06666422364033206, 0.05878900032342983, -0.052302411507894, 0.045506220391755364,
    -0.034545610104858494, 0.016258132064979208,
)  # fmt: skip
# (tanh x / x - 1) / x^2 in powers of x^2, |x| < 0.55; (sinh x / x - 1) / x^2, |x| < 1
_TANH = (
    -0.3333333333333333, 0.13333333333332714, -0.053968253967434016, 0.021869488493666944, -0.008863234397814355,
    0.003592110378689024, -0.001455661830100716, 0.0005889360520074057, -0.0002346347410887237,
    8.511313685577672e-05, -2.060276537636634e-05,
)  # fmt: skip
_SINH = (
    0.16666666666666666, 0.008333333333333333, 0.00019841269841269773, 2.755731922404034e-06, 2.505210836405804e-08,
    1.6059048396350562e-10, 7.646625361656657e-13, 2.8445264169895285e-15,
)  # fmt: skip
# log2 on [1, 2], 2^x on [-1/2, 1/2]
_ROUGH_LOG2 = (
    -2.4983531488141586,
    4.029211391071475,
    -2.0783351682517304,
    0.6260321821639458,
    -0.07844067620915011,
)
_ROUGH_EXP2 = (
    1.0000000754548972, 0.6931471880262273, 0.2402210748530968, 0.05550357114222094, 0.009676031918255982,
    0.001339086336353527,
)  # fmt: skip
