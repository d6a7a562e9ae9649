"""What the command line prints and where it writes: tables, progress, checks of places."""

import os
import sys
from collections import Counter
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from rainwind.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

INSIDE, OUTSIDE = "inside", "outside"


def announce_compilation(*, orbits: bool = False) -> None:
    """Say so before minutes of silence: the kernels are compiled on first use and then kept."""
    from rainwind.dynamics.kernels.compiling import are_compiled, folder

    orbits = orbits and not any(folder("orbit_newton").rglob("orbit_newton.correct*.nbi"))
    if orbits or not are_compiled():
        wait = "one to three minutes" if orbits else "about a minute"
        typer.echo(f"compiling the numerical kernels, once for this installation ({wait})", err=True)


def image_path(path: Path) -> Path:
    """The path, if its suffix is that of an image format that we write."""
    if path.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise InputError(f"--out {path}: '{path.suffix}' is no image format; end it with .png, .svg or .pdf")
    return path


def make_folder(folder: Path) -> None:
    """Make it now: a place that cannot be written is known before the computation, not after."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file, not a folder; choose another name")
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder}: cannot be written to; choose another folder or change its permissions")


def equilibria_table(model: Any, found: Any) -> tuple[list[str], list[list[float | str]]]:
    """The header, and a row for each equilibrium by rising angle.

    phi goes from leeward, -90 deg, over the top (0 without yaw), windward (90) and the bottom round to 270.
    The last column says whether the set's curves hold at the row's angle of attack, -phi at rest.
    """
    lengths = [name for name in ("y", "z") if name in model.states]
    millimetre = [f"{name} [mm]" for name in lengths]
    header = ["phi [deg]", *millimetre, "kind", "largest real part [1/s]", "coefficients' range"]
    rows: list[list[float | str]] = []
    for one in found:
        growth = float(max(value.real for value in one.eigenvalues))
        millimetres = [1000 * float(one[name]) for name in lengths]
        place = INSIDE if _is_covered(model, -float(one["phi"])) else OUTSIDE
        rows.append([(degrees(one["phi"]) + 90) % 360 - 90, *millimetres, one.kind, growth, place])
    return header, sorted(rows, key=lambda row: row[0])


def range_remark(model: Any, rows: list[list[float | str]]) -> str:
    """What rows outside the coefficients' range rest on; empty if there are none."""
    if all(row[-1] == INSIDE for row in rows):
        return ""
    low, high = (degrees(angle) for angle in model.coefficients.valid)
    rest = (
        "the passage into the bare cylinder" if model.outside == "blend" else "the curves drawn on beyond it"
    )
    return (
        f"outside: the coefficients '{model.coefficients.name}' hold for alpha = -phi from {low:.4g} to "
        f"{high:.4g} deg; these rows rest on {rest}, which nobody measured"
    )


def _is_covered(model: Any, alpha: float) -> bool:
    if model.outside == "blend":
        alpha = float(model.coefficients.usable_blend.weight_and_angle(alpha)[1])
    return bool(model.coefficients.covers(alpha))


def print_table(header: list[str], rows: list[list[str]]) -> None:
    """Print a table as wide as the terminal."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(*map(escape, header))
    for row in rows:
        table.add_row(*map(escape, row))
    console = _console()
    with console.capture() as text:
        console.print(table)
    typer.echo(text.get(), nl=False)


def print_targets(path: Path) -> None:
    """Print the targets of a `targets.json`."""
    import json

    targets = json.loads(path.read_text(encoding="utf-8"))
    rows = [
        [
            str(target["id"]),
            str(target["what"]),
            _number_text(target["paper"]),
            _number_text(target["computed"]),
            str(target["unit"] or ""),
            "yes" if target["fitted"] else "no",
            str(target["verdict"]),
        ]
        for target in targets
    ]
    print_table(["id", "what", "paper", "computed", "unit", "fitted", "verdict"], rows)
    counts = Counter(str(target["verdict"]).replace("_", " ") for target in targets)
    typer.echo(", ".join(f"{count} {verdict}" for verdict, count in counts.items()))
    if any(target["fitted"] for target in targets):
        typer.echo("fitted: the coefficients are reconstructed and were made to meet this; it tests nothing")


def _number_text(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_number_text, value))
    return "-" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def _console() -> "Console":
    from rich.console import Console

    # a table that is piped into a file or another program is not cut at 80 columns
    return Console(width=None if sys.stdout.isatty() else 160)


def progress_bar() -> Any:
    """A progress bar on stderr, to be entered by `with`."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
    )
