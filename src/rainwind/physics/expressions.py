"""Formulas in alpha given as text: parsed, never run as Python."""

import ast
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import pi
from typing import Any

from rainwind import elementary
from rainwind.errors import InputError

_ONE = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "erf")
_FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    **{name: (getattr(elementary, name), 1) for name in _ONE},
    "atan2": (elementary.atan2, 2),
}
_LONGEST = 1000
_LARGEST_POWER = 30

Formula = Callable[[Any], Any]


@dataclass(frozen=True)
class Expression:
    """A coefficient as a formula, e.g. "0.3*sin(2*alpha) + 0.1"; alpha in rad.

    Allowed: numbers, alpha, pi, + - * /, ** with a whole number, brackets and the functions of
    `rainwind.elementary`. Raises InputError for anything else.
    """

    text: str

    def __post_init__(self) -> None:
        if not isinstance(self.text, str):
            raise InputError(f"an expression must be text in alpha, not {self.text!r}")
        _formula(self.text)

    def __call__(self, alpha: Any) -> Any:
        """The value at alpha (rad): a number, array, tape symbol or interval."""
        return _formula(self.text)(alpha)


@lru_cache(maxsize=256)
def _formula(text: str) -> Formula:
    if len(text) > _LONGEST:
        raise InputError(f"the expression has {len(text)} characters; at most {_LONGEST} are allowed")
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError(
            f"the expression {text!r} is not a formula; write e.g. '0.3*sin(2*alpha) + 0.1'"
        ) from None
    return _node(tree.body, text)


def _node(node: ast.expr, text: str) -> Formula:
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            try:
                number = float(value)
            except OverflowError:
                raise _refused(node, text, "the number is too large") from None
            return lambda alpha: number
        case ast.Name(id="alpha"):
            return lambda alpha: alpha
        case ast.Name(id="pi"):
            return lambda alpha: pi
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            inner = _node(operand, text)
            return lambda alpha: -inner(alpha)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _node(operand, text)
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return _power(_node(left, text), _exponent(right, text))
        case ast.BinOp(left=left, op=operator, right=right):
            return _binary(_node(left, text), operator, _node(right, text), node, text)
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in _FUNCTIONS:
            function, wanted = _FUNCTIONS[name]
            if len(arguments) != wanted:
                raise _refused(node, text, f"{name} takes {wanted} argument{'s' * (wanted > 1)}")
            inners = [_node(argument, text) for argument in arguments]
            return lambda alpha: function(*(inner(alpha) for inner in inners))
    raise _refused(node, text, "this is not allowed")


def _binary(left: Formula, operator: ast.operator, right: Formula, node: ast.expr, text: str) -> Formula:
    match operator:
        case ast.Add():
            return lambda alpha: left(alpha) + right(alpha)
        case ast.Sub():
            return lambda alpha: left(alpha) - right(alpha)
        case ast.Mult():
            return lambda alpha: left(alpha) * right(alpha)
        case ast.Div():
            return lambda alpha: left(alpha) / right(alpha)
    raise _refused(node, text, "this operator is not allowed")


def _exponent(node: ast.expr, text: str) -> int:
    match node:
        case ast.Constant(value=int() as value) if (
            not isinstance(value, bool) and 0 <= value <= _LARGEST_POWER
        ):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_exponent(operand, text)
    raise _refused(node, text, f"a power must be a whole number up to {_LARGEST_POWER}")


def _power(base: Formula, exponent: int) -> Formula:
    def power(alpha: Any) -> Any:
        # repeated products only: intervals and tape symbols need not offer powers
        square, rest, result = base(alpha), abs(exponent), None
        while rest:
            if rest & 1:
                result = square if result is None else result * square
            rest >>= 1
            if rest:
                square = square * square
        if result is None:
            return 1.0
        return 1.0 / result if exponent < 0 else result

    return power


def _refused(node: ast.expr, text: str, why: str) -> InputError:
    part = ast.get_source_segment(text.strip(), node) or type(node).__name__
    return InputError(
        f"the expression {text!r} cannot be used: {why}: {part!r}; allowed are numbers, alpha, pi, + - * /, "
        f"** with a whole number, and {', '.join(_FUNCTIONS)}"
    )
