"""Wind records in: a CSV file of measured wind becomes signals, or one error that lists its faults by line."""

import csv
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

import numpy as np

from rainwind.dynamics.records import GAP, gaps_in, record
from rainwind.dynamics.signals import Signal
from rainwind.errors import InputError
from rainwind.io.csv_text import csv_text
from rainwind.io.faults import Faults
from rainwind.io.units import KINDS, Kind, has_decimal_comma, number, to_si
from rainwind.io.usual import FASTEST

__all__ = ["WindRecord", "read_wind"]

_TIME = Kind("time", {"s": (1, 1), "ms": (1, 1000), "min": (60, 1), "h": (3600, 1)}, ("s",), "s", "0.1 s")
_COLUMNS = {"time": _TIME, "speed": KINDS["speed"], "vertical_speed": KINDS["speed"]}
_NEEDED = ("time", "speed")
_EXAMPLE = "time_s,speed_m_s"
_LISTED = 20  # faults; the rest of a hopeless file is counted


@dataclass(frozen=True, eq=False)
class WindRecord:
    """A measured wind: U(t) and, where it was measured, w(t) in m/s, with time from the first sample in seconds.

    began: the first time of the file, in seconds. The signals may stand for the parameters `wind.speed` and
    `wind.vertical_speed`.
    """

    speed: Signal
    vertical_speed: Signal | None
    began: float

    @property
    def parameters(self) -> dict[str, Signal]:
        """The signals by the names of the model's parameters."""
        found = {"wind.speed": self.speed}
        return found if self.vertical_speed is None else {**found, "wind.vertical_speed": self.vertical_speed}


def read_wind(
    path: Path | str,
    *,
    kind: Literal["linear", "cubic", "spline"] = "linear",
    gaps: Literal["refuse", "interpolate"] = "refuse",
) -> WindRecord:
    """The wind of the CSV file at `path`.

    Its first line names the columns with their units: time_s (or _ms, _min, _h), speed_m_s (or _km_h) and, if there,
    vertical_speed_m_s, positive upwards; other columns are left aside. Columns are parted by comma, semicolon or tab,
    numbers have a decimal point, lines beginning with # are comments. kind and gaps: as of `record`. Raises CaseError
    with the faults by line: a missing column or unit, no number, NaN, a speed that is not above 0 or above 100 m/s,
    times unsorted or given twice, gaps; InputError for another kind or gaps.
    """
    path = Path(path)
    faults = Faults(str(path), {})
    rows = _rows(csv_text(path, "a wind record"))
    columns = _columns(rows, faults)
    _raise(faults)
    values, places = _values(rows[1:], columns, faults)
    if len(places) < 2:
        faults.add(f"{len(places)} rows of numbers; a record needs two or more")
    _check_times(values["time"], places, gaps, faults)
    _raise(faults)
    t = values.pop("time")
    signals = {name: record(t - t[0], column, kind, gaps=gaps) for name, column in values.items()}
    return WindRecord(signals["speed"], signals.get("vertical_speed"), float(t[0]))


def _rows(text: str) -> list[tuple[int, list[str]]]:
    """Line and cells of every line that is neither empty nor a comment."""
    lines = [
        (i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and line.strip()[0] != "#"
    ]
    if not lines:
        return []
    parts = max(",;\t", key=lines[0][1].count)
    # line by line: a quote that is not closed spoils its own line only
    return [(i, [cell.strip() for cell in next(csv.reader([line], delimiter=parts))]) for i, line in lines]


def _columns(rows: list[tuple[int, list[str]]], faults: Faults) -> dict[str, tuple[int, str]]:
    """Name -> number of the column and its unit."""
    if not rows:
        faults.add(f"empty; the first line names the columns: {_EXAMPLE}")
        return {}
    line, header = rows[0]
    found: dict[str, tuple[int, str]] = {}
    for i, key in enumerate(header):
        name = max((n for n in _COLUMNS if key == n or key.startswith(f"{n}_")), key=len, default=None)
        if name is None:
            continue
        suffix = key[len(name) + 1 :]
        if suffix not in _COLUMNS[name].suffixes:
            keys = " or ".join(_COLUMNS[name].keys(name))
            why = (
                f"has the unit '{suffix}', which is no unit of {_COLUMNS[name]}" if suffix else "has no unit"
            )
            faults.found.append((line, f"column '{key}' {why}; write {keys}"))
        elif name in found:
            faults.found.append((line, f"column '{key}' is the second one of the {name}; keep one of them"))
        found.setdefault(name, (i, suffix))
    for name in _NEEDED:
        if name not in found:
            keys = _COLUMNS[name].keys(name)
            near = get_close_matches(keys[0], header, n=1, cutoff=0.5)
            hint = f"; is '{near[0]}' meant?" if near else ""
            faults.found.append(
                (line, f"no column of the {name}; the first line names the columns: {_EXAMPLE}{hint}")
            )
    return found


def _values(
    rows: list[tuple[int, list[str]]], columns: dict[str, tuple[int, str]], faults: Faults
) -> tuple[dict[str, np.ndarray], list[int]]:
    """The columns in SI, NaN where a cell is faulty, and the line of each row."""
    values = {name: np.full(len(rows), np.nan) for name in columns}
    for row, (line, cells) in enumerate(rows):
        for name, (i, suffix) in columns.items():
            try:
                values[name][row] = _cell(name, cells[i] if i < len(cells) else "", suffix)
            except InputError as error:
                faults.found.append((line, f"{name} {error}"))
    return values, [line for line, _ in rows]


def _cell(name: str, text: str, suffix: str) -> float:
    if not text:
        raise InputError(
            "is missing; fill it in, or remove the line and bridge the gap with gaps='interpolate'"
        )
    if has_decimal_comma(text):
        raise InputError(f"= {text} has a comma; write a decimal point")
    try:
        value = number(float(text))
    except ValueError as error:  # InputError is one
        raise InputError(
            f"= {text} is not a finite number; correct it, or remove the line and bridge the gap with "
            "gaps='interpolate'"
        ) from error
    value = to_si(value, _COLUMNS[name], suffix)
    if name == "speed" and value <= 0:
        raise InputError(
            f"= {text} is not allowed: it must be above 0; for a calm write the least speed measured"
        )
    if name != "time" and abs(value) > FASTEST:
        raise InputError(
            f"= {text} is {value:g} m/s; allowed is up to {FASTEST:g} m/s; correct it or its unit"
        )
    return value


def _check_times(t: np.ndarray, places: list[int], gaps: str, faults: Faults) -> None:
    """Order of the times, and gaps once they are in order; rows with a faulty time are left aside."""
    known = np.flatnonzero(np.isfinite(t))
    t, lines = t[known], [places[i] for i in known]
    wrong = np.flatnonzero(np.diff(t) <= 0)
    for i in wrong:
        what = "is also that of" if t[i + 1] == t[i] else f"comes after {t[i]:.9g} s of"
        advice = "sort the lines" if t[i + 1] < t[i] else "keep one of them"
        faults.found.append((lines[i + 1], f"time {t[i + 1]:.9g} s {what} line {lines[i]}; {advice}"))
    if wrong.size or gaps == "interpolate" or faults.found:
        return
    for i in gaps_in(t):
        faults.found.append((
            lines[i + 1],
            f"a gap before it: {t[i + 1] - t[i]:.6g} s since line {lines[i]}, more than {GAP:g} times the usual step "
            f"of {np.median(np.diff(t)):.6g} s; fill in what is missing, or accept it with gaps='interpolate'",
        ))  # fmt: skip


def _raise(faults: Faults) -> None:
    """Raise for the first faults; those of a hopeless file are not all listed."""
    more = len(faults.found) - _LISTED
    if more > 0:
        kept = sorted(faults.found)[:_LISTED]
        faults.found[:] = [*kept, (kept[-1][0] + 1, f"and {more} more from here on")]
    faults.raise_any()
