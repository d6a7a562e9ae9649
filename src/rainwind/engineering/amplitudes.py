"""How strongly a section vibrates in the end: many rivulets at many wind speeds, followed in time."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.dynamics.ensembles import ensemble
from rainwind.dynamics.reductions import Extremes
from rainwind.physics.model import RivuletModel
from rainwind.physics.oblique_wind import beta
from rainwind.physics.tilted import ScatteredModel

__all__ = ["DISPLACED", "LAST", "PERIODS", "Vibrations", "vibrations"]

PERIODS = 600.0
"""Periods of the cable that each run is followed."""
LAST = 60.0
"""Periods at its end in which the amplitude is taken."""
DISPLACED = 1.0
"""Diameters by which the cable is displaced at the start, so that a vibration that needs a push is found too."""
_TOLERANCE = 1e-7


@dataclass(frozen=True, eq=False)
class Vibrations:
    """Runs of any shape: amplitude, half peak to peak of y or z, whichever is larger, in m; lost.

    amplitude: 0 where no upper rivulet is at the start, nan where the rivulet was lost or the run failed: then the
    cable comes to rest until another one forms. lost: whether it was.
    """

    amplitude: np.ndarray
    lost: np.ndarray


def vibrations(
    model: RivuletModel,
    state: np.ndarray,
    parameters: Mapping[str, np.ndarray],
    *,
    workers: Any = None,
    progress: Callable[[int, int, str], None] | None = None,
) -> Vibrations:
    """Follow each start for `PERIODS`; state (..., 6) at rest, nan without an upper rivulet; parameters (...).

    The amplitude is that of the last `LAST` periods. Ctrl-C raises KeyboardInterrupt.
    """
    there = np.isfinite(state[..., 1])
    amplitude, lost = np.zeros(there.shape), np.zeros(there.shape, dtype=bool)
    if not there.any():
        return Vibrations(amplitude, lost)
    start = state[there].copy()
    start[:, model.states.index("y")] += DISPLACED * model.section.diameter
    period = 1.0 / min(model.section.frequency_y, model.section.frequency_z)
    run = ensemble(
        ScatteredModel(model), start,
        varying={name: values[there] for name, values in parameters.items()},
        duration=PERIODS * period, tolerance=_TOLERANCE, workers=workers, progress=progress,
        reduce=Extremes(of=("y", "z"), since=(PERIODS - LAST) * period),
    )  # fmt: skip
    if run.interrupted:
        raise KeyboardInterrupt
    found = np.asarray(run["amplitude"]).max(axis=1)
    phi = run.final[:, model.states.index("phi")]
    # the cable's top is at phi = -beta; a rivulet more than 120 degrees from it is lost
    turned = beta(parameters["wind.yaw"][there], model.section.inclination)
    gone = ~np.isfinite(found) | (np.cos(phi + turned) + 0.5 < 0.0)
    amplitude[there] = np.where(gone, np.nan, found)
    lost[there] = gone
    return Vibrations(amplitude, lost)
