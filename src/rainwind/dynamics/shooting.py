"""Multiple shooting: a periodic orbit and its multipliers again, by integration, with nothing of collocation in it.

Peil & Nahrath, eq. (8), integrate the variational equations over one period. Over a whole period the matrix loses
every multiplier below rounding of the largest; so the period is cut into segments, and the multipliers come from their
matrices without multiplying them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from rainwind.dynamics.kernels.periodic_schur import log_multipliers
from rainwind.dynamics.orbit_results import Orbit, OrbitPoint
from rainwind.dynamics.system import System, as_system, number
from rainwind.dynamics.variational import Flow, Transition
from rainwind.errors import InputError

SPREAD = float(np.log(1e3))  # of the singular values of a segment's matrix, above which it is cut
RESOLVED = float(np.log(1e9))  # above which the smallest ones are lost
SEGMENTS = 1000  # at most
ITERATIONS = 25
LAPS = 12  # round an attracting orbit from a state
HALVINGS = 5  # of a step, before Newton gives up
SMALL = float(np.log(1e-6))


@dataclass(frozen=True, eq=False, repr=False)
class Shot:
    """A periodic orbit found by multiple shooting.

    starts (K, n): the states at times (K,), the first at 0; log_multipliers (n,): log|mu| + i arg(mu) of all
    multipliers, the trivial one among them, by falling modulus; residual: largest gap between one segment's end and
    the next one's start; correction: the size of Newton's next step, which was not taken: how far the orbit may be
    away; both as shares of each state's range (the period's, of itself). liouville: sum of all log|mu| less the
    integral of trace J, which should vanish. Where not `converged`, note says why, and the numbers are those of the
    last iterate.
    """

    states: tuple[str, ...]
    parameters: Mapping[str, float]
    period: float
    times: np.ndarray
    starts: np.ndarray
    log_multipliers: NDArray[np.complex128]
    residual: float
    correction: float
    liouville: float
    iterations: int
    converged: bool
    note: str = ""

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """All Floquet multipliers (n,), by falling modulus, the trivial one among them."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.exp(self.log_multipliers)

    @property
    def trivial_error(self) -> float:
        """|mu - 1| of the multiplier nearest to 1. Near a fold of cycles, about the root of the tolerance."""
        return float(np.min(np.abs(self.multipliers - 1.0)))

    def differences(self, orbit: Orbit) -> dict[str, float]:
        """How far another computation of the same orbit is away; its phase may be another one.

        period: relative; state: the largest difference at this shot's times, as a share of the state's range;
        multipliers: the largest relative difference of those above 1e-6; small multipliers: the largest difference
        of log|mu| of those below.
        """
        if not isinstance(orbit, Orbit) or orbit.states != self.states:
            raise InputError(
                f"differences(orbit) takes an orbit with the states {', '.join(self.states)}; got {orbit!r}"
            )
        large, small = _multiplier_differences(
            self.log_multipliers, np.array([orbit.trivial, *orbit.exponents])
        )
        return {
            "period": float(abs(orbit.period - self.period) / self.period),
            "state": self._gap(orbit),
            "multipliers": large,
            "small multipliers": small,
        }

    def _gap(self, orbit: Orbit) -> float:
        """The largest difference of states once the phases are aligned."""
        low, high = orbit.extremes
        units = _units(np.array([low, high]))
        phases = self.times / self.period

        def gap(shift: Any, few: slice = slice(None)) -> np.ndarray:
            at = orbit.period * (phases[few] + np.asarray(shift)[..., None])
            return (orbit.at(at) - self.starts[few]) / units

        shifts = np.arange(400) / 400.0
        sizes = np.sum(gap(shifts, slice(None, None, 1 + len(phases) // 40)) ** 2, axis=(1, 2))
        shift, h = float(shifts[np.argmin(sizes)]), 1e-5
        for _ in range(8):
            slope = (gap(shift + h) - gap(shift - h)) / (2.0 * h)
            shift -= float(np.sum(slope * gap(shift)) / max(np.sum(slope**2), 1e-300))
        return float(np.max(np.abs(gap(shift))))

    def __repr__(self) -> str:
        found = "orbit" if self.converged else "no orbit"
        note = f": {self.note}" if self.note else ""
        return f"<{found} by shooting, period {self.period:.10g}, {len(self.times)} segments{note}>"


def shoot(
    model: Any,
    start: Orbit | OrbitPoint | Mapping[str, float] | Sequence[float] | np.ndarray,
    *,
    period: float | None = None,
    segments: int = 20,
    tolerance: float = 1e-10,
) -> Shot:
    """Find a periodic orbit and its multipliers by multiple shooting, as an independent check of collocation.

    start: an orbit, at whose parameters the model is taken, or a state near one together with a guess of the period.
    segments: at least as many; those over which disturbances grow apart by more than 1e3 are cut. tolerance: of
    Newton's last step, relative to each state's range and to the period; integration is a hundred times finer.
    A failed iteration is a result (`converged`, `note`). Raises InputError for a start of another model or bad numbers.
    """
    system = as_system(model)
    if (
        isinstance(segments, bool)
        or not isinstance(segments, int | np.integer)
        or not 1 <= segments <= SEGMENTS
    ):
        raise InputError(f"segments must be a whole number from 1 to {SEGMENTS}; got {segments!r}")
    if not 1e-12 <= number(tolerance, "tolerance") <= 1e-3:
        raise InputError(f"tolerance must lie between 1e-12 and 1e-3; got {tolerance!r}")
    phases = np.arange(segments) / segments
    if isinstance(start, OrbitPoint):
        start = start.orbit
    if isinstance(start, Orbit):
        if period is not None:
            raise InputError(
                "an orbit brings its period: leave out period=, or give a state in place of the orbit"
            )
        if start.states != system.states:
            raise InputError(
                f"the orbit's states are {', '.join(start.states)}, the model's {', '.join(system.states)}; "
                "give the model that the orbit was computed with"
            )
        system = system.with_parameters(start.parameters)
        return _newton(system, start.at(start.period * phases), phases, start.period, tolerance)
    x = system.state(start)
    if period is None or not number(period, "period") > 0.0:
        raise InputError(f"a state needs a guess of the period beside it, above zero; got period={period!r}")
    period = float(period)
    starts, period = _trajectory(system, x, phases, period)
    if starts is None:
        note = (
            "the trajectory from the start runs away within a period: start nearer, or guess a shorter period"
        )
        flow = Flow(system, np.ones(x.size), 1e-2 * tolerance)
        return _result(flow, x[None], np.zeros(1), period, [], np.inf, 0, False, note)
    return _newton(system, starts, phases, period, tolerance)


def _trajectory(
    system: System, x: np.ndarray, phases: np.ndarray, period: float
) -> tuple[np.ndarray | None, float]:
    """The states (K, n) along the trajectory from x, and the time near `period` after which it comes back nearest.

    Another lap is taken for as long as each comes back twice as near: an attracting orbit is almost found that way.
    """
    size = float(np.max(np.abs(x)))
    flow = Flow(system, np.maximum(np.abs(x), 1e-3 * size if size > 0.0 else 1.0), 1e-9)
    start, nearest = x / flow.units, np.inf
    best = start, period
    for _ in range(LAPS):
        times = period * np.linspace(0.0, 1.3, 1301)
        found = flow.states(start, times)
        if found is None:
            break
        away = np.sum(((found - start) / _units(found)) ** 2, axis=1)
        k = 800 + int(np.argmin(away[800:-1]))
        if not away[k] < 0.25 * nearest:
            break
        nearest = float(away[k])
        before, here, after = away[k - 1 : k + 2]
        vertex = 0.5 * (before - after) / max(before - 2.0 * here + after, 1e-300)
        best = start, float(times[k] + np.clip(vertex, -0.5, 0.5) * times[1])
        start, period = found[k], best[1]
    start, period = best
    found = flow.states(start, np.append(phases, 1.0) * period)
    return (None if found is None else found[:-1] * flow.units), period


def _newton(system: System, starts: np.ndarray, phases: np.ndarray, period: float, tolerance: float) -> Shot:
    """Newton's iteration on the starts of all segments and the period."""
    units = _units(starts)
    flow = Flow(system, units, max(1e-2 * tolerance, 3e-14))
    x, phases, tried = _integrate(flow, starts / units, phases, period)
    pieces = tried or []
    correction, iteration = np.inf, 0

    def result(note: str, converged: bool = False) -> Shot:
        return _result(flow, x, phases, period, pieces, correction, iteration, converged, note)

    if not pieces:
        return result("a trajectory runs away: the start is too far from an orbit")
    for iteration in range(ITERATIONS):
        dx, dt = _step(flow, x, phases, period, pieces)
        previous, correction = correction, float(max(np.max(np.abs(dx)), abs(dt)))
        if not np.isfinite(correction):
            return result("the equations are singular: orbits are not isolated here")
        if np.max(np.abs(flow.slope(x))) * period < 1e-5:
            return result("the iteration went to an equilibrium")
        if correction <= tolerance:
            return result("", converged=True)
        if iteration > 5 and correction < 1e-4 and correction > 0.5 * previous:
            return result(
                f"Newton's step stays at {correction:.0e}: the orbit is determined no better, "
                "because its multiplier 1 is nearly double or it is very unstable"
            )
        share, gap = min(1.0, 1.0 / correction), _largest_gap(x, pieces)
        for _ in range(HALVINGS):
            longer = period * np.exp(share * dt)
            new, cut, tried = _integrate(flow, x + share * dx, phases, longer)
            if tried and _largest_gap(new, tried) < max(gap, 1e-4):
                break
            share *= 0.5
        else:
            return result("Newton's steps lead nowhere: the start is too far from an orbit")
        x, phases, pieces, period = new, cut, tried, longer
    return result(f"Newton has not converged in {ITERATIONS} steps: its last is {correction:.0e}")


def _result(
    flow: Flow, x: np.ndarray, phases: np.ndarray, period: float, pieces: list[Transition],
    correction: float, iterations: int, converged: bool, note: str,
) -> Shot:  # fmt: skip
    """What has been found; of the last iterate that could be integrated where the iteration failed."""
    notes = [note] if note else []
    system = flow.system
    logs = np.full(x.shape[1], complex(np.nan, np.nan))
    residual = liouville = np.inf
    if len(pieces) == len(x):
        factors = np.array([piece.matrix for piece in pieces])
        logs = log_multipliers(factors)
        residual = _largest_gap(x, pieces)
        liouville = float(np.sum(logs.real) - sum(piece.trace for piece in pieces))
        if np.max(np.linalg.cond(factors)) > np.exp(RESOLVED):
            notes.append("disturbances shrink too fast to follow: the smallest multipliers are upper bounds")
    if converged:
        notes += [
            f"the orbit closes after 1/{d} of the period already"
            for d in (2, 3)
            if _closes(flow, x, phases, period, d)
        ]
        notes += [
            f"the model refuses a state of the orbit: {why}" for why in _refusals(system, x * flow.units)
        ]
    return Shot(
        system.states, dict(system.parameters), period, phases * period, x * flow.units, logs, residual, correction,
        liouville, iterations, converged, "; ".join(notes),
    )  # fmt: skip


def _integrate(
    flow: Flow, x: np.ndarray, phases: np.ndarray, period: float
) -> tuple[np.ndarray, np.ndarray, list[Transition] | None]:
    """All segments' transitions; where their condition is too large, with more segments than were given."""
    pieces: list[Transition | None] = [None] * len(x)
    while True:
        spans = np.diff(np.append(phases, 1.0)) * period
        for k, piece in enumerate(pieces):
            if piece is None:
                pieces[k] = flow.over(x[k], spans[k])
                if pieces[k] is None:
                    return x, phases, None
        whole = [piece for piece in pieces if piece is not None]
        cuts = np.array([_parts(flow, *each) for each in zip(x, spans, whole, strict=True)])
        # beyond any hope: then the smallest multipliers are given up, and nothing else
        if np.sum(cuts) > SEGMENTS or np.all(cuts == 1):
            return x, phases, whole
        more_x, more_phases, more = [], [], []
        for k, cut in enumerate(cuts):
            inner = spans[k] * np.arange(1, cut) / cut
            found = flow.states(x[k], inner) if cut > 1 else x[:0]
            if found is None:
                return x, phases, None
            more_x += [x[k], *found]
            more_phases += [phases[k], *(phases[k] + inner / period)]
            more += [None] * cut if cut > 1 else [pieces[k]]
        x, phases, pieces = np.array(more_x), np.array(more_phases), more


def _parts(flow: Flow, x: np.ndarray, span: float, piece: Transition) -> int:
    """Into how many parts a segment should be cut."""
    singular = np.linalg.svd(piece.matrix, compute_uv=False)
    spread = np.log(singular[0] / max(float(singular[-1]), 1e-300))
    if spread > RESOLVED:  # all that is left of the smallest is the integrator's error
        spread = max(spread, flow.rate(x) * span)
    return max(1, int(np.ceil(spread / SPREAD)))


def _gaps(x: np.ndarray, pieces: list[Transition]) -> np.ndarray:
    """Each segment's end less the next one's start (K, n)."""
    return np.array([piece.end for piece in pieces]) - np.roll(x, -1, axis=0)


def _largest_gap(x: np.ndarray, pieces: list[Transition]) -> float:
    return float(np.max(np.abs(_gaps(x, pieces))))


def _step(
    flow: Flow, x: np.ndarray, phases: np.ndarray, period: float, pieces: list[Transition]
) -> tuple[np.ndarray, float]:
    """Newton's step of the starts (K, n) and of the logarithm of the period, across the flow on average."""
    many, n = x.shape
    size = many * n
    shares = np.diff(np.append(phases, 1.0))
    speeds = period * flow.slope(np.array([piece.end for piece in pieces])) * shares[:, None]
    across = flow.slope(x) * shares[:, None]
    across /= max(float(np.linalg.norm(across)), 1e-300)
    unknown = np.arange(size).reshape(many, n)
    rows = [np.repeat(unknown, n, axis=1).ravel(), unknown.ravel(), unknown.ravel(), np.full(size, size)]
    columns = [
        np.tile(unknown, (1, n)).ravel(), np.roll(unknown, -1, axis=0).ravel(), np.full(size, size), unknown.ravel()
    ]  # fmt: skip
    matrices = np.array([piece.matrix for piece in pieces])
    entries = [matrices.ravel(), -np.ones(size), speeds.ravel(), across.ravel()]
    matrix = coo_matrix(
        (np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))), shape=(size + 1, size + 1)
    )
    try:
        step = splu(matrix.tocsc()).solve(np.append(-_gaps(x, pieces).ravel(), 0.0))
    except RuntimeError:  # exactly singular
        step = np.full(size + 1, np.nan)
    return step[:-1].reshape(many, n), float(step[-1])


def _closes(flow: Flow, x: np.ndarray, phases: np.ndarray, period: float, parts: int) -> bool:
    """Whether the orbit is back at its start after one of some parts of the period."""
    k = int(np.searchsorted(phases, 1.0 / parts - 1e-12, side="right")) - 1
    span = (1.0 / parts - phases[k]) * period
    there = flow.states(x[k], np.array([span])) if span > 1e-9 * period else x[k : k + 1]
    return there is not None and bool(np.max(np.abs(there[0] - x[0])) < 1e-6)


def _refusals(system: System, states: np.ndarray) -> list[str]:
    """Why the model refuses a state among these, once."""
    if system.refusal is None:
        return []
    whys = (system.refusal(x, system.parameters) for x in states)
    return [why for why in whys if why][:1]


def _units(x: np.ndarray) -> np.ndarray:
    """One unit of each state (n,): its range or a thousandth of its size; the largest unit where both vanish."""
    units = np.maximum(np.ptp(x, axis=0), 1e-3 * np.max(np.abs(x), axis=0))
    largest = float(np.max(units))
    return np.where(units > 1e-5 * largest, units, largest) if largest > 0.0 else np.ones(units.size)


def _multiplier_differences(
    mine: NDArray[np.complex128], theirs: NDArray[np.complex128]
) -> tuple[float, float]:
    """Multipliers matched: relative differences of those above 1e-6, differences of log|mu| of those below."""
    if np.any(np.isnan(mine)) or np.any(np.isnan(theirs)):
        return np.inf, np.inf
    # a multiplier of zero counts as exp(-10000); angles by the shorter way
    less = np.maximum(mine.real, -1e4)[:, None] - np.maximum(theirs.real, -1e4)
    turned = np.mod(mine.imag[:, None] - theirs.imag + np.pi, 2.0 * np.pi) - np.pi
    i, j = linear_sum_assignment(np.hypot(less, turned))
    small = np.maximum(np.real(mine[i]), np.real(theirs[j])) < SMALL
    with np.errstate(over="ignore", invalid="ignore"):
        large = np.abs(np.expm1(less[i, j] + 1j * turned[i, j])[~small])
    return float(np.max(large, initial=0.0)), float(np.max(np.abs(less[i, j][small]), initial=0.0))
