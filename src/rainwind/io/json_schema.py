"""The JSON schema of case files, from the tables of keys: an editor completes keys with it and marks wrong ones."""

import json
from typing import Any

from rainwind.io.bridge_schema import BRIDGE_KEYS, BRIDGE_MARKS, FIELDS, TITLES
from rainwind.io.schema import SCHEMA, SECTION_KEYS, Keys, Number, Option
from rainwind.io.units import unit_text

__all__ = ["case_schema", "case_schema_text"]

_SECTION_TITLES = {
    "wind": "the undisturbed wind",
    "section": "the cable, per metre",
    "coefficients": "lift, drag and moment of the wetted section",
    "model": "how the model is written",
}


def case_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a case file: of a section, or of a bridge if it has one of its tables.

    It knows keys, units and words; what depends on several values or on other files only the reader knows.
    """
    tables: dict[str, dict[str, Any]] = {}
    for table in SECTION_KEYS.tables:
        title = _SECTION_TITLES.get(table, TITLES.get(table, ""))
        tables[table] = _table(table, title, SECTION_KEYS)
    for table in BRIDGE_KEYS.tables:
        tables[table] = _table(table, TITLES[table], BRIDGE_KEYS)
    tables["cable"]["properties"]["damper"] = _one_or_more("damper")
    properties: dict[str, Any] = {"schema": {"const": SCHEMA, "description": "the form of the file"}}
    for table in tables:
        several = table in BRIDGE_KEYS.arrays
        properties[table] = _one_or_more(table) if several else {"$ref": f"#/$defs/{table}"}
    only_section = [table for table in SECTION_KEYS.tables if table not in BRIDGE_KEYS.tables]
    only_bridge = [table for table in BRIDGE_KEYS.tables if table not in SECTION_KEYS.tables]
    needed = sorted({item.table for item in SECTION_KEYS.numbers if item.required})
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A case of rainwind",
        "description": "One section of a stay cable with a rivulet, or the stays of a bridge.",
        "type": "object",
        "properties": properties,
        "required": ["schema"],
        "additionalProperties": False,
        "if": {"anyOf": [{"required": [table]} for table in BRIDGE_MARKS]},
        "then": {
            "properties": dict.fromkeys(only_section, False),
            "anyOf": [{"required": [table]} for table in ("cable", "stays")],
        },
        "else": {"properties": dict.fromkeys(only_bridge, False), "required": needed},
        "$defs": tables,
    }


def case_schema_text() -> str:
    """The schema as the text of a file."""
    return json.dumps(case_schema(), indent=1, ensure_ascii=False) + "\n"


def _one_or_more(table: str) -> dict[str, Any]:
    one = {"$ref": f"#/$defs/{table}"}
    return {"anyOf": [one, {"type": "array", "items": one}]}


def _table(table: str, title: str, keys: Keys) -> dict[str, Any]:
    properties: dict[str, Any] = {}
    needed: list[dict[str, Any]] = []
    for name, option in keys.options_of(table).items():
        properties[name] = _option(option)
        if option.required:
            needed.append({"required": [name]})
    for item in keys.numbers_of(table).values():
        properties |= _number(item)
        if item.required and (keys is SECTION_KEYS or table != "cable"):
            # a stay of a bridge may take it from [cable_defaults]
            ways = [{"required": [key]} for key in _number(item)]
            parts = [
                {"anyOf": [{"required": [key]} for key in _of(part, keys, table)]} for part in item.parts
            ]
            needed.append({"anyOf": [*ways, {"allOf": parts}] if parts else ways})
        needed.append({"not": {"anyOf": _twice(list(_number(item)))}})
    result: dict[str, Any] = {
        "type": "object",
        "description": title,
        "properties": properties,
        "additionalProperties": False,
    }
    return result | ({"allOf": needed} if needed else {})


def _of(name: str, keys: Keys, table: str) -> list[str]:
    return list(_number(keys.numbers_of(table)[name]))


def _twice(names: list[str]) -> list[dict[str, Any]]:
    """Any two of the keys: each gives the same number."""
    return [{"required": [one, other]} for i, one in enumerate(names) for other in names[i + 1 :]]


def _number(item: Number) -> dict[str, Any]:
    """The keys that give a number: one for each unit, and one without for text with a unit."""
    result: dict[str, Any] = {}
    for key in item.kind.keys(item.name):
        suffix = key[len(item.name) + 1 :]
        unit = "1 means 100 %" if suffix == "ratio" else unit_text(suffix)
        one: dict[str, Any] = {"type": "number"}
        if item.several:
            one = {"anyOf": [one, {"type": "array", "items": one, "minItems": 1}]}
        result[key] = one | {"description": f"{item.comment} [{unit}]"}
    text: dict[str, Any] = {
        "type": "string",
        "description": f'{item.comment}; with its unit, "{item.kind.example}"',
    }
    if item.several:
        inner = {"type": "string"}
        text = {"anyOf": [inner, {"type": "array", "items": inner, "minItems": 1}]} | {
            "description": text["description"]
        }
    return result | {item.name: text}


def _option(option: Option) -> dict[str, Any]:
    result: dict[str, Any]
    if option.choices:
        result = {"enum": list(option.choices)}
    elif isinstance(option.sample, tuple):
        inner = {"enum": list(FIELDS)} if option.name == "assumed" else {"type": "string", "minLength": 1}
        result = {"type": "array", "items": inner}
    elif isinstance(option.sample, str):
        result = {"type": "string", "minLength": 1}
    else:
        result = {"type": "integer" if option.form == "count" else "number"}
    return result | {"description": option.comment}
