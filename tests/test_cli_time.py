"""`rainwind simulate` and `rainwind sweep`: what they print and write, units, and what they say to wrong input."""

import csv
from pathlib import Path

import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from PIL import Image
from typer.testing import CliRunner

from rainwind import cli_time
from rainwind.cli import app
from rainwind.errors import InputError
from rainwind.physics.model import paper_model
from rainwind.plotting.animation import Scene, animate, frames
from rainwind.studies import one_run, run_words, wind_sweep

approx = pytest.approx


def run(*arguments: object, fine: int = 0) -> tuple[str, str]:
    plain = {"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}
    result = CliRunner(env=plain).invoke(app, [*map(str, arguments)])
    assert result.exit_code == fine, (result.output, result.exception)
    assert "Traceback" not in result.output
    return result.stdout, result.stderr


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_rivulet_falls_at_9_metres_per_second(tmp_path: Path):
    # issue 4: grows past C and falls to A within about 200 s; A lies at 183.7 degrees (test_targets)
    out, err = run(
        "simulate",
        "--wind",
        "32.4 km/h",
        "--duration",
        "25 min",
        "--out",
        tmp_path / "new" / "s.png",
        "--csv",
    )
    assert "the paper's sample case" in err
    first, second, third, written = out.splitlines()
    assert first == "Wind 9 m/s, 1500 s, from D, y displaced by 1 mm."
    assert second.startswith("It comes to rest at A: y ")
    assert second.endswith("phi 183.7°.")
    assert "outside -90° to 0°, where the coefficients 'reconstructed' hold." in third
    assert written == f"written to {tmp_path / 'new' / 's.png'}, {tmp_path / 'new' / 's.csv'}"
    table = rows(tmp_path / "new" / "s.csv")
    assert list(table[0])[:4] == ["time [s]", "y [m]", "phi [rad]", "z [m]"]
    assert float(table[-1]["time [s]"]) == 1500.0
    after = [float(row["phi [rad]"]) for row in table if float(row["time [s]"]) > 200.0]
    before = [float(row["phi [rad]"]) for row in table if float(row["time [s]"]) < 150.0]
    assert min(after) > np.pi / 2 > max(before)


def test_a_vibration_is_said_with_its_size(tmp_path: Path):
    # issue 3, from AUTO-07p: y 0.233 m, z 0.203 m at 12 m/s
    out, _ = run(
        "simulate",
        "--wind",
        "12 m/s",
        "--start",
        "d, y = 20 mm",
        "--duration",
        "1000",
        "--out",
        tmp_path / "s.svg",
    )
    first, second, *_ = out.splitlines()
    assert first == "Wind 12 m/s, 1000 s, from D, y = 20 mm."
    assert second.startswith("It vibrates steadily from about ")
    assert second.endswith("half peak-to-peak y ±0.2327 m, z ±0.2029 m, phi ±20.6°.")


def test_a_ramp_and_a_record_and_a_turbulent_wind(tmp_path: Path):
    out, _ = run(
        "simulate",
        "--wind",
        "8 m/s to 14 m/s in 1 min",
        "--duration",
        "80",
        "--out",
        tmp_path / "s.png",
        "--csv",
    )
    assert out.startswith(
        "Wind 8 to 14 m/s in 60 s, 80 s, from D, y displaced by 1 mm."
    )  # the fold is at 7.997 m/s
    wind = [(float(row["time [s]"]), float(row["wind.speed [m/s]"])) for row in rows(tmp_path / "s.csv")]
    for t, speed in wind[:: len(wind) // 20]:
        assert speed == approx(8.0 + 0.1 * min(t, 60.0), abs=1e-9)
    record = tmp_path / "wind.csv"
    record.write_text("time_s,speed_m_s\n0,9\n10,10\n20,9\n30,11\n", encoding="utf-8")
    out, _ = run("simulate", "--wind", record, "--out", tmp_path / "r.png", "--csv")
    assert out.startswith("Wind record wind.csv, 30 s, from D")  # as long as the record
    assert float(rows(tmp_path / "r.csv")[-1]["wind.speed [m/s]"]) == 11.0
    given = run_words.wind_from_text("turbulent 12 m/s, 10 %, 100 m, seed 1", paper_model(), 600.0)
    t = np.linspace(0.0, 600.0, 6001)[:-1]
    speed = given.parameters["wind.speed"].at(t)  # type: ignore[union-attr]
    assert speed.mean() == approx(12.0, abs=0.05)
    assert speed.std() == approx(1.2, rel=0.15)


def test_animations(tmp_path: Path):
    run(
        "simulate",
        "--duration",
        "3",
        "--out",
        tmp_path / "s.png",
        "--animate",
        tmp_path / "s.gif",
        "--span",
        "1 s",
        "2 s",
    )
    with Image.open(tmp_path / "s.gif") as film:
        assert film.n_frames == 20  # type: ignore[attr-defined]
        assert film.info["loop"] == 0  # for ever
        assert film.info["duration"] == 50  # ms: as fast as in life
    result = one_run.compute(paper_model(), duration=1.0)
    one_run.film(result, tmp_path / "s.html", (0.0, 0.2))
    page = (tmp_path / "s.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64") == 4
    assert "cdnjs" not in page  # nothing from the network
    if FFMpegWriter.isAvailable():
        one_run.film(result, tmp_path / "s.mp4", (0.0, 0.2))
        assert (tmp_path / "s.mp4").read_bytes()[4:8] == b"ftyp"


def test_the_rivulet_is_drawn_where_it_is():
    from matplotlib.figure import Figure

    from rainwind.plotting.animation import _Drawing

    t = np.zeros(1)
    at = [t + v for v in (0.3, 0.2)]
    for phi, side in ((0.0, (0.2, 0.245)), (np.pi / 2, (0.145, 0.3)), (np.pi, (0.2, 0.355))):
        # top: above, y is downward; windward is left; the lower rivulet is below
        drawing = _Drawing(Scene(t, at[0], at[1], t + phi, t + 9.0, 0.1, 0.055), Figure())
        drawing.show(0)
        assert drawing.rivulet.center == approx(side)
        assert drawing.cable.center == approx((0.2, 0.3))
        assert drawing.axes.get_ylim()[0] > drawing.axes.get_ylim()[1]


def test_frames():
    assert frames(".gif", 10.0) == 200
    with pytest.raises(InputError, match="show 75 s or less"):
        frames(".gif", 100.0)
    none = np.zeros(2)
    with pytest.raises(InputError, match="no format"):
        animate(Scene(none, none, none, none, none, 0.1, 0.05), Path("a.avi"))


def test_ctrl_c_keeps_what_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    calls = []

    def asked() -> None:
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(cli_time, "raise_if_asked", asked)
    out, err = run(
        "simulate",
        "--duration",
        "1 h",
        "--out",
        tmp_path / "s.png",
        "--csv",
        "--animate",
        tmp_path / "s.gif",
        fine=130,
    )
    assert "interrupted by the user" in out
    assert f"what was done is in {tmp_path / 's.png'}, {tmp_path / 's.csv'}" in err
    last = float(rows(tmp_path / "s.csv")[-1]["time [s]"])
    assert 0.0 < last < 3600.0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["s.csv", "s.png"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--wind", "fast"], "--wind 'fast' is not a number with a unit"),
        (["--wind", "9 kg"], "no unit of a speed"),
        (["--wind", "-9"], "above 0"),
        (["--wind", "nan"], "--wind 'nan'"),
        (["--wind", "8 m/s to 9 m/s to 10 m/s"], "more than one 'to'"),
        (["--wind", "none.csv"], "no such file"),
        (["--wind", "turbulent 12 m/s"], "write a turbulent wind as"),
        (["--wind", "turbulent 12 m/s, 10 %, 100 m, seed 1.5"], "write a turbulent wind as"),
        (["--duration", "0"], "above 0"),
        (["--duration", "9 m"], "--duration '9 m'"),
        (["--start", "Q"], "no such equilibrium at 9 m/s; there are A, B, C, D"),
        (["--start", "D, C"], "a letter such as D"),
        (["--start", "psi = 3 deg"], "the states are y, phi, z"),
        (["--start", "phi = 45"], "has no unit"),
        (["--start", "y = 1 kg"], "--start y = '1 kg'"),
        (["--out", "a.gif"], ".png, .svg or .pdf"),
        (["--animate", "a.avi"], ".mp4, .gif or .html"),
        (["--span", "1 s", "2 s"], "name its file with --animate"),
        (["--animate", "a.gif", "--span", "3 s", "2 s"], "the earlier one first"),
        (
            ["--duration", "20 s", "--animate", "a.gif", "--span", "3 s", "25 s"],
            "not inside the run, 0 to 20 s",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(arguments: list[str], words: str, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, err = run("simulate", *arguments, fine=2)
    assert words in err
    assert list(tmp_path.iterdir()) == []


def test_an_mp4_without_its_program_is_refused_before_anything_is_computed(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    _, err = run("simulate", "--out", tmp_path / "s.png", "--animate", tmp_path / "s.mp4", fine=2)
    assert "ffmpeg, which is not found; install it, or write a .gif or .html" in err
    assert list(tmp_path.iterdir()) == []


def test_a_record_with_gaps_or_too_short_is_refused(tmp_path: Path):
    record = tmp_path / "wind.csv"
    record.write_text("time_s,speed_m_s\n0,9\n1,10\n2,9\n9,11\n", encoding="utf-8")
    _, err = run("simulate", "--wind", record, "--out", tmp_path / "r.png", fine=2)
    assert "line 5: a gap before it: 7 s since line 4" in err
    assert "rainwind.read_wind(file, gaps='interpolate') in Python" in err  # there is no such option
    record.write_text("time_s,speed_m_s\n0,9\n1,10\n2,9\n", encoding="utf-8")
    _, err = run("simulate", "--wind", record, "--duration", "3 s", "--out", tmp_path / "r.png", fine=2)
    assert "--duration 3 s: the record wind.csv ends after 2 s" in err
    _, err = run("simulate", "--wind", record, "--duration", "1.5 s", "--out", tmp_path / "r.png")
    assert (tmp_path / "r.png").exists()


def test_the_case_file_is_spared(tmp_path: Path):
    case = tmp_path / "case.png"
    case.write_text("mine", encoding="utf-8")
    for command in ("simulate", "sweep"):
        assert "is the case file itself" in run(command, case, "--out", case, fine=2)[1]
    assert case.read_text(encoding="utf-8") == "mine"


def test_sweep(tmp_path: Path):
    # D is at rest above its Hopf point at 14.8 m/s (section 4.2)
    out, err = run("sweep", "--until", "15.5", "57.6 km/h", "--out", tmp_path / "w.png", "--csv")
    assert "the paper's sample case" in err
    assert "Falling wind from D at 16.00 m/s: no jump; at 15.50 m/s it is at rest at D." in out
    assert out.splitlines()[-1].startswith(f"written to {tmp_path / 'w.png'}, ")
    assert rows(tmp_path / "w_jumps.csv") == []
    speeds = [float(row["wind_speed [m/s]"]) for row in rows(tmp_path / "w_sweep_1_up.csv")]
    assert speeds == approx([15.5, 16.0])


def test_sweep_stopped_and_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    calls = []

    def asked() -> None:
        calls.append(1)
        if len(calls) > 12:
            raise KeyboardInterrupt

    monkeypatch.setattr(cli_time, "raise_if_asked", asked)
    out, err = run("sweep", "--until", "15", "17", "--out", tmp_path / "w.png", fine=130)
    assert "This sweep ended early: interrupted by the user." in out
    assert f"what was finished is in {tmp_path / 'w.png'}" in err
    assert "no unit" in run("sweep", "--step", "1 kg", fine=2)[1]
    assert "from 0.01 to 10 m/s" in run("sweep", "--step", "0", fine=2)[1]
    assert "the first must be the smaller" in run("sweep", "--until", "9", "8", fine=2)[1]
    assert wind_sweep.step_from_text("3.6 km/h") == 1.0
