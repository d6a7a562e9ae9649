"""Wind records: units, columns, and each fault at its line."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.errors import CaseError, InputError

GOOD = "# anemometer 3\ntime_s,speed_m_s\n10,8\n10.5,9\n\n11,7.5\n11.5,8\n"


@pytest.fixture
def file(tmp_path):
    def write(text, **options):
        path = tmp_path / "wind.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return rw.read_wind(path, **options)

    return write


def test_time_counts_from_the_first_sample(file):
    wind = file(GOOD)
    assert (wind.speed.since, wind.speed.until, wind.began) == (0.0, 1.5, 10.0)
    assert wind.speed.at([0, 0.5, 0.75, 1.5]).tolist() == [8, 9, 8.25, 8]
    assert wind.vertical_speed is None
    assert list(wind.parameters) == ["wind.speed"]


def test_units_parting_and_other_columns(file):
    text = (
        "\ufeffdirection_deg;vertical_speed_km_h;time_min;speed_km_h\r\n200;-3.6;0;36\r\n210;7.2;0.1;18\r\n"
    )
    wind = file(text)
    assert wind.speed.at([0.0, 6.0]) == pytest.approx([10.0, 5.0], rel=1e-15)
    assert wind.vertical_speed is not None
    assert wind.vertical_speed.at([0.0, 6.0]) == pytest.approx([-1.0, 2.0], rel=1e-15)
    assert set(wind.parameters) <= set(rw.paper_model().parameters)
    assert file("time_s\tspeed_m_s\n0\t1\n1\t2\n").speed.until == 1.0


def test_kind_and_gaps_are_those_of_a_record(file):
    t = np.array([0, 0.5, 1.0, 2.5, 3.0, 3.5, 4.0])
    v = 9 + np.sin(t)
    text = "time_s,speed_m_s\n" + "\n".join(
        f"{a!r},{b!r}" for a, b in zip(t.tolist(), v.tolist(), strict=True)
    )
    with pytest.raises(
        CaseError, match=r"line 5: a gap before it: 1.5 s since line 4, .* usual step of 0.5 s"
    ):
        file(text)
    wind = file(text, kind="spline", gaps="interpolate")
    between = np.linspace(0, 4, 99)
    assert np.array_equal(wind.speed.at(between), rw.record(t, v, "spline", gaps="interpolate").at(between))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty; the first line names the columns: time_s,speed_m_s"),
        ("# only a comment\n", "empty"),
        ("0,8\n1,9\n", "line 1: no column of the time; .* time_s,speed_m_s"),
        ("time_s,wind_speed_m_s\n0,8\n1,9\n", "no column of the speed; .* is 'wind_speed_m_s' meant"),
        ("time,speed_m_s\n0,8\n1,9\n", "column 'time' has no unit; write time_s or time_ms"),
        ("time_s,speed_kn\n0,8\n1,9\n", "column 'speed_kn' has the unit 'kn', which is no unit of a speed"),
        ("time_s,speed_m_s,speed_km_h\n0,8,1\n1,9,1\n", "'speed_km_h' is the second one of the speed"),
        ("time_s,speed_m_s\n0,8\n", "1 rows of numbers; a record needs two"),
        ("time_s,speed_m_s\n0,8\n1,\n2,9\n", "line 3: speed is missing"),
        ("time_s,speed_m_s\n0,8\n1\n2,9\n", "line 3: speed is missing"),
        ("time_s,speed_m_s\n0,8\n1,nan\n2,9\n", "line 3: speed = nan is not a finite number"),
        ("time_s,speed_m_s\n0,8\n1,inf\n2,9\n", "line 3: speed = inf is not a finite number"),
        ("time_s,speed_m_s\n0,8\n1,calm\n2,9\n", "line 3: speed = calm is not a finite number"),
        ("time_s,speed_m_s\n0,8\n#\n1,-9\n2,9\n", "line 4: speed = -9 is not allowed: it must be above 0"),
        ("time_s,speed_m_s\n0,8\n1,0\n2,9\n", "line 3: speed = 0 is not allowed"),
        ("time_s,speed_m_s\n0,8\n1,250\n2,9\n", "line 3: speed = 250 is 250 m/s; allowed is up to 100 m/s"),
        ("time_s;speed_m_s\n0;8,5\n1;9\n", "line 2: speed = 8,5 has a comma; write a decimal point"),
        (
            "time_s,speed_m_s\n0,8\n2,9\n1,9\n3,9\n",
            "line 4: time 1 s comes after 2 s of line 3; sort the lines",
        ),
        (
            "time_s,speed_m_s\n0,8\n1,9\n1,9\n2,9\n",
            "line 4: time 1 s is also that of line 3; keep one of them",
        ),
        ('time_s,speed_m_s\n0,8\n1,"9\n2,9x\n', "line 4: speed = 9x is not a finite number"),
        (b"time_s,speed_m_s\n0,\xff8\n", "not a text file in UTF-8"),
    ],
)
def test_faults_are_named_by_line(file, text, words):
    with pytest.raises(CaseError, match=words):
        file(text)


def test_every_fault_is_listed_but_not_thousands(file):
    rows = [f"{i},{'-1' if i % 10 == 0 else '9'}" for i in range(1000)]
    with pytest.raises(CaseError) as caught:
        file("time_s,speed_m_s\n" + "\n".join(rows))
    text = str(caught.value)
    assert text.count("\n") == 21
    assert "line 2: speed = -1" in text
    assert "line 192: speed = -1" in text
    assert "80 more" in text


def test_files_that_cannot_be_read(tmp_path, file):
    with pytest.raises(CaseError, match="no such file"):
        rw.read_wind(tmp_path / "none.csv")
    with pytest.raises(CaseError, match="a folder"):
        rw.read_wind(tmp_path)
    with pytest.raises(InputError, match="kind = 'quintic'"):
        file(GOOD, kind="quintic")
    with pytest.raises(InputError, match="gaps = 'ignore'"):
        file(GOOD, gaps="ignore")
