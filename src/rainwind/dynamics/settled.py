"""What a trajectory has settled to, judged from its pieces alone."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np

from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.turning_points import extremes_of, zeros_of

_TURN = 2.0 * np.pi
_RETURNS = 400  # looked at, counted from the end
_LOOPS = 10  # periods before the end from which the speed of settling is judged
_NOISE = 1e3  # times tolerance and size: what a run may differ by without meaning
_SAMPLES = 128  # a period, to see since when it has been settled


@dataclass(frozen=True)
class Settled:
    """What a run settled to. kind: "equilibrium", "cycle", "whole turns" (a cycle but for full turns), "not settled".

    period: None at an equilibrium. amplitude: half peak-to-peak of each state over the last period; lowest, highest,
    mean likewise; of states that turn, less the turning at constant speed. turns: full turns a period. change: from
    the last period but one to the last, and left: what seems to be still missing, both in units of the largest
    amplitudes (equilibrium: of the run's range). since: the time from which on amplitudes and means differ by less
    than `within` of an amplitude from the last ones.
    """

    kind: Literal["equilibrium", "cycle", "whole turns", "not settled"]
    mean: Mapping[str, float]
    amplitude: Mapping[str, float]
    lowest: Mapping[str, float]
    highest: Mapping[str, float]
    period: float | None = None
    turns: Mapping[str, int] = field(default_factory=dict)
    change: float = float("nan")
    left: float = float("nan")
    since: float = float("nan")
    note: str = ""

    def __str__(self) -> str:
        if self.kind == "equilibrium":
            return f"equilibrium since t = {self.since:.4g}; {self.left:.1e} of the run's range is left"
        if self.kind == "not settled":
            return f"not settled: {self.note}"
        sizes = ", ".join(f"{name} {value:.6g}" for name, value in self.amplitude.items())
        turns = "".join(f", {count:+d} turns of {name}" for name, count in self.turns.items() if count)
        return (
            f"{self.kind} of period {self.period:.8g}{turns} since t = {self.since:.4g}, half peak-to-peak {sizes}; "
            f"{self.left:.1e} is left"
        )


def settled(
    pieces: Pieces, states: tuple[str, ...], turning: tuple[str, ...], tolerance: float, within: float = 0.01
) -> Settled:
    """Judge the end of a run. turning: states that count modulo a full turn; within: how near is settled."""
    begin, end = pieces.times[0], pieces.times[-1]
    turns = np.array([name in turning for name in states])
    joints = pieces.joints()
    ranges, sizes = np.ptp(joints, axis=0), np.abs(joints).max(axis=0)
    tail = pieces.part(end - 0.1 * (end - begin), end)
    before = pieces.part(end - 0.2 * (end - begin), tail.times[0])
    (low, high), earlier = extremes_of(tail), np.ptp(extremes_of(before), axis=0)
    last, mean = high - low, tail.integral() / (tail.times[-1] - tail.times[0])
    noise = _NOISE * max(tolerance, 1e-15) * np.where(sizes > 0.0, sizes, 1.0)
    if np.all(last <= noise):
        share = float(np.max(last / np.maximum(ranges, noise)))
        since = _at_rest_since(pieces, joints, within * np.maximum(ranges, noise))
        return _result("equilibrium", states, low, high, mean, change=share, left=share, since=since)
    cycle = _cycle(pieces, states, turns, noise, tolerance, within)
    if cycle is not None and cycle.kind != "not settled":
        return cycle
    rest = float(np.max(last / np.maximum(ranges, noise)))
    if rest <= within and np.all((last < 0.9 * earlier) | (last <= noise)):
        since = _at_rest_since(pieces, joints, within * np.maximum(ranges, noise))
        return _result("equilibrium", states, low, high, mean, change=rest, left=rest, since=since)
    if cycle is not None:
        return cycle
    falls = np.all((last < 0.9 * earlier) | (last <= noise))
    note = "it comes to rest, but not yet" if falls else "no state near the last one came back"
    return _result("not settled", states, low, high, mean, change=rest, note=note)


def unsettled(states: tuple[str, ...], note: str) -> Settled:
    """Of a run that has no end to judge."""
    none = np.full(len(states), np.nan)
    return _result("not settled", states, none, none, none, note=note)


def _cycle(
    pieces: Pieces,
    states: tuple[str, ...],
    turns: np.ndarray,
    noise: np.ndarray,
    tolerance: float,
    within: float,
) -> Settled | None:
    """The cycle at the end of a run, or one that it still approaches; None where the last state came back never."""
    end = pieces.times[-1]
    x = pieces.at(end)
    half = pieces.part(0.5 * (pieces.times[0] + end), end)
    units = np.maximum(np.ptp(_unturned(half, turns), axis=0), noise)
    times, gaps = _returns(pieces, x, units, turns)
    if times.size < 3 or gaps.min() > 0.2:
        return None
    # a later return is a shorter period: taken unless an earlier one is far nearer
    first = int(np.flatnonzero(gaps <= max(10.0 * gaps.min(), _NOISE * tolerance))[0])
    period = float(end - times[first])
    last = pieces.part(end - period, end)
    turned = np.where(turns, np.round((x - pieces.at(end - period)) / _TURN), 0.0).astype(int)
    speed = turned * _TURN / period
    straight = Pieces(last.times, last.coefficients.copy())
    straight.coefficients[:, :, 0] -= speed * (last.times[:-1] - last.times[0])[:, None]
    if straight.degree:
        straight.coefficients[:, :, 1] -= speed
    low, high = extremes_of(straight)
    mean = straight.integral() / period
    seen = high - low > 10.0 * noise  # of the other states there is nothing to say
    if not np.any(seen):
        return None
    units = np.where(seen, high - low, np.inf)
    # the returns that are one, two, ... periods before the end, and how far each loop is from the one before it
    ends = [end]
    while len(ends) <= _LOOPS:
        k = int(np.argmin(np.abs(times - (ends[-1] - period))))
        if abs(times[k] - (ends[-1] - period)) > 0.1 * period or times[k] - period <= pieces.times[0]:
            break
        ends.append(times[k])
    back = -period * np.arange(_SAMPLES) / _SAMPLES
    loops = [pieces.at(t + back) for t in ends]
    apart = [_difference(a, b, turns) for a, b in pairwise(loops)]
    changes = [float(np.max(np.abs(one) / units)) for one in apart]
    if len(changes) < 2:
        return None
    ratio = (changes[0] / changes[-1]) ** (1.0 / (len(changes) - 1)) if changes[-1] > 0.0 else 0.0
    left = changes[0]
    # noise has no direction: changes that go on growing or shrinking are none, however small
    steady = len(changes) > 4 and len({b > a for a, b in pairwise(changes)}) == 1
    if steady or np.any(np.abs(apart) > np.where(seen, noise, np.inf)):
        left = max(changes[0], changes[0] * ratio / (1.0 - ratio)) if ratio < 1.0 else np.inf
    facts = {
        "period": period, "turns": {s: int(k) for s, k in zip(states, turned, strict=True) if k},
        "change": changes[0], "left": float(left),
    }  # fmt: skip
    if left <= within:
        kind = "whole turns" if np.any(turned) else "cycle"
        since = _same_since(pieces, period, turned, within)
        return _result(kind, states, low, high, mean, since=since, **facts)
    if changes[0] > 0.2:
        return None
    sizes = [
        float(np.max(np.ptp(loop - back[:, None] * speed, axis=0) / units)) for loop in (loops[0], loops[-1])
    ]
    grows = (sizes[0] / sizes[1]) ** (1.0 / (len(loops) - 1)) - 1.0
    note = f"it comes back after {period:.5g}, {changes[0]:.2g} of its amplitude off, and not more closely than before"
    if ratio < 1.0 or abs(grows) > 0.3 * changes[0]:
        how = f"{'grows' if grows > 0.0 else 'falls'} by {abs(grows):.2g} of it a period"
        note = f"it oscillates with a period of {period:.5g}, and its amplitude {how}"
    return _result("not settled", states, low, high, mean, note=note, **facts)


def _returns(
    pieces: Pieces, x: np.ndarray, units: np.ndarray, turns: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """When it passed through the surface across its end in the same direction, the latest first, and how far from
    the end it was in units."""
    normal = pieces.at(pieces.times[-1], derivative=1) / units**2
    size = float(np.linalg.norm(normal * units))
    if not size > 0.0:
        return np.zeros(0), np.zeros(0)
    part = pieces.part(0.5 * (pieces.times[0] + pieces.times[-1]), pieces.times[-1])
    level = Pieces(part.times, _level(part, x, normal / size, turns)[:, None, :])
    times, rising = zeros_of(level, 0)
    times = times[rising][::-1][:_RETURNS]
    times = times[times < pieces.times[-1] - 1e-9 * (pieces.times[-1] - pieces.times[0])]
    gaps = np.abs(_difference(part.at(times), x, turns)) / units
    return times, gaps.max(axis=1, initial=0.0)


def _level(pieces: Pieces, x: np.ndarray, normal: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """normal . (state - x) along the pieces as polynomials (k, D + 1); states that turn are brought near x."""
    c = pieces.coefficients.copy()
    whole = np.round((c[:, :, 0] - x) / _TURN) * _TURN
    c[:, :, 0] -= x + np.where(turns, whole, 0.0)
    return np.einsum("i,kij->kj", normal, c)


def _unturned(pieces: Pieces, turns: np.ndarray) -> np.ndarray:
    """The states at the joints, those that turn less their drift in whole turns."""
    joints = pieces.joints()
    whole = np.round((joints[-1] - joints[0]) / _TURN) * np.where(turns, _TURN, 0.0)
    share = (pieces.times - pieces.times[0]) / (pieces.times[-1] - pieces.times[0])
    return joints - share[:, None] * whole


def _difference(a: np.ndarray, b: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """a - b, of states that turn modulo a full turn."""
    gap = a - b
    return np.where(turns, gap - np.round(gap / _TURN) * _TURN, gap)


def _at_rest_since(pieces: Pieces, joints: np.ndarray, allowed: np.ndarray) -> float:
    """From when on all states stayed near the last one, to the end of a step."""
    far = np.flatnonzero(np.any(np.abs(joints - joints[-1]) > allowed, axis=1))
    return float(pieces.times[far[-1] + 1]) if far.size else float(pieces.times[0])


def _same_since(pieces: Pieces, period: float, turned: np.ndarray, within: float) -> float:
    """From when on each period's amplitudes and means are near the last one's."""
    end, n = pieces.times[-1], turned.size
    many = int((end - pieces.times[0]) / period)
    phases = np.arange(_SAMPLES) / _SAMPLES
    drift = phases[:, None] * turned * _TURN
    last, allowed = None, np.zeros(0)
    for k in range(many):
        x = pieces.at(end - (k + 1) * period + phases * period) - drift
        # of states that turn the mean counts modulo a turn, and is left out
        facts = np.concatenate([np.ptp(x, axis=0) / 2.0, np.where(turned, 0.0, x.mean(axis=0))])
        if last is None:
            last, allowed = facts, within * np.tile(np.maximum(facts[:n], 1e-3 * facts[:n].max()), 2)
        elif np.any(np.abs(facts - last) > allowed):
            return float(end - k * period)
    return float(pieces.times[0])


def _result(
    kind: Literal["equilibrium", "cycle", "whole turns", "not settled"], states: tuple[str, ...],
    low: np.ndarray, high: np.ndarray, mean: np.ndarray, **facts: object,
) -> Settled:  # fmt: skip
    def named(values: np.ndarray) -> dict[str, float]:
        return dict(zip(states, np.asarray(values, dtype=float).tolist(), strict=True))

    return Settled(kind, named(mean), named(0.5 * (high - low)), named(low), named(high), **facts)  # type: ignore[arg-type]
