"""The energy balance along a trajectory: what has been put in and taken out is what there is more or less."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.dynamics.events import Function
from rainwind.dynamics.kernels.tangents import jacobians
from rainwind.dynamics.trajectory import Trajectory
from rainwind.errors import InputError

Of = Callable[[Any, Any], Any]
DRIVEN = "driven parameters"


@dataclass(frozen=True, eq=False, repr=False)
class EnergyBalance:
    """Energy at `times` (k + 1,), and the work of everything that changes it since the start, by name (k + 1,)."""

    times: np.ndarray
    energy: np.ndarray
    work: Mapping[str, np.ndarray]

    @property
    def defect(self) -> np.ndarray:
        """By how much the change of energy differs from all work (k + 1,): zero but for the errors of the run."""
        return self.energy - self.energy[0] - sum(self.work.values(), np.zeros(len(self.times)))

    @property
    def worst(self) -> float:
        """The largest defect, as a share of the energy that has been moved: the largest work or change of energy."""
        moved = [np.ptp(self.energy), *(np.ptp(one) for one in self.work.values())]
        largest = float(max(moved))
        return float(np.abs(self.defect).max()) / largest if largest > 0.0 else 0.0

    def __repr__(self) -> str:
        work = ", ".join(f"{name} {one[-1]:+.6g}" for name, one in self.work.items())
        change = self.energy[-1] - self.energy[0]
        return f"<energy changes by {change:+.6g} to t = {self.times[-1]:.6g}; work: {work}; defect {self.worst:.1e}>"


def energy_balance(
    run: Trajectory, model: Any = None, *, energy: Of | None = None, powers: Mapping[str, Of] | None = None
) -> EnergyBalance:
    """Energy along a run, and the integrals of the powers that change it.

    model: one that offers energy(x, p) and powers(x, p) -> {name: power}; or give energy(x, p) and powers
    {name: (x, p) -> power} themselves. Parameters that signals drive and the energy depends on do work of their own,
    "driven parameters". Raises InputError for a model that offers neither, TraceError.
    """
    if energy is None and powers is None and hasattr(model, "energy") and hasattr(model, "powers"):
        energy = model.energy
        powers = {name: _named(model.powers, name) for name in model.powers(run.start, run.parameters)}
    if energy is None or powers is None:
        raise InputError(
            f"{type(model).__name__} has no energy(x, p) and powers(x, p); give energy= and powers={{name: function}}"
        )
    work = {name: run.integral(power) for name, power in powers.items()}
    if run.driven is not None:
        function = Function(energy, run.states, run.parameters, run.driven_names, "energy")
        driven = _work_of_driven(run, function)
        if np.any(driven):
            work[DRIVEN] = driven
    return EnergyBalance(run.times, run.value(energy, run.times), work)


def _named(powers: Callable[[Any, Any], Mapping[str, Any]], name: str) -> Of:
    return lambda x, p: powers(x, p)[name]


def _work_of_driven(run: Trajectory, energy: Function) -> np.ndarray:
    """The integral of dE/dp p' and the jumps of E where p jumps, from the start to each of the times (k + 1,)."""
    assert run.driven is not None
    nodes, weights = np.polynomial.legendre.leggauss(10)
    half = 0.5 * np.diff(run.times)
    t = (run.times[:-1] + half)[:, None] + half[:, None] * nodes
    p, rates = run.driven.at(t.ravel()), run.driven.at(t.ravel(), derivative=1)
    _, slopes = jacobians(*energy.tape.arrays, energy.inputs(run.at(t.ravel()), p), energy.numbers)
    smooth = half * (np.sum(slopes[:, 0] * rates, axis=1).reshape(t.shape) @ weights)
    # at each joint: the parameters at the end of one piece and at the beginning of the next
    powers = np.diff(run.times)[:, None] ** np.arange(run.driven.degree + 1)
    left = np.einsum("kij,kj->ki", run.driven.coefficients, powers)[:-1]
    right = run.driven.coefficients[1:, :, 0]
    states = run.state[1:-1]
    jumps = energy.at(states, right) - energy.at(states, left)
    jumps[np.all(np.abs(right - left) <= 1e-12 * np.abs(left), axis=1)] = 0.0
    # at a joint the later parameters hold
    return np.concatenate([[0.0], np.cumsum(smooth + np.append(jumps, 0.0))])
