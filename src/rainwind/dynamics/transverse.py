"""Does a trajectory repeat itself, wander on a torus, or is it chaotic? One small disturbance across the flow tells.

A disturbance along the flow neither grows nor shrinks in the long run. What is left of another one when its part along
the flow is taken away dies out near a stable cycle, stays about as it is on a torus, and grows exponentially in chaos:
the largest Lyapunov exponent but for that of the flow itself. Many trajectories at once, in lanes.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.kernels import taylor as kernel
from rainwind.dynamics.system import System
from rainwind.dynamics.tangent_tape import with_tangents
from rainwind.dynamics.taylor import TaylorEngine

_MOST = 12.0  # log of the growth in one interval; more makes the next ones shorter


@dataclass(frozen=True, eq=False)
class Transverse:
    """growth (k, N): log of the growth across the flow up to times (k,); states (k + 1, N, n), from the start on.

    fine (N,): whether a trajectory could be followed to the end. sizes (N, n): as the engine's.
    """

    times: np.ndarray
    growth: np.ndarray
    states: np.ndarray
    fine: np.ndarray
    sizes: np.ndarray


def transverse_growth(
    system: System, starts: np.ndarray, parameters: np.ndarray, sizes: np.ndarray, duration: float,
    interval: float, tolerance: float, look: Callable[[float], None] = lambda t: None,
) -> Transverse:  # fmt: skip
    """Follow N trajectories (N, n), parameters (N, m), one disturbance each; look(t) is called between intervals."""
    engine = TaylorEngine(with_tangents(system.tape, 1), tolerance)
    many, n = starts.shape
    names = list(system.parameters)
    known = dict(zip(names, parameters.T, strict=True))
    units = np.where(sizes > 0.0, sizes, 1.0)
    x, sizes, fine = starts.copy(), sizes.copy(), np.ones(many, dtype=bool)
    f = system.f(x, known) / units
    w = _across(np.ones(n) / np.sqrt(n) * np.where(np.arange(n) % 2, -1.0, 1.0) + 0.0 * f, f)[0]
    total, t = np.zeros(many), 0.0
    times, growth, states = [], [], [x.copy()]
    while t < duration * (1.0 - 1e-12):
        step = min(interval, duration - t)
        before = np.log(np.maximum(np.linalg.norm(f, axis=1), 1e-300))
        run = engine.advance(
            np.concatenate([x, w * units], axis=1), step, parameters, sizes=np.concatenate([sizes, units], axis=1)
        )  # fmt: skip
        fine &= run.statuses == kernel.ARRIVED
        x[fine], sizes[fine] = run.states[fine, :n], run.sizes[fine, :n]
        f[fine] = (system.f(x, known) / units)[fine]
        moved = np.where(fine[:, None], run.states[:, n:] / units, w)
        w, lengths = _across(moved, f)
        # the area between the flow and the disturbance, by what it has grown
        part = np.log(lengths) + np.log(np.maximum(np.linalg.norm(f, axis=1), 1e-300)) - before
        total = total + np.where(fine, part, 0.0)
        t += step
        if fine.any() and np.median(np.abs(part[fine])) > _MOST:
            interval *= 0.5
        times.append(t)
        growth.append(total)
        states.append(x.copy())
        look(t)
    return Transverse(np.array(times), np.array(growth), np.array(states), fine, sizes)


def _across(w: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The parts of disturbances (N, n) across f (N, n), of length 1, and their lengths (N,)."""
    square = np.maximum(np.sum(f * f, axis=1, keepdims=True), 1e-300)
    w = w - np.sum(w * f, axis=1, keepdims=True) / square * f
    lengths = np.maximum(np.linalg.norm(w, axis=1), 1e-300)
    return w / lengths[:, None], lengths
