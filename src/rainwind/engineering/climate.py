"""Wind and rain of a site: how many hours a year the wind lies in a range, with rain and without.

    hours = 8760 sum over (speed, direction) of p(speed, direction) p(rain | speed, direction) [speed in the range]

from records of both at once, never from independent factors: rain comes with its own wind. Source: textbook formula.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from rainwind.errors import InputError

__all__ = ["HOURS", "Climate", "Exposure", "WindRose", "cycles", "exposure", "wind_rose"]

HOURS = 8760.0
"""Of a year."""
_HALF_WAY = 1e-9  # of a sector: 5 degrees between 0 and 10 is half way also after rounding


@dataclass(frozen=True, eq=False)
class Climate:
    """Entries (n,) of wind: speed in m/s at `height` (m), direction from which it comes in rad clockwise from north,
    wet: whether rivulets may be there, hours: that the entry stands for in a year.

    coverage: share of the time from the first to the last record that has one. notes: gaps, doubled stamps, values
    that were missing, in sentences. Raises InputError for arrays that do not fit each other.
    """

    speed: np.ndarray
    direction: np.ndarray
    wet: np.ndarray
    hours: np.ndarray
    height: float
    coverage: float = 1.0
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name, kind in (("speed", float), ("direction", float), ("wet", bool), ("hours", float)):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=kind))
        shapes = {getattr(self, name).shape for name in ("speed", "direction", "wet", "hours")}
        if len(shapes) != 1 or len(self.speed.shape) != 1 or not self.speed.size:
            raise InputError(
                f"speed, direction, wet and hours must be of one length of 1 or more, not {sorted(shapes)}"
            )
        if not all(np.all(np.isfinite(a)) and np.all(a >= 0) for a in (self.speed, self.hours)):
            raise InputError("speed and hours of a climate must be 0 or more, and finite")
        if not np.all(np.isfinite(self.direction)):
            raise InputError("directions of a climate must be finite; a calm may have any, such as 0")
        if not self.hours.sum() > 0:
            raise InputError("the hours of a climate are all 0; give the hours that each entry stands for")

    @property
    def wet_share(self) -> float:
        """The share of the hours in which rivulets may be there."""
        return float(self.hours[self.wet].sum() / self.hours.sum())


@dataclass(frozen=True, eq=False)
class Exposure:
    """Hours a year in the range: with rain, without; numbers, or arrays (s,) for ranges of s samples."""

    wet_hours: np.ndarray
    dry_hours: np.ndarray

    @property
    def hours(self) -> np.ndarray:
        """With rain or without."""
        return self.wet_hours + self.dry_hours


def exposure(
    climate: Climate, directions: np.ndarray, low: np.ndarray, high: np.ndarray, *, factor: float = 1.0
) -> Exposure:
    """Hours a year in which the wind lies between low and high, m/s, of the nearest direction.

    directions: (d,) rad, evenly round the compass from north; low, high: (d,) or (d, s), nan for no range. factor: the
    wind to which low and high belong over that of the climate. Bounds count in. Raises InputError.
    """
    sector = _sectors(climate, directions)
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    if low.shape != high.shape or low.shape[:1] != np.shape(directions):
        raise InputError(
            f"low and high have the shapes {low.shape} and {high.shape}; give one range for each of the "
            f"{len(directions)} directions"
        )
    columns = (low.reshape(len(directions), -1), high.reshape(len(directions), -1))
    wet, dry = (
        _hours_between(climate.speed[chosen] * factor, sector[chosen], climate.hours[chosen], *columns)
        for chosen in (climate.wet, ~climate.wet)
    )
    shape = low.shape[1:]
    return Exposure(np.reshape(wet, shape), np.reshape(dry, shape))


def _hours_between(
    speed: np.ndarray, sector: np.ndarray, hours: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """The hours (s,) in which the speed lies in the range of its sector, low and high (d, s): entries sorted once."""
    total = np.zeros(low.shape[1])
    order = np.lexsort((speed, sector))
    bounds = np.searchsorted(sector[order], np.arange(len(low) + 1))
    for d in np.flatnonzero(np.diff(bounds)):
        there = order[bounds[d] : bounds[d + 1]]
        summed = np.concatenate([[0.0], np.cumsum(hours[there])])
        first = np.searchsorted(speed[there], low[d], side="left")
        last = np.searchsorted(speed[there], high[d], side="right")
        known = low[d] <= high[d]  # not where one is nan
        total += np.where(known, summed[last] - summed[first], 0.0)
    return total


def cycles(
    climate: Climate,
    directions: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    speeds: np.ndarray,
    amplitude: np.ndarray,
    frequency: float,
    edges: np.ndarray,
    *,
    factor: float = 1.0,
) -> np.ndarray:
    """Cycles a year with rain in each bin of amplitude, edges (m + 1,) in m -> (m,).

    In the range of each direction, low and high (d,), the stay is taken to vibrate with amplitude (k,) over speeds (k,)
    at its frequency, Hz; beyond the speeds with that of the nearest one. What lies beyond the edges counts in the bin
    next to it. Full vibration from the first minute of rain: more than there will be. Raises InputError.
    """
    sector = _sectors(climate, directions)
    speed = climate.speed * factor
    there = climate.wet & (speed >= low[sector]) & (speed <= high[sector])
    found = np.interp(speed[there], speeds, amplitude)
    found = np.clip(found, edges[0], edges[-1])
    counts, _ = np.histogram(found, edges, weights=climate.hours[there] * 3600.0 * frequency)
    return counts


@dataclass(frozen=True, eq=False)
class WindRose:
    """Hours a year: (d, m) of directions (d,) rad and bins of speed between edges (m + 1,) in m/s.

    calm: hours below the first edge and those without any wind, which come from no direction.
    """

    directions: np.ndarray
    edges: np.ndarray
    hours: np.ndarray
    calm: float = 0.0


def wind_rose(
    climate: Climate,
    directions: np.ndarray,
    edges: np.ndarray,
    *,
    wet: bool | None = None,
    factor: float = 1.0,
) -> WindRose:
    """The hours of each direction and speed; wet: only with rain (True) or without (False). Raises InputError.

    A bin holds its lower edge. What is faster than the last edge counts in the last bin.
    """
    sector = _sectors(climate, directions)
    edges = np.asarray(edges, dtype=float)
    if edges.ndim != 1 or edges.size < 2 or not np.all(np.diff(edges) > 0):
        raise InputError("edges of a wind rose must be two speeds or more, each above the one before")
    chosen = np.ones(climate.speed.shape, dtype=bool) if wet is None else climate.wet == wet
    speed = climate.speed * factor
    blowing = chosen & (speed > 0) & (speed >= edges[0])
    hours, _, _ = np.histogram2d(
        sector[blowing],
        np.minimum(speed[blowing], edges[-1]),
        (np.arange(len(directions) + 1) - 0.5, edges),
        weights=climate.hours[blowing],
    )
    calm = float(climate.hours[chosen & ~blowing].sum())
    return WindRose(np.asarray(directions), edges, hours, calm)


def _sectors(climate: Climate, directions: np.ndarray) -> np.ndarray:
    """The number of the nearest direction of each entry; half way between two the clockwise one."""
    count = len(directions)
    if count < 1 or not np.allclose(directions, 2 * pi * np.arange(count) / count):
        raise InputError("directions must go evenly round the compass, from north clockwise")
    return np.floor(climate.direction / (2 * pi / count) + 0.5 + _HALF_WAY).astype(int) % count
