"""A plain Python right-hand side, called once with symbols, becomes a tape of elementary operations.

A tape is data: three arrays that the kernels in `dynamics/kernels/` interpret. Its slots hold, in this order,
the inputs (states, then parameters), the constants, and the results of the operations. Some operations fill
two slots, because the derivatives of the first need the second (sin and cos, tan and 1 + tan^2, ...).
"""

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from types import FrameType, TracebackType
from typing import Any, NoReturn

import numpy as np

from rainwind.dynamics.kernels import opcodes as op
from rainwind.errors import RainwindError, TraceError

# frames that are never the line to show: where a symbol is recorded, not where the user wrote it
_NOT_THE_USERS = ("rainwind.dynamics.tape", "rainwind.elementary", "numpy", "scipy")
_LARGEST_WHOLE_POWER = 1024


@dataclass(frozen=True, eq=False)
class Tape:
    """The operations of a right-hand side, in order.

    operations: (m, 4) int64, each row an opcode, the slot it fills, the slots of its arguments;
    template: (slots,) float64, zero but for the constants; outputs: (n,) int64, the slots of the derivatives.
    """

    states: tuple[str, ...]
    parameters: tuple[str, ...]
    operations: np.ndarray
    template: np.ndarray
    outputs: np.ndarray

    @property
    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What the kernels take: operations, template, outputs."""
        return self.operations, self.template, self.outputs


class Symbol:
    """A value on the tape: what a right-hand side sees instead of a number."""

    __slots__ = ("_recorder", "_slot")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, recorder: "_Recorder", slot: Any) -> None:
        self._recorder = recorder
        self._slot = slot

    def __add__(self, other: Any) -> Any:
        return self._recorder.binary(op.ADD, self, other)

    def __radd__(self, other: Any) -> Any:
        return self._recorder.binary(op.ADD, other, self)

    def __sub__(self, other: Any) -> Any:
        return self._recorder.binary(op.SUB, self, other)

    def __rsub__(self, other: Any) -> Any:
        return self._recorder.binary(op.SUB, other, self)

    def __mul__(self, other: Any) -> Any:
        return self._recorder.binary(op.MUL, self, other)

    def __rmul__(self, other: Any) -> Any:
        return self._recorder.binary(op.MUL, other, self)

    def __truediv__(self, other: Any) -> Any:
        return self._recorder.binary(op.DIV, self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._recorder.binary(op.DIV, other, self)

    def __pow__(self, exponent: Any) -> Any:
        return self._recorder.power(self, exponent)

    def __rpow__(self, base: Any) -> Any:
        return self._recorder.power(base, self)

    def __neg__(self) -> Any:
        return self._recorder.unary(op.NEG, self)

    def __pos__(self) -> Any:
        return self

    def _elementary_(self, name: str, *arguments: Any) -> Any:
        return self._recorder.elementary(name, arguments or (self,))

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Let `np.sin(x)`, `2.0 * x` with NumPy numbers and the like record too."""
        name = ufunc.__name__
        if method != "__call__" or options or any(isinstance(i, np.ndarray) and i.ndim for i in inputs):
            _refuse(f"np.{name} with arrays or options cannot be recorded; write it with scalars")
        if name in _UFUNC_BRANCHES:
            self._branch()
        if name in _UFUNC_OPERATORS:
            return _UFUNC_OPERATORS[name](self._recorder, *inputs)
        return self._recorder.elementary(_UFUNC_NAMES.get(name, name), inputs)

    def _branch(self, *_: Any) -> NoReturn:
        _refuse(
            "a branch or comparison on a traced value: the tape records one path only; "
            "use a smooth function (for example rw.tanh) instead of if, max, abs or =="
        )

    __bool__ = __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = __abs__ = _branch  # type: ignore[assignment]
    __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = __round__ = __floor__ = __ceil__ = _branch

    def _number(self) -> NoReturn:
        _refuse(
            "a traced value is used as a plain number; use rw.sin, rw.exp, ... instead of math.sin, math.exp"
        )

    __float__ = __int__ = __index__ = __complex__ = _number  # type: ignore[assignment]

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("_"):  # optional protocols that callers ask for with getattr(..., None)
            raise AttributeError(name)
        _refuse(f"a traced value is a scalar and has no attribute '{name}'")

    def __repr__(self) -> str:
        return f"Symbol({self._slot})"


class Named:
    """Values that go by name: `x.phi`, `p["wind.speed"]`, `x[1]`, `y, phi = x`."""

    # mangled, and no base class with methods such as `index`: any word may name a state
    __slots__ = ("__kind", "__names", "__values")

    def __init__(self, names: tuple[str, ...], values: Sequence[Any], kind: str) -> None:
        self.__names, self.__values, self.__kind = names, values, kind

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            if key not in self.__names:
                names = ", ".join(self.__names) or "not given"
                _refuse(f"{self.__kind}s are {names}; there is no '{key}'")
            return self.__values[self.__names.index(key)]
        return self.__values[key]

    def __getattr__(self, name: str) -> Any:
        if name.startswith(("__", "_Named__")):
            raise AttributeError(name)
        return self[name]

    def __len__(self) -> int:
        return len(self.__values)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.__values)


@dataclass
class _Recorder:
    """Collects operations while a right-hand side runs; equal operations are recorded once."""

    inputs: int
    rows: list[tuple[int, Any, Any]] = field(default_factory=list)
    known: dict[tuple, int] = field(default_factory=dict)

    def key(self, value: Any, where: str | None = None) -> Any:
        """What stands for a symbol or constant in a row: ("in", i), ("op", row, which) or a float."""
        if isinstance(value, Symbol):
            if value._recorder is not self:
                _refuse("a traced value of another right-hand side was kept and used again", where)
            return value._slot
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return self.key(value.item(), where)
        try:
            if isinstance(value, str | bytes | np.ndarray):
                raise TypeError
            number = float(value)
        except OverflowError:
            number = math.inf
        except (TypeError, ValueError):
            _refuse(f"{type(value).__name__} {value!r} cannot be recorded; a number is needed", where)
        if not math.isfinite(number):
            _refuse(f"the constant {number} is not finite", where)
        return number

    def record(self, code: int, a: Any, b: Any = 0.0, *, second: bool = False) -> Symbol:
        if code in (op.ADD, op.MUL) and _order(b) < _order(a):
            a, b = b, a
        key = (code, _order(a), _order(b))
        row = self.known.get(key)
        if row is None:
            row = self.known[key] = len(self.rows)
            self.rows.append((code, a, b))
        return Symbol(self, ("op", row, int(second)))

    def binary(self, code: int, left: Any, right: Any) -> Any:
        a, b = self.key(left), self.key(right)
        if isinstance(a, float) and isinstance(b, float):
            return self.constant(_NUMERIC[code], a, b)
        if code == op.ADD and 0.0 in (a, b):
            return left if b == 0.0 else right
        if code == op.SUB and b == 0.0:
            return left
        if code == op.SUB and a == 0.0:
            return self.unary(op.NEG, right)
        if code == op.MUL and 1.0 in (a, b):
            return left if b == 1.0 else right
        if code == op.MUL and 0.0 in (a, b):
            return 0.0
        if code == op.DIV and b == 0.0:
            _refuse("division by the constant zero")
        if code == op.DIV and b == 1.0:
            return left
        if code == op.DIV and a == 0.0:
            return 0.0
        return self.record(code, a, b)

    def unary(self, code: int, value: Any) -> Any:
        a = self.key(value)
        return -a if isinstance(a, float) else self.record(code, a)

    def power(self, base: Any, exponent: Any) -> Any:
        e = self.key(exponent)
        if isinstance(e, float) and e.is_integer() and abs(e) <= _LARGEST_WHOLE_POWER:
            return self.whole_power(base, int(e))
        b = self.key(base)
        if isinstance(e, float):
            if isinstance(b, float):
                return self.constant(math.pow, b, e)
            return self.record(op.SQRT, b) if e == 0.5 else self.record(op.POWER, b, e)
        if isinstance(b, float):
            if b <= 0.0:
                _refuse(f"{b} to a traced power: the base must be positive")
            return self.elementary("exp", (math.log(b) * exponent,))
        return self.elementary("exp", (exponent * self.elementary("log", (base,)),))

    def whole_power(self, base: Any, exponent: int) -> Any:
        """By repeated squaring, so that a base of zero or below is as good as any other."""
        if exponent == 0:
            return 1.0
        if exponent < 0:
            return 1.0 / self.whole_power(base, -exponent)
        half = self.whole_power(base, exponent // 2) if exponent > 1 else 1.0
        return (half * half) * base if exponent % 2 else half * half

    def elementary(self, name: str, arguments: Sequence[Any]) -> Any:
        if name not in _FUNCTIONS:
            _refuse(f"the function '{name}' cannot be recorded; known: {', '.join(sorted(_FUNCTIONS))}")
        code, second, count = _FUNCTIONS[name]
        if len(arguments) != count:
            _refuse(f"'{name}' takes {count} argument{'s' * (count > 1)}, {len(arguments)} given")
        slots = [self.key(argument) for argument in arguments]
        if all(isinstance(slot, float) for slot in slots):
            return self.constant(getattr(math, name), *slots)
        return self.record(code, *slots, second=second)

    def constant(self, function: Callable[..., float], *arguments: float) -> float:
        """A result that no symbol enters: computed now; it must be finite."""
        try:
            number = function(*arguments)
        except (ArithmeticError, ValueError):
            number = math.nan
        if not math.isfinite(number):
            name = getattr(function, "__name__", "operation")
            _refuse(f"{name}{arguments} gives a constant that is not finite")
        return number

    def finish(self, states: tuple[str, ...], parameters: tuple[str, ...], keys: Sequence[Any]) -> Tape:
        """Lay out the slots, leaving out what no output needs."""
        needed = self.needed_rows(keys)
        constants = dict.fromkeys(
            _order(k) for row in needed for k in self.rows[row][1:] if isinstance(k, float)
        )
        constants |= dict.fromkeys(_order(k) for k in keys if isinstance(k, float))
        slot_of: dict[Any, int] = {_order(("in", i)): i for i in range(self.inputs)}
        slot_of |= {constant: self.inputs + i for i, constant in enumerate(constants)}
        free = self.inputs + len(constants)
        operations = np.zeros((len(needed), 4), dtype=np.int64)
        for i, row in enumerate(needed):
            code, a, b = self.rows[row]
            operations[i] = code, free, slot_of[_order(a)], slot_of[_order(b if code in op.BINARY else a)]
            slot_of[_order(("op", row, 0))], slot_of[_order(("op", row, 1))] = free, free + 1
            free += 2 if code >= op.FIRST_WITH_TWO else 1
        template = np.zeros(free)
        template[self.inputs : self.inputs + len(constants)] = [number for _, number, _ in constants]
        slots = np.array([slot_of[_order(k)] for k in keys], dtype=np.int64)
        return Tape(states, parameters, operations, template, slots)

    def needed_rows(self, keys: Iterable[Any]) -> list[int]:
        stack = [key for key in keys if isinstance(key, tuple) and key[0] == "op"]
        needed: set[int] = set()
        while stack:
            row = stack.pop()[1]
            if row not in needed:
                needed.add(row)
                stack += [k for k in self.rows[row][1:] if isinstance(k, tuple) and k[0] == "op"]
        return sorted(needed)


def trace(
    rhs: Callable[..., Any], states: Sequence[str], parameters: Sequence[str] | Mapping[str, float]
) -> Tape:
    """Call `rhs(x, p)` once with symbols and return its tape.

    `rhs` returns one derivative for each state, in order, or a mapping from state names to them. Raises
    TraceError, naming the line of the right-hand side, for what cannot be recorded.
    """
    states, parameters = _names(states, "state"), _names(parameters, "parameter")

    def derivatives(x: Named, p: Named) -> tuple[Any, ...]:
        found = _derivatives(rhs(x, p), states)
        if len(found) != len(states):
            names = f"{len(states)} state{'s' * (len(states) != 1)} ({', '.join(states)})"
            _refuse(f"rhs returned {len(found)} derivatives for {names}", _definition(rhs))
        return found

    return _recorded(derivatives, states, parameters, "rhs", _definition(rhs))


def trace_function(
    function: Callable[..., Any],
    states: Sequence[str],
    parameters: Sequence[str] | Mapping[str, float],
    what: str,
) -> Tape:
    """The tape of one number that follows from states and parameters, `function(x, p)`; `what` names it in errors.

    Raises TraceError as `trace` does.
    """

    def one(x: Named, p: Named) -> tuple[Any, ...]:
        found = function(x, p)
        if not (isinstance(found, Symbol | Real) or (isinstance(found, np.ndarray) and found.ndim == 0)):
            raise ValueError(f"it returned {found!r}; one number is needed")
        return (found,)

    names = _names(states, "state"), _names(parameters, "parameter")
    return _recorded(one, *names, what, _definition(function))


def _recorded(
    function: Callable[[Named, Named], tuple[Any, ...]], states: tuple[str, ...], parameters: tuple[str, ...],
    what: str, where: str,
) -> Tape:  # fmt: skip
    recorder = _Recorder(len(states) + len(parameters))
    symbols = [Symbol(recorder, ("in", i)) for i in range(recorder.inputs)]
    x = Named(states, symbols[: len(states)], "state")
    p = Named(parameters, symbols[len(states) :], "parameter")
    try:
        # NumPy numbers then refuse 1/0 and overflow as Python's do
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            outputs = function(x, p)
    except RainwindError:
        raise
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        line = _line(_users_frame(error.__traceback__)) or where
        raise TraceError(f"{what} failed: {error}{line}") from error
    return recorder.finish(states, parameters, [recorder.key(o, where) for o in outputs])


def _names(given: Iterable[str], kind: str) -> tuple[str, ...]:
    if isinstance(given, str) or not all(isinstance(name, str) for name in given):
        raise TraceError(f"{kind}s = {given!r} must be a list of names")
    names = tuple(given)
    if len(set(names)) < len(names):
        raise TraceError(f"{kind}s = {', '.join(names)}: each name may come once")
    return names


def _derivatives(result: Any, states: tuple[str, ...]) -> tuple[Any, ...]:
    """What a right-hand side returned, as one item for each state; a generator runs here."""
    if isinstance(result, Mapping):
        if set(result) != set(states):
            given = ", ".join(map(str, result)) or "nothing"
            raise ValueError(f"rhs returned derivatives of {given}; they are needed of {', '.join(states)}")
        return tuple(result[name] for name in states)
    if isinstance(result, Symbol | Real) or (isinstance(result, np.ndarray) and result.ndim == 0):
        return (result,)
    if isinstance(result, str | bytes) or not isinstance(result, Iterable):
        raise ValueError(f"rhs returned {result!r}; derivatives of {', '.join(states)} are needed")
    return tuple(result)


def _order(key: Any) -> tuple:
    """A sortable, hashable form of a slot key."""
    return (0, key, math.copysign(1.0, key)) if isinstance(key, float) else (1, *key)


def _belongs_to_user(frame: FrameType) -> bool:
    module = frame.f_globals.get("__name__", "")
    return not any(module == name or module.startswith(name + ".") for name in _NOT_THE_USERS)


def _users_frame(traceback: TracebackType | None) -> tuple[int, str] | None:
    """Line and file of the innermost frame of an error that is the user's."""
    found = None
    while traceback is not None:
        if _belongs_to_user(traceback.tb_frame):
            found = traceback.tb_lineno, traceback.tb_frame.f_code.co_filename
        traceback = traceback.tb_next
    return found


def _line(place: tuple[int, str] | None) -> str:
    return "" if place is None else f" (line {place[0]} of {place[1]})"


def _where() -> str:
    """The line of the user's code that is being traced."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and not _belongs_to_user(frame):
        frame = frame.f_back
    return _line(None if frame is None else (frame.f_lineno, frame.f_code.co_filename))


def _definition(rhs: Any) -> str:
    """Where a right-hand side is defined, for what shows only after it has returned."""
    for function in (rhs, getattr(rhs, "func", None), rhs.__call__):
        code = getattr(function, "__code__", None)
        if code is not None:
            return _line((code.co_firstlineno, code.co_filename))
    return ""


def _refuse(message: str, where: str | None = None) -> NoReturn:
    raise TraceError(message + (_where() if where is None else where))


_NUMERIC = {
    op.ADD: lambda a, b: a + b,
    op.SUB: lambda a, b: a - b,
    op.MUL: lambda a, b: a * b,
    op.DIV: lambda a, b: a / b,
}
# name -> opcode, whether it is the operation's second slot, number of arguments
_FUNCTIONS = {
    "sin": (op.SINCOS, False, 1),
    "cos": (op.SINCOS, True, 1),
    "tan": (op.TAN, False, 1),
    "asin": (op.ASIN, False, 1),
    "acos": (op.ACOS, False, 1),
    "atan": (op.ATAN, False, 1),
    "atan2": (op.ATAN2, False, 2),
    "sinh": (op.SINHCOSH, False, 1),
    "cosh": (op.SINHCOSH, True, 1),
    "tanh": (op.TANH, False, 1),
    "exp": (op.EXP, False, 1),
    "log": (op.LOG, False, 1),
    "sqrt": (op.SQRT, False, 1),
    "erf": (op.ERF, False, 1),
}
_UFUNC_NAMES = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2"}
_UFUNC_BRANCHES = frozenset({
    "absolute", "equal", "fabs", "fmax", "fmin", "greater", "greater_equal", "less", "less_equal", "maximum",
    "minimum", "not_equal", "sign",
})  # fmt: skip
_UFUNC_OPERATORS = {
    "add": lambda r, a, b: r.binary(op.ADD, a, b),
    "subtract": lambda r, a, b: r.binary(op.SUB, a, b),
    "multiply": lambda r, a, b: r.binary(op.MUL, a, b),
    "divide": lambda r, a, b: r.binary(op.DIV, a, b),
    "negative": lambda r, a: r.unary(op.NEG, a),
    "power": lambda r, a, b: r.power(a, b),
    "float_power": lambda r, a, b: r.power(a, b),
    "square": lambda r, a: r.whole_power(a, 2),
}
