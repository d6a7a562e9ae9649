"""A report's content as a PDF: Typst lays it out; texts reach it as data, so that none can be read as a command."""

import json
import re
import tempfile
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from rainwind.reporting import words
from rainwind.reporting.content import Block, Cell, Figure, Points, Report, Table, Verbatim, Words

__all__ = ["pdf"]

_TEMPLATE = "report.typ"
_LONG = re.compile(r"\S{24,}")
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


def pdf(report: Report) -> bytes:
    """The report as the bytes of a PDF file, A4. Needs no net and no fonts of the machine."""
    import typst

    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        template = files("rainwind.reporting") / "templates" / _TEMPLATE
        (root / _TEMPLATE).write_text(template.read_text(encoding="utf-8"), encoding="utf-8")
        (root / "report.json").write_text(json.dumps(_report(report, root)), encoding="utf-8")
        return typst.compile(
            str(root / _TEMPLATE), root=str(root), ignore_system_fonts=True, font_paths=[_fonts()]
        )


def _fonts() -> str:
    """The folder of the fonts that come with matplotlib, for signs that Typst's own fonts lack."""
    import matplotlib

    return str(Path(matplotlib.get_data_path()) / "fonts" / "ttf")


def _report(report: Report, root: Path) -> dict[str, Any]:
    sections = []
    for section in report.sections:
        blocks = [_block(block, root) for block in section.blocks]
        sections.append(
            {
                "title": _text(section.title),
                "level": section.level,
                "new_page": section.new_page,
                "one_page": section.one_page,
                "blocks": blocks,
            }
        )
    return {
        "title": _text(report.title),
        "subtitle": _text(report.subtitle),
        "head": _text(report.head),
        "foot": _text(report.foot),
        "sections": sections,
        "verdicts": {name: {"ink": v.ink, "paper": v.paper} for name, v in words.VERDICTS.items()},
    }


def _block(block: Block, root: Path) -> Mapping[str, Any]:
    match block:
        case Words(text, kind):
            return {"type": "words", "kind": kind, "text": _text(text)}
        case Points(items, numbered):
            return {"type": "points", "items": [_text(item) for item in items], "numbered": numbered}
        case Table():
            return _table(block)
        case Figure(svg, caption, width):
            name = f"figure-{len(list(root.glob('figure-*.svg')))}.svg"
            (root / name).write_text(svg, encoding="utf-8")
            return {"type": "figure", "file": name, "caption": _text(caption), "width": width}
        case Verbatim(text):
            return {"type": "verbatim", "lines": [_breakable(line) for line in text.splitlines()]}


def _table(table: Table) -> Mapping[str, Any]:
    count = len(table.header)
    widths = table.widths or (1 / count,) * count
    return {
        "type": "table",
        "header": [_text(text) for text in table.header],
        "widths": list(widths),
        "left": list(table.left),
        "caption": _text(table.caption),
        "rows": [[_cell(cell) for cell in row] for row in table.rows],
    }


def _cell(cell: Cell) -> Mapping[str, str]:
    return {"text": _text(cell.text), "mark": cell.mark}


def _text(text: str) -> str:
    return _breakable(words.unbroken(text))


def _breakable(text: str) -> str:
    """Without control characters; words of many letters may break anywhere."""
    text = _CONTROL.sub("", text.replace("\t", "    "))
    return _LONG.sub(
        lambda found: "\u200b".join(found[0][i : i + 4] for i in range(0, len(found[0]), 4)), text
    )
