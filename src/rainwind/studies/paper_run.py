"""The main job: every figure and number of the reproduction, with a report that can be filed.

In the folder: figures/*.png and *.svg, data.nc, targets.json, report.html.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from inspect import signature
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any

from matplotlib.figure import Figure

from rainwind import __version__
from rainwind.errors import InputError
from rainwind.io.results import Table, save_netcdf
from rainwind.physics.model import RivuletModel, paper_model
from rainwind.plotting import style
from rainwind.studies import paper, report
from rainwind.studies.targets import is_fitted, target
from rainwind.studies.targets_record import Outcome, Target
from rainwind.studies.targets_statements import STATEMENTS

STUDIES = (
    "figure_04_coefficients",
    "figure_05_equilibria",
    "figure_06_stability",
    "figure_07_limit_cycles",
    "figure_08_transient",
    "figure_09_stability_diagram",
    "figure_10_rivulet_and_frequency",
    "figure_11_mass_coefficients_dof",
    "hopf_map",
    "wind_sweep",
)
FORMATS = ("png", "svg")
_STOPPED = Outcome(note="not computed: the run was stopped before it", verdict="not_computed")
Progress = Callable[[int, int, str], None]


@dataclass
class Run:
    """What a run has made so far; it grows, so that a run that is stopped keeps what is there."""

    targets: dict[str, Target] = field(default_factory=dict)
    extended: dict[str, Target] = field(default_factory=dict)
    figures: list[Path] = field(default_factory=list)
    tables: dict[str, Table] = field(default_factory=dict)
    seconds: float = 0.0
    complete: bool = False


def run(out: Path, *, progress: Progress) -> Run:
    """Compute everything into the folder `out`, telling `progress(done, total, what)` before each step.

    Whatever stops it, an error or Ctrl-C, the data, targets and report of what is done are written first.
    """
    started, made = perf_counter(), Run()
    (out / "figures").mkdir(parents=True, exist_ok=True)
    blend, extend = paper.model(), paper_model(outside="extend")
    total = 2 * len(STATEMENTS) + len(STUDIES) + 1
    done = 0
    try:
        for model, into in ((blend, made.targets), (extend, made.extended)):
            for name in STATEMENTS:
                progress(done, total, f"target {name}, {model.outside}")
                into[name] = target(name, model)
                done += 1
        for name in STUDIES:
            words = name.replace("_", " ")
            progress(done, total, words)
            _study(
                name,
                blend,
                out / "figures",
                made,
                lambda what, words=words, at=done: progress(at, total, f"{words}: {what}"),
            )
            done += 1
        made.complete = True
    finally:
        progress(done, total, "report and data")
        made.seconds = perf_counter() - started
        _write(out, made)
    progress(total, total, "finished")
    return made


def save_figure(study: str, path: Path, *, model: RivuletModel) -> list[str]:
    """Compute and draw one study, such as "hopf_map", with any model; the suffix of `path` says the format.

    Returns what it shows in plain sentences, none where the study has none.

    Raises InputError for an unknown study, OSError where the file cannot be written.
    """
    module = _module(study)
    result = module.compute(model=model)
    style.save(module.draw(result, Figure()), path)
    return list(module.summary(result)) if hasattr(module, "summary") else []


def _module(study: str) -> ModuleType:
    if study not in STUDIES:
        raise InputError(f"there is no study '{study}'; choose one of {', '.join(STUDIES)}")
    return import_module(f"rainwind.studies.{study}")


def _study(name: str, model: RivuletModel, folder: Path, made: Run, progress: Callable[[str], None]) -> None:
    module = _module(name)
    # only what takes long tells its steps
    more = {"progress": progress} if "progress" in signature(module.compute).parameters else {}
    result = module.compute(model=model, **more)
    figure = module.draw(result, Figure())
    for suffix in FORMATS:
        style.save(figure, folder / f"{name}.{suffix}")
    made.tables |= {f"{name}/{label}": table for label, table in module.tables(result).items()}
    made.figures.append(folder / f"{name}.svg")


def _write(out: Path, made: Run) -> None:
    for found in (made.targets, made.extended):
        for name, statement in STATEMENTS.items():
            found.setdefault(name, Target(statement, _STOPPED, is_fitted(name, paper.model())))
    records = [
        one.record() | {"extend": _short(made.extended[name].record())} for name, one in made.targets.items()
    ]
    text = json.dumps(records, indent=2, ensure_ascii=False, allow_nan=False)
    (out / "targets.json").write_text(text + "\n", encoding="utf-8")
    captions = [report.Picture(path, _caption(path.stem)) for path in made.figures]
    page = report.page(records, captions, complete=made.complete, seconds=made.seconds)
    (out / "report.html").write_text(page, encoding="utf-8")
    # last, because it takes longest and nothing else needs it
    save_netcdf(out / "data.nc", made.tables, source=paper.SOURCE, version=__version__)


def _short(record: dict[str, Any]) -> dict[str, Any]:
    return {key: record[key] for key in ("computed", "verdict", "parts", "note")}


def _caption(study: str) -> str:
    """The study's own words: its CAPTION, or the first paragraph of its description."""
    module = _module(study)
    words = (getattr(module, "CAPTION", None) or module.__doc__ or study).strip()
    return " ".join(words.split("\n\n")[0].split())
