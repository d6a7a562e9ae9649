"""Writes climate.csv beside this file: a SYNTHETIC year of hourly wind and rain. Nobody measured it.

Made up to look like the coast of the Gulf of Mexico: sea breeze from south-east most of the year, "northers" behind
cold fronts from October to April, rain in events that come with stronger wind. It shows how a climate file is used;
it says nothing about the site of any bridge.
"""

import sys
from math import erf, sqrt
from pathlib import Path

import numpy as np

HOURS = 8760
SEED = 2026
COMMENT = "# SYNTHETIC: made up by make_climate.py, seed 2026; no station measured this. Times are UTC, wind at 10 m."


def wander(rng: np.random.Generator, hours: float) -> np.ndarray:
    """A normal random walk back to 0 with unit spread, which forgets within so many hours: (HOURS,)."""
    keep = np.exp(-1 / hours)
    found = np.empty(HOURS)
    found[0] = rng.standard_normal()
    for i, kick in enumerate(rng.standard_normal(HOURS - 1)):
        found[i + 1] = keep * found[i] + np.sqrt(1 - keep**2) * kick
    return found


def events(rng: np.random.Generator, apart: float, hours: float) -> np.ndarray:
    """Whether an event is on, (HOURS,): for `hours` on average, and `apart` hours on average between two."""
    on = np.zeros(HOURS, dtype=bool)
    i = 0.0
    while i < HOURS:
        i += rng.exponential(apart)
        last = i + max(1.0, rng.exponential(hours))
        on[int(i) : int(np.ceil(last))] = True
        i = last
    return on


def make() -> str:
    """The text of climate.csv."""
    rng = np.random.default_rng(SEED)
    hour = np.arange(HOURS)
    winter = 0.5 + 0.5 * np.cos(2 * np.pi * (hour / 24 - 15) / 365)
    norther = events(rng, apart=150, hours=40) & (winter > 0.35)
    rain = events(rng, apart=60, hours=4.5)

    # speed: Weibull with shape 2, its scale larger in the afternoon, behind fronts and in rain
    scale = 4.9 * (1 + 0.22 * np.cos(2 * np.pi * (hour - 21) / 24)) * np.where(norther, 1.35, 1.0)
    scale = scale * np.where(rain, 1.35, 1.0)
    even = 0.5 * (1 + np.array([erf(x / sqrt(2)) for x in wander(rng, 9.0)]))
    speed = scale * np.sqrt(-np.log1p(-np.clip(even, 0, 1 - 1e-9)))

    # direction: about 145 degrees, or 5 behind a front; wide in light wind
    middle = np.where(norther, 5.0, 145.0)
    width = np.where(norther, 25.0, 38.0) * (1 + 2.0 * np.exp(-speed / 1.5))
    direction = np.round((middle + width * wander(rng, 14.0)) / 10) * 10 % 360

    amount = np.where(rain, np.maximum(0.2, rng.gamma(0.6, 3.0, HOURS)), 0.0)
    start = np.datetime64("2025-01-01T00:00")
    lines = [COMMENT, "time_utc,speed_m_s,direction_deg,rain_mm_h"]
    for i in range(HOURS):
        wet = f"{amount[i]:.1f}" if amount[i] else "0"
        lines.append(f"{start + np.timedelta64(i, 'h')},{speed[i]:.1f},{direction[i]:.0f},{wet}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("climate.csv")
    out.write_text(make(), encoding="utf-8", newline="\n")
