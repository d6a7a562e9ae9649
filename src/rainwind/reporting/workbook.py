"""The numbers of an assessment as an Excel workbook: units in the headers, every text a text."""

from collections.abc import Iterable, Sequence
from io import BytesIO
from math import isinf, isnan, nan
from typing import Any

import numpy as np
from openpyxl import Workbook
from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE
from openpyxl.styles import Alignment, Font, PatternFill
from openpyxl.utils import get_column_letter
from openpyxl.worksheet.worksheet import Worksheet

from rainwind.engineering.answers import Band, BridgeAnswer
from rainwind.engineering.sources import SOURCES
from rainwind.reporting import words
from rainwind.reporting.back_pages import LIMITS, assumptions
from rainwind.reporting.first_page import RECONSTRUCTED, key_sentences, next_steps
from rainwind.reporting.quantities import columns, in_degrees, values

__all__ = ["workbook"]

_LONGEST = 32_000  # letters in a cell, of 32767
_NUMBER = "0.0000##"
_BOLD = Font(bold=True)
_GREY = PatternFill("solid", fgColor="E6E9EC")
Value = str | int | float | None


def workbook(answer: BridgeAnswer) -> bytes:
    """The bytes of an .xlsx file with sheets Summary, Modes, Checks, Directions, Assumptions, Input."""
    book = Workbook()
    book.remove(book.active)  # type: ignore[arg-type]
    _summary(book.create_sheet("Summary"), answer)
    _modes(book.create_sheet("Modes"), answer)
    _checks(book.create_sheet("Checks"), answer)
    _directions(book.create_sheet("Directions"), answer)
    _assumptions(book.create_sheet("Assumptions"), answer)
    _input(book.create_sheet("Input"), answer)
    out = BytesIO()
    book.save(out)
    return out.getvalue()


_SUMMARY = (
    "Stay",
    "Verdict",
    "Margin",
    "Mode that decides",
    "Damping there (%)",
    *(f"Damping needed, observed speeds (%), {part}" for part in ("5 %", "middle", "95 %")),
    "Mode of the range",
    *(f"Range begins (m/s), {part}" for part in ("5 %", "middle", "95 %")),
    *(f"Range ends (m/s), {part}" for part in ("5 %", "middle", "95 %")),
    "Range open, share of samples",
    "Mode of the amplitude",
    *(f"Amplitude, half peak to peak (m), {part}" for part in ("5 %", "middle", "95 %")),
    "Failure",
)


def _summary(sheet: Worksheet, answer: BridgeAnswer) -> None:
    rows: list[list[Value]] = []
    for stay in answer.stays:
        said = words.VERDICTS[stay.verdict].word
        worst, ranged, largest = stay.worst, words.range_mode(stay), words.amplitude_mode(stay)
        row: list[Value] = [stay.cable.name, said]
        row += [nan if worst is None else stay.margin, worst.number if worst else None]
        row += [100 * worst.damping_total if worst else None]
        row += _ends(worst and words.in_percent(worst.damping_needed_observed))
        row += [ranged.number if ranged else None]
        row += _ends(ranged and ranged.range_low) + _ends(ranged and ranged.range_high)
        row += [ranged.unlimited if ranged else None, largest.number if largest else None]
        row += _ends(largest and largest.amplitude)
        rows.append([*row, stay.failure])
    _fill(sheet, _SUMMARY, rows)
    for row_number, stay in enumerate(answer.stays, start=2):
        one = words.VERDICTS[stay.verdict]
        cell = sheet.cell(row_number, 2)
        cell.fill = PatternFill("solid", fgColor=one.paper.lstrip("#"))
        cell.font = Font(bold=True, color=one.ink.lstrip("#"))
    interrupted = ("The computation was interrupted; stays are missing.",) if answer.interrupted else ()
    sentences = (*interrupted, *key_sentences(answer), *next_steps(answer), RECONSTRUCTED)
    for offset, sentence in enumerate(sentences):
        _put(sheet, len(rows) + 3 + offset, 1, sentence)


def _ends(band: Band | None) -> list[Value]:
    return [nan] * 3 if band is None else [band.low, band.middle, band.high]


def _modes(sheet: Worksheet, answer: BridgeAnswer) -> None:
    rows = [
        [stay.cable.name, stay.verdict, mode.number, *values(stay, mode)]
        for stay in answer.stays
        for mode in stay.modes
    ]
    _fill(sheet, ("Stay", "Verdict", "Mode", *columns()), rows, frozen="D2")


def _checks(sheet: Worksheet, answer: BridgeAnswer) -> None:
    rows = [
        [
            stay.cable.name,
            one.rule,
            one.what,
            one.value,
            one.sense,
            one.limit,
            one.unit,
            _met(one.passes),
            one.source,
        ]
        for stay in answer.stays
        for one in stay.checks
    ]
    header = ("Stay", "Rule", "What", "Value", "Asked", "Limit", "Unit of value and limit", "Met", "Source")
    _fill(sheet, header, rows)


def _met(passes: bool) -> str:
    return "yes" if passes else "no"


def _directions(sheet: Worksheet, answer: BridgeAnswer) -> None:
    parts = ("5 %", "middle", "95 %")
    header = (
        "Stay",
        "Mode",
        "Wind from (°)",
        *(f"Range begins (m/s), {part}" for part in parts),
        *(f"Range ends (m/s), {part}" for part in parts),
        "Share of samples with a range",
    )
    rows = [
        [
            stay.cable.name,
            mode.number,
            in_degrees(direction),
            *map(float, low),
            *map(float, high),
            float(share),
        ]
        for stay in answer.stays
        for mode in stay.modes
        for direction, low, high, share in zip(
            mode.directions, np.asarray(mode.speed_low), np.asarray(mode.speed_high), mode.share, strict=True
        )
    ]
    _fill(sheet, header, rows)


def _assumptions(sheet: Worksheet, answer: BridgeAnswer) -> None:
    rows: list[Sequence[Value]] = [("assumed", of, said) for said, of in assumptions(answer)]
    rows += [("limit of the model", "all", said) for said in LIMITS]
    rows += [("wind and rain records", "the bridge", said) for said in answer.climate_notes]
    rows += [("source of the input", "the bridge", said) for said in answer.bridge.sources]
    rows += [("source of the method", key, one.sentence) for key, one in SOURCES.items()]
    _fill(sheet, ("Kind", "Of", "Sentence"), rows)


def _input(sheet: Worksheet, answer: BridgeAnswer) -> None:
    _fill(sheet, ("The case file as it was read",), [[line] for line in answer.case_text.splitlines()])


def _fill(
    sheet: Worksheet, header: Sequence[str], rows: Iterable[Sequence[Value]], frozen: str = "B2"
) -> None:
    for column, text in enumerate(header, start=1):
        _put(sheet, 1, column, text)
        cell = sheet.cell(1, column)
        cell.font, cell.fill = _BOLD, _GREY
        cell.alignment = Alignment(wrap_text=True, vertical="bottom")
    longest = [12] * len(header)
    count = 1
    for count, row in enumerate(rows, start=2):
        for column, value in enumerate(row, start=1):
            _put(sheet, count, column, value)
            if isinstance(value, str):
                longest[column - 1] = max(longest[column - 1], min(len(value) + 2, 90))
    for column, width in enumerate(longest, start=1):
        sheet.column_dimensions[get_column_letter(column)].width = width
    sheet.freeze_panes = frozen if len(header) > 1 else "A2"
    if count > 1 and len(header) > 1:
        sheet.auto_filter.ref = f"A1:{get_column_letter(len(header))}{count}"


def _put(sheet: Worksheet, row: int, column: int, value: Value) -> None:
    """A number where it is finite; nan an empty cell; a text is never a formula."""
    if value is None or (isinstance(value, float) and isnan(value)):
        return
    cell: Any = sheet.cell(row, column)  # a plain cell: nothing is merged
    if isinstance(value, float) and isinf(value):
        value = words.NOT_NEEDED if str(sheet.cell(1, column).value).lower() == "margin" else "no limit"
    if isinstance(value, str):
        cell.value = ILLEGAL_CHARACTERS_RE.sub("", value)[:_LONGEST]
        cell.data_type = "s"
        cell.quotePrefix = True
        return
    cell.value = value
    if isinstance(value, float):
        cell.number_format = _NUMBER
