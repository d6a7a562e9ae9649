"""A flow and its derivative over a span of time, by SciPy's Runge-Kutta methods: slow, general, of another make.

Nothing here shares code with collocation but the tape: it is what orbits are checked against.
"""

from dataclasses import dataclass, field
from math import isfinite
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from rainwind.dynamics.kernels.tangents import jacobian_at
from rainwind.dynamics.kernels.values import specialised
from rainwind.dynamics.system import System

STIFF = 5e3  # rate times span above which Radau's steps cost less than DOP853's many
EVALUATIONS = 50_000  # in one span, by each method


@dataclass(frozen=True, eq=False)
class Transition:
    """A flow's end (n,), its derivative by the start (n, n), the integral of trace J; `fast`: by DOP853."""

    end: np.ndarray
    matrix: np.ndarray
    trace: float
    fast: bool


@dataclass(frozen=True, eq=False)
class Flow:
    """x' = f and M' = J M with every state in its unit: units (n,), tolerance relative and absolute."""

    system: System
    units: np.ndarray
    tolerance: float
    _tape: tuple = field(init=False, repr=False)

    def __post_init__(self) -> None:
        n = self.units.size
        inputs = self.system.inputs(np.zeros(n))
        operations, template, outputs = self.system.tape.arrays
        varies = np.arange(inputs.size) < n
        tape = (*specialised(operations, template, inputs, varies), outputs)
        object.__setattr__(self, "_tape", (tape, inputs, np.arange(n), self.units / self.units[:, None]))

    def slope(self, x: np.ndarray) -> np.ndarray:
        """f: states (..., n), in units, to rates (..., n), in units."""
        return self.system.f(x * self.units) / self.units

    def rate(self, x: np.ndarray) -> float:
        """The largest modulus of an eigenvalue of J at x."""
        j = self.system.jacobian(x * self.units)
        return float(np.max(np.abs(np.linalg.eigvals(j)))) if np.all(np.isfinite(j)) else np.inf

    def states(self, x: np.ndarray, times: np.ndarray) -> np.ndarray | None:
        """The states at rising times (k, n) from x at time 0; None where the trajectory runs away."""
        tape, inputs, directions, ratio = self._tape
        at = inputs.copy()

        def rhs(_: float, x: np.ndarray) -> np.ndarray:
            at[: x.size] = x * self.units
            return jacobian_at(*tape, at, directions)[0] / self.units

        def jacobian(_: float, x: np.ndarray) -> np.ndarray:
            at[: x.size] = x * self.units
            return jacobian_at(*tape, at, directions)[1] * ratio

        return self._solve(rhs, jacobian, x, times, self.rate(x) * times[-1] < STIFF)

    def over(self, x: np.ndarray, span: float) -> Transition | None:
        """The transition from x over a span of time; None where the trajectory runs away."""
        n = x.size
        tape, inputs, directions, ratio = self._tape
        at = inputs.copy()

        def rhs(_: float, y: np.ndarray) -> np.ndarray:
            at[:n] = y[:n] * self.units
            f, j = jacobian_at(*tape, at, directions)
            found = np.empty(y.size)
            found[:n] = f / self.units
            np.matmul(j * ratio, y[n:-1].reshape(n, n), out=found[n:-1].reshape(n, n))
            found[-1] = j.trace()
            return found

        def jacobian(_: float, y: np.ndarray) -> np.ndarray:
            at[:n] = y[:n] * self.units
            j = jacobian_at(*tape, at, directions)[1] * ratio
            found = np.zeros((y.size, y.size))
            found[:n, :n] = j
            found[n:-1, n:-1] = np.kron(j, np.eye(n))
            return found  # how M' and q' vary with x is left out: Radau's Newton takes hardly a step more

        fast = self.rate(x) * span < STIFF
        y = self._solve(rhs, jacobian, np.concatenate([x, np.eye(n).ravel(), [0.0]]), np.array([span]), fast)
        if y is None:
            return None
        return Transition(y[0, :n], y[0, n:-1].reshape(n, n).copy(), float(y[0, -1]), fast)

    def _solve(self, rhs, jacobian, start, times: np.ndarray, fast: bool) -> np.ndarray | None:
        """All unknowns at rising times (k, .), by DOP853 where that is `fast`."""
        count = 0

        def counted(t: float, y: np.ndarray) -> np.ndarray:
            nonlocal count
            count += 1
            found = rhs(t, y)
            if count > EVALUATIONS:
                raise _TooManyError
            if not isfinite(found.sum()):
                raise _RunsAwayError
            return found

        options: dict[str, Any] = {"method": "DOP853"} if fast else {"method": "Radau", "jac": jacobian}
        try:
            with np.errstate(all="ignore"):
                run = solve_ivp(
                    counted, (0.0, times[-1]), start, t_eval=times, rtol=self.tolerance, atol=self.tolerance, **options
                )  # fmt: skip
        except _TooManyError:
            return self._solve(rhs, jacobian, start, times, False) if fast else None
        # ValueError: SciPy refuses steps that are zero and matrices that are not finite
        except (_RunsAwayError, ValueError):
            return None
        return run.y.T if run.status == 0 else None


class _RunsAwayError(Exception):
    """A trajectory leaves the numbers."""


class _TooManyError(Exception):
    """A trajectory takes too many steps."""
