"""Ranges from grids of rates whose zeros are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rainwind.engineering.vibration_ranges import unstable_ranges

SPEED = np.array([4.0, 6.0, 8.0, 10.0, 12.0])
NAN = np.nan


def ranges(*rate: float, onset: float = NAN) -> tuple[float, float, bool]:
    low, high, opened = unstable_ranges(np.array(rate)[None, None], SPEED, np.array([[onset]]))
    return float(low[0, 0]), float(high[0, 0]), bool(opened[0, 0])


def test_a_linear_rate_gives_its_zeros() -> None:
    assert ranges(-1.0, 1.0, 2.0, 1.0, -3.0) == (pytest.approx(5.0), pytest.approx(10.5), False)


def test_a_range_begins_where_the_rivulet_begins() -> None:
    assert ranges(NAN, NAN, 1.0, 1.0, -1.0, onset=7.25) == (pytest.approx(7.25), pytest.approx(11.0), False)


def test_a_stable_gap_lies_inside_the_range() -> None:
    assert ranges(-1.0, 1.0, -1.0, 1.0, -1.0) == (pytest.approx(5.0), pytest.approx(11.0), False)


def test_the_end_of_the_grid_leaves_the_range_open() -> None:
    assert ranges(-1.0, -1.0, 1.0, 1.0, 1.0) == (pytest.approx(7.0), pytest.approx(12.0), True)
    assert ranges(1.0, -1.0, -1.0, -1.0, -1.0) == (pytest.approx(4.0), pytest.approx(5.0), False)


def test_a_rivulet_that_vanishes_ends_the_range_there() -> None:
    assert ranges(NAN, 1.0, 1.0, NAN, NAN, onset=5.0) == (pytest.approx(5.0), pytest.approx(8.0), False)


def test_nothing_unstable_is_nan() -> None:
    low, high, opened = ranges(-1.0, -1.0, NAN, -1.0, -1.0)
    assert np.isnan(low)
    assert np.isnan(high)
    assert not opened


@given(st.lists(st.floats(-1.0, 1.0), min_size=5, max_size=5))
def test_every_unstable_speed_lies_in_the_range(rate: list[float]) -> None:
    low, high, _ = ranges(*rate)
    unstable = SPEED[np.array(rate) > 0]
    if unstable.size:
        assert low <= unstable.min() <= unstable.max() <= high
    else:
        assert np.isnan(low)
