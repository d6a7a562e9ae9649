"""One periodic orbit: from a state that settles on it, a state and a period, a simulation, or a function of time."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.dynamics.branches import check_states
from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.equilibria import find_equilibrium
from rainwind.dynamics.newton import solve_equilibrium
from rainwind.dynamics.orbit_families import ONE_OF_MANY, is_one_of_many
from rainwind.dynamics.orbit_from_guess import CLOSED, Guess, gap_of, orbit_near
from rainwind.dynamics.orbit_results import Orbit, OrbitPoint
from rainwind.dynamics.results import Equilibrium
from rainwind.dynamics.settling import STIFF, Integration, Trajectory
from rainwind.dynamics.system import System, as_system, number
from rainwind.dynamics.trajectory import Trajectory as Run
from rainwind.errors import ComputationError, InputError

TURNS = 2500  # after which a trajectory that has not settled is given up
EVALUATIONS = 800_000  # of f, likewise
WINDOWS, WITHOUT_TURN = 32, 18  # each twice as long as the one before
APART, TURNS_APART = 1e-5, 30
CHAOTIC = 300.0  # spread in so many turns; on a torus it grows in proportion to them
COMES_BACK = 0.1  # of its range: a return from which Newton is tried
NEAR, AT_REST = 0.05, 1e-3
_REPEATS = 1e-3  # in units: a return from which it is asked whether everything beside closes too


def find_orbit(
    model: Any,
    start: Any,
    *,
    period: float | None = None,
    transient: float = 0.0,
    mesh: Mesh | None = None,
) -> Orbit:
    """A periodic orbit at the model's parameters, by collocation, from something near it.

    start: a state, by name or in order, from which the trajectory settles on a stable orbit, after `transient` at
    least; or a state near an orbit of any stability, with a guess of the period; or a run of `simulate`, or (times,
    states), of which the last period is taken; or a function t -> state with its period; or an Orbit, of other
    parameters. mesh: to begin with; intervals are added, up to its limit, until the estimated error is below 1e-6. What
    goes round several times within the period comes out with its least period.
    Raises InputError for bad input, and ComputationError, which says what was seen and what to do, where no orbit is
    found: at an equilibrium, on a torus or in chaos, for a trajectory that runs away or has not settled.
    """
    system = as_system(model)
    mesh = mesh if mesh is not None else Mesh()
    if not isinstance(mesh, Mesh):
        raise InputError(f"mesh must be a Mesh, for example Mesh(intervals=40, degree=4); got {mesh!r}")
    if period is not None and not number(period, "period") > 0.0:
        raise InputError(f"period = {period!r} must be above zero")
    if number(transient, "transient") < 0.0:
        raise InputError(f"transient = {transient!r} must not be below zero")
    if isinstance(start, OrbitPoint):
        start = start.orbit
    if isinstance(start, Orbit):
        return _checked(system, _from_orbit(system, start, period, mesh))
    if callable(start):
        return _checked(system, _from_function(system, start, period, mesh))
    if isinstance(start, Run):
        check_states(system, start)
        start = start.times, start.state
    if isinstance(start, tuple) and len(start) == 2 and np.ndim(start[0]) == 1:
        return _checked(system, _from_simulation(system, start, period, mesh))
    x = system.state(start.state if isinstance(start, Equilibrium) else start)
    _refuse_not_finite(system, x)
    if period is None:
        return _checked(system, _settled(system, x, float(transient), mesh))
    return _checked(system, _from_state(system, x, float(period), mesh))


# -- where the guess comes from ---------------------------------------------------------------------------------------


def _from_orbit(system: System, start: Orbit, period: float | None, mesh: Mesh) -> Orbit:
    if start.states != system.states:
        raise InputError(
            f"the orbit has the states {', '.join(start.states)}, the system has {', '.join(system.states)}; "
            "give an orbit of this system"
        )
    found = orbit_near(system, lambda phase: start.at(start.period * phase), period or start.period, mesh)
    if found is None:
        raise ComputationError(
            "Newton finds no orbit from this one: the parameters are too far apart; follow it with continue_orbits"
        )
    return found


def _from_function(system: System, start: Callable[[float], Any], period: float | None, mesh: Mesh) -> Orbit:
    if period is None:
        raise InputError(
            "a function of time needs its period beside it: find_orbit(model, function, period=...)"
        )
    times = period * np.linspace(0.0, 1.0, 8 * mesh.intervals + 1)
    states = np.array([system.state(start(float(t))) for t in times])
    cubic = Trajectory(times / period, states, period * system.f(states))
    found = orbit_near(system, cubic.at, period, mesh)
    if found is None:
        raise ComputationError(
            f"Newton finds no orbit near this function with period {period:g}; give a nearer one, or a state alone "
            "if the orbit is stable"
        )
    return found


def _from_simulation(system: System, start: tuple[Any, Any], period: float | None, mesh: Mesh) -> Orbit:
    run = _as_trajectory(system, start)
    length = float(run.times[-1] - run.times[0])
    step = length / (len(run.times) - 1)
    if period is not None:
        # the last row may be left out, being the first again
        if period > length + 1.5 * step:
            raise InputError(
                f"the simulation lasts {length:g}, less than the period of {period:g}; give a longer one"
            )
        guess = _last(run, min(period, length))
        found = orbit_near(system, guess, period, mesh)
        if found is None:
            raise ComputationError(
                f"Newton finds no orbit near the last {period:g} of the simulation; {_gap_in_words(guess)}; give a "
                "better settled simulation or another period"
            )
        return found
    units = run.latter().units()
    lags, gaps = run.returns(units)
    for lag, _ in _promising(lags, gaps):
        found = orbit_near(system, _last(run, lag), lag, mesh)
        if found is not None and _swings(found, units):
            return found
    raise ComputationError(
        f"the simulation does not repeat itself so that Newton could find an orbit: {_returns_in_words(lags, gaps)}; "
        "give one that has settled and lasts some periods, or say period="
    )


def _from_state(system: System, x: np.ndarray, period: float, mesh: Mesh) -> Orbit:
    """The trajectory over the period that was guessed, or up to where it comes back nearest about then."""
    integration = Integration(system)
    run = integration.run(x, 1.3 * period, np.maximum(np.abs(x), 1e-3 * np.max(np.abs(x)) + 1e-9))
    if run is None:
        raise ComputationError(
            f"within 1.3 periods of {period:g} the trajectory from the start {integration.why}; give a state nearer to "
            "the orbit, or a shorter period"
        )
    units = run.units()
    times = period * np.linspace(0.7, 1.3, 601)
    nearest = float(times[np.argmin(np.max(np.abs((run.at(times) - x) / units), axis=1))])
    for guess in dict.fromkeys((nearest, period)):
        found = orbit_near(system, _first(run, guess), guess, mesh)
        if found is not None and _swings(found, units):
            return found
    _refuse_equilibrium(system, x)
    if is_one_of_many(integration, x, units, nearest):
        raise ComputationError(ONE_OF_MANY.format(nearest))
    raise ComputationError(
        f"Newton finds no orbit from this state with a period near {period:g}; the trajectory comes back nearest "
        f"after {nearest:.6g}, and then {_gap_in_words(_first(run, nearest))}; give a state nearer to the orbit, "
        "another period, or the state alone if the orbit is stable"
    )


@dataclass
class _Seen:
    """What a trajectory that does not settle has shown."""

    lags: np.ndarray
    gaps: np.ndarray
    orbit: Orbit | None = None  # an unstable one it goes round


def _settled(system: System, x: np.ndarray, transient: float, mesh: Mesh) -> Orbit:
    """The stable orbit on which the trajectory from x settles."""
    _refuse_equilibrium(system, x)
    integration = Integration(system)
    rate = integration.rate(x)
    span = 20.0 / rate if 0.0 < rate < np.inf else 1.0
    units = np.maximum(np.abs(x), 1e-3 * np.max(np.abs(x)))
    units = np.where(units > 0.0, units, 1e-3)
    extent = np.zeros(x.size)
    elapsed, turns, seen = 0.0, 0, _Seen(np.zeros(0), np.zeros(0))
    for window in range(WINDOWS):
        length = transient if window == 0 and transient > 0.0 else span
        run = integration.run(x, length, units)
        if run is None:
            raise ComputationError(
                f"between t = {elapsed:.4g} and {elapsed + length:.4g} the trajectory {integration.why}; give a start "
                "in the orbit's basin of attraction, or a state near the orbit with its period"
            )
        elapsed += length
        x = run.states[-1]
        extent = np.maximum(extent, np.ptp(run.states, axis=0))
        if window == 0 and transient > 0.0:
            continue
        last = run.latter()
        units = last.units()
        lags, gaps = run.returns(units)
        _refuse_rest(system, run, extent, elapsed)
        orbit = _on_which_it_settles(system, run, units, lags, gaps, seen, mesh)
        if orbit is not None:
            return orbit
        closed = np.flatnonzero(gaps < _REPEATS)
        if closed.size and is_one_of_many(integration, x, units, float(lags[closed[0]])):
            raise ComputationError(ONE_OF_MANY.format(lags[closed[0]]))
        seen.lags, seen.gaps = lags, gaps
        turns += len(lags)
        if turns > TURNS or integration.count > EVALUATIONS or (not len(lags) and window > WITHOUT_TURN):
            break
        span = 2.0 * span
    fast, slow = _rates(system, x)
    if not len(seen.lags) and fast > STIFF * slow > 0.0:
        raise ComputationError(
            f"after {integration.count} evaluations of f the trajectory is at t = {elapsed:.4g} and has not come back "
            f"to where it was; it is stiff: rates there go from {slow:.3g} to {fast:.3g} per unit of time. Give a "
            "state near the orbit with its period, or transient= to wait longer"
        )
    raise ComputationError(_not_settled(seen, elapsed, _spreads(integration, x, units, seen.lags)))


def _rates(system: System, x: np.ndarray) -> tuple[float, float]:
    """The largest and the smallest modulus of an eigenvalue of J at x, those that vanish to rounding left out."""
    found = np.abs(np.linalg.eigvals(system.jacobian(x)))
    fast = float(found.max())
    return fast, float(found[found > 1e-14 * fast].min(initial=fast))


def _spreads(integration: Integration, x: np.ndarray, units: np.ndarray, lags: np.ndarray) -> float | None:
    """By how much two trajectories that begin near each other are farther apart some turns later; at most 1 / APART."""
    if len(lags) < 2:
        return None
    span = float(lags[min(TURNS_APART, len(lags)) - 1])
    both = [integration.run(start, span, 1e-2 * units) for start in (x, x + APART * units)]
    if both[0] is None or both[1] is None:
        return None
    return float(np.max(np.abs((both[0].states[-1] - both[1].states[-1]) / units))) / APART


def _on_which_it_settles(
    system: System,
    run: Trajectory,
    units: np.ndarray,
    lags: np.ndarray,
    gaps: np.ndarray,
    seen: _Seen,
    mesh: Mesh,
) -> Orbit | None:
    """A stable orbit that the trajectory comes ever nearer to, from one of its returns."""
    for lag, _ in _promising(lags, gaps):
        orbit = orbit_near(system, _last(run, lag), lag, mesh, patient=False)
        if orbit is None or not _swings(orbit, units):
            continue
        away = _distance(orbit, run.states[-1], units)
        if away > NEAR:
            continue
        if not orbit.stable:
            seen.orbit = orbit
        elif away < AT_REST or away < 0.5 * _distance(orbit, run.states[0], units):
            return orbit
    return None


def _promising(lags: np.ndarray, gaps: np.ndarray) -> Iterator[tuple[float, float]]:
    """The first return that comes near, and those later ones that come much nearer."""
    best, count = 2.0 * COMES_BACK, 0
    for lag, gap in zip(lags.tolist(), gaps.tolist(), strict=True):
        if gap < 0.5 * best and count < 4:
            best, count = gap, count + 1
            yield lag, gap


def _distance(orbit: Orbit, x: np.ndarray, units: np.ndarray) -> float:
    """How far a state is from an orbit, in units, along its polygon of many corners."""
    fine = np.linspace(0.0, 1.0, 21)[:-1]
    corners = np.append((orbit.grid.times[:-1, None] + orbit.grid.lengths[:, None] * fine).ravel(), 1.0)
    places = (orbit.grid.at(orbit.profile, corners) - x) / units
    a, b = places[:-1], places[1:]
    along = b - a
    share = -np.sum(a * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-300)
    return float(np.min(np.max(np.abs(a + np.clip(share, 0.0, 1.0)[:, None] * along), axis=1)))


def _last(run: Trajectory, span: float) -> Guess:
    """The last part of a trajectory, by phase."""
    begin = run.times[-1] - span
    return lambda phase: run.at(begin + span * phase)


def _first(run: Trajectory, span: float) -> Guess:
    begin = run.times[0]
    return lambda phase: run.at(begin + span * phase)


def _as_trajectory(system: System, given: tuple[Any, Any]) -> Trajectory:
    n = len(system.states)
    try:
        times, states = np.asarray(given[0], dtype=float), np.asarray(given[1], dtype=float)
    except (TypeError, ValueError):
        times, states = np.zeros(0), np.zeros(0)
    if states.shape == (n, len(times)) and n != len(times):  # as SciPy gives them
        states = states.T
    if (
        len(times) < 8
        or states.shape != (len(times), n)
        or not (np.all(np.isfinite(times)) and np.all(np.isfinite(states)))
        or not np.all(np.diff(times) > 0.0)
    ):
        raise InputError(
            f"a simulation is (times, states): at least 8 rising times (k,) and finite states (k, {n}); got arrays of "
            f"shapes {np.shape(times)} and {np.shape(states)}"
        )
    return Trajectory(times, states, system.f(states))


def _swings(orbit: Orbit, units: np.ndarray) -> bool:
    """Whether an orbit is about as large as what it was sought from: Newton may go to an equilibrium instead."""
    return float(np.max(np.ptp(orbit.profile, axis=0) / units)) > 0.1


# -- what is no orbit -------------------------------------------------------------------------------------------------


def _checked(system: System, orbit: Orbit) -> Orbit:
    """The orbit, if it is one and the model allows all its states."""
    size = np.maximum(1.0, np.max(np.abs(orbit.profile), axis=0))
    if float(np.max(np.ptp(orbit.profile, axis=0) / size)) < 1e-7:
        raise ComputationError(
            f"Newton went to an equilibrium at {_state(system, orbit.profile[0])}; give a guess with a larger swing"
        )
    if system.refusal is not None:
        for x in orbit.profile:
            why = system.refusal(x, system.parameters)
            if why is not None:
                raise ComputationError(f"the orbit passes through a state that the model refuses: {why}")
    return orbit


def _refuse_not_finite(system: System, x: np.ndarray) -> None:
    with np.errstate(all="ignore"):
        rates = system.f(x)
    if not np.all(np.isfinite(rates)):
        bad = [
            f"the rate of {n} is {r}"
            for n, r in zip(system.states, rates.tolist(), strict=True)
            if not np.isfinite(r)
        ]
        raise InputError(
            f"f is not finite at the start {_state(system, x)}: {', '.join(bad)}; give a start at which it is"
        )


def _refuse_equilibrium(system: System, x: np.ndarray) -> None:
    found = solve_equilibrium(system, x)
    if found is not None and np.max(np.abs(found[0] - x) / np.maximum(1e-3, np.abs(x))) < 1e-9:
        kind = find_equilibrium(system, found[0]).kind
        raise ComputationError(
            f"the start is an equilibrium itself ({kind}); give a state away from it, or go to continue_orbits with "
            "a Hopf point"
        )


def _refuse_rest(system: System, run: Trajectory, extent: np.ndarray, elapsed: float) -> None:
    """Raises where the trajectory comes to rest."""
    found = solve_equilibrium(system, run.states[-1])
    if found is None:
        return
    units = np.maximum(extent, 1e-9 * max(float(np.max(extent)), 1e-300))
    first, last = (float(np.max(np.abs(x - found[0]) / units)) for x in (run.states[0], run.states[-1]))
    if not (last < AT_REST and last < 0.5 * first) and last > 1e-9:
        return
    there = find_equilibrium(system, found[0])
    if there.stable:
        raise ComputationError(
            f"the trajectory comes to rest by t = {elapsed:.4g}, at the {there.kind} {_state(system, there.state)}; "
            "give a start farther from it, or a state with a period if the orbit is unstable"
        )


def _not_settled(seen: _Seen, elapsed: float, spread: float | None) -> str:
    said = f"the trajectory has not settled on an orbit by t = {elapsed:.4g}: {_returns_in_words(seen.lags, seen.gaps)}"
    if np.count_nonzero(seen.gaps < 0.01 * CLOSED) > 1:  # once may be chance
        return f"{said}: it does repeat itself, but Newton fails on this mesh; give mesh= with more intervals"
    if spread is None:
        what = "; it drifts, or is very slow"
    elif spread > CHAOTIC:
        what = "; trajectories side by side part fast: this is chaos"
    else:
        what = "; trajectories side by side stay so: this is a torus, or a slow transient"
    if seen.orbit is not None:
        leading = np.exp(seen.orbit.exponents[0])
        number = (
            f"{leading.real:.4g}"
            if abs(leading.imag) < 1e-9
            else f"{abs(leading):.4g} exp(i {np.angle(leading):.4g})"
        )
        what += f", round an unstable orbit of period {seen.orbit.period:.6g} with the multiplier {number}"
    return (
        f"{said}{what}; give transient= to wait longer, another start, or, for an unstable orbit, a state near it with "
        "its period"
    )


def _returns_in_words(lags: np.ndarray, gaps: np.ndarray) -> str:
    if not len(lags):
        return "it does not come back to where it was"
    k = int(np.argmin(gaps))
    return (
        f"of its last {len(lags)} turns none ends nearer to the present one than {100 * gaps[k]:.2g} % of its range "
        f"({lags[k]:.6g} ago)"
    )


def _gap_in_words(guess: Guess) -> str:
    return f"its ends are {100 * gap_of(guess):.2g} % of its range apart"


def _state(system: System, x: np.ndarray) -> str:
    return ", ".join(f"{name} = {value:.6g}" for name, value in zip(system.states, x.tolist(), strict=True))
