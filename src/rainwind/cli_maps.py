"""Commands that follow many trajectories to their end: `rainwind basins`, `rainwind map`, `rainwind probability`."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from rainwind.cli_output import announce_compilation, image_path, make_folder, progress_bar
from rainwind.cli_work import raise_if_asked, stopping_between_steps, unfinished
from rainwind.errors import InputError

__all__ = ["add_map_commands"]

_MOST = 400  # cells a side

Case = Annotated[
    Path | None,
    typer.Argument(metavar="[CASE]", help="Case file (TOML); without it the paper's sample case."),
]
Out = Annotated[Path, typer.Option("--out", help="Image file (.png, .svg, .pdf).")]
Data = Annotated[bool, typer.Option("--data", help="Write the numbers beside the image, as .csv and .nc.")]
Cells = Annotated[
    tuple[int, int] | None,
    typer.Option("--cells", metavar="ACROSS UP", help="How many cells, across and up."),
]
Duration = Annotated[
    str | None,
    typer.Option(
        "--longest", metavar="TIME", help="How long a run may take to settle, in s or such as '30 min'."
    ),
]


def add_map_commands(
    app: typer.Typer, read: Callable[[Path | None], Any], guard: Callable[[Path, Path | None], None]
) -> None:
    """Add the commands. read: a case file, or None, to a model; guard(out, case): the output is not the case itself."""

    @app.command("map")
    def map_(
        case: Case = None,
        until: Annotated[
            tuple[str, str] | None,
            typer.Option("--until", metavar="LOW HIGH", help="Range of wind speeds, in m/s or with units."),
        ] = None,
        damping: Annotated[
            tuple[str, str] | None,
            typer.Option(
                "--damping", metavar="LOW HIGH", help="Range of damping ratios, such as '0.01 %' '0.8 %'."
            ),
        ] = None,
        cells: Cells = None,
        longest: Duration = None,
        out: Out = Path("map.png"),
        data: Data = False,
    ) -> None:
        """Draw what happens over wind speed and damping: rest, vibration, beats, chaos, a lost rivulet."""
        guard(image_path(out), case)
        model = read(case)
        windows = {"speeds": _window("--until", "wind.speed", until)}
        windows["ratios"] = _window("--damping", "section.damping_ratio", damping)
        options = {**windows, "shape": _cells(cells), "longest": _time(longest)}
        _run("attractor_map", model, out, data, options)

    @app.command()
    def basins(
        case: Case = None,
        speed: Annotated[
            str | None,
            typer.Option("--speed", metavar="SPEED", help="Wind speed in m/s, or such as '32 km/h'."),
        ] = None,
        plane: Annotated[
            str,
            typer.Option(
                "--plane", help="'cable': y and phi; 'rivulet': phi and phi_dot; or two states: 'z,phi'."
            ),
        ] = "cable",
        cells: Cells = None,
        longest: Duration = None,
        out: Out = Path("basins.png"),
        data: Data = False,
    ) -> None:
        """Draw which start leads to which end at one wind speed, and with which share of all starts."""
        guard(image_path(out), case)
        model = read(case)
        if speed is not None:
            model = model.with_parameters({"wind.speed": _number("--speed", "wind.speed", speed)})
        options = {"plane": _plane(plane), "shape": _cells(cells), "longest": _time(longest)}
        _run("basins", model, out, data, options)

    @app.command()
    def probability(
        case: Case = None,
        until: Annotated[
            tuple[str, str] | None,
            typer.Option("--until", metavar="LOW HIGH", help="Range of wind speeds, in m/s or with units."),
        ] = None,
        mass: Annotated[float | None, typer.Option(help="Scatter of the rivulet's mass in %.")] = None,
        damping: Annotated[
            float | None, typer.Option(help="Scatter of the damping ratio in % of it.")
        ] = None,
        slopes: Annotated[
            float | None, typer.Option(help="Scatter of the coefficients' slopes in %.")
        ] = None,
        samples: Annotated[int, typer.Option(help="Samples at each wind speed.")] = 256,
        sobol: Annotated[
            int, typer.Option(help="Base samples of the Sobol indices, a power of two; 0: none.")
        ] = 512,
        out: Out = Path("probability.png"),
        data: Data = False,
    ) -> None:
        """Draw how likely a vibration is when rivulet, damping, coefficients and wind scatter, and what decides."""
        guard(image_path(out), case)
        model = read(case)
        given = {"rivulet.mass": mass, "section.damping_ratio": damping}
        given |= dict.fromkeys(("lift slope", "drag slope", "moment slope"), slopes)
        options = {
            "speeds": _window("--until", "wind.speed", until), "samples": samples, "sobol": sobol,
            "scatter": {name: share / 100.0 for name, share in given.items() if share is not None},
        }  # fmt: skip
        _run("vibration_probability", model, out, data, options)


def _run(name: str, model: Any, out: Path, data: bool, options: dict[str, Any]) -> None:
    """Compute with progress, draw, write, say; Ctrl-C keeps what is done."""
    study = import_module(f"rainwind.studies.{name}")
    make_folder(out.parent)
    announce_compilation()
    with progress_bar() as bar, stopping_between_steps():
        task = bar.add_task("starting", total=None)

        def progress(done: int, total: int, what: str) -> None:
            bar.update(task, completed=done, total=total, description=what)
            raise_if_asked()

        given = {key: value for key, value in options.items() if value is not None}
        found = study.compute(model, **given, progress=progress)
    if found.empty:
        raise KeyboardInterrupt("stopped before anything was finished: no picture is written")
    with unfinished(out) as part:
        study.save(found, part)
    for sentence in study.summary(found):
        typer.echo(sentence)
    written = ", ".join(map(str, [out, *(study.save_data(found, out) if data else ())]))
    if found.partial:
        raise KeyboardInterrupt(f"stopped; what was finished is in {written}")
    typer.echo(f"written to {written}")


def _cells(cells: tuple[int, int] | None) -> tuple[int, int] | None:
    if cells is not None and not all(2 <= many <= _MOST for many in cells):
        raise InputError(f"--cells {cells[0]} {cells[1]}: give two numbers from 2 to {_MOST}")
    return cells


def _plane(text: str) -> tuple[str, str]:
    from rainwind.studies.basins import PLANES

    names = PLANES.get(text) or tuple(name.strip() for name in text.split(","))
    if len(names) != 2:
        raise InputError(
            f"--plane '{text}': give {', '.join(PLANES)} or two states with a comma between, such as z,phi"
        )
    return names[0], names[1]


def _window(option: str, along: str, ends: tuple[str, str] | None) -> tuple[float, float] | None:
    if ends is None:
        return None
    from rainwind.studies.diagram_window import window_from_text

    try:
        low, high = window_from_text(along, ends)
    except InputError as error:
        raise InputError(str(error).replace("--until", option)) from error
    if not 0.0 <= low < high:
        raise InputError(f"{option} {ends[0]} {ends[1]}: give two values, zero or above, the lower one first")
    return low, high


def _number(option: str, along: str, text: str) -> float:
    from rainwind.studies.diagram_window import window_from_text

    try:
        return window_from_text(along, (text, text))[0]
    except InputError as error:
        raise InputError(str(error).replace("--until", option)) from error


def _time(text: str | None) -> float | None:
    if text is None:
        return None
    words = text.split()
    factors = {"s": 1.0, "min": 60.0, "h": 3600.0}
    try:
        value = float(words[0]) * factors[words[1] if len(words) > 1 else "s"]
        if len(words) > 2 or not 0.0 < value < 1e7:
            raise ValueError
    except (ValueError, KeyError, IndexError):
        raise InputError(
            f"--longest '{text}': give a time above zero, such as 2000, '2000 s' or '30 min'"
        ) from None
    return value
