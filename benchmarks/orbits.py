"""rainwind against AUTO-07p, in one run: a branch of limit cycles with all labels, and two curves of special points.

Both do the same work on the sample case (raw polynomials) with 60 mesh intervals of degree 4: all cycles born at the
Hopf point on D at xi = 0.2 %, round both folds to the Hopf point on C; then 200 points of the curve of folds of cycles
and of the Neimark-Sacker curve in (U, xi). AUTO: its executable alone, start and files included, once as it comes and
once silent (IID = 0, no diagnostics written); its Jacobians are exact. rainwind: the call in a warm process, with
normal forms, certificates and Liouville's check, which AUTO has not; its mesh has 60 intervals and is never refined
here. Tolerances alike (1e-7 for AUTO, 1e-9 here); on the branch the same bound of steps (0.037), on the curves such
steps that the number of points is the same within 10 %; the same labels are found. Runs alternate, so that both meet
the same load.
"""

import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from tests.validation.auto.auto_runner import Auto
from tests.validation.auto.sample_case import (
    EQUATIONS,
    EQUILIBRIA,
    LPC_CURVE,
    NS_CURVE,
    ORBIT_BRANCH,
    extended,
    fold_and_hopf_points,
    tight,
)

import rainwind as rw
from benchmarks.side_by_side import side_by_side

_SPEED, _DAMPING = "wind.speed", "section.damping_ratio"
_WINDOW = {_SPEED: (4.0, 25.0), _DAMPING: (1e-4, 0.01)}
_MESH = rw.Mesh(60)


def against_auto(repeats: int = 5) -> list[dict[str, Any]]:
    """One row a run: points and median milliseconds of both, and the ratio ours / AUTO's."""
    with tempfile.TemporaryDirectory() as folder:
        auto = Auto(EQUATIONS, Path(folder))
        _, on_d, _ = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
        branch = auto.run(ORBIT_BRANCH, on_d)
        lpc = extended(auto, LPC_CURVE, branch.points("LP")[0])
        ns = extended(auto, NS_CURVE, branch.points("TR")[0])
        ours = _ours()
        runs = {
            "cycles": (ORBIT_BRANCH, on_d, ours["cycles"]),
            "folds of cycles": (LPC_CURVE, lpc, ours["lpc"]),
            "Neimark-Sacker": (NS_CURVE, ns, ours["ns"]),
        }
        return side_by_side(auto, runs, repeats)


def _hopf_on_d() -> tuple[rw.RivuletModel, rw.SpecialPoint]:
    model = rw.paper_model(outside="extend")
    at_9 = rw.find_equilibria(model.with_parameters({_SPEED: 9.0}))
    on_d = min(at_9, key=lambda e: abs(np.degrees(e["phi"]) - 45.0))
    equilibria = rw.continue_equilibria(model, _SPEED, start=on_d, until=_WINDOW[_SPEED])
    return model, max(equilibria.points("hopf"), key=lambda p: p.parameter)


# AUTO goes one way for 200 points. Ours go both ways: so far, or at such a step, that they have as many in all
_LIMIT, _NS_STEP = 135, 0.083


def _ours() -> dict[str, Callable[[], rw.OrbitBranch]]:
    model, hopf = _hopf_on_d()
    both = (_SPEED, _DAMPING)

    def cycles() -> rw.OrbitBranch:
        return rw.continue_orbits(model, _SPEED, start=hopf, until=_WINDOW[_SPEED], ds=0.037, mesh=_MESH)

    branch = cycles()
    lpc, ns = branch.points("lpc")[0], branch.points("ns")[0]
    return {
        "cycles": cycles,
        "lpc": lambda: rw.continue_lpc(
            model, both, start=lpc, until=_WINDOW, ds=0.1, mesh=_MESH, limit=_LIMIT
        ),
        "ns": lambda: rw.continue_ns(model, both, start=ns, until=_WINDOW, ds=_NS_STEP, mesh=_MESH),
    }


def scaling(intervals: tuple[int, ...] = (15, 30, 60, 120, 240), repeats: int = 5) -> list[dict[str, Any]]:
    """Milliseconds an orbit of the cycle branch, by number of mesh intervals: the cost should grow in proportion."""
    model, hopf = _hopf_on_d()
    rows = []
    for many in intervals:
        times = []
        for _ in range(repeats + 1):
            begin = perf_counter()
            found = rw.continue_orbits(
                model, _SPEED, start=hopf, until=(11.0, 15.0), mesh=rw.Mesh(many, 4, many), limit=60
            )
            times.append(1e3 * (perf_counter() - begin) / len(found))
        rows.append({"intervals": many, "ms_an_orbit": median(times[1:])})
    return rows


def draw_scaling(rows: list[dict[str, Any]], path: Path) -> None:
    """The cost of an orbit over the number of mesh intervals, with a straight line through the origin's offset."""
    many = np.array([row["intervals"] for row in rows])
    cost = np.array([row["ms_an_orbit"] for row in rows])
    slope, offset = np.polyfit(many, cost, 1)
    figure = Figure(figsize=(4.5, 3.2), layout="constrained")
    axes = figure.subplots()
    axes.plot(
        many, slope * many + offset, color="0.6", label=f"{offset:.2f} ms + {1e3 * slope:.1f} us an interval"
    )
    axes.plot(many, cost, "ko", label="measured (median)")
    axes.set(xlabel="mesh intervals (degree 4)", ylabel="time an orbit (ms)", xlim=(0, None), ylim=(0, None))
    axes.legend(frameon=False)
    figure.savefig(path)
