"""Branches, curves and diagrams as named tables, SI and radians, for netCDF and CSV."""

from collections.abc import Sequence

import numpy as np

from rainwind.dynamics.results import Branch, SpecialPoint
from rainwind.io.results import Column, Table
from rainwind.studies.equilibrium_map import EquilibriumMap
from rainwind.studies.stability_diagram import ALONG, StabilityDiagram

_SPEED = "undisturbed wind speed"
_UNITS = {"y": "m", "phi": "rad", "z": "m", "y_dot": "m/s", "phi_dot": "rad/s", "z_dot": "m/s"}
_MEANINGS = {
    "y": "cross-wind displacement", "phi": "rivulet angle", "z": "in-wind displacement",
    "wind.speed": _SPEED, "section.damping_ratio": "damping ratio, 1 = critical",
}  # fmt: skip


def equilibrium_tables(known: EquilibriumMap) -> dict[str, Table]:
    """A table for each equilibrium by letter, and one of the special points."""
    tables = {}
    for number, side in enumerate(known.sides):
        inside = side.inside
        branch = side.branch
        columns = {"wind_speed": Column(branch.parameter[inside], "m/s", _SPEED)}
        for name in branch.states[: len(branch.states) // 2]:
            columns[name] = Column(branch[name][inside], _UNITS.get(name, ""), _MEANINGS.get(name, ""))
        columns["growth"] = Column(
            np.real(branch.eigenvalues[inside]).max(axis=1), "1/s", "largest real part of the eigenvalues"
        )
        columns["unstable"] = Column(branch.unstable[inside], "", "eigenvalues with positive real part")
        tables[f"equilibrium_{side.letter or f'other_{number}'}"] = Table(columns)
    tables["special_points"] = points_table([p for branch in known.branches for p in branch.special])
    return tables


def diagram_tables(diagram: StabilityDiagram) -> dict[str, Table]:
    """The fold curve, every piece of the Hopf curves, the special points, and the field where there is one."""
    tables: dict[str, Table] = {}
    if diagram.fold is not None:
        tables["fold"] = curve_table(diagram.fold)
    for number, piece in enumerate(diagram.pieces, 1):
        columns = {
            "wind_speed": Column(piece.speed, "m/s", _SPEED),
            "damping_ratio": Column(piece.ratio, "", _MEANINGS[ALONG[1]]),
        }
        tables[f"hopf_{number}"] = Table(
            columns, {"equilibrium": piece.letter, "other_unstable": piece.others}
        )
    tables["special_points"] = points_table(diagram.points)
    if diagram.field is not None:
        field, grid = diagram.field, ("damping_ratio", "wind_speed")
        tables["field"] = Table(
            {
                "wind_speed": Column(field.speed, "m/s", _SPEED, ("wind_speed",)),
                "damping_ratio": Column(field.ratio, "", _MEANINGS[ALONG[1]], ("damping_ratio",)),
                "growth": Column(field.growth, "1/s", "largest real part of D's eigenvalues", grid),
                "unstable": Column(field.count, "", "eigenvalues of D with positive real part", grid),
            }
        )
    return tables


def curve_table(curve: Branch) -> Table:
    """A curve in two parameters."""
    return Table(
        {
            "wind_speed": Column(curve[ALONG[0]], "m/s", _SPEED),
            "damping_ratio": Column(curve[ALONG[1]], "", _MEANINGS[ALONG[1]]),
            "phi": Column(curve["phi"], "rad", _MEANINGS["phi"]),
        }
    )


def points_table(points: Sequence[SpecialPoint]) -> Table:
    """Labelled points: kind, speed, damping ratio, angle, first frequency, Lyapunov coefficient."""
    return Table(
        {
            "kind": Column(np.array([p.kind for p in points], dtype=object), "", "kind of special point"),
            "wind_speed": Column(np.array([p.parameters[ALONG[0]] for p in points]), "m/s", _SPEED),
            "damping_ratio": Column(
                np.array([p.parameters[ALONG[1]] for p in points]), "", _MEANINGS[ALONG[1]]
            ),
            "phi": Column(np.array([p["phi"] for p in points]), "rad", _MEANINGS["phi"]),
            "omega": Column(np.array([_first_omega(p) for p in points]), "rad/s", "angular frequency"),
            "lyapunov": Column(
                np.array([np.nan if p.lyapunov is None else p.lyapunov for p in points]),
                "",
                "first Lyapunov coefficient, Kuznetsov's normalisation",
            ),
        }
    )


def _first_omega(point: SpecialPoint) -> float:
    omega = point.omega[0] if isinstance(point.omega, tuple) else point.omega
    return np.nan if omega is None else float(omega)
