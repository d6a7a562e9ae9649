"""`rainwind map`, `basins`, `probability`: what they print and write, and what they say to wrong input."""

from pathlib import Path

from typer.testing import CliRunner

from rainwind.cli import app


def run(*arguments: object, fine: int = 0) -> tuple[str, str]:
    plain = {"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}
    result = CliRunner(env=plain).invoke(app, [*map(str, arguments)])
    assert result.exit_code == fine, (result.output, result.exception)
    assert "Traceback" not in result.output
    return result.stdout, result.stderr


def test_map(tmp_path: Path):
    out, err = run(
        "map", "--until", 13, "61.2 km/h", "--damping", "0.2 %", "0.9 %", "--cells", 2, 2,
        "--longest", "30 min", "--out", tmp_path / "new" / "m.svg", "--data",
    )  # fmt: skip
    assert "the paper's sample case" in err
    # 13 m/s, 0.2 %: the stable cycle; 0.9 % is above the critical damping; at 17 m/s D is stable
    rest, vibration, largest, written = out.splitlines()
    assert rest.startswith("at rest: 3 of 4 cells, between 13.0 and 17.0 m/s")
    assert vibration.startswith(
        "steady vibration: 1 of 4 cells, between 13.0 and 13.0 m/s and between 0.2 and 0.2 %"
    )
    assert largest.startswith("Largest half peak to peak: 0.2")
    assert written.startswith("written to ")
    assert {path.name for path in (tmp_path / "new").iterdir()} == {"m.svg", "m.nc", "m_cells.csv"}
    assert (tmp_path / "new" / "m_cells.csv").read_text(encoding="utf-8").count("\n") == 5


def test_basins(tmp_path: Path):
    out, _ = run(
        "basins", "--speed", "16.5", "--cells", 3, 3, "--longest", "1800", "--out", tmp_path / "b.png"
    )
    assert "rivulet lost: " in out
    assert "at rest: " in out
    assert "Equilibria at 16.5 m/s: A at 192.3°, B at -7.2°, C at 80.7°, D at 30.9°." in out
    assert "Every start ends the same way" not in out
    assert (tmp_path / "b.png").stat().st_size > 5000
    out, _ = run("basins", "--speed", "6", "--cells", 2, 2, "--longest", "1800", "--out", tmp_path / "b.png")
    assert "Every start ends the same way at this wind speed" in out  # no upper rivulet below 8 m/s


def test_probability(tmp_path: Path):
    out, _ = run(
        "probability", "--until", 13, 14, "--mass", 0, "--damping", 0, "--slopes", 0, "--samples", 2, "--sobol", 0,
        "--out", tmp_path / "p.png",
    )  # fmt: skip
    assert "A vibration is most likely at 13.0 m/s: 100 %" in out


def test_what_they_say_to_wrong_input(tmp_path: Path):
    for arguments, said in (
        (("map", "--until", "12", "8"), "lower one first"),
        (("map", "--damping", "1", "2 %"), "--damping"),
        (("map", "--longest", "0"), "--longest '0': give a time above zero"),
        (("map", "--cells", "1", "9"), "--cells 1 9: give two numbers from 2"),
        (("map", "--out", tmp_path / "m.txt"), "no image format"),
        (("basins", "--plane", "phi"), "two states with a comma"),
        (("basins", "--plane", "phi,psi"), "psi"),
        (("basins", "--speed", "fast"), "--speed 'fast'"),
        (("probability", "--mass", "90"), "0 to 0.5"),
    ):
        _, err = run(*arguments, fine=2)
        assert said in err
    assert not list(tmp_path.iterdir())
