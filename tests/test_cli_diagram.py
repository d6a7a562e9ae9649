"""`rainwind diagram`: what it prints and writes, its units, and what it says to wrong input."""

import csv
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

import rainwind as rw
from rainwind.cli import app
from rainwind.dynamics import zoo
from rainwind.parameters import replace_parameters
from rainwind.physics import paper_model
from rainwind.plotting.diagram import Panel, decimals, draw_panels
from rainwind.studies import diagram_window, full_diagram


def run(*arguments: object, fine: int = 0) -> tuple[str, str]:
    plain = {"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}
    result = CliRunner(env=plain).invoke(app, ["diagram", *map(str, arguments)])
    assert result.exit_code == fine, (result.output, result.exception)
    assert "Traceback" not in result.output
    return result.stdout, result.stderr


def upper_is_stable(speed: float, percent: float) -> bool:
    model = paper_model().with_parameters({"wind.speed": speed, "section.damping_ratio": percent / 100})
    (upper,) = [one for one in rw.find_equilibria(model) if 0.3 < one["phi"] < 1.0]
    return upper.stable


def test_the_sample_case(tmp_path: Path):
    # Hopf 14.799 and Neimark-Sacker 10.853 m/s as AUTO-07p found them (issue 3); 15 m/s is 54 km/h
    out, err = run("--until", "10", "54 km/h", "--out", tmp_path / "new" / "d.svg", "--csv")
    assert "the paper's sample case" in err
    varied, first, second, third, *said, written = out.splitlines()
    assert varied.startswith(
        "Varied: wind speed, 10 m/s to 15 m/s. Held: damping ratio 0.2 %, frequency 1 Hz, diameter"
    )
    assert first == "10.00-10.85 m/s: equilibrium A, rivulet at 185°"
    assert second.startswith(
        "10.85-14.80 m/s: equilibrium A, rivulet at 185 to 190°; vibration, y ±0.000 to 0.258 m, z ±"
    )
    assert third == "14.80-15.00 m/s: equilibrium D, rivulet at 32°; equilibrium A, rivulet at 190°"
    assert said[0] == "A stable vibration exists from 10.85 to 14.80 m/s."
    # above the speed of the critical damping (9 m/s, section 5) most is needed at the window's lower end
    enough = float(
        said[1].removeprefix("With a damping ratio above ").split(" % small disturbances of D die out")[0]
    )
    assert [upper_is_stable(10.0, ratio) for ratio in (enough - 0.001, enough + 0.001)] == [False, True]
    assert said[1].endswith("(most is needed at 10.00 m/s).")
    assert "'rainwind figure 9'" in said[2]
    assert said[3].startswith("The paper's letters: A is the lower rivulet")
    assert written.startswith("written to ")
    text = (tmp_path / "new" / "d.svg").read_text(encoding="utf-8")
    assert text.startswith("<?xml")
    with (tmp_path / "new" / "d_special_points.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["kind"] for row in rows] == ["lpc", "ns", "lpc", "hopf"]
    assert float(rows[1]["wind.speed [m/s]"]) == pytest.approx(10.8525928, abs=1e-6)
    with (tmp_path / "new" / "d_orbits_0.csv").open(encoding="utf-8") as file:
        header = next(csv.reader(file))
    assert header[:3] == ["wind.speed [m/s]", "period [s]", "min y [m]"]
    letters = set()
    for path in (tmp_path / "new").glob("d_equilibria_*.csv"):
        with path.open(encoding="utf-8") as file:
            letters |= {(row["letter"], int(row["unstable"]) > 0) for row in csv.DictReader(file)}
    # A is stable, B and C never are, D is not at first
    assert letters == {("A", False), ("B", True), ("C", True), ("D", True), ("D", False)}


def test_along_the_damping_ratio(tmp_path: Path):
    # section 5: the critical damping ratio of the sample calculation at 9 m/s is 0.7 %
    out, _ = run("--along", "section.damping_ratio", "--until", "0.6 %", "0.8 %", "--out", tmp_path / "d.png")
    varied, *ranges, where, letters, _ = out.splitlines()
    assert varied.startswith(
        "Varied: damping ratio, 0.6 % to 0.8 %. Held: wind speed 9 m/s, frequency 1 Hz, "
    )
    assert [line.split(" %:")[0] for line in ranges] == ["0.6000-0.6940", "0.6940-0.8000"]
    assert "equilibrium D, rivulet at 45°" in ranges[1]
    assert "equilibrium D" not in ranges[0]
    assert where == "A stable vibration exists from 0.6000 to 0.6940 %."
    assert "A is the lower rivulet" in letters
    assert (tmp_path / "d.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--out", "d.txt"], "no image format"),
        (["--along", "wind.sped"], "no parameter 'wind.sped'. Did you mean 'wind.speed'?"),
        (["--along", "wind.yaw"], "no default; say until where"),
        (["--along", "wind.yaw", "--until", "0", "20"], "--until '0' has no unit; write an angle"),
        (["--until", "5", "soon"], "--until 'soon' is not a number with a unit"),
        (["--until", "20", "5"], "the first must be the smaller"),
        (
            ["--until", "-1", "5"],
            "-1 m/s to 5 m/s, leaves what is allowed at -1 m/s: wind.speed = -1 is not allowed",
        ),
        (["--until", "5 m/s", "200 m/s"], "at 200 m/s: a wind of 200 m/s; allowed is up to 100 m/s"),
        (["--until", "5", "nan"], "must be a finite number"),
        (
            ["--along", "rivulet.height", "--until", "5 mm", "100 mm"],
            "at 100 mm: a rivulet of 100 mm on a cable of 100 mm; allowed is a rivulet less high",
        ),
        (
            ["--along", "section.diameter", "--until", "9 mm", "0.1 m"],
            "at 9 mm: a rivulet of 10 mm on a cable of 9 mm",
        ),
        (
            ["--along", "section.diameter", "--until", "0 mm", "0.1 m"],
            "at 0 mm: section.diameter = 0 is not allowed",
        ),
        (["--along", "section.inclination", "--until", "30 deg", "95 deg"], "at 95 °: section.inclination"),
        (["--along", "rivulet.friction", "--until", "-1 N m s", "1 N m s"], "must be 0 or more"),
    ],
)
def test_bad_arguments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: str):
    monkeypatch.chdir(tmp_path)
    out, err = run(*arguments, fine=2)
    assert words in err
    assert not out
    assert "starting" not in err  # no progress bar before the error
    assert "━" not in err
    assert list(tmp_path.iterdir()) == []


def test_an_unusual_window_is_told_and_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(
        full_diagram, "compute", lambda *_, **__: (_ for _ in ()).throw(rw.RainwindError("stop"))
    )
    _, err = run(
        "--along", "section.damping_ratio", "--until", "0 %", "5 %", "--out", tmp_path / "d.png", fine=1
    )
    assert "--until 5 %, which is unusual: usual is 0.01 to 3 %;" in err
    assert "--until 0 %" not in err


@pytest.mark.parametrize("end", [float("inf"), "8", None])
def test_a_window_of_no_numbers(end: object):
    with pytest.raises(rw.RainwindError, match="number"):
        full_diagram.compute(paper_model(), until=(5.0, end))  # type: ignore[arg-type]


def test_the_default_window_stays_below_the_fastest_wind(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(diagram_window, "speed_window", lambda _: (25.0, 120.0))
    assert diagram_window.checked_window(paper_model(), "wind.speed") == (25.0, 100.0)


def stop_at(monkeypatch: pytest.MonkeyPatch, call: int) -> None:
    told: list[int] = []

    def stop() -> None:
        told.append(1)
        if len(told) == call:
            raise KeyboardInterrupt

    monkeypatch.setattr("rainwind.cli.raise_if_asked", stop)


def test_an_interrupt_draws_what_is_done_and_the_picture_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    stop_at(monkeypatch, 60)
    drawn: list[Figure] = []
    save = full_diagram.style.save
    monkeypatch.setattr(
        full_diagram.style, "save", lambda figure, path: (drawn.append(figure), save(figure, path))
    )
    out, err = run("--until", "10", "15", "--out", tmp_path / "d.png", fine=130)
    assert "interrupted by the user: branches are missing" in out
    assert "stable vibration" not in out
    assert f"stopped; what was finished is in {tmp_path / 'd.png'}" in err
    assert (tmp_path / "d.png").exists()
    (figure,) = drawn
    assert figure.axes[0].get_title(loc="right") == "stopped by the user before its end: branches are missing"


def test_an_interrupt_before_anything_was_found_draws_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    stop_at(monkeypatch, 1)
    out, err = run("--until", "10", "15", "--out", tmp_path / "d.png", fine=130)
    assert "stopped before anything was found: no picture is written" in err
    assert not out
    assert list(tmp_path.iterdir()) == []


def test_a_finished_diagram_is_not_called_stopped_and_says_what_is_held():
    found = full_diagram.compute(paper_model(), "section.damping_ratio", (0.0068, 0.0070))
    figure = full_diagram.draw(found, Figure())
    assert figure.axes[0].get_title(loc="right") == ""
    assert "wind speed 9 m/s" in " ".join(figure.get_supxlabel().split())
    letters = {text.get_text() for text in figure.axes[2].texts} & set("ABCD")
    assert letters == set("ABCD")


def test_what_is_held_names_what_leads_and_differs():
    apart = paper_model().with_parameters({"wind.yaw": 0.5, "section.frequency_z": 1.2})
    said = diagram_window.held(apart, "section.mass")
    assert said[:5] == [
        "wind speed 9 m/s", "yaw 28.6479 °", "damping ratio 0.2 %", "frequency in y 1 Hz", "frequency in z 1.2 Hz",
    ]  # fmt: skip
    assert not any(one.startswith("mass") for one in said)


def test_a_damping_ratio_that_changes_nothing_is_refused():
    both = {"section.damping_ratio_y": 0.002, "section.damping_ratio_z": 0.003}
    apart = replace_parameters(paper_model(), both)
    with pytest.raises(rw.RainwindError, match="changes nothing: the case has"):
        full_diagram.compute(apart, "section.damping_ratio", (0.001, 0.003))


def test_a_case_with_two_degrees_of_freedom_has_no_panel_for_z():
    found = full_diagram.compute(paper_model(degrees_of_freedom=2), until=(14.0, 18.0))
    figure = full_diagram.draw(found, Figure())
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "amplitude of $y$ (m)", "rivulet angle $\\phi$ (°)",
    ]  # fmt: skip


def test_any_system_can_be_drawn():
    known = zoo.brusselator()
    found = rw.diagram(known.system, "b", until=known.until)
    figure = draw_panels(found, Figure(), [Panel("x", "x"), Panel("y", "y", amplitude=True)])
    first, second = figure.axes
    assert [text.get_text() for text in first.texts] == ["Hopf 2.00"]
    assert not second.texts  # each name once
    # rest until b = 2, then both extremes of the orbit, drawn through to the Hopf point at (2, 1)
    curves = [line.get_xydata() for line in first.lines if len(line.get_xdata()) > 1]
    assert len(curves) == 4
    assert all(min(abs(curve - [2.0, 1.0]).max(axis=1)) < 1e-9 for curve in curves)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "equilibrium, stable", "equilibrium, unstable", "orbit, stable", "a stable orbit exists", "Hopf point",
    ]  # fmt: skip


@pytest.mark.parametrize(("span", "digits"), [(16.0, 2), (4.8, 2), (0.85, 3), (300.0, 1), (4000.0, 0)])
def test_decimals_show_a_thousandth_of_the_range(span: float, digits: int):
    assert decimals(span) == digits
