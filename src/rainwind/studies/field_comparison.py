"""The assessment of each stay and rig on which rain-wind vibrations were observed.

Every case is assessed with its own observed speeds as those that decide on direction, amplitude and damping. One
coefficient set, with as many samples as a report takes of each of three: sets move the bands less than samples do.
"""

from dataclasses import dataclass

import numpy as np

from rainwind.engineering.answers import Band, ModeAnswer, StayAnswer
from rainwind.engineering.assessment import assess
from rainwind.engineering.bridge import Bridge, Limits, Question
from rainwind.engineering.inflow import yaw
from rainwind.engineering.observed import Observed, observed_cases

__all__ = ["DIRECTIONS", "RUNS", "SAMPLES", "SETS", "TOP", "Comparison", "Result", "compute"]

TOP = 40.0  # m/s, the highest speed looked at
DIRECTIONS, SAMPLES, RUNS, SETS = 24, 32, 12, ("reconstructed",)
_NEARLY_ALL = 0.9


@dataclass(frozen=True, eq=False)
class Comparison:
    """One case: what was seen, and the assessment of it with the observed speeds as the ones that decide."""

    case: Observed
    answer: StayAnswer

    @property
    def modes(self) -> tuple[ModeAnswer, ...]:
        """As many as are compared."""
        return self.answer.modes

    def onset(self, mode: ModeAnswer) -> Band:
        """The lowest unstable wind speed in any direction, over f D."""
        per = mode.frequency_out * self.case.cable.diameter
        low = mode.range_low
        return Band(low.low / per, low.middle / per, low.high / per, low.share)

    def amplitude(self, mode: ModeAnswer) -> Band:
        """Half peak to peak at the observed speeds, in diameters."""
        d, a = self.case.cable.diameter, mode.amplitude
        return Band(a.low / d, a.middle / d, a.high / d, a.share)

    def worst_yaw(self, mode: ModeAnswer) -> float:
        """In which most damping is needed at the observed speeds, rad; nan where half the samples need none."""
        if not mode.damping_needed_observed.middle > 0:
            return np.nan
        return float(yaw(mode.worst_direction, self.case.cable.heading))

    def yaws(self, mode: ModeAnswer) -> tuple[tuple[float, float], ...]:
        """Ranges of yaw, rad, in which half the samples have begun to vibrate at the highest speed observed.

        From the bands: nearly all samples vibrate at some speed, and the middle one's begins below that.
        """
        gamma, first = np.unique(
            np.round(yaw(mode.directions, self.case.cable.heading), 9), return_index=True
        )
        begun = (mode.share[first] >= _NEARLY_ALL) & (mode.speed_low[first, 1] <= self.case.speeds[1])
        edges = np.flatnonzero(np.diff(np.concatenate([[0], begun.astype(int), [0]])))
        return tuple((float(gamma[i]), float(gamma[j - 1])) for i, j in edges.reshape(-1, 2))

    def onset_at_seen_yaw(self, mode: ModeAnswer) -> tuple[float, float, float] | None:
        """The band of the onset, m/s, in the direction nearest to the middle of the yaws observed."""
        if self.case.yaw is None:
            return None
        gamma = np.asarray(yaw(mode.directions, self.case.cable.heading))
        nearest = int(np.abs(gamma - 0.5 * sum(self.case.yaw)).argmin())
        low, middle, high = mode.speed_low[nearest]
        return float(low), float(middle), float(high)


@dataclass(frozen=True, eq=False)
class Result:
    """All cases, in the order of `observed_cases`."""

    cases: tuple[Comparison, ...]

    def named(self, name: str) -> Comparison:
        """One case by its name. Raises KeyError."""
        return {one.case.name: one for one in self.cases}[name]


def compute(cases: tuple[Observed, ...] | None = None, *, workers: int | None = None) -> Result:
    """Assess every case; cases: None for all observed ones."""
    return Result(tuple(_compared(case, workers) for case in (cases or observed_cases())))


def _compared(case: Observed, workers: int | None) -> Comparison:
    # a rig at one yaw rises off north, and the four quarters have its yaw and the opposite one only
    fixed = case.cable.heading != 0.0
    question = Question(
        modes=case.modes,
        directions=4 if fixed else DIRECTIONS,
        speeds=(3.0, TOP),
        sets=SETS,
        samples=SAMPLES,
        runs=RUNS,
    )
    bridge = Bridge(
        case.name, (case.cable,), case.site, limits=Limits(observed_speeds=case.speeds), question=question
    )
    return Comparison(case, assess(bridge, workers=workers).stays[0])
