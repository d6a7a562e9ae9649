"""`rainwind assess`: reports, what is kept of a run that was stopped, failures, wrong input; the shipped examples."""

import csv
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rainwind.cli import app
from rainwind.engineering import assessment

ROOT = Path(__file__).parents[1]
SMALL = "\n[assessment]\nmodes = 1\ndirections = 4\nsamples = 2\nsets = ['reconstructed']\n"
STAY = """
[[cable]]
name = "{name}"
length_m = 98.3
inclination_deg = 29.8
heading_deg = 0
diameter_mm = 79
mass_kg_m = 40
tension_kN = 1704
damping_percent = 0.1
"""
FILES = {"report.pdf", "report.html", "results.xlsx", "results.csv"}


@pytest.fixture(autouse=True)
def short_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rainwind.engineering.amplitudes.PERIODS", 40.0)
    monkeypatch.setattr("rainwind.engineering.amplitudes.LAST", 10.0)


def run(*arguments: object, code: int = 0) -> tuple[str, str]:
    plain = {"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}
    result = CliRunner(env=plain).invoke(app, [*map(str, arguments)])
    assert result.exit_code == code, (result.output, result.exception)
    assert "Traceback" not in result.output
    return result.stdout, result.stderr


def case(folder: Path, *names: str) -> Path:
    path = folder / "bridge.toml"
    path.write_text(
        'schema = 1\n[bridge]\nname = "Little"\n' + "".join(STAY.format(name=n) for n in names) + SMALL,
        encoding="utf-8",
    )
    return path


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "results.csv").open(encoding="utf-8-sig", newline="") as file:
        return list(csv.DictReader(file))


def test_a_report_of_every_kind(tmp_path: Path):
    out = tmp_path / "new" / "report"
    said, _ = run("assess", case(tmp_path, "C1", "C2"), "--out", out)
    assert "C1" in said
    assert "C2" in said
    assert {path.name for path in out.iterdir() if path.is_file()} == FILES
    assert (out / "report.pdf").read_bytes().startswith(b"%PDF")
    assert "Little" in (out / "report.html").read_text(encoding="utf-8")
    assert len(rows(out)) == 2


def test_a_run_that_was_stopped_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path, out = case(tmp_path, "C1", "C2"), tmp_path / "report"
    stay, seen = assessment._stay, []

    def stopping(setting, cable, tell):
        seen.append(cable.name)
        if len(seen) == 2:
            raise KeyboardInterrupt
        return stay(setting, cable, tell)

    monkeypatch.setattr(assessment, "_stay", stopping)
    _, err = run("assess", path, "--out", out, code=130)
    assert "1 of 2 stays" in err
    assert len(rows(out)) == 1
    run("assess", path, "--out", out)
    assert seen == ["C1", "C2", "C2"]
    assert len(rows(out)) == 2
    run("assess", path, "--out", out, "--fresh")
    assert sorted(seen[3:]) == ["C1", "C2"]


def test_a_stay_that_fails_stands_in_the_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    modes = assessment.cable_modes

    def failing(cable, count):
        if cable.name == "C1":
            raise ArithmeticError("no root")
        return modes(cable, count)

    monkeypatch.setattr(assessment, "cable_modes", failing)
    out = tmp_path / "report"
    _, err = run("assess", case(tmp_path, "C1", "C2"), "--out", out, code=1)
    assert "could not be assessed: C1" in err
    assert "no root" in (out / "report.html").read_text(encoding="utf-8")
    assert any(row for row in rows(out) if "C2" in row.values())


def test_wrong_input_is_told_before_anything_is_computed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(assessment, "assess", lambda *_, **__: pytest.fail("computed"))
    run("assess", tmp_path / "none.toml", "--out", tmp_path / "r", code=2)
    section = tmp_path / "section.toml"
    run("new", section)
    _, err = run("assess", section, "--out", tmp_path / "r", code=2)
    assert "rainwind new --bridge" in err
    _, err = run("assess", case(tmp_path, "C1", "C1"), "--out", tmp_path / "r", code=2)
    assert "'C1'" in err
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize("name", ["fred_hartman", "stavanger_c1e", "paper_cable"])
def test_the_shipped_examples_end_with_a_report(name: str, tmp_path: Path):
    """In small: fewer directions and samples, and short runs; all stays of each."""
    folder = tmp_path / name
    folder.mkdir()
    for file in (ROOT / "examples" / name).iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    path = folder / "case.toml"
    text = path.read_text(encoding="utf-8")
    assert "[assessment]" not in text
    path.write_text(text + SMALL, encoding="utf-8")
    run("assess", path, "--out", tmp_path / "report")
    assert {file.name for file in (tmp_path / "report").iterdir() if file.is_file()} == FILES
    assert len(rows(tmp_path / "report")) == {"fred_hartman": 12}.get(name, 1)
