"""Results: frozen data that can be asked and can audit themselves. They hold no solver."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, ClassVar, overload

import numpy as np
from numpy.typing import NDArray

from rainwind.errors import InputError
from rainwind.parameters import unknown_name


class Ended(Enum):
    """Why a walk ended."""

    AT_BOUND = "a parameter reached its bound"
    CLOSED = "the curve came back to its start"
    AT_BT = "the Hopf curve ended at a Bogdanov-Takens point; beyond it lie neutral saddles"
    STEP_TOO_SMALL = "Newton failed even at the smallest step"
    TOO_MANY_POINTS = "the limit on the number of points was reached"
    REFUSED = "the model refused the next state"
    NOT_FINITE = "a state or parameter became too large"
    INTERRUPTED = "interrupted by the user"
    AT_HOPF = "the orbits shrank to a Hopf point"
    AT_CONDITION = "the condition that was asked for was met"
    HOMOCLINIC = "the period grew beyond its limit: a homoclinic or heteroclinic orbit is suspected"
    MESH_AT_LIMIT = "the orbit needs more mesh intervals than allowed"
    AT_RESONANCE = "the curve ended at a strong resonance; beyond it the multipliers are real"
    FAMILY = (
        "the parameter does not move along the branch: a whole family of orbits at one value, none isolated"
    )
    REVISITED = "the walk came back to where it had been"


@dataclass(frozen=True)
class Certificate:
    """How well a label holds: what should be zero, and what should not.

    residual: largest |F| of the defining equations; checks: name -> value of independent quantities that vanish
    at such a point, each beside its tolerance; margins: quantities that must differ from zero (non-degeneracy).
    """

    residual: float
    checks: Mapping[str, tuple[float, float]]
    margins: Mapping[str, float] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        """Whether every check is within its tolerance."""
        return all(abs(value) <= tolerance for value, tolerance in self.checks.values())

    def __str__(self) -> str:
        checks = ", ".join(f"{name} {value:.1e} (<= {tol:.0e})" for name, (value, tol) in self.checks.items())
        margins = ", ".join(f"{name} {value:.3g}" for name, value in self.margins.items())
        return f"residual {self.residual:.1e}; {checks}" + (f"; {margins}" if margins else "")


@dataclass(frozen=True, eq=False, repr=False)
class SpecialPoint:
    """A labelled point of a branch or curve.

    kind: fold, hopf, bp; on curves cusp, bt, gh, zh, hh. state (n,); parameters: all of them, by name; along:
    the names of the free ones. omega: angular frequency of the critical pair, or two of them (rad per unit time);
    lyapunov: first Lyapunov coefficient in Kuznetsov's normalisation (MatCont prints omega times it). crossing
    (n + 1,): direction (state, parameter) of the other branch at a branch point.
    """

    kind: str
    states: tuple[str, ...]
    state: np.ndarray
    parameters: Mapping[str, float]
    along: tuple[str, ...]
    eigenvalues: NDArray[np.complex128]
    arclength: float
    certificate: Certificate
    omega: float | tuple[float, ...] | None = None
    lyapunov: float | None = None
    crossing: np.ndarray | None = None
    note: str = ""

    @property
    def parameter(self) -> float:
        """The value of the first free parameter."""
        return self.parameters[self.along[0]]

    def __getitem__(self, name: str) -> float:
        return _by_name(name, self.states, self.state, self.parameters)

    def __repr__(self) -> str:
        return f"<{self}>"

    def __str__(self) -> str:
        where = ", ".join(f"{name} = {self.parameters[name]:.8g}" for name in self.along)
        omega = "" if self.omega is None else f", omega = {np.round(self.omega, 6)}"
        lyapunov = "" if self.lyapunov is None else f", l1 = {self.lyapunov:.4g}"
        return f"{self.kind} at {where}{omega}{lyapunov}" + (f" ({self.note})" if self.note else "")


@dataclass(frozen=True, eq=False, repr=False)
class Equilibrium:
    """One equilibrium: state (n,), all parameters, eigenvalues (n,) by descending real part."""

    states: tuple[str, ...]
    state: np.ndarray
    parameters: Mapping[str, float]
    eigenvalues: NDArray[np.complex128]
    residual: float

    @property
    def stable(self) -> bool:
        """Whether all eigenvalues lie left of the imaginary axis."""
        return bool(np.all(self.eigenvalues.real < 0))

    def __repr__(self) -> str:
        state = ", ".join(
            f"{name} = {value:.6g}" for name, value in zip(self.states, self.state, strict=True)
        )
        return f"<{self.kind} at {state}>"

    @property
    def kind(self) -> str:
        """In words: stable focus or node, unstable focus or node, saddle, saddle-focus."""
        return kind_of_equilibrium(self.eigenvalues)

    def __getitem__(self, name: str) -> float:
        return _by_name(name, self.states, self.state, self.parameters)


@dataclass(frozen=True, eq=False)
class Equilibria(Sequence[Equilibrium]):
    """Equilibria found together; complete: whether these are certainly all of them, and if not, `note` says why."""

    found: tuple[Equilibrium, ...]
    complete: bool
    note: str = ""

    @overload
    def __getitem__(self, i: int) -> Equilibrium: ...

    @overload
    def __getitem__(self, i: slice) -> tuple[Equilibrium, ...]: ...

    def __getitem__(self, i: int | slice) -> Equilibrium | tuple[Equilibrium, ...]:
        return self.found[i]

    def __len__(self) -> int:
        return len(self.found)


@dataclass(frozen=True)
class Unexplained:
    """A change that no label explains, between two points: of the number of unstable eigenvalues, or (change = 0)
    of the sign of a test value."""

    between: tuple[float, float]  # arclengths
    parameters: tuple[Mapping[str, float], Mapping[str, float]]
    change: int

    def __str__(self) -> str:
        what = (
            f"the number of unstable eigenvalues (multipliers of orbits) changes by {self.change:+d}"
            if self.change
            else "a test value changes sign or touches zero"
        )
        a, b = self.parameters
        # ten digits: a walk that looks once more can begin there
        places = [f"{name} = {a[name]:.10g} and {b[name]:.10g}" for name in a if a[name] != b[name]]
        first, last = self.between
        where = ", ".join([*places, f"arclength {first:.10g} and {last:.10g}"])
        return f"between {where}: {what} and no label explains it"


class Labelled:
    """What branches and curves of equilibria and of orbits have in common: labels along an arclength, ends, gaps."""

    along: tuple[str, ...]
    arclength: np.ndarray
    special: tuple[Any, ...]
    ended: tuple[Ended, Ended]
    unexplained: tuple[Unexplained, ...]
    unstable: Any  # (N,), how many eigenvalues or multipliers are
    kinds: ClassVar[tuple[str, ...]]  # of special points
    bad_ends: ClassVar[tuple[Ended, ...]]  # that a reader should know of

    def __getitem__(self, key: Any) -> Any:
        raise NotImplementedError

    def points(self, kind: str | None = None) -> tuple[Any, ...]:
        """The special points of one kind, or all, in order along the branch."""
        if kind is not None and kind not in self.kinds:
            raise unknown_name(kind, self.kinds, "kind of special point")
        return tuple(point for point in self.special if kind in (None, point.kind))

    @property
    def parameter(self) -> np.ndarray:
        """The first free parameter along the branch (N,)."""
        return self[self.along[0]]

    @property
    def stable(self) -> np.ndarray:
        """Whether each point is stable (N,)."""
        return self.unstable == 0

    def at(self, name: str, value: float) -> np.ndarray:
        """Arclengths at which a column passes `value`, by linear interpolation between points."""
        column = self[name] - value
        hits = np.flatnonzero(np.sign(column[:-1]) * np.sign(column[1:]) < 0)
        t = column[hits] / (column[hits] - column[hits + 1])
        return self.arclength[hits] + t * np.diff(self.arclength)[hits]

    def audit(self) -> list[str]:
        """Everything about this branch that a careful reader should know before trusting it."""
        faults = [
            f"{p}: certificate does not hold: {p.certificate}"
            for p in self.special
            if not p.certificate.holds
        ]
        faults += [str(gap) for gap in self.unexplained]
        return faults + [
            end_in_words(
                end, self.along, [self[name][k] for name in self.along] if self.arclength.size else []
            )
            for end, k in zip(self.ended, (0, -1), strict=True)
            if end in self.bad_ends
        ]


@dataclass(frozen=True, eq=False, repr=False)
class Branch(Labelled):
    """Equilibria in one parameter, or points of a curve in two, ordered along the arclength.

    along: names of the free parameters (1 or 2); state (N, n); free (N, len(along)); tangent (N, n + len(along)):
    derivatives of both by arclength; eigenvalues (N, n);
    unstable (N,): number of eigenvalues right of the imaginary axis, the critical ones of a curve not counted;
    special: labelled points; ended: why each end is where it is; unexplained: what no label explains.
    `branch["phi"]`, `branch["wind.speed"]` give columns.
    """

    kind: str  # equilibria, fold, hopf
    states: tuple[str, ...]
    along: tuple[str, ...]
    parameters: Mapping[str, float]  # those that are not free keep these values
    state: np.ndarray
    free: np.ndarray
    tangent: np.ndarray
    eigenvalues: NDArray[np.complex128]
    unstable: np.ndarray
    arclength: np.ndarray
    residual: np.ndarray
    special: tuple[SpecialPoint, ...]
    ended: tuple[Ended, Ended]
    unexplained: tuple[Unexplained, ...] = ()
    note: str = ""
    recorded: Mapping[str, np.ndarray] = field(default_factory=dict)

    kinds = ("fold", "hopf", "bp", "cusp", "bt", "gh", "zh", "hh", "event")
    bad_ends = (Ended.STEP_TOO_SMALL, Ended.NOT_FINITE, Ended.TOO_MANY_POINTS)

    def __repr__(self) -> str:
        ranges = ", ".join(
            f"{name} = {self[name].min():.6g} ... {self[name].max():.6g}" for name in self.along
        )
        labels = "; ".join(map(str, self.special)) or "none"
        return f"<{self.kind} in {ranges}: {len(self)} points; special points: {labels}>"

    def __len__(self) -> int:
        return len(self.arclength)

    def __getitem__(self, name: str) -> np.ndarray:
        if name in self.along:
            return self.free[:, self.along.index(name)]
        if name in self.states:
            return self.state[:, self.states.index(name)]
        if name in self.recorded:
            return self.recorded[name]
        if name in self.parameters:
            return np.full(len(self), self.parameters[name])
        known = (*self.along, *self.states, *self.recorded, *self.parameters)
        raise unknown_name(name, tuple(dict.fromkeys(known)), "column")

    def pieces(self, *names: str) -> Iterator[tuple[int, tuple[np.ndarray, ...]]]:
        """Pieces of constant stability for drawing: (number unstable, columns), cut exactly at the labels."""
        cuts = [p for p in self.special if p.kind in ("fold", "hopf", "bp", "zh", "hh", "bt")]
        at_cuts = [[p[name] for name in names] for p in cuts]
        columns = [self[name] for name in names]
        yield from pieces_between(
            self.arclength, self.unstable, [p.arclength for p in cuts], at_cuts, columns
        )

    def extremum(self, name: str, *, largest: bool = True) -> float:
        """The largest (or smallest) value of a column, on the cubics through the points and their tangents."""
        sign = 1.0 if largest else -1.0
        value = sign * self[name]
        columns = (*self.states, *self.along)
        if name not in columns or len(self) < 2:
            return float(sign * np.max(value))
        slope = sign * self.tangent[:, columns.index(name)]
        top = int(np.argmax(value))
        best = float(value[top])
        for i in range(max(top - 1, 0), min(top + 1, len(self) - 1)):
            h = self.arclength[i + 1] - self.arclength[i]
            rise, m0, m1 = value[i + 1] - value[i], slope[i] * h, slope[i + 1] * h
            cubic = np.array([m0 + m1 - 2 * rise, 3 * rise - 2 * m0 - m1, m0, value[i]])
            turns = np.roots(np.polyder(cubic))
            inside = turns.real[(turns.imag == 0) & (turns.real > 0) & (turns.real < 1)]
            best = max([best, *np.polyval(cubic, inside).tolist()])
        return sign * best


def end_in_words(end: Ended, along: Sequence[str], at: Sequence[float]) -> str:
    """Why a branch ends, and where: the values of its free parameters, none for a branch without points."""
    where = ", ".join(f"{name} = {value:.10g}" for name, value in zip(along, at, strict=False))
    return f"{end.value}, at {where}" if where else end.value


def pieces_between(
    arclength: np.ndarray,
    unstable: np.ndarray,
    cuts: Sequence[float],
    at_cuts: Sequence[Sequence[float]],
    columns: Sequence[np.ndarray],
) -> Iterator[tuple[int, tuple[np.ndarray, ...]]]:
    """Columns cut at some arclengths, where their values are given: (number unstable, columns) a piece."""
    bounds = [-np.inf, *cuts, np.inf]
    for i in range(len(bounds) - 1):
        inside = (arclength > bounds[i]) & (arclength < bounds[i + 1])
        if not np.any(inside):
            continue
        found = []
        for k, column in enumerate(columns):
            before = [at_cuts[i - 1][k]] if i > 0 else []
            after = [at_cuts[i][k]] if i < len(cuts) else []
            found.append(np.concatenate([before, column[inside], after]))
        # the count in the middle: points beside a label may sit on the axis to rounding
        yield int(np.median(unstable[inside])), tuple(found)


def kind_of_equilibrium(eigenvalues: NDArray[np.complex128]) -> str:
    """An equilibrium's type in words, from its eigenvalues (n,)."""
    unstable = eigenvalues[eigenvalues.real > 0]
    leading = eigenvalues[np.argmax(eigenvalues.real)]
    if unstable.size == 0:
        return "stable focus" if leading.imag else "stable node"
    if np.all(unstable.imag != 0):
        return "unstable focus"
    if np.any(unstable.imag != 0):
        return "saddle-focus"
    return "unstable node" if unstable.size == eigenvalues.size else "saddle"


def _by_name(name: str, states: tuple[str, ...], state: np.ndarray, parameters: Mapping[str, Any]) -> float:
    if name in states:
        return float(state[states.index(name)])
    if name in parameters:
        return float(parameters[name])
    raise InputError(f"there is no state or parameter '{name}'. Known: {', '.join((*states, *parameters))}")
