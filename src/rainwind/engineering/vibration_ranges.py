"""Between which wind speeds small vibrations grow: ranges of many samples and directions from a grid of rates."""

import numpy as np

__all__ = ["unstable_ranges"]


def unstable_ranges(
    rate: np.ndarray, speed: np.ndarray, onset: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The lowest and the highest unstable speed, each (s, g), nan where nothing grows; and whether the range is open.

    rate: (s, g, n) in 1/s over speed (n,), nan without an upper rivulet; onset: (s, g), the speed from which it is
    there, nan without one. A range that begins where the rivulet begins starts at the onset; between two points of
    the grid the rate is taken as linear. Ranges with a stable gap count as one, from the first to the last unstable
    speed. open (s, g): the highest speed of the grid is unstable.
    """
    unstable = np.nan_to_num(rate, nan=-1.0) > 0.0
    any_ = unstable.any(axis=-1)
    n = speed.size
    first = unstable.argmax(axis=-1)
    last = n - 1 - unstable[..., ::-1].argmax(axis=-1)
    low = _edge(rate, speed, first, first - 1)
    high = _edge(rate, speed, last, last + 1)
    # no rivulet at the neighbour below: it begins in between, already unstable
    before = np.take_along_axis(rate, np.maximum(first - 1, 0)[..., None], -1)[..., 0]
    born = (first > 0) & np.isnan(before) & np.isfinite(onset)
    low = np.where(born, np.clip(onset, speed[np.maximum(first - 1, 0)], speed[first]), low)
    opened = any_ & (last == n - 1)
    return np.where(any_, low, np.nan), np.where(any_, high, np.nan), opened


def _edge(rate: np.ndarray, speed: np.ndarray, inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """The speed at which the rate passes zero between two neighbours; the inner one at the grid's end or beside nan."""
    there = (outside >= 0) & (outside < speed.size)
    beyond = np.clip(outside, 0, speed.size - 1)
    a = np.take_along_axis(rate, inside[..., None], -1)[..., 0]
    b = np.take_along_axis(rate, beyond[..., None], -1)[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(there & np.isfinite(b), a / (a - b), 0.0)
    return speed[inside] + np.nan_to_num(np.clip(share, 0.0, 1.0)) * (speed[beyond] - speed[inside])
