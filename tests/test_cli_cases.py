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
    path = ROOT / "examples/stavanger_c1e/case.toml"
    assert run("check", path).output == f"{path}: fine\n"


def test_check_reads_the_climate_and_tells_its_notes():
    path = ROOT / "examples/fred_hartman/case.toml"
    *notes, last = run("check", path).output.splitlines()
    assert last == f"{path}: fine"
    climate = path.with_name("climate.csv")
    assert (
        notes[0] == f"{climate}: 8760 records, one every 1 h, over 365 days; 100.0 % of that time has wind."
    )
    assert len(notes) == 2
    assert f"{climate}: Wind up to " in notes[1]


def test_check_tells_faults_of_the_climate(tmp_path: Path):
    path = tmp_path / "bridge.toml"
    run("new", "--bridge", path)
    (tmp_path / "wind.csv").write_text("time,speed_m_s,direction_deg,rain_mm_h\n2025-01-01,5,400,0\n")
    with path.open("a", encoding="utf-8") as file:
        file.write('\n[climate]\nfile = "wind.csv"\n')
    output = run("check", path, code=2).output
    assert "wind.csv: 1 fault" in output
    assert "line 2: direction_deg = 400 is not allowed" in output


def test_check_tells_faults_of_the_climate_beside_those_of_the_case(tmp_path: Path):
    path = tmp_path / "bridge.toml"
    run("new", "--bridge", path)
    (tmp_path / "wind.csv").write_text(
        "time,speed_m_s,direction_deg,rain_mm_h\n2025-01-01,5,400,0\n2025-01-02,-5,40,0\n"
    )
    text = path.read_text(encoding="utf-8").replace("heading_deg = 90 ", "heading_deg = 400", 1)
    path.write_text(text + '\n[climate]\nfile = "wind.csv"\n', encoding="utf-8")
    output = run("check", path, code=2).output
    assert "heading_deg = 400 is" in output
    assert "wind.csv: 2 faults\n    line 2: direction_deg = 400 is not allowed" in output
    assert "line 3: speed_m_s = -5 is not allowed" in output


def test_schema_to_the_screen_or_a_file(tmp_path: Path):
    assert json.loads(run("schema").output) == case_schema()
    path = tmp_path / "a" / "case.schema.json"
    assert "#:schema ./case.schema.json" in run("schema", path).output
    assert json.loads(path.read_text(encoding="utf-8")) == case_schema()
    assert "--force" in run("schema", path, code=2).output
    assert "is a folder" in run("schema", tmp_path, code=2).output
    run("schema", path, "--force")
