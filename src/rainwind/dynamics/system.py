"""What a model must offer, and what its tape gives: f, J, J_p, B(u, v), C(u, v, w)."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from rainwind.dynamics.kernels.jets import directional
from rainwind.dynamics.kernels.tangents import jacobians
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.tape import Tape, trace
from rainwind.errors import InputError
from rainwind.parameters import unknown_name


@runtime_checkable
class Model(Protocol):
    """The shape of a model: anything with these is a dynamical system.

    It may also offer `structure` (hashable: models of equal structure share a tape), `all_states(parameters)`
    (every equilibrium, certified), `refusal(state, parameters)` (why a state may not be used, or None), `refuses`
    (whether `refusal` ever says anything), `limits` (name -> value(x, p), margin(x, p): what is watched along a
    trajectory; the margin is positive where the model holds), `losses` (name -> function(x, p), positive as long as
    what the model is about is still there: behaviour in the long run on which it stays negative goes by that name),
    `units` (of states and "time") and, for `energy_balance`, `energy(x, p)` and `powers(x, p)` (a mapping from names
    to what changes the energy).
    """

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states, in order."""
        ...

    @property
    def parameters(self) -> Mapping[str, float]:
        """Names and values of the parameters."""
        ...

    def rhs(self, x: Any, p: Any) -> Sequence[Any]:
        """The derivatives of the states, in order."""
        ...


@dataclass(frozen=True, eq=False)
class System:
    """A smooth ODE x' = f(x, p), given as a plain Python function.

    rhs(x, p) returns one derivative for each state; x and p go by name (`x.y`, `p["wind.speed"]`) or by number.
    allowed(changes) raises InputError for parameters that make no sense, such as a negative mass.
    Raises TraceError when the right-hand side cannot be recorded, InputError for bad names or values.
    """

    rhs: Callable[..., Any]
    states: tuple[str, ...]
    parameters: Mapping[str, float] = field(default_factory=dict)
    all_states: Callable[[Mapping[str, float]], Any] | None = field(default=None, kw_only=True)
    refusal: Callable[[np.ndarray, Mapping[str, float]], str | None] | None = field(
        default=None, kw_only=True
    )
    allowed: Callable[[Mapping[str, float]], Any] = field(default=lambda changes: None, kw_only=True)
    limits: Mapping[str, tuple[Callable[..., Any], Callable[..., Any]]] = field(
        default_factory=dict, kw_only=True
    )
    losses: Mapping[str, Callable[..., Any]] = field(default_factory=dict, kw_only=True)
    units: Mapping[str, str] = field(default_factory=dict, kw_only=True)
    tape: Tape = field(default=None, kw_only=True, repr=False)  # type: ignore[assignment]  # traced below

    def __post_init__(self) -> None:
        states = (self.states,) if isinstance(self.states, str) else tuple(self.states)
        names = states + tuple(self.parameters)
        if not states:
            raise InputError("a system needs at least one state, for example states=('x',)")
        if len(set(names)) < len(names):
            twice = sorted({name for name in names if names.count(name) > 1})
            raise InputError(f"the name(s) {', '.join(twice)} stand for more than one state or parameter")
        checked = {name: number(value, f"parameter '{name}'") for name, value in self.parameters.items()}
        object.__setattr__(self, "states", states)
        object.__setattr__(self, "parameters", checked)
        if self.tape is None:
            object.__setattr__(self, "tape", trace(self.rhs, states, tuple(checked)))

    def with_parameters(self, changes: Mapping[str, float]) -> "System":
        """A copy with the named parameters replaced. Raises InputError for unknown names."""
        if not isinstance(changes, Mapping):
            raise InputError(f"changes go by name, for example {{'a': 1.0}}; got {changes!r}")
        for name in changes:
            if name not in self.parameters:
                raise unknown_name(name, self.parameters, "parameter")
        return replace(self, parameters={**self.parameters, **changes})

    def state(self, given: Mapping[str, float] | Sequence[float] | np.ndarray) -> np.ndarray:
        """A state (n,) from a mapping by name or from numbers in order; states left out are zero."""
        if isinstance(given, Mapping):
            for name in given:
                if name not in self.states:
                    raise unknown_name(name, self.states, "state")
            return np.array([number(given.get(name, 0.0), f"state '{name}'") for name in self.states])
        try:
            x = np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            x = np.array(np.nan)
        if x.shape != (len(self.states),) or not np.all(np.isfinite(x)):
            raise InputError(
                f"a state is {len(self.states)} finite numbers ({', '.join(self.states)}); got {given!r}"
            )
        return x.copy()

    def inputs(self, x: Any, parameters: Mapping[str, float] | None = None) -> np.ndarray:
        """States and parameters as the kernels take them: x (..., n) -> (..., n + number of parameters).

        A parameter given here may be an array, of a shape that goes with the leading shape of x.
        """
        x = np.asarray(x, dtype=float)
        n = len(self.states)
        if x.shape[-1:] != (n,):
            raise InputError(f"x must have shape (..., {n}); got {x.shape}")
        found = np.empty((*x.shape[:-1], n + len(self.parameters)))
        found[..., :n] = x
        found[..., n:] = list(self.parameters.values())
        for name, value in (parameters or {}).items():
            found[..., self.number(name)] = value
        return found

    def number(self, parameter: str) -> int:
        """The number of a parameter among the inputs. Raises InputError for an unknown name."""
        if parameter not in self.parameters:
            raise unknown_name(parameter, self.parameters, "parameter")
        return len(self.states) + list(self.parameters).index(parameter)

    def f(self, x: Any, parameters: Mapping[str, Any] | None = None) -> np.ndarray:
        """The right-hand side: x (..., n) -> (..., n)."""
        inputs = self.inputs(x, parameters)
        found = values(*self.tape.arrays, inputs.reshape(-1, inputs.shape[-1]))
        return found.reshape(*inputs.shape[:-1], len(self.states))

    def jacobian(self, x: Any, parameters: Mapping[str, Any] | None = None) -> np.ndarray:
        """df_i/dx_j: x (..., n) -> (..., n, n)."""
        return self._derivatives(x, parameters, np.arange(len(self.states)))

    def jacobian_parameters(
        self, x: Any, names: Sequence[str], parameters: Mapping[str, float] | None = None
    ) -> np.ndarray:
        """df_i/dp_j for the parameters named: x (..., n) -> (..., n, len(names))."""
        return self._derivatives(x, parameters, np.array([self.number(name) for name in names]))

    def _derivatives(self, x: Any, parameters: Any, directions: np.ndarray) -> np.ndarray:
        inputs = self.inputs(x, parameters)
        _, d = jacobians(*self.tape.arrays, inputs.reshape(-1, inputs.shape[-1]), directions)
        return d.reshape(*inputs.shape[:-1], len(self.states), directions.size)

    def second(self, x: Any, u: Any, v: Any, parameters: Mapping[str, float] | None = None) -> np.ndarray:
        """B(u, v) = D^2 f[u, v] at x (n,); u and v may be complex."""
        return _polarised(lambda w: self._directional(x, w, 2, parameters), (u, v))

    def third(
        self, x: Any, u: Any, v: Any, w: Any, parameters: Mapping[str, float] | None = None
    ) -> np.ndarray:
        """C(u, v, w) = D^3 f[u, v, w] at x (n,); the vectors may be complex."""
        return _polarised(lambda s: self._directional(x, s, 3, parameters), (u, v, w))

    def _directional(self, x: Any, vectors: np.ndarray, order: int, parameters: Any) -> np.ndarray:
        inputs = self.inputs(x, parameters)
        padded = np.zeros((len(vectors), inputs.size))
        padded[:, : len(self.states)] = vectors
        return directional(*self.tape.arrays, inputs, padded, order)


def as_system(model: Any) -> System:
    """Any model as a System; models of equal structure share one tape."""
    if isinstance(model, System):
        return model
    if not isinstance(model, Model):
        raise InputError(f"{type(model).__name__} is no model: it needs states, parameters and rhs(x, p)")
    structure = getattr(model, "structure", None)
    tape = _tapes.get((type(model), structure)) if structure is not None else None
    system = System(
        model.rhs,
        model.states,
        model.parameters,
        all_states=getattr(model, "all_states", None),
        refusal=getattr(model, "refusal", None) if getattr(model, "refuses", True) else None,
        allowed=getattr(model, "with_parameters", lambda changes: None),
        limits=getattr(model, "limits", {}),
        losses=getattr(model, "losses", {}),
        units=getattr(model, "units", {}),
        tape=tape,  # type: ignore[arg-type]
    )
    if structure is not None:
        _tapes[type(model), structure] = system.tape
    return system


_tapes: dict[tuple[type, Any], Tape] = {}


def _polarised(power: Callable[[np.ndarray], np.ndarray], vectors: tuple[Any, ...]) -> np.ndarray:
    """A symmetric multilinear form from its values on the diagonal, for real or complex vectors.

    M(v_1 ... v_k) = sum over signs s of (prod s) power(sum s_i v_i) / (2^k k!); complex vectors by linearity.
    """
    vectors = tuple(np.asarray(v) for v in vectors)
    for i, v in enumerate(vectors):
        if np.iscomplexobj(v):
            real = _polarised(power, (*vectors[:i], v.real, *vectors[i + 1 :]))
            return real + 1j * _polarised(power, (*vectors[:i], v.imag, *vectors[i + 1 :]))
    # equal lengths keep the cancellation at the level of rounding
    lengths = [float(np.linalg.norm(v)) for v in vectors]
    k = len(vectors)
    if min(lengths) == 0.0:
        return np.zeros_like(power(np.zeros((1, vectors[0].size)))[0])
    units = np.array([v / length for v, length in zip(vectors, lengths, strict=True)])
    signs = np.array(np.meshgrid(*[[1.0, -1.0]] * (k - 1), indexing="ij")).reshape(k - 1, -1).T
    signs = np.hstack([np.ones((len(signs), 1)), signs])  # the other half follows from (-1)^k
    total = np.prod(signs, axis=1) @ power(signs @ units)
    return total * np.prod(lengths) * 2.0 / (2.0**k * math.factorial(k))


def number(value: Any, what: str) -> float:
    """A finite number as a float. Raises InputError that names what it is."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not math.isfinite(value):
        raise InputError(f"{what} must be a finite number; got {value!r}")
    return float(value)
