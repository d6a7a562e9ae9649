"""Cycles whose surroundings twist: period doubling, its curves and their codimension-2 points.

A plane w goes round the cycle in a frame that makes half turns, w = R(k theta / 2) z, with z' = G z and G a matrix of
z1^2 and other even quantities. After one round z has become (-1)^k z: the multipliers are (-1)^k exp(lambda T), lambda
the eigenvalues of G, and for odd k an equilibrium z of the plane is a cycle of period 2T. As a function of theta,
R G R^-1 has only cos k theta and sin k theta in it. `flat`: the plane has two states of its own beside the unit circle
(polynomials, four states); else it is the plane across a circle in space, w = (r - 1, height), which takes three.
"""

from collections.abc import Sequence
from math import pi, sqrt
from typing import Any

import numpy as np

from rainwind.dynamics.cycle_zoo.driven import circle
from rainwind.dynamics.cycle_zoo.known import (
    Cycle,
    CycleAnswer,
    KnownCurve,
    KnownCycles,
    Parameters,
    folded,
    whole_roots,
)
from rainwind.dynamics.system import System
from rainwind.elementary import exp
from rainwind.elementary import sqrt as root

CARRIER, SHEAR, LAG = 1.7, 0.31, -0.6
PERIOD = 2 * pi / CARRIER


def _frame(c: Any, s: Any, half_turns: int) -> tuple[Any, Any]:
    """cos k theta, sin k theta from cos theta, sin theta."""
    return ((1.0, 0.0), (c, s), (c**2 - s**2, 2 * c * s))[half_turns]


def _square(w: Sequence[Any], frame: tuple[Any, Any]) -> Any:
    """z1^2."""
    (u, v), (c, s) = w, frame
    return (u**2 * (1 + c) + v**2 * (1 - c)) / 2 + u * v * s


def _turned(w: Sequence[Any], frame: tuple[Any, Any], matrix: Any, turn: Any) -> tuple[Any, Any]:
    """R G R^-1 w + turn J w: G's parts that commute with rotations, and the two that turn with k theta."""
    (u, v), (c, s) = w, frame
    (g11, g12), (g21, g22) = matrix
    mean, spin, stretch, slant = (g11 + g22) / 2, (g21 - g12) / 2 + turn, (g11 - g22) / 2, (g12 + g21) / 2
    cosine, sine = stretch * c - slant * s, stretch * s + slant * c
    return mean * u - spin * v + cosine * u + sine * v, spin * u + mean * v + sine * u - cosine * v


def _around(x: Any, flat: bool) -> tuple[Any, Any, tuple[Any, Any]]:
    """cos theta, sin theta and the plane w from the states."""
    if flat:
        return x.cosine, x.sine, (x.u, x.v)
    radius = root(x.x**2 + x.y**2)
    return x.x / radius, x.y / radius, (radius - 1, x.height)


def _states(c: Any, s: Any, turn: Any, x: Any, plane: tuple[Any, Any], flat: bool) -> tuple[Any, ...]:
    """The derivatives of the states that `_around` reads, from theta' = turn and w' = plane."""
    if flat:
        return *circle(c, s, turn), *plane
    return c * plane[0] - turn * x.y, s * plane[0] + turn * x.x, plane[1]


def _path(
    turn: float, z: tuple[float, float], half_turns: int, flat: bool, others: Sequence[Any] = ()
) -> Any:
    """times -> states; others: numbers, or complex amplitudes (value, rate) of a plane of its own."""

    def at(t: Any) -> np.ndarray:
        angle = turn * np.asarray(t)
        w = complex(*z) * np.exp(0.5j * half_turns * angle)
        radius = 1.0 if flat else 1 + w.real
        tail = [w.real, w.imag] if flat else [w.imag]
        still = [np.full(angle.shape, value) for value in others]
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), *tail, *still], axis=-1)

    return at


def _names(flat: bool, *others: str) -> tuple[str, ...]:
    return (("cosine", "sine", "u", "v") if flat else ("x", "y", "height")) + others


def _exponents(period: float, rates: Any, half_turns: int, flat: bool, others: Any = ()) -> np.ndarray:
    """Of the plane, of the phase, across the unit circle if there is one, of other states."""
    plane = [rate * period + 1j * pi * half_turns for rate in rates]
    return np.array(
        [*plane, 0, *([-2 * period] if flat else []), *(rate * period for rate in others)], complex
    )


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
    odd = half_turns % 2
    side = "doubled" if odd else "crossing"

    def rhs(x: Any, p: Any) -> Any:
        c, s, w = _around(x, flat)
        frame = _frame(c, s, half_turns)
        square = _square(w, frame)
        turn = p.carrier + p.shear * square
        matrix = ((p.a + p.b * square - p.e * square**2, 0.0), (0.0, p.lag))
        return _states(c, s, turn, x, _turned(w, frame, matrix, 0.5 * half_turns * turn), flat)

    def all_cycles(p: Parameters) -> list[Cycle]:
        rates = (p["a"], p["lag"])
        period = 2 * pi / p["carrier"]
        found = [
            Cycle(
                "main",
                p,
                period,
                _path(p["carrier"], (0.0, 0.0), half_turns, flat),
                _exponents(period, rates, half_turns, flat),
            )
        ]
        for square in whole_roots(-p["e"], p["b"], p["a"]):
            if square > 0:
                turn = p["carrier"] + p["shear"] * square
                period = (1 + odd) * 2 * pi / turn
                rates = (2 * p["b"] * square - 4 * p["e"] * square**2, p["lag"])
                # two full turns of the plane in a doubled round, and its mirror image is another cycle if there is none
                found += [
                    Cycle(
                        side,
                        p,
                        period,
                        _path(turn, (z, 0.0), half_turns, flat),
                        _exponents(period, rates, 0, flat),
                    )
                    for z in ((sqrt(square),) if odd else (sqrt(square), -sqrt(square)))
                ]
        return found

    places = {"a": 0.0}
    curves: tuple[KnownCurve, ...] = ()
    until = {"b": (-1.3, 1.1), "a": (-0.6, 0.6)}
    answers: tuple[CycleAnswer, ...] = (
        CycleAnswer("pd" if odd else "bp", places, soft=cubic < 0 if odd else None),
    )
    if odd:
        double = (CycleAnswer("gpd", {"a": 0.0, "b": 0.0}),) if quintic else ()
        curves = (KnownCurve("pd", ("b", "a"), until, lambda p: p["a"], double),)
    start, window = -0.3, (-0.6, 0.6)
    if branch == side:  # away from a = 0, where the branch has no amplitude
        start, window = (0.2, (0.03, 0.5)) if cubic < 0 else (-0.2, (-0.4, -0.03))
        answers, curves = (), ()
        if quintic and cubic > 0:
            start, window = -0.1 * cubic**2, (-0.6, -0.02)
            answers = (CycleAnswer("lpc", {"a": -(cubic**2) / 4}),)
            until = {"b": (0.2, 1.5), "a": (-0.6, 0.6)}  # the curve ends at the gpd point, the origin
            curves = (KnownCurve("lpc", ("b", "a"), until, lambda p: p["a"] + p["b"] ** 2 / 4),)
    system = System(
        rhs,
        _names(flat),
        {"a": start, "b": cubic, "e": quintic, "lag": LAG, "carrier": CARRIER, "shear": SHEAR},
    )
    return KnownCycles(system, "a", window, all_cycles, answers, curves, branch)


def strong_resonance(along: str = "q", branch: str = "main", *, flat: bool = False) -> KnownCycles:
    """z1' = z2, z2' = -(q + z1^2) z1 + (2 a - z1^2) z2: Bogdanov & Takens' normal form with the symmetry of 1:2.

    Multipliers -exp((a +- sqrt(a^2 - q)) T): pd on q = 0, ns on a = 0 < q with angle pi - sqrt(q) T, r2 at
    a = q = 0, r3 and r4 at angles 2 pi/3 and pi/2. Doubled cycles z1^2 = -q, with ns where a = -q/2, omega^2 = -2q.
    """

    def rhs(x: Any, p: Any) -> Any:
        c, s, w = _around(x, flat)
        frame = _frame(c, s, 1)
        square = _square(w, frame)
        turn = p.carrier + p.shear * square
        matrix = ((0.0, 1.0), (-p.q - square, 2 * p.a - square))
        return _states(c, s, turn, x, _turned(w, frame, matrix, 0.5 * turn), flat)

    def all_cycles(p: Parameters) -> list[Cycle]:
        a, q, period = p["a"], p["q"], 2 * pi / p["carrier"]
        rates = np.roots([1, -2 * a, q])
        path = _path(p["carrier"], (0.0, 0.0), 1, flat)
        found = [Cycle("main", p, period, path, _exponents(period, rates, 1, flat))]
        if q < 0:
            turn = p["carrier"] - p["shear"] * q
            period = 4 * pi / turn
            rates = np.roots([1, -2 * a - q, -2 * q])
            path = _path(turn, (sqrt(-q), 0.0), 1, flat)
            found.append(Cycle("doubled", p, period, path, _exponents(period, rates, 0, flat)))
        return found

    def resonance(kind: str, angle: float) -> CycleAnswer:
        return CycleAnswer(kind, {"a": 0.0, "q": ((pi - angle) / PERIOD) ** 2}, angle)

    double = CycleAnswer("r2", {"a": 0.0, "q": 0.0})
    window = {
        "q": (-0.5, 0.6),
        "a": (-0.6, 0.6),
    }  # the ns curve's angle is above zero for q < (carrier / 2)^2
    pd_curve = KnownCurve("pd", ("a", "q"), window, lambda p: p["q"], (double,))
    ns_curve = KnownCurve(
        "ns",
        ("q", "a"),
        window,
        lambda p: p["a"],
        (double, resonance("r3", 2 * pi / 3), resonance("r4", pi / 2)),
    )
    a, q = -0.2, 0.3
    if branch == "doubled":
        a, q, along = 0.3, -0.3, "a"
        omega = sqrt(-2 * q)
        angle = folded(omega * 4 * pi / (CARRIER - SHEAR * q))
        answers = (CycleAnswer("ns", {"a": -q / 2}, angle, False),)
        # the angle of the curve passes pi where expm(T Df) = -1, so the window is narrow
        curves = (
            KnownCurve(
                "ns", ("q", "a"), {"q": (-0.33, -0.26), "a": (0.0, 0.5)}, lambda p: p["a"] + p["q"] / 2
            ),
        )
        window_along = (-0.5, 0.6)
    elif along == "q":
        answers = (CycleAnswer("pd", {"q": 0.0}, soft=True),)
        curves, window_along = (pd_curve,), (-0.5, 0.6)
    else:
        a, answers = -0.3, (CycleAnswer("ns", {"a": 0.0}, pi - sqrt(q) * PERIOD, True),)
        curves, window_along = (ns_curve,), (-0.5, 0.5)
    system = System(rhs, _names(flat), {"q": q, "a": a, "carrier": CARRIER, "shear": SHEAR})
    return KnownCycles(system, along, window_along, all_cycles, answers, curves, branch)


def fold_flip(a: float = -0.4, branch: str = "main") -> KnownCycles:
    """f' = b - f^2 - e z1^2, z1' = (a + f - z1^2) z1, z2' = lag z2, theta' = carrier exp(shear f); four states.

    Cycles f = +-sqrt(b): lpc on b = 0, pd on b = a^2 (f = -a), foldflip where they touch, a = b = 0; gpd where the
    pd's cubic coefficient e/(2a) - 1 vanishes, a = e/2. Doubled cycles z1^2 = a + f, f^2 + e (a + f) = b, with ns at
    f = -a/2 for 0 < a < e.
    """

    def rhs(x: Any, p: Any) -> Any:
        c, s, w = _around(x, False)
        square = _square(w, (c, s))
        turn = p.carrier * exp(p.shear * x.f)
        matrix = ((p.a + x.f - square, 0.0), (0.0, p.lag))
        states = _states(c, s, turn, x, _turned(w, (c, s), matrix, 0.5 * turn), False)
        return *states, p.b - x.f**2 - p.e * square

    def all_cycles(p: Parameters) -> list[Cycle]:
        a, b, e, found = p["a"], p["b"], p["e"], []
        for f in whole_roots(-1.0, 0.0, b)[::-1]:
            turn = p["carrier"] * np.exp(p["shear"] * f)
            path = _path(turn, (0.0, 0.0), 1, False, [f])
            period = 2 * pi / turn
            found.append(
                Cycle("main", p, period, path, _exponents(period, (a + f, p["lag"]), 1, False, [-2 * f]))
            )
        for f in whole_roots(1.0, e, e * a - b)[::-1]:
            if (square := a + f) > 0:
                turn = p["carrier"] * np.exp(p["shear"] * f)
                period = 4 * pi / turn
                # of (f, z1), with trace -2 (f + z1^2) and determinant 2 z1^2 (2 f + e)
                rates = np.roots([1, 2 * (f + square), 2 * square * (2 * f + e)])
                path = _path(turn, (sqrt(square), 0.0), 1, False, [f])
                found.append(
                    Cycle("doubled", p, period, path, _exponents(period, [*rates, p["lag"]], 0, False))
                )
        return found

    e = 0.6
    window = {"a": (-0.8, 0.8), "b": (-0.5, 1.0)}
    foldflip = CycleAnswer("foldflip", {"a": 0.0, "b": 0.0})
    curves: tuple[KnownCurve, ...] = (
        KnownCurve("lpc", ("a", "b"), window, lambda p: p["b"], (foldflip,)),
        KnownCurve(
            "pd",
            ("a", "b"),
            window,
            lambda p: p["b"] - p["a"] ** 2,
            (foldflip, CycleAnswer("gpd", {"a": e / 2, "b": e**2 / 4})),
        ),
    )
    answers = (CycleAnswer("lpc", {"b": 0.0}), CycleAnswer("pd", {"b": a**2}, soft=a < 0 or a > e / 2))
    until, start = (-0.5, 1.0), 0.4
    if branch == "doubled":
        f = -a / 2
        omega = sqrt(2 * (a + f) * (2 * f + e))
        angle = folded(omega * 4 * pi / (CARRIER * np.exp(SHEAR * f)))
        answers, curves = (CycleAnswer("ns", {"b": f**2 + e * (a + f)}, angle, False),), ()
        until = (a**2 + 0.01, 0.5)
    system = System(
        rhs,
        _names(False, "f"),
        {"b": start, "a": a, "e": e, "lag": LAG, "carrier": CARRIER, "shear": SHEAR},
    )
    return KnownCycles(system, "b", until, all_cycles, answers, curves, branch)


def doubling_and_torus(along: str = "a") -> KnownCycles:
    """z1' = z1 (a - z1^2 - 2 |u|^2), z2' = lag z2, u' = (m + i spin) u - u (|u|^2 + 3 z1^2); five states.

    pd on a = 0, ns on m = 0 with angle spin T, pdns where they cross.
    """
    spin = 0.5

    def rhs(x: Any, p: Any) -> Any:
        c, s, w = _around(x, False)
        square, size = _square(w, (c, s)), x.u**2 + x.v**2
        turn = p.carrier + p.shear * square
        matrix = ((p.a - square - 2 * size, 0.0), (0.0, p.lag))
        growth = p.m - size - 3 * square
        states = _states(c, s, turn, x, _turned(w, (c, s), matrix, 0.5 * turn), False)
        return *states, growth * x.u - p.spin * x.v, p.spin * x.u + growth * x.v

    def all_cycles(p: Parameters) -> list[Cycle]:
        a, period, pair = p["a"], 2 * pi / p["carrier"], p["m"] + np.array([1j, -1j]) * p["spin"]
        path = _path(p["carrier"], (0.0, 0.0), 1, False, [0.0, 0.0])
        found = [Cycle("main", p, period, path, _exponents(period, (a, p["lag"]), 1, False, pair))]
        if a > 0:
            turn = p["carrier"] + p["shear"] * a
            period = 4 * pi / turn
            path = _path(turn, (sqrt(a), 0.0), 1, False, [0.0, 0.0])
            exponents = _exponents(period, (-2 * a, p["lag"]), 0, False, pair - 3 * a)
            found.append(Cycle("doubled", p, period, path, exponents))
        return found

    window = {"a": (-0.6, 0.6), "m": (-0.6, 0.6)}
    double = CycleAnswer("pdns", {"a": 0.0, "m": 0.0}, spin * PERIOD)
    pd_curve = KnownCurve("pd", ("m", "a"), window, lambda p: p["a"], (double,))
    ns_curve = KnownCurve("ns", ("a", "m"), window, lambda p: p["m"], (double,))
    start = {"a": -0.4, "m": -0.3, "spin": spin, "lag": LAG, "carrier": CARRIER, "shear": SHEAR}
    system = System(rhs, _names(False, "u", "v"), start)
    pd, ns = CycleAnswer("pd", {"a": 0.0}, soft=True), CycleAnswer("ns", {"m": 0.0}, spin * PERIOD, True)
    answer, curve = (pd, pd_curve) if along == "a" else (ns, ns_curve)
    return KnownCycles(system, along, (-0.6, 0.6), all_cycles, (answer,), (curve,))
