"""A trajectory and where it comes back to: steps of an integration or rows of a simulation, with cubics between."""

from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from rainwind.dynamics.kernels.tangents import jacobian_at
from rainwind.dynamics.kernels.values import specialised
from rainwind.dynamics.system import System

TOLERANCE = 1e-7  # of the integration, relative, and absolute in units of the trajectory's size
STIFF = 5e3  # rate times span above which Radau's steps cost less than DOP853's many
RETURNS = 200  # looked at, counted from the end
BISECTIONS = 40
FAR = 1e6  # times the units, or 1: there a trajectory has run away
NOT_FINITE = "comes to states where f is not finite, or where no step is short enough"
MOST = 300_000  # evaluations of f in one piece, likewise


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States (k, n) and their rates at rising times (k,)."""

    times: np.ndarray
    states: np.ndarray
    rates: np.ndarray

    def at(self, t: np.ndarray) -> np.ndarray:
        """The states (..., n) at times (...)."""
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        h = (self.times[k + 1] - self.times[k])[..., None]
        s = np.asarray(t)[..., None] - self.times[k][..., None]
        s = s / h
        a, b = self.states[k], self.states[k + 1]
        left, right = h * self.rates[k], h * self.rates[k + 1]
        return a + s * (left + s * (3 * (b - a) - 2 * left - right + s * (2 * (a - b) + left + right)))

    def units(self) -> np.ndarray:
        """The range of every state (n,), with some range where it has none."""
        spread = np.ptp(self.states, axis=0)
        spread = np.maximum(spread, 1e-9 * np.max(np.abs(self.states), axis=0))
        largest = float(np.max(spread))
        return np.where(spread > 1e-12 * largest, spread, largest) if largest > 0.0 else np.ones(spread.size)

    def latter(self, share: float = 0.5) -> "Trajectory":
        """The last part of it, by time."""
        first = self.times[-1] - share * (self.times[-1] - self.times[0])
        few = slice(min(int(np.searchsorted(self.times, first)), len(self.times) - 2), None)
        return Trajectory(self.times[few], self.states[few], self.rates[few])

    def returns(self, units: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How long before the end it passed through the plane across its end in the same direction, and how far
        from the end in units (n,): two arrays, the latest passage first."""
        normal = self.rates[-1] / units
        size = float(np.linalg.norm(normal))
        if not size > 0.0:
            return np.zeros(0), np.zeros(0)
        level = (self.states - self.states[-1]) / units @ (normal / size)
        found = np.flatnonzero((level[:-2] < 0.0) & (level[1:-1] >= 0.0))[::-1][:RETURNS]
        low, high = self.times[found], self.times[found + 1]
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            below = (self.at(middle) - self.states[-1]) / units @ normal < 0.0
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        gaps = np.max(np.abs((self.at(high) - self.states[-1]) / units), axis=1, initial=0.0)
        return self.times[-1] - high, gaps


class Integration:
    """x' = f by SciPy's Runge-Kutta methods, as many steps as it takes; `count` is the evaluations of f so far.

    why: what ended the last run before its time, in words that follow "the trajectory".
    """

    def __init__(self, system: System) -> None:
        self.system, self.count, self.why = system, 0, ""
        n = len(system.states)
        self._inputs = system.inputs(np.zeros(n))
        operations, template, outputs = system.tape.arrays
        varies = np.arange(self._inputs.size) < n
        self._tape = (*specialised(operations, template, self._inputs, varies), outputs)
        self._directions = np.arange(n)

    def rate(self, x: np.ndarray) -> float:
        """The largest modulus of an eigenvalue of J at x."""
        j = self.system.jacobian(x)
        return float(np.max(np.abs(np.linalg.eigvals(j)))) if np.all(np.isfinite(j)) else np.inf

    def _both(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        self._inputs[: x.size] = x
        return jacobian_at(*self._tape, self._inputs, self._directions)

    def run(self, x: np.ndarray, span: float, units: np.ndarray) -> Trajectory | None:
        """The steps from x over a span of time; None where it does not get there, and then `why` says the reason."""
        pieces, at, left, begun = [], x, span, 0.0
        while left > 1e-12 * span:
            # in pieces, for what is not stiff at the start may become so
            rate = self.rate(at)
            piece = (
                left if not isfinite(rate) else min(left, max(0.02 * span, 0.2 * STIFF / max(rate, 1e-300)))
            )
            found = self._piece(at, piece, units, stiff=not rate * piece < STIFF)
            if found is None:
                return None
            times, states = found
            pieces.append((begun + times[bool(pieces) :], states[bool(pieces) :]))
            at, left, begun = states[-1], left - piece, begun + piece
        times = np.concatenate([t for t, _ in pieces])
        states = np.concatenate([s for _, s in pieces])
        return Trajectory(times, states, self.system.f(states))

    def _piece(
        self, x: np.ndarray, span: float, units: np.ndarray, stiff: bool
    ) -> tuple[np.ndarray, np.ndarray] | None:
        far, most = FAR * max(1.0, float(np.max(units))), self.count + MOST

        def rhs(_: float, x: np.ndarray) -> np.ndarray:
            self.count += 1
            if self.count > most:
                raise _TooManyError
            return self._both(x)[0]  # where it is not finite the step is tried again, shorter

        def away(_: float, x: np.ndarray) -> float:
            return far - float(np.abs(x).max())

        away.terminal = True  # type: ignore[attr-defined]  # so SciPy wants it
        method: dict[str, Any] = {"method": "DOP853"}
        if stiff:
            method = {"method": "Radau", "jac": lambda _, x: self._both(x)[1]}
        try:
            with np.errstate(all="ignore"):
                run = solve_ivp(
                    rhs, (0.0, span), x, rtol=TOLERANCE, atol=TOLERANCE * units, events=away, **method
                )
        except _TooManyError:
            self.why = (
                f"needs more than {MOST} evaluations of f: it is too stiff, or too fast for so long a time"
            )
            return None
        except ValueError:  # Radau's linear algebra refuses what is not finite
            self.why = NOT_FINITE
            return None
        if run.status == 1:
            self.why = f"runs away: a state passes {far:.3g}"
        elif run.status != 0:
            self.why = NOT_FINITE
        return (run.t, run.y.T) if run.status == 0 else None


class _TooManyError(Exception):
    """A trajectory takes too many steps."""
