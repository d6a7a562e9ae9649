"""What `reference.json` stores about limit cycles: cycles, branches with every label, curves in two parameters.

A label of AUTO depends on its step, and some are never printed. So each branch is run with several steps, the labels
are joined, and a change of the number of unstable multipliers that none of them explains is located on cycles that
`refined_orbit` polishes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .auto_runner import Auto, Constants, LabelledPoint, Run
from .refined_orbit import (
    NotConverged,
    RefinedOrbit,
    critical,
    crossing,
    distance,
    explicit_flow,
    fold_of_cycles,
    gauss_flow,
    multipliers_by_iteration,
    multipliers_by_product,
    refine,
)
from .sample_case import (
    EQUILIBRIA,
    LPC_CURVE,
    NS_CURVE,
    ORBITS,
    PD_CURVE,
    Equations,
    backward,
    extended,
    fold_and_hopf_points,
    tight,
)

Record = dict[str, Any]

DAMPING = 0.002  # of the sample case
SPEEDS = (9.0, 10.0, 12.0, 13.0, 14.0)
STEPS = (0.05, 0.02, 0.01)
NAMES = {"LP": "lpc", "PD": "pd", "TR": "ns"}
CURVE_DAMPINGS = (0.0002, 0.0005, 0.001, 0.0015, 0.0018, 0.002, 0.0025, 0.003, 0.0035, 0.004, 0.0045)

BRANCH = tight(ORBITS) | {"NTST": 100, "NMX": 4000, "DSMAX": 0.02}
FINER = BRANCH | {"NTST": 200, "DSMAX": 0.03}


def orbit_records(auto: Auto) -> Record:
    """The value of the key "orbits"."""
    equations = Equations(auto)
    _, on_d, on_c = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
    # AUTO goes round the end of a branch that has shrunk to a Hopf point: stop it just before
    whole = BRANCH | {"UZSTOP": {1: [float(on_c.parameters[0]) + 1e-4, 25.1]}}
    run = auto.run(whole | {"UZR": {1: list(SPEEDS)}}, on_d)
    finer = auto.run(FINER | {"UZSTOP": whole["UZSTOP"]}, on_d)
    branches = sample_branches(auto, equations)
    return {
        "units": "SI and radians; state: y, phi, z, y_dot, phi_dot, z_dot; multipliers as [real, imaginary]",
        "what": {
            "cycles": "xi = 0.2 %: every cycle at some wind speeds, polished by refined_orbit.py from AUTO's",
            "branches": "cycles from each Hopf point, all labels of runs with several DSMAX",
            "curves": "of LPC, NS and PD points in (U, xi): at given damping ratios, their labels, a coarse line",
            "polished": "by refined_orbit.py, not by AUTO; `from_auto` says how far AUTO is from it",
        },
        "cycles": [cycle_record(equations, run, p) for p in run.points("UZ") if min_gap(p) < 1e-6],
        "branches": [record for _, record in branches],
        "curves": curve_records(auto, equations, run, branches),
        "accuracy": {
            "branch, NTST 100 against 200": label_gap(run, finer),
            "curves": "points carry `moved`, NTST 60 against 120; labels `spread`, over steps, meshes and orders",
            "cycles": "each carries `agreement`, the distance of two independent solutions",
            "polished": "two independent solutions agree within 1e-11; digits beyond that are rounding",
        },
        "constants": {
            "branch": whole,
            "branch_finer": FINER,
            "steps": list(STEPS),
            "curve": tight(LPC_CURVE) | {"NMX": 400, "UZR": {2: list(CURVE_DAMPINGS)}},
        },
    }


def min_gap(point: LabelledPoint) -> float:
    return float(min(abs(point.parameters[0] - speed) for speed in SPEEDS))


def pairs(values: np.ndarray) -> list[list[float]]:
    """Complex numbers as [real, imaginary]; parts that are rounding of a real number are zero."""
    return [[float(v.real), float(v.imag) if abs(v.imag) > 1e-12 * abs(v) else 0.0] for v in values]


def unstable(values: np.ndarray) -> int:
    """How many multipliers lie outside the unit circle; the one nearest 1 is the trivial one."""
    others = np.delete(values, np.argmin(np.abs(values - 1)))
    return int(np.sum(np.abs(others) > 1))


def cycle_record(equations: Equations, run: Run, point: LabelledPoint) -> Record:
    """One cycle at a round wind speed, by two ways, and how far they and AUTO are apart."""
    speed = min(SPEEDS, key=lambda s: abs(point.parameters[0] - s))
    first = refine(equations, point, explicit_flow, speed=speed)
    second = refine(equations, point, gauss_flow, speed=speed)
    multipliers, others = multipliers_by_product(first), multipliers_by_iteration(second)
    logs, other_logs = np.log(np.abs(multipliers)), np.log(np.abs(others))
    return {
        "speed": speed,
        "damping_ratio": first.damping_ratio,
        "period": second.period,
        "multipliers": pairs(multipliers),
        "log_abs_multipliers": logs.tolist(),
        "unstable": unstable(multipliers),
        "half_peak_to_peak": peaks(second),
        "maxima": dict(zip(("y", "phi", "z"), second.maxima.tolist(), strict=True)),
        "minima": dict(zip(("y", "phi", "z"), second.minima.tolist(), strict=True)),
        "mean": second.mean.tolist(),
        "state": second.states[0].tolist(),
        "integral_of_trace": second.trace,
        "auto": {
            "period": point.parameters[10],
            "state": point.state[:6].tolist(),
            "multipliers": pairs(run.spectrum(point.point)),
        },
        "agreement": {
            "period": abs(first.period - second.period),
            "state": float(np.abs(first.states - second.states).max()),
            "multipliers_relative": distance(multipliers, others),
            "log_multipliers": float(np.abs(logs - other_logs).max()),
            "trivial_multiplier": float(np.min(np.abs(multipliers - 1))),
            "liouville": abs(float(logs.sum()) - second.trace),
            "auto_period": abs(point.parameters[10] - second.period),
            "auto_state": float(np.abs(point.state[:6] - second.states[0]).max()),
        },
    }


def peaks(orbit: RefinedOrbit) -> dict[str, float]:
    return dict(zip(("y", "phi", "z"), ((orbit.maxima - orbit.minima) / 2).tolist(), strict=True))


def label_gap(first: Run, second: Run) -> list[Record]:
    """How far labels move to the other mesh."""
    rows = []
    for name in NAMES:
        for p in first.points(name):
            same = [q for q in second.points(name) if abs(q.parameters[0] - p.parameters[0]) < 1e-3]
            best = min(same, key=lambda q: abs(q.parameters[10] - p.parameters[10]), default=None)
            row: Record = {"name": NAMES[name], "speed": p.parameters[0], "found": best is not None}
            if best is not None:
                row |= {
                    "speed_moved": abs(best.parameters[0] - p.parameters[0]),
                    "period_moved": abs(best.parameters[10] - p.parameters[10]),
                }
            rows.append(row)
    return rows


# ---- branches ----


@dataclass
class Change:
    """The count of unstable multipliers changes between two rows of a run."""

    row: int  # the one after
    speeds: tuple[float, float]
    periods: tuple[float, float]
    before: int
    after: int


def changes(run: Run, ends: Sequence[float]) -> list[Change]:
    """All of a run, but those within 0.01 m/s of a Hopf point at the end: there 6 digits do not tell 1 from 1."""
    found: list[Change] = []
    last: tuple[int, int] | None = None
    period = run.columns.index("PERIOD")
    for row, values in sorted(run.spectra().items()):
        if row > len(run.table) or len(values) != 6:
            continue
        speed = run.table[row - 1, 0]
        if min(abs(speed - end) for end in ends) < 0.01:
            continue
        count = unstable(values)
        if last is not None and count != last[1]:
            at = [last[0] - 1, row - 1]
            found.append(Change(row, tuple(run.table[at, 0]), tuple(run.table[at, period]), last[1], count))
        last = row, count
    return found


def same(p: LabelledPoint, q: LabelledPoint) -> bool:
    return (
        p.kind == q.kind
        and abs(p.parameters[0] - q.parameters[0]) < 1e-4
        and abs(p.parameters[10] - q.parameters[10]) < 1e-6
    )


def explains(p: LabelledPoint, change: Change) -> bool:
    """A label within the rows' speeds and periods, with some room for the row that AUTO moved to the label."""
    low, high = sorted(change.speeds)
    low_t, high_t = sorted(change.periods)
    room, room_t = 3e-4 + (high - low) / 2, 2e-6 + (high_t - low_t)
    odd = (change.before - change.after) % 2 == 1
    return (
        low - room < p.parameters[0] < high + room
        and low_t - room_t < p.parameters[10] < high_t + room_t
        and odd == (p.kind != "TR")
    )


def sample_branches(auto: Auto, equations: Equations) -> list[tuple[list[LabelledPoint], Record]]:
    """Branches from the Hopf points at several damping ratios, with AUTO's points and their records."""
    found = []
    for damping_ratio in (0.0002, 0.0005, 0.001, 0.0017, 0.002, 0.004):
        equilibria = auto.run(tight(EQUILIBRIA) | {"PAR": {2: damping_ratio}})
        hopf = equilibria.points("HB")
        speeds = [float(p.parameters[0]) for p in hopf]
        # at these three the branch from the Hopf point on D ends at that on C: one branch, not two
        joined = damping_ratio in (0.0017, 0.002, 0.004)
        for start in hopf[:1] if joined else hopf:
            stop = {1: [min(speeds) + 1e-4 if joined else 4.0, 25.1]}
            found.append(branch(auto, equations, start, speeds, {"UZSTOP": stop}))
    return found


def branch(
    auto: Auto, equations: Equations, start: LabelledPoint, ends: Sequence[float], stop: Constants
) -> tuple[list[LabelledPoint], Record]:
    """One branch: labels of all steps joined, and what no label explains located."""
    constants = BRANCH | stop | {"NMX": 2500}
    # along the branch as far as the same arclength with every step: about 40 units
    runs = {step: auto.run(constants | {"DSMAX": step, "NMX": int(40 / step)}, start) for step in STEPS}
    points: list[LabelledPoint] = []
    steps: list[list[float]] = []
    false: list[Record] = []  # AUTO's turn at the end of the branch
    for step, run in runs.items():
        for p in run.labelled:
            if p.kind not in NAMES:
                continue
            if min(abs(p.parameters[0] - end) for end in ends) < 1e-3:
                false.append({"auto_label": p.kind, "speed": p.parameters[0], "dsmax": step})
                continue
            known = [i for i, q in enumerate(points) if same(p, q)]
            if known:
                points[known[0]] = p  # the finest run's
                steps[known[0]] = sorted({*steps[known[0]], step})
            else:
                points.append(p)
                steps.append([step])
    finest = runs[min(STEPS)]
    last = finest.table[-1]
    rows = [label_record(equations, p, s) for p, s in zip(points, steps, strict=True)]
    events = changes(finest, ends)
    for row, p in zip(rows, points, strict=True):
        known = [c for c in events if explains(p, c)]
        row["unstable_before_after"] = [known[0].before, known[0].after] if known else None
    for change in events:
        if not any(explains(p, change) for p in points):
            rows.append(locate(auto, equations, start, constants, change))
    rows.sort(key=lambda r: r["period"])
    return points, {
        "damping_ratio": start.parameters[1],
        "hopf_speed": start.parameters[0],
        "lowest_speed": float(finest.table[:, 0].min()),
        "highest_speed": float(finest.table[:, 0].max()),
        "followed_to": {
            "speed": float(last[0]),
            "period": float(last[finest.columns.index("PERIOD")]),
            "ended": finest.labelled[-1].kind,
        },
        "labels": rows,
        "labels_at_a_hopf_point": false,
    }


def label_record(equations: Equations, point: LabelledPoint, steps: Sequence[float]) -> Record:
    """A label of AUTO, and the cycle polished to the same condition."""
    name = NAMES[point.kind]
    orbit = fold_of_cycles(equations, point) if name == "lpc" else crossing(equations, point, name)
    return {
        "name": name,
        "speed": point.parameters[0],
        "damping_ratio": point.parameters[1],
        "period": point.parameters[10],
        "found_with_dsmax": list(steps),
        "polished": polished_record(orbit, name, point),
    }


def polished_record(orbit: RefinedOrbit, name: str, point: LabelledPoint | None = None) -> Record:
    values = multipliers_by_product(orbit)
    record: Record = {
        "speed": orbit.speed,
        "period": orbit.period,
        "half_peak_to_peak": peaks(orbit),
        "multipliers": pairs(values),
    }
    if name != "lpc":
        value = critical(values, name)
        record |= {"critical_abs_minus_1": abs(value) - 1, "angle": float(abs(np.angle(value)))}
    if point is not None:
        record["from_auto"] = {
            "speed": orbit.speed - point.parameters[0],
            "period": orbit.period - point.parameters[10],
        }
    return record


def locate(
    auto: Auto, equations: Equations, start: LabelledPoint, constants: Constants, change: Change
) -> Record:
    """Where a multiplier crosses the unit circle without a label: bisection and secant on polished cycles."""
    low, high = change.speeds
    step = min(STEPS)
    near = auto.run(
        dict(constants) | {"DSMAX": step, "NMX": change.row + 10, "UZR": {1: [float(low), float(high)]}},
        start,
    )
    candidates = [p for p in near.points("UZ") if abs(p.parameters[10] - change.periods[0]) < 1e-5]
    point = min(candidates or near.points("UZ"), key=lambda p: abs(p.parameters[10] - change.periods[0]))
    name = "ns" if (change.before - change.after) % 2 == 0 else "pd"
    orbit = refine(equations, point, gauss_flow, speed=float(low))
    orbit = crossing(equations, orbit, name, other_speed=float(high))
    if not min(low, high) <= orbit.speed <= max(low, high):
        raise NotConverged(f"{name} at {orbit.speed:g} m/s lies outside {low:g} ... {high:g} m/s")
    return {
        "name": name,
        "speed": orbit.speed,
        "damping_ratio": orbit.damping_ratio,
        "period": orbit.period,
        "found_with_dsmax": [],
        "unstable_before_after": [change.before, change.after],
        "located": "no label of AUTO in any run; located on polished cycles",
        "between_speeds": [float(low), float(high)],
        "polished": polished_record(orbit, name),
    }


# ---- curves ----


def curve_records(
    auto: Auto, equations: Equations, run: Run, branches: Sequence[tuple[list[LabelledPoint], Record]]
) -> Record:
    """All curves: from the sample's LPC and NS points, and from points that only other dampings have."""
    pd = [p for points, _ in branches for p in points if p.kind == "PD"]
    low_ns = NS_CURVE | {"DSMAX": 0.05, "UZSTOP": LPC_CURVE["UZSTOP"]}
    second_ns = {"DSMAX": 0.02}
    starts = {
        "lpc": (run.points("LP")[0], [LPC_CURVE, backward(LPC_CURVE)]),
        # only its end at the fold-Hopf point must be stopped: there AUTO would turn round
        "ns": (run.points("TR")[0], [NS_CURVE | {"DSMAX": 0.05}, backward(low_ns)]),
        "second_ns": (second_ns_point(auto), [low_ns | second_ns, backward(low_ns) | second_ns]),
        # from the Hopf point on C, and on the branch from D at the lowest damping
        "pd": (max(pd, key=lambda p: p.parameters[1]), [PD_CURVE, backward(PD_CURVE)]),
        "second_pd": (max(pd, key=lambda p: p.parameters[0]), [PD_CURVE, backward(PD_CURVE)]),
    }
    return {
        name: curve_record(auto, equations, name, start, directions)
        for name, (start, directions) in starts.items()
    }


def second_ns_point(auto: Auto) -> LabelledPoint:
    """The NS point just before the LPC point at xi = 0.17 %: AUTO finds it only with small steps."""
    (hopf, *_) = auto.run(tight(EQUILIBRIA) | {"PAR": {2: 0.0017}}).points("HB")
    run = auto.run(BRANCH | {"UZR": {1: [13.5]}, "UZSTOP": {1: [8.1, 25.0]}}, hopf)
    near = run.points("UZ")[1]
    for sign in (1, -1):
        steps = BRANCH | {"NMX": 300, "DS": sign * 0.001, "DSMAX": 0.001, "UZSTOP": {1: [13.45, 25.0]}}
        found = auto.run(steps, near).points("TR")
        if found:
            return found[0]
    raise NotConverged("no NS point near 13.5547 m/s at a damping ratio of 0.17 %")


def curve_record(
    auto: Auto, equations: Equations, name: str, start: LabelledPoint, directions: Sequence[Constants]
) -> Record:
    """One curve: points at given dampings on two meshes, labels of several runs, the line thinned."""
    kind = name.removeprefix("second_")

    def runs(changed: Constants) -> list[Run]:
        """In both directions."""
        settings = [tight(d) | {"NTST": 60, "NMX": 400} | changed for d in directions]
        return [auto.run(s, extended(auto, s, start)) for s in settings]

    at_dampings = {"UZR": {2: list(CURVE_DAMPINGS)}}
    coarse, fine = runs(at_dampings), runs(at_dampings | {"NTST": 120})
    points = []
    for p in uz_points(coarse):
        damping_ratio = min(CURVE_DAMPINGS, key=lambda xi: abs(p.parameters[1] - xi))
        if abs(p.parameters[1] - damping_ratio) > 1e-8:  # where the window ends
            continue
        like = [q for q in uz_points(fine) if abs(q.parameters[0] - p.parameters[0]) < 1e-3]
        best = min(like, key=lambda q: abs(q.parameters[10] - p.parameters[10]), default=None)
        record = {
            "speed": p.parameters[0],
            "damping_ratio": p.parameters[1],
            "period": p.parameters[10],
            "moved": abs(best.parameters[0] - p.parameters[0]) if best else None,
        }
        if kind != "lpc":
            try:
                orbit = crossing(equations, p, kind, damping_ratio=damping_ratio)
                record["polished"] = polished_record(orbit, kind, p) | {"damping_ratio": damping_ratio}
            except NotConverged:
                # a fold of cycles is so close that the cycle of a given speed is hardly isolated
                record["polished"] = None
        points.append(record)
    # an extremum of the first parameter is AUTO's "LP": of the speed, or of the damping ratio
    labelled = [
        (p, order, step)
        for order in ("speed", "damping_ratio")
        for step in (0.05, 0.02)
        for run in runs(
            {"ICP": [1, 2, 11] if order == "speed" else [2, 1, 11], "DSMAX": step, "NMX": int(20 / step)}
        )
        for p in run.labelled
        if p.kind not in ("EP", "UZ")
    ]
    line = [run.table[:, [run.columns.index(c) for c in ("U", "xi", "PERIOD")]] for run in coarse]
    whole = np.concatenate([line[1][::-1], line[0]])
    return {
        "from": {"speed": start.parameters[0], "damping_ratio": start.parameters[1]},
        "points": sorted(points, key=lambda r: (r["damping_ratio"], r["speed"])),
        "labels": curve_labels(labelled),
        "line_columns": ["speed", "damping_ratio", "period"],
        "line": whole[:: max(1, len(whole) // 60)].tolist(),
    }


def uz_points(runs: Sequence[Run]) -> list[LabelledPoint]:
    return [p for run in runs for p in run.points("UZ")]


def curve_labels(labelled: Sequence[tuple[LabelledPoint, str, float]]) -> list[Record]:
    """Labels of all runs joined: which runs have each, and how far its places lie apart."""
    groups: list[list[tuple[LabelledPoint, str, float]]] = []
    for entry in labelled:
        p = entry[0]
        for group in groups:
            q = group[0][0]
            near = np.abs(p.parameters[:2] - q.parameters[:2]) < (2e-3, 1e-6)
            if p.kind == q.kind and near.all():
                group.append(entry)
                break
        else:
            groups.append([entry])
    records = []
    for group in groups:
        at = np.array([p.parameters[[0, 1, 10]] for p, _, _ in group])
        middle = np.median(at, axis=0)
        records.append(
            {
                "auto_label": group[0][0].kind,
                "speed": middle[0],
                "damping_ratio": middle[1],
                "period": middle[2],
                "spread": dict(zip(("speed", "damping_ratio"), np.ptp(at, axis=0)[:2].tolist(), strict=True)),
                "found_with": [f"{order} first, DSMAX {step}" for _, order, step in group],
            }
        )
    return records
