"""The keys of a case file: which are known, in which unit their numbers are, which are missing."""

from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from rainwind.errors import InputError
from rainwind.io.faults import Faults
from rainwind.io.schema import NUMBERS, OPTIONS, SCHEMA, TABLES, Number
from rainwind.io.units import from_text, has_decimal_comma, number, to_si, unit_text, written

__all__ = ["Given", "check_top", "read_table"]


def check_top(content: dict[str, Any], faults: Faults) -> None:
    """The schema's number and the names of the tables."""
    given = content.get("schema")
    if given is None:
        faults.add(f"no 'schema'; write schema = {SCHEMA} above the first table")
    elif given != SCHEMA or isinstance(given, bool | float):
        faults.add(f"schema = {given!r} is not known; this version reads schema = {SCHEMA}", "schema")
    for key, value in content.items():
        if key == "schema":
            continue
        if key not in TABLES:
            kind = "table" if isinstance(value, dict) else "key"
            faults.add(f"unknown {kind} '{key}'; {_home(key) or _nearest(key, TABLES, 'tables')}", key)
        elif not isinstance(value, dict):
            faults.add(f"'{key}' is no table; write [{key}] and its keys on the lines below", key)


def _nearest(given: str, allowed: Any, kind: str) -> str:
    near = get_close_matches(given, list(allowed), n=1, cutoff=0.5)
    return f"did you mean '{near[0]}'?" if near else f"{kind} allowed: {', '.join(allowed)}"


@dataclass(frozen=True)
class Given:
    """A value of the file: the key that gave it, as written there, and in SI."""

    key: str
    raw: Any
    value: Any


def read_table(table: str, content: Any, faults: Faults) -> dict[str, Given]:
    """Name without unit -> what was given, of one table; faulty values are left out."""
    numbers = {item.name: item for item in NUMBERS if item.table == table}
    options = {item.name for item in OPTIONS if item.table == table}
    values: dict[str, Given] = {}
    keys: dict[str, str] = {}  # name -> the key that gave it; a key with a faulty value counts
    for key, value in content.items() if isinstance(content, dict) else ():
        if key in options:
            values[key] = Given(key, value, value)
            continue
        name = max((n for n in numbers if key == n or key.startswith(f"{n}_")), key=len, default=None)
        if name is None:
            faults.add(f"unknown key '{key}' in [{table}]; {_advice(table, key)}", table, key)
        elif name in keys:
            faults.add(f"{key} and {keys[name]} both give the {name}; keep one of them", table, key)
        else:
            keys[name] = key
            try:
                values[name] = Given(key, value, _number(numbers[name], key, value))
            except InputError as error:
                faults.add(str(error), table, key)
    for name, item in numbers.items():
        if item.required and name not in keys and not (item.parts and set(item.parts) <= set(keys)):
            faults.add(f"[{table}] {_missing(item, numbers, keys)}", table)
    return values


def _number(item: Number, key: str, value: Any) -> float:
    suffix = key[len(item.name) + 1 :]
    allowed = " or ".join(item.kind.keys(item.name))
    try:
        if suffix and suffix not in item.kind.suffixes:
            raise InputError(f"has the unit '{suffix}', which is no unit of {item.kind}; write {allowed}")
        if not suffix and isinstance(value, str):
            return from_text(value, item.kind)
        if isinstance(value, str):
            if has_decimal_comma(value):
                point = value.strip().replace(",", ".")
                raise InputError(f"is text with a comma; write a plain number with a decimal point, {point}")
            text = f'{item.name} = "{item.kind.example}"'
            raise InputError(f"is text, not a number; write a plain number, or {text}")
        result = number(value)
        if not suffix:
            raise InputError(f'has no unit; write {allowed}, or {key} = "{item.kind.example}"')
        return to_si(result, item.kind, suffix)
    except InputError as error:
        raise InputError(f"{key} = {value!r} {error}") from error


def _missing(item: Number, numbers: dict[str, Number], given: dict[str, str]) -> str:
    if any(part in given for part in item.parts):
        has = next(part for part in item.parts if part in given)
        lacks = next(part for part in item.parts if part not in given)
        return f"has {has} but no {lacks}; add for example {_example(numbers[lacks])}, or give {item.name} for both"
    return f"has no {item.name}; add for example {_example(item)}"


def _example(item: Number) -> str:
    """The sample case's number: an example of a mass must not be a cable's where a rivulet's is missing."""
    suffix, value = written(item.sample, item.kind)
    return f'{item.name}_{suffix} = {value:g} or {item.name} = "{value:g} {unit_text(suffix)}"'


def _advice(table: str, key: str) -> str:
    keys = [item.kind.keys(item.name)[0] for item in NUMBERS if item.table == table]
    keys += [item.name for item in OPTIONS if item.table == table]
    return _home(key) or _nearest(key, keys, "keys")


def _home(key: str) -> str:
    """Where a key that is right in itself belongs."""
    tables = [item.table for item in NUMBERS if key in (item.name, *item.kind.keys(item.name))]
    tables += [item.table for item in OPTIONS if key == item.name]
    return f"it belongs in {' or '.join(f'[{table}]' for table in tables)}" if tables else ""
