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
        elif isinstance(value, int | float) and not isinstance(value, bool):
            values[field.name] = float(value)
    return values


def replace_parameters(record: Any, changes: Mapping[str, float]) -> Any:
    """A copy of a nested frozen dataclass with the parameters named in `changes` replaced.

    Raises InputError for a name that `record` does not have; the dataclasses check the values.
    """
    grouped: dict[str, Any] = {}
    for name, value in changes.items():
        head, _, rest = name.partition(".")
        if head not in {field.name for field in fields(record)} or not (
            is_dataclass(getattr(record, head)) if rest else not is_dataclass(getattr(record, head))
        ):
            raise unknown_name(name, parameter_values(record), "parameter")
        if rest:
            grouped.setdefault(head, {})[rest] = value
        else:
            grouped[head] = value
    return replace(
        record,
        **{
            head: replace_parameters(getattr(record, head), value) if isinstance(value, dict) else value
            for head, value in grouped.items()
        },
    )


def unknown_name(name: str, known: Any, kind: str) -> InputError:
    """The error for a misspelt name: what was given, what exists, which one is nearest."""
    near = get_close_matches(name, list(known), n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return InputError(f"there is no {kind} '{name}'.{hint} Known: {', '.join(known)}")
