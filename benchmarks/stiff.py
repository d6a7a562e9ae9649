"""`python -m benchmarks.stiff`: light rivulets, which make the model stiff: both engines, the choice, and SciPy.

5 s of the paper's model at 12 m/s. Errors are those of the last state against Radau at 1e-11, relative to the largest
value that each state has had. SciPy's Radau gets f and the exact Jacobian from the same tape. Medians of five runs, CPU
time of one core; runs that would take over a million steps are left out.
"""

from statistics import median
from time import process_time

import numpy as np
from scipy.integrate import solve_ivp

import rainwind as rw
from rainwind.dynamics.system import System, as_system

DURATION = 5.0
MASSES = (0.2, 1e-2, 1e-3, 1e-4)
START = {"phi": 1.0}


def measure(repeats: int = 5) -> list[dict[str, float | str]]:
    """One row a mass and method: seconds, steps, error."""
    rows: list[dict[str, float | str]] = []
    for mass in MASSES:
        model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 12.0, "rivulet.mass": mass})
        system = as_system(model)
        reference, sizes, _ = _radau(system, 1e-11)
        for method in ("auto", "rosenbrock", "taylor"):
            for tolerance in (1e-6, 1e-9):
                run = rw.simulate(
                    model, START, duration=DURATION, method=method, tolerance=tolerance, most_steps=10**6
                )
                times = []
                for _ in range(repeats):
                    begun = process_time()
                    rw.simulate(
                        model, START, duration=DURATION, method=method, tolerance=tolerance, most_steps=10**6
                    )
                    times.append(process_time() - begun)
                error = float(np.max(np.abs(run.end - reference) / sizes))
                rows.append(_row(mass, method, tolerance, median(times), len(run), error))
        for tolerance in (1e-6, 1e-9):
            begun = process_time()
            end, _, steps = _radau(system, tolerance)
            error = float(np.max(np.abs(end - reference) / sizes))
            rows.append(_row(mass, "SciPy Radau", tolerance, process_time() - begun, steps, error))
    return rows


def _radau(system: System, tolerance: float) -> tuple[np.ndarray, np.ndarray, int]:
    run = solve_ivp(
        lambda t, x: system.f(x), (0.0, DURATION), system.state(START), method="Radau",
        jac=lambda t, x: system.jacobian(x), rtol=tolerance, atol=1e-3 * tolerance,
    )  # fmt: skip
    return run.y[:, -1], np.abs(run.y).max(axis=1), run.t.size - 1


def _row(
    mass: float, method: str, tolerance: float, seconds: float, steps: int, error: float
) -> dict[str, float | str]:
    return {
        "mass": mass, "method": method, "tolerance": tolerance, "seconds": seconds, "steps": steps, "error": error,
    }  # fmt: skip


if __name__ == "__main__":
    print(f"{'rivulet.mass':>12} {'method':12}{'tolerance':>10}{'ms':>10}{'steps':>9}{'error':>10}")
    for row in measure():
        ms = 1e3 * float(row["seconds"])
        what = f"{row['mass']:12g} {row['method']:12}{row['tolerance']:10.0e}"
        print(f"{what}{ms:10.2f}{row['steps']:9d}{row['error']:10.1e}")
