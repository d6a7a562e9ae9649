"""The command line: `rainwind paper`, `figure`, `equilibria`, `diagram`, `hopf-map`, `new`, `check`, `schema`.

Nothing heavy is imported before a command needs it, so that `rainwind --help` answers at once.
"""

import csv
import os
import sys
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
import typer.core

from rainwind.cli_assess import add_assess_command
from rainwind.cli_maps import add_map_commands
from rainwind.cli_output import (
    announce_compilation,
    equilibria_table,
    image_path,
    make_folder,
    print_table,
    print_targets,
    progress_bar,
    range_remark,
)
from rainwind.cli_time import add_commands
from rainwind.cli_work import (
    raise_if_asked,
    run_aside,
    stopping_between_steps,
    unfinished,
)
from rainwind.errors import InputError, RainwindError, is_interrupt

__all__ = ["app", "main"]

FIGURES = {
    4: "figure_04_coefficients",
    5: "figure_05_equilibria",
    6: "figure_06_stability",
    7: "figure_07_limit_cycles",
    8: "figure_08_transient",
    9: "figure_09_stability_diagram",
    10: "figure_10_rivulet_and_frequency",
    11: "figure_11_mass_coefficients_dof",
}


class Exit(int, Enum):
    """What the shell is told."""

    FINE = 0
    FAILED = 1
    BAD_INPUT = 2
    INTERRUPTED = 130
    BROKEN_PIPE = 141


class _Group(typer.core.TyperGroup):
    """Turns every error of a command into one message on stderr and an exit code."""

    def invoke(self, ctx: Any) -> Any:
        try:
            result = super().invoke(ctx)
            sys.stdout.flush()  # what cannot be written shows here, not while Python shuts down
            return result
        except (Exception, KeyboardInterrupt) as error:
            own = hasattr(error, "exit_code") or isinstance(error, typer.Abort)  # typer's: usage, exit
            if own or ctx.params.get("debug"):
                raise
            raise typer.Exit(_report(error)) from None


def _report(error: BaseException) -> int:
    """Say it in one message on stderr; the exit code."""
    code, text = Exit.FAILED, str(error)
    if isinstance(error, BrokenPipeError):  # `rainwind equilibria | head`: nobody is left to read
        _discard_output()
        return Exit.BROKEN_PIPE.value
    if is_interrupt(error):
        own = isinstance(error, KeyboardInterrupt) and text
        code, text = Exit.INTERRUPTED, text if own else "interrupted"
    elif isinstance(error, InputError):
        code = Exit.BAD_INPUT
    elif isinstance(error, OSError):
        if error.filename is None:
            _discard_output()
        place = f"{error.filename}: " if error.filename is not None else ""
        code, text = Exit.BAD_INPUT, f"{place}{error.strerror or error}; choose a place that can be written"
    elif isinstance(error, MemoryError):
        text = "not enough memory for this computation"
    elif not isinstance(error, RainwindError):
        kind = type(error).__name__
        text = f"an error of the program itself, {kind}: {text}; 'rainwind --debug ...' shows where"
    typer.echo(f"rainwind: {text}", err=True)
    return code.value


def _discard_output() -> None:
    # Python would try once more to write what is left, and complain
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


app = typer.Typer(
    cls=_Group,
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Case = Annotated[
    Path | None,
    typer.Argument(metavar="[CASE]", help="Case file (TOML); without it the paper's sample case."),
]


def _version(wanted: bool) -> None:
    if wanted:
        from rainwind import __version__

        typer.echo(f"rainwind {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
    version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Rain-wind induced vibration of stay cables: will it vibrate, when, and how much damping stops it?"""


@app.command()
def paper(
    out: Annotated[Path, typer.Option("--out", help="Folder for the results; made if needed.")] = Path(
        "paper_out"
    ),
) -> None:
    """Reproduce the figures and numbers of Peil & Nahrath (2003)."""
    make_folder(out)
    announce_compilation(orbits=True)
    run = import_module("rainwind.studies.paper_run").run
    try:
        with progress_bar() as bar, stopping_between_steps():
            task = bar.add_task("starting", total=None)

            def progress(done: int, total: int, what: str) -> None:
                bar.update(task, completed=done, total=total, description=what)
                raise_if_asked()

            run(out, progress=progress)
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
        raise KeyboardInterrupt(f"stopped; what was finished is in {out}") from None
    print_targets(out / "targets.json")
    typer.echo(f"written to {out}: report.html, targets.json, figures and data")


@app.command()
def figure(
    number: Annotated[str, typer.Argument(metavar="N", help="4, 5, 6, 7, 8, 9, 10 or 11.")],
    case: Case = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="Image file (.png, .svg, .pdf); by default figure_NN.png.")
    ] = None,
) -> None:
    """Compute and draw one figure of the paper."""
    chosen = _figure_number(number)
    out = image_path(out or Path(f"figure_{chosen:02d}.png"))
    _not_the_case(out, case)
    _draw(FIGURES[chosen], _model(case), out)


@app.command("hopf-map")
def hopf_map(
    case: Case = None,
    out: Annotated[Path, typer.Option("--out", help="Image file (.png, .svg, .pdf).")] = Path("hopf_map.png"),
) -> None:
    """Draw where the equilibria lose stability over wind speed and damping."""
    _not_the_case(image_path(out), case)
    _draw("hopf_map", _model(case), out)


@app.command()
def diagram(
    case: Case = None,
    along: Annotated[
        str, typer.Option("--along", metavar="NAME", help="Parameter to vary, such as section.damping_ratio.")
    ] = "wind.speed",
    until: Annotated[
        tuple[str, str] | None,
        typer.Option("--until", metavar="LOW HIGH", help="Its range, in m/s or with units: '0.05 %' '1 %'."),
    ] = None,
    out: Annotated[Path, typer.Option("--out", help="Image file (.png, .svg, .pdf).")] = Path("diagram.png"),
    table: Annotated[
        bool, typer.Option("--csv", help="Write every branch beside the image, as .csv files.")
    ] = False,
) -> None:
    """Compute and draw everything over wind speed: all equilibria, all vibrations, what is stable where."""
    _not_the_case(image_path(out), case)
    model = _model(case)
    study, windows = (
        import_module(f"rainwind.studies.{name}") for name in ("full_diagram", "diagram_window")
    )
    window = windows.window_from_text(along, until) if until else None
    window = windows.checked_window(model, along, window)
    for sentence in windows.unusual_ends(along, window):
        typer.echo(sentence, err=True)
    make_folder(out.parent)
    announce_compilation(orbits=True)
    with progress_bar() as bar, stopping_between_steps():
        task = bar.add_task("starting", total=None)

        def progress(done: int, total: int, what: str) -> None:
            bar.update(task, completed=done, total=total, description=what)
            raise_if_asked()

        found = study.compute(model, along, window, progress=progress)
    if found.empty:
        raise KeyboardInterrupt("stopped before anything was found: no picture is written")
    with unfinished(out) as part:
        study.save(found, part)
    for sentence in study.summary(found):
        typer.echo(sentence)
    written = [out, *(study.save_tables(found, out) if table else ())]
    if found.diagram.interrupted:
        raise KeyboardInterrupt(f"stopped; what was finished is in {', '.join(map(str, written))}")
    typer.echo(f"written to {', '.join(map(str, written))}")


@app.command()
def equilibria(
    case: Case = None,
    speed: Annotated[
        str | None, typer.Option("--speed", metavar="SPEED", help="Wind speed in m/s, or such as '32 km/h'.")
    ] = None,
    csv_file: Annotated[Path | None, typer.Option("--csv", help="Write the table to this file too.")] = None,
) -> None:
    """List all equilibria at one wind speed, with their kind and stability."""
    if csv_file is not None:
        _not_the_case(csv_file, case)
    model = _model(case)
    if speed is not None:
        from rainwind.parameters import replace_parameters

        model = replace_parameters(model, {"wind.speed": _speed(speed)})
    if csv_file is not None:
        make_folder(csv_file.parent)
    announce_compilation()
    found = import_module("rainwind.dynamics.equilibria").find_equilibria(model)
    header, rows = equilibria_table(model, found)
    noun = "equilibrium" if len(rows) == 1 else "equilibria"
    typer.echo(f"{len(rows)} {noun} at a wind speed of {model.wind.speed:g} m/s")
    certified = "all there are, certified: every equilibrium of the model as given"
    typer.echo(certified if found.complete else f"perhaps not all: {found.note}")
    print_table(header, [[f"{x:.4f}" if isinstance(x, float) else str(x) for x in row] for row in rows])
    if remark := range_remark(model, rows):
        typer.echo(remark)
    if csv_file is not None:
        with unfinished(csv_file) as part, part.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([header, *rows])
        typer.echo(f"written to {csv_file}")


@app.command()
def new(
    file: Annotated[Path, typer.Argument(help="Case file to write, such as case.toml.")],
    bridge: Annotated[bool, typer.Option("--bridge", help="A bridge with a stay, to be assessed.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")] = False,
) -> None:
    """Write a commented case file: the paper's sample case, or an example of a bridge."""
    from rainwind.io.case_files import new_case_text
    from rainwind.io.new_bridge import new_bridge_text

    if file.is_dir():
        raise InputError(f"{file}: is a folder; name a file in it, such as {file / 'case.toml'}")
    if file.exists() and not force:
        raise InputError(f"{file}: exists already; choose another name or give --force to overwrite it")
    make_folder(file.parent)
    file.write_text(new_bridge_text() if bridge else new_case_text(), encoding="utf-8")
    typer.echo(f"written to {file}; 'rainwind {'assess' if bridge else 'equilibria'} {file}' computes it")


@app.command()
def check(case: Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).")]) -> None:
    """Say what is wrong with a case file, every fault with its line, and which numbers are unusual."""
    from rainwind.io.bridge_cases import is_bridge_case, read_bridge
    from rainwind.io.cases import given_numbers, read_case
    from rainwind.io.usual import unusual
    from rainwind.io.usual_bridge import unusual_bridge

    bridge = read_bridge(case) if is_bridge_case(case) else None
    found = unusual(read_case(case), given_numbers(case)) if bridge is None else unusual_bridge(bridge)
    if bridge is not None and bridge.climate is not None:
        from rainwind.io.climate_files import read_climate

        for note in read_climate(bridge.climate).notes:
            typer.echo(f"{bridge.climate.path}: {note}")
    for sentence in found:
        typer.echo(f"{case}: {sentence}")
    count = "1 unusual number" if len(found) == 1 else f"{len(found)} unusual numbers"
    typer.echo(f"{case}: no fault, but {count}" if found else f"{case}: fine")


@app.command()
def schema(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="File to write; without it, to the screen.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")] = False,
) -> None:
    """Write the JSON schema of case files, with which an editor completes and checks keys."""
    from rainwind.io.json_schema import case_schema_text

    if file is None:
        typer.echo(case_schema_text(), nl=False)
        return
    if file.is_dir():
        raise InputError(f"{file}: is a folder; name a file in it, such as {file / 'case.schema.json'}")
    if file.exists() and not force:
        raise InputError(f"{file}: exists already; choose another name or give --force to overwrite it")
    make_folder(file.parent)
    file.write_text(case_schema_text(), encoding="utf-8")
    typer.echo(
        f"written to {file}; a case beside it that begins with '#:schema ./{file.name}' is checked by editors"
    )


def main() -> None:
    """Entry point of the `rainwind` program."""
    run_aside(app)


def _figure_number(text: str) -> int:
    known = ", ".join(map(str, FIGURES))
    number = int(text) if text.isascii() and text.isdecimal() and len(text) < 9 else None
    if number in FIGURES:
        return number
    reason = "is no result" if text.isdecimal() else "is no number"
    raise InputError(f"figure {text} {reason}; choose one of {known}")


def _not_the_case(out: Path, case: Path | None) -> None:
    if case is not None and out.exists() and case.exists() and out.samefile(case):
        raise InputError(f"{out}: is the case file itself; choose another name for the output")


def _model(case: Path | None) -> Any:
    if case is not None:
        from rainwind.io.cases import given_numbers, read_case
        from rainwind.io.usual import unusual

        model = read_case(case)
        for sentence in unusual(model, given_numbers(case)):
            typer.echo(f"{case}: {sentence}", err=True)
        return model
    typer.echo("no case file given: the paper's sample case", err=True)
    return import_module("rainwind.physics.model").paper_model()


def _speed(text: str) -> float:
    from rainwind.io.units import KINDS, from_text
    from rainwind.io.usual import FASTEST

    try:
        try:
            speed = float(text)
        except ValueError:
            speed = from_text(text, KINDS["speed"])
        if speed > FASTEST:
            raise InputError(f"is too fast: allowed is up to {FASTEST:g} m/s; correct the number or its unit")
        return speed
    except InputError as error:
        raise InputError(f"--speed '{text}' {error}") from error


def _draw(study: str, model: Any, out: Path) -> None:
    make_folder(out.parent)
    announce_compilation(orbits=study.startswith(("figure_07", "figure_09")))
    save_figure = import_module("rainwind.studies.paper_run").save_figure
    with unfinished(out) as part:
        sentences = save_figure(study, part, model=model)
    for sentence in sentences or ():
        typer.echo(sentence)
    typer.echo(f"written to {out}")


add_commands(app, _model, _not_the_case)
add_map_commands(app, _model, _not_the_case)
add_assess_command(app)

if __name__ == "__main__":
    main()
