"""A joint table of wind and rain, hours a year of each direction and bin of speed, as a climate."""

import numpy as np

from rainwind.engineering.bridge import ClimateSource
from rainwind.engineering.climate import HOURS, Climate
from rainwind.io.climate_cells import Cells
from rainwind.io.usual import FASTEST

__all__ = ["TABLE", "table_climate"]

TABLE = ("speed_low_m_s", "speed_high_m_s", "direction_deg", "hours_per_year", "wet_hours_per_year")
_PARTS = 10  # of a bin of speed, each with the same hours
_ACROSS = 6  # of a sector
_LEAST = 0.98  # of a year


def table_climate(cells: Cells, source: ClimateSource) -> Climate:
    """The hours of a bin are spread evenly over its speeds and over its sector.

    A sector is as wide as the least angle between two directions of the table. Raises CaseError with the first ten
    faults: a missing cell, a bin twice, more wet hours than hours, more hours than a year has.
    """
    for name in TABLE:
        if cells.header.count(name) != 1:
            say = "two columns" if name in cells.header else "no column"
            cells.fault(cells.header_line, f"{say} {name}; a joint table has {','.join(TABLE)}")
    cells.raise_any()
    low, high = (cells.numbers(name, 0.0, FASTEST) for name in TABLE[:2])
    direction = cells.numbers("direction_deg", 0.0, 360.0) % 360.0
    hours, wet = (cells.numbers(name, 0.0, HOURS * 1.01) for name in TABLE[3:])
    cells.raise_any()
    _check(cells, low, high, direction, hours, wet)
    cells.raise_any()

    width = _width(direction)
    along = (np.arange(_PARTS) + 0.5) / _PARTS
    across = ((np.arange(_ACROSS) + 0.5) / _ACROSS - 0.5) * width
    shape = (len(low), _PARTS, _ACROSS)
    speed = np.broadcast_to((low[:, None] + (high - low)[:, None] * along)[:, :, None], shape).ravel()
    angle = np.broadcast_to(((direction[:, None] + across) % 360.0)[:, None, :], shape).ravel()
    parts = _PARTS * _ACROSS
    total = float(hours.sum())
    return Climate(
        np.tile(speed, 2),
        np.radians(np.tile(angle, 2)),
        np.repeat([True, False], speed.size),
        np.concatenate([np.repeat(part / parts, parts) for part in (wet, hours - wet)]),
        source.height,
        min(1.0, total / HOURS),
        tuple(_notes(total, float(wet.sum()), width)),
    )


def _check(
    cells: Cells, low: np.ndarray, high: np.ndarray, direction: np.ndarray, hours: np.ndarray, wet: np.ndarray
) -> None:
    seen: dict[tuple[float, float, float], int] = {}
    for i, line in enumerate(cells.lines):
        if np.isnan([low[i], high[i], direction[i], hours[i], wet[i]]).any():
            cells.fault(line, f"a cell is missing; every row needs {', '.join(TABLE)}")
            continue
        bin_ = (low[i], high[i], direction[i])
        if bin_ in seen:
            cells.fault(line, f"the same bin stands in line {seen[bin_]}; keep one of them")
        seen.setdefault(bin_, line)
        if low[i] >= high[i]:
            cells.fault(line, f"speed_low_m_s = {low[i]:g} must be below speed_high_m_s = {high[i]:g}")
        if wet[i] > hours[i]:
            cells.fault(line, f"wet_hours_per_year = {wet[i]:g} is more than hours_per_year = {hours[i]:g}")
    if not cells.found and hours.sum() > 1.01 * HOURS:
        cells.fault(
            cells.lines[-1],
            f"all hours make {hours.sum():.6g}, more than a year has, {HOURS:g}; correct them",
        )
    if not cells.found and hours.sum() == 0:
        cells.fault(cells.lines[-1], "all hours are 0; give the hours a year of each bin")


def _width(direction: np.ndarray) -> float:
    """Degrees of a sector; 0 where all rows have one direction."""
    there = np.unique(direction)
    return float(np.diff(there, append=there[0] + 360.0).min()) if there.size > 1 else 0.0


def _notes(total: float, wet: float, width: float) -> list[str]:
    said = [f"A joint table of {total:.0f} hours a year, {wet:.0f} of them with rain."]
    if width:
        said.append(f"Its sectors are {width:g} degrees wide; hours are spread evenly over each.")
    if total < _LEAST * HOURS:
        said.append(f"It leaves out {HOURS - total:.0f} hours of the year; they count as calm.")
    return said
