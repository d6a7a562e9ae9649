"""T1 to T4 and T8: the equilibria of the sample case and their linear stability."""

from math import degrees, radians
from typing import Any

import numpy as np

from rainwind.dynamics.equilibria import find_equilibria
from rainwind.dynamics.results import Equilibria, Equilibrium
from rainwind.studies.targets_record import Outcome, Part, Rows, close
from rainwind.studies.targets_statements import STATEMENTS
from rainwind.studies.targets_upper_rivulet import (
    UpperRivulet,
    damping_limits,
    lower_and_upper,
    upper_rivulet,
)

BELOW = (3.0, 5.0, 6.0, 7.0, 7.9)  # m/s, below the fold at 8
ABOVE = (8.1, 9.0, 12.0, 14.8, 20.0)
DAMPINGS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)  # %
NO_FOLD = Outcome(note="no fold of the upper rivulet was found between 3 and 30 m/s", verdict="missed")


def two_equilibria(model: Any) -> Outcome:
    """T1: count and types below the fold, and A's at every speed."""
    low, high = _by_speed(model, BELOW), _by_speed(model, ABOVE)
    counts = [len(found) for found in low]
    a = [[e.kind for e in lower_and_upper(found, model.beta)[0]] for found in (*low, *high)]
    b = [[e.kind for e in lower_and_upper(found, model.beta)[1]] for found in low]
    parts = (
        Part("two equilibria at each speed below 8 m/s", all(n == 2 for n in counts)),
        Part("A is a stable focus at each speed", all(kinds == ["stable focus"] for kinds in a)),
        Part("B is a saddle at each speed below 8 m/s", all(kinds == ["saddle"] for kinds in b)),
    )
    note = f"at {_list(BELOW)} m/s; A also at {_list(ABOVE)} m/s"
    if not any(a):
        note += "; there is no A: the coefficients, used raw, have no lower side"
    # the count that is furthest from two stands for all
    return Outcome(max(counts, key=lambda n: abs(n - 2)), "number of equilibria", parts, note)


def fold(model: Any) -> Outcome:
    """T2: where C and D join, how many equilibria lie above it and in which order."""
    upper = upper_rivulet(model)
    if upper is None:
        return NO_FOLD
    high = _by_speed(model, ABOVE)
    named = [_named(found, upper, model.beta) for found in high]
    orders = ["".join(name for name, _ in sorted(one, key=lambda pair: pair[1]["phi"])) for one in named]
    c_kinds = {e.kind for one in named for name, e in one if name == "C"}
    limit = _tolerance("T2")
    parts = (
        Part(f"fold within {limit:g} m/s of 8 m/s", close(upper.fold.parameter, 8.0, limit)),
        Part("four equilibria at each speed above", all(len(found) == 4 for found in high)),
        Part("C is a saddle", bool(c_kinds) and all(kind.startswith("saddle") for kind in c_kinds)),
        Part("B < D < C < A in phi at each speed above", all(order == "BDCA" for order in orders)),
    )
    note = f"counts and order at {_list(ABOVE)} m/s"
    return Outcome(upper.fold.parameter, "wind speed of the fold", parts, note)


def angle_of_d(model: Any) -> Outcome:
    """T3: phi of D."""
    upper = upper_rivulet(model)
    if upper is None or upper.end is None:
        return NO_FOLD
    limit = _tolerance("T3")
    at_9, first, last = upper.angle(9.0), upper.fold["phi"], upper.angle(upper.end)
    inside = upper.d[upper.branch["wind.speed"][upper.d] <= upper.end]
    phi = upper.branch["phi"][inside]
    speeds = upper.branch["wind.speed"][upper.d]
    reached = float(np.interp(-30.0, -np.degrees(upper.branch["phi"][upper.d]), speeds))
    parts = (
        Part(f"within {limit:g} deg of 45 deg at 9 m/s", close(degrees(at_9), 45.0, limit)),
        Part(
            "within 30 to 60 deg (and the tolerance) from the fold to the upper Hopf point",
            30.0 - limit <= degrees(last) and degrees(first) <= 60.0 + limit,
        ),
        Part("falls as the wind grows", bool(np.all(np.diff(phi) < 0))),
    )
    note = (
        "the paper does not say at which speeds D lies at 60 and at 30 deg; ours are those at the fold and "
        f"at the upper Hopf point. D reaches 30 deg at {reached:.2f} m/s"
    )
    computed = [degrees(at_9), degrees(first), degrees(last)]
    return Outcome(computed, "phi of D at 9 m/s, at the fold, at the upper Hopf point", parts, note)


def hopf_points(model: Any) -> Outcome:
    """T4: the two Hopf points, and between which speeds D is unstable."""
    upper = upper_rivulet(model)
    if upper is None or upper.onset is None:
        return NO_FOLD
    on_d = [p.parameter for p in upper.on_d]
    low_on_d = next((speed for speed in on_d if upper.end is not None and speed < upper.end), None)
    low = low_on_d if low_on_d is not None else min((p.parameter for p in upper.on_c), default=None)
    limit = _tolerance("T4")
    at_0 = f"within {limit:g} m/s of"
    parts = (
        Part(f"U_H2 {at_0} 14.8 m/s", close(upper.end, 14.8, limit)),
        Part(
            "D is unstable up to U_H2 and stable above, to 30 m/s",
            upper.end is not None and len(upper.unstable) == 1,
        ),
        Part(f"D's instability begins {at_0} 8 m/s", close(upper.onset, 8.0, limit)),
        Part(f"U_H1 is a Hopf point of D {at_0} 8 m/s", close(low_on_d, 8.0, limit)),
    )
    note = ""
    if low_on_d is None and low is not None:
        note = (
            f"D is born unstable at the fold ({upper.fold.parameter:.5f} m/s); the low Hopf point lies on C, "
            "beyond the fold, so D has one Hopf point where the paper has two"
        )
    computed = None if low is None or upper.end is None else [low, upper.end]
    return Outcome(computed, "wind speed of the low and the high Hopf point", parts, note)


def damping_that_stops_it(model: Any) -> Outcome:
    """T8, its linear part: critical damping, and the onset at several dampings."""
    limits = damping_limits(model)
    at = [upper_rivulet(model, ratio=percent / 100) for percent in DAMPINGS]
    if limits.critical is None or any(one is None for one in at):
        return NO_FOLD
    uppers = [one for one in at if one is not None]
    limit, speed_limit = _tolerance("T8"), _tolerance("T2")
    beyond = upper_rivulet(model, ratio=limits.critical + limit / 100)
    parts = (
        Part(f"within {limit:g} % of 0.7 %", close(100 * limits.critical, 0.7, limit)),
        Part("D is stable at every speed just above it", beyond is not None and not beyond.unstable),
        Part(
            "D exists from 8 m/s on at every damping",
            all(close(one.fold.parameter, 8.0, speed_limit) for one in uppers),
        ),
    )
    pairs = zip(DAMPINGS, uppers, strict=True)
    rows = tuple((percent, one.fold.parameter, one.onset, one.end) for percent, one in pairs)
    details = Rows(("damping [%]", "fold [m/s]", "D unstable from [m/s]", "to [m/s]"), rows)
    born = (
        ""
        if limits.leaves is None
        else f"The Hopf curve leaves the fold at {100 * limits.leaves:.4f} %: below that D is unstable from "
        "the fold on, above it from a somewhat higher speed. "
    )
    note = (
        f"linear part only: the largest damping of D's Hopf curve, at {limits.speed:.2f} m/s. {born}"
        "Whether limit cycles outlive the Hopf curve comes with the limit cycles"
    )
    return Outcome(100 * limits.critical, "critical damping", parts, note, details)


def _by_speed(model: Any, speeds: tuple[float, ...]) -> list[Equilibria]:
    return [find_equilibria(model.with_parameters({"wind.speed": speed})) for speed in speeds]


def _named(found: Equilibria, upper: UpperRivulet, beta: float) -> list[tuple[str, Equilibrium]]:
    """A is the lower one, C and D those on the branch that turns at the fold, B the rest."""
    speed = found[0].parameters["wind.speed"]
    lower, _ = lower_and_upper(found, beta)
    named = []
    for e in found:
        near = {
            name: abs(e["phi"] - upper.angle(speed, on_c=name == "C")) < radians(0.1) for name in ("C", "D")
        }
        on_branch = [name for name, here in near.items() if here]
        named.append(("A" if any(e is one for one in lower) else on_branch[0] if on_branch else "B", e))
    return named


def _tolerance(target: str) -> float:
    limit = STATEMENTS[target].tolerance
    if limit is None:
        raise LookupError(f"{target} has no tolerance")
    return limit


def _list(values: tuple[float, ...]) -> str:
    return ", ".join(f"{v:g}" for v in values)
