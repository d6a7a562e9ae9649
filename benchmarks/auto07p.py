"""How long AUTO-07p takes for the paper's sample case; from the root: `python -m benchmarks.auto07p`.

Only AUTO's compiled executable is timed, its start and its files included; rainwind computes nothing here.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from tests.validation.auto.auto_runner import Auto, Timing, auto_directory, auto_version
from tests.validation.auto.sample_case import (
    EQUATIONS,
    EQUILIBRIA,
    FOLD_CURVE,
    HOPF_CURVE,
    LPC_CURVE,
    NS_CURVE,
    ORBIT_BRANCH,
    ORBITS,
    backward,
    extended,
    fold_and_hopf_points,
    tight,
)


def time_auto(folder: Path, *, repeats: int = 21) -> dict[str, Timing]:
    """Timings of AUTO's executable by name of the run; `folder` keeps its files."""
    auto = Auto(EQUATIONS, folder)
    fold, on_d, on_c = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
    silent = {"IID": 0}  # no diagnostics in fort.9
    orbits = ORBITS | {"NMX": 200}
    branch = auto.run(ORBIT_BRANCH, on_d)
    lpc = extended(auto, LPC_CURVE, branch.points("LP")[0])
    ns = extended(auto, NS_CURVE, branch.points("TR")[0])
    runs = {
        "process start (equilibria, NMX = 1)": (EQUILIBRIA | {"NMX": 1}, None),
        "equilibria": (EQUILIBRIA, None),
        "equilibria, silent": (EQUILIBRIA | silent, None),
        "equilibria, tight": (tight(EQUILIBRIA), None),
        "equilibria, tight, silent": (tight(EQUILIBRIA) | silent, None),
        "equilibria, differences for Jacobians, silent": (EQUILIBRIA | silent | {"JAC": 0}, None),
        "equilibria, no detection, silent": (EQUILIBRIA | silent | {"ISP": 0, "ILP": 0}, None),
        "Hopf curve from C": (backward(HOPF_CURVE), on_c),
        "Hopf curve from C, silent": (backward(HOPF_CURVE) | silent, on_c),
        "Hopf curve from C, tight, silent": (backward(tight(HOPF_CURVE)) | silent, on_c),
        "fold curve": (FOLD_CURVE, fold),
        "fold curve, silent": (FOLD_CURVE | silent, fold),
        "fold curve, tight, silent": (tight(FOLD_CURVE) | silent, fold),
        "orbits from D, NTST 40, 200 points, silent": (orbits | silent, on_d),
        "orbits from D, NTST 80, 200 points, tight, silent": (tight(orbits) | silent | {"NTST": 80}, on_d),
        "orbits, whole branch, NTST 60": (ORBIT_BRANCH, on_d),
        "orbits, whole branch, NTST 60, silent": (ORBIT_BRANCH | silent, on_d),
        "orbits: LPC curve, NTST 60": (LPC_CURVE, lpc),
        "orbits: LPC curve, NTST 60, silent": (LPC_CURVE | silent, lpc),
        "orbits: NS curve, NTST 60": (NS_CURVE, ns),
        "orbits: NS curve, NTST 60, silent": (NS_CURVE | silent, ns),
    }
    # the orbits take a hundred times as long: fewer repeats
    return {
        name: auto.time(constants, start, repeats=min(repeats, 5) if "orbits" in name else repeats)
        for name, (constants, start) in runs.items()
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=21, help="runs of each; the median is printed")
    arguments = parser.parse_args()
    if auto_directory() is None:
        raise SystemExit("AUTO-07p is not installed (Debian: auto-07p and gfortran)")
    print(f"AUTO-07p {auto_version()}, one thread; median of {arguments.repeats} runs, times in ms")
    print(f"{'run':52}{'points':>7}{'wall':>9}{'best':>9}{'cpu':>9}{'own clock':>11}{'us/point':>10}")
    with tempfile.TemporaryDirectory() as folder:
        for name, t in time_auto(Path(folder), repeats=arguments.repeats).items():
            times = (t.wall_median, t.wall_best, t.cpu_median)
            row = "".join(f"{1e3 * seconds:9.2f}" for seconds in times)
            print(f"{name:52}{t.points:7d}{row}{1e3 * t.reported_median:11.2f}{1e6 * t.per_point:10.1f}")


if __name__ == "__main__":
    main()
