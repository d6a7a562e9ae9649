"""Regenerate `reference.json`; from the root: `python -m tests.validation.auto.make_reference` (about ten minutes)."""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from .auto_runner import Auto, Constants, LabelledPoint, Run, auto_version
from .orbit_reference import orbit_records
from .sample_case import (
    EQUATIONS,
    EQUILIBRIA,
    FOLD_CURVE,
    HOPF_CURVE,
    ORBITS,
    Equations,
    backward,
    fold_and_hopf_points,
    tight,
)

REFERENCE = Path(__file__).with_name("reference.json")

# what a row of the reference is called where AUTO's own label says something else
MEANING = {
    "HH": "AUTO prints ZH; two pairs of eigenvalues are imaginary: Hopf-Hopf",
    "FH": "AUTO prints ZH; fold-Hopf, where the Hopf curve touches the fold curve",
    "MAX": "AUTO prints LP; the largest damping ratio on the curve: the critical damping",
    "spurious": "AUTO prints GH; the Lyapunov coefficient changes sign through its pole at the "
    "fold-Hopf point, not through zero: the label's place moves into that point as DSMAX shrinks",
}


def point_record(point: LabelledPoint, equations: Equations, name: str = "") -> dict[str, Any]:
    """A labelled point of an equilibrium as plain data."""
    return {
        "auto_label": point.kind,
        "name": name or point.kind,
        "speed": point.parameters[0],
        "damping_ratio": point.parameters[1],
        "state": point.state[:6].tolist(),
        "eigenvalues": [[value.real, value.imag] for value in equations.eigenvalues(point)],
    }


def curve_records(run: Run, equations: Equations) -> list[dict[str, Any]]:
    """The labelled points of a Hopf or fold curve, with the names that they deserve."""

    def name(point: LabelledPoint) -> str:
        if point.kind == "ZH":
            imaginary = sum(abs(v.real) < 1e-6 and abs(v.imag) > 1 for v in equations.eigenvalues(point))
            return "HH" if imaginary == 4 else "FH"
        return {"LP": "MAX", "GH": "spurious"}.get(point.kind, point.kind)

    return [point_record(p, equations, name(p)) for p in run.labelled if p.kind != "EP"]


def compute(folder: Path) -> dict[str, Any]:
    """Everything that the reference stores, computed anew in `folder`."""
    auto = Auto(EQUATIONS, folder)
    equations = Equations(auto)
    constants: dict[str, Constants] = {
        "equilibria": tight(EQUILIBRIA) | {"UZR": {1: [9.0, 12.0, 20.0]}},
        "equilibria_low_damping": tight(EQUILIBRIA) | {"PAR": {2: 0.0005}},
        "hopf_curve": tight(backward(HOPF_CURVE))
        | {"DSMAX": 0.01, "DS": 0.002, "UZR": {2: [0.001, 0.002, 0.003, 0.004, 0.005, 0.006]}},
        "hopf_curve_finer": tight(backward(HOPF_CURVE)) | {"DSMAX": 0.0005, "DS": 0.0005, "NMX": 2000},
        "second_hopf_curve": tight(backward(HOPF_CURVE)) | {"UZR": {2: [0.0005, 0.0008, 0.001]}},
        "fold_curve": tight(FOLD_CURVE),
        "orbits": tight(ORBITS) | {"NTST": 80, "NMX": 200},
    }
    branch = auto.run(constants["equilibria"])
    fold, on_d, on_c = fold_and_hopf_points(branch)
    low = auto.run(constants["equilibria_low_damping"])
    # of the two Hopf points on D at 0.05 %, the one at 12.76 m/s belongs to the other pair of eigenvalues
    second_start = low.points("HB")[1]
    starts = {
        "equilibria": None,
        "equilibria_low_damping": None,
        "hopf_curve": on_c,
        "hopf_curve_finer": on_c,
        "second_hopf_curve": second_start,
        "fold_curve": fold,
    }
    names = {id(fold): "fold", id(on_d): "Hopf on D", id(on_c): "Hopf on C"}
    data: dict[str, Any] = {}
    for run_name, start in starts.items():
        run = branch if run_name == "equilibria" else auto.run(constants[run_name], start)
        if run_name.startswith("equilibria"):
            data[run_name] = [point_record(p, equations, names.get(id(p), "")) for p in run.labelled]
        else:
            data[run_name] = curve_records(run, equations)
    orbits = auto.run(constants["orbits"], on_d)
    data["orbits"] = [
        {
            "auto_label": p.kind,
            "name": {"LP": "lpc", "TR": "ns", "EP": "end"}.get(p.kind, p.kind),
            "speed": p.parameters[0],
            "damping_ratio": p.parameters[1],
            "period": p.parameters[10],
            "maxima": dict(zip(orbits.columns[2:7], orbits.table[p.point - 1, 2:7].tolist(), strict=True)),
        }
        for p in orbits.labelled
    ]
    compiler = subprocess.run(["gfortran", "-dumpfullversion"], capture_output=True, text=True, check=True)
    return {
        "made_by": "tests/validation/auto/make_reference.py",
        "auto_version": auto_version(),
        "gfortran_version": compiler.stdout.strip(),
        "model": "rainwind.f90: sample case of Peil & Nahrath (2003), set 'reconstructed' as raw polynomials",
        "units": "SI and radians; state: y, phi, z, y_dot, phi_dot, z_dot; eigenvalues as [real, imaginary]",
        "digits": "AUTO stores 11; see `accuracy`. Eigenvalues: LAPACK on the exact Jacobian at AUTO's point",
        "maxima": "of orbits: over AUTO's mesh points only, so good to about 3 digits",
        "meaning": MEANING,
        "accuracy": accuracy(auto, branch),
        "points": data,
        "orbits": orbit_records(auto),
        "constants": {name: dict(c) for name, c in constants.items()},
    }


def accuracy(auto: Auto, branch: Run) -> dict[str, dict[str, float]]:
    """How far the three main points move when the tolerances are a hundred times tighter still."""
    tighter = auto.run(EQUILIBRIA | {"EPSL": 1e-12, "EPSU": 1e-12, "EPSS": 1e-10})
    pairs = zip(fold_and_hopf_points(branch), fold_and_hopf_points(tighter), strict=True)
    moved = [
        {
            "speed": abs(a.parameters[0] - b.parameters[0]),
            "state": max(abs(a.state[:6] - b.state[:6])),
        }
        for a, b in pairs
    ]
    return dict(zip(("fold", "Hopf on D", "Hopf on C"), moved, strict=True))


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        reference = compute(Path(folder))
    REFERENCE.write_text(json.dumps(reference, indent=1) + "\n")
    print(f"{REFERENCE.name} written with AUTO-07p {reference['auto_version']}")


if __name__ == "__main__":
    main()
