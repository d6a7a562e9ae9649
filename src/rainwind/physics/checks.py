"""Numbers and choices checked at the door."""

from collections.abc import Sequence
from math import isfinite
from numbers import Real
from typing import Any

from rainwind.errors import InputError


def finite_number(name: str, value: Any, hint: str = "") -> float:
    """The value as a float; InputError for text, bool, NaN and infinity."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InputError(f"{name} = {value!r} is not a number; give a finite number{_then(hint)}")
    if not isfinite(value):
        raise InputError(f"{name} = {value!r} is not finite; give a finite number{_then(hint)}")
    return float(value)


def positive(name: str, value: Any, hint: str = "") -> float:
    """The value as a float above zero; InputError otherwise."""
    number = finite_number(name, value, hint)
    if number <= 0:
        raise InputError(f"{name} = {number:g} is not allowed: it must be above 0{_then(hint)}")
    return number


def not_negative(name: str, value: Any, hint: str = "") -> float:
    """The value as a float of zero or more; InputError otherwise."""
    number = finite_number(name, value, hint)
    if number < 0:
        raise InputError(f"{name} = {number:g} is not allowed: it must be 0 or more{_then(hint)}")
    return number


def radians_between(name: str, value: Any, low: float, high: float) -> float:
    """The value as a float in [low, high]; the error says that it does not look like radians."""
    number = finite_number(name, value, "angles are in radians")
    if not low <= number <= high:
        raise InputError(
            f"{name} = {number:g} does not look like an angle in radians: allowed is {low:.6g} to "
            f"{high:.6g}; convert degrees with math.radians"
        )
    return number


def one_of(name: str, value: Any, allowed: Sequence[Any]) -> Any:
    """The value if it is one of those allowed; InputError otherwise."""
    if isinstance(value, bool) or value not in allowed:
        raise InputError(f"{name} = {value!r} is not known; choose one of {', '.join(map(repr, allowed))}")
    return value


def _then(hint: str) -> str:
    return f"; {hint}" if hint else ""
