"""`python -m benchmarks` (or `make benchmark`): every benchmark, printed and kept as JSON with machine and versions."""

import argparse
import json
import os
import platform
from datetime import date
from importlib.metadata import version
from pathlib import Path

from tests.validation.auto.auto_runner import auto_directory, auto_version

from benchmarks import goals, linear, orbits

RESULTS = Path(__file__).parent / "results"


def _machine() -> dict[str, str | int | float | None]:
    cpu = next(
        (line.split(":")[1].strip() for line in _lines("/proc/cpuinfo") if line.startswith("model name")),
        platform.processor(),
    )
    return {
        "cpu": cpu,
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "python": platform.python_version(),
        **{name: version(name) for name in ("rainwind", "numpy", "numba", "llvmlite")},
        "auto-07p": auto_version() if auto_directory() else None,
    }


def _lines(path: str) -> list[str]:
    return Path(path).read_text().splitlines() if Path(path).exists() else []


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=21, help="runs of each; medians are printed")
    parser.add_argument("--no-json", action="store_true", help="print only")
    arguments = parser.parse_args()
    result: dict = {"date": date.today().isoformat(), "machine": _machine()}
    if auto_directory() is None:
        print("AUTO-07p is not installed (Debian: auto-07p and gfortran): no comparison with it")
    else:
        rows = linear.against_auto(arguments.repeats)
        # orbits take a hundred times as long: fewer repeats
        rows += orbits.against_auto(max(3, arguments.repeats // 4))
        result["against_auto"] = rows
        print(
            f"{'run':16}{'points':>12}{'AUTO ms':>10}{'silent ms':>11}{'ours ms':>9}{'ratio':>8}{'silent':>8}"
        )
        for row in rows:
            points = f"{row['points_auto']}/{row['points_ours']}"
            times = f"{row['ms_auto']:10.2f}{row['ms_auto_silent']:11.2f}{row['ms_ours']:9.2f}"
            print(f"{row['run']:16}{points:>12}{times}{row['ratio']:8.2f}{row['ratio_silent']:8.2f}")
    result["orbits_by_mesh"] = orbits.scaling()
    for row in result["orbits_by_mesh"]:
        print(f"{row['intervals']:5d} mesh intervals: {row['ms_an_orbit']:.3f} ms an orbit")
    result["goals"] = goals.measure()
    for row in result["goals"]:
        print(f"{row['what']:40} {row['median_s']:.4g} s (goal {row['goal_s']:g} s)")
    if not arguments.no_json:
        RESULTS.mkdir(exist_ok=True)
        path = RESULTS / f"benchmark-{result['date']}.json"
        path.write_text(json.dumps(result, indent=1) + "\n")
        orbits.draw_scaling(result["orbits_by_mesh"], RESULTS / "orbits_by_mesh.svg")
        print(f"kept in {path.name}")


if __name__ == "__main__":
    main()
