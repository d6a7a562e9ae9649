"""The forms in which a coefficient may be given as a function of alpha: polynomial, table, expression."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from rainwind.errors import InputError
from rainwind.physics.checks import finite_number, positive
from rainwind.physics.expressions import Expression


@dataclass(frozen=True)
class Polynomial:
    """c0 + c1 alpha + c2 alpha² + ..., alpha in rad; any degree. Raises InputError."""

    coefficients: tuple[float, ...]

    def __post_init__(self) -> None:
        given = self.coefficients
        if isinstance(given, str) or not hasattr(given, "__iter__") or not len(given):
            raise InputError(f"a polynomial needs a list of numbers c0, c1, ..., not {given!r}")
        numbers = tuple(finite_number(f"polynomial coefficient c{i}", c) for i, c in enumerate(given))
        object.__setattr__(self, "coefficients", numbers)

    def __call__(self, alpha: Any) -> Any:
        """The value at alpha (rad), by Horner's scheme: a number, array, tape symbol or interval."""
        *lower, value = self.coefficients
        for c in reversed(lower):
            value = value * alpha + c
        return value


@dataclass(frozen=True)
class Table:
    """Values at given alpha (rad, rising), fitted by a least-squares Chebyshev polynomial of `degree`.

    A fit, not a spline: Taylor steps cannot see the knots of a spline. `fit_error` is the largest difference
    between fit and table; above `allowed_error` (None: 5 % of the values' range) the table is refused.
    Raises InputError.
    """

    alpha: tuple[float, ...]
    value: tuple[float, ...]
    degree: int = 6
    allowed_error: float | None = None
    fit: tuple[float, ...] = field(init=False, repr=False)
    fit_error: float = field(init=False)

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        for name in ("alpha", "value"):
            given = getattr(self, name)
            if isinstance(given, str) or not hasattr(given, "__iter__"):
                raise InputError(f"table {name} must be a list of numbers, not {given!r}")
            numbers = tuple(finite_number(f"table {name}[{i}]", v) for i, v in enumerate(given))
            set_(self, name, numbers)
        if len(self.alpha) != len(self.value) or len(self.alpha) < 2:
            raise InputError(
                f"the table has {len(self.alpha)} angles and {len(self.value)} values; give as "
                "many of both, at least 2"
            )
        if any(b <= a for a, b in zip(self.alpha, self.alpha[1:], strict=False)):
            raise InputError("the table's angles must rise; sort the rows and drop repeated angles")
        if isinstance(self.degree, bool) or not isinstance(self.degree, int) or self.degree < 0:
            raise InputError(f"table degree = {self.degree!r} must be a whole number of 0 or more")
        if self.degree >= len(self.alpha):
            raise InputError(
                f"table degree = {self.degree} needs at least {self.degree + 1} rows, there are "
                f"{len(self.alpha)}; choose a lower degree"
            )
        t, values = self._scaled(np.array(self.alpha)), np.array(self.value)
        fit = chebyshev.chebfit(t, values, self.degree)
        set_(self, "fit", tuple(float(c) for c in fit))
        set_(self, "fit_error", float(np.max(np.abs(chebyshev.chebval(t, fit) - values))))
        if self.allowed_error is None:
            allowed = 0.05 * float(np.ptp(values)) + 1e-12
        else:
            allowed = positive("table allowed_error", self.allowed_error)
        if self.fit_error > allowed:
            raise InputError(
                f"a polynomial of degree {self.degree} misses the table by {self.fit_error:.3g}, allowed is "
                f"{allowed:.3g}; choose another degree, or raise allowed_error if the table is no more exact"
            )

    def __call__(self, alpha: Any) -> Any:
        """The fit at alpha (rad), by Clenshaw's scheme: a number, array, tape symbol or interval."""
        t = self._scaled(alpha)
        first, *higher = self.fit
        if not higher:
            return first
        b1: Any = 0.0
        b2: Any = 0.0
        for c in reversed(higher):
            b1, b2 = 2.0 * t * b1 - b2 + c, b1
        return t * b1 - b2 + first

    def _scaled(self, alpha: Any) -> Any:
        low, high = self.alpha[0], self.alpha[-1]
        return (alpha - 0.5 * (low + high)) * (2.0 / (high - low))


Curve = Polynomial | Table | Expression


def as_curve(name: str, given: Any) -> Curve:
    """A curve as it is, a list of numbers as Polynomial, text as Expression, one number as a constant."""
    try:
        if isinstance(given, Polynomial | Table | Expression):
            return given
        if isinstance(given, str):
            return Expression(given)
        if hasattr(given, "__iter__"):
            return Polynomial(given)
        return Polynomial((finite_number("constant", given),))
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
