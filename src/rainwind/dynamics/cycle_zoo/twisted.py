"""Period doubling, its curves and their codimension-2 points: equilibria of a plane with a `Twist`."""

from math import pi, sqrt
from typing import Any

import numpy as np

from rainwind.dynamics.cycle_zoo.known import (
    Cycle,
    CycleAnswer,
    KnownCurve,
    KnownCycles,
    Parameters,
    folded,
    whole_roots,
)
from rainwind.dynamics.cycle_zoo.twist import Twist
from rainwind.dynamics.system import System
from rainwind.elementary import exp

CARRIER, SHEAR, LAG = 1.7, 0.31, -0.6
PERIOD = 2 * pi / CARRIER
COMMON = {"lag": LAG, "carrier": CARRIER, "shear": SHEAR}


def doubling(
    cubic: float = -1.0,
    quintic: float = 0.0,
    *,
    half_turns: int = 1,
    flat: bool = False,
    branch: str = "main",
) -> KnownCycles:
    """z1' = z1 (a + b z1^2 - e z1^4), z2' = lag z2, theta' = carrier + shear z1^2.

    One half turn: pd at a = 0, soft for b < 0; none or two: bp. The branch there ("doubled", "crossing") has
    a + b z1^2 - e z1^4 = 0. With e = 1: gpd at a = b = 0, and an lpc of the doubled cycles on a = -b^2/4, b > 0.
    """
    twist, odd = Twist(half_turns, flat), half_turns % 2
    side = "doubled" if odd else "crossing"

    def rhs(x: Any, p: Any) -> Any:
        square = twist.square(x)
        growth = p.a + p.b * square - p.e * square**2
        return twist.derivatives(x, p.carrier + p.shear * square, ((growth, 0.0), (0.0, p.lag)))

    def all_cycles(p: Parameters) -> list[Cycle]:
        found = [twist.cycle("main", p, p["carrier"], 0.0, (p["a"], p["lag"]))]
        for square in whole_roots(-p["e"], p["b"], p["a"]):
            if square > 0:
                turn = p["carrier"] + p["shear"] * square
                rates = (2 * p["b"] * square - 4 * p["e"] * square**2, p["lag"])
                # z and -z are the same cycle if it is a doubled one
                for z in (sqrt(square),) if odd else (sqrt(square), -sqrt(square)):
                    found.append(twist.cycle(side, p, turn, z, rates, rounds=1 + odd))
        return found

    gpd = (CycleAnswer("gpd", {"a": 0.0, "b": 0.0}),) if quintic else ()
    # without the quintic term b = 0 is too degenerate to be crossed
    width = (-1.2, 1.2) if quintic else ((-1.3, -0.2) if cubic < 0 else (0.2, 1.3))
    until = {"b": width, "a": (-0.6, 0.6)}
    answers: tuple[CycleAnswer, ...] = (
        CycleAnswer("pd" if odd else "bp", {"a": 0.0}, soft=cubic < 0 if odd else None),
    )
    curves = (KnownCurve("pd", ("b", "a"), until, lambda p: p["a"], gpd),) if odd else ()
    start, window = -0.3, (-0.6, 0.6)
    if branch == side:  # away from a = 0, where the branch has no amplitude
        start, window = (0.2, (0.03, 0.5)) if cubic < 0 else (-0.2, (-0.4, -0.03))
        answers, curves = (), ()
        if quintic and cubic > 0:
            start, window = -0.1 * cubic**2, (-0.6, -0.02)
            answers = (CycleAnswer("lpc", {"a": -(cubic**2) / 4}),)
            until = {"b": (0.2, 1.5), "a": (-0.6, 0.6)}  # the curve ends at the gpd point, the origin
            curves = (KnownCurve("lpc", ("b", "a"), until, lambda p: p["a"] + p["b"] ** 2 / 4),)
    system = System(rhs, twist.states, {"a": start, "b": cubic, "e": quintic, **COMMON})
    return KnownCycles(system, "a", window, all_cycles, answers, curves, branch)


def strong_resonance(along: str = "q", branch: str = "main", *, flat: bool = False) -> KnownCycles:
    """z1' = z2, z2' = -(q + z1^2) z1 + (2 a - z1^2) z2: Bogdanov & Takens' normal form with the symmetry of 1:2.

    Multipliers -exp((a +- sqrt(a^2 - q)) T): pd on q = 0, ns on a = 0 < q with angle pi - sqrt(q) T, r2 at
    a = q = 0, r3 and r4 at angles 2 pi/3 and pi/2. Doubled cycles z1^2 = -q, with ns where a = -q/2, omega^2 = -2q.
    """
    twist = Twist(1, flat)

    def rhs(x: Any, p: Any) -> Any:
        square = twist.square(x)
        matrix = ((0.0, 1.0), (-p.q - square, 2 * p.a - square))
        return twist.derivatives(x, p.carrier + p.shear * square, matrix)

    def all_cycles(p: Parameters) -> list[Cycle]:
        a, q = p["a"], p["q"]
        found = [twist.cycle("main", p, p["carrier"], 0.0, np.roots([1, -2 * a, q]))]
        if q < 0:
            turn, rates = p["carrier"] - p["shear"] * q, np.roots([1, -2 * a - q, -2 * q])
            found.append(twist.cycle("doubled", p, turn, sqrt(-q), rates, rounds=2))
        return found

    def resonance(kind: str, angle: float) -> CycleAnswer:
        return CycleAnswer(kind, {"a": 0.0, "q": ((pi - angle) / PERIOD) ** 2}, angle)

    r2 = CycleAnswer("r2", {"a": 0.0, "q": 0.0})
    window = {
        "q": (-0.5, 0.6),
        "a": (-0.6, 0.6),
    }  # the ns curve's angle is above zero for q < (carrier / 2)^2
    if branch == "doubled":
        a, q, along, until = 0.3, -0.3, "a", (-0.5, 0.6)
        angle = folded(sqrt(-2 * q) * 4 * pi / (CARRIER - SHEAR * q))
        answer = CycleAnswer("ns", {"a": -q / 2}, angle, False)
        # the curve has resonances outside this window
        window = {"q": (-0.33, -0.26), "a": (0.0, 0.5)}
        curve = KnownCurve("ns", ("q", "a"), window, lambda p: p["a"] + p["q"] / 2)
    elif along == "q":
        a, q, until = -0.2, 0.3, (-0.5, 0.6)
        answer = CycleAnswer("pd", {"q": 0.0}, soft=True)
        curve = KnownCurve("pd", ("a", "q"), window, lambda p: p["q"], (r2,))
    else:
        a, q, until = -0.3, 0.3, (-0.5, 0.5)
        answer = CycleAnswer("ns", {"a": 0.0}, pi - sqrt(q) * PERIOD, True)
        doubles = (r2, resonance("r3", 2 * pi / 3), resonance("r4", pi / 2))
        curve = KnownCurve("ns", ("q", "a"), window, lambda p: p["a"], doubles)
    system = System(rhs, twist.states, {"q": q, "a": a, "carrier": CARRIER, "shear": SHEAR})
    return KnownCycles(system, along, until, all_cycles, (answer,), (curve,), branch)


def fold_flip(a: float = -0.4, branch: str = "main") -> KnownCycles:
    """f' = b - f^2 - e z1^2, z1' = (a + f - z1^2) z1, z2' = lag z2, theta' = carrier exp(shear f); four states.

    Cycles f = +-sqrt(b): lpc on b = 0, pd on b = a^2 (f = -a), foldflip where they touch, a = b = 0; gpd where the
    pd's cubic coefficient e/(2a) - 1 vanishes, a = e/2. Doubled cycles z1^2 = a + f, f^2 + e (a + f) = b, with ns at
    f = -a/2 for 0 < a < e.
    """
    twist, e = Twist(), 0.6

    def rhs(x: Any, p: Any) -> Any:
        square = twist.square(x)
        matrix = ((p.a + x.f - square, 0.0), (0.0, p.lag))
        states = twist.derivatives(x, p.carrier * exp(p.shear * x.f), matrix)
        return *states, p.b - x.f**2 - p.e * square

    def all_cycles(p: Parameters) -> list[Cycle]:
        a, b, e, found = p["a"], p["b"], p["e"], []
        for f in whole_roots(-1.0, 0.0, b)[::-1]:
            turn = p["carrier"] * np.exp(p["shear"] * f)
            found.append(twist.cycle("main", p, turn, 0.0, (a + f, p["lag"], -2 * f), still=[f]))
        for f in whole_roots(1.0, e, e * a - b)[::-1]:
            if (square := a + f) > 0:
                turn = p["carrier"] * np.exp(p["shear"] * f)
                # of (f, z1), with trace -2 (f + z1^2) and determinant 2 z1^2 (2 f + e)
                rates = [*np.roots([1, 2 * (f + square), 2 * square * (2 * f + e)]), p["lag"]]
                found.append(twist.cycle("doubled", p, turn, sqrt(square), rates, rounds=2, still=[f]))
        return found

    window = {"a": (-0.8, 0.8), "b": (-0.5, 1.0)}
    foldflip = CycleAnswer("foldflip", {"a": 0.0, "b": 0.0})
    gpd = CycleAnswer("gpd", {"a": e / 2, "b": e**2 / 4})
    curves: tuple[KnownCurve, ...] = (
        KnownCurve("lpc", ("a", "b"), window, lambda p: p["b"], (foldflip,)),
        KnownCurve("pd", ("a", "b"), window, lambda p: p["b"] - p["a"] ** 2, (foldflip, gpd)),
    )
    answers = (CycleAnswer("lpc", {"b": 0.0}), CycleAnswer("pd", {"b": a**2}, soft=a < 0 or a > e / 2))
    until = (-0.5, 1.0)
    if branch == "doubled":  # away from b = a^2, where the branch has no amplitude
        f = -a / 2
        angle = folded(sqrt(a * (e - a)) * 4 * pi / (CARRIER * np.exp(SHEAR * f)))
        answers, curves = (CycleAnswer("ns", {"b": f**2 + e * (a + f)}, angle, False),), ()
        until = (a**2 + 0.01, 0.5)
    system = System(rhs, (*twist.states, "f"), {"b": 0.4, "a": a, "e": e, **COMMON})
    return KnownCycles(system, "b", until, all_cycles, answers, curves, branch)


def doubling_and_torus(along: str = "a") -> KnownCycles:
    """z1' = z1 (a - z1^2 - 2 |u|^2), z2' = lag z2, u' = (m + i spin) u - u (|u|^2 + 3 z1^2); five states.

    pd on a = 0, ns on m = 0 with angle spin T, pdns where they cross. Doubled cycles z1^2 = a.
    """
    twist, spin = Twist(), 0.5

    def rhs(x: Any, p: Any) -> Any:
        square, size = twist.square(x), x.u**2 + x.v**2
        matrix = ((p.a - square - 2 * size, 0.0), (0.0, p.lag))
        growth = p.m - size - 3 * square
        states = twist.derivatives(x, p.carrier + p.shear * square, matrix)
        return *states, growth * x.u - p.spin * x.v, p.spin * x.u + growth * x.v

    def all_cycles(p: Parameters) -> list[Cycle]:
        a, pair = p["a"], p["m"] + np.array([1j, -1j]) * p["spin"]
        found = [twist.cycle("main", p, p["carrier"], 0.0, (a, p["lag"], *pair), still=[0.0, 0.0])]
        if a > 0:
            turn, rates = p["carrier"] + p["shear"] * a, (-2 * a, p["lag"], *(pair - 3 * a))
            found.append(twist.cycle("doubled", p, turn, sqrt(a), rates, rounds=2, still=[0.0, 0.0]))
        return found

    window = {"a": (-0.6, 0.6), "m": (-0.6, 0.6)}
    double = (CycleAnswer("pdns", {"a": 0.0, "m": 0.0}, spin * PERIOD),)
    if along == "a":
        answer = CycleAnswer("pd", {"a": 0.0}, soft=True)
        curve = KnownCurve("pd", ("m", "a"), window, lambda p: p["a"], double)
    else:
        answer = CycleAnswer("ns", {"m": 0.0}, spin * PERIOD, True)
        curve = KnownCurve("ns", ("a", "m"), window, lambda p: p["m"], double)
    system = System(rhs, (*twist.states, "u", "v"), {"a": -0.4, "m": -0.3, "spin": spin, **COMMON})
    return KnownCycles(system, along, (-0.6, 0.6), all_cycles, (answer,), (curve,))
