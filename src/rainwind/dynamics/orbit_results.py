"""Results about periodic orbits: one orbit, a labelled one, and branches and curves of them."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics.collocation import Grid
from rainwind.dynamics.orbit_trust import trivial_error
from rainwind.dynamics.results import Ended, Labelled, SpecialPoint, Unexplained, pieces_between
from rainwind.errors import InputError
from rainwind.parameters import unknown_name


@dataclass(frozen=True, eq=False, repr=False)
class Orbit:
    """A periodic orbit, as a piecewise polynomial of the phase (time / period) on [0, 1].

    profile (N m + 1, n): the states at all nodes of the grid; exponents (n - 1,): log mu of the nontrivial
    multipliers, largest first (real part log|mu|, imaginary part in (-pi, pi]); trivial: log of the multiplier that
    should be 1, as computed; liouville: sum of the nontrivial log|mu| less the integral of trace J, which should be 0;
    residual: largest |F| of the collocation equations, before Newton's last step; doubt: why the multipliers may be
    wrong, if they may.
    """

    states: tuple[str, ...]
    parameters: Mapping[str, float]
    period: float
    grid: Grid
    profile: np.ndarray
    exponents: NDArray[np.complex128]
    trivial: complex
    liouville: float
    residual: float
    doubt: str = ""

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """All n Floquet multipliers, the trivial one (as computed) first, then by falling modulus."""
        with np.errstate(over="ignore"):
            return np.exp(np.concatenate([[self.trivial], self.exponents]))

    @cached_property
    def mesh_error(self) -> float:
        """The estimated largest error of any state, in units of max(1, |state|)."""
        return error_of(self.grid, self.profile)

    @property
    def trivial_error(self) -> float:
        """How far the trivial multiplier is from 1, with a meaning at folds and branch points too."""
        return trivial_error(self.trivial, self.exponents)

    @property
    def unstable(self) -> int:
        """How many multipliers lie outside the unit circle, the trivial one not counted."""
        return int(np.sum(self.exponents.real > 0))

    @property
    def stable(self) -> bool:
        """Whether all multipliers but the trivial one lie inside the unit circle."""
        return self.unstable == 0

    @property
    def times(self) -> np.ndarray:
        """The times (N m + 1,) of the nodes, from 0 to the period."""
        return self.period * self.grid.nodes

    def at(self, t: Any) -> np.ndarray:
        """The states at times t, any shape and any number of periods: (..., n)."""
        t = np.asarray(t, dtype=float)
        phase = np.mod(t / self.period, 1.0)
        return self.grid.at(self.profile, phase.ravel()).reshape(*t.shape, len(self.states))

    def __getitem__(self, name: str) -> np.ndarray:
        """A state at the nodes (N m + 1,)."""
        if name not in self.states:
            raise unknown_name(name, self.states, "state")
        return self.profile[:, self.states.index(name)]

    @cached_property
    def extremes(self) -> np.ndarray:
        """The smallest and largest value of every state over the period (2, n), on the polynomials themselves."""
        return np.array([sign * self._largest(sign) for sign in (-1.0, 1.0)])

    def _largest(self, sign: float) -> np.ndarray:
        m, nodes = self.grid.degree, self.grid.basis.nodes
        pieces = sign * self.grid.pieces(self.profile)
        best = pieces.max(axis=(0, 1))
        # only pieces that come near the largest node can hold the maximum
        for k in range(len(self.states)):
            top = np.unique(np.argsort(pieces[:, :, k].max(axis=1))[-3:])
            for piece in pieces[top, :, k]:
                slope = np.polyder(np.polyfit(2.0 * nodes - 1.0, piece, m))
                turns = np.roots(slope)
                inside = turns.real[(np.abs(turns.imag) < 1e-9) & (np.abs(turns.real) <= 1.0)]
                if inside.size:
                    best[k] = max(best[k], float((self.grid.basis.at((inside + 1.0) / 2.0) @ piece).max()))
        return best

    @property
    def amplitude(self) -> dict[str, float]:
        """Half of the peak-to-peak value of every state."""
        low, high = self.extremes
        return dict(zip(self.states, (0.5 * (high - low)).tolist(), strict=True))

    @property
    def mean(self) -> dict[str, float]:
        """The mean of every state over the period."""
        return dict(zip(self.states, (self.grid.quadrature @ self.profile).tolist(), strict=True))

    def __repr__(self) -> str:
        stable = "stable" if self.stable else f"unstable ({self.unstable} multipliers outside)"
        return f"<{stable} orbit of period {self.period:.8g}>"


def error_of(grid: Grid, profile: np.ndarray) -> float:
    """The estimated largest error of a profile, in units of max(1, |state|)."""
    return grid.error(profile, np.maximum(1.0, np.abs(profile).max(axis=0)))


@dataclass(frozen=True, eq=False, repr=False)
class OrbitPoint(SpecialPoint):
    """A labelled periodic orbit. kind: lpc, pd, ns, bp; on curves cpc, ch, gpd, r1, r2, r3, r4, foldflip, lpns, ...

    state: the orbit's at phase 0; eigenvalues: log mu as `Orbit.exponents`; angle: argument of the critical pair of
    multipliers at ns (rad); coefficient: normal-form coefficient, whose sign says super- (negative) or subcritical;
    direction: the critical disturbance, which leads onto the other branch at pd and bp, as one vector: profile at all
    nodes, period, parameter.
    """

    orbit: Orbit = None  # type: ignore[assignment]  # always given
    angle: float | None = None
    coefficient: float | None = None
    direction: np.ndarray | None = None

    def __str__(self) -> str:
        where = ", ".join(f"{name} = {self.parameters[name]:.8g}" for name in self.along)
        angle = "" if self.angle is None else f", angle = {np.degrees(self.angle):.4g} deg"
        found = "" if self.coefficient is None else f", coefficient = {self.coefficient:.4g}"
        note = f" ({self.note})" if self.note else ""
        return f"{self.kind} at {where}, period = {self.orbit.period:.8g}{angle}{found}{note}"


@dataclass(frozen=True, eq=False, repr=False)
class OrbitBranch(Labelled):
    """Periodic orbits in one parameter, or a curve of lpc, pd or ns in two, ordered along the arclength.

    orbits: one a point; tangent_parameter (N, len(along)): derivative of the free parameters by arclength; special:
    labelled orbits; ended: why each end is where it is; unexplained: what no label explains. `branch["wind.speed"]`,
    `branch["period"]`, `branch["y"]` (half peak-to-peak), `branch["max y"]`, `branch["mean y"]` give columns.
    """

    kind: str  # orbits, lpc, pd, ns
    states: tuple[str, ...]
    along: tuple[str, ...]
    parameters: Mapping[str, float]
    orbits: tuple[Orbit, ...]
    arclength: np.ndarray
    tangent_parameter: np.ndarray
    special: tuple[SpecialPoint, ...]
    ended: tuple[Ended, Ended]
    unexplained: tuple[Unexplained, ...] = ()
    recorded: Mapping[str, np.ndarray] = field(default_factory=dict)
    note: str = ""

    kinds = (
        "lpc", "pd", "ns", "bp", "hopf",
        "cpc", "ch", "gpd", "gh", "zh", "event", "r1", "r2", "r3", "r4", "foldflip", "lpns", "pdns", "nsns",
    )  # fmt: skip
    bad_ends = (Ended.STEP_TOO_SMALL, Ended.NOT_FINITE, Ended.TOO_MANY_POINTS, Ended.MESH_AT_LIMIT)

    def __len__(self) -> int:
        return len(self.orbits)

    def __iter__(self) -> Iterator[Orbit]:
        return iter(self.orbits)

    def __getitem__(self, key: Any) -> Any:
        """An orbit by number, or a column (N,) by name."""
        if isinstance(key, int | np.integer | slice):
            return self.orbits[key]
        return self.column(key)

    def column(self, name: str) -> np.ndarray:
        """One value an orbit (N,): a parameter, `period`, a state's amplitude, `max`, `min` or `mean` of a state."""
        if name in self.recorded:
            return self.recorded[name]
        if name in self.parameters:
            return np.array([orbit.parameters[name] for orbit in self.orbits])
        if name in _NUMBERS:
            return np.array([getattr(orbit, name) for orbit in self.orbits])
        kind, _, state = name.rpartition(" ")
        of: dict[str, Callable[[Orbit, int], float]] = {
            "": lambda orbit, k: 0.5 * (orbit.extremes[1, k] - orbit.extremes[0, k]),
            "max": lambda orbit, k: orbit.extremes[1, k],
            "min": lambda orbit, k: orbit.extremes[0, k],
            "mean": lambda orbit, k: float(orbit.grid.quadrature @ orbit.profile[:, k]),
        }
        if kind not in of or state not in self.states:
            of_states = (f"{kind} {s}".strip() for kind in of for s in self.states)
            known = (*self.along, *_NUMBERS, *of_states, *self.recorded, *self.parameters)
            raise unknown_name(name, tuple(dict.fromkeys(known)), "column")
        k = self.states.index(state)
        return np.array([of[kind](orbit, k) for orbit in self.orbits])

    @property
    def exponents(self) -> NDArray[np.complex128]:
        """log mu of the nontrivial multipliers (N, n - 1)."""
        return np.array([orbit.exponents for orbit in self.orbits])

    @property
    def unstable(self) -> np.ndarray:
        """Number of multipliers outside the unit circle (N,), those that a curve holds on it not counted."""
        return np.array([_unstable(self.kind, orbit.exponents) for orbit in self.orbits])

    def pieces(self, *names: str) -> Iterator[tuple[int, tuple[np.ndarray, ...]]]:
        """Pieces of constant stability for drawing: (number unstable, columns), cut exactly at the labels."""
        cuts = [p for p in self.special if isinstance(p, OrbitPoint)]
        at_cuts = [[_value(p, name) for name in names] for p in cuts]
        columns = [self.column(name) for name in names]
        yield from pieces_between(
            self.arclength, self.unstable, [p.arclength for p in cuts], at_cuts, columns
        )

    def audit(self) -> list[str]:
        """Everything about this branch that a careful reader should know before trusting it."""
        doubts = dict.fromkeys(orbit.doubt for orbit in self.orbits if orbit.doubt)
        return [*super().audit(), *(_doubtful(self, reason) for reason in doubts)]

    def __repr__(self) -> str:
        ranges = ", ".join(
            f"{name} = {column.min():.6g} ... {column.max():.6g}"
            for name, column in ((name, self.column(name)) for name in self.along)
            if column.size
        ) or ", ".join(self.along)
        labels = "; ".join(map(str, self.special)) or "none"
        return f"<{self.kind} in {ranges}: {len(self)} orbits; special points: {labels}>"


def _doubtful(branch: OrbitBranch, reason: str) -> str:
    """How many orbits of a branch are in doubt for one reason, and where."""
    orbits = [orbit for orbit in branch.orbits if orbit.doubt == reason]
    values = [orbit.parameters[branch.along[0]] for orbit in orbits]
    many = f"{len(orbits)} orbits" if len(orbits) > 1 else "1 orbit"
    return f"{many} at {branch.along[0]} = {min(values):.10g} to {max(values):.10g}: {reason}"


def _unstable(kind: str, exponents: NDArray[np.complex128]) -> int:
    """How many exponents lie right of the axis, without those that a curve of this kind holds on it."""
    real = exponents.real
    if kind in ("lpc", "pd"):
        at_minus_one = np.abs(np.abs(exponents.imag) - np.pi) < 1e-9
        candidates = np.where(at_minus_one if kind == "pd" else exponents.imag == 0.0, np.abs(real), np.inf)
        real = np.delete(real, np.argmin(candidates))
    elif kind == "ns":
        real = np.delete(
            real, np.argsort(np.where(exponents.imag != 0.0, np.abs(real), np.inf), kind="stable")[:2]
        )
    return int(np.sum(real > 0))


def _value(point: OrbitPoint, name: str) -> float:
    """A column's value at a labelled orbit."""
    one = OrbitBranch(
        "orbits", point.states, point.along, point.parameters, (point.orbit,), np.zeros(1), np.zeros((1, 1)),
        (), (Ended.AT_BOUND, Ended.AT_BOUND),
    )  # fmt: skip
    try:
        return float(one.column(name)[0])
    except InputError:
        return float("nan")


_NUMBERS = ("period", "mesh_error", "liouville", "residual", "unstable", "trivial_error")
