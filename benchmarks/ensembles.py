"""Many trajectories of the paper's model: what one costs from a thousand to a hundred thousand, memory, two threads.

300 s each, tolerance 1e-9, wind speed, damping and start by Sobol's points; extremes of the last 60 s and final states
are kept. Each run is a process of its own, so that its peak memory is its own; the first run compiles and is thrown
away. `python -m benchmarks.ensembles` measures all (about ten minutes on two idle cores) and keeps it as JSON.
"""

import argparse
import json
import os
import subprocess
import sys
from datetime import date
from statistics import median
from time import perf_counter, process_time
from typing import Any

DURATION, TOLERANCE = 300.0, 1e-9
GOAL = {"trajectories": 100_000, "seconds": 480.0, "megabytes": 1000.0}


def one(many: int, threads: int) -> dict[str, Any]:
    """One ensemble: seconds in all and of the processors, per trajectory in ms, peak memory in MB."""
    import rainwind as rw

    model = rw.paper_model(coefficients="reconstructed")
    power = 2 ** (many - 1).bit_length()
    sample = rw.sobol(
        {"wind.speed": (6.0, 14.0), "section.damping_ratio": (0.0005, 0.005), "y": (0.0, 0.05)}, power
    )
    varying = {name: values[:many] for name, values in sample.values.items()}
    how = {"duration": DURATION, "tolerance": TOLERANCE, "workers": threads}
    rw.ensemble(model, {"phi": 0.6}, varying={n: v[:64] for n, v in varying.items()}, **how)
    begin, begin_cpu = perf_counter(), process_time()
    run = rw.ensemble(model, {"phi": 0.6}, varying=varying, reduce=rw.Extremes(since=DURATION - 60.0), **how)
    seconds, cpu = perf_counter() - begin, process_time() - begin_cpu
    return {
        "trajectories": many, "threads": threads, "seconds": seconds, "cpu_ms_each": 1e3 * cpu / many,
        "ms_each": 1e3 * seconds / many, "per_second": many / seconds, "steps_each": float(run.steps.sum() / many),
        "failed": int((~run.finished).sum()), "peak_mb": _peak_mb(),
        "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }  # fmt: skip


def _peak_mb() -> float | None:
    """The most memory this process has had, where the system tells."""
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)


def apart(many: int, threads: int) -> dict[str, Any]:
    """`one` in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.ensembles", "--one", str(many), str(threads)]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def scaling(sizes: tuple[int, ...] = (1_000, 10_000, 100_000), threads: int = 2) -> list[dict[str, Any]]:
    """One row for each size."""
    return [apart(many, threads) for many in sizes]


def two_threads(many: int = 2_000, repeats: int = 5) -> dict[str, Any]:
    """The throughput of two threads over that of one: runs in turns, the median of the ratios."""
    pairs = [(apart(many, 1), apart(many, 2)) for _ in range(repeats)]
    ratios = [both["per_second"] / single["per_second"] for single, both in pairs]
    return {
        "trajectories": many, "ratio": median(ratios), "ratios": ratios,
        "load_averages": [both["load_average"] for _, both in pairs],
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--one", nargs=2, type=int, metavar=("N", "THREADS"), help="one run, printed as JSON")
    parser.add_argument("--sizes", nargs="+", type=int, default=[1_000, 10_000, 100_000])
    parser.add_argument("--repeats", type=int, default=5, help="of two threads against one")
    parser.add_argument("--no-json", action="store_true", help="print only")
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(one(*arguments.one)))
        return
    from benchmarks.__main__ import RESULTS, _machine

    result = {
        "date": date.today().isoformat(), "machine": _machine(), "goal": GOAL,
        "scaling": scaling(tuple(arguments.sizes)), "two_threads": two_threads(repeats=arguments.repeats),
    }  # fmt: skip
    for row in result["scaling"]:
        print(
            f"{row['trajectories']:7d} trajectories, {row['threads']} threads: {row['seconds']:.4g} s, "
            f"{row['cpu_ms_each']:.3g} ms of a core each, {row['peak_mb']:.4g} MB, load {row['load_average']:.2f}"
        )
    print(f"two threads over one: {result['two_threads']['ratio']:.3g}")
    if not arguments.no_json:
        path = RESULTS / f"ensembles-{result['date']}.json"
        path.write_text(json.dumps(result, indent=1) + "\n")
        print(f"kept in {path.name}")


if __name__ == "__main__":
    main()
