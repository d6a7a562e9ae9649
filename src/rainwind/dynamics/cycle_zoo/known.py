"""What is known of a system's cycles: exact orbits, their Floquet exponents, special points, curves of these."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics.system import System
from rainwind.errors import InputError

Parameters = Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Cycle:
    """A cycle known exactly.

    at: times (...) -> states (..., n). exponents (n,): logarithms of the multipliers, the trivial 0 among them;
    multipliers as small as exp(-1e6) keep their meaning so.
    """

    branch: str
    parameters: Parameters
    period: float
    at: Callable[[Any], np.ndarray]
    exponents: NDArray[np.complex128]

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """All n multipliers, the trivial 1 among them, by falling modulus."""
        return np.exp(self.exponents[np.argsort(-self.exponents.real, kind="stable")])


@dataclass(frozen=True)
class CycleAnswer:
    """A special point of a branch of cycles, or of a curve of such points.

    kind: lpc, pd, ns, bp; on curves cpc, ch, gpd, r1, r2, r3, r4, foldflip, lpns, pdns, nsns. angle: of the pair of
    multipliers on the unit circle, in (0, pi), or both of them at nsns. soft: whether what branches off at pd or ns
    does so supercritically, within the centre manifold; None where it is not known or does not apply.
    """

    kind: str
    at: Parameters
    angle: float | tuple[float, ...] | None = None
    soft: bool | None = None


@dataclass(frozen=True, eq=False)
class KnownCurve:
    """A curve of lpc, pd or ns in two parameters through every point of that kind on the branch.

    equation: all parameters -> a number that vanishes on the curve, in closed form.
    """

    kind: str
    along: tuple[str, str]
    until: Mapping[str, tuple[float, float]]
    equation: Callable[[Parameters], float]
    answers: tuple[CycleAnswer, ...] = ()


@dataclass(frozen=True, eq=False)
class KnownCycles:
    """A system and a branch of its cycles, with all special points on the branch within `until`.

    all_cycles: all parameters -> every cycle known there, on this branch or another. branch: the name of this one.
    equilibrium: a state that rests at the system's own parameters, from which `rw.continue_equilibria` along the
    same parameter reaches the Hopf point `hopf` where the branch is born. homoclinic: where the branch ends with
    infinite period. closed: the branch comes back to its start within `until`.
    """

    system: System
    along: str
    until: tuple[float, float]
    all_cycles: Callable[[Parameters], Sequence[Cycle]]
    answers: tuple[CycleAnswer, ...] = ()
    curves: tuple[KnownCurve, ...] = ()
    branch: str = "main"
    equilibrium: tuple[float, ...] | None = None
    hopf: float | None = None
    homoclinic: float | None = None
    closed: bool = False

    def cycles(self, changes: Parameters | None = None, branch: str | None = None) -> tuple[Cycle, ...]:
        """The cycles known at the system's parameters with these changes; of one branch, or of all."""
        found = self.all_cycles({**self.system.parameters, **(changes or {})})
        return tuple(cycle for cycle in found if branch in (None, cycle.branch))

    @property
    def start(self) -> Cycle:
        """A cycle of the branch at the system's own parameters."""
        if not (found := self.cycles(branch=self.branch)):
            raise InputError(f"no cycle of branch '{self.branch}' is known at {dict(self.system.parameters)}")
        return found[0]


class Named:
    """Values by name or by number, as a right-hand side reads them."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = values

    def __getattr__(self, name: str) -> Any:
        return self._values[name]

    def __getitem__(self, key: str | int) -> Any:
        return self._values[key] if isinstance(key, str) else list(self._values.values())[key]


def disguised(known: KnownCycles, matrix: np.ndarray, bend: float = 0.0) -> KnownCycles:
    """The same cycles in coordinates y = matrix (x + bend x0^2 e), e = (0, 1, ..., 1).

    The bend adds harmonics to an orbit; kinds, places, periods, multipliers and coefficients' signs stay.
    """
    system, n = known.system, len(known.system.states)
    inverse = np.linalg.inv(matrix)

    def rhs(y: Any, p: Any) -> Any:
        bent = [sum(float(inverse[i, j]) * y[j] for j in range(n)) for i in range(n)]
        first = bent[0]
        x = [first] + [value - bend * first**2 for value in bent[1:]]
        f = system.rhs(Named(dict(zip(system.states, x, strict=True))), p)
        f = [f[0]] + [value + 2.0 * bend * first * f[0] for value in f[1:]]
        return [sum(float(matrix[i, j]) * f[j] for j in range(n)) for i in range(n)]

    def moved(x: np.ndarray) -> np.ndarray:
        bent = np.array(x, dtype=float)
        bent[..., 1:] += bend * bent[..., :1] ** 2
        return bent @ matrix.T

    def all_cycles(p: Parameters) -> list[Cycle]:
        return [replace(c, at=lambda t, at=c.at: moved(at(t))) for c in known.all_cycles(p)]

    return replace(
        known,
        system=System(rhs, tuple(f"y{i}" for i in range(n)), system.parameters),
        all_cycles=all_cycles,
        equilibrium=None
        if known.equilibrium is None
        else tuple(map(float, moved(np.array(known.equilibrium)))),
    )


def folded(angle: float) -> float:
    """The angle of the pair exp(+-i angle), in [0, pi]."""
    return float(np.arccos(np.cos(angle)))


def whole_roots(*coefficients: float, tolerance: float = 1e-6) -> list[float]:
    """The real roots of a polynomial, highest power first; a double root is kept though rounding parts it."""
    found = np.roots(coefficients)
    scale = 1.0 + np.abs(found).max(initial=0.0)
    return sorted(float(root.real) for root in found if abs(root.imag) < tolerance * scale)
