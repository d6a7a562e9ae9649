"""Everything about a system in one parameter: all branches, their points, what exists and what is stable where."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from rainwind.dynamics.crossings import doubled, equilibria_at, orbits_at, same_orbit, same_state
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.results import Branch, Ended, Equilibrium, SpecialPoint
from rainwind.dynamics.system import System, number
from rainwind.errors import InputError
from rainwind.parameters import unknown_name

_MANY = 3  # unexplained changes of one branch that an audit tells one by one


@dataclass(frozen=True, eq=False, repr=False)
class Coexisting:
    """What exists at one value of the parameter: equilibria and orbits, each once, and where each comes from.

    equilibrium_branches, orbit_branches: the number of the diagram's branch that each lies on.
    """

    along: str
    value: float
    equilibria: tuple[Equilibrium, ...]
    orbits: tuple[Orbit, ...]
    equilibrium_branches: tuple[int, ...]
    orbit_branches: tuple[int, ...]

    @property
    def stable(self) -> tuple[Equilibrium | Orbit, ...]:
        """The attractors among them."""
        return tuple(one for one in (*self.equilibria, *self.orbits) if one.stable)

    def __len__(self) -> int:
        return len(self.equilibria) + len(self.orbits)

    def __repr__(self) -> str:
        lines = [
            f"<at {self.along} = {self.value:.8g}: {len(self.equilibria)} equilibria, {len(self.orbits)} orbits"
        ]
        lines += [f"  {one!r}" for one in self.equilibria]
        for orbit in self.orbits:
            swing = ", ".join(f"{name} +-{size:.4g}" for name, size in orbit.amplitude.items())
            lines.append(f"  {orbit!r}: {swing}")
        return "\n".join(lines) + ">"


@dataclass(frozen=True)
class StableRange:
    """Values of the parameter between which the same branches are stable: their numbers in the diagram."""

    low: float
    high: float
    equilibria: tuple[int, ...]
    orbits: tuple[int, ...]


@dataclass(frozen=True, eq=False, repr=False)
class Diagram:
    """All branches of equilibria and of periodic orbits found in one parameter.

    notes: what could not be started or followed, in sentences; interrupted: whether the user stopped the work, so
    that branches are missing.
    """

    system: System
    along: str
    until: tuple[float, float]
    equilibria: tuple[Branch, ...]
    orbits: tuple[OrbitBranch, ...]
    notes: tuple[str, ...] = ()
    interrupted: bool = False

    def points(self, kind: str | None = None) -> tuple[Any, ...]:
        """The special points of one kind, or all, of all branches: each once, by rising parameter."""
        known = tuple(dict.fromkeys((*Branch.kinds, *OrbitBranch.kinds)))
        if kind is not None and kind not in known:
            raise unknown_name(kind, known, "kind of special point")
        found: list[Any] = []
        for branch in (*self.equilibria, *self.orbits):
            for point in branch.special:
                if kind in (None, point.kind) and not any(self.same_point(point, other) for other in found):
                    found.append(point)
        return tuple(sorted(found, key=lambda point: point.parameter))

    def same_point(self, a: SpecialPoint, b: SpecialPoint) -> bool:
        """Whether two labels stand for one point."""
        return same_point(a, b, 1e-6 * (self.until[1] - self.until[0]))

    def at(self, value: float) -> Coexisting:
        """All equilibria and orbits at one value of the parameter, computed there. InputError outside `until`."""
        value = number(value, self.along)
        low, high = self.until
        if not low <= value <= high:
            raise InputError(
                f"{self.along} = {value:g} lies outside the diagram, which goes from {low:g} to {high:g}"
            )
        equilibria: list[tuple[Equilibrium, int]] = []
        orbits: list[tuple[Orbit, int]] = []
        for k, branch in enumerate(self.equilibria):
            for one in equilibria_at(self.system, branch, value):
                if not any(same_state(one.state, other.state) for other, _ in equilibria):
                    equilibria.append((one, k))
        for k, orbit_branch in enumerate(self.orbits):
            for orbit in orbits_at(self.system, orbit_branch, value, birth=self.births[k][0]):
                if not any(same_orbit(orbit, other) for other, branch_of in orbits if branch_of != k):
                    orbits.append((orbit, k))
        return Coexisting(
            self.along, value, tuple(e for e, _ in equilibria), tuple(o for o, _ in orbits),
            tuple(k for _, k in equilibria), tuple(k for _, k in orbits),
        )  # fmt: skip

    def stable_at(self, value: float) -> tuple[Equilibrium | Orbit, ...]:
        """The attractors at one value of the parameter, equilibria first."""
        return self.at(value).stable

    def stable_ranges(self) -> tuple[StableRange, ...]:
        """The whole range of the parameter in pieces, each with the branches that are stable on it."""
        least = 1e-9 * (self.until[1] - self.until[0])
        runs = [(k, 0, run) for k, b in enumerate(self.equilibria) for run in self.stable_runs(b)]
        runs += [(k, 1, run) for k, b in enumerate(self.orbits) for run in self.stable_runs(b)]
        ends = sorted({*self.until, *(end for _, _, run in runs for end in run)})
        edges = [a for a, b in zip(ends, [*ends[1:], np.inf], strict=True) if b - a > least]
        edges[0], edges[-1] = self.until
        found: list[StableRange] = []
        for low, high in pairwise(edges):
            middle = 0.5 * (low + high)
            numbers = [
                tuple(sorted({k for k, what, (a, b) in runs if what == kind and a < middle < b}))
                for kind in (0, 1)
            ]
            if found and (found[-1].equilibria, found[-1].orbits) == tuple(numbers):
                low = found.pop().low
            found.append(StableRange(low, high, numbers[0], numbers[1]))
        return tuple(found)

    @cached_property
    def births(self) -> tuple[tuple[OrbitPoint | None, OrbitPoint | None], ...]:
        """The period doublings in which each branch of orbits begins and ends, if it does so in one."""
        doublings = self.points("pd")
        return tuple((birth_of(b, doublings, 0), birth_of(b, doublings, -1)) for b in self.orbits)

    def pieces(
        self, branch: Branch | OrbitBranch, *names: str
    ) -> Iterator[tuple[int, tuple[np.ndarray, ...]]]:
        """The pieces of one of the branches as `branch.pieces`, drawn through to where orbits are born."""
        births = next((pair for b, pair in zip(self.orbits, self.births, strict=True) if b is branch), ())
        return drawn(branch, *names, births=births)

    def stable_runs(self, branch: Branch | OrbitBranch) -> Iterator[tuple[float, float]]:
        """Ranges of the parameter over which a branch is stable, one for each of its pieces."""
        for unstable, (x,) in self.pieces(branch, self.along):
            if not unstable:
                yield float(x.min()), float(x.max())

    def audit(self) -> list[str]:
        """Everything about this diagram that a careful reader should know before trusting it."""
        faults = ["interrupted by the user: branches are missing"] if self.interrupted else []
        for name, branches in (("equilibria", self.equilibria), ("orbits", self.orbits)):
            for k, branch in enumerate(branches):
                gaps = [str(gap) for gap in branch.unexplained]
                own = [fault for fault in branch.audit() if fault not in gaps]
                if len(gaps) > _MANY:
                    gaps = [f"{gaps[0]}, and {len(gaps) - 1} more like it"]
                faults += [f"{name} {k}: {fault}" for fault in (*own, *gaps)]
                if Ended.INTERRUPTED in branch.ended:
                    faults.append(f"{name} {k}: {Ended.INTERRUPTED.value}")
        return faults + list(self.notes)

    def tables(self) -> dict[str, dict[str, np.ndarray]]:
        """Columns by name for each branch (`equilibria_0`, `orbits_0`, ...) and of all points (`special_points`)."""
        found: dict[str, dict[str, np.ndarray]] = {}
        for k, branch in enumerate(self.equilibria):
            columns = {self.along: branch.parameter} | {name: branch[name] for name in branch.states}
            columns["growth"] = branch.eigenvalues.real.max(axis=1)
            found[f"equilibria_{k}"] = columns | {"unstable": branch.unstable}
        for k, orbits in enumerate(self.orbits):
            columns = {self.along: orbits.parameter, "period": orbits.column("period")}
            for name in orbits.states:
                columns |= {f"{of} {name}": orbits.column(f"{of} {name}") for of in ("min", "max", "mean")}
            first = [orbit.exponents.real.max(initial=-np.inf) for orbit in orbits]
            columns["log largest multiplier"] = np.array(first)
            found[f"orbits_{k}"] = columns | {"unstable": orbits.unstable}
        points = self.points()
        found["special_points"] = {
            "kind": np.array([p.kind for p in points], dtype=object),
            self.along: np.array([p.parameter for p in points]),
            "period": np.array([p.orbit.period if isinstance(p, OrbitPoint) else _period(p) for p in points]),
            "coefficient": np.array([_coefficient(p) for p in points], dtype=float),
        }
        return found

    def __repr__(self) -> str:
        low, high = self.until
        lines = [
            f"<diagram in {self.along} = {low:g} ... {high:g}: {len(self.equilibria)} branches of equilibria, "
            f"{len(self.orbits)} of orbits{', interrupted' if self.interrupted else ''}"
        ]
        for name, branches in (("equilibria", self.equilibria), ("orbits", self.orbits)):
            for k, branch in enumerate(branches):
                p, labels = branch.parameter, ", ".join(f"{q.kind} {q.parameter:.7g}" for q in branch.special)
                if not len(p):
                    continue
                runs = ", ".join(f"{a:.5g} ... {b:.5g}" for a, b in self.stable_runs(branch)) or "nowhere"
                lines.append(
                    f"  {name} {k}: {p.min():.6g} ... {p.max():.6g}, {len(p)} points; stable {runs}; "
                    f"{labels or 'no special points'}"
                )
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)]) + ">"


def drawn(
    branch: Branch | OrbitBranch, *names: str, births: Sequence[OrbitPoint | None] = ()
) -> Iterator[tuple[int, tuple[np.ndarray, ...]]]:
    """The pieces of a branch, those of orbits through to the Hopf points and doublings at the beginning and end."""
    pieces = list(branch.pieces(*names))
    if isinstance(branch, OrbitBranch) and pieces:
        for point in branch.points("hopf"):
            k = 0 if point.arclength <= branch.arclength[0] else -1
            pieces[k] = _extended(pieces[k], k, [_at_hopf(point, name) for name in names])
        for k, birth in zip((0, -1), births, strict=False):
            if birth is not None:
                one = replace(branch, orbits=(doubled(birth.orbit),), recorded={})
                pieces[k] = _extended(pieces[k], k, [float(one.column(name)[0]) for name in names])
    yield from pieces


def birth_of(branch: OrbitBranch, points: Sequence[OrbitPoint], end: int) -> OrbitPoint | None:
    """The period doubling, of those given, in which a branch of doubled orbits begins (end 0) or ends (end -1)."""
    if not len(branch) or branch.ended[end] is not Ended.REVISITED:
        return None
    orbit, along = branch.orbits[end], branch.along[0]
    other = branch.orbits[(1 if len(branch) > 1 else 0) if end == 0 else -min(2, len(branch))]
    step = abs(orbit.parameters[along] - other.parameters[along])
    size = np.ptp(orbit.profile, axis=0).max()
    best = None
    for point in points:
        distance = float(np.max(np.abs(_means(point.orbit) - _means(orbit)))) / size
        near = abs(point.parameter - orbit.parameters[along]) <= 5.0 * step + 1e-9
        if near and distance < 0.1 and abs(2.0 * point.orbit.period - orbit.period) < 0.01 * orbit.period:
            best = min(best or (distance, point), (distance, point), key=lambda pair: pair[0])
    return best[1] if best else None


def _means(orbit: Orbit) -> np.ndarray:
    mean = orbit.grid.quadrature @ orbit.profile
    return np.concatenate([mean, np.sqrt(orbit.grid.quadrature @ (orbit.profile - mean) ** 2)])


def _extended(
    piece: tuple[int, tuple[np.ndarray, ...]], k: int, ends: Sequence[float]
) -> tuple[int, tuple[np.ndarray, ...]]:
    """A piece with one more point, before it (k = 0) or behind it (k = -1)."""
    unstable, columns = piece
    both = [([end], c) if k == 0 else (c, [end]) for end, c in zip(ends, columns, strict=True)]
    return unstable, tuple(np.concatenate(pair) for pair in both)


def _at_hopf(point: SpecialPoint, name: str) -> float:
    """A column's value for an orbit without size."""
    if name in point.states:
        return 0.0  # half peak-to-peak
    if name in point.parameters:
        return point.parameters[name]
    kind, _, state = name.rpartition(" ")
    if kind in ("max", "min", "mean") and state in point.states:
        return point[state]
    return _period(point) if name == "period" else float("nan")


def _period(point: SpecialPoint) -> float:
    omega = point.omega[0] if isinstance(point.omega, tuple) else point.omega
    return 2 * np.pi / omega if omega else float("nan")


def _coefficient(point: SpecialPoint) -> float:
    found = point.coefficient if isinstance(point, OrbitPoint) else point.lyapunov
    return float("nan") if found is None else found


def same_point(a: SpecialPoint, b: SpecialPoint, tolerance: float) -> bool:
    """Whether two labels stand for one point; tolerance: of the parameter."""
    if a.kind != b.kind or abs(a.parameter - b.parameter) > tolerance:
        return False
    if isinstance(a, OrbitPoint) and isinstance(b, OrbitPoint):
        return same_orbit(a.orbit, b.orbit)
    if isinstance(a, OrbitPoint) or isinstance(b, OrbitPoint):
        return False
    # a branch point is an end of Newton's reach: states there agree to the root of the tolerance
    return bool(np.all(np.abs(a.state - b.state) <= 1e-4 * np.maximum(1.0, np.abs(a.state))))
