"""Write the report of an assessment: PDF, HTML, Excel and text, all from one answer."""

from collections.abc import Callable, Sequence
from pathlib import Path

from rainwind.engineering.answers import BridgeAnswer
from rainwind.engineering.climate import Climate
from rainwind.errors import InputError
from rainwind.reporting.content import Report
from rainwind.reporting.document import document
from rainwind.reporting.text_table import csv_text

__all__ = ["FORMATS", "write_report"]

NAMES = {"pdf": "report.pdf", "html": "report.html", "xlsx": "results.xlsx", "csv": "results.csv"}
FORMATS = tuple(NAMES)


def write_report(
    answer: BridgeAnswer,
    folder: Path | str,
    *,
    formats: Sequence[str] = FORMATS,
    climate: Climate | None = None,
) -> tuple[Path, ...]:
    """Write report.pdf, report.html, results.xlsx and results.csv, those of `formats`, and return their paths.

    climate: for the wind rose, None without. The folder is made if needed. Raises InputError for a format that is not
    known or a file that cannot be written, as one that another program holds open.
    """
    unknown = [name for name in formats if name not in NAMES]
    if unknown:
        raise InputError(f"format {unknown[0]!r} is not known; choose from {', '.join(FORMATS)}")
    pages = document(answer, climate) if {"pdf", "html"} & set(formats) else None
    folder = Path(folder)
    paths = []
    for name in dict.fromkeys(formats):
        data = _WRITERS[name](answer, pages)
        path = folder / NAMES[name]
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        except OSError as error:
            raise InputError(
                f"{path} cannot be written ({error.strerror}); close it where it is open, or choose another folder"
            ) from error
        paths.append(path)
    return tuple(paths)


def _pdf(answer: BridgeAnswer, pages: Report | None) -> bytes:
    from rainwind.reporting.pdf_writer import pdf

    assert pages is not None
    return pdf(pages)


def _html(answer: BridgeAnswer, pages: Report | None) -> bytes:
    from rainwind.reporting.html_writer import html

    assert pages is not None
    return html(pages).encode("utf-8")


def _xlsx(answer: BridgeAnswer, pages: Report | None) -> bytes:
    from rainwind.reporting.workbook import workbook

    return workbook(answer)


def _csv(answer: BridgeAnswer, pages: Report | None) -> bytes:
    return ("\ufeff" + csv_text(answer)).encode("utf-8")


_WRITERS: dict[str, Callable[[BridgeAnswer, Report | None], bytes]] = {
    "pdf": _pdf,
    "html": _html,
    "xlsx": _xlsx,
    "csv": _csv,
}
