"""T5 to T9 and T15: limit cycles of the sample case, their folds, sizes and stability, and what low damping brings."""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees, log
from typing import Any

import numpy as np

from rainwind.dynamics.equilibria import continue_equilibria
from rainwind.dynamics.lyapunov import LyapunovSpectrum, lyapunov
from rainwind.dynamics.orbit_results import Orbit, OrbitPoint
from rainwind.dynamics.orbits import continue_orbits
from rainwind.errors import ComputationError
from rainwind.studies import paper, targets_equilibria, targets_time
from rainwind.studies.cycle_map import MESH, STEP, CycleMap, cycle_map
from rainwind.studies.equilibrium_map import equilibria_by_letter
from rainwind.studies.targets_record import Outcome, Part, Rows, close
from rainwind.studies.targets_statements import STATEMENTS
from rainwind.studies.targets_upper_rivulet import damping_limits
from rainwind.studies.walks import whole

LOW, MIDDLE, HIGH = (
    (8.5, 9.0, 10.0),
    (11.0, 11.5, 12.0, 12.5),
    (13.0, 14.0, 14.7),
)  # m/s, of the paper's three ranges
SWING_AT = 9.0  # m/s, T7
LOW_RATIOS = (0.0002, 0.0005, 0.001)  # our choice: the paper names no low damping
CHAOS_AT = (18.0, 0.0002)  # m/s and damping ratio, where `attractor_map` finds chaos
RATIO = "section.damping_ratio"
NO_CYCLE = Outcome(note="no limit cycle was found between 4 and 20 m/s", verdict="missed")
_FIRST, _LAST = 1e-3, 0.1  # m: how far a small disturbance of D grows in T7's estimate


def folds_of_cycles(model: Any) -> Outcome:
    """T5: the folds, how many cycles there are in each range and how many of them are stable."""
    known = _known(model)
    if not known.branches:
        return NO_CYCLE
    folds = [p.parameter for p in known.points("lpc")]
    limit = STATEMENTS["T5"].tolerance or 0.0
    counts = {speed: _counts(known, speed) for speed in (*LOW, *MIDDLE, *HIGH)}
    parts = (
        *(
            Part(
                f"a fold of cycles within {limit:g} m/s of {at:g} m/s",
                any(close(x, at, limit) for x in folds),
            )
            for at in (10.7, 12.7)
        ),
        Part("one cycle below and one above them", all(counts[s][0] == 1 for s in (*LOW, *HIGH))),
        Part("three cycles between them", all(counts[s][0] == 3 for s in MIDDLE)),
        Part("two of the three are stable", all(counts[s][1] == 2 for s in MIDDLE)),
        Part("the one below is stable", all(counts[s][1] == 1 for s in LOW)),
        Part("the one above is stable", all(counts[s][1] == 1 for s in HIGH)),
    )
    stable = [(one.low, one.high) for one in known.ranges() if one.cycles]
    two = [(one.low, one.high) for one in known.ranges() if len(one.cycles) > 1]
    note = (
        f"a cycle is stable at {_ranges(stable)} m/s, where it ends at {_ends(known, stable)}; two are stable at "
        f"{_ranges(two) if two else 'no wind speed'}. Counted at {_list(LOW)}; {_list(MIDDLE)}; {_list(HIGH)} m/s"
    )
    more, swept = targets_time.jump_parts(model)
    return Outcome(folds or None, "wind speeds of the folds of cycles", (*parts, *more), f"{note}. {swept}")


def direction(model: Any) -> Outcome:
    """T6: whether z or y is larger, on the cycle at low wind speeds and on the stable one at high ones."""
    known = _known(model)
    low = {speed: known.cycles(speed) for speed in LOW}
    high = {speed: [o for o in known.cycles(speed) if o.stable] for speed in HIGH}
    if not all(low.values()) or not any(high.values()):
        return replace(NO_CYCLE, note="not every range of wind speeds has its cycle")
    ratio = {
        s: orbits[0].amplitude["z"] / orbits[0].amplitude["y"]
        for s, orbits in (*low.items(), *high.items())
        if orbits
    }
    parts = (
        Part("the cycle at 8-10.7 m/s is mostly in-wind", all(ratio[s] > 1 for s in LOW)),
        Part("and it is stable, so that the cable vibrates so", all(o.stable for s in LOW for o in low[s])),
        Part(
            "the stable cycle at 12.7-14.8 m/s is mostly cross-wind",
            all(bool(high[s]) and ratio[s] < 1 for s in HIGH),
        ),
    )
    note = f"looked at {_list(LOW)} and {_list(HIGH)} m/s"
    changes = _changes_of_direction(known)
    if changes:
        note += f"; on the stable cycles y overtakes z at {_list(changes)} m/s"
    return Outcome(
        [ratio[9.0], 1.0 / ratio[14.0]] if 14.0 in ratio else None,
        "z/y on the cycle at 9 m/s, y/z on the stable one at 14 m/s",
        parts,
        note,
    )


def swing(model: Any) -> Outcome:
    """T7: the rivulet's swing at 9 m/s; how fast things grow there; whether the cycle is reached, and when."""
    known = _known(model)
    orbits = known.cycles(SWING_AT)
    if not orbits:
        return replace(NO_CYCLE, note="there is no cycle at 9 m/s")
    orbit = min(orbits, key=lambda o: o.unstable)
    least, most = np.degrees(orbit.extremes[:, orbit.states.index("phi")])
    half, middle = float(0.5 * (most - least)), float(0.5 * (most + least))
    limit = STATEMENTS["T7"].tolerance or 0.0
    parts = (
        Part(f"swings within {limit:g} deg of 25 deg", close(half, 25.0, limit)),
        Part(f"about an angle within {limit:g} deg of 45 deg", close(middle, 45.0, limit)),
        Part("the cycle is stable", orbit.stable),
    )
    reached, said, rows = targets_time.time_part(model)
    note = f"{_growth(model, orbit)}. {said}"
    return Outcome([half, middle], "half the swing of phi, and its middle", (*parts, reached), note, rows)


def _growth(model: Any, orbit: Orbit) -> str:
    """In words, how fast a disturbance of the cycle and one of D grow."""
    upper = equilibria_by_letter(model.with_parameters({"wind.speed": SWING_AT})).get("D")
    largest = float(orbit.exponents.real.max())
    said = [
        f"the cycle at 9 m/s has {orbit.unstable} multipliers outside the unit circle"
        + (f"; what disturbs it grows e-fold in {orbit.period / largest:.1f} s" if largest > 0 else "")
    ]
    if upper is not None:
        rate = float(upper.eigenvalues.real.max())
        said.append(f"D lies at {degrees(upper['phi']):.1f} deg")
        if rate > 0:
            said[-1] += (
                f" and a disturbance of it grows e-fold in {1 / rate:.0f} s, from 1 mm to 0.1 m in about "
                f"{log(_LAST / _FIRST) / rate:.0f} s by the linear theory"
            )
    return "; ".join(said)


def damping_that_stops_it(model: Any) -> Outcome:
    """T8: the linear part, and whether limit cycles keep within it."""
    linear = targets_equilibria.damping_that_stops_it(model)
    critical = damping_limits(model).critical
    if linear.details is None or critical is None:
        return linear
    maps = [_known(model, percent / 100) for percent in targets_equilibria.DAMPINGS]
    largest = _largest_damping(model)
    limit = STATEMENTS["T8"].tolerance or 0.0
    slowest = [min((float(b.parameter.min()) for b in known.branches), default=None) for known in maps]
    parts = (
        *linear.parts,
        Part(
            f"no limit cycle above the critical damping (and {limit:g} %)",
            largest is not None and 100 * (largest - critical) <= limit,
        ),
        Part(
            "no limit cycle below 7.95 m/s at any of these dampings",
            all(x is None or x > 7.95 for x in slowest),
        ),
    )
    rows = tuple(
        (*row, _ranges(_span(known)), _ranges([(r.low, r.high) for r in known.ranges() if r.cycles]))
        for row, known in zip(linear.details.rows, maps, strict=True)
    )
    details = Rows((*linear.details.header, "cycles at [m/s]", "stable ones at [m/s]"), rows)
    found = "No cycle was found beside the critical point" if largest is None else (
        f"Limit cycles exist up to {100 * largest:.4f} %, followed in the damping at wind speeds about that of the "
        "critical point, and shrink to nothing there: they do not outlive the Hopf curve"
    )  # fmt: skip
    note = linear.note.removeprefix("linear part only: ").replace(
        "Whether limit cycles outlive the Hopf curve comes with the limit cycles", ""
    )
    return Outcome(
        linear.computed,
        linear.quantity,
        parts,
        f"{note.rstrip(' .')}. {found}. Cycles were looked for at 4 to 20 m/s",
        details,
    )


def _largest_damping(model: Any) -> float | None:
    """The largest damping on the branches of cycles over damping, at three wind speeds about the critical one."""
    limits = damping_limits(model)
    if limits.critical is None or limits.speed is None:
        return None
    window = (0.3 * limits.critical, 2.0 * limits.critical)
    found = []
    for speed in (limits.speed - 0.5, limits.speed, limits.speed + 0.5):
        at = model.with_parameters({"wind.speed": speed, RATIO: 0.5 * limits.critical})
        upper = equilibria_by_letter(at).get("D")
        if upper is None:
            continue
        for hopf in whole(continue_equilibria(at, RATIO, start=upper, until=window)).points("hopf"):
            branch = whole(continue_orbits(at, RATIO, start=hopf, until=window, ds=STEP, mesh=MESH))
            found += [hopf.parameter, float(branch.parameter.max())]
    return max(found, default=None)


def low_damping(model: Any) -> Outcome:
    """T9: Neimark-Sacker points and period doublings at low damping, and what is stable there."""
    maps = {ratio: _known(model, ratio) for ratio in LOW_RATIOS}
    ns = {ratio: known.points("ns") for ratio, known in maps.items()}
    pd = {ratio: known.points("pd") for ratio, known in maps.items()}
    twice = [
        p for known in maps.values() for b in known.branches if not b.points("hopf") for p in b.points("pd")
    ]
    soft = {
        ratio: [
            p for p in points if p.coefficient is not None and p.coefficient < 0 and _at_edge(maps[ratio], p)
        ]
        for ratio, points in ns.items()
    }
    seen = [p for ratio, points in pd.items() for p in points if _at_edge(maps[ratio], p)]
    exponents = _exponents(model)
    parts = (
        Part(f"Neimark-Sacker points at each of {_percents(LOW_RATIOS)} % damping", all(ns.values())),
        Part(
            "soft ones (by their normal form), at which beats are born from a stable cycle",
            any(soft.values()),
        ),
        Part("period doublings", any(pd.values())),
        Part("doublings of doubled cycles: a cascade", bool(twice)),
        Part("a period doubling of a stable cycle, so that it can be seen", bool(seen)),
        Part(
            "chaos: a positive Lyapunov exponent, another one zero",
            exponents is not None and _chaotic(exponents),
        ),
    )
    said = []
    for ratio in LOW_RATIOS:
        at = f"{_percents([ratio])} %: "
        words = [f"Neimark-Sacker at {_speeds(ns[ratio])} m/s"] if ns[ratio] else ["no Neimark-Sacker point"]
        if soft[ratio]:
            beats = ", ".join(f"{p.parameter:.2f} (beats of about {_beat(p):.0f} s)" for p in soft[ratio])
            words.append(f"soft at the edge of a stable cycle: {beats} m/s")
        words.append(f"period doubling at {_speeds(pd[ratio])} m/s" if pd[ratio] else "no period doubling")
        said.append(at + ", ".join(words))
    speed, ratio = CHAOS_AT
    largest = "the trajectory runs away"
    if exponents is not None:
        largest = f"largest Lyapunov exponent {exponents.exponents[0]:.2f} ± {exponents.errors[0]:.1g} 1/s"
    note = "; ".join(said) + (
        f". Looked for at 4 to 20 m/s. From D, displaced by a diameter, at {speed:g} m/s, {100 * ratio:g} %: {largest}"
    )
    rows = tuple(
        (
            f"{100 * ratio:g}", one.low, one.high, ", ".join(one.equilibria) or None,
            "; ".join(f"y {o.amplitude['y']:.2f}, z {o.amplitude['z']:.2f}" for o in one.cycles) or None,
        )
        for ratio in (*LOW_RATIOS, model.section.damping_ratio)
        for one in _known(model, ratio).ranges()
    )  # fmt: skip
    header = (
        "damping [%]",
        "from [m/s]",
        "to [m/s]",
        "stable equilibria",
        "stable cycles half way: half amplitudes [m]",
    )
    total = [float(sum(map(len, found.values()))) for found in (ns, pd)]
    return Outcome(
        total, "number of Neimark-Sacker points and of period doublings", parts, note, Rows(header, rows)
    )


def _exponents(model: Any) -> LyapunovSpectrum | None:
    """The three largest exponents of the trajectory that begins beside D; None where it runs away."""
    speed, ratio = CHAOS_AT
    at = model.with_parameters({"wind.speed": speed, RATIO: ratio})
    upper = equilibria_by_letter(at).get("D")
    if upper is None:
        return None
    x = upper.state.copy()
    x[at.states.index("y")] += at.section.diameter
    try:
        return lyapunov(at, x, duration=1500.0, transient=6000.0, many=3, tolerance=1e-8)
    except ComputationError:
        return None


def _chaotic(found: LyapunovSpectrum) -> bool:
    """Whether the largest exponent is far above its error, and the next one is that of the flow, zero."""
    (first, second, _), errors = found.exponents, found.errors
    return bool(first > 5.0 * errors[0] and abs(second) < max(0.1 * first, 4.0 * errors[1]))


def amplitude(model: Any) -> Outcome:
    """T15: the largest y and z on the cycles, against the diameter."""
    known = _known(model)
    if not known.branches:
        return NO_CYCLE
    names = [name for name in ("y", "z") if name in known.branches[0].states]
    pieces = [piece for branch in known.branches for piece in branch.pieces(*names)]
    diameter = model.section.diameter
    largest, of_all = (
        [
            max((float(columns[k].max()) for unstable, columns in pieces if unstable <= most), default=0.0)
            / diameter
            for k in range(len(names))
        ]
        for most in (0, np.inf)
    )
    parts = (Part("y or z above the diameter on a stable cycle", max(largest) > 1),)
    note = (
        f"half peak to peak, at {_percents([model.section.damping_ratio])} % damping; with the unstable cycles "
        f"{' and '.join(f'{size:.1f}' for size in of_all)} diameters"
    )
    return Outcome(largest, "largest y and z on a stable cycle, in diameters", parts, note)


def _known(model: Any, ratio: float | None = None) -> CycleMap:
    if ratio is not None and ratio != model.section.damping_ratio:
        model = model.with_parameters({RATIO: ratio})
    return cycle_map(model, paper.SPEEDS)


def _counts(known: CycleMap, speed: float) -> tuple[int, int]:
    """How many cycles there are at a wind speed, and how many of them stable."""
    orbits = known.cycles(speed)
    return len(orbits), sum(orbit.stable for orbit in orbits)


def _changes_of_direction(known: CycleMap) -> list[float]:
    """Wind speeds at which y and z are equal on a stable cycle."""
    found = []
    for branch in known.branches:
        more = branch["y"] - branch["z"]
        for i in np.flatnonzero((np.diff(np.sign(more)) != 0) & branch.stable[:-1] & branch.stable[1:]):
            part = more[i] / (more[i] - more[i + 1])
            found.append(float(branch.parameter[i] + part * np.diff(branch.parameter)[i]))
    return sorted(found)


def _span(known: CycleMap) -> list[tuple[float, float]]:
    """The wind speeds at which there are cycles, overlapping ranges joined."""
    spans = []
    for branch in known.branches:
        speeds = [*branch.parameter, *(p.parameter for p in branch.special)]
        spans.append((float(min(speeds)), float(max(speeds))))
    joined: list[tuple[float, float]] = []
    for low, high in sorted(spans):
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return joined


def _at_edge(known: CycleMap, point: OrbitPoint) -> bool:
    """Whether a labelled cycle ends a range in which its branch is stable."""
    ends = [end for one in known.diagram.stable_ranges() for end in (one.low, one.high)]
    return any(abs(point.parameter - end) < 1e-9 * point.parameter for end in ends)


def _ends(known: CycleMap, stable: Sequence[tuple[float, float]]) -> str:
    """What kinds of point end the stable ranges."""
    names = {
        "lpc": "a fold of cycles",
        "ns": "a Neimark-Sacker point",
        "pd": "a period doubling",
        "hopf": "a Hopf point",
    }
    points = [p for branch in known.branches for p in branch.special]
    found = [
        f"{names.get(p.kind, p.kind)} ({p.parameter:.2f})"
        for end in sorted({end for one in stable for end in one})
        for p in points
        if abs(p.parameter - end) < 1e-6
    ]
    return " and ".join(dict.fromkeys(found)) or "the window's edge"


def _beat(point: OrbitPoint) -> float:
    """The period of the beats born at a Neimark-Sacker point, s."""
    return float(2 * np.pi / (point.angle or np.nan) * point.orbit.period)


def _ranges(ranges: Sequence[tuple[float, float]]) -> str:
    joined: list[tuple[float, float]] = []
    for low, high in ranges:
        if joined and abs(joined[-1][1] - low) < 1e-9:
            joined[-1] = (joined[-1][0], high)
        else:
            joined.append((low, high))
    return ", ".join(f"{low:.2f}-{high:.2f}" for low, high in joined) or "–"


def _speeds(points: Sequence[OrbitPoint]) -> str:
    return ", ".join(f"{p.parameter:.2f}" for p in points)


def _percents(ratios: Sequence[float]) -> str:
    return ", ".join(f"{100 * ratio:g}" for ratio in ratios)


def _list(values: Sequence[float]) -> str:
    return ", ".join(f"{v:.4g}" for v in values)
