"""All equilibria over a range of wind speeds, under the paper's letters A, B, C, D (section 4.1)."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, cos, floor, pi

import numpy as np

from rainwind.dynamics.equilibria import continue_equilibria, find_equilibria
from rainwind.dynamics.results import Branch, Equilibrium, SpecialPoint
from rainwind.physics.model import RivuletModel
from rainwind.studies import paper

_LADDER = 7
_WIDEST = (1.0, 60.0)


@dataclass(frozen=True, eq=False)
class Side:
    """One equilibrium over the wind speeds where it exists: the part of a branch between two folds.

    letter: A, B, C, D, or "" where a model has more than the paper's four. bounds: arclengths on the branch.
    """

    letter: str
    branch: Branch
    bounds: tuple[float, float]

    @property
    def inside(self) -> np.ndarray:
        """Which points of the branch belong to it (N,)."""
        s = self.branch.arclength
        return (s > self.bounds[0]) & (s < self.bounds[1])

    @property
    def folds(self) -> tuple[SpecialPoint, ...]:
        """The folds at which it begins or ends."""
        return tuple(p for p in self.branch.points("fold") if p.arclength in self.bounds)

    @property
    def statically_stable(self) -> bool:
        """Whether an even number of real eigenvalues is positive: no saddle."""
        middle = self.branch.eigenvalues[self.inside][int(self.inside.sum()) // 2]
        return int(np.sum((middle.imag == 0) & (middle.real > 0))) % 2 == 0

    def points(self, kind: str) -> tuple[SpecialPoint, ...]:
        """The special points of one kind on it, by rising speed."""
        low, high = self.bounds
        found = [p for p in self.branch.points(kind) if low < p.arclength < high]
        return tuple(sorted(found, key=lambda p: p.parameter))

    def states(self) -> tuple[np.ndarray, np.ndarray]:
        """Wind speeds (m,), rising, and states (m, n); the folds at its ends are included."""
        speed = [*self.branch.parameter[self.inside], *(p.parameter for p in self.folds)]
        state = np.vstack([self.branch.state[self.inside], *(p.state[None, :] for p in self.folds)])
        order = np.argsort(speed, kind="stable")
        return np.asarray(speed)[order], state[order]

    def at(self, speed: float) -> np.ndarray | None:
        """The state at one speed, interpolated; None outside its range."""
        speeds, states = self.states()
        if not speeds[0] <= speed <= speeds[-1]:
            return None
        return np.array([np.interp(speed, speeds, column) for column in states.T])


@dataclass(frozen=True, eq=False)
class EquilibriumMap:
    """The branches of equilibria in a window of wind speeds (m/s), and the sides of each, by letter."""

    model: RivuletModel
    speeds: tuple[float, float]
    branches: tuple[Branch, ...]
    sides: tuple[Side, ...]

    def __getitem__(self, letter: str) -> Side | None:
        return next((side for side in self.sides if side.letter == letter), None)

    @property
    def onset(self) -> float | None:
        """The speed of the fold in which D begins, m/s; None without one."""
        upper = self["D"]
        return min((p.parameter for p in upper.folds), default=None) if upper else None

    def letter_near(self, speed: float, state: np.ndarray) -> str:
        """The letter of the equilibrium next to a state at a speed."""
        near = [
            (float(np.abs(at - state).max()), s.letter) for s in self.sides if (at := s.at(speed)) is not None
        ]
        return min(near)[1] if near else ""


def equilibria_by_letter(
    model: RivuletModel, speeds: tuple[float, float] | None = None
) -> dict[str, Equilibrium]:
    """The equilibria at the model's own wind speed under the paper's letters."""
    speed = model.wind.speed
    low, high = speeds or speed_window(model)
    known = equilibrium_map(model, (min(low, speed), max(high, speed)))
    found = {known.letter_near(speed, e.state): e for e in find_equilibria(model)}
    return dict(sorted((letter, e) for letter, e in found.items() if letter))


def speed_window(model: RivuletModel, reach: float = 2.5) -> tuple[float, float]:
    """Wind speeds from half the onset speed to `reach` times it, in whole m/s; the paper's without an onset."""
    onset = equilibrium_map(model, _WIDEST).onset
    if onset is None:
        return paper.SPEEDS[0], paper.SPEEDS[1] * reach / 2.5
    return float(max(1, floor(onset / 2 + 0.5))), float(ceil(reach * onset - 0.25))


def equilibrium_map(model: RivuletModel, speeds: tuple[float, float], *, ds: float = 0.05) -> EquilibriumMap:
    """Every branch that passes one of a ladder of speeds, walked over the window and named.

    A hangs at the bottom at the lowest speed. D is another equilibrium that is statically stable, B and C are its
    neighbours at smaller and larger phi; without D every saddle of the lowest speed is B.
    """
    branches: list[Branch] = []
    for speed in np.linspace(*speeds, _LADDER):
        at_speed = model.with_parameters({"wind.speed": float(speed)})
        for equilibrium in find_equilibria(at_speed):
            if not any(_passes(branch, float(speed), equilibrium["phi"]) for branch in branches):
                branches.append(
                    continue_equilibria(at_speed, "wind.speed", start=equilibrium, until=speeds, ds=ds)
                )
    sides = tuple(side for branch in branches for side in _sides(branch))
    return EquilibriumMap(model, speeds, tuple(branches), _named(model, sides, speeds[0]))


def _passes(branch: Branch, speed: float, phi: float) -> bool:
    crossings = branch.at("wind.speed", speed)
    ends = branch["phi"][[0, -1]][np.abs(branch.parameter[[0, -1]] - speed) < 1e-6]
    angles = [*np.interp(crossings, branch.arclength, branch["phi"]), *ends]
    # two branches may only come this close at a fold, where they are one
    return any(abs((angle - phi + pi) % (2 * pi) - pi) < 0.02 for angle in angles)


def _sides(branch: Branch) -> Iterator[Side]:
    cuts = [-np.inf, *(p.arclength for p in branch.points("fold")), np.inf]
    for low, high in pairwise(cuts):
        side = Side("", branch, (low, high))
        if side.inside.any():
            yield side


def _named(model: RivuletModel, sides: tuple[Side, ...], lowest: float) -> tuple[Side, ...]:
    beta = model.beta
    letters = [""] * len(sides)
    stable = [i for i, side in enumerate(sides) if side.statically_stable]
    angle = {i: at[1] for i, side in enumerate(sides) if (at := side.at(lowest)) is not None}
    hanging = [i for i in stable if i in angle and cos(angle[i] + beta) < 0]
    if hanging:
        letters[min(hanging, key=lambda i: cos(angle[i] + beta))] = "A"
    upper = [i for i in stable if not letters[i]]
    saddles = [i for i in range(len(sides)) if i not in stable]
    if not upper:
        for i in saddles:
            letters[i] = "B" if i in angle else ""
        return tuple(replace(side, letter=letter) for side, letter in zip(sides, letters, strict=True))
    first = min(upper, key=lambda i: sides[i].states()[0][0])
    letters[first] = "D"
    speeds, states = sides[first].states()
    # half way along, all that belong together are there
    speed, phi = float(speeds[len(speeds) // 2]), float(states[len(speeds) // 2, 1])
    beside = {i: at[1] for i in saddles if (at := sides[i].at(speed)) is not None}
    below = [i for i in beside if beside[i] < phi]
    above = [i for i in beside if beside[i] > phi]
    if below:
        letters[max(below, key=lambda i: beside[i])] = "B"
    if above:
        letters[min(above, key=lambda i: beside[i])] = "C"
    return tuple(replace(side, letter=letter) for side, letter in zip(sides, letters, strict=True))
