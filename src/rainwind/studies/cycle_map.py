"""All limit cycles of the upper rivulet over a range of wind speeds, and what is stable at each (section 4.3)."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.diagram_results import Diagram, same_point
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.orbits import continue_orbits
from rainwind.dynamics.results import Equilibrium, SpecialPoint
from rainwind.dynamics.system import as_system
from rainwind.errors import RainwindError
from rainwind.physics.model import RivuletModel
from rainwind.studies.equilibrium_map import EquilibriumMap, equilibrium_map, speed_window
from rainwind.studies.walks import whole

SPEED = "wind.speed"
# the same labels as with ds = 0.02 and 60 intervals, at 0.02 to 0.2 % damping, in a fifth of the time
MESH, STEP = Mesh(30), 0.15
DOUBLINGS = 2  # period doublings followed one after another: cycles of up to four periods


@dataclass(frozen=True, eq=False)
class Attractors:
    """What is stable between two wind speeds (m/s): letters of equilibria, cycles in the middle of the range."""

    low: float
    high: float
    equilibria: tuple[str, ...]
    cycles: tuple[Orbit, ...]


@dataclass(frozen=True, eq=False)
class CycleMap:
    """The equilibria by letter, and every branch of cycles that is born from C or D in the window.

    Cycles that no Hopf point and no period doubling of this window leads to are not found.
    """

    equilibria: EquilibriumMap
    diagram: Diagram

    @property
    def branches(self) -> tuple[OrbitBranch, ...]:
        """The branches of cycles: those from Hopf points by rising speed, each before its doubled ones."""
        return self.diagram.orbits

    @property
    def singles(self) -> tuple[OrbitBranch, ...]:
        """The branches born at a Hopf point."""
        return tuple(branch for branch in self.branches if branch.points("hopf"))

    def points(self, kind: str) -> tuple[OrbitPoint, ...]:
        """The labelled cycles of one kind, by rising speed."""
        return tuple(p for p in self.diagram.points(kind) if isinstance(p, OrbitPoint))

    def cycles(self, speed: float) -> tuple[Orbit, ...]:
        """All cycles at one wind speed, stable and unstable, by falling amplitude of y."""
        return tuple(sorted(self.diagram.at(speed).orbits, key=lambda orbit: -orbit.amplitude["y"]))

    def attractors(self, speed: float) -> tuple[tuple[str, Equilibrium | Orbit], ...]:
        """What is stable at one wind speed: equilibria under their letters, then cycles under "cycle"."""
        return tuple(
            ("cycle" if isinstance(one, Orbit) else self.equilibria.letter_near(speed, one.state), one)
            for one in self.diagram.stable_at(speed)
        )

    def ranges(self) -> tuple[Attractors, ...]:
        """The window in pieces, in each of which the same equilibria and cycles are stable."""
        found = []
        for piece in self.diagram.stable_ranges():
            here = self.attractors(0.5 * (piece.low + piece.high))
            letters = tuple(sorted(name for name, one in here if isinstance(one, Equilibrium)))
            orbits = tuple(one for _, one in here if isinstance(one, Orbit))
            before = found[-1] if found else None
            if before and (before.equilibria, len(before.cycles)) == (letters, len(orbits)) == (letters, 0):
                found[-1] = Attractors(before.low, piece.high, letters, ())
            else:
                found.append(Attractors(piece.low, piece.high, letters, orbits))
        return tuple(found)

    def unstable_upper(self) -> tuple[tuple[float, float], ...]:
        """Speeds at which there is an upper rivulet D, but neither it nor any cycle found here is stable."""
        reach = self.equilibria.reach
        if reach is None:
            return ()
        return tuple(
            (max(one.low, reach[0]), min(one.high, reach[1]))
            for one in self.ranges()
            if not one.cycles and "D" not in one.equilibria and one.low < reach[1] and one.high > reach[0]
        )


def cycle_map(model: RivuletModel, speeds: tuple[float, float] | None = None) -> CycleMap:
    """Every branch of cycles from the Hopf points of C and D in a window of wind speeds, doublings followed.

    Computed once for a model and a window, and then remembered.
    """
    return _cycle_map(model, speeds or speed_window(model))


@lru_cache(maxsize=16)
def _cycle_map(model: RivuletModel, speeds: tuple[float, float]) -> CycleMap:
    known = equilibrium_map(model, speeds)
    hopf = [p for letter in ("C", "D") if (side := known[letter]) for p in side.points("hopf")]
    branches: list[OrbitBranch] = []
    notes: list[str] = []
    near = 1e-6 * (speeds[1] - speeds[0])
    for start in sorted(hopf, key=lambda point: point.parameter):
        ended = [p for branch in branches for p in branch.points("hopf")]
        if not any(same_point(start, point, near) for point in ended):
            _follow(model, start, speeds, branches, notes, DOUBLINGS)
    diagram = Diagram(as_system(model), SPEED, speeds, known.branches, tuple(branches), tuple(notes))
    return CycleMap(known, diagram)


def _follow(
    model: Any,
    start: SpecialPoint,
    speeds: tuple[float, float],
    branches: list[OrbitBranch],
    notes: list[str],
    doublings: int,
) -> None:
    """One branch, and those that its period doublings lead to."""
    mesh = None if isinstance(start, OrbitPoint) else MESH  # doubled cycles take twice their mother's
    try:
        branch = whole(continue_orbits(model, SPEED, start=start, until=speeds, ds=STEP, mesh=mesh))
    except (RainwindError, np.linalg.LinAlgError) as error:
        notes.append(f"cycles from {start.kind} at {start.parameter:.4f} m/s: {error}")
        return
    if not len(branch):
        return
    branches.append(branch)
    if doublings:
        for point in branch.points("pd"):
            if not any(_passes(other, point) for other in branches if other is not branch):
                _follow(model, point, speeds, branches, notes, doublings - 1)


def _passes(branch: OrbitBranch, point: OrbitPoint) -> bool:
    """Whether a branch of doubled cycles ended at this period doubling already."""
    ends = (branch[0], branch[-1])
    return any(
        abs(orbit.parameters[SPEED] - point.parameter) < 0.05
        and abs(orbit.period / point.orbit.period - 2.0) < 1e-3
        and all(abs(orbit.amplitude[n] - a) < 0.02 * max(1.0, a) for n, a in point.orbit.amplitude.items())
        for orbit in ends
    )
