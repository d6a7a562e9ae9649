"""Units at the border: the only place where degrees, per cent and millimetres become SI and radians.

A number's unit is the suffix of its key (`yaw_deg = 45`) or stands in the text (`yaw = "45 deg"`).
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from typing import Any

from rainwind.errors import InputError

__all__ = ["KINDS", "Kind", "from_text", "has_decimal_comma", "number", "to_si", "unit_text", "written"]


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: the suffixes its keys may carry, SI's first, and what pint calls its dimension.

    A suffix has a factor and a divisor to SI: 100 mm / 1000 is 0.1 m exactly, 100 * 0.001 is not.
    """

    name: str
    suffixes: Mapping[str, tuple[float, float]]
    si: tuple[str, ...]
    preferred: str
    example: str
    only: frozenset[str] | None = None  # pint takes deg, % and 1 for the same, and rad/s for Hz

    def __str__(self) -> str:
        return f"an {self.name}" if self.name[0] in "aeiou" else f"a {self.name}"

    def keys(self, base: str) -> list[str]:
        """The keys that give this quantity under the name `base`, the preferred one first."""
        first = [f"{base}_{self.preferred}"]
        return first + [f"{base}_{suffix}" for suffix in self.suffixes if suffix != self.preferred]


_DEGREE = (math.pi, 180.0)
KINDS = {
    kind.name: kind
    for kind in (
        Kind("speed", {"m_s": (1, 1), "km_h": (1, 3.6)}, ("m/s",), "m_s", "9 m/s"),
        Kind(
            "angle",
            {"rad": (1, 1), "deg": _DEGREE},
            ("rad",),
            "deg",
            "45 deg",
            frozenset({"degree", "radian"}),
        ),
        Kind(
            "ratio",
            {"ratio": (1, 1), "percent": (1, 100)},
            ("",),
            "percent",
            "0.2 %",
            frozenset({"percent", "permille"}),
        ),
        Kind("length", {"m": (1, 1), "cm": (1, 100), "mm": (1, 1000)}, ("m",), "mm", "100 mm"),
        Kind("density", {"kg_m3": (1, 1)}, ("kg/m^3",), "kg_m3", "1.225 kg/m^3"),
        Kind("mass per length", {"kg_m": (1, 1), "g_m": (1, 1000)}, ("kg/m",), "kg_m", "50 kg/m"),
        Kind("frequency", {"Hz": (1, 1)}, ("Hz",), "Hz", "1 Hz", frozenset({"hertz", "millihertz"})),
        # forces are per metre of cable, which the paper leaves out of its units
        Kind("friction", {"Nms": (1, 1)}, ("N*m*s", "N*m*s/m"), "Nms", "0.05 N m s"),
        Kind("quadratic stiffness", {"N_m3": (1, 1)}, ("N/m^3",), "N_m3", "0.0077 N/m^3"),
        Kind("cubic stiffness", {"N_m4": (1, 1)}, ("N/m^4",), "N_m4", "0.00115 N/m^4"),
        Kind("force", {"N": (1, 1), "kN": (1000, 1), "MN": (1e6, 1)}, ("N",), "kN", "4500 kN"),
        Kind(
            "bending stiffness",
            {"Nm2": (1, 1), "kNm2": (1000, 1), "MNm2": (1e6, 1)},
            ("N*m^2",),
            "kNm2",
            "900 kNm^2",
        ),
        Kind("damper coefficient", {"Ns_m": (1, 1), "kNs_m": (1000, 1)}, ("N*s/m",), "kNs_m", "80 kNs/m"),
        Kind(
            "stiffness", {"N_m": (1, 1), "kN_m": (1000, 1), "MN_m": (1e6, 1)}, ("N/m",), "kN_m", "5000 kN/m"
        ),
        Kind("time", {"s": (1, 1), "min": (60, 1), "h": (3600, 1)}, ("s",), "h", "2 h"),
        # the one quantity that stays in its usual unit inside too, as the records of rain have it
        Kind("rain rate", {"mm_h": (1, 1)}, ("mm/h",), "mm_h", "0.5 mm/h"),
    )
}


def number(value: Any) -> float:
    """A finite float from what a file holds.

    Raises InputError for text, true or false, a list, NaN and infinity.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        kinds = {bool: "true or false", str: "text", list: "a list", dict: "a table"}
        raise InputError(
            f"is {kinds.get(type(value), 'a date or time')}, not a number; write a plain number such as 0.5"
        )
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise InputError("is not a finite number; write a plain number such as 0.5")
    return result


def to_si(value: float, kind: Kind, suffix: str) -> float:
    """`value` in the unit of `suffix`, in SI and radians."""
    if kind.suffixes[suffix] is _DEGREE:
        return math.radians(value)
    factor, divisor = kind.suffixes[suffix]
    return value * factor / divisor


def from_text(text: str, kind: Kind) -> float:
    """A number with its unit, such as "45 deg" or "32 km/h", in SI and radians.

    Raises InputError for text that is no number with a unit, and for a unit of the wrong kind.
    """
    say = f'write {kind} with its unit, such as "{kind.example}"'
    if has_decimal_comma(text):
        raise InputError(
            f"has a comma in its number; write a decimal point, {text.strip().replace(',', '.')}"
        )
    parts = re.fullmatch(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\D.*?)?\s*", text)
    if parts is None:
        raise InputError(f"is not a number with a unit; {say}")
    value, unit = float(parts[1]), parts[2] or ""
    if not unit:
        raise InputError(f"has no unit; {say}")
    registry = _registry()
    try:
        quantity = registry.Quantity(value, _spelt_out(unit))
    except _unreadable() as error:
        raise InputError(f"has a unit '{unit}' that is not known; {_meant(unit, kind)}{say}") from error
    names = {name for name, _ in quantity.unit_items()}
    fits = any(quantity.is_compatible_with(si) for si in kind.si)
    if not fits or (kind.only is not None and not (len(names) == 1 and names <= kind.only)):
        raise InputError(f"has the unit '{unit}', which is no unit of {kind}; {_meant(unit, kind)}{say}")
    for si in kind.si:
        if quantity.is_compatible_with(si):
            result = float(quantity.to(si).magnitude)
            return number(_tidy(result, value, unit, kind))
    raise AssertionError("unreachable: a unit that fits is compatible with one of kind.si")


def has_decimal_comma(text: str) -> bool:
    """Whether the text begins with a number such as 79,0."""
    return re.match(r"\s*[-+]?\d+,\d", text) is not None


def unit_text(suffix: str) -> str:
    """The unit that a key's suffix stands for, as it is written behind a number: kg_m3 is kg/m^3."""
    if suffix == "percent":
        return "%"
    return re.sub(r"(\d)$", r"^\1", suffix.replace("_", "/"))


def _meant(unit: str, kind: Kind) -> str:
    """A question after the nearest unit of the kind, of those that differ by signs or capitals mostly."""
    known = {_letters(suffix): unit_text(suffix) for suffix in kind.suffixes if suffix != "ratio"}
    near = get_close_matches(_letters(unit), known, n=1)
    return f"did you mean {known[near[0]]}? " if near else ""


def _letters(unit: str) -> str:
    return re.sub(r"[^a-z0-9]", "", unit.lower())


def written(value: float, kind: Kind) -> tuple[str, float]:
    """The suffix and the number that give `value` (SI) back exactly: the preferred unit, or SI's."""
    factor, divisor = kind.suffixes[kind.preferred]
    exact = value * divisor / factor
    for candidate in (float(f"{exact:.12g}"), exact):
        if to_si(candidate, kind, kind.preferred) == value:
            return kind.preferred, candidate
    return next(iter(kind.suffixes)), value


def _tidy(result: float, value: float, unit: str, kind: Kind) -> float:
    # the same number for "100 mm" as for diameter_mm = 100
    suffix = unit.replace("/", "_").replace("^", "").replace("**", "").replace("%", "percent")
    return to_si(value, kind, suffix) if suffix in kind.suffixes else result


def _spelt_out(unit: str) -> str:
    # pint reads "Nms" as a number-metre, "N ms" as newton-milliseconds and does not know "kNm2" or "kNs/m"
    unit = re.sub(r"\bN\s*ms\b", "N*m*s", unit)
    unit = re.sub(r"\b([kM]?N)\s*s\b", r"\1*s", unit)
    return re.sub(r"\b([kM]?N)\s*m\s*(?:\^|\*\*)?\s*[2²]", r"\1*m^2", unit)


@cache
def _unreadable() -> tuple[type[Exception], ...]:
    """What pint raises of a text that is no unit: its own errors, and Python's where it calculates with the text."""
    import tokenize

    import pint

    of_python = (AssertionError, ArithmeticError, SyntaxError, TypeError, ValueError)
    return (pint.PintError, tokenize.TokenError, *of_python)


@cache
def _registry() -> Any:
    import pint  # half a second: only for values given as text with a unit

    return pint.UnitRegistry()
