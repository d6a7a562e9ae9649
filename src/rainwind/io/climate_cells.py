"""Cells of a climate file: its lines, its columns by name, its numbers; every fault with its line."""

import csv
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from rainwind.errors import CaseError
from rainwind.io.csv_text import csv_text
from rainwind.io.stay_tables import key_of_header
from rainwind.io.units import has_decimal_comma

__all__ = ["ABSENT", "Cells", "read_cells"]

ABSENT = (*(sign * value for value in (999, 9999, 99999, 999.9, 9999.9) for sign in (1, -1)), -99, -99.9)
"""What loggers write where they have no value."""
_WORDS = ("", "na", "n/a", "null", "none", "-", "--")
_LISTED = 10  # faults; the rest of a hopeless file is counted


@dataclass(frozen=True)
class Cells:
    """The texts of a file: header keys, and rows with their lines; `found` collects faults."""

    name: str
    header: tuple[str, ...]
    header_line: int
    lines: tuple[int, ...]
    rows: list[tuple[str, ...]]
    found: list[tuple[int, str]] = field(default_factory=list)

    def texts(self, key: str) -> list[str]:
        """One column."""
        index = self.header.index(key)
        return [row[index] for row in self.rows]

    def numbers(self, key: str, low: float, high: float, absent: tuple[float, ...] = ()) -> np.ndarray:
        """One column (n,), nan where a value is missing: no text, or one of `absent`.

        What is no number, or lies outside low to high, is a fault.
        """
        found = np.full(len(self.rows), np.nan)
        texts = self.texts(key)
        for i, text in enumerate(texts):
            try:
                found[i] = float(text)
            except ValueError:
                self._no_number(i, key, text.strip())
        if absent:
            found[np.isin(found, absent)] = np.nan
        for i in np.flatnonzero((found < low) | (found > high)):
            must = f"it must be {low:g} to {high:g}"
            self.fault(self.lines[i], f"{key} = {texts[i].strip()} is not allowed: {must}")
        return found

    def fault(self, line: int, text: str) -> None:
        """A fault of one line."""
        self.found.append((line, text))

    def raise_any(self) -> None:
        """Raise CaseError with the first ten faults by line and the count of all."""
        if not self.found:
            return
        total = len(self.found)
        count = "1 fault" if total == 1 else f"{total} faults"
        more = f", the first {_LISTED} of them:" if total > _LISTED else ""
        listed = [f"  line {line}: {text}" for line, text in sorted(self.found)[:_LISTED]]
        raise CaseError("\n".join([f"{self.name}: {count}{more}", *listed]))

    def _no_number(self, i: int, key: str, text: str) -> None:
        if text.lower() in _WORDS:
            return
        advice = "write a decimal point" if has_decimal_comma(text) else "correct it, or leave it empty"
        self.fault(self.lines[i], f"{key} = {text!r} is not a number; {advice}")


def read_cells(path: Path, example: str) -> Cells:
    """The cells of a CSV file parted by comma, semicolon or tab; example: a header, for messages.

    Blank lines and lines that begin with # are skipped. Raises CaseError for a file that is no text, has no records,
    or has rows with another number of cells than the header.
    """
    text = csv_text(path, "wind and rain")
    kept = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip(" ,;\t\ufeff")]
    kept = [(i, line) for i, line in kept if not line.lstrip().startswith("#")]
    if len(kept) < 2:
        what = "has a header and no records" if kept else "is empty"
        raise CaseError(f"{path}: {what}; the first line names the columns: {example}")
    (first, line), *rest = kept
    parts = max(",;\t", key=line.count)
    header = tuple(key_of_header(cell).lower() for cell in _split(line, parts))
    while header and not header[-1]:
        header = header[:-1]
    # tuples: the garbage collector looks at lists again and again, which doubles the time of a long file
    cells = Cells(
        str(path), header, first, tuple(i for i, _ in rest), [tuple(_split(o, parts)) for _, o in rest]
    )
    for i, row in zip(cells.lines, cells.rows, strict=True):
        if len(row) == len(header):
            continue
        if len(row) < len(header) or any(cell.strip() for cell in row[len(header) :]):
            advice = "; write decimals with a point" if len(row) > len(header) and parts == "," else ""
            cells.fault(i, f"has {len(row)} cells where the header names {len(header)}{advice}")
    cells.raise_any()
    return cells


def _split(line: str, parts: str) -> list[str]:
    """The cells of one line; a stray quote spoils its own line only."""
    if '"' not in line:
        return line.split(parts)
    return next(csv.reader([line], delimiter=parts, skipinitialspace=True))
