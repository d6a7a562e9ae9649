"""Orbits that are not isolated: every trajectory beside one of them closes too, so Newton's matrix is singular."""

import numpy as np

from rainwind.dynamics.settling import Integration, Trajectory

ONE_OF_MANY = (
    "the trajectory closes after {0:.4g}, and so does every one beside it: a whole family of orbits, none of them "
    "isolated, as where a quantity is conserved. No single one can be found; change a parameter (a little damping, or "
    "driving), so that one of them is left"
)
_CLOSES, _BESIDE = 2e-5, 0.05  # in units: how near a closed trajectory comes to its start; how far beside is


def is_one_of_many(integration: Integration, x: np.ndarray, units: np.ndarray, lag: float) -> bool:
    """Whether the trajectory from x closes after about `lag`, and so does another one that stays beside it.

    x (n,): a state; units (n,): the size of each state; what lies beside is given 20 rounds to settle.
    """
    first = _closing(integration, x, units, lag)
    beside = integration.run(x + _BESIDE * units, 20.0 * lag, units)
    if first is None or beside is None or first[0] > _CLOSES:
        return False
    other = _closing(integration, beside.states[-1], units, lag)
    if other is None or other[0] > _CLOSES:
        return False
    path = other[1].at(np.linspace(other[1].times[0], other[1].times[-1], 2000))
    return float(np.min(np.max(np.abs(path - x) / units, axis=1))) > 0.1 * _BESIDE


def _closing(
    integration: Integration, x: np.ndarray, units: np.ndarray, lag: float
) -> tuple[float, Trajectory] | None:
    """How near to x its trajectory comes back after about `lag`, in units, and the trajectory up to there."""
    rate = integration.system.f(x) / units
    found = None
    for _ in range(4):
        run = integration.run(x, lag, units)
        if run is None or not np.any(rate):
            return None
        away = (run.states[-1] - x) / units
        found = float(np.max(np.abs(away))), run
        shift = float(away @ rate / (rate @ rate))
        if abs(shift) < 1e-9 * lag:
            break
        lag -= float(np.clip(shift, -0.1 * lag, 0.1 * lag))
    return found
