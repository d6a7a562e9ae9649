"""Time AUTO-07p and rainwind on the same work, in turn, so that both meet the same load."""

from collections.abc import Callable, Mapping
from statistics import median
from time import perf_counter
from typing import Any

from tests.validation.auto.auto_runner import Auto

Runs = Mapping[str, tuple[Mapping[str, Any], Any, Callable[[], Any]]]


def side_by_side(auto: Auto, runs: Runs, repeats: int) -> list[dict[str, Any]]:
    """One row a run (AUTO's constants and start, our call): points, median milliseconds, the ratio ours / AUTO's.

    AUTO is timed once as it comes and once silent (IID = 0, no diagnostics written).
    """
    rows = []
    for name, (constants, start, call) in runs.items():
        found = call()
        points = 0
        times: dict[str, list[float]] = {"auto": [], "silent": [], "ours": []}
        for _ in range(repeats):
            timing = auto.time(constants, start, repeats=1)
            points = timing.points
            times["auto"].append(timing.wall_median)
            times["silent"].append(auto.time(dict(constants) | {"IID": 0}, start, repeats=1).wall_median)
            begin = perf_counter()
            found = call()
            times["ours"].append(perf_counter() - begin)
        ms = {key: 1e3 * median(values) for key, values in times.items()}
        rows.append(
            {
                "run": name,
                "points_auto": points,
                "points_ours": len(found),
                "labels_ours": [point.kind for point in found.points()],
                "ms_auto": ms["auto"],
                "ms_auto_silent": ms["silent"],
                "ms_ours": ms["ours"],
                "ratio": ms["ours"] / ms["auto"],
                "ratio_silent": ms["ours"] / ms["silent"],
            }
        )
    return rows
