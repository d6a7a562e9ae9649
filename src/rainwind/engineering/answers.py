"""What an assessment says: frozen records of a mode, a stay and a bridge; every model value is a band."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rainwind.engineering.bridge import Bridge
from rainwind.engineering.cable import Cable

__all__ = ["Band", "BridgeAnswer", "CodeCheck", "ModeAnswer", "StayAnswer", "Verdict"]

Verdict = Literal["sufficient", "doubtful", "insufficient", "failed"]
"""sufficient: model and code rule both find enough damping; doubtful: they disagree, or the band decides;
insufficient: both find too little; failed: could not be computed."""


@dataclass(frozen=True)
class Band:
    """Where a value lies over the samples: 5, 50 and 95 % of those in which it exists (nan: in none).

    share: of the samples in which it exists, 0 to 1.
    """

    low: float
    middle: float
    high: float
    share: float = 1.0

    @classmethod
    def of(cls, values: np.ndarray) -> "Band":
        """The band of samples (m,), of which nan means that the value does not exist."""
        values = np.asarray(values, dtype=float)
        there = values[~np.isnan(values)]
        if not there.size:
            return cls(np.nan, np.nan, np.nan, 0.0)
        low, middle, high = np.quantile(there, (0.05, 0.5, 0.95))
        return cls(float(low), float(middle), float(high), there.size / max(values.size, 1))

    @property
    def exists(self) -> bool:
        """Whether the value exists in any sample."""
        return self.share > 0.0


@dataclass(frozen=True)
class CodeCheck:
    """One criterion of a code or guideline: the stay's value beside the limit.

    rule: short name such as "PTI"; sense: "at least" or "at most"; source: key of `sources.SOURCES`.
    """

    rule: str
    what: str
    value: float
    limit: float
    unit: str
    sense: Literal["at least", "at most"]
    passes: bool
    source: str


@dataclass(frozen=True, eq=False)
class ModeAnswer:
    """One mode of one stay. Speeds in m/s at the site's reference height, directions where the wind comes from.

    frequency_in, frequency_out: Hz, in and out of the cable's plane. damping_own, damping_total: ratios without and
    with dampers. scruton: of the total damping, by the name of the definition. speed_low, speed_high: (d, 3) of each
    direction (d,) in rad, the band (5, 50, 95 %) of the range in which the upper rivulet is unstable, nan for none;
    share: (d,) of samples with such a range. worst_direction: rad, that which needs the most damping.
    range_low, range_high: over all directions; unlimited: share of samples in which the range reaches the highest
    speed looked at. amplitude: half peak to peak, m, the largest at any speed in the worst direction, in the range
    where rivulets have been observed; speeds (k,) and amplitudes (k, 3): its band over speed. amplitude_undamped,
    amplitudes_undamped: without the stay's dampers, None where it has none. damping_needed: ratio above which no
    direction and speed is unstable; damping_needed_observed: the same over the observed speeds only. rule_damping:
    ratio that the PTI rule asks for.
    lost: (k,) share of samples that lose their rivulet before a steady vibration; their amplitude is the largest
    until then. build_up: s from a tenth of a diameter to the amplitude. stroke, force: of the damper, m and N.
    uplift: mean displacement of mid-span upwards by the wind's lift, m. hours: a year, in the range with rain, None
    without climate; hours_observed: those of them at observed speeds; hours_dry: in the range without rain. cycles:
    expected a year, the mean over samples, in bins between `cycle_edges` (m), the last one open.
    stability_needed (n, 3): over stability_speeds (n,), the band of the damping ratio below which small vibrations grow
    there, in the worst direction, to first order in the damping; 0 where none is needed or no rivulet is.
    """

    number: int
    frequency_in: float
    frequency_out: float
    damping_own: float
    damping_total: float
    scruton: Mapping[str, float]
    directions: np.ndarray
    speed_low: np.ndarray
    speed_high: np.ndarray
    share: np.ndarray
    worst_direction: float
    range_low: Band
    range_high: Band
    unlimited: float
    damping_needed: Band
    damping_needed_observed: Band
    rule_damping: float
    speeds: np.ndarray
    amplitudes: np.ndarray
    amplitude: Band
    build_up: Band
    uplift: Band
    lost: np.ndarray | None = None
    amplitudes_undamped: np.ndarray | None = None
    amplitude_undamped: Band | None = None
    stroke: Band | None = None
    force: Band | None = None
    hours: Band | None = None
    hours_dry: Band | None = None
    hours_observed: Band | None = None
    cycle_edges: np.ndarray | None = None
    cycles: np.ndarray | None = None
    stability_speeds: np.ndarray | None = None
    stability_needed: np.ndarray | None = None
    galloping_speed: float = np.nan
    vortex_speed: float = np.nan

    @property
    def margin(self) -> float:
        """The damping there is over the damping needed over the observed speeds, at the band's high end."""
        needed = self.damping_needed_observed.high
        return self.damping_total / needed if needed > 0 else np.inf


@dataclass(frozen=True, eq=False)
class StayAnswer:
    """One stay: its modes, the code checks, what was assumed and what it all means in sentences.

    failure: why it could not be computed, "" if it could.
    """

    cable: Cable
    modes: tuple[ModeAnswer, ...]
    checks: tuple[CodeCheck, ...]
    verdict: Verdict
    sentences: tuple[str, ...]
    assumptions: tuple[str, ...] = ()
    failure: str = ""

    @property
    def margin(self) -> float:
        """The least of its modes; nan where it failed."""
        return min((mode.margin for mode in self.modes), default=np.nan)

    @property
    def worst(self) -> ModeAnswer | None:
        """The mode with the least margin."""
        return min(self.modes, key=lambda mode: mode.margin, default=None)


@dataclass(frozen=True, eq=False)
class BridgeAnswer:
    """The whole bridge: one answer a stay, in the bridge's order.

    case_text: the input file as it was read; seconds: that the computation took; interrupted: by the user, stays that
    were not reached are missing. climate_notes: gaps and doubled stamps of the records, in sentences.
    """

    bridge: Bridge
    stays: tuple[StayAnswer, ...]
    seconds: float
    case_text: str = ""
    interrupted: bool = False
    climate_notes: tuple[str, ...] = ()
