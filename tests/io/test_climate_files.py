"""Climate files: a record counted by hand, a joint table beside its records, every fault with its line."""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rainwind.engineering.bridge import ClimateSource
from rainwind.engineering.climate import HOURS, Climate, exposure
from rainwind.errors import CaseError
from rainwind.io.climate_cells import ABSENT
from rainwind.io.climate_files import read_climate

HEADER = "time,speed_m_s,direction_deg,rain_mm_h\n"
TABLE = "speed_low_m_s,speed_high_m_s,direction_deg,hours_per_year,wet_hours_per_year\n"
BY_HAND: list[tuple[Any, ...]] = [  # hour of 1 March 2025, speed, direction, rain
    (0, 5.0, 0, 0.0),
    (1, 6.0, 360, 0.5),  # wet
    (2, 7.0, 355, 0.0),  # wet, one hour after
    (3, 8.0, 90, 0.01),  # wet, two hours after; 0.01 is not more than the threshold
    (4, 9.0, 180, 0.0),
    (5, 10.0, 270, 0.02),  # wet
]


def records(rows: list[tuple[Any, ...]] = BY_HAND, header: str = HEADER, sep: str = ",") -> str:
    lines = [sep.join(map(str, (f"2025-03-01T{hour:02d}:00", *more))) for hour, *more in rows]
    return header + "\n".join(lines) + "\n"


def read(folder: Path, text: str, **source: float) -> Climate:
    path = folder / "climate.csv"
    path.write_text(text, encoding="utf-8")
    return read_climate(replace(ClimateSource(path), **source))


def fault(folder: Path, text: str) -> str:
    """The one fault of a file, without its head."""
    with pytest.raises(CaseError) as error:
        read(folder, text)
    head, *rest = str(error.value).splitlines()
    assert head.startswith(f"{folder / 'climate.csv'}: ")
    if not rest:
        return head.partition(": ")[2]
    (only,) = rest
    assert head.endswith(": 1 fault")
    return only.strip()


def same(one: Climate, other: Climate) -> bool:
    return all(
        np.allclose(getattr(one, f), getattr(other, f), rtol=1e-12, atol=0)
        for f in ("speed", "direction", "wet", "hours")
    )


def test_a_record_by_hand(tmp_path: Path):
    found = read(tmp_path, records(), height=55.0)
    assert found.speed.tolist() == [5, 6, 7, 8, 9, 10]
    assert np.degrees(found.direction) == pytest.approx([0, 0, 355, 90, 180, 270])
    assert found.wet.tolist() == [False, True, True, True, False, True]
    assert found.hours == pytest.approx([HOURS / 6] * 6)
    assert (found.height, found.coverage) == (55, 1)
    assert found.wet_share == pytest.approx(4 / 6)
    assert found.notes == (
        "6 records, one every 1 h, over 0 days; 100.0 % of that time has wind.",
        "It is less than a year: seasons are missing.",
        "Wind up to 10 m/s, rain up to 0.5 mm/h.",
    )


@pytest.mark.parametrize(
    ("look_back", "threshold", "wet"),
    [
        (0.0, 0.01, [0, 1, 0, 0, 0, 1]),
        (3599.0, 0.01, [0, 1, 0, 0, 0, 1]),
        (3600.0, 0.01, [0, 1, 1, 0, 0, 1]),
        (7199.0, 0.01, [0, 1, 1, 0, 0, 1]),
        (1e6, 0.01, [0, 1, 1, 1, 1, 1]),
        (7200.0, 0.0, [0, 1, 1, 1, 1, 1]),
        (7200.0, 0.02, [0, 1, 1, 1, 0, 0]),
        (7200.0, 0.5, [0, 0, 0, 0, 0, 0]),
    ],
)
def test_look_back_and_threshold(look_back: float, threshold: float, wet: list[int], tmp_path: Path):
    found = read(tmp_path, records(), look_back=look_back, rain_threshold=threshold)
    assert found.wet.astype(int).tolist() == wet
    assert any("reaches no record" in note for note in found.notes) == (look_back == 3599.0)


@pytest.mark.parametrize(
    ("header", "sep"),
    [
        ("Time;Speed [m/s];Direction [°];Rain [mm/h]\n", ";"),
        ("time_utc\tspeed (m/s)\tdirection_deg\train_mm_h\n", "\t"),
        ("# from a mast\n\ntime, speed_m_s, direction_deg, rain_mm_h\n  # and so on\n", ", "),
        ("\ufefftime,speed_m_s,direction_deg,rain_mm_h,,\n", ","),
        ('"time","speed_m_s","direction_deg","rain_mm_h"\n', ","),
    ],
)
def test_ways_to_write_the_same(header: str, sep: str, tmp_path: Path):
    assert same(read(tmp_path, records(header=header, sep=sep)), read(tmp_path, records()))


def test_other_columns_trailing_separators_quotes_and_empty_rows(tmp_path: Path):
    text = "\n".join(f'{line.replace("T", " ")},12.5,"a, b",,' for line in records().splitlines()[1:])
    text = HEADER.strip() + ",temperature,remark\n" + text.replace("\n", "\n,,,,,\n# comment\n") + "\n"
    assert same(read(tmp_path, text), read(tmp_path, records()))


def test_kilometres_per_hour(tmp_path: Path):
    rows = [(hour, speed * 3.6, *rest) for hour, speed, *rest in BY_HAND]
    header = "time,speed [km/h],direction_deg,rain_mm_h\n"
    assert same(read(tmp_path, records(rows, header)), read(tmp_path, records()))
    assert read(tmp_path, records([(0, 360, 0, 0)], header)).speed == pytest.approx([100])
    assert "it must be 0 to 360" in fault(tmp_path, records([(0, 361, 0, 0)], header))


def test_rain_of_ten_minutes_is_a_rate(tmp_path: Path):
    rains = [0, 0.002, 0, 0.001]  # mm in ten minutes: 0.012 and 0.006 mm/h
    text = "time,speed_m_s,direction_deg,rain [mm]\n" + "".join(
        f"2025-03-01T00:{10 * i:02d}Z,5,0,{rain}\n" for i, rain in enumerate(rains)
    )
    found = read(tmp_path, text, look_back=600.0)
    assert found.wet.tolist() == [False, True, True, False]
    assert found.notes[0].startswith("4 records, one every 10 min")
    assert found.notes[-1].endswith("rain up to 0.012 mm/h.")


def test_gaps_are_scaled_away_and_told(tmp_path: Path):
    rows = [BY_HAND[i] for i in (0, 1, 5)]  # hours 2, 3, 4 are missing
    found = read(tmp_path, records(rows))
    assert found.hours == pytest.approx([HOURS / 3] * 3)
    assert found.coverage == pytest.approx(3 / 6)
    assert found.notes[1].startswith("Gaps: 1, 3 h in all, the longest 3 h; the hours a year are scaled up")


def test_rain_reaches_across_a_gap_within_the_look_back(tmp_path: Path):
    rows = [BY_HAND[i] for i in (1, 3, 4)]
    assert read(tmp_path, records(rows)).wet.tolist() == [True, True, False]


def test_unsorted_and_doubled(tmp_path: Path):
    rows = [BY_HAND[i] for i in (3, 0, 1, 2, 5, 4)]
    rows.insert(5, (5, 99.0, 99, 99.0))
    found = read(tmp_path, records(rows))
    assert same(found, read(tmp_path, records()))
    assert found.notes[1] == "Out of order: 4 records, sorted here."
    assert found.notes[2].startswith("Times that stand twice: 1; the first record of each counts.")


def test_the_hour_that_comes_twice_in_autumn_and_zones(tmp_path: Path):
    hours = [
        "2025-10-26T01:00+02:00",
        "2025-10-26T02:00+02:00",
        "2025-10-26T02:00+01:00",
        "2025-10-26T02:00Z",
    ]
    text = HEADER + "".join(f"{time},{5 + i},0,0\n" for i, time in enumerate(hours))
    found = read(tmp_path, text)
    assert found.speed.tolist() == [5, 6, 7, 8]
    assert (len(found.notes), found.coverage) == (3, 1), "with zones nothing is odd"
    found = read(tmp_path, text.replace("+02:00", "").replace("+01:00", "").replace("Z", ""))
    assert found.speed.tolist() == [5, 6]
    assert "Times that stand twice: 2;" in found.notes[1]
    assert "UTC" in found.notes[1]


@pytest.mark.parametrize("absent", [*ABSENT, "", " ", "NaN", "NA", "null", "-", "999.0", "-9999.00"])
def test_missing_numbers(absent: object, tmp_path: Path):
    rows = [*BY_HAND, (6, absent, 5, 0), (7, 5.0, absent, 0), (8, 5.0, 5, absent), (9, 0.0, absent, 0)]
    found = read(tmp_path, records(rows))
    assert found.speed.tolist() == [5, 6, 7, 8, 9, 10, 5, 0]
    assert found.wet.tolist()[-2:] == [False, False], "two hours after hour 5 the rain is past"
    assert found.hours == pytest.approx([HOURS / 8] * 8)
    assert found.coverage == pytest.approx(8 / 10)
    assert "Without speed or direction: 2 records, left out." in found.notes
    assert "Without a number of the rain: 1 record; they count as dry." in found.notes


def test_rain_without_wind_still_wets_the_records_after(tmp_path: Path):
    rows = [(0, 5.0, 0, 0.0), (1, "", 0, 3.0), (2, 5.0, 0, 0.0), (3, 5.0, 0, 0.0), (4, 5.0, 0, 0.0)]
    assert read(tmp_path, records(rows)).wet.tolist() == [False, True, True, False]


def test_special_records_between_hours_stand_for_less(tmp_path: Path):
    minutes = [0, 60, 120, 135, 140, 180, 240, 300]
    text = HEADER + "".join(f"2025-03-01T{m // 60:02d}:{m % 60:02d},5,0,0\n" for m in minutes)
    found = read(tmp_path, text)
    assert found.hours == pytest.approx(np.array([60, 60, 15, 5, 40, 60, 60, 60]) * HOURS / 360)
    assert "43 % of the steps are not 1 h" in found.notes[1]
    assert found.coverage == 1


def test_a_whole_year_has_no_note_but_its_size_and_extremes(tmp_path: Path):
    times = np.datetime64("2025-01-01T00:00") + np.arange(8760) * np.timedelta64(1, "h")
    text = HEADER + "".join(f"{time},5.5,10,0.2\n" for time in times)
    found = read(tmp_path, text)
    assert len(found.notes) == 2
    assert found.hours == pytest.approx(np.ones(8760))
    half = text.splitlines(keepends=True) + [
        f"{time + np.timedelta64(8760, 'h')},6,20,0\n" for time in times[:4380]
    ]
    assert any(
        "It is 1.5 years: some seasons count more" in note for note in read(tmp_path, "".join(half)).notes
    )


def test_a_joint_table_and_the_records_that_it_counts(tmp_path: Path):
    rng = np.random.default_rng(3)
    count = 4000
    speed, degrees = rng.integers(0, 80, count) / 4 + 0.125, rng.integers(0, 36, count) * 10
    wet = rng.random(count) < 0.1
    times = np.datetime64("2025-01-01T00:00") + np.arange(count) * np.timedelta64(1, "h")
    rows = zip(times, speed, degrees, wet.astype(int), strict=True)
    text = HEADER + "".join(f"{t},{v},{d},{r}\n" for t, v, d, r in rows)
    of_records = read(tmp_path, text, look_back=0.0)

    hour = HOURS / count
    low = np.floor(speed / 2) * 2
    bins = sorted(set(zip(low, degrees, strict=True)))
    table = TABLE
    for v, d in bins:
        there = (low == v) & (degrees == d)
        table += f"{v},{v + 2},{d},{there.sum() * hour!r},{(there & wet).sum() * hour!r}\n"
    of_table = read(tmp_path, table.replace("np.float64(", "").replace(")", ""))
    assert of_table.hours.sum() == pytest.approx(HOURS)
    assert of_table.wet_share == pytest.approx(of_records.wet_share)
    directions = 2 * pi * np.arange(36) / 36
    edges = rng.integers(0, 10, (36, 5)) * 2.0  # ranges that end where bins do
    ends = edges + rng.integers(0, 5, (36, 5)) * 2.0
    one, other = (exposure(climate, directions, edges, ends) for climate in (of_records, of_table))
    assert one.wet_hours.min() > 0
    assert other.wet_hours == pytest.approx(one.wet_hours)
    assert other.dry_hours == pytest.approx(one.dry_hours)


def test_a_table_by_hand(tmp_path: Path):
    found = read(tmp_path, TABLE + "4,6,0,999,99\n6,8,180,7761,1000\n")
    assert found.hours.sum() == pytest.approx(8760), "999 hours are no missing number"
    assert found.wet_share == pytest.approx(1099 / 8760)
    north = exposure(found, np.zeros(1), np.array([4.0]), np.array([5.0]))
    assert (north.wet_hours, north.dry_hours) == (pytest.approx(49.5), pytest.approx(450))
    quarters = exposure(found, 2 * pi * np.arange(4) / 4, np.zeros(4), np.array([9.0, 0, 0, 0]))
    assert quarters.hours == pytest.approx(999 / 2), "half of a sector of 180 degrees lies about north"
    assert found.notes == (
        "A joint table of 8760 hours a year, 1099 of them with rain.",
        "Its sectors are 180 degrees wide; hours are spread evenly over each.",
    )
    part = read(tmp_path, TABLE + "4,6,40,100,10\n")
    assert part.notes[-1] == "It leaves out 8660 hours of the year; they count as calm."
    assert part.hours.sum() == pytest.approx(100)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty; the first line names the columns: time,speed_m_s,direction_deg,rain_mm_h"),
        ("# nothing\n\n", "is empty;"),
        (HEADER, "has a header and no records;"),
        (records([(0, 5, 400, 0)]), "line 2: direction_deg = 400 is not allowed: it must be 0 to 360"),
        (records([(0, 5, -1, 0)]), "line 2: direction_deg = -1 is not allowed"),
        (records([(0, 100.5, 0, 0)]), "line 2: speed_m_s = 100.5 is not allowed: it must be 0 to 100"),
        (records([(0, -0.5, 0, 0)]), "line 2: speed_m_s = -0.5 is not allowed"),
        (records([(0, 5, 0, -0.2)]), "line 2: rain_mm_h = -0.2 is not allowed: it must be 0 to 1000"),
        (records([(0, "inf", 0, 0)]), "line 2: speed_m_s = inf is not allowed"),
        (records([(0, "calm", 0, 0)]), "line 2: speed_m_s = 'calm' is not a number; correct it, or leave it empty"),
        (records([(0, "5,5", 0, 0)], HEADER.replace(",", ";"), ";"), "is not a number; write a decimal point"),
        (records([(0, "5,5", 0, 0)]), "line 2: has 5 cells where the header names 4; write decimals with a point"),
        (records() + "2025-03-01T06:00,5\n", "line 8: has 2 cells where the header names 4"),
        (records([(24, 5, 0, 0)]), "line 2: time = '2025-03-01T24:00' is no time"),
        (HEADER + "31.1.2026 14:00,5,0,0\n", "is no time; write it as in 2026-01-31T14:00"),
        (records() + "2025-03-01T06:00Z,5,0,0\n", "line 8: the time has a zone, and that of line 2 has none; give all"),
        ("# one\ntime,speed_m_s,rain_mm_h\n2025-03-01,5,0\n", "line 2: no column gives the direction from which"),
        ("time,speed,direction_deg,rain_mm_h\n2025-03-01,5,0,0\n", "name one speed_m_s or speed_km_h, as in"),
        ("time,speed_m_s,direction_deg,rain_mm_h,rain_mm\n2025-03-01,5,0,0,0\n", "columns give the rain: rain_mm_h"),
        ("time,speed_m_s,speed_m_s,direction_deg,rain_mm\n2025-03-01,5,6,0,0\n", "line 1: 2 columns give the wind"),
        (records([(0, "", 0, 0)]), "no record has both speed and direction; check the columns"),
        (records([(0, 5, "", 0)]), "no record has both speed and direction; check the columns"),
        (records([(0, 5, 0, "")]), "no record has the rain; check the columns"),
        (TABLE + "4,6,0,9000,0\n", "hours_per_year = 9000 is not allowed"),
        (TABLE + "4,6,0,8000,0\n6,8,0,1000,0\n", "line 3: all hours make 9000, more than a year has, 8760"),
        (TABLE + "4,6,0,10,11\n", "line 2: wet_hours_per_year = 11 is more than hours_per_year = 10"),
        (TABLE + "6,6,0,10,1\n", "line 2: speed_low_m_s = 6 must be below speed_high_m_s = 6"),
        (TABLE + "4,6,0,10,\n", "line 2: a cell is missing; every row needs speed_low_m_s"),
        (TABLE + "4,6,0,10,1\n4,6,360,10,1\n", "line 3: the same bin stands in line 2"),
        (TABLE + "4,6,0,0,0\n", "all hours are 0"),
        (TABLE.replace("wet_", "rainy_") + "4,6,0,10,1\n", "line 1: no column wet_hours_per_year; a joint table has"),
    ],
)  # fmt: skip
def test_faults(text: str, message: str, tmp_path: Path):
    assert message in fault(tmp_path, text)


def test_first_ten_faults_and_the_count_of_all(tmp_path: Path):
    rows = [(i, "x" if i % 2 else 5, 400, 0) for i in range(20)]
    with pytest.raises(CaseError) as error:
        read(tmp_path, records(rows))
    head, *rest = str(error.value).splitlines()
    assert head.endswith("climate.csv: 30 faults, the first 10 of them:")
    assert [int(line.split(":")[0].split()[1]) for line in rest] == [2, 3, 3, 4, 5, 5, 6, 7, 7, 8]


def test_files_that_cannot_be_read(tmp_path: Path):
    with pytest.raises(CaseError, match="no such file"):
        read_climate(ClimateSource(tmp_path / "none.csv"))
    with pytest.raises(CaseError, match="a folder"):
        read_climate(ClimateSource(tmp_path))
    (tmp_path / "latin.csv").write_bytes("time;direction [°]".encode("latin-1"))
    with pytest.raises(CaseError, match="not a text file in UTF-8"):
        read_climate(ClimateSource(tmp_path / "latin.csv"))


_CELLS = st.one_of(
    st.sampled_from(["", "5", "360", "-1", "1e400", "1e-300", "NaN", '"', '"a,b"', "2025-03-01T01:00", "x"]),
    st.sampled_from(["0001-01-01T00:00+14:00", "9999-12-31T23:59-14:00", "2025-03-01T02:00Z", "1_0", "٣", "\x00"]),
    st.text(max_size=4),
)  # fmt: skip


@given(st.sampled_from([HEADER, TABLE]), st.lists(st.lists(_CELLS, min_size=3, max_size=6), max_size=6))
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_text_is_a_climate_or_a_fault(tmp_path: Path, header: str, rows: list[list[str]]):
    text = header + "\n".join(",".join(row) for row in rows)
    try:
        found = read(tmp_path, text)
    except CaseError as error:
        said = str(error)
    else:
        said = ""
        assert found.hours.sum() <= HOURS * 1.01
        assert 0 < found.coverage <= 1
        assert found.notes
    assert not said or said.startswith(f"{tmp_path / 'climate.csv'}: ")
