"""From a small disturbance of the upper rivulet D to where it ends: a limit cycle, D again, or the fall to A."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rainwind.dynamics.extremes import extremes_between
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.dynamics.orbit_results import Orbit
from rainwind.dynamics.results import Equilibrium
from rainwind.dynamics.simulate import simulate
from rainwind.dynamics.trajectory import RunEnded, Trajectory
from rainwind.errors import ComputationError
from rainwind.physics.model import RivuletModel
from rainwind.studies.equilibrium_map import equilibria_by_letter

DISTURBANCE = 1e-3  # m, of y at rest at D: small beside the diameter, our choice; the paper does not say
WITHIN = 0.01  # of the limit cycle's own amplitude: then it is reached
FIRST, LONGEST = 1500.0, 24000.0  # s: a run is lengthened until it has ended somewhere, up to this
_SETTLED = 0.1 * WITHIN


@dataclass(frozen=True, eq=False)
class Transient:
    """One run from D at a wind speed (m/s), y displaced by `disturbance` (m).

    rest: the equilibria by letter. end: "cycle", the letter of an equilibrium, "turning" (the rivulet goes round for
    ever) or "" where the run ended nowhere, of which `run.ended` and `run.settled()` say more. cycle: the limit cycle.
    since: the time from which on the half peak-to-peak values of y, phi and z over each period lie within 1 % of the
    cycle's; at an equilibrium the time at which phi first has its angle, about which it swings less and less from then
    on; NaN without an end. lost: when the rivulet first passed C; NaN if it never did.
    """

    speed: float
    run: Trajectory
    rest: dict[str, Equilibrium]
    end: Literal["cycle", "turning", ""] | str
    cycle: Orbit | None
    since: float
    lost: float
    disturbance: float


def transient(model: RivuletModel, speed: float, *, disturbance: float = DISTURBANCE) -> Transient | None:
    """Follow a disturbed D until it has ended somewhere; None where there is no D at this wind speed (m/s)."""
    at = model.with_parameters({"wind.speed": speed})
    rest = equilibria_by_letter(at)
    if "D" not in rest:
        return None
    start = rest["D"].state.copy()
    start[at.states.index("y")] += disturbance
    duration = FIRST
    while True:
        run = simulate(at, start, duration=duration)
        lost = _lost(run, rest)
        end, cycle, since = _end(at, run, rest)
        if end or not run.finished or 2.0 * duration > LONGEST:
            return Transient(speed, run, rest, end, cycle, since, lost, disturbance)
        duration *= 2.0


def _lost(run: Trajectory, rest: dict[str, Equilibrium]) -> float:
    """The first time at which the rivulet is beyond C."""
    if "C" not in rest:
        return float("nan")
    beyond = run.section(("phi", float(rest["C"]["phi"]))).times
    return float(beyond[0]) if beyond.size else float("nan")


def _end(
    model: RivuletModel, run: Trajectory, rest: dict[str, Equilibrium]
) -> tuple[str, Orbit | None, float]:
    """Where the run ended, the cycle there, and since when it is there."""
    nowhere = ("", None, float("nan"))
    if not run.finished:
        return nowhere
    period = 1.0 / model.section.frequency_y
    low, high = extremes_between(run, np.array([run.duration - 20.0 * period, run.duration]))
    for letter, one in rest.items():
        if one.stable and np.all(np.maximum(np.abs(low[0] - one.state), np.abs(high[0] - one.state)) < 1e-3):
            there = run.section(("phi", float(one["phi"])), 0).times
            return letter, None, float(there[0]) if there.size else 0.0
    phi = run.states.index("phi")
    if high[0, phi] - low[0, phi] > 2.0 * np.pi:
        return "turning", None, float(run.section(("phi", 2.0 * np.pi), 0).times[0])
    # what grows or shrinks still is no cycle yet, and not worth a Newton iteration
    edges = run.duration - period * np.arange(41.0)[::-1]
    sizes = 0.5 * np.subtract(*extremes_between(run, edges)[::-1])[:, : len(run.states) // 2]
    if np.any(np.ptp(sizes, axis=0) > 2.0 * WITHIN * sizes.max(axis=0)):
        return nowhere
    try:
        cycle = find_orbit(model, run.end, period=period)
    except ComputationError:
        return nowhere
    count = int(run.duration / cycle.period)
    edges = run.duration - cycle.period * np.arange(count + 1.0)[::-1]
    low, high = extremes_between(run, edges)
    names = run.states[: len(run.states) // 2]
    own = np.array([cycle.amplitude[name] for name in names])
    off = np.abs(0.5 * (high - low)[:, : len(names)] / own - 1.0).max(axis=1)
    if off[-20:].max() > _SETTLED:
        return nowhere
    far = np.flatnonzero(off > WITHIN)
    return "cycle", cycle, float(edges[far[-1] + 1]) if far.size else 0.0


def in_words(one: Transient) -> str:
    """Where it ended and after how long, in one sentence."""
    began = f"At {one.speed:g} m/s D with y displaced by {1000 * one.disturbance:g} mm"
    lost = f" passes C after {one.lost:.0f} s and" if np.isfinite(one.lost) else ""
    if one.end == "cycle" and one.cycle is not None:
        size = ", ".join(
            f"{name} ±{one.cycle.amplitude[name]:.3f} m" for name in ("y", "z") if name in one.run.states
        )
        return (
            f"{began}{lost} reaches a limit cycle ({size}, phi ±{np.degrees(one.cycle.amplitude['phi']):.1f}°) to "
            f"within 1 % after {one.since:.0f} s ({one.since / 60:.1f} min)."
        )
    if one.end == "D":
        return f"{began}{lost} comes to rest at D again."
    if one.end == "turning":
        return f"{began}{lost} turns round the cable for ever, from {one.since:.0f} s on."
    if one.end:
        angle = np.degrees(one.rest[one.end]["phi"])
        return f"{began}{lost} falls to {one.end}: it is at {angle:.1f}° after {one.since:.0f} s, and stays there."
    if one.run.ended is RunEnded.RAN_AWAY:
        return f"{began}{lost} runs away after {one.run.duration:.0f} s: these coefficients have no lower rivulet."
    return f"{began}{lost} reaches nothing settled within {one.run.duration:.0f} s ({one.run.ended.value})."
