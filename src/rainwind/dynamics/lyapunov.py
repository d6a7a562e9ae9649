"""Lyapunov exponents: how fast small disturbances of a trajectory grow or die out, in the long run.

Benettin, Galgani, Giorgilli & Strelcyn, Meccanica 15 (1980) 9-30: n small disturbances are carried along by
w' = J w, as Taylor series of the model's own tape, and made orthogonal again after short intervals; the exponents are
the mean rates at which their lengths would have grown.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.dynamics.kernels import taylor as kernel
from rainwind.dynamics.system import as_system, number
from rainwind.dynamics.tangent_tape import with_tangents
from rainwind.dynamics.taylor import TaylorEngine
from rainwind.errors import ComputationError, InputError, is_interrupt

Progress = Callable[[int, int, str], None]
SPREAD = 8.0  # log of the largest growth over the smallest in one interval: digits lost are 0.43 of it
BLOCKS = 20  # whose scatter tells the error
_SHORTEST = 1e-9  # interval, as a share of the duration


@dataclass(frozen=True, eq=False)
class LyapunovSpectrum:
    """exponents (m,) in 1/time, the largest first; errors (m,): standard errors by block means.

    blocks (20, m): the means over twenty equal parts of the duration, in time. start, end: the states between which
    they were taken. complete: whether m is the number of states. intervals: how often disturbances were made
    orthogonal. interrupted: Ctrl-C came first; `duration` is the time up to then.
    """

    exponents: np.ndarray
    errors: np.ndarray
    blocks: np.ndarray
    duration: float
    start: np.ndarray
    end: np.ndarray
    states: tuple[str, ...]
    intervals: int
    interrupted: bool = False

    @property
    def complete(self) -> bool:
        """Whether there is an exponent for each state."""
        return self.exponents.size == len(self.states)

    @property
    def sum(self) -> float:
        """The sum of the exponents; of all of them it is the mean of trace J, the rate at which volumes grow."""
        return float(self.exponents.sum())

    @property
    def dimension(self) -> float:
        """Kaplan & Yorke's dimension of the attractor: nan where too few exponents are known."""
        total = np.cumsum(self.exponents)
        k = int(np.count_nonzero(total >= 0.0))
        if k == total.size:
            return float(k) if self.complete else float("nan")
        return k + (float(total[k - 1]) / abs(float(self.exponents[k])) if k else 0.0)

    def __str__(self) -> str:
        pairs = zip(self.exponents, self.errors, strict=True)
        return ", ".join(f"{value:.6g} ± {error:.1g}" for value, error in pairs)


def lyapunov(
    model: Any,
    start: Any,
    *,
    duration: float,
    transient: float = 0.0,
    many: int | None = None,
    parameters: Mapping[str, float] | None = None,
    tolerance: float = 1e-9,
    progress: Progress | None = None,
) -> LyapunovSpectrum:
    """The Lyapunov exponents of the trajectory from a start, over a duration after a transient.

    start: a state by name or in order, an equilibrium or the end of a trajectory. many: how many of the largest
    exponents; None for all. parameters: values that replace the model's own. tolerance: of each step, 1e-15 to 1e-2.
    Errors fall as 1/duration on cycles and tori, as its square root in chaos. Ctrl-C gives what there is.
    Raises InputError for bad input, ComputationError for a trajectory that runs away or takes too many steps.
    """
    system = as_system(model)
    if parameters:
        system.allowed(parameters)
        system = system.with_parameters({k: number(v, f"parameter '{k}'") for k, v in parameters.items()})
    n = len(system.states)
    many = n if many is None else many
    if isinstance(many, bool) or not isinstance(many, int) or not 1 <= many <= n:
        raise InputError(f"many = {many!r}: give a whole number from 1 to {n}, the number of states")
    if not number(duration, "duration") > 0.0:
        raise InputError(f"duration = {duration!r}: give a positive time")
    if number(transient, "transient") < 0.0:
        raise InputError(f"transient = {transient!r}: give zero or a positive time")
    x = system.state(getattr(start, "end", getattr(start, "state", start)))
    p = np.array(list(system.parameters.values()))
    sizes = np.abs(x)
    turning = min(
        0.2 * duration, 0.5 * transient
    )  # of the transient: in it disturbances turn where they grow
    if transient > 0.0:
        run = TaylorEngine(system, tolerance, lanes=1).advance(x, transient - turning, p, sizes=sizes)
        _check(run.statuses[0], run.times[0], run.states[0], system.states)
        x, sizes = run.states[0], run.sizes[0]
    engine = TaylorEngine(with_tangents(system.tape, many), tolerance, lanes=1)
    begun, t, step = x.copy(), -turning, _first_step(system.jacobian(x), float(duration))
    units = np.where(sizes > 0.0, sizes, 1.0)  # of disturbances: in the long run they make no difference
    # along the flow first, which is an exponent of zero by itself; the others in no special direction
    w = np.random.default_rng(1).standard_normal((n, n))
    along = system.f(x) / units
    w[0] = along / np.linalg.norm(along) if np.any(along) else w[0]
    w = np.linalg.qr(w.T)[0].T[:many]
    own = np.tile(units, many)
    times, logs, interrupted = [0.0], [np.zeros(many)], False
    try:
        while t < duration * (1.0 - 1e-12):
            step = min(step, (duration if t >= 0.0 else 0.0) - t)
            run = engine.advance(
                np.concatenate([x, w.ravel() * own]), step, p, sizes=np.concatenate([sizes, own])
            )
            _check(run.statuses[0], t + run.times[0], run.states[0, :n], system.states)
            q, r = np.linalg.qr((run.states[0, n:] / own).reshape(many, n).T)
            with np.errstate(divide="ignore"):
                growth = np.log(np.abs(np.diag(r)))
            spread = float(max(growth.max(), 0.0) - min(growth.min(), 0.0))
            if not spread <= 2.0 * SPREAD and step > _SHORTEST * duration:
                step *= max(0.1, SPREAD / spread)  # too many digits are lost: once more, shorter
                continue
            x, sizes, w, t = run.states[0, :n].copy(), run.sizes[0, :n].copy(), q.T, t + step
            t = 0.0 if abs(t) < 1e-12 * duration else t
            if t > 0.0:
                times.append(t)
                logs.append(growth)
            elif t == 0.0:
                begun = x
            step *= float(np.clip(SPREAD / max(spread, 1e-300), 0.5, 2.0))
            if progress is not None:
                progress(max(0, round(1000 * t / duration)), 1000, f"t = {t:.4g} of {duration:.4g}")
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error) or t <= 0.0:
            raise
        interrupted = True
    blocks = _blocks(np.array(times), np.cumsum(logs, axis=0))
    order = np.argsort(-blocks.mean(axis=0), kind="stable")
    blocks = blocks[:, order]
    return LyapunovSpectrum(
        blocks.mean(axis=0), blocks.std(axis=0, ddof=1) / np.sqrt(BLOCKS), blocks, t, begun, x, system.states,
        len(times) - 1, interrupted,
    )  # fmt: skip


def _first_step(jacobian: np.ndarray, duration: float) -> float:
    rates = np.linalg.eigvals(jacobian).real if np.all(np.isfinite(jacobian)) else np.zeros(1)
    return min(duration / BLOCKS, SPREAD / max(float(np.ptp(np.append(rates, 0.0))), 1e-300))


def _blocks(times: np.ndarray, totals: np.ndarray) -> np.ndarray:
    """The mean rates (BLOCKS, m) over equal parts of the time, from growth (k, m) added up until times (k,)."""
    edges = np.linspace(0.0, times[-1], BLOCKS + 1)
    at = np.array([np.interp(edges, times, column) for column in totals.T]).T
    return np.diff(at, axis=0) / (times[-1] / BLOCKS)


def _check(status: int, t: float, x: np.ndarray, states: tuple[str, ...]) -> None:
    """ComputationError where a trajectory could not be followed to its end."""
    if status == kernel.ARRIVED:
        return
    place = ", ".join(f"{name} = {value:.5g}" for name, value in zip(states, x, strict=True))
    raise ComputationError(
        f"the trajectory ran away or its steps became too small at t = {t:.6g} after the transient ({place}), so it "
        "has no exponents; choose another start, or look at it with rw.simulate"
    )
