"""What is odd about records of wind and rain, in sentences: nothing is dropped in silence."""

from dataclasses import dataclass

import numpy as np

__all__ = ["Odd", "record_notes"]

_GAP = 1.5  # steps
_YEAR = 8766.0  # h, with leap days
_LEAST, _MANY = 0.95, 5.0  # years
_UNEVEN = 0.01  # share of the steps


@dataclass(frozen=True)
class Odd:
    """How many records came late, have a time that another one has, lack the wind, lack the rain."""

    unsorted: int = 0
    doubled: int = 0
    without_wind: int = 0
    without_rain: int = 0


def record_notes(
    time: np.ndarray, step: float, odd: Odd, coverage: float, look_back: float
) -> tuple[str, ...]:
    """The sentences. time: (n,) s, sorted, each once; step: s, the usual one; coverage: share of the time."""
    steps = np.diff(time)
    gaps = steps[steps > _GAP * step]
    span = (float(time[-1] - time[0]) + step) / 3600.0
    said = [
        f"{_count(time.size, 'record')}, one every {_duration(step)}, over {_count(round(span / 24), 'day')}; "
        f"{100 * coverage:.1f} % of that time has wind."
    ]
    if odd.unsorted:
        said.append(f"Out of order: {_count(odd.unsorted, 'record')}, sorted here.")
    if odd.doubled:
        said.append(
            f"Times that stand twice: {odd.doubled}; the first record of each counts. Clocks set back in autumn do "
            "that: times in UTC do not."
        )
    if gaps.size:
        missing = float(np.sum(gaps - step))
        said.append(
            f"Gaps: {gaps.size}, {_duration(missing)} in all, the longest {_duration(float(gaps.max()) - step)}; the "
            "hours a year are scaled up for them, as if the wind had been as at other times."
        )
    uneven = float(np.mean(np.abs(steps - step) > 0.01 * step)) if steps.size else 0.0
    if uneven > _UNEVEN and uneven > 2 * gaps.size / steps.size:
        said.append(
            f"The step is uneven: {100 * uneven:.0f} % of the steps are not {_duration(step)}. A record stands for the "
            f"time until the next one, at most for {_duration(step)}."
        )
    if odd.without_wind:
        said.append(f"Without speed or direction: {_count(odd.without_wind, 'record')}, left out.")
    if odd.without_rain:
        said.append(f"Without a number of the rain: {_count(odd.without_rain, 'record')}; they count as dry.")
    if 0 < look_back < step:
        said.append(
            f"The look-back of {_duration(look_back)} is shorter than the step: it reaches no record before."
        )
    if coverage < 0.5:
        said.append("Less than half of the time has wind: are there two different steps in the file?")
    if span < _LEAST * _YEAR:
        said.append("It is less than a year: seasons are missing.")
    elif span < _MANY * _YEAR and 0.1 < span / _YEAR % 1 < 0.9:
        said.append(f"It is {span / _YEAR:.1f} years: some seasons count more than others.")
    return tuple(said)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _duration(seconds: float) -> str:
    return f"{seconds / 3600:.3g} h" if seconds >= 3600 else f"{seconds / 60:.3g} min"
