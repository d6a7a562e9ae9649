"""Everything at once in one parameter: all equilibria, the orbits born at Hopf points, what branches off these."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rainwind.dynamics.branches import check_steps, window_of
from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.crossings import equilibria_at, lies_on, same_state
from rainwind.dynamics.diagram_results import Diagram, same_point
from rainwind.dynamics.equilibria import continue_equilibria, find_equilibria, find_equilibrium
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.orbits import continue_orbits
from rainwind.dynamics.results import Branch, Ended, Equilibrium, SpecialPoint
from rainwind.dynamics.system import System, as_system
from rainwind.errors import ComputationError, InputError, RainwindError, is_interrupt
from rainwind.parameters import unknown_name

Progress = Callable[[int, int, str], None]

_LADDER = 41  # values at which all equilibria are asked for
_LOOKS = (3, 10, 30)  # at so many orbits a walk looks whether its branch is known
_PACE = 150.0  # orbits in which a branch's bar is filled to 63 %, for nobody knows how long it will be
_WHOLE = 100  # of the bar, for one branch


def diagram(
    model: Any,
    along: str,
    *,
    until: tuple[float, float],
    starts: Sequence[Any] | None = None,
    orbits: bool = True,
    ds: float = 0.05,
    mesh: Mesh | None = None,
    depth: int = 3,
    progress: Progress | None = None,
) -> Diagram:
    """All branches of equilibria and periodic orbits in one parameter, within the window `until`, each once.

    Equilibria: where the model lists them (`all_states`) at 41 values of the parameter, so that a branch between two
    of these may be missed; else those that Newton reaches from the zero state at the model's own value. starts: states,
    equilibria or orbits to go from as well (or instead of the zero state). Branch points are switched at. Orbits: from
    every Hopf point, then from period doublings and branch points of orbits, at most `depth` of them one after another.
    ds, mesh: as `continue_orbits`. progress(done, total, what) is called often, and total grows with what is found.
    What cannot be started is a note of the result; after KeyboardInterrupt the result holds what was finished.
    Raises InputError for bad input, ComputationError when nothing at all was found.
    """
    check_steps(ds, 1)
    system = as_system(model)
    if not isinstance(along, str) or along not in system.parameters:
        raise unknown_name(str(along), system.parameters, "parameter")
    if isinstance(depth, bool) or not isinstance(depth, int) or depth < 0:
        raise InputError(f"depth = {depth!r}: how many switches one after another, a whole number from 0")
    window = window_of(system, along, until)
    work = _Work(system, along, window, ds, mesh, depth, progress)
    interrupted = False
    try:
        work.follow_equilibria(starts)
        if orbits:
            work.follow_orbits(starts)
        work.tell("finished")
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
        interrupted = True
    if not (work.branches or work.orbits or interrupted):
        raise ComputationError(
            f"no equilibrium was found for {along} from {window[0]:g} to {window[1]:g}; "
            + ("; ".join(work.notes) or "widen `until`, or give starts=[...], states to search from")
        )
    return Diagram(
        system, along, window, tuple(work.branches), tuple(work.orbits), tuple(work.notes), interrupted
    )


class _Known(Exception):
    """The walk is on a branch that is known already."""


class _Work:
    """What has been found so far, and what is still to be started."""

    def __init__(
        self,
        system: System,
        along: str,
        until: tuple[float, float],
        ds: float,
        mesh: Mesh | None,
        depth: int,
        progress: Progress | None,
    ) -> None:
        self.system, self.along, self.until = system, along, until
        self.ds, self.mesh, self.depth, self.progress = ds, mesh, depth, progress
        self.turns = angles(system)
        self.branches: list[Branch] = []
        self.orbits: list[OrbitBranch] = []
        self.notes: list[str] = []
        self.done, self.pending = 0, 1

    def tell(self, what: str, part: float = 0.0) -> None:
        """Report progress: what is done now, and which part of it."""
        if self.progress is not None:
            done = int(_WHOLE * (self.done + part))
            self.progress(done, max(_WHOLE * (self.done + self.pending), done), what)

    # -- equilibria ---------------------------------------------------------------------------------------------------

    def follow_equilibria(self, starts: Sequence[Any] | None) -> None:
        """All branches of equilibria, then those that branch off them."""
        self.tell("equilibria")
        for start in self.seeds(starts):
            if not self.is_known(start):
                self.add_equilibria(start)
        queue = deque(p for branch in self.branches for p in branch.points("bp"))
        while queue:
            point = queue.popleft()
            if sum(self.same(point, q) for branch in self.branches for q in branch.points("bp")) > 1:
                continue  # both branches through it are known
            if (branch := self.add_equilibria(point)) is not None:
                queue += branch.points("bp")
        self.done, self.pending = 1, 0

    def seeds(self, starts: Sequence[Any] | None) -> list[Equilibrium]:
        """Equilibria to start from, many of them on one branch."""
        found: list[Equilibrium] = []
        uncertain = 0
        if self.system.all_states is not None:
            for value in np.linspace(*self.until, _LADDER).tolist():
                listed = find_equilibria(self.system.with_parameters({self.along: value}))
                uncertain += not listed.complete
                found += listed
        if uncertain:
            self.notes.append(
                f"at {uncertain} of {_LADDER} values the list of equilibria is not certainly complete"
            )
        given = starts if starts is not None else ([] if self.system.all_states is not None else [{}])
        for start in given:
            if isinstance(start, Orbit | OrbitPoint):
                continue
            if isinstance(start, Equilibrium | SpecialPoint):
                found.append(find_equilibrium(self.system.with_parameters(start.parameters), start.state))
                continue
            try:
                found.append(find_equilibrium(self.system, start))
            except ComputationError as error:
                self.notes.append(str(error))
        return found

    def is_known(self, equilibrium: Equilibrium) -> bool:
        """Whether an equilibrium lies on a branch that was followed."""
        value = equilibrium.parameters[self.along]
        return any(
            same_state(equilibrium.state, other.state, self.turns)
            for branch in self.branches
            for other in equilibria_at(self.system, branch, value)
        )

    def add_equilibria(self, start: Equilibrium | SpecialPoint) -> Branch | None:
        """Follow one branch; None where it fails or is known."""
        value = start.parameters[self.along]
        self.tell(f"equilibria from {self.along} = {value:.5g}")
        try:
            branch = continue_equilibria(self.system, self.along, start=start, until=self.until, ds=self.ds)
        except RainwindError as error:
            self.notes.append(f"equilibria from {_where(start, self.along)}: {error}")
            return None
        known = isinstance(start, SpecialPoint) and all(
            self.is_known(self.on_branch(branch, part)) for part in (0.25, 0.5, 0.75)
        )
        if not known:
            self.branches.append(branch)
        self.raise_if_interrupted(branch)
        return None if known else branch

    def on_branch(self, branch: Branch, part: float) -> Equilibrium:
        """A point of a branch as an equilibrium."""
        i = int(part * (len(branch) - 1))
        parameters = {**branch.parameters, self.along: float(branch.parameter[i])}
        return Equilibrium(branch.states, branch.state[i], parameters, branch.eigenvalues[i], 0.0)

    # -- orbits -------------------------------------------------------------------------------------------------------

    def follow_orbits(self, starts: Sequence[Any] | None) -> None:
        """The branch of every Hopf point at which no other ended, of every given orbit, and what branches off."""
        hopf: list[Any] = []
        for branch in self.branches:
            hopf += [p for p in branch.points("hopf") if not any(self.same(p, q) for q in hopf)]
        given = [start for start in starts or () if isinstance(start, Orbit | OrbitPoint)]
        hopf.sort(key=lambda point: point.parameter)
        queue: deque[tuple[Any, int]] = deque((start, 0) for start in (*hopf, *given))
        passed = doubtful = 0
        while queue:
            start, level = queue.popleft()
            self.pending = 1 + len(queue)
            found = None if self.is_used(start) else self.add_orbits(start)
            self.done += 1
            for point in (*found.points("pd"), *found.points("bp")) if found else ():
                if not point.certificate.holds:
                    doubtful += 1
                elif level < self.depth:
                    queue.append((point, level + 1))
                else:
                    passed += 1
        self.pending = 0
        if passed:
            self.notes.append(
                f"{passed} period doublings or branch points of orbits were not followed: depth = {self.depth}"
            )
        if doubtful:
            self.notes.append(
                f"{doubtful} period doublings or branch points of orbits were not followed, not being certain: "
                "their certificates do not hold"
            )

    def is_used(self, start: Any) -> bool:
        """Whether another branch ended at a Hopf point, or every branch through a branch point is known."""
        if not isinstance(start, SpecialPoint) or start.kind not in ("hopf", "bp"):
            return False
        same = sum(self.same(start, other) for branch in self.orbits for other in branch.points(start.kind))
        return same > (start.kind == "bp")

    def add_orbits(self, start: Any) -> OrbitBranch | None:
        """Follow one branch of orbits; None where it fails or is known."""
        where = _where(start, self.along)
        what = f"orbits from {where}"
        self.tell(what)

        def look(orbit: Orbit, count: int) -> None:
            value = orbit.parameters[self.along]
            part = 1.0 - np.exp(-count / _PACE)
            self.tell(f"{what}: {count}, {self.along} = {value:.5g}", part)
            if count in _LOOKS and any(lies_on(self.system, branch, orbit) for branch in self.orbits):
                raise _Known

        try:
            branch = continue_orbits(
                self.system,
                self.along,
                start=start,
                until=self.until,
                ds=self.ds,
                mesh=self.mesh,
                progress=look,
            )
        except _Known:
            return None
        except (RainwindError, np.linalg.LinAlgError) as error:
            self.notes.append(f"orbits from {where}: {error}")
            return None
        if len(branch):
            self.orbits.append(branch)
            if Ended.FAMILY in branch.ended:
                self.notes.append(f"orbits from {where}: {Ended.FAMILY.value}")
        else:
            self.notes.append(f"orbits from {where}: not even one was found ({branch.ended[1].value})")
        self.raise_if_interrupted(branch)
        return branch if len(branch) else None

    def same(self, a: SpecialPoint, b: SpecialPoint) -> bool:
        """Whether two labels stand for one point."""
        return same_point(a, b, 1e-6 * (self.until[1] - self.until[0]))

    def raise_if_interrupted(self, branch: Branch | OrbitBranch) -> None:
        """A walk keeps what it has when Ctrl-C comes; the rest of the work must stop as well."""
        if Ended.INTERRUPTED in branch.ended:
            raise KeyboardInterrupt


def angles(system: System) -> np.ndarray:
    """Which states are angles (n,): those that the equations only know modulo 2 pi."""
    random = np.random.default_rng(1).uniform(-1.5, 1.5, (4, len(system.states)))
    found = []
    for k in range(len(system.states)):
        turned = random.copy()
        turned[:, k] += 2 * np.pi
        with np.errstate(all="ignore"):
            found.append(np.allclose(system.f(turned), system.f(random), rtol=1e-9, atol=1e-9))
    return np.array(found)


def _where(start: Any, along: str) -> str:
    name = start.kind if isinstance(start, SpecialPoint) else "a start"
    return f"{name} at {along} = {start.parameters[along]:.6g}"
