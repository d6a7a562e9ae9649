"""Parameters of nested frozen dataclasses by dotted name: `wind.speed`, `section.mass`.

A field that holds a number is a parameter; one that holds a frozen dataclass is looked into, unless its
metadata says `{"parameters": False}`; a field that is None has no parameter (it follows another one).
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from difflib import get_close_matches
from typing import Any

from rainwind.errors import InputError


def parameter_values(record: Any) -> dict[str, float]:
    """Every parameter of a nested dataclass: dotted name -> value, in the order of its fields."""
    values: dict[str, float] = {}
    for field in fields(record):
        if not field.metadata.get("parameters", True):
            continue
        value = getattr(record, field.name)
        if is_dataclass(value):
            values |= {f"{field.name}.{name}": inner for name, inner in parameter_values(value).items()}
        elif _is_number(value):
            values[field.name] = float(value)
    return values


def replace_parameters(record: Any, changes: Mapping[str, float]) -> Any:
    """A copy of a nested frozen dataclass with the parameters named in `changes` replaced.

    A field that is None may be given a number. Raises InputError for a name that `record` does not have; the
    dataclasses check the values.
    """
    for name in changes:
        if not _may_be_replaced(record, name):
            raise unknown_name(name, parameter_values(record), "parameter")
    return _replaced(record, changes)


def _may_be_replaced(record: Any, name: str) -> bool:
    head, dot, rest = name.partition(".")
    for field in fields(record):
        if field.name == head and field.metadata.get("parameters", True):
            value = getattr(record, head)
            if is_dataclass(value):
                return bool(dot) and _may_be_replaced(value, rest)
            return not dot and (
                value is None or (isinstance(value, int | float) and not isinstance(value, bool))
            )
    return False


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _replaced(record: Any, changes: Mapping[str, float]) -> Any:
    own: dict[str, Any] = {}
    inner: dict[str, dict[str, float]] = {}
    for name, value in changes.items():
        head, _, rest = name.partition(".")
        if rest:
            inner.setdefault(head, {})[rest] = value
        else:
            own[head] = value
    return replace(record, **own, **{head: _replaced(getattr(record, head), v) for head, v in inner.items()})


def unknown_name(name: str, known: Any, kind: str) -> InputError:
    """The error for a misspelt name: what was given, what exists, which one is nearest."""
    near = get_close_matches(name, list(known), n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return InputError(f"there is no {kind} '{name}'.{hint} Known: {', '.join(known)}")
