"""`rainwind new`, `check` and `schema` for both kinds of case file."""

import json
from pathlib import Path

from typer.testing import CliRunner, Result

from rainwind.cli import app
from rainwind.io.bridge_cases import is_bridge_case, read_bridge
from rainwind.io.json_schema import case_schema

ROOT = Path(__file__).parents[1]


def run(*words: object, code: int = 0) -> Result:
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == code, result.output
    return result


def test_new_bridge_writes_an_example_that_is_fine(tmp_path: Path):
    path = tmp_path / "bridge.toml"
    assert "rainwind assess" in run("new", "--bridge", path).output
    assert is_bridge_case(path)
    assert read_bridge(path).stays[0].name == "S1"
    assert run("check", path).output == f"{path}: fine\n"
    run("new", "--bridge", path, code=2)
    run("new", path, "--force")
    assert not is_bridge_case(path)


def test_check_tells_every_fault_of_a_bridge(tmp_path: Path):
    path = tmp_path / "bridge.toml"
    run("new", "--bridge", path)
    text = path.read_text(encoding="utf-8")
    path.write_text(
        text.replace("heading_deg = 90", "heading_deg = 400").replace("position_m = 4", "position_m = 70"),
        encoding="utf-8",
    )
    output = run("check", path, code=2).output
    assert "2 faults" in output
    assert "line 18: heading_deg = 400" in output
    assert "line 28: position_m = 70" in output


def test_check_tells_unusual_numbers_of_a_bridge(tmp_path: Path):
    path = tmp_path / "bridge.toml"
    run("new", "--bridge", path)
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("damping_percent = 0.15 ", "damping_ratio = 0.000015 "), encoding="utf-8")
    first, last = run("check", path).output.splitlines()
    assert first.startswith(f"{path}: stay 'S1': damping_percent = 0.0015, which is unusual")
    assert last == f"{path}: no fault, but 1 unusual number"


def test_check_of_a_shipped_example():
    path = ROOT / "examples/fred_hartman/case.toml"
    assert run("check", path).output == f"{path}: fine\n"


def test_schema_to_the_screen_or_a_file(tmp_path: Path):
    assert json.loads(run("schema").output) == case_schema()
    path = tmp_path / "a" / "case.schema.json"
    assert "#:schema ./case.schema.json" in run("schema", path).output
    assert json.loads(path.read_text(encoding="utf-8")) == case_schema()
    assert "--force" in run("schema", path, code=2).output
    assert "is a folder" in run("schema", tmp_path, code=2).output
    run("schema", path, "--force")
