"""The documentation cannot rot: code runs, commands and links exist, the table of names agrees with the code."""

import re
import shlex
from pathlib import Path

import pytest
import typer.main

from rainwind.cli import app
from rainwind.io.schema import NUMBERS, Number
from rainwind.io.units import written
from rainwind.physics.model import paper_model

ROOT = Path(__file__).parents[1]
PAGES = [page for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))) if page.exists()]
EVERY_PAGE = [
    *PAGES,
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs/decisions").glob("*.md")),
]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: Path, language: str) -> list[tuple[int, str]]:
    """The line on which each fenced block of one language begins, and its text."""
    text = page.read_text(encoding="utf-8")
    found = BLOCK.finditer(text)
    return [(text.count("\n", 0, m.start(2)), m[2]) for m in found if m[1] == language]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_python_block_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__documentation__"}
    for line, text in blocks(page, "python"):
        # the lines before it, so that an error shows its line on the page
        exec(compile("\n" * line + text, str(page), "exec"), names)


def test_blocks_are_found():
    assert len(blocks(ROOT / "docs/guide.md", "python")) > 10
    assert len(blocks(ROOT / "docs/guide.md", "console")) > 3


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_command_exists(page: Path):
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    for _, text in blocks(page, "console"):
        for line in text.splitlines():
            words = shlex.split(line.removeprefix("$ "), comments=True)
            if words[:1] == ["make"]:
                assert words[1] in targets, line
            if words[:1] != ["rainwind"] or words[1].startswith("-"):
                continue
            assert words[1] in commands, line
            known = {option for p in commands[words[1]].params for option in p.opts} | {"--help"}
            assert {word for word in words[2:] if word.startswith("--")} <= known, line


@pytest.mark.parametrize("page", EVERY_PAGE, ids=lambda page: page.name)
def test_every_link_within_the_repository_leads_somewhere(page: Path):
    text = BLOCK.sub("", page.read_text(encoding="utf-8"))
    for target in re.findall(r"\]\((?!https?:|#)([^)#\s]+)", text):
        assert (page.parent / target).exists(), f"{page.name}: {target}"


def rows_of_parameters() -> dict[str, list[str]]:
    """Name of a parameter -> the cells of its row in docs/conventions.md."""
    text = (ROOT / "docs/conventions.md").read_text(encoding="utf-8")
    table = text.split("<!-- parameters -->")[1].split("<!-- /parameters -->")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.strip().splitlines()[2:]]
    return {row[1].strip("`"): row for row in rows}


def test_the_table_of_parameters_is_complete():
    assert set(paper_model().parameters) <= set(rows_of_parameters())
    settable = {f"{n.table}.{n.field}" for n in NUMBERS if n.name != "frequency"}
    assert set(rows_of_parameters()) == settable


@pytest.mark.parametrize(
    "number", [n for n in NUMBERS if n.name != "frequency"], ids=lambda n: f"{n.table}.{n.name}"
)
def test_the_table_of_parameters_agrees_with_the_code(number: Number):
    _, name, key, unit, value, in_file = rows_of_parameters()[f"{number.table}.{number.field}"]
    assert key == f"`{number.kind.keys(number.name)[0]}`"
    assert unit == (number.kind.si[0] or "1")
    own = paper_model().parameters.get(name.strip("`"))
    if own is None:
        assert value.startswith(("follows", "none"))
    else:
        assert float(value) == pytest.approx(own, rel=1e-6)
        assert own == number.sample
    if number.shown:
        assert float(in_file) == written(number.sample, number.kind)[1]
