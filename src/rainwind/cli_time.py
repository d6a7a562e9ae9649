"""Commands of the time domain: `rainwind simulate`, `rainwind sweep`. `cli` adds them to its program."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from rainwind.cli_output import announce_compilation, image_path, make_folder, progress_bar
from rainwind.cli_work import raise_if_asked, stopping_between_steps, unfinished
from rainwind.errors import InputError

__all__ = ["add_commands"]

Case = Annotated[
    Path | None,
    typer.Argument(metavar="[CASE]", help="Case file (TOML); without it the paper's sample case."),
]
Out = Annotated[Path, typer.Option("--out", help="Image file (.png, .svg, .pdf).")]
FILMS = (".mp4", ".gif", ".html")


def add_commands(
    app: typer.Typer,
    model_of: Callable[[Path | None], Any],
    not_the_case: Callable[[Path, Path | None], None],
) -> None:
    """Add the commands to a program that knows how to read a case and to spare its file."""

    @app.command()
    def simulate(
        case: Case = None,
        wind: Annotated[
            str | None,
            typer.Option(
                "--wind", metavar="WIND",
                help="'9 m/s'; a ramp, '8 m/s to 14 m/s'; a record, wind.csv; 'turbulent 12 m/s, 10 %, 100 m, seed 1'.",
            ),
        ] = None,
        duration: Annotated[
            str | None, typer.Option("--duration", metavar="TIME", help="Such as '300 s', '10 min'.")
        ] = None,
        start: Annotated[
            str | None,
            typer.Option("--start", metavar="START", help="A letter, D; or states, 'phi = 45 deg, y = 10 mm'."),
        ] = None,
        out: Out = Path("simulate.png"),
        table: Annotated[bool, typer.Option("--csv", help="Write the states beside the image, as .csv.")] = False,
        film: Annotated[
            Path | None, typer.Option("--animate", metavar="FILE", help="Animation too (.mp4, .gif, .html).")
        ] = None,
        span: Annotated[
            tuple[str, str] | None,
            typer.Option("--span", metavar="FROM TO", help="Times that the animation shows: '178 s' '188 s'."),
        ] = None,
    ) -> None:  # fmt: skip
        """Follow one trajectory: the cable and the rivulet over time, from a start, in a wind that may vary."""
        files = [image_path(out), *([_film_path(film)] if film is not None else [])]
        if span is not None and film is None:
            raise InputError("--span says what the animation shows; name its file with --animate")
        files += [out.with_suffix(".csv")] if table else []
        for file in files:
            not_the_case(file, case)
        words, study = (import_module(f"rainwind.studies.{name}") for name in ("run_words", "one_run"))
        seconds = words.seconds(duration) if duration is not None else None
        shown = words.span_from_text(span)
        if film is not None:  # before anything is computed
            import_module("rainwind.plotting.animation").checked_format(film)
        if shown is not None and seconds is not None and shown[1] > seconds:
            raise InputError(
                f"--span {shown[0]:g} s to {shown[1]:g} s is not inside the run, 0 to {seconds:g} s"
            )
        model = model_of(case)
        for file in files:
            make_folder(file.parent)
        announce_compilation()
        with progress_bar() as bar, stopping_between_steps():
            task = bar.add_task("starting", total=None)

            def progress(done: int, total: int, what: str) -> None:
                bar.update(task, completed=done, total=total, description=what)
                raise_if_asked()

            found = study.compute(model, wind=wind, duration=seconds, start=start, progress=progress)
        if not len(found.run):
            raise KeyboardInterrupt("stopped before anything was computed: nothing is written")
        with unfinished(out) as part:
            study.save(found, part)
        if table:
            with unfinished(out.with_suffix(".csv")) as part:
                study.save_table(found, part)
        for sentence in study.summary(found):
            typer.echo(sentence)
        if film is not None and not found.interrupted:
            _film(study, found, film, shown)
        elif film is not None:
            files.remove(film)
        written = ", ".join(map(str, files))
        if found.interrupted:
            raise KeyboardInterrupt(
                f"stopped after {found.run.duration:.4g} s; what was done is in {written}"
            )
        typer.echo(f"written to {written}")

    @app.command()
    def sweep(
        case: Case = None,
        until: Annotated[
            tuple[str, str] | None,
            typer.Option("--until", metavar="LOW HIGH", help="Wind speeds to sweep over, such as '9 m/s' '16 m/s'."),
        ] = None,
        step: Annotated[
            str, typer.Option("--step", metavar="STEP", help="Longest step of the wind speed.")
        ] = "0.5 m/s",
        out: Out = Path("sweep.png"),
        table: Annotated[
            bool, typer.Option("--csv", help="Write every sweep and the jumps beside the image, as .csv files.")
        ] = False,
    ) -> None:  # fmt: skip
        """Raise and lower the wind slowly: which vibration is reached, where it jumps, and the hysteresis."""
        not_the_case(image_path(out), case)
        study, windows = (
            import_module(f"rainwind.studies.{name}") for name in ("wind_sweep", "diagram_window")
        )
        longest = study.step_from_text(step)
        window = windows.window_from_text("wind.speed", until) if until else None
        model = model_of(case)
        window = windows.checked_window(model, "wind.speed", window)
        make_folder(out.parent)
        announce_compilation(orbits=True)
        with progress_bar() as bar, stopping_between_steps():
            task = bar.add_task("limit cycles of the case", total=None)

            def progress(done: float, what: str) -> None:
                bar.update(task, completed=100.0 * done, total=100.0, description=what)
                raise_if_asked()

            found = study.compute(model, speeds=window, step=longest, told=progress)
        if not any(one.levels for one in found.sweeps):
            raise KeyboardInterrupt("stopped before anything was found: no picture is written")
        with unfinished(out) as part:
            study.save(found, part)
        for sentence in study.summary(found):
            typer.echo(sentence)
        written = ", ".join(map(str, [out, *(study.save_tables(found, out) if table else ())]))
        if found.interrupted:
            raise KeyboardInterrupt(f"stopped; what was finished is in {written}")
        typer.echo(f"written to {written}")


def _film_path(path: Path) -> Path:
    if path.suffix.lower() not in FILMS:
        raise InputError(
            f"--animate {path}: '{path.suffix}' is no format of a film; end it with .mp4, .gif or .html"
        )
    return path


def _film(study: Any, found: Any, path: Path, span: tuple[float, float] | None) -> None:
    with progress_bar() as bar:
        task = bar.add_task("animation", total=None)
        with unfinished(path) as part:
            study.film(
                found, part, span, progress=lambda k, total: bar.update(task, completed=k + 1, total=total)
            )
