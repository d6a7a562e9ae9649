"""Climate files in: records of wind and rain, or a joint table of hours, as CSV.

Records: `time,speed_m_s,direction_deg,rain_mm_h`, hourly or every ten minutes. A joint table:
`speed_low_m_s,speed_high_m_s,direction_deg,hours_per_year,wet_hours_per_year`. The header tells which. Headers may
carry their unit in brackets, `speed [m/s]`. Lines that begin with # are comments.
"""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path

import numpy as np

from rainwind.engineering.bridge import ClimateSource
from rainwind.engineering.climate import HOURS, Climate
from rainwind.errors import CaseError
from rainwind.io.climate_notes import record_notes
from rainwind.io.faults import Faults
from rainwind.io.stay_tables import key_of_header
from rainwind.io.units import has_decimal_comma
from rainwind.io.usual import FASTEST

__all__ = ["read_climate"]

_SPEEDS = {"speed_m_s": 1.0, "speed_km_h": 1 / 3.6}
_RAINS = ("rain_mm_h", "rain_mm")
_RECORDS = "time,speed_m_s,direction_deg,rain_mm_h"
_TABLE = ("speed_low_m_s", "speed_high_m_s", "direction_deg", "hours_per_year", "wet_hours_per_year")
_MISSING = {"", "na", "nan", "null", "none", "-", "999", "-999", "9999", "-9999", "999.9", "-999.9"}
_LISTED = 10  # faults; the rest of a hopeless file is counted
_PARTS = 10  # of a speed bin of a joint table, each with the same hours


def read_climate(source: ClimateSource) -> Climate:
    """The climate of a file, with the height, look-back and threshold of `source`.

    A record is wet if it, or one within the look-back before it, has more rain than the threshold. Every record that
    has wind stands for the same part of a year. What is left out or put in order is told in `notes`. Raises CaseError
    with the first ten faults by line: no number, a direction beyond 360 degrees, a speed below 0 or above 100 m/s.
    """
    faults = Faults(str(source.path), {})
    lines = _lines(source.path)
    if len(lines) < 2:
        what = "has a header and no records" if lines else "is empty"
        raise CaseError(f"{source.path}: {what}; the first line names the columns: {_RECORDS}")
    header = [key_of_header(cell) for cell in lines[0][1]]
    table = "hours_per_year" in header
    _check_header(header, table, lines[0][0], faults)
    _raise(faults)
    rows = [(line, dict(zip(header, cells, strict=False))) for line, cells in lines[1:]]
    climate = _table(rows, source, faults) if table else _records(rows, header, source, faults)
    _raise(faults)
    if climate is None:
        raise CaseError(f"{source.path}: no record has both speed and direction; check the columns")
    return climate


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise CaseError(f"{path}: no such file; name a CSV file of wind and rain") from error
    except UnicodeDecodeError as error:
        raise CaseError(f"{path}: not a text file in UTF-8; save it as CSV in UTF-8") from error
    except OSError as error:
        reason = "a folder" if path.is_dir() else error.strerror
        raise CaseError(f"{path}: cannot be read ({reason}); name a CSV file of wind and rain") from error
    kept = [
        (i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"
    ]
    parts = max(",;\t", key=kept[0][1].count) if kept else ","
    return [(i, [cell.strip() for cell in next(csv.reader([line], delimiter=parts))]) for i, line in kept]


def _check_header(header: Sequence[str], table: bool, line: int, faults: Faults) -> None:
    if table:
        for name in _TABLE:
            if name not in header:
                faults.found.append((line, f"no column {name}; a joint table has {','.join(_TABLE)}"))
        return
    for names, what in (
        (("time",), "the time, such as 2026-01-31T14:00"),
        (tuple(_SPEEDS), "the wind speed"),
        (("direction_deg",), "the direction from which the wind comes"),
        (_RAINS, "the rain"),
    ):
        found = [name for name in names if name in header]
        if len(found) != 1:
            say = "two columns give" if found else "no column gives"
            faults.found.append((line, f"{say} {what}; write one of {', '.join(names)} as in {_RECORDS}"))


@dataclass(frozen=True)
class _Cells:
    """The numbers of rows, nan where one is missing."""

    rows: list[tuple[int, dict[str, str]]]
    faults: Faults

    def column(self, name: str, low: float, high: float) -> np.ndarray:
        """One column; what is no number, or outside low to high, is a fault."""
        found = np.full(len(self.rows), np.nan)
        for i, (line, cells) in enumerate(self.rows):
            text = cells.get(name, "")
            if text.lower() in _MISSING:
                continue
            try:
                value = float(text)
            except ValueError:
                advice = (
                    "write a decimal point" if has_decimal_comma(text) else "correct it, or leave it empty"
                )
                self.faults.found.append((line, f"{name} = {text!r} is not a number; {advice}"))
                continue
            if not isfinite(value) or not low <= value <= high:
                self.faults.found.append(
                    (line, f"{name} = {text} is not allowed: it must be {low:g} to {high:g}")
                )
                continue
            found[i] = value
        return found


def _records(
    rows: list[tuple[int, dict[str, str]]], header: Sequence[str], source: ClimateSource, faults: Faults
) -> Climate | None:
    cells = _Cells(rows, faults)
    unit = next(name for name in _SPEEDS if name in header)
    rain_name = next(name for name in _RAINS if name in header)
    speed = cells.column(unit, 0.0, FASTEST / _SPEEDS[unit]) * _SPEEDS[unit]
    direction = cells.column("direction_deg", 0.0, 360.0)
    rain = cells.column(rain_name, 0.0, 1000.0)
    time = _times(rows, faults)
    if faults.found:
        return None
    order = np.argsort(time, kind="stable")
    doubled = np.concatenate([[False], np.diff(time[order]) == 0])
    kept = order[~doubled]
    unsorted_ = int(np.sum(np.diff(time) < 0))
    time, speed, direction, rain = time[kept], speed[kept], direction[kept], rain[kept]
    step = float(np.median(np.diff(time))) if time.size > 1 else 3600.0
    if rain_name == "rain_mm":
        rain = rain * 3600.0 / step
    wet = _wet(time, np.nan_to_num(rain) > source.rain_threshold, source.look_back)
    there = np.isfinite(speed) & (np.isfinite(direction) | (speed == 0))
    if not there.any():
        return None
    notes, coverage = record_notes(
        time, step, unsorted_, int(doubled.sum()), int(np.sum(~there)), int(np.sum(np.isnan(rain)))
    )
    hours = np.full(int(there.sum()), HOURS / there.sum())
    angle = np.radians(np.nan_to_num(direction[there]) % 360.0)
    return Climate(speed[there], angle, wet[there], hours, source.height, coverage, notes)


def _times(rows: list[tuple[int, dict[str, str]]], faults: Faults) -> np.ndarray:
    """Seconds of each row's stamp, those without a zone as if all were of one zone."""
    found = np.full(len(rows), np.nan)
    zones = set()
    for i, (line, cells) in enumerate(rows):
        text = cells.get("time", "")
        try:
            stamp = datetime.fromisoformat(text)
        except ValueError:
            faults.found.append((line, f"time = {text!r} is no time; write such as 2026-01-31T14:00"))
            continue
        zones.add(stamp.tzinfo is None)
        found[i] = (stamp.replace(tzinfo=UTC) if stamp.tzinfo is None else stamp).timestamp()
    if len(zones) > 1:
        faults.found.append(
            (rows[0][0], "some times have a zone and others have none; give all of them one, or none")
        )
    return found


def _wet(time: np.ndarray, rains: np.ndarray, look_back: float) -> np.ndarray:
    """Whether it rained at the record or in the look-back before it."""
    at = time[rains]
    if not at.size:
        return np.zeros(time.shape, dtype=bool)
    last = np.searchsorted(at, time, side="right") - 1
    return (last >= 0) & (time - at[np.maximum(last, 0)] <= look_back)


def _table(rows: list[tuple[int, dict[str, str]]], source: ClimateSource, faults: Faults) -> Climate | None:
    """A joint table: the hours of a bin are spread evenly over its speeds."""
    cells = _Cells(rows, faults)
    low, high = (cells.column(f"speed_{end}_m_s", 0.0, FASTEST) for end in ("low", "high"))
    direction = cells.column("direction_deg", 0.0, 360.0)
    hours, wet = (cells.column(name, 0.0, HOURS * 1.01) for name in _TABLE[3:])
    for i, (line, _) in enumerate(rows):
        if np.isnan([low[i], high[i], direction[i], hours[i], wet[i]]).any():
            faults.found.append((line, f"a cell is missing; every row needs {', '.join(_TABLE)}"))
        elif low[i] >= high[i]:
            faults.found.append(
                (line, f"speed_low_m_s = {low[i]:g} must be below speed_high_m_s = {high[i]:g}")
            )
        elif wet[i] > hours[i]:
            faults.found.append(
                (line, f"wet_hours_per_year = {wet[i]:g} is more than hours_per_year = {hours[i]:g}")
            )
    if not faults.found and hours.sum() > 1.01 * HOURS:
        faults.found.append(
            (rows[0][0], f"all hours make {hours.sum():.6g}, more than a year has, {HOURS:g}")
        )
    if faults.found:
        return None
    parts = (np.arange(_PARTS) + 0.5) / _PARTS
    speed = (low[:, None] + (high - low)[:, None] * parts).ravel()
    angle = np.repeat(np.radians(direction % 360.0), _PARTS)
    each = [np.repeat(h / _PARTS, _PARTS) for h in (wet, hours - wet)]
    notes = (f"A joint table of {hours.sum():.0f} hours a year, {wet.sum():.0f} of them with rain.",)
    return Climate(
        np.tile(speed, 2), np.tile(angle, 2), np.repeat([True, False], speed.size), np.concatenate(each),
        source.height, min(1.0, float(hours.sum() / HOURS)), notes,
    )  # fmt: skip


def _raise(faults: Faults) -> None:
    """Raise for the first faults; those of a hopeless file are not all listed."""
    more = len(faults.found) - _LISTED
    if more > 0:
        kept = sorted(faults.found)[:_LISTED]
        faults.found[:] = [*kept, (kept[-1][0] + 1, f"and {more} more from here on")]
    faults.raise_any()
