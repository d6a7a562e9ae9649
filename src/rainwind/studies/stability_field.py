"""Linear stability of D on a grid of wind speeds and damping ratios: what the diagrams shade."""

from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.kernels.tangents import jacobians
from rainwind.dynamics.system import as_system
from rainwind.studies.equilibrium_map import EquilibriumMap
from rainwind.studies.hopf_curves import ALONG


@dataclass(frozen=True, eq=False)
class Field:
    """Linear stability of D on a grid: speed (m,), ratio (k,), growth and count (k, m).

    growth: largest real part of the eigenvalues in 1/s; count: number of eigenvalues with positive real part.
    """

    speed: np.ndarray
    ratio: np.ndarray
    growth: np.ndarray
    count: np.ndarray


def stability_field(
    known: EquilibriumMap, ratios: tuple[float, float], shape: tuple[int, int]
) -> Field | None:
    """The field of D over its speeds and a range of ratios, of `shape` points in speed and ratio; None without D.

    Its speeds are those at which D is inside the coefficients' range.
    """
    side, reach = known["D"], known.reach
    if side is None or reach is None:
        return None
    speeds, states = side.states()
    kept = (speeds >= reach[0]) & (speeds <= reach[1])
    speeds, states = speeds[kept], states[kept]
    # even in arclength near the fold, where the state moves fast, and even in speed elsewhere
    part = np.linspace(0.0, 1.0, shape[0])
    speed = speeds[0] + (speeds[-1] - speeds[0]) * part * (0.3 + 0.7 * part)
    state = np.array([np.interp(speed, speeds, column) for column in states.T]).T
    low, high = ratios
    ratio = np.geomspace(low, high, shape[1]) if low > 0 else np.linspace(low, high, shape[1])
    system = as_system(known.model)
    inputs = system.inputs(np.tile(state, (len(ratio), 1)))
    inputs[:, system.number(ALONG[0])] = np.tile(speed, len(ratio))
    inputs[:, system.number(ALONG[1])] = np.repeat(ratio, len(speed))
    matrices = jacobians(*system.tape.arrays, inputs, np.arange(len(system.states)))[1]
    values = np.linalg.eigvals(matrices).real.reshape(len(ratio), len(speed), -1)
    # the fold's own zero eigenvalue says nothing about its sides
    values[np.abs(values) < 1e-7] = -np.inf
    return Field(speed, ratio, values.max(axis=-1), np.sum(values > 0, axis=-1))
