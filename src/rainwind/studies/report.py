"""The report of a reproduction run: one HTML page that needs nothing beside it."""

import platform
import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from importlib.resources import files
from math import pi
from pathlib import Path
from typing import Any

import jinja2

from rainwind import __version__
from rainwind.dynamics.results import SpecialPoint
from rainwind.studies import paper
from rainwind.studies.targets_record import VERDICTS
from rainwind.studies.targets_upper_rivulet import hopf_curves, upper_rivulet

LIBRARIES = ("numpy", "scipy", "numba", "matplotlib", "xarray", "h5netcdf", "jinja2")
WORDS = {
    "met": "met",
    "partly": "partly",
    "missed": "missed",
    "not_computed": "not computed",
    "impossible": "impossible",
}
UNITS = {  # of the sample case's table: factor from SI, unit
    "wind.speed": (1.0, "m/s"),
    "wind.yaw": (180.0 / pi, "deg"),
    "wind.vertical_speed": (1.0, "m/s"),
    "wind.density": (1.0, "kg/m³"),
    "section.diameter": (1.0, "m"),
    "section.mass": (1.0, "kg/m"),
    "section.frequency_y": (1.0, "Hz"),
    "section.frequency_z": (1.0, "Hz"),
    "section.damping_ratio": (100.0, "%"),
    "section.inclination": (180.0 / pi, "deg"),
    "section.k2_y": (1.0, "N/m³"),
    "section.k3_y": (1.0, "N/m⁴"),
    "section.k2_z": (1.0, "N/m³"),
    "section.k3_z": (1.0, "N/m⁴"),
    "rivulet.mass": (1.0, "kg/m"),
    "rivulet.height": (1.0, "m"),
    "rivulet.friction": (1.0, "Nms/m"),
}


@dataclass(frozen=True)
class Picture:
    """A figure's file and the words below it."""

    path: Path
    caption: str

    @property
    def address(self) -> str:
        """The picture itself as an address that needs no file."""
        return "data:image/svg+xml;base64," + b64encode(self.path.read_bytes()).decode("ascii")

    @property
    def width(self) -> str:
        """On the page: one and a half times its size in print."""
        points = re.search(rb'<svg[^>]* width="([0-9.]+)pt"', self.path.read_bytes())
        return f"{1.5 * float(points[1]):.0f}pt" if points else "100%"


@dataclass(frozen=True)
class Check:
    """A located point and how well it holds."""

    where: str
    kind: str
    certificate: str
    holds: bool


def page(
    records: Sequence[Mapping[str, Any]], pictures: Sequence[Picture], *, complete: bool, seconds: float
) -> str:
    """The whole page; `records` as in targets.json, each with its "extend"."""
    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    environment.filters |= {"number": number_text, "words": WORDS.__getitem__}
    template = (files("rainwind.studies") / "templates" / "report.html.j2").read_text(encoding="utf-8")
    model = paper.model()
    checks, faults = certificates()
    return environment.from_string(template).render(
        records=records,
        counts=[(name, sum(r["verdict"] == name for r in records)) for name in VERDICTS],
        pictures=pictures,
        readings=paper.READINGS,
        coefficients=model.coefficients,
        parameters=[(name, *_shown(name, value)) for name, value in model.parameters.items()],
        checks=checks,
        faults=faults,
        versions=versions(),
        made=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        complete=complete,
        seconds=seconds,
    )


def number_text(value: Any, digits: int = 5) -> str:
    """Numbers with so many significant digits, lists with commas, nothing as a dash, words as they are."""
    if value is None:
        return "–"
    if isinstance(value, list | tuple):
        return ", ".join(number_text(one, digits) for one in value)
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def markdown_table(records: Sequence[Mapping[str, Any]]) -> str:
    """The table of docs/paper.md: each target with blend and extend side by side."""
    rows = [
        (
            record["id"],
            record["what"],
            number_text(record["paper"]),
            number_text(record["computed"]),
            number_text(record["extend"]["computed"]),
            record["unit"],
            "fitted" if record["fitted"] else "predicted" if record["computed"] is not None else "",
            WORDS[record["verdict"]],
            WORDS[record["extend"]["verdict"]],
        )
        for record in records
    ]
    header = ("", "statement", "paper", "blend", "extend", "unit", "set", "verdict, blend", "verdict, extend")
    return _markdown(header, rows)


def markdown_details(record: Mapping[str, Any]) -> str:
    """The numbers behind one target, as a table of docs/paper.md."""
    details = record["details"]
    return _markdown(details["header"], [[number_text(cell) for cell in row] for row in details["rows"]])


def _markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def certificates() -> tuple[list[Check], list[str]]:
    """The special points of the sample case's branch C-D and Hopf curves; and what their audit found."""
    model = paper.model()
    upper = upper_rivulet(model)
    walks = [] if upper is None else [("equilibria C and D over wind speed", upper.branch)]
    walks += [("Hopf curve over wind speed and damping", curve) for curve, _ in hopf_curves(model)]
    checks = [
        Check(where, _named(point), str(point.certificate), point.certificate.holds)
        for where, branch in walks
        for point in branch.special
    ]
    return checks, [f"{where}: {fault}" for where, branch in walks for fault in branch.audit()]


def versions() -> dict[str, str]:
    """What this was computed with."""
    found = {"rainwind": __version__, "Python": platform.python_version(), "system": platform.platform()}
    return found | {name: metadata.version(name) for name in LIBRARIES}


def _named(point: SpecialPoint) -> str:
    kinds = {"fold": "fold", "hopf": "Hopf", "zh": "fold-Hopf", "hh": "Hopf-Hopf", "gh": "generalised Hopf"}
    at = f"U = {point.parameters['wind.speed']:.6g} m/s"
    if len(point.along) == 2:
        at += f", xi = {100 * point.parameters['section.damping_ratio']:.5g} %"
    return f"{kinds.get(point.kind, point.kind)} at {at}"


def _shown(name: str, value: float) -> tuple[str, str]:
    scale, unit = UNITS[name]
    return f"{scale * value:.6g}", unit
