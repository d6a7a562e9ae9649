"""An assessment of twelve stays (examples/fred_hartman), and a point of its stability grid beside a certified search.

`python -m benchmarks.assessment` prints both and keeps them as JSON. The goal is two minutes on two cores.
"""

import argparse
import json
import os
from datetime import date
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

import rainwind as rw
from rainwind.engineering.linear_stability import growth
from rainwind.engineering.upper_rivulet import upper_rivulets

EXAMPLE = Path(__file__).parents[1] / "examples" / "fred_hartman" / "case.toml"
GOAL_S = 120.0


def bridge() -> dict[str, Any]:
    """The whole bridge, once, after one stay that loads the kernels."""
    given = rw.read_bridge(EXAMPLE)
    climate = rw.read_climate(given.climate) if given.climate is not None else None
    rw.assess(
        rw.Bridge("warm", given.stays[:1], given.site, question=rw.Question(modes=1, directions=4, samples=2))
    )
    begin = perf_counter()
    answer = rw.assess(given, climate)
    question = given.question
    return {
        "stays": len(given.stays), "modes": question.modes, "directions": question.directions,
        "samples": question.samples * len(question.sets), "seconds": perf_counter() - begin, "goal_s": GOAL_S,
        "failed": sum(bool(stay.failure) for stay in answer.stays),
        "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }  # fmt: skip


def point(repeats: int = 5) -> dict[str, Any]:
    """Equilibrium D and its eigenvalues at a point: in the grid of an assessment, and by the certified search."""
    model = rw.paper_model()
    names = ("rivulet.mass", "rivulet.friction", "lift slope", "drag slope", "moment slope")
    factors = {name: np.ones(8) for name in names}
    yaw, speed = np.linspace(-1.0, 1.0, 36), np.geomspace(3.0, 40.0, 64)
    beta = np.arctan2(np.sin(yaw) * np.sin(np.pi / 4), np.cos(yaw))

    def grid() -> float:
        begin = perf_counter()
        growth(model, factors, upper_rivulets(model, factors, beta), yaw, speed)
        return (perf_counter() - begin) / (8 * yaw.size * speed.size)

    def search() -> float:
        some = np.linspace(9.0, 30.0, 20)
        begin = perf_counter()
        for u in some:
            for one in rw.find_equilibria(model.with_parameters({"wind.speed": float(u)})):
                _ = one.eigenvalues
        return (perf_counter() - begin) / some.size

    grid(), search()
    pairs = [(grid(), search()) for _ in range(repeats)]
    return {
        "grid_us": 1e6 * median(a for a, _ in pairs), "search_us": 1e6 * median(b for _, b in pairs),
        "ratio": median(a / b for a, b in pairs),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--no-json", action="store_true", help="print only")
    arguments = parser.parse_args()
    from benchmarks.__main__ import RESULTS, _machine

    result = {"date": date.today().isoformat(), "machine": _machine(), "point": point(), "bridge": bridge()}
    at, whole = result["point"], result["bridge"]
    print(
        f"a point: {at['grid_us']:.3g} us, by certified search {at['search_us']:.4g} us, ratio {at['ratio']:.3g}"
    )
    print(
        f"{whole['stays']} stays: {whole['seconds']:.3g} s (goal {GOAL_S:g} s), load {whole['load_average']:.2f}"
    )
    if not arguments.no_json:
        path = RESULTS / f"assessment-{result['date']}.json"
        path.write_text(json.dumps(result, indent=1) + "\n")
        print(f"kept in {path.name}")


if __name__ == "__main__":
    main()
