"""The report: numbers as text, tables, escaping, pictures."""

from base64 import b64decode
from pathlib import Path
from typing import Any

import pytest

from rainwind import __version__
from rainwind.studies import report
from rainwind.studies.targets_record import VERDICTS, Outcome, Part, Rows, Target
from rainwind.studies.targets_statements import STATEMENTS


def record(name: str, outcome: Outcome) -> dict[str, Any]:
    data = Target(STATEMENTS[name], outcome, fitted=name == "T2").record()
    return data | {"extend": {key: data[key] for key in ("computed", "verdict", "parts", "note")}}


RECORDS = [
    record("T2", Outcome(7.99704716, "fold", (Part("fold < 8.05", True), Part("order", False)), "a & b")),
    record("T10", Outcome([1.0, 0.5], details=Rows(("d", "fold [m/s]"), ((0.05, None), ("twice", 8.0))))),
    record("T5", Outcome(note="later", verdict="not_computed")),
]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (7.99704716, "7.997"), (14.799081, "14.799"), (8.0, "8"), (2, "2"), (None, "–"), ("same", "same"),
        ([1.23456789, None], "1.2346, –"), ((8.0, 14.8), "8, 14.8"), (0.0, "0"), (1e-7, "1e-07"),
    ],
)  # fmt: skip
def test_number_text(value: Any, text: str):
    assert report.number_text(value) == text


def test_markdown_table():
    first, _, fold, _, later = report.markdown_table(RECORDS).splitlines()
    assert first.startswith("|  | statement | paper | blend | extend | unit |")
    assert fold.endswith("| 8 | 7.997 | 7.997 | m/s | fitted | partly | partly |")
    assert later.endswith("| – | – | m/s |  | not computed | not computed |")
    assert (
        report.markdown_details(RECORDS[1])
        == "| d | fold [m/s] |\n| --- | --- |\n| 0.05 | – |\n| twice | 8 |\n"
    )


def test_page(tmp_path: Path):
    drawing = tmp_path / "a.svg"
    drawing.write_text('<svg width="100pt" height="5pt"></svg>', encoding="utf-8")
    picture = report.Picture(drawing, "A < B")
    page = report.page(RECORDS, [picture], complete=False, seconds=2.0)
    assert b64decode(picture.address.partition(",")[2]) == drawing.read_bytes()
    assert "width: 150pt" in page
    for text in ("A &lt; B", "a &amp; b", "fold &lt; 8.05", "order – does not hold", "stopped before its end",
                 "0 met", "1 partly", f"rainwind {__version__}", "1 not computed"):  # fmt: skip
        assert text in page
    assert "None" not in page


def test_every_verdict_has_a_word_and_a_colour():
    page = report.page(RECORDS, [], complete=True, seconds=1.0)
    for verdict in VERDICTS:
        assert report.WORDS[verdict]
        assert f".{verdict} {{ background" in page


def test_certificates_hold():
    checks, faults = report.certificates()
    # the fold, the Hopf points on C and D; and on the Hopf curve the fold-Hopf and Hopf-Hopf points
    assert {check.kind.split()[0] for check in checks} == {"fold", "Hopf", "fold-Hopf", "Hopf-Hopf"}
    assert all(check.holds for check in checks)
    assert faults == []


def test_versions_name_no_place():
    found = report.versions()
    assert found["rainwind"] == __version__
    assert not any("/" in version for version in found.values())
