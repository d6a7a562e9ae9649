"""Stays from a table, one row each: a CSV file or a sheet of an Excel file, with the keys of [cable] as headers.

A header carries the unit as the key does, `tension_kN`, or in brackets, `tension [kN]`. A stay's damper may stand in
its row: `damper_position_m`, `damper_coefficient_kNs_m`, ... Blank lines, blank columns
and lines above the headers that begin with # are skipped.
"""

import csv
import io
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rainwind.errors import InputError
from rainwind.io.case_keys import advice, name_of
from rainwind.io.faults import Faults, TableRow
from rainwind.io.schema import Keys

__all__ = ["StayRow", "key_of_header", "read_stay_rows"]

_DAMPER = "damper_"
_LISTS = ("assumed",)  # cells that hold several words
_EXCEL = (".xlsx", ".xlsm")


@dataclass(frozen=True)
class StayRow:
    """One row: what its cells say by key, as a [[cable]] would, and where it stands; damper: of its own."""

    place: TableRow
    content: dict[str, Any]
    damper: dict[str, Any]
    damper_place: TableRow


def read_stay_rows(
    path: Path, sheet: str | None, keys: Keys, faults: Faults, defaults: Collection[str] = ()
) -> list[StayRow]:
    """The rows of the table at `path`; faults of the table as a whole and of its headers go to `faults`.

    defaults: names that need no column, because they are given elsewhere. Raises InputError for a file that cannot
    be read at all.
    """
    rows = _excel_rows(path, sheet) if path.suffix.lower() in _EXCEL else _csv_rows(path)
    table = [(number, cells) for number, cells in rows if any(not _blank(cell) for cell in cells)]
    while table and str(table[0][1][0] or "").lstrip().startswith("#"):  # below the headers #12 may be a name
        table.pop(0)
    if not table:
        raise InputError(
            f"is empty; write one row of headers, such as name, length_m, and one row a stay{_others(path, sheet)}"
        )
    (first, headers), *rest = table
    if not rest:
        raise InputError(f"has headers and no row below them; write one row a stay{_others(path, sheet)}")
    columns = _columns(headers, keys, TableRow(faults, path.name, first, {}), defaults)
    texts = {key: str(headers[index]).strip() for index, key in columns.items()}
    return [_row(path.name, number, cells, columns, texts, keys, faults) for number, cells in rest]


def key_of_header(header: str) -> str:
    """The key that a header means: "Tension [kN]" is tension_kN, "damping (%)" is damping_percent."""
    parts = re.fullmatch(r"\s*(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*", header)
    words, unit = (parts[1], parts[2]) if parts else (header.strip(), "")
    if not parts:
        return "_".join(words.split())
    unit = unit.replace("%", "percent").replace("°", "deg").replace("²", "2").replace("³", "3")
    unit = re.sub(r"[\s^*·]", "", unit).replace("/", "_")
    name = "_".join(words.lower().split())
    return f"{name}_{unit}" if unit and unit not in ("-", "1") else name


def _columns(headers: list[Any], keys: Keys, place: TableRow, defaults: Collection[str]) -> dict[int, str]:
    """Index of each column that is known -> its key; unknown, doubled and missing ones are faults."""
    known = {**keys.numbers_of("cable"), **keys.options_of("cable")}
    dampers = {**keys.numbers_of("damper"), **keys.options_of("damper")}
    columns: dict[int, str] = {}
    names: dict[str, str] = {}
    for index, header in enumerate(headers):
        if _blank(header):
            continue
        key = key_of_header(str(header))
        key = key[0].lower() + key[1:]
        inner = key.removeprefix(_DAMPER)
        name = name_of(key, known)
        if name is None and inner != key and name_of(inner, dampers) not in (None, "stays"):
            name = f"{_DAMPER}{name_of(inner, dampers)}"
        if name is None:
            place.add(f"unknown column '{header}'; {advice('cable', key, keys)}")
        elif name in names:
            place.add(f"the columns '{names[name]}' and '{header}' both give the {name}; keep one")
        else:
            names[name] = str(header)
            columns[index] = key
    for name, item in known.items():
        if item.required and name not in names and name not in defaults:
            key = item.kind.keys(name)[0] if name in keys.numbers_of("cable") else name  # type: ignore[union-attr]
            where = f", or {key} in [cable_defaults]" if name != "name" else ""
            place.add(f"no column gives the {name}; add one with the header {key}{where}")
    return columns


def _row(
    file: str,
    number: int,
    cells: list[Any],
    columns: dict[int, str],
    texts: dict[str, str],
    keys: Keys,
    faults: Faults,
) -> StayRow:
    content: dict[str, Any] = {}
    damper: dict[str, Any] = {}
    numbers = keys.numbers_of("cable")
    for index, key in columns.items():
        cell = cells[index] if index < len(cells) else None
        if _blank(cell):
            continue
        if name_of(key, [*numbers, *keys.options_of("cable")]) is None:
            damper[key.removeprefix(_DAMPER)] = _number_or_text(cell)
        elif name_of(key, numbers) is None:
            content[key] = _words(cell) if key in _LISTS else _text(cell)
        elif numbers[str(name_of(key, numbers))].several and isinstance(cell, str):
            several = [_number_or_text(one) for one in cell.replace(";", " ").split()]
            content[key] = several if all(isinstance(one, float) for one in several) else cell.strip()
        elif isinstance(cell, _PercentCell) and key.endswith("_percent"):
            content[key] = float(f"{100 * cell:.15g}")
        else:
            content[key] = _number_or_text(cell)
    inner = {key.removeprefix(_DAMPER): text for key, text in texts.items()}
    return StayRow(
        TableRow(faults, file, number, texts),
        content,
        damper,
        TableRow(faults, file, number, inner, "the row's damper"),
    )


def _csv_rows(path: Path) -> Iterator[tuple[int, list[Any]]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            "is no text in UTF-8; save it as CSV UTF-8, or give the .xlsx file itself"
        ) from error
    head = next(
        (line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), ""
    )
    separator = max(",;\t", key=head.count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    for cells in reader:
        yield reader.line_num, list(cells)


def _excel_rows(path: Path, sheet: str | None) -> Iterator[tuple[int, list[Any]]]:
    import zipfile

    import openpyxl  # a quarter of a second: only for Excel files
    from openpyxl.utils.exceptions import InvalidFileException

    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    except (InvalidFileException, zipfile.BadZipFile, KeyError, ValueError) as error:
        raise InputError(f"cannot be read as an Excel file ({error}); save it again as .xlsx") from error
    try:
        if sheet is not None and sheet not in book.sheetnames:
            raise InputError(f"has no sheet '{sheet}'; it has {', '.join(book.sheetnames)}")
        page = book[sheet] if sheet is not None else book.worksheets[0]
        for number, cells in enumerate(page.iter_rows(), start=1):
            yield number, [_seen(cell) for cell in cells]
    finally:
        book.close()


class _PercentCell(float):
    """A cell that Excel shows as "0.12%": its value is 0.0012."""


def _seen(cell: Any) -> Any:
    """The value of a cell; one in per cent is marked, since it shows a hundred times its value."""
    if isinstance(cell.value, int | float) and "%" in (getattr(cell, "number_format", None) or ""):
        return _PercentCell(cell.value)
    return cell.value


def _others(path: Path, sheet: str | None) -> str:
    """Of an Excel file whose first sheet was taken because none was named: the others, for a message."""
    if sheet is not None or path.suffix.lower() not in _EXCEL:
        return ""
    import openpyxl

    book = openpyxl.load_workbook(path, read_only=True)
    first, *others = book.sheetnames
    book.close()
    if not others:
        return ""
    names = ", ".join(f"'{name}'" for name in others)
    return f"; this is its first sheet, '{first}', others are {names}: name one with sheet = \"...\""


def _blank(cell: Any) -> bool:
    return cell is None or (isinstance(cell, str) and not cell.strip())


def _text(cell: Any) -> str:
    """A name such as 13 is a number in Excel."""
    return (
        f"{cell:.15g}" if isinstance(cell, int | float) and not isinstance(cell, bool) else str(cell).strip()
    )


def _words(cell: Any) -> list[str]:
    return [word for word in re.split(r"[;,\s]+", str(cell)) if word]


def _number_or_text(cell: Any) -> Any:
    if not isinstance(cell, str):
        return cell
    try:
        return float(cell.replace("_", "x"))  # Python takes 1_000 for a number
    except ValueError:
        return cell.strip()
