"""Goals without a peer: what a user waits for."""

import subprocess
import sys
from importlib import import_module
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

import rainwind as rw
from rainwind.dynamics.system import as_system
from rainwind.studies.paper_run import STUDIES

FIGURES = tuple(name for name in STUDIES if name.startswith("figure_"))


def _median(call: Any, repeats: int) -> float:
    call()
    times = []
    for _ in range(repeats):
        begin = perf_counter()
        call()
        times.append(perf_counter() - begin)
    return median(times)


def _compute_all(studies: list[Any]) -> None:
    """Every figure anew: what the studies remember between figures is forgotten first."""
    for module in [m for name, m in list(sys.modules.items()) if name.startswith("rainwind.studies")]:
        for value in vars(module).values():
            if hasattr(value, "cache_clear"):
                value.cache_clear()
    for study in studies:
        study.compute()


def measure(repeats: int = 11) -> list[dict[str, Any]]:
    """One row a goal: what, the goal and the median, in seconds."""
    system = as_system(rw.paper_model())
    x = np.random.default_rng(0).normal(scale=0.1, size=(1000, 6))
    studies = [import_module(f"rainwind.studies.{name}") for name in FIGURES]
    rows = [
        ("J at 1000 points", 1e-3, _median(lambda: system.jacobian(x), 101)),
        ("all linear figures computed, warm", 3.0, _median(lambda: _compute_all(studies), 3)),
        (
            "rainwind --help",
            0.4,
            _median(
                lambda: subprocess.run([sys.executable, "-m", "rainwind", "--help"], capture_output=True),
                repeats,
            ),
        ),
    ]
    return [{"what": what, "goal_s": goal, "median_s": seconds} for what, goal, seconds in rows]
