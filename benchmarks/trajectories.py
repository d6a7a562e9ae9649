"""Trajectories and monodromy matrices beside heyoka and SciPy, in one run: work against the error that was achieved.

300 s of the paper's model at 12 m/s from points of its stable cycle, where errors do not grow; the error is the
largest of all states and starts against a run of heyoka's at 1e-17 with compensated sums. One core, CPU time. heyoka:
batches of eight lanes, the tape's operations one to one; ours: the same tape. Both take turns, so that both meet the
same load. Between tolerances times are interpolated (log-log) to a worst error of 1e-9. LSODA (odeint) with a rhs
compiled by numba and DOP853 with the model's Python rhs run once each, at tolerances that reach 1e-9. Without heyoka
only ours and SciPy's run.
"""

import json
import math
from collections.abc import Callable
from datetime import date
from math import log
from statistics import median
from time import perf_counter, process_time
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numba import njit
from scipy.integrate import odeint, solve_ivp
from tests.validation import heyoka_peer

import rainwind as rw
from benchmarks.__main__ import RESULTS, _machine
from rainwind.dynamics.kernels import machine_code
from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.system import System, as_system
from rainwind.dynamics.tangent_tape import with_tangents
from rainwind.dynamics.tape import Named
from rainwind.dynamics.taylor import TaylorEngine

DURATION, WANTED, LANES = 300.0, 1e-9, 8
TOLERANCES = {
    "ours": (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-13),
    "heyoka": (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-11, 1e-13),
}
MODELS = ("extend", "blend")


def measure(repeats: int = 5) -> list[dict[str, Any]]:
    """One row a model: work-precision points of each program, ms a trajectory at the wanted error, ratios."""
    return [_one(outside, repeats) for outside in MODELS]


def _system(outside: str) -> System:
    model = rw.paper_model(outside=outside)  # type: ignore[arg-type]
    return as_system(model.with_parameters({"wind.speed": 12.0}))


def _on_the_cycle(system: System, many: int) -> np.ndarray:
    """States (many, n) along the stable cycle, after 3000 s from beside the unstable focus."""
    focus = next(e for e in rw.find_equilibria(system) if "focus" in repr(e))
    start = focus.state + 0.02
    engine = TaylorEngine(system, 1e-12)
    times = 3000.0 + np.linspace(0.0, 1.0, many, endpoint=False)
    return engine.advance(np.tile(start, (many, 1)), times, _parameters(system)).states


def _parameters(system: System) -> np.ndarray:
    return np.array([*system.parameters.values()])


def _one(outside: str, repeats: int) -> dict[str, Any]:
    system = _system(outside)
    starts = _on_the_cycle(system, 8 * LANES)
    few, parameters = starts[::LANES], _parameters(system)
    calls: dict[str, dict[float, Callable[[np.ndarray], np.ndarray]]] = {"ours": {}}
    for tolerance in TOLERANCES["ours"]:
        engine = TaylorEngine(system, tolerance, lanes=LANES)
        calls["ours"][tolerance] = lambda x, e=engine: e.advance(x, DURATION, parameters).states
    row: dict[str, Any] = {"model": outside, "compile_s": _compile_seconds(system)}
    if heyoka_peer.heyoka is not None:
        exact = heyoka_peer.integrator(system, 1e-17, LANES, compensated=True)
        reference = heyoka_peer.propagate(exact, few, DURATION)
        calls["heyoka"] = {}
        for tolerance in TOLERANCES["heyoka"]:
            run = heyoka_peer.integrator(system, tolerance, LANES)
            calls["heyoka"][tolerance] = lambda x, r=run: heyoka_peer.propagate(r, x, DURATION)
    else:
        reference = TaylorEngine(system, 1e-15, order=30).advance(few, DURATION, parameters).states
    row["points"] = _points(calls, starts, few, reference, repeats)
    row["ms_at_wanted"] = {name: _at(points, WANTED) for name, points in row["points"].items()}
    for name, call in (("lsoda_numba", _lsoda), ("dop853_python", _dop853)):
        row["points"][name] = points = call(system, few[0], reference[0])
        row["ms_at_wanted"][name] = points[-1]["ms"]
    ours = row["ms_at_wanted"]["ours"]
    row["ratios"] = {name: ours / ms for name, ms in row["ms_at_wanted"].items() if name != "ours"}
    return row


def _points(
    calls: dict[str, dict[float, Callable[[np.ndarray], np.ndarray]]], starts: np.ndarray, few: np.ndarray,
    reference: np.ndarray, repeats: int,
) -> dict[str, list[dict[str, float]]]:  # fmt: skip
    """Of each program: tolerance, worst error, median CPU milliseconds a trajectory; in turns."""
    every = [(name, tolerance, call) for name, each in calls.items() for tolerance, call in each.items()]
    errors = [float(np.max(np.abs(call(few) - reference))) for _, _, call in every]
    times: list[list[float]] = [[] for _ in every]
    for _ in range(repeats):
        for (_, _, call), mine in zip(every, times, strict=True):
            begin = process_time()
            call(starts)
            mine.append(1e3 * (process_time() - begin) / len(starts))
    points: dict[str, list[dict[str, float]]] = {name: [] for name in calls}
    for (name, tolerance, _), error, mine in zip(every, errors, times, strict=True):
        points[name].append({"tolerance": tolerance, "error": error, "ms": median(mine)})
    return points


def _at(points: list[dict[str, float]], error: float) -> float:
    """Milliseconds at an error between two points, both logarithmic."""
    rising = sorted(points, key=lambda point: point["error"])
    return float(
        np.exp(np.interp(log(error), [log(p["error"]) for p in rising], [log(p["ms"]) for p in rising]))
    )


def _compile_seconds(system: System) -> float:
    """Until a new engine could take its first step, with no code kept from before."""
    kept, machine_code._kept = machine_code._kept, lambda path: None
    known = dict(machine_code._addresses)
    machine_code._addresses.clear()
    begin = perf_counter()
    TaylorEngine(system, WANTED, lanes=LANES)
    seconds = perf_counter() - begin
    machine_code._kept = kept
    machine_code._addresses.update(known)
    return seconds


# SciPy


def _lsoda(system: System, start: np.ndarray, reference: np.ndarray) -> list[dict[str, float]]:
    rhs = compiled_rhs(system)
    rhs(start)

    def solve(tolerance: float) -> np.ndarray:
        times = np.array([0.0, DURATION])
        return odeint(lambda x, t: rhs(x), start, times, rtol=tolerance, atol=tolerance, mxstep=10**8)[-1]

    return _until_wanted(solve, reference, (1e-10, 1e-11, 1e-12, 1e-13))


def _dop853(system: System, start: np.ndarray, reference: np.ndarray) -> list[dict[str, float]]:
    model = rw.paper_model(outside=_outside(system)).with_parameters({"wind.speed": 12.0})  # type: ignore[arg-type]
    names, values = tuple(model.parameters), [*model.parameters.values()]
    p = Named(names, values, "parameter")

    def rhs(t: float, x: np.ndarray) -> Any:
        return model.rhs(Named(system.states, [float(value) for value in x], "state"), p)

    def solve(tolerance: float) -> np.ndarray:
        run = solve_ivp(rhs, (0.0, DURATION), start, method="DOP853", rtol=tolerance, atol=tolerance)
        return run.y[:, -1]

    return _until_wanted(solve, reference, (1e-8, 1e-9, 1e-10))


def _outside(system: System) -> str:
    return next(o for o in MODELS if len(_system(o).tape.operations) == len(system.tape.operations))


def _until_wanted(
    solve: Callable[[float], np.ndarray], reference: np.ndarray, tolerances: tuple[float, ...]
) -> list[dict[str, float]]:
    """Ever finer tolerances until the wanted error is reached."""
    points = []
    for tolerance in tolerances:
        begin = process_time()
        end = solve(tolerance)
        ms = 1e3 * (process_time() - begin)
        points.append({"tolerance": tolerance, "error": float(np.max(np.abs(end - reference))), "ms": ms})
        if points[-1]["error"] <= WANTED:
            break
    return points


def compiled_rhs(system: System) -> Callable[..., Any]:
    """The tape as straight-line Python, compiled by numba, with the parameters as numbers."""
    tape = system.tape
    n = len(system.states)
    names = [f"x[{i}]" for i in range(n)] + [repr(float(v)) for v in system.parameters.values()]
    names += [repr(float(v)) for v in tape.template[len(names) :]]
    lines = []
    for code, z, a, b in tape.operations.tolist():
        x, y = names[a], names[b]
        names[z] = f"s{z}"
        lines.append(f"s{z} = " + _SOURCE[code].format(x=x, y=y))
        if code == op.SINCOS:
            names[z + 1] = f"s{z + 1}"
            lines.append(f"s{z + 1} = math.cos({x})")
    result = ", ".join(names[z] for z in tape.outputs.tolist())
    source = "def rhs(x):\n    " + "\n    ".join([*lines, f"return np.array([{result}])"])
    room: dict[str, Any] = {"np": np, "math": math}
    exec(source, room)
    return njit(room["rhs"])


_SOURCE = {
    op.ADD: "{x} + {y}", op.SUB: "{x} - {y}", op.MUL: "{x} * {y}", op.DIV: "{x} / {y}", op.NEG: "-{x}",
    op.SINCOS: "math.sin({x})", op.ATAN2: "math.atan2({x}, {y})", op.TANH: "math.tanh({x})", op.EXP: "math.exp({x})",
    op.SQRT: "math.sqrt({x})", op.LOG: "math.log({x})", op.POWER: "{x} ** {y}",
}  # fmt: skip


# monodromy matrices


def monodromy(repeats: int = 11, tolerance: float = 1e-12) -> dict[str, Any]:
    """CPU milliseconds a matrix over the period of the cycle at 12 m/s.

    difference: between our matrix and heyoka's, the largest, as a share of the largest entry. Ours: eight orbits at a
    time with all directions in each lane, and one orbit with a direction in each of six lanes.
    """
    system = _system("extend")
    n, parameters = len(system.states), _parameters(system)
    starts = _on_the_cycle(system, LANES)
    period = rw.shoot(system, starts[0], period=1.0).period
    identity = np.tile(np.eye(n).ravel(), (LANES, 1))
    each = TaylorEngine(with_tangents(system.tape), tolerance, controlled=n, lanes=LANES)
    together = TaylorEngine(with_tangents(system.tape, n), tolerance, controlled=n, lanes=LANES)
    wide = np.hstack([starts, identity])
    narrow = np.hstack([np.tile(starts[0], (n, 1)), np.eye(n)])
    calls: dict[str, tuple[Callable[[], np.ndarray], int]] = {
        "eight orbits": (lambda: together.advance(wide, period, parameters).states[:, n:], LANES),
        "one orbit in lanes": (
            lambda: each.advance(narrow, period, parameters).states[:, n:].reshape(1, -1),
            1,
        ),
    }
    if heyoka_peer.heyoka is not None:
        run = heyoka_peer.integrator(system, tolerance, LANES, tangents=True)
        # heyoka keeps dx_i(t)/dx_j(0) by rows
        by_rows = np.hstack([starts, identity])
        calls["heyoka"] = lambda: heyoka_peer.propagate(run, by_rows, period)[:, n:], LANES
    times: dict[str, list[float]] = {name: [] for name in calls}
    found = {name: call()[0].reshape(n, n) for name, (call, _) in calls.items()}
    for _ in range(repeats):
        for name, (call, matrices) in calls.items():
            begin = process_time()
            for _ in range(10):
                call()
            times[name].append(1e2 * (process_time() - begin) / matrices)
    ms = {name: median(values) for name, values in times.items()}
    row: dict[str, Any] = {"period_s": period, "tolerance": tolerance, "ms": ms}
    ours = found["eight orbits"].T  # kept one direction after the other
    if "heyoka" in ms:
        row["ratios"] = {name: ms[name] / ms["heyoka"] for name in ms if name != "heyoka"}
        row["difference"] = float(np.max(np.abs(ours - found["heyoka"])) / np.max(np.abs(ours)))
    return row


def draw(rows: list[dict[str, Any]], path: Any) -> None:
    """Work against precision of all programs."""
    figure = Figure(figsize=(5.0 * len(rows), 4.0), layout="constrained")
    for number, row in enumerate(rows):
        axes = figure.add_subplot(1, len(rows), number + 1)
        for name, points in row["points"].items():
            axes.loglog([p["error"] for p in points], [p["ms"] for p in points], "o-", label=name)
        axes.set(xlabel="worst error after 300 s", ylabel="CPU ms a trajectory", title=row["model"])
        axes.legend()
    figure.savefig(path)


def _version() -> str | None:
    return None if heyoka_peer.heyoka is None else heyoka_peer.heyoka.__version__


def main() -> None:
    """`python -m benchmarks.trajectories`: printed, and kept as JSON and a picture with machine and versions."""
    result: dict[str, Any] = {
        "date": date.today().isoformat(),
        "machine": _machine() | {"heyoka": _version()},
    }
    result["trajectories"] = rows = measure()
    for row in rows:
        print(
            f"{row['model']}: compiled in {row['compile_s']:.2f} s; CPU ms for {DURATION:g} s at {WANTED:g}:"
        )
        for name, ms in row["ms_at_wanted"].items():
            print(
                f"  {name:14}{ms:10.3f}"
                + (f"   ours / it {row['ratios'][name]:.4f}" if name != "ours" else "")
            )
    result["monodromy"] = row = monodromy()
    for name, ms in row["ms"].items():
        ratio = f"   / heyoka {row['ratios'][name]:.2f}" if name in row.get("ratios", {}) else ""
        print(f"monodromy matrix, {name:20}{ms:8.3f} ms{ratio}")
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / f"trajectories-{result['date']}.json"
    path.write_text(json.dumps(result, indent=1) + "\n")
    draw(rows, path.with_suffix(".svg"))
    print(f"kept in {path.name}")


if __name__ == "__main__":
    main()
