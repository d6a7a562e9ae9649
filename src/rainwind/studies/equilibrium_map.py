"""All equilibria over a range of wind speeds, under the paper's letters A, B, C, D (section 4.1)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, cos, floor, pi

import numpy as np

from rainwind.dynamics.equilibria import continue_equilibria, find_equilibria
from rainwind.dynamics.results import Branch, Equilibrium, SpecialPoint
from rainwind.physics.model import RivuletModel
from rainwind.studies import paper
from rainwind.studies.walks import whole

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

    def covered(self, model: RivuletModel) -> tuple[float, float] | None:
        """The longest range of speeds over which the angle of attack lies where the coefficients are valid."""
        speeds, states = self.states()
        inside = [_covers(model, float(state[1])) for state in states]
        edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
        runs = [(float(speeds[i]), float(speeds[j - 1])) for i, j in edges.reshape(-1, 2)]
        return max(runs, key=lambda run: run[1] - run[0], default=None)

    def at(self, speed: float) -> np.ndarray | None:
        """The state at one speed, interpolated; None outside its range."""
        speeds, states = self.states()
        if not speeds[0] <= speed <= speeds[-1]:
            return None
        return np.array([np.interp(speed, speeds, column) for column in states.T])


@dataclass(frozen=True, eq=False)
class EquilibriumMap:
    """The branches of equilibria in a window of wind speeds (m/s), and the sides of each, by letter.

    notes: what a reader must know of the letters, such as equilibria outside the coefficients' range.
    """

    model: RivuletModel
    speeds: tuple[float, float]
    branches: tuple[Branch, ...]
    sides: tuple[Side, ...]
    notes: tuple[str, ...] = ()

    def __getitem__(self, letter: str) -> Side | None:
        return next((side for side in self.sides if side.letter == letter), None)

    @property
    def onset(self) -> float | None:
        """The speed of the fold in which D begins, m/s; None without one."""
        return self.fold.parameter if self.fold else None

    @property
    def fold(self) -> SpecialPoint | None:
        """The fold in which D begins; None without one. A fold at D's highest speed is where it ends."""
        upper = self["D"]
        if upper is None:
            return None
        first = upper.states()[0][0]
        return next((p for p in upper.folds if p.parameter <= first), None)

    @property
    def reach(self) -> tuple[float, float] | None:
        """The speeds between which D is there and inside the coefficients' range, m/s."""
        upper = self["D"]
        return upper.covered(self.model) if upper else None

    def existence(self) -> list[str]:
        """In a sentence, whether there is an upper rivulet D and where it begins; none where no fold begins it."""
        if self.reach is None:
            return [f"There is no upper rivulet D between {self.speeds[0]:g} and {self.speeds[1]:g} m/s."]
        return (
            [] if self.onset is None else [f"The upper rivulet D exists above {self.onset:.2f} m/s (fold)."]
        )

    @property
    def outside(self) -> tuple[Side, ...]:
        """Sides without a letter that lie outside the coefficients' range altogether."""
        return tuple(side for side in self.sides if not side.letter and side.covered(self.model) is None)

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

    A hangs at the bottom at the lowest speed. D is another equilibrium that is statically stable, with an angle of
    attack inside the coefficients' valid range, B and C are its neighbours at smaller and larger phi; without D
    every saddle of the lowest speed is B.
    """
    branches: list[Branch] = []
    for speed in np.linspace(*speeds, _LADDER):
        at_speed = model.with_parameters({"wind.speed": float(speed)})
        for equilibrium in find_equilibria(at_speed):
            if not any(_passes(branch, float(speed), equilibrium["phi"]) for branch in branches):
                branches.append(
                    whole(continue_equilibria(at_speed, "wind.speed", start=equilibrium, until=speeds, ds=ds))
                )
    sides = tuple(side for branch in branches for side in _sides(branch))
    named, several = _named(model, sides, speeds[0])
    known = EquilibriumMap(model, speeds, tuple(branches), named)
    return replace(known, notes=(*several, *_notes(known)))


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


def _covers(model: RivuletModel, phi: float) -> bool:
    """Whether the set is valid at the angle of attack of a rivulet at rest, -phi."""
    alpha = -((phi + pi) % (2 * pi) - pi)
    return any(model.coefficients.covers(alpha + turn) for turn in (-2 * pi, 0.0, 2 * pi))


def _named(
    model: RivuletModel, sides: tuple[Side, ...], lowest: float
) -> tuple[tuple[Side, ...], tuple[str, ...]]:
    """The sides with their letters, and a note if D was chosen among several."""
    letters = [""] * len(sides)
    stable = [i for i, side in enumerate(sides) if side.statically_stable]
    angle = {i: at[1] for i, side in enumerate(sides) if (at := side.at(lowest)) is not None}
    hanging = [i for i in stable if i in angle and cos(angle[i] + model.beta) < 0]
    if hanging:
        letters[min(hanging, key=lambda i: cos(angle[i] + model.beta))] = "A"
    saddles = [i for i in range(len(sides)) if i not in stable]
    first, notes = _upper(model, sides, [i for i in stable if not letters[i]])
    if first is None:
        for i in saddles:
            letters[i] = "B" if i in angle else ""
    else:
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
    return tuple(replace(side, letter=x) for side, x in zip(sides, letters, strict=True)), notes


def _upper(
    model: RivuletModel, sides: tuple[Side, ...], candidates: Sequence[int]
) -> tuple[int | None, tuple[str, ...]]:
    """Which side is D: valid coefficients, on the upper windward quarter if one is, over the most speeds."""
    valid = {i: run for i in candidates if (run := sides[i].covered(model)) is not None}
    quarter = []
    for i, run in valid.items():
        at = sides[i].at(0.5 * sum(run))
        if at is not None and 0 <= (float(at[1]) + pi) % (2 * pi) - pi <= 0.5 * pi:
            quarter.append(i)
    among = quarter or list(valid)
    if not among:
        return None, ()
    first = max(among, key=lambda i: valid[i][1] - valid[i][0])
    if len(valid) == 1:
        return first, ()
    return first, (
        f"{len(valid)} equilibria could be D; taken is the one from {valid[first][0]:.2f} "
        f"to {valid[first][1]:.2f} m/s",
    )


def _notes(known: EquilibriumMap) -> Iterator[str]:
    """Where the set's range ends: what D leaves it, and what lies beyond and is not D."""
    low, high = np.degrees(known.model.coefficients.valid)
    upper, reach = known["D"], known.reach
    if upper is not None and reach is not None:
        ends = upper.states()[0][[0, -1]]
        if reach[0] > ends[0] + 0.1 or reach[1] < ends[1] - 0.1:
            yield f"D lies in the coefficients' range only from {reach[0]:.2f} to {reach[1]:.2f} m/s"
        if ends[1] < known.speeds[1] - 1e-9:
            yield f"D ends at {ends[1]:.2f} m/s, in a second fold"
    beyond = [side for side in known.outside if side.statically_stable]
    for side in beyond:
        speeds, states = side.states()
        first, last = np.sort(np.degrees(states[[0, -1], 1]))
        yield (
            f"an equilibrium at phi {first:.0f} to {last:.0f}° ({speeds[0]:.1f} to {speeds[-1]:.1f} m/s) lies "
            f"outside the coefficients' range ({low:.0f} to {high:.0f}° of attack) and is not D"
        )
