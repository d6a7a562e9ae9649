"""What the cable and the rivulet do in the long run, in words and numbers of a map."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.attractors import Attractor, Kind
from rainwind.physics.model import RivuletModel
from rainwind.studies.equilibrium_map import EquilibriumMap, equilibrium_map, speed_window

# the numbers that stand in tables and pictures; -1 is what was not computed
NAMES = (
    "rivulet lost", "at rest", "steady vibration", "beats (torus)", "chaos", "vibration, rivulet going round",
    "not settled", "runs away",
)  # fmt: skip
LOST, REST, CYCLE, TORUS, CHAOS, TURNS, UNDECIDED, AWAY = range(len(NAMES))
MISSING = -1
_NUMBERS = {
    Kind.LOST: LOST, Kind.EQUILIBRIUM: REST, Kind.CYCLE: CYCLE, Kind.TORUS: TORUS, Kind.CHAOS: CHAOS,
    Kind.TURNS: TURNS, Kind.UNDECIDED: UNDECIDED, Kind.RAN_AWAY: AWAY,
}  # fmt: skip
LEAST, MOST, WINDOW = 2000.0, 20_000.0, 60.0  # periods: how long a run is followed, and looked at
EFOLDS = 12.0  # of the dry cable's decay: what a run is given to settle in
_ALIKE = 0.05


def numbers_of(found: Sequence[Attractor | None]) -> np.ndarray:
    """The number of each attractor's name (N,), MISSING where there is none."""
    return np.array([MISSING if one is None else _NUMBERS[one.kind] for one in found], dtype=int)


def amplitudes_of(found: Sequence[Attractor | None], name: str) -> np.ndarray:
    """Half peak to peak of one state (N,); nan where the rivulet is lost or nothing is known."""
    return np.array(
        [
            np.nan if one is None or one.kind in (Kind.LOST, Kind.RAN_AWAY) else one.amplitude[name]
            for one in found
        ]
    )


def times_of(model: RivuletModel, longest: float | None, ratio: float) -> tuple[float, float]:
    """How long to follow and to look, in s: by default the time in which a dry cable of this damping ratio decays by
    e^12, but 2000 periods at least and 20000 at most; and 60 periods."""
    section = model.section
    period = 1.0 / min(section.frequency_y, section.frequency_z)
    if longest is None:
        decay = EFOLDS / (2.0 * np.pi * max(ratio, 1e-12))
        longest = float(np.clip(decay, LEAST, MOST)) * period
    return longest, min(WINDOW * period, longest / 4.0)


@dataclass(frozen=True, eq=False)
class UpperRivulet:
    """Where the upper rivulet is at each wind speed: D's state, or D's nearest one where there is no D."""

    known: EquilibriumMap

    def at(self, speed: float) -> np.ndarray | None:
        """The state (n,); None where there is no D at any speed."""
        upper, reach = self.known["D"], self.known.reach
        return None if upper is None or reach is None else upper.at(float(np.clip(speed, *reach)))


def upper_rivulet(model: RivuletModel, speeds: tuple[float, float]) -> UpperRivulet:
    """Over a range of wind speeds, and at least over the model's own window."""
    low, high = speed_window(model)
    return UpperRivulet(equilibrium_map(model, (min(low, speeds[0]), max(high, speeds[1]))))


@dataclass(frozen=True)
class Group:
    """Trajectories that end on the same: number in NAMES, an example, which of them (indices)."""

    number: int
    example: Attractor
    members: tuple[int, ...]

    @property
    def words(self) -> str:
        """For a legend."""
        if self.number not in (CYCLE, TORUS, CHAOS, TURNS):
            return NAMES[self.number]
        sizes = [f"{n} ±{self.example.amplitude[n]:.2f} m" for n in ("y", "z") if n in self.example.amplitude]
        return f"{NAMES[self.number]}: {', '.join(sizes)}"


def groups_of(found: Sequence[Attractor | None]) -> tuple[Group, ...]:
    """What ends on the same, the most frequent of each name first: cycles are told apart by their amplitudes."""
    groups: list[tuple[int, Attractor, list[int]]] = []
    for i, one in enumerate(found):
        if one is None:
            continue
        number = _NUMBERS[one.kind]
        same = (g for g in groups if g[0] == number and (number != CYCLE or _alike(g[1], one)))
        group = next(same, None)
        if group is None:
            groups.append((number, one, [i]))
        else:
            group[2].append(i)
    return tuple(
        Group(number, one, tuple(members))
        for number, one, members in sorted(groups, key=lambda g: (g[0], -len(g[2])))
    )


def _alike(a: Attractor, b: Attractor) -> bool:
    names = [n for n in ("y", "z") if n in a.amplitude]
    largest = max(max(a.amplitude[n], b.amplitude[n]) for n in names)
    return all(abs(a.amplitude[n] - b.amplitude[n]) <= _ALIKE * largest for n in names)
