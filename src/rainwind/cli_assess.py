"""The command `rainwind assess`: from a case file of stays to a report."""

from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from rainwind.cli_output import announce_compilation, make_folder, print_table, progress_bar
from rainwind.cli_work import raise_if_asked, stopping_between_steps
from rainwind.errors import ComputationError, InputError

__all__ = ["add_assess_command"]

_KEPT = ".finished_stays"


def add_assess_command(app: typer.Typer) -> None:
    """Add the command."""

    @app.command()
    def assess(
        case: Annotated[
            Path, typer.Argument(metavar="CASE", help="Case file (TOML) with one stay or a bridge of them.")
        ],
        out: Annotated[Path, typer.Option("--out", help="Folder for the report; made if needed.")] = Path(
            "assessment"
        ),
        fresh: Annotated[
            bool, typer.Option("--fresh", help="Compute anew what an earlier run into this folder finished.")
        ] = False,
        workers: Annotated[
            int | None, typer.Option("--workers", min=1, help="Threads; by default one for each processor.")
        ] = None,
    ) -> None:
        """Say of every stay whether rain and wind make it vibrate and how much damping stops it: a report to file."""
        bridge, text = _read(case)
        climate = None
        if bridge.climate is not None:
            climate = import_module("rainwind.io.climate_files").read_climate(bridge.climate)
            for note in climate.notes:
                typer.echo(f"{bridge.climate.path}: {note}", err=True)
        make_folder(out)
        kept = out / _KEPT
        if fresh and kept.is_dir():
            for file in kept.glob("stay-*.json"):
                file.unlink()
        announce_compilation()
        assessment = import_module("rainwind.engineering.assessment")
        with progress_bar() as bar, stopping_between_steps():
            task = bar.add_task("starting", total=None)

            def progress(done: int, total: int, what: str) -> None:
                bar.update(task, completed=done, total=total, description=what)
                raise_if_asked()

            answer = assessment.assess(
                bridge, climate, checkpoint=kept, workers=workers, progress=progress, case_text=text
            )
        if not answer.stays:
            raise KeyboardInterrupt("stopped before the first stay was finished: no report is written")
        written = import_module("rainwind.reporting.report").write_report(answer, out, climate=climate)
        _print(answer)
        names = ", ".join(path.name for path in written)
        if answer.interrupted:
            raise KeyboardInterrupt(
                f"stopped; the report on {len(answer.stays)} of {len(bridge.stays)} stays is in {out} ({names}); "
                "the same command goes on from there"
            )
        typer.echo(f"written to {out}: {names}")
        failed = [stay.cable.name for stay in answer.stays if stay.failure]
        if failed:
            raise ComputationError(f"could not be assessed: {', '.join(failed)}; the report says why")


def _read(case: Path) -> tuple[Any, str]:
    """The bridge and the text of its file. InputError for a section's case."""
    files = import_module("rainwind.io.bridge_cases")
    if case.is_file() and not files.is_bridge_case(case):
        raise InputError(
            f"{case}: describes one section, not a stay; 'rainwind new --bridge FILE' writes an example of a case that "
            "can be assessed"
        )
    bridge = files.read_bridge(case)
    for sentence in files.unusual_bridge(bridge):
        typer.echo(f"{case}: {sentence}", err=True)
    return bridge, case.read_text(encoding="utf-8-sig")


def _print(answer: Any) -> None:
    """One row a stay: the verdict and the numbers behind it."""
    words = import_module("rainwind.reporting.words")
    print_table(*words.summary_rows(answer))
