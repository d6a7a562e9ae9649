"""The reference of keys in the documentation is that of the code, and its example reads."""

import re
from pathlib import Path

from rainwind.io.bridge_cases import read_bridge
from rainwind.io.bridge_schema import BRIDGE_KEYS
from rainwind.io.key_reference import key_reference

PAGE = Path(__file__).parents[2] / "docs/case_files.md"


def test_the_page_has_the_keys_as_they_are():
    """If not: put key_reference() between the two marks of docs/case_files.md."""
    text = PAGE.read_text(encoding="utf-8")
    assert text.split("<!-- keys -->")[1].split("<!-- /keys -->")[0].strip() == key_reference().strip()


def test_every_key_has_a_row():
    rows = re.findall(r"(?m)^\| `(\w+) = ", key_reference())
    shown = [item for item in (*BRIDGE_KEYS.numbers, *BRIDGE_KEYS.options) if item.table != "cable_defaults"]
    assert len(rows) == len(shown)
    assert "| `tension_kN = 3200` | `_kN`, `_N`, `_MN` | yes | along the chord |" in key_reference()


def test_the_example_of_the_page_reads(tmp_path: Path):
    text = PAGE.read_text(encoding="utf-8")
    for name, language in (("case.toml", "toml"), ("stays.csv", "text")):
        found = re.search(rf"```{language}\n(.*?)```", text, re.DOTALL)
        assert found is not None
        (tmp_path / name).write_text(found[1], encoding="utf-8")
    bridge = read_bridge(tmp_path / "case.toml")
    assert [stay.name for stay in bridge.stays] == ["1N", "2N", "3N"]
    assert [len(stay.dampers) for stay in bridge.stays] == [0, 0, 1]
    assert bridge.stays[0].tension == 1.85e6
    assert all(stay.assumed == ("damping",) for stay in bridge.stays)
