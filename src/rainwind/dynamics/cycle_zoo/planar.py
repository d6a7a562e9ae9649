"""Cycles in the plane: circles r' = r g(r^2), level curves of a Hamiltonian, and a loop through a saddle."""

from collections.abc import Callable, Sequence
from math import acos, cos, pi, sqrt
from typing import Any

import numpy as np
from scipy.special import ellipj, ellipkm1

from rainwind.dynamics.cycle_zoo.known import (
    Cycle,
    CycleAnswer,
    KnownCurve,
    KnownCycles,
    Parameters,
    whole_roots,
)
from rainwind.dynamics.system import System

OMEGA, SHEAR = 1.7, 0.23


def _circles(
    growth: Callable[[Any, Any], Any],
    slope: Callable[[float, Parameters], float],
    squares: Callable[[Parameters], Sequence[float]],
    parameters: Parameters,
    **about: Any,
) -> KnownCycles:
    """r' = r g(r^2), theta' = omega + shear r^2: circles where g = 0, multiplier exp(2 r^2 g'(r^2) T)."""

    def rhs(x: Any, p: Any) -> Any:
        square = x.x**2 + x.y**2
        g, turn = growth(square, p), p.omega + p.shear * square
        return g * x.x - turn * x.y, turn * x.x + g * x.y

    def circle(square: float, p: Parameters) -> Cycle:
        turn, radius = p["omega"] + p["shear"] * square, sqrt(square)

        def at(t: Any) -> np.ndarray:
            angle = turn * np.asarray(t)
            return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

        period = 2 * pi / turn
        return Cycle("main", p, period, at, np.array([0.0, 2 * square * slope(square, p) * period], complex))

    system = System(rhs, ("x", "y"), {**parameters, "omega": OMEGA, "shear": SHEAR})
    return KnownCycles(
        system,
        all_cycles=lambda p: [circle(square, p) for square in squares(p) if square > 0],
        **about,
    )


def hopf() -> KnownCycles:
    """z' = (mu + i (omega + shear |z|^2)) z - z |z|^2: r^2 = mu, multiplier exp(-2 mu T)."""
    return _circles(
        lambda square, p: p.mu - square,
        lambda square, p: -1.0,
        lambda p: [p["mu"]],
        {"mu": 0.3},
        along="mu",
        until=(-0.5, 1.5),
        equilibrium=(0.0, 0.0),
        hopf=0.0,
    )


def bautin(b2: float = 1.0) -> KnownCycles:
    """r' = r (b1 + b2 r^2 - r^4): r^2 = (b2 +- sqrt(b2^2 + 4 b1)) / 2 (Kuznetsov, 3rd ed., sec. 8.3).

    From the hard Hopf point b1 = 0 (b2 > 0) to an LPC at b1 = -b2^2/4; its curve ends at the Bautin point
    b1 = b2 = 0, where the cycle has shrunk to the equilibrium.
    """
    lpc = CycleAnswer("lpc", {"b1": -(b2**2) / 4})
    curve = KnownCurve(
        "lpc", ("b2", "b1"), {"b2": (-1.0, 2.0), "b1": (-1.0, 1.0)}, lambda p: p["b1"] + p["b2"] ** 2 / 4
    )
    return _circles(
        lambda square, p: p.b1 + p.b2 * square - square**2,
        lambda square, p: p["b2"] - 2 * square,
        lambda p: whole_roots(-1.0, p["b2"], p["b1"])[::-1],
        {"b1": -0.15 * b2**2, "b2": b2},
        along="b1",
        until=(-1.0, 1.0),
        answers=(lpc,) if b2 > 0 else (),
        curves=(curve,) if b2 > 0 else (),
        equilibrium=(0.0, 0.0),
        hopf=0.0,
    )


def cusp(a: float = 0.9) -> KnownCycles:
    """r' = r (b + a s - s^3), s = r^2 - 1: LPCs at s = +-sqrt(a/3), so 27 b^2 = 4 a^3; cusp at a = b = 0.

    Born at the Hopf point b = a - 1 (s = -1), soft for a < 3.
    """
    b = 2 * (a / 3) ** 1.5
    curve = KnownCurve(
        "lpc",
        ("b", "a"),
        {"b": (-1.3, 1.3), "a": (-1.0, 2.0)},
        lambda p: 27 * p["b"] ** 2 - 4 * p["a"] ** 3,
        (CycleAnswer("cpc", {"a": 0.0, "b": 0.0}),),
    )

    def growth(square: Any, p: Any) -> Any:
        s = square - 1
        return p.b + p.a * s - s**3

    return _circles(
        growth,
        lambda square, p: p["a"] - 3 * (square - 1) ** 2,
        lambda p: [1 + s for s in whole_roots(-1.0, 0.0, p["a"], p["b"])],
        {"b": 0.5 * (a - 1), "a": a},
        along="b",
        until=(-1.5, 1.5),
        answers=(CycleAnswer("lpc", {"b": b}), CycleAnswer("lpc", {"b": -b})),
        curves=(curve,),
        equilibrium=(0.0, 0.0),
        hopf=a - 1,
    )


def isola(c: float = 1.0) -> KnownCycles:
    """r' = r (c - (r^2 - 2)^2 - lambda^2), c < 4: a closed branch, LPCs at lambda = +-sqrt(c).

    The LPC curve c = lambda^2 turns at the isola's centre c = 0, which is no codimension-2 point of the cycle.
    """
    curve = KnownCurve(
        "lpc", ("lam", "c"), {"lam": (-1.5, 1.5), "c": (-1.0, 2.0)}, lambda p: p["c"] - p["lam"] ** 2
    )
    return _circles(
        lambda square, p: p.c - (square - 2) ** 2 - p.lam**2,
        lambda square, p: -2 * (square - 2),
        lambda p: whole_roots(1.0, -4.0, 4.0 + p["lam"] ** 2 - p["c"])[::-1],
        {"lam": 0.1, "c": c},
        along="lam",
        until=(-2.0, 2.0),
        answers=tuple(CycleAnswer("lpc", {"lam": sign * sqrt(c)}) for sign in (1.0, -1.0)),
        curves=(curve,),
        closed=True,
    )


def level_curve(pull: float = 2.0) -> KnownCycles:
    """x' = H_y - k (H - h) H_x, y' = -H_x - k (H - h) H_y with H = y^2/2 + x^2/2 - x^3/3: the cycle is H = h.

    On it x'' = x^2 - x, so x = e1 + (e2 - e1) sn^2; multiplier exp(-k integral |grad H|^2 dt). Born at the Hopf
    point h = 0; homoclinic to (1, 0), a saddle of zero trace, at h = 1/6.
    """

    def rhs(x: Any, p: Any) -> Any:
        h_x, h_y = x.x - x.x**2, x.y
        off = p.pull * (x.y**2 / 2 + x.x**2 / 2 - x.x**3 / 3 - p.h)
        return h_y - off * h_x, -h_x - off * h_y

    def all_cycles(p: Parameters) -> list[Cycle]:
        h = p["h"]
        if not 0 < h < 1 / 6:
            return []
        third = acos(1 - 12 * h) / 3
        e1, e2, e3 = (0.5 + cos(third + shift) for shift in (2 * pi / 3, -2 * pi / 3, 0.0))
        rate, quarter = sqrt((e3 - e1) / 6), float(ellipkm1((e3 - e2) / (e3 - e1)))
        period = 2 * quarter / rate

        def at(t: Any) -> np.ndarray:
            phase = np.mod(rate * np.asarray(t), 2 * quarter)
            sn, cn, dn, _ = ellipj(phase, (e2 - e1) / (e3 - e1))
            return np.stack([e1 + (e2 - e1) * sn**2, 2 * rate * (e2 - e1) * sn * cn * dn], axis=-1)

        x, y = at(np.arange(4096) * period / 4096).T
        steepness = period * float(np.mean((x - x**2) ** 2 + y**2))
        return [Cycle("main", p, period, at, np.array([0.0, -p["pull"] * steepness], complex))]

    system = System(rhs, ("x", "y"), {"h": 0.05, "pull": pull})
    return KnownCycles(
        system, "h", (-0.1, 0.3), all_cycles, equilibrium=(0.0, 0.0), hopf=0.0, homoclinic=1 / 6
    )


def alpha_loop() -> KnownCycles:
    """Sandstede (1997): x' = -x + 2y + x^2 + mu x (2 - 3x), y' = 2x - y - 3x^2 + 3/2 x y - 2 mu y.

    At mu = 0 the curve x^2 (1 - x) = y^2 is a homoclinic loop of the origin, eigenvalues 1 and -3. The stable cycle
    inside it lives from there to the Hopf point where the trace at the other equilibrium vanishes. The cycle itself
    is not known.
    """

    def rhs(x: Any, p: Any) -> Any:
        return (
            -x.x + 2 * x.y + x.x**2 + p.mu * x.x * (2 - 3 * x.x),
            2 * x.x - x.y - 3 * x.x**2 + 1.5 * x.x * x.y - 2 * p.mu * x.y,
        )

    system = System(rhs, ("x", "y"), {"mu": 0.0})
    return KnownCycles(
        system,
        "mu",
        (-0.1, 0.3),
        lambda p: [],
        equilibrium=(2 / 3, 1 / 9),
        hopf=ALPHA_LOOP_HOPF,
        homoclinic=0.0,
    )


# the smallest root of 576 m^4 - 384 m^3 + 652 m^2 - 376 m + 25, left when x and y are eliminated from f = trace = 0
ALPHA_LOOP_HOPF = 0.076143746417079307938
