"""The command line: what it prints, what it writes, its exit codes, and no traceback for bad input."""

import csv
import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from rainwind import __version__
from rainwind.cli import FIGURES, app
from rainwind.errors import ComputationError
from rainwind.io.case_files import new_case_text
from rainwind.io.cases import read_case
from rainwind.physics import paper_model

SOURCE = Path(__file__).parents[1] / "src"
TARGETS = [
    {
        "id": "T2",
        "what": "fold",
        "paper": 8.0,
        "computed": 7.997,
        "unit": "m/s",
        "fitted": True,
        "verdict": "met",
    },
    {
        "id": "T5",
        "what": "folds of cycles",
        "paper": [10.7, 12.7],
        "computed": None,
        "unit": "m/s",
        "fitted": False,
        "verdict": "not_computed",
    },
]


def run(*arguments: object, fine: int = 0) -> SimpleNamespace:
    """The program inside this process; the exit code must be `fine`."""
    # wide and plain, so that no word is broken or coloured
    plain = {"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}
    result = CliRunner(env=plain).invoke(app, [str(argument) for argument in arguments])
    assert result.exit_code == fine, (result.output, result.exception)
    if fine:
        assert "Traceback" not in result.output
    return SimpleNamespace(out=result.stdout, err=result.stderr, raised=result.exception)


def program(*arguments: object, cwd: Path, **options: object) -> subprocess.CompletedProcess[str]:
    """The program as its own process."""
    command = [sys.executable, "-m", "rainwind.cli", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, env=environment(), capture_output=True, text=True, **options)


def environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(SOURCE)}


@pytest.fixture
def case(tmp_path: Path) -> Path:
    run("new", tmp_path / "case.toml")
    return tmp_path / "case.toml"


@pytest.fixture
def studies(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A stand-in for the studies, which take long: what the command line expects of them."""
    calls: list[tuple[str, Path, object]] = []

    def paper_run(out: Path, *, progress) -> None:
        for done, what in enumerate(("figure 4", "figure 5"), start=1):
            progress(done, 2, what)
        (out / "targets.json").write_text(json.dumps(TARGETS), encoding="utf-8")

    def save_figure(study: str, path: Path, *, model: object) -> list[str]:
        calls.append((study, path, model))
        path.write_text("picture", encoding="utf-8")
        return ["D is born at 8 m/s."]

    stand_in = SimpleNamespace(run=paper_run, save_figure=save_figure, calls=calls)
    monkeypatch.setitem(sys.modules, "rainwind.studies.paper_run", stand_in)
    return stand_in


@pytest.fixture
def equilibria(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """A stand-in for the dynamics: two equilibria whose numbers are known; the models it was asked for."""
    asked: list[object] = []

    class Equilibrium(dict):
        kind = "stable focus"
        eigenvalues = (-0.5 + 2j, -0.25 + 0j)

    class Found(list):
        complete = True

    def find(model: object) -> Found:
        asked.append(model)
        return Found([Equilibrium(phi=-3.0, y=0.001, z=0.002), Equilibrium(phi=0.5, y=-0.003, z=0.25)])

    monkeypatch.setitem(sys.modules, "rainwind.dynamics.equilibria", SimpleNamespace(find_equilibria=find))
    return asked


def test_version():
    assert run("--version").out == f"rainwind {__version__}\n"


def test_help_names_every_command():
    text = run("--help").out
    for command in ("paper", "figure", "equilibria", "hopf-map", "new", "check"):
        assert command in text
        assert "Usage" in run(command, "--help").out


def test_new_writes_the_sample_case_and_overwrites_only_when_told(tmp_path: Path):
    path = tmp_path / "a" / "case.toml"
    run("new", path)
    assert read_case(path) == paper_model()
    path.write_text("mine", encoding="utf-8")
    assert "--force" in run("new", path, fine=2).err
    assert path.read_text(encoding="utf-8") == "mine"
    run("new", path, "--force")
    assert read_case(path) == paper_model()
    assert "is a folder" in run("new", tmp_path, "--force", fine=2).err


def test_check(case: Path, tmp_path: Path):
    assert run("check", case).out == f"{case}: fine\n"
    bad = tmp_path / "bad.toml"
    text = case.read_text(encoding="utf-8").replace("mass_kg_m = 50", "mass_kg_m = -50")
    bad.write_text(text.replace("speed_m_s", "speed"), encoding="utf-8")
    err = run("check", bad, fine=2).err
    assert "2 faults" in err
    assert "line 7: speed = 9.0 has no unit" in err
    assert "line 13: mass_kg_m = -50.0" in err
    assert "no such file" in run("check", tmp_path / "none.toml", fine=2).err


def test_unusual_numbers_are_told_and_are_no_error(equilibria: list[object], case: Path):
    text = case.read_text(encoding="utf-8")
    case.write_text(text.replace("diameter_mm = 100.0", "diameter_m = 79"), encoding="utf-8")
    out = run("check", case).out
    assert f"{case}: [section] diameter_m = 79, which is unusual: usual is 0.04 to 0.4 m" in out
    assert f"{case}: no fault, but 2 unusual numbers\n" in out
    result = run("equilibria", case)
    assert "diameter_m = 79, which is unusual" in result.err
    assert "unusual" not in result.out


def test_equilibria(equilibria: list[object], tmp_path: Path):
    result = run("equilibria", "--csv", tmp_path / "new" / "a.csv")
    assert "the paper's sample case" in result.err
    assert "2 equilibria at a wind speed of 9 m/s" in result.out
    assert "phi [deg]" in result.out
    assert equilibria == [paper_model()]
    header, first, second = (tmp_path / "new" / "a.csv").read_text(encoding="utf-8").splitlines()
    assert header == "phi [deg],y [mm],z [mm],kind,largest real part [1/s],coefficients' range"
    assert first.endswith(",inside")
    assert second.endswith(",outside")
    assert "all there are, certified: every equilibrium of the model as given" in result.out
    assert "'reconstructed' hold for alpha = -phi from -90 to 0 deg" in result.out
    assert [float(first.split(",")[i]) for i in (0, 1, 2, 4)] == pytest.approx(
        [28.6478898, -3.0, 250.0, -0.25]
    )
    assert [float(second.split(",")[i]) for i in (0, 1, 2, 4)] == pytest.approx(
        [188.1126615, 1.0, 2.0, -0.25]
    )


def test_the_range_is_that_of_the_angle_as_the_blend_wraps_it(equilibria: list[object], tmp_path: Path):
    (tmp_path / "own.toml").write_text(
        'name = "own"\nsource = "here"\nstatus = "test"\nvalid_deg = [170, 200]\n'
        "lift = 0\ndrag = 1\nmoment = 0.1\n",
        encoding="utf-8",
    )
    text = new_case_text().replace('set = "reconstructed"', 'set = "own.toml"')
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    run("equilibria", tmp_path / "case.toml", "--csv", tmp_path / "a.csv")
    _, first, second = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert first.endswith(",outside")
    assert second.endswith(",inside")  # phi = 188 deg is alpha = 172 deg
    (tmp_path / "case.toml").write_text(text.replace('"blend"', '"extend"'), encoding="utf-8")
    assert "the curves drawn on beyond it" in run("equilibria", tmp_path / "case.toml").out


def test_equilibria_of_the_paper(tmp_path: Path):
    # Peil & Nahrath (2003), section 4.1: two below 8 m/s, four above; D at about 45 degrees at 9 m/s
    for speed, count in ((7.0, 2), (9.0, 4)):
        run("equilibria", "--speed", speed, "--csv", tmp_path / f"{count}.csv")
        with (tmp_path / f"{count}.csv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == count
        assert rows[-1]["kind"] == "stable focus"  # A, section 4.2
    assert float(rows[1]["phi [deg]"]) == pytest.approx(45, abs=2)
    assert [row["kind"] for row in rows] == ["saddle", "unstable focus", "saddle", "stable focus"]  # B D C A


def test_equilibria_of_any_case(case: Path):
    text = case.read_text(encoding="utf-8")
    case.write_text(text.replace("yaw_deg = 0", "yaw_deg = 20"), encoding="utf-8")
    turned = read_case(case)
    assert turned.wind.yaw == pytest.approx(math.radians(20))
    out = run("equilibria", case, "--speed", "12 m/s").out
    (count,) = (int(line.split()[0]) for line in out.splitlines() if "at a wind speed of 12 m/s" in line)
    # the scan of the whole circle is the physics' own; the command lists what it finds
    assert count == len(turned.with_parameters({"wind.speed": 12.0}).all_states())


def test_the_first_computation_says_that_it_compiles(monkeypatch: pytest.MonkeyPatch):
    line = "compiling the numerical kernels, once for this installation (about a minute)"
    monkeypatch.setattr("rainwind.dynamics.kernels.compiling.are_compiled", lambda: False)
    result = run("equilibria", "--speed", "7")
    assert line in result.err
    assert line not in result.out
    monkeypatch.setattr("rainwind.dynamics.kernels.compiling.are_compiled", lambda: True)
    assert line not in run("equilibria", "--speed", "7").err


@pytest.mark.parametrize(("command", "suffix", "start"), [
    (("figure", "9"), ".png", b"\x89PNG"), (("figure", "5"), ".svg", b"<?xml"), (("hopf-map",), ".pdf", b"%PDF"),
])  # fmt: skip
def test_real_figures(case: Path, tmp_path: Path, command: tuple[str, ...], suffix: str, start: bytes):
    out = tmp_path / f"a{suffix}"
    run(*command, case, "--out", out)
    assert out.read_bytes().startswith(start)
    assert out.stat().st_size > 5000


@pytest.mark.parametrize(("given", "speed"), [("12", 12.0), ("12 m/s", 12.0), ("36 km/h", 10.0)])
def test_equilibria_at_a_speed(equilibria: list[object], case: Path, given: str, speed: float):
    run("equilibria", case, "--speed", given)
    assert equilibria == [paper_model().with_parameters({"wind.speed": speed})]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("0", "above 0"),
        ("-3", "above 0"),
        ("nan", "not finite"),
        ("1e200", "'1e200' is too fast: allowed is up to 100 m/s"),
        ("400 km/h", "up to 100 m/s"),
        ("fast", "9 m/s"),
        ("10,5", "write a decimal point, 10.5"),
        ("9 m_s", "did you mean m/s?"),
        ("9 kg", "no unit of a speed"),
    ],
)
def test_equilibria_at_no_speed(equilibria: list[object], given: str, words: str):
    assert words in run("equilibria", "--speed", given, fine=2).err
    assert equilibria == []


@pytest.mark.parametrize("number", FIGURES)
def test_figure(studies: SimpleNamespace, case: Path, tmp_path: Path, number: int):
    out = tmp_path / "pictures" / "a.svg"
    assert run("figure", number, case, "--out", out).out == f"D is born at 8 m/s.\nwritten to {out}\n"
    ((study, path, model),) = studies.calls
    assert (study, path.suffix, model) == (FIGURES[number], ".svg", paper_model())
    assert [one.name for one in out.parent.iterdir()] == ["a.svg"]


def test_hopf_map(studies: SimpleNamespace, tmp_path: Path):
    run("hopf-map", "--out", tmp_path / "map.png")
    ((study, path, model),) = studies.calls
    assert (study, path.parent, path.suffix, model) == ("hopf_map", tmp_path, ".png", paper_model())
    assert (tmp_path / "map.png").read_text(encoding="utf-8") == "picture"


def test_a_figure_that_fails_leaves_the_old_one(studies, monkeypatch, tmp_path: Path):
    def fail(study: str, path: Path, *, model: object) -> None:
        path.write_text("half", encoding="utf-8")
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(studies, "save_figure", fail)
    out = tmp_path / "map.png"
    out.write_text("old", encoding="utf-8")
    assert f"{out}: No space left" in run("hopf-map", "--out", out, fine=2).err
    assert [(one.name, one.read_text(encoding="utf-8")) for one in tmp_path.iterdir()] == [("map.png", "old")]


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize(
    "command", [("equilibria", "--csv"), ("figure", "9", "--out"), ("hopf-map", "--out")]
)
def test_the_case_is_not_overwritten_by_the_output(
    studies, equilibria, tmp_path: Path, command: tuple[str, ...], linked: bool
):
    case = tmp_path / "case.png"
    run("new", case)
    before = case.read_bytes()
    out = tmp_path / "link.png" if linked else case
    if linked:
        out.symlink_to(case)
    *words, option = command
    assert "is the case file itself" in run(*words, case, option, out, fine=2).err
    assert case.read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["figure", "12"], "figure 12 is no result"),
        (["figure", "3"], "choose one of 4, 5, 6, 7, 8, 9, 10, 11"),
        (["figure", "nine"], "figure nine is no number; choose one of 4, 5"),
        (["figure", "9" * 5000], "choose one of 4, 5"),
        (["figure"], "Missing argument"),
        (["figure", "9", "--out", "a.gif"], ".png, .svg or .pdf"),
        (["hopf-map", "--out", "map"], ".png, .svg or .pdf"),
        (["figure", "9", "none.toml"], "no such file"),
        (["equilibrium"], "No such command"),
        (["check"], "Missing argument"),
        (["check", "a", "b"], "unexpected"),
        (["paper", "--oout", "x"], "No such option"),
    ],
)
def test_bad_arguments(studies: SimpleNamespace, arguments: list[str], words: str):
    assert words in run(*arguments, fine=2).err
    assert studies.calls == []


def test_paper_prints_the_targets(studies: SimpleNamespace, tmp_path: Path):
    out = run("paper", "--out", tmp_path / "results").out
    for word in (
        "T2",
        "7.997",
        "met",
        "10.7, 12.7",
        "not_computed",
        "1 met, 1 not computed",
        "reconstructed",
    ):
        assert word in out


def test_a_file_in_place_of_the_folder(studies: SimpleNamespace, tmp_path: Path):
    (tmp_path / "results").write_text("", encoding="utf-8")
    assert "is a file, not a folder" in run("paper", "--out", tmp_path / "results", fine=2).err


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written(studies: SimpleNamespace, tmp_path: Path):
    (tmp_path / "results").mkdir(mode=0o500)
    assert "cannot be written" in run("paper", "--out", tmp_path / "results", fine=2).err


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (ComputationError("not one point"), 1, "rainwind: not one point"),
        (RuntimeError("boom"), 1, "RuntimeError: boom; 'rainwind --debug"),
        (MemoryError(), 1, "not enough memory"),
        (OSError(28, "No space left on device", "a.nc"), 2, "a.nc: No space left on device"),
        (KeyboardInterrupt(), 130, "what was finished is in"),
    ],
)
def test_a_computation_that_fails(studies, monkeypatch, tmp_path: Path, error, code: int, words: str):
    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(studies, "run", fail)
    assert words in run("paper", "--out", tmp_path, fine=code).err


def test_debug_shows_where(studies, monkeypatch, tmp_path: Path):
    result = CliRunner().invoke(app, ["--debug", "check", str(tmp_path / "none.toml")])
    assert type(result.exception).__name__ == "CaseError"


def test_the_program_itself(tmp_path: Path):
    assert program("new", "case.toml", cwd=tmp_path).returncode == 0
    fine = program("check", "case.toml", cwd=tmp_path)
    assert (fine.returncode, fine.stdout, fine.stderr) == (0, "case.toml: fine\n", "")
    bad = program("check", tmp_path, cwd=tmp_path)
    assert (bad.returncode, bad.stdout) == (2, "")
    assert bad.stderr.startswith("rainwind: ")
    assert "Traceback" not in bad.stderr
    assert program("figure", "12", cwd=tmp_path).returncode == 2
    assert program("nonsense", cwd=tmp_path).returncode == 2
    assert "Traceback" in program("--debug", "check", tmp_path, cwd=tmp_path).stderr


def test_help_loads_nothing_heavy(tmp_path: Path):
    code = (
        "import sys; sys.argv = ['rainwind', '--help']\n"
        "import rainwind.cli\n"
        "try: rainwind.cli.main()\n"
        "except SystemExit: pass\n"
        "heavy = {'numpy', 'scipy', 'numba', 'matplotlib', 'pint', 'xarray', 'pydantic'}\n"
        "print('loaded', heavy & set(sys.modules))"
    )
    result = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    assert result.stdout.endswith("loaded set()\n")


@pytest.mark.skipif(sys.platform == "win32", reason="no such pipes and signals")
@pytest.mark.parametrize(
    ("place", "code", "words"), [("pipe", 141, ""), ("/dev/full", 2, "rainwind: No space left on device")]
)
def test_output_that_nobody_takes(tmp_path: Path, place: str, code: int, words: str):
    if place == "pipe":
        reading, writing = os.pipe()
        os.close(reading)
    else:
        if not Path(place).exists():
            pytest.skip(f"no {place}")
        writing = os.open(place, os.O_WRONLY)
    result = subprocess.run(
        [sys.executable, "-m", "rainwind.cli", "new", "case.toml"],
        cwd=tmp_path,
        env=environment(),
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
    )
    os.close(writing)
    assert result.returncode == code
    assert result.stderr.startswith(words)
    assert "Exception" not in result.stderr
    assert "Traceback" not in result.stderr


# a study that says when it is there and then works on in compiled code, or in steps of Python
COMPILED = """
import sys, time, types, numba
@numba.njit
def busy(n):
    total = 0.0
    for i in range(n):
        total += i % 7
    return total
def save_figure(study, path, *, model):
    path.write_bytes(b"half")
    print("ready", flush=True)
    end = time.monotonic() + 30
    while time.monotonic() < end:
        busy(100_000)
def run(out, *, progress):
    try:
        for step in range(200):
            progress(step, 200, "a step")
            print("ready", flush=True)
            time.sleep(0.1)
    finally:
        progress(200, 200, "report")
        (out / "report.html").write_text("done")
sys.modules["rainwind.studies.paper_run"] = types.SimpleNamespace(run=run, save_figure=save_figure)
"""


def interrupted(code: str, *arguments: str, cwd: Path, wait: float) -> tuple[int, str]:
    """Exit code and error stream of the program that gets Ctrl-C so many seconds after its first word."""
    head = f"import sys; sys.argv = ['rainwind', *{arguments!r}]\n"
    tail = "\nimport rainwind.cli\nprint('ready', flush=True)\nrainwind.cli.main()\n"
    process = subprocess.Popen(
        [sys.executable, "-c", head + code + tail],
        cwd=cwd,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    while "ready" not in process.stdout.readline():
        assert process.poll() is None
    time.sleep(wait)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    return process.returncode, err


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.parametrize("wait", [0.05, 0.4, 1.0, 2.5])
def test_ctrl_c_at_a_figure(tmp_path: Path, wait: float):
    code, err = interrupted(COMPILED, "figure", "9", "--out", "a.png", cwd=tmp_path, wait=wait)
    assert code == 130
    assert err.endswith("rainwind: interrupted\n")
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.parametrize("wait", [0.2, 0.7])
def test_ctrl_c_at_the_real_hopf_map(tmp_path: Path, wait: float):
    code, err = interrupted("", "hopf-map", "--out", "map.png", cwd=tmp_path, wait=wait)
    assert code == 130
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
def test_ctrl_c_at_the_paper_keeps_what_is_done(tmp_path: Path):
    code, err = interrupted(COMPILED, "paper", "--out", "results", cwd=tmp_path, wait=2.0)
    assert code == 130
    assert "stopping after this step" in err
    assert err.endswith("rainwind: stopped; what was finished is in results\n")
    assert (tmp_path / "results" / "report.html").read_text() == "done"


def test_an_interrupt_that_compiled_code_hid(studies, monkeypatch, tmp_path: Path):
    def fail(*_: object, **__: object) -> None:
        raise SystemError("returned a result with an exception set") from KeyboardInterrupt()

    monkeypatch.setattr(studies, "save_figure", fail)
    assert run("hopf-map", "--out", tmp_path / "a.png", fine=130).err.endswith("rainwind: interrupted\n")
