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
        shapes = {np.shape(getattr(self, name)) for name in ("speed", "direction", "wet", "hours")}
        if len(shapes) != 1 or len(next(iter(shapes))) != 1 or not next(iter(shapes))[0]:
            raise InputError(
                f"speed, direction, wet and hours must be of one length of 1 or more, not {sorted(shapes)}"
            )
        if not all(np.all(np.isfinite(a)) and np.all(a >= 0) for a in (self.speed, self.hours)):
            raise InputError("speed and hours of a climate must be 0 or more, and finite")

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
    speed = climate.speed * factor
    columns = (low.reshape(len(directions), -1), high.reshape(len(directions), -1))
    wet, dry = [], []
    for a, b in zip(columns[0].T, columns[1].T, strict=True):
        hours = np.where((speed >= a[sector]) & (speed <= b[sector]), climate.hours, 0.0)
        wet.append(hours[climate.wet].sum())
        dry.append(hours[~climate.wet].sum())
    shape = low.shape[1:]
    return Exposure(np.reshape(wet, shape), np.reshape(dry, shape))


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
    at its frequency, Hz; beyond the speeds with that of the nearest one. What is larger than the last edge counts in
    the last bin. Full vibration from the first minute of rain: more than there will be. Raises InputError.
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
    """Hours a year: (d, m) of directions (d,) rad and bins of speed between edges (m + 1,) in m/s."""

    directions: np.ndarray
    edges: np.ndarray
    hours: np.ndarray


def wind_rose(
    climate: Climate,
    directions: np.ndarray,
    edges: np.ndarray,
    *,
    wet: bool | None = None,
    factor: float = 1.0,
) -> WindRose:
    """The hours of each direction and speed; wet: only with rain (True) or without (False). Raises InputError.

    What is faster than the last edge counts in the last bin; calms below the first edge are left out.
    """
    sector = _sectors(climate, directions)
    chosen = np.ones(climate.speed.shape, dtype=bool) if wet is None else climate.wet == wet
    speed = np.minimum(climate.speed * factor, edges[-1])
    hours, _, _ = np.histogram2d(
        sector[chosen],
        speed[chosen],
        (np.arange(len(directions) + 1) - 0.5, edges),
        weights=climate.hours[chosen],
    )
    return WindRose(np.asarray(directions), np.asarray(edges), hours)


def _sectors(climate: Climate, directions: np.ndarray) -> np.ndarray:
    """The number of the nearest direction of each entry; half way between two the clockwise one."""
    count = len(directions)
    if count < 1 or not np.allclose(directions, 2 * pi * np.arange(count) / count):
        raise InputError("directions must go evenly round the compass, from north clockwise")
    return np.floor(climate.direction / (2 * pi / count) + 0.5).astype(int) % count
