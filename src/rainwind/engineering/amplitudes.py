"""How strongly a section vibrates in the end: many rivulets at many wind speeds, followed in time."""

from collections.abc import Mapping
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
NUDGED = 0.05
"""Diameters by which it is displaced where the first run loses its rivulet."""
_LEFT = 1.25
"""What is less than so many times the rest of the push, which decays as small vibrations do, is no vibration."""
_TOLERANCE = 1e-7


@dataclass(frozen=True, eq=False)
class Vibrations:
    """Runs of any shape: amplitude, half peak to peak of y or z, whichever is larger, in m; lost.

    amplitude: that of the last `LAST` periods; 0 without an upper rivulet. lost: whether the rivulet leaves the upper
    side. Then the amplitude is the largest of a run from nearly at rest, until the rivulet is lost and the section
    swings out. A whole stay goes on at about that amplitude: its pieces lose their rivulets one after another
    (docs/cables.md).
    """

    amplitude: np.ndarray
    lost: np.ndarray


def vibrations(
    model: RivuletModel,
    state: np.ndarray,
    parameters: Mapping[str, np.ndarray],
    rate: np.ndarray,
    *,
    workers: Any = None,
) -> Vibrations:
    """Follow each start for `PERIODS`; state (..., 6) at rest, nan without an upper rivulet; parameters (...).

    rate: (...) of small vibrations, 1/s: where they decay, what may be left of the push by then counts as rest. Ctrl-C
    raises KeyboardInterrupt.
    """
    there = np.isfinite(state[..., 1])
    amplitude, lost = np.zeros(there.shape), np.zeros(there.shape, dtype=bool)
    if not there.any():
        return Vibrations(amplitude, lost)
    starts, varying = state[there], {name: values[there] for name, values in parameters.items()}
    period = 1.0 / min(model.section.frequency_y, model.section.frequency_z)
    found, gone = _run(model, starts, varying, DISPLACED, (PERIODS - LAST) * period, workers)
    if gone.any():
        some = {name: values[gone] for name, values in varying.items()}
        found[gone], _ = _run(model, starts[gone], some, NUDGED, 0.0, workers)
    left = DISPLACED * model.section.diameter * np.exp(rate[there] * (PERIODS - LAST) * period)
    # the second run's amplitude counts from its start, so its push is in it whole
    left = np.where(gone, NUDGED * model.section.diameter, left)
    found[(rate[there] < 0.0) & (found < _LEFT * left)] = 0.0
    amplitude[there], lost[there] = found, gone
    return Vibrations(amplitude, lost)


def _run(
    model: RivuletModel,
    rest: np.ndarray,
    varying: Mapping[str, np.ndarray],
    diameters: float,
    since: float,
    workers: Any,
) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes from `since` (s) on, and whether the rivulet is on the lower side in the end; each (N,)."""
    start = rest.copy()
    start[:, model.states.index("y")] += diameters * model.section.diameter
    period = 1.0 / min(model.section.frequency_y, model.section.frequency_z)
    run = ensemble(
        ScatteredModel(model), start, varying=varying, duration=PERIODS * period, tolerance=_TOLERANCE,
        workers=workers, reduce=Extremes(of=("y", "z"), since=since),
    )  # fmt: skip
    if run.interrupted:
        raise KeyboardInterrupt
    phi = run.final[:, model.states.index("phi")]
    turned = beta(varying["wind.yaw"], model.section.inclination)
    # the cable's top is at phi = -beta; a rivulet more than 120 degrees from it is lost
    return np.asarray(run["amplitude"]).max(axis=1), ~(np.cos(phi + turned) + 0.5 >= 0.0)
