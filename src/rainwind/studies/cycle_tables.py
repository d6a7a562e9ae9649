"""Limit cycles as named tables, SI and radians, for netCDF and CSV."""

from collections.abc import Mapping

import numpy as np

from rainwind.dynamics.orbit_results import Orbit, OrbitBranch
from rainwind.io.results import Column, Table
from rainwind.studies.cycle_map import CycleMap

_SPEED = "undisturbed wind speed"
_UNITS = {"y": "m", "phi": "rad", "z": "m"}


def cycle_tables(known: CycleMap, shown: Mapping[float, tuple[Orbit, ...]]) -> dict[str, Table]:
    """Each branch, the labelled cycles, what is stable where, and some cycles over their period."""
    found = {f"cycles_{k}": _branch(branch) for k, branch in enumerate(known.branches, 1)}
    found["cycle_points"] = _points(known)
    found["stable"] = _stable(known)
    for speed, orbits in shown.items():
        for k, orbit in enumerate(orbits, 1):
            found[f"orbit_{speed:g}_{k}".replace(".", "_")] = _orbit(orbit, speed)
    return found


def _branch(branch: OrbitBranch) -> Table:
    columns = {
        "wind_speed": Column(branch.parameter, "m/s", _SPEED),
        "period": Column(branch["period"], "s", "period"),
        "unstable": Column(branch.unstable, "", "multipliers outside the unit circle"),
        "growth": Column(
            branch.exponents.real.max(axis=1) / branch["period"],
            "1/s",
            "log of the largest multiplier by period",
        ),
    }
    for name in branch.states[: len(branch.states) // 2]:
        columns |= {
            f"{of}_{name}": Column(branch[f"{of} {name}"], _UNITS.get(name, ""), f"{of} {name} over a period")
            for of in ("min", "mean", "max")
        }
    return Table(columns)


def _points(known: CycleMap) -> Table:
    points = [p for kind in ("lpc", "ns", "pd", "bp") for p in known.points(kind)]
    none = float("nan")
    size = {name: [p.orbit.amplitude.get(name, none) for p in points] for name in ("y", "phi", "z")}
    return Table(
        {
            "kind": Column(np.array([p.kind for p in points], dtype=object), "", "kind of labelled cycle"),
            "wind_speed": Column(np.array([p.parameter for p in points]), "m/s", _SPEED),
            "period": Column(np.array([p.orbit.period for p in points]), "s", "period"),
            "angle": Column(
                np.array([none if p.angle is None else p.angle for p in points]), "rad",
                "argument of the critical multipliers (ns)",
            ),
            "coefficient": Column(
                np.array([none if p.coefficient is None else p.coefficient for p in points]), "",
                "normal-form coefficient, negative: soft",
            ),
            **{
                f"half_amplitude_{name}": Column(np.array(values), _UNITS[name], "half peak to peak")
                for name, values in size.items()
            },
        }
    )  # fmt: skip


def _stable(known: CycleMap) -> Table:
    ranges = known.ranges()
    return Table(
        {
            "from": Column(np.array([one.low for one in ranges]), "m/s", _SPEED),
            "to": Column(np.array([one.high for one in ranges]), "m/s", _SPEED),
            "equilibria": Column(
                np.array([", ".join(one.equilibria) for one in ranges], dtype=object), "", "stable equilibria"
            ),
            "cycles": Column(np.array([len(one.cycles) for one in ranges]), "", "number of stable cycles"),
        }
    )


def _orbit(orbit: Orbit, speed: float) -> Table:
    time = np.linspace(0.0, orbit.period, 201)
    path = orbit.at(time)
    columns = {"time": Column(time, "s", "time")}
    for k, name in enumerate(orbit.states[: len(orbit.states) // 2]):
        columns[name] = Column(path[:, k], _UNITS.get(name, ""), name)
    return Table(columns, {"wind_speed": speed, "unstable_multipliers": orbit.unstable})
