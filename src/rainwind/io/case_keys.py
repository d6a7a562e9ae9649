"""The keys of a case file: which are known, in which unit their numbers are, which are missing."""

from collections.abc import Collection
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from rainwind.errors import InputError
from rainwind.io.faults import Faults, Place
from rainwind.io.schema import SCHEMA, SECTION_KEYS, Keys, Number, Option
from rainwind.io.toml_values import toml_value
from rainwind.io.units import from_text, has_decimal_comma, number, to_si, unit_text, written

__all__ = ["Given", "advice", "check_top", "name_of", "nearest", "read_table", "refusal"]


def check_top(content: dict[str, Any], faults: Faults, keys: Keys = SECTION_KEYS) -> None:
    """The schema's number and the names of the tables."""
    given = content.get("schema")
    if given is None:
        faults.add(f"no 'schema'; write schema = {SCHEMA} above the first table")
    elif given != SCHEMA or isinstance(given, bool | float):
        faults.add(f"schema = {given!r} is not known; this version reads schema = {SCHEMA}", "schema")
    for key, value in content.items():
        if key == "schema":
            continue
        if key not in keys.tables:
            kind = "table" if isinstance(value, dict) or _is_tables(value) else "key"
            other = "it belongs to the case of one section, which has no [bridge], [cable] or [stays]"
            known = other if key in SECTION_KEYS.tables else _home(key, keys)
            faults.add(f"unknown {kind} '{key}'; {known or nearest(key, keys.tables, 'tables')}", key)
        elif isinstance(value, list) and key in keys.arrays:
            if not _is_tables(value):
                faults.add(
                    f"'{key}' is no list of tables; write [[{key}]] and its keys below, once for each", key
                )
        elif not isinstance(value, dict):
            faults.add(f"'{key}' is no table; write [{key}] and its keys on the lines below", key)


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def nearest(given: str, allowed: Any, kind: str) -> str:
    """The allowed name that is meant, as a question, or all of them; `kind` is what they are called."""
    near = get_close_matches(given, list(allowed), n=1, cutoff=0.5)
    return f"did you mean '{near[0]}'?" if near else f"{kind} allowed: {', '.join(allowed)}"


@dataclass(frozen=True)
class Given:
    """A value of the file: the key that gave it, as written there, and in SI."""

    key: str
    raw: Any
    value: Any


def read_table(
    table: str, content: Any, place: Place, keys: Keys = SECTION_KEYS, elsewhere: Collection[str] = ()
) -> dict[str, Given]:
    """Name without unit -> what was given, of one table; faulty values are left out.

    elsewhere: names that need not be here, because they are given somewhere else.
    """
    numbers, options = keys.numbers_of(table), keys.options_of(table)
    values: dict[str, Given] = {}
    found: dict[str, str] = {}  # name -> the key that gave it; a key with a faulty value counts
    for key, value in content.items() if isinstance(content, dict) else ():
        name = key if key in options else name_of(key, numbers)
        if name is None:
            place.add(f"unknown key '{key}' in {place.label}; {advice(table, key, keys)}", key)
        elif name in found:
            place.add(f"{key} and {found[name]} both give the {name}; keep one of them", key)
        else:
            found[name] = key
            try:
                read = _option(options[key], value) if key in options else _number(numbers[name], key, value)
                values[name] = Given(key, value, read)
            except InputError as error:
                place.add(str(error), key)
    there = {*found, *elsewhere}
    for name, item in numbers.items():
        if item.required and name not in there and not (item.parts and set(item.parts) <= there):
            place.add(f"{place.label} {_missing(item, numbers, found)}")
    for name, option in options.items():
        if option.required and name not in there:
            place.add(f"{place.label} has no {name}; add for example {name} = {toml_value(option.sample)}")
    return values


def name_of(key: str, names: Collection[str]) -> str | None:
    """The longest of the names that the key gives, with or without a unit behind it."""
    return max((name for name in names if key == name or key.startswith(f"{name}_")), key=len, default=None)


def refusal(item: Number, given: Given, error: InputError) -> str:
    """The fault of a number that the physics refuses, quoting the file."""
    if item.allowed and isinstance(given.value, float):
        return (
            f"{given.key} = {given.raw!r} is {given.value:g} rad; allowed is {item.allowed}; "
            "correct the number or its unit"
        )
    return f"{given.key} = {given.raw!r}: {error}"


def _option(option: Option, value: Any) -> Any:
    """What stands there, checked by its form."""
    given = f"{option.name} = {value!r}"
    if option.form == "text" and (not isinstance(value, str) or not value.strip()):
        raise InputError(f"{given} is no text; write {option.name} = {toml_value(option.sample)}")
    if option.form == "texts":
        if not isinstance(value, list) or not all(isinstance(item, str) and item.strip() for item in value):
            raise InputError(
                f"{given} is no list of texts; write {option.name} = {toml_value(option.sample)}"
            )
        return tuple(value)
    if option.form == "count" and (isinstance(value, bool) or not isinstance(value, int)):
        raise InputError(f"{given} is no whole number; write {option.name} = {toml_value(option.sample)}")
    if option.choices and option.form and value not in option.choices:
        raise InputError(
            f"{given} is not known; {nearest(str(value), [str(one) for one in option.choices], 'words')}"
        )
    if option.form == "number":
        try:
            return number(value)
        except InputError as error:
            raise InputError(f"{given} {error}") from error
    return value


def _number(item: Number, key: str, value: Any) -> float | tuple[float, ...]:
    if not item.several:
        return _one_number(item, key, value)
    if isinstance(value, list) and not value:
        raise InputError(f"{key} = [] is empty; write one number or more")
    return tuple(_one_number(item, key, one) for one in (value if isinstance(value, list) else [value]))


def _one_number(item: Number, key: str, value: Any) -> float:
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


def advice(table: str, key: str, keys: Keys) -> str:
    """What to do about a key that the table does not know."""
    names = [item.kind.keys(item.name)[0] for item in keys.numbers_of(table).values()]
    return _home(key, keys) or nearest(key, [*names, *keys.options_of(table)], "keys")


def _home(key: str, keys: Keys) -> str:
    """Where a key that is right in itself belongs."""
    tables = [item.table for item in keys.numbers if key in (item.name, *item.kind.keys(item.name))]
    tables += [item.table for item in keys.options if key == item.name]
    return f"it belongs in {' or '.join(f'[{table}]' for table in tables)}" if tables else ""
