"""The JSON schema of case files: it is up to date, passes what the reader reads and stops what it can."""

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from rainwind.io.bridge_schema import BRIDGE_KEYS
from rainwind.io.case_files import new_case_text
from rainwind.io.json_schema import case_schema, case_schema_text
from rainwind.io.new_bridge import new_bridge_text
from rainwind.io.schema import OPTIONS, SECTION_KEYS
from rainwind.physics.model import RivuletModel

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*/*.toml"))
SCHEMA = case_schema()
TYPES = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": int}


def wrong(value: Any, schema: Any, path: str = "") -> Iterator[str]:
    """Where the value breaks the schema, of the words that ours uses; every other word is an error."""
    if schema is True or schema is False:
        if not schema:
            yield f"{path}: nothing is allowed here"
        return
    for word, rule in schema.items():
        if word in ("$schema", "$defs", "title", "description", "then", "else"):
            continue
        if word == "$ref":
            yield from wrong(value, SCHEMA["$defs"][rule.removeprefix("#/$defs/")], path)
        elif word == "type":
            if not isinstance(value, TYPES[rule]) or isinstance(value, bool):
                yield f"{path}: is no {rule}"
        elif word == "const":
            if value != rule:
                yield f"{path}: is not {rule}"
        elif word == "enum":
            if value not in rule:
                yield f"{path}: is none of {rule}"
        elif word in ("minLength", "minItems"):
            if isinstance(value, str | list) and len(value) < rule:
                yield f"{path}: is too short"
        elif word == "properties":
            for key in value if isinstance(value, dict) else ():
                if key in rule:
                    yield from wrong(value[key], rule[key], f"{path}.{key}")
        elif word == "additionalProperties":
            assert rule is False
            value = value if isinstance(value, dict) else {}
            yield from (f"{path}.{key}: is unknown" for key in value if key not in schema["properties"])
        elif word == "required":
            yield from (
                f"{path}: lacks {key}" for key in rule if isinstance(value, dict) and key not in value
            )
        elif word == "items":
            for index, one in enumerate(value if isinstance(value, list) else ()):
                yield from wrong(one, rule, f"{path}[{index}]")
        elif word == "anyOf":
            found = [list(wrong(value, one, path)) for one in rule]
            if all(found):  # the longest path is of the alternative that fits best
                yield max((faults[0] for faults in found), key=lambda fault: len(fault.split(":")[0]))
        elif word == "allOf":
            for one in rule:
                yield from wrong(value, one, path)
        elif word == "not":
            if not any(wrong(value, rule, path)):
                yield f"{path}: has what it must not have"
        elif word == "if":
            branch = "else" if any(wrong(value, rule, path)) else "then"
            yield from wrong(value, schema[branch], path)
        else:
            raise AssertionError(f"the schema has a word that this test does not know: {word}")


def faults(text: str) -> list[str]:
    return list(wrong(tomllib.loads(text), SCHEMA))


def test_the_shipped_schema_is_up_to_date():
    """If not: rainwind schema docs/case.schema.json --force."""
    assert (ROOT / "docs/case.schema.json").read_text(encoding="utf-8") == case_schema_text()
    assert json.loads(case_schema_text()) == SCHEMA


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_shipped_examples_validate(path: Path):
    assert faults(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("text", [new_case_text(), new_bridge_text()], ids=["section", "bridge"])
def test_the_written_examples_validate(text: str):
    assert faults(text) == []
    with_text = text.replace("mass_kg_m = 50.0", 'mass = "50 kg/m"').replace(
        "tension_kN = 3200", 'tension = "3.2 MN"'
    )
    assert with_text != text
    assert faults(with_text) == []


def test_every_key_is_described_with_its_unit():
    for keys in (SECTION_KEYS, BRIDGE_KEYS):
        for item in keys.numbers:
            properties = SCHEMA["$defs"][item.table]["properties"]
            for key in item.kind.keys(item.name):
                assert properties[key]["description"].startswith(item.comment)
            assert item.kind.example in properties[item.name]["description"]
        for option in keys.options:
            assert SCHEMA["$defs"][option.table]["properties"][option.name]["description"] == option.comment
    assert SCHEMA["$defs"]["cable"]["properties"]["tension_MN"]["description"] == "along the chord [MN]"


def test_words_of_the_section_are_those_of_the_model():
    hints = get_type_hints(RivuletModel)
    for option in OPTIONS:
        if option.choices and option.name != "degrees_of_freedom":
            assert set(option.choices) == set(hints[option.name].__args__)


BRIDGE = new_bridge_text()
FAULTS = {
    "unknown key": (BRIDGE.replace("length_m = 130", "lenth_m = 130"), ".cable[0].lenth_m: is unknown"),
    "text for a number": (
        BRIDGE.replace("high_m_s = 40", 'high_m_s = "40"'),
        ".assessment.high_m_s: is no number",
    ),
    "number for text": (BRIDGE.replace('name = "A bridge"', "name = 3"), ".bridge.name: is no string"),
    "unknown word": (
        BRIDGE.replace('profile = "uniform"', 'profile = "log"'),
        ".site.profile: is none of ['uniform', 'power', 'logarithmic']",
    ),
    "both units": (
        BRIDGE.replace("density_kg_m3 = 1.225", 'density_kg_m3 = 1.225\ndensity = "1 kg/m^3"'),
        ".site: has what it must not have",
    ),
    "no climate file": (BRIDGE + "[climate]\nheight_m = 3\n", ".climate: lacks file"),
    "half a rivulet": (BRIDGE + "[rivulet]\nmass_kg_m = 3\nheight_mm = 3\n", ".rivulet: lacks friction_Nms"),
    "no stay": ("schema = 1\n[bridge]\nname = 'x'\n", ": lacks cable"),
    "a section in a bridge": (BRIDGE + "[wind]\nspeed_m_s = 9\n", ".wind: nothing is allowed here"),
    "a site in a section": (new_case_text() + "[site]\n", ".site: nothing is allowed here"),
    "no schema": (BRIDGE.replace("schema = 1", ""), ": lacks schema"),
    "schema of the future": (BRIDGE.replace("schema = 1", "schema = 2"), ".schema: is not 1"),
    "section without mass": (new_case_text().replace("mass_kg_m = 50.0", ""), ".section: lacks mass_kg_m"),
    "whole number": (BRIDGE.replace("modes = 3", "modes = 2.5"), ".assessment.modes: is no integer"),
}


@pytest.mark.parametrize(("text", "words"), FAULTS.values(), ids=FAULTS.keys())
def test_one_fault(text: str, words: str):
    assert faults(text) == [words]


def test_one_damping_for_each_direction_will_do():
    text = new_case_text().replace(
        "damping_percent = 0.2", "damping_y_percent = 0.2\ndamping_z_ratio = 0.002"
    )
    assert "damping_z_ratio" in text
    assert faults(text) == []


def test_it_is_a_schema():
    """With the independent validator, where it is installed."""
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    validator = jsonschema.Draft202012Validator(SCHEMA)
    for path in EXAMPLES:
        assert list(validator.iter_errors(tomllib.loads(path.read_text(encoding="utf-8")))) == []
    for text, _ in FAULTS.values():
        assert list(validator.iter_errors(tomllib.loads(text)))
