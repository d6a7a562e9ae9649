"""Hours and cycles a year: entries counted by hand, nothing lost, and the sum over entries done the slow way."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rainwind.engineering.climate import HOURS, Climate, cycles, exposure, wind_rose
from rainwind.errors import InputError

FOUR = 2 * pi * np.arange(4) / 4
SPEEDS = [4.0, 6.0, 8.0, 10.0, 6.0, 0.0]
DEGREES = [0, 90, 90, 180, 350, 0]
HAND = Climate(
    np.array(SPEEDS), np.radians(DEGREES), np.array([1, 1, 0, 1, 1, 0], dtype=bool),
    np.array([1.0, 2, 4, 8, 16, 32]), 10.0,
)  # fmt: skip


def compass(count: int) -> np.ndarray:
    return 2 * pi * np.arange(count) / count


def ranges(low: float, high: float, count: int = 4) -> tuple[np.ndarray, np.ndarray]:
    return np.full(count, low), np.full(count, high)


@st.composite
def climates(draw: st.DrawFn) -> Climate:
    size = draw(st.integers(1, 30))
    of = lambda values: np.array(draw(st.lists(values, min_size=size, max_size=size)))  # noqa: E731
    hours = of(st.floats(0.1, 100.0))
    return Climate(
        of(st.floats(0, 40)), of(st.floats(0, 7)), of(st.booleans()), HOURS * hours / hours.sum(), 10.0
    )


def test_hours_by_hand():
    found = exposure(HAND, FOUR, *ranges(6, 8))
    assert (found.wet_hours, found.dry_hours, found.hours) == (18, 4, 22)
    low = np.array([0, np.nan, 10, 0])
    high = np.array([4, np.nan, 10, 40])
    found = exposure(HAND, FOUR, low, high)  # both bounds count in
    assert (found.wet_hours, found.dry_hours) == (1 + 8, 32)
    found = exposure(HAND, FOUR, *ranges(9, 15), factor=1.5)
    assert found.wet_hours == 2 + 8 + 16, "6 m/s at the anemometer are 9 here"
    assert found.dry_hours == 4
    found = exposure(HAND, FOUR, np.array([7.0, 7, 7, 7]), np.array([6.9, 6, 1, 0]))
    assert found.hours == 0, "a range turned round holds nothing"


def test_one_range_for_each_sample():
    low = np.column_stack([ranges(0, 0)[0], np.full(4, 6.0), np.full(4, np.nan)])
    found = exposure(HAND, FOUR, low, np.full((4, 3), 8.0))
    assert found.wet_hours.tolist() == [19, 18, 0]
    assert found.dry_hours.tolist() == [36, 4, 0]


@pytest.mark.parametrize(
    ("degrees", "sector"),
    [(0, 0), (4.99, 0), (5, 1), (14.9, 1), (15, 2), (354.9, 35), (355, 0), (359.99, 0), (360, 0), (-4, 0)],
)
def test_edges_of_sectors(degrees: float, sector: int):
    one = Climate(np.array([5.0]), np.array([radians(degrees)]), np.array([True]), np.array([HOURS]), 10.0)
    (found,) = np.flatnonzero(wind_rose(one, compass(36), np.array([0, 10])).hours.sum(axis=1))
    assert found == sector


@pytest.mark.parametrize("count", [36, 90])  # 90: two of them lie below half way in floating point
def test_half_way_is_clockwise_all_round_in_spite_of_rounding(count: int):
    half = (np.arange(count) + 0.5) * 360 / count
    one = Climate(np.full(count, 5.0), np.radians(half), np.ones(count), np.ones(count), 10.0)
    assert np.all(wind_rose(one, compass(count), np.array([0, 10])).hours == 1)


def test_rose_by_hand_with_calms_apart():
    rose = wind_rose(HAND, FOUR, np.array([0.0, 6.0, 8.0]))
    assert rose.hours.tolist() == [[1, 16], [0, 2 + 4], [0, 8], [0, 0]], (
        "faster than 8 m/s is in the last bin"
    )
    assert rose.calm == 32
    assert wind_rose(HAND, FOUR, np.array([0.0, 20]), wet=True).hours[:, 0].tolist() == [17, 2, 8, 0]
    dry = wind_rose(HAND, FOUR, np.array([5.0, 20]), wet=False)
    assert (dry.hours[:, 0].tolist(), dry.calm) == ([0, 4, 0, 0], 32)
    assert wind_rose(HAND, FOUR, np.array([5.0, 20])).calm == 33


def test_cycles_by_hand():
    speeds, amplitude = np.array([5.0, 9.0]), np.array([0.1, 0.3])
    counts = cycles(HAND, FOUR, *ranges(4, 10), speeds, amplitude, 2.0, np.array([0, 0.12, 0.2, 0.25]))
    # 4 m/s: as at 5, 0.1 m; 6 m/s: 0.15 m; 10 m/s: as at 9, 0.3 m, beyond the last edge
    assert counts == pytest.approx(np.array([1, 2 + 16, 8]) * 7200)
    low = np.array([np.nan, 0, np.nan, np.nan])
    counts = cycles(HAND, FOUR, low, ranges(0, 40)[1], speeds, amplitude, 2.0, np.array([0, 0.12, 0.2]))
    assert counts == pytest.approx([0, 2 * 7200])


@given(climates(), st.integers(1, 48))
def test_all_hours_make_a_year(climate: Climate, count: int):
    found = exposure(climate, compass(count), *ranges(0, 50, count))
    assert found.hours == pytest.approx(HOURS)
    assert found.wet_hours == pytest.approx(HOURS * climate.wet_share)
    rose = wind_rose(climate, compass(count), np.array([0.0, 3, 6, 20]))
    assert rose.hours.sum() + rose.calm == pytest.approx(HOURS)


@given(climates(), st.floats(0, 30), st.floats(0, 10), st.floats(0, 5), st.floats(0, 5))
@settings(max_examples=60)
def test_hours_grow_with_the_range(climate: Climate, low: float, wide: float, below: float, above: float):
    less = exposure(climate, FOUR, *ranges(low, low + wide))
    more = exposure(climate, FOUR, *ranges(low - below, low + wide + above))
    assert more.wet_hours >= less.wet_hours - 1e-9
    assert more.dry_hours >= less.dry_hours - 1e-9
    assert less.wet_hours >= 0


@given(climates(), st.floats(0.3, 3), st.integers(0, 2**31))
@settings(max_examples=60)
def test_the_sum_over_entries_done_one_by_one(climate: Climate, factor: float, seed: int):
    rng = np.random.default_rng(seed)
    low = rng.uniform(0, 20, (12, 3))
    high = low + rng.uniform(-2, 20, (12, 3))
    low[rng.random((12, 3)) < 0.2] = np.nan
    expected = np.zeros((2, 3))
    sectors = [int(d / (2 * pi / 12) + 0.5 + 1e-9) % 12 for d in climate.direction]
    for v, d, wet, h in zip(climate.speed, sectors, climate.wet, climate.hours, strict=True):
        for k in range(3):
            if low[d, k] <= v * factor <= high[d, k]:
                expected[0 if wet else 1, k] += h
    found = exposure(climate, compass(12), low, high, factor=factor)
    assert found.wet_hours == pytest.approx(expected[0], abs=1e-6)
    assert found.dry_hours == pytest.approx(expected[1], abs=1e-6)
    alone = [exposure(climate, compass(12), *_only(low, high, d)).wet_hours for d in range(12)]
    assert np.sum(alone, axis=0) == pytest.approx(
        exposure(climate, compass(12), low, high).wet_hours, abs=1e-6
    )


def _only(low: np.ndarray, high: np.ndarray, d: int) -> tuple[np.ndarray, np.ndarray]:
    chosen = np.full_like(low, np.nan)
    chosen[d] = low[d]
    return chosen, high


@given(climates())
def test_cycles_are_those_of_the_wet_hours(climate: Climate):
    speeds = np.linspace(5, 18, 5)
    edges = np.linspace(0, 0.3, 7)
    counts = cycles(climate, FOUR, *ranges(5, 15), speeds, np.linspace(0, 0.5, 5), 1.5, edges)
    wet = exposure(climate, FOUR, *ranges(5, 15)).wet_hours
    assert counts.sum() == pytest.approx(wet * 5400, abs=1e-6)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"speed": [1.0, 2.0]}, "of one length"),
        ({"speed": [-1.0]}, "0 or more"),
        ({"hours": [np.nan]}, "0 or more"),
        ({"hours": [0.0]}, "all 0"),
        ({"direction": [np.nan]}, "must be finite"),
        ({"speed": [], "direction": [], "wet": [], "hours": []}, "1 or more"),
    ],
)
def test_arrays_that_do_not_fit(changed: dict[str, list[float]], message: str):
    good = {"speed": [1.0], "direction": [0.0], "wet": [True], "hours": [1.0]}
    with pytest.raises(InputError, match=message):
        Climate(**{k: np.array(v) for k, v in (good | changed).items()}, height=10.0)


def test_questions_that_do_not_fit():
    with pytest.raises(InputError, match="evenly round the compass"):
        exposure(HAND, FOUR + 0.1, *ranges(0, 1))
    with pytest.raises(InputError, match=r"shapes \(3,\) and \(4,\)"):
        exposure(HAND, FOUR, np.zeros(3), np.zeros(4))
    with pytest.raises(InputError, match="each of the 4 directions"):
        exposure(HAND, FOUR, np.zeros(3), np.zeros(3))
    for edges in ([5.0], [0.0, 2.0, 2.0]):
        with pytest.raises(InputError, match="edges of a wind rose"):
            wind_rose(HAND, FOUR, np.array(edges))
