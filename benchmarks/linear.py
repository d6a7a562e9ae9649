"""rainwind against AUTO-07p, in one run: the equilibrium branch with all labels, its fold and its Hopf curve.

Both do the same work on the sample case (xi = 0.2 %, raw polynomials): U = 4 ... 25 m/s down branch D, round the fold
and up C; then both curves in (U, xi). AUTO: its executable alone, start and files included, once as it comes and once
silent (IID = 0, no diagnostics written). rainwind: the call in a warm process. Tolerances alike (1e-7 for AUTO, 1e-8
here); steps of at most 0.05 for the branch, and on the curves, whose arclengths differ, as long as the number of points
is the same within 10 %. Runs alternate, so that both meet the same load.
"""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from tests.validation.auto.auto_runner import Auto
from tests.validation.auto.sample_case import (
    EQUATIONS,
    EQUILIBRIA,
    FOLD_CURVE,
    HOPF_CURVE,
    backward,
    fold_and_hopf_points,
    tight,
)

import rainwind as rw
from benchmarks.side_by_side import side_by_side

_SPEED, _DAMPING = "wind.speed", "section.damping_ratio"
_WINDOW = {_SPEED: (4.0, 25.0), _DAMPING: (2e-4, 0.01)}


def against_auto(repeats: int = 21) -> list[dict[str, Any]]:
    """One row a run: points and median milliseconds of both, and the ratio ours / AUTO's."""
    with tempfile.TemporaryDirectory() as folder:
        auto = Auto(EQUATIONS, Path(folder))
        fold, _, on_c = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
        ours = _ours()
        runs = {
            "equilibria": (EQUILIBRIA, None, ours["equilibria"]),
            "fold curve": (FOLD_CURVE, fold, ours["fold"]),
            "Hopf curve": (backward(HOPF_CURVE), on_c, ours["hopf"]),
        }
        return side_by_side(auto, runs, repeats)


def _ours() -> dict[str, Callable[[], rw.Branch]]:
    model = rw.paper_model(outside="extend")
    at_9 = rw.find_equilibria(model.with_parameters({_SPEED: 9.0}))
    on_d = min(at_9, key=lambda e: abs(np.degrees(e["phi"]) - 45.0))

    def branch() -> rw.Branch:
        return rw.continue_equilibria(model, _SPEED, start=on_d, until=_WINDOW[_SPEED], ds=0.05)

    (fold,), hopf = branch().points("fold"), branch().points("hopf")[0]
    return {
        "equilibria": branch,
        "fold": lambda: rw.continue_fold(model, (_SPEED, _DAMPING), start=fold, until=_WINDOW, ds=0.25),
        "hopf": lambda: rw.continue_hopf(model, (_SPEED, _DAMPING), start=hopf, until=_WINDOW, ds=0.14),
    }
