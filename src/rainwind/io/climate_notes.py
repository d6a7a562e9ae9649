"""What is odd about records of wind and rain, in sentences: nothing is dropped in silence."""

import numpy as np

__all__ = ["record_notes"]

_GAP = 1.5  # steps
_YEAR = 8760.0
_LEAST = 0.95


def record_notes(
    time: np.ndarray, step: float, unsorted_: int, doubled: int, without_wind: int, without_rain: int
) -> tuple[tuple[str, ...], float]:
    """The sentences, and the share of the time from the first to the last record that is covered.

    time: (n,) s, sorted, each once; step: s, between records. unsorted_, doubled, without_wind, without_rain: counts.
    """
    steps = np.diff(time)
    gaps = steps[steps > _GAP * step]
    missing = float(np.sum(gaps - step)) / 3600.0
    span = (float(time[-1] - time[0]) + step) / 3600.0
    coverage = min(1.0, (span - missing - without_wind * step / 3600.0) / span)
    said = [
        f"{time.size} records every {_step(step)}, {span / 24:.0f} days, {100 * coverage:.1f} % of them covered."
    ]
    if unsorted_:
        said.append(f"{unsorted_} records were out of order and were sorted.")
    if doubled:
        said.append(f"{doubled} records have a time that an earlier one has; the earlier one counts.")
    if gaps.size:
        said.append(
            f"{gaps.size} gaps, {missing:.0f} hours in all, the longest {gaps.max() / 3600.0:.3g} hours; hours a "
            "year are scaled by the time covered."
        )
    if without_wind:
        said.append(f"{without_wind} records lack speed or direction and are left out.")
    if without_rain:
        said.append(f"{without_rain} records lack the rain; they count as dry.")
    if span < _LEAST * _YEAR:
        said.append(f"The records span {span / 24:.0f} days, less than a year: seasons are missing.")
    return tuple(said), coverage


def _step(seconds: float) -> str:
    return f"{seconds / 3600:g} h" if seconds >= 3600 else f"{seconds / 60:g} min"
