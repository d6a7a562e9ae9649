"""Climate files in: records of wind and rain, or a joint table of hours, as CSV.

Records: `time,speed_m_s,direction_deg,rain_mm_h`, hourly or every ten minutes. A joint table:
`speed_low_m_s,speed_high_m_s,direction_deg,hours_per_year,wet_hours_per_year`. The header tells which. Headers may
carry their unit in brackets, `speed [m/s]`. Lines that begin with # are comments, other columns are not read.
"""

from datetime import UTC, datetime

import numpy as np

from rainwind.engineering.bridge import ClimateSource
from rainwind.engineering.climate import HOURS, Climate
from rainwind.errors import CaseError
from rainwind.io.climate_cells import ABSENT, Cells, read_cells
from rainwind.io.climate_notes import Odd, record_notes
from rainwind.io.climate_tables import TABLE, table_climate
from rainwind.io.usual import FASTEST

__all__ = ["read_climate"]

_SPEEDS = {"speed_m_s": (1.0, 1.0), "speed_km_h": (1.0, 3.6)}  # factor and divisor to m/s
_RAINS = ("rain_mm_h", "rain_mm")
_TIMES = ("time", "time_utc")
_RECORDS = "time,speed_m_s,direction_deg,rain_mm_h"
_START = datetime(1970, 1, 1)
_START_UTC = datetime(1970, 1, 1, tzinfo=UTC)
_RAINIEST = 1000.0  # mm/h


def read_climate(source: ClimateSource) -> Climate:
    """The climate of a file, with the height, look-back and threshold of `source`.

    A record is wet if it, or one within the look-back before it, has more rain than the threshold. A record stands
    for the time until the next one, at most for the usual step; all that have wind together make a year. What is left
    out or put in order is told in `notes`. Raises CaseError with the first ten faults by line and the count: no
    number, a direction beyond 360 degrees, a speed below 0 or above 100 m/s, a row with a cell too many.
    """
    cells = read_cells(source.path, _RECORDS)
    if any(name in cells.header for name in TABLE if name != "direction_deg"):
        return table_climate(cells, source)
    return _records(cells, source)


def _records(cells: Cells, source: ClimateSource) -> Climate:
    stamp = _one(cells, _TIMES, "the time, such as 2026-01-31T14:00")
    unit = _one(cells, tuple(_SPEEDS), "the wind speed")
    _one(cells, ("direction_deg",), "the direction from which the wind comes")
    fall = _one(cells, _RAINS, "the rain")
    cells.raise_any()
    factor, divisor = _SPEEDS[unit]
    speed = cells.numbers(unit, 0.0, FASTEST * divisor, ABSENT) * factor / divisor
    direction = cells.numbers("direction_deg", 0.0, 360.0, ABSENT)
    rain = cells.numbers(fall, 0.0, _RAINIEST, ABSENT)
    time = _times(cells, stamp)
    cells.raise_any()

    order = np.argsort(time, kind="stable")
    doubled = np.concatenate([[False], np.diff(time[order]) == 0])
    kept = order[~doubled]
    late = int(np.sum(time < np.maximum.accumulate(time)))
    time, speed, direction, rain = time[kept], speed[kept], direction[kept], rain[kept]
    steps = np.diff(time)
    step = float(np.quantile(steps, 0.5, method="lower")) if steps.size else 3600.0
    if fall == "rain_mm":
        rain = rain * 3600.0 / step
    there = np.isfinite(speed) & (np.isfinite(direction) | (speed == 0))
    for known, what in ((there, "both speed and direction"), (np.isfinite(rain), "the rain")):
        if not known.any():
            raise CaseError(f"{source.path}: no record has {what}; check the columns")
    wet = _wet(time, np.nan_to_num(rain) > source.rain_threshold, source.look_back)
    held = np.append(np.minimum(steps, step), step)  # s, that each record stands for
    odd = Odd(late, int(doubled.sum()), int(np.sum(~there)), int(np.sum(np.isnan(rain))))
    coverage = min(1.0, float(held[there].sum() / (time[-1] - time[0] + step)))
    extremes = f"Wind up to {speed[there].max():.3g} m/s, rain up to {np.nanmax(rain):.3g} mm/h."
    return Climate(
        speed[there],
        np.radians(np.nan_to_num(direction[there]) % 360.0),
        wet[there],
        HOURS * held[there] / held[there].sum(),
        source.height,
        coverage,
        (*record_notes(time, step, odd, coverage, source.look_back), extremes),
    )


def _one(cells: Cells, names: tuple[str, ...], what: str) -> str:
    """The one column that gives something; none or two are a fault."""
    found = [name for name in cells.header if name in names]
    if len(found) == 1:
        return found[0]
    if found:
        text = f"{len(found)} columns give {what}: {', '.join(found)}; keep one"
    else:
        there = ", ".join(name for name in cells.header if name)
        text = f"no column gives {what}; name one {' or '.join(names)}, as in {_RECORDS} (there are: {there})"
    cells.fault(cells.header_line, text)
    return ""


def _times(cells: Cells, stamp: str) -> np.ndarray:
    """Seconds of each row's stamp (n,), those without a zone as if all were of one zone."""
    found = np.full(len(cells.rows), np.nan)
    zoned = np.zeros(len(cells.rows), dtype=bool)
    for i, text in enumerate(cells.texts(stamp)):
        try:
            moment = datetime.fromisoformat(text.strip())
            zoned[i] = moment.tzinfo is not None
            found[i] = (moment - (_START_UTC if zoned[i] else _START)).total_seconds()
        except (ValueError, OverflowError):
            cells.fault(
                cells.lines[i], f"time = {text.strip()!r} is no time; write it as in 2026-01-31T14:00"
            )
    zoned_first = bool(zoned[0])
    other = np.flatnonzero((zoned != zoned_first) & np.isfinite(found))
    if np.isfinite(found[0]) and other.size:
        has, had = ("no zone", "one") if zoned_first else ("a zone", "none")
        cells.fault(
            cells.lines[other[0]],
            f"the time has {has}, and that of line {cells.lines[0]} has {had}; give all of them a zone, or none",
        )
    return found


def _wet(time: np.ndarray, rains: np.ndarray, look_back: float) -> np.ndarray:
    """Whether it rained at the record or in the look-back before it, both ends counted in."""
    at = time[rains]
    if not at.size:
        return np.zeros(time.shape, dtype=bool)
    last = np.searchsorted(at, time, side="right") - 1
    return (last >= 0) & (time - at[np.maximum(last, 0)] <= look_back)
