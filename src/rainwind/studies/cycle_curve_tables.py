"""Curves of cycles over wind speed and damping as named tables, SI and radians."""

import numpy as np

from rainwind.io.results import Column, Table
from rainwind.studies.cycle_curves import RATIO, SPEED, CycleCurves
from rainwind.studies.cycle_field import CycleField

_SPEED, _RATIO = "undisturbed wind speed", "damping ratio"


def cycle_curve_tables(found: CycleCurves, stable: CycleField) -> dict[str, Table]:
    """Each curve under its kind and number, the points on them, and the number of stable cycles on a grid."""
    tables: dict[str, Table] = {}
    for kind in ("lpc", "ns", "pd"):
        for number, curve in enumerate(found.of(kind), 1):
            columns = {
                "wind_speed": Column(curve[SPEED], "m/s", _SPEED),
                "damping_ratio": Column(curve[RATIO], "", _RATIO),
                "period": Column(curve["period"], "s", "period"),
            }
            units = {"y": "m", "phi": "rad", "z": "m"}
            for name in (n for n in units if n in curve.states):
                columns[f"amplitude_{name}"] = Column(
                    curve[name], units[name], f"half peak-to-peak of {name}"
                )
            tables[f"{kind}_{number}"] = Table(columns)
    points = found.points()
    if points:
        tables["cycle_curve_points"] = Table(
            {
                "kind": Column(np.array([p.kind for p in points], dtype=object), "", "kind of special point"),
                "wind_speed": Column(np.array([p.parameters[SPEED] for p in points]), "m/s", _SPEED),
                "damping_ratio": Column(np.array([p.parameters[RATIO] for p in points]), "", _RATIO),
                "period": Column(np.array([p.orbit.period for p in points]), "s", "period"),
                "amplitude_y": Column(
                    np.array([p.orbit.amplitude["y"] for p in points]), "m", "half peak-to-peak of y"
                ),
            }
        )
    few = (slice(None, None, 4), slice(None, None, 4))
    tables["stable_cycles"] = Table(
        {
            "wind_speed": Column(stable.speed[::4], "m/s", _SPEED, ("wind_speed",)),
            "damping_ratio": Column(stable.ratio[::4], "", _RATIO, ("damping_ratio",)),
            "count": Column(
                stable.count[few], "", "number of stable limit cycles", ("damping_ratio", "wind_speed")
            ),
        }
    )
    return tables
