"""Elementary functions that take numbers, arrays, tape symbols and intervals alike.

A type of its own kind (a tape symbol, an interval) takes part by offering
`_elementary_(name, *others)`, which returns the value of the function `name` at itself and `others`.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.special import erf as _erf

__all__ = [
    "acos", "asin", "atan", "atan2", "cos", "cosh", "erf", "exp", "log",
    "sin", "sinh", "sqrt", "tan", "tanh", "wrap_angle",
]  # fmt: skip


def _of_one(name: str, numeric: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def function(x: Any) -> Any:
        special = getattr(x, "_elementary_", None)
        return numeric(x) if special is None else special(name)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = f"{name}(x) of a number, an array, a tape symbol or an interval (radians)."
    return function


sin = _of_one("sin", np.sin)
cos = _of_one("cos", np.cos)
tan = _of_one("tan", np.tan)
asin = _of_one("asin", np.arcsin)
acos = _of_one("acos", np.arccos)
atan = _of_one("atan", np.arctan)
sinh = _of_one("sinh", np.sinh)
cosh = _of_one("cosh", np.cosh)
tanh = _of_one("tanh", np.tanh)
exp = _of_one("exp", np.exp)
log = _of_one("log", np.log)
sqrt = _of_one("sqrt", np.sqrt)
erf = _of_one("erf", _erf)


def atan2(y: Any, x: Any) -> Any:
    """The angle of the point (x, y) in (-pi, pi], of numbers, arrays or tape symbols."""
    for first in (y, x):
        special = getattr(first, "_elementary_", None)
        if special is not None:
            return special("atan2", y, x)
    return np.arctan2(y, x)


def wrap_angle(x: Any) -> Any:
    """The angle x brought into (-pi, pi]; smooth but for the cut."""
    special = getattr(x, "_wrap_angle_", None)
    return atan2(sin(x), cos(x)) if special is None else special()
