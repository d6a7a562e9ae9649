"""The main job end to end, what a stopped run keeps, and docs/paper.md against what the run computes."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from rainwind.cli import app
from rainwind.errors import InputError
from rainwind.io.results import load_netcdf
from rainwind.physics.model import paper_model
from rainwind.studies import paper, paper_run, report

DOCS = Path(__file__).parents[2] / "docs" / "paper.md"


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """`rainwind paper`, once: its folder and what it printed."""
    out = tmp_path_factory.mktemp("paper")
    result = CliRunner(env={"NO_COLOR": "1", "TERM": "dumb"}).invoke(app, ["paper", "--out", str(out)])
    assert result.exit_code == 0, (result.output, result.exception)
    return out, result.stdout


@pytest.fixture(scope="session")
def records(finished: tuple[Path, str]) -> dict[str, dict[str, Any]]:
    text = (finished[0] / "targets.json").read_text(encoding="utf-8")
    return {record["id"]: record for record in json.loads(text)}


def test_everything_is_written(finished: tuple[Path, str]):
    out, printed = finished
    for study in paper_run.STUDIES:
        assert (out / "figures" / f"{study}.png").read_bytes().startswith(b"\x89PNG")
        assert "</svg>" in (out / "figures" / f"{study}.svg").read_text(encoding="utf-8")
    groups = load_netcdf(out / "data.nc")
    assert {name.split("/")[0] for name in groups if name} == set(paper_run.STUDIES)
    assert groups[""].attrs["source"] == "Peil & Nahrath (2003)"
    for word in ("T1", "T15", "impossible", "0.694163", f"written to {out}"):
        assert word in printed


def test_targets(records: dict[str, dict[str, Any]]):
    assert list(records) == [f"T{i}" for i in range(1, 16)]
    for record in records.values():
        assert {"id", "what", "paper", "computed", "unit", "fitted", "verdict"} <= set(record)
    # section 4.1 and 4.2 of the paper, tolerances of the targets
    assert records["T2"]["computed"] == pytest.approx(8.0, abs=0.05)
    assert records["T4"]["computed"][1] == pytest.approx(14.8, abs=0.05)
    assert records["T8"]["computed"] == pytest.approx(0.7, abs=0.02)


def test_the_blend_moves_nothing_on_the_upper_side(records: dict[str, dict[str, Any]]):
    for name in ("T2", "T4", "T8"):
        assert records[name]["computed"] == pytest.approx(records[name]["extend"]["computed"], abs=1e-9)


def test_the_report_needs_nothing_beside_it(finished: tuple[Path, str]):
    page = (finished[0] / "report.html").read_text(encoding="utf-8")
    addresses = re.findall(r'(?:src|href)="([^"]*)"', page) + re.findall(r"url\(([^)]*)\)", page)
    assert len(addresses) == len(paper_run.STUDIES)
    assert all(address.startswith("data:image/svg+xml;base64,") for address in addresses)
    assert "reconstructed, not Yamaguchi" in page
    assert "stopped before its end" not in page
    assert ">NO<" not in page  # every certificate holds
    for reading in paper.READINGS:
        assert reading.place in page


def test_docs_say_what_the_run_computes(records: dict[str, dict[str, Any]]):
    words = DOCS.read_text(encoding="utf-8")
    assert report.markdown_table(list(records.values())) in words
    shown = [name for name, record in records.items() if record["details"]]
    assert shown == ["T7", "T8", "T9", "T10", "T11", "T12", "T13", "T14"]
    for name in shown:
        assert report.markdown_details(records[name]) in words
    for one in paper.READINGS:
        assert f"| {one.place} | {one.printed} | {one.taken} | {one.why} |" in words


@pytest.mark.parametrize("error", [KeyboardInterrupt(), RuntimeError("boom")])
def test_a_stopped_run_keeps_what_is_done(monkeypatch, tmp_path: Path, error: BaseException):
    told: list[tuple[int, int, str]] = []

    def progress(done: int, total: int, what: str) -> None:
        told.append((done, total, what))
        if what == "figure 05 equilibria":
            raise error

    only = ("T2", "T4")
    monkeypatch.setattr(paper_run, "STATEMENTS", {name: paper_run.STATEMENTS[name] for name in only})
    with pytest.raises(type(error)):
        paper_run.run(tmp_path, progress=progress)
    assert [done for done, _, _ in told[:-1]] == list(range(len(told) - 1))
    assert told[-1][2] == "report and data"
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == [
        "figure_04_coefficients.png",
        "figure_04_coefficients.svg",
    ]
    assert any(name.startswith("figure_04") for name in load_netcdf(tmp_path / "data.nc"))
    found = json.loads((tmp_path / "targets.json").read_text(encoding="utf-8"))
    assert [record["verdict"] for record in found] == ["met", "partly"]
    assert "stopped before its end" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_run_stopped_at_once_says_that_nothing_was_computed(tmp_path: Path):
    def progress(done: int, total: int, what: str) -> None:
        if what == "target T1, blend":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        paper_run.run(tmp_path, progress=progress)
    found = json.loads((tmp_path / "targets.json").read_text(encoding="utf-8"))
    assert {record["verdict"] for record in found} == {"not_computed"}
    assert found[1]["fitted"]
    assert "the run was stopped" in found[0]["note"]


def test_an_unknown_study_is_refused(tmp_path: Path):
    with pytest.raises(InputError, match="figure_07"):
        paper_run.save_figure("figure_07", tmp_path / "a.png", model=paper_model())
