"""Equilibria carried round a circle: every special point of `zoo`'s equilibria becomes one of cycles.

With theta' = carrier exp(shear z1) on the unit circle and z' = f(z, p), an equilibrium z of f gives a cycle of
period T = 2 pi exp(-shear z1) / carrier with multipliers 1, exp(-2 T) and exp(lambda T), lambda the eigenvalues of
Df: folds become lpc, Hopf points ns of angle omega T, and bp, cusp, gh, bt, zh, hh become bp, cpc, ch, r1, lpns, nsns.
The shear lets the period follow z1, which makes r1 generic. From two states on, the plane (z1, z2) turns with theta,
w = R(theta) z.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import pi, sqrt
from typing import Any

import numpy as np
from scipy.special import lambertw

from rainwind.dynamics import zoo
from rainwind.dynamics.cycle_zoo.driven import circle
from rainwind.dynamics.cycle_zoo.known import (
    Cycle,
    CycleAnswer,
    KnownCurve,
    KnownCycles,
    Named,
    Parameters,
    folded,
    whole_roots,
)
from rainwind.dynamics.system import System
from rainwind.elementary import exp

KINDS = {
    "fold": "lpc",
    "hopf": "ns",
    "bp": "bp",
    "cusp": "cpc",
    "gh": "ch",
    "bt": "r1",
    "zh": "lpns",
    "hh": "nsns",
}

# all parameters -> (branch, state) of every equilibrium
Equilibria = Callable[[Parameters], Sequence[tuple[str, Sequence[float]]]]


def suspended(
    base: zoo.Known,
    equilibria: Equilibria,
    equations: Sequence[Callable[[Parameters], float]] = (),
    *,
    carrier: float,
    shear: float,
) -> KnownCycles:
    """The cycles of a system of `zoo`; equations: of its curves, in their order."""
    inner = base.system
    turned = len(inner.states) > 1

    def rhs(x: Any, p: Any) -> Any:
        c, s = x.cosine, x.sine
        z = [x[name] for name in inner.states]
        if turned:
            z[:2] = c * z[0] + s * z[1], c * z[1] - s * z[0]
        turn = p.carrier * exp(p.shear * z[0])
        f = list(inner.rhs(Named(dict(zip(inner.states, z, strict=True))), p))
        if turned:
            u, v = x[inner.states[0]], x[inner.states[1]]
            f[:2] = c * f[0] - s * f[1] - turn * v, s * f[0] + c * f[1] + turn * u
        return *circle(c, s, turn), *f

    def all_cycles(p: Parameters) -> list[Cycle]:
        return [cycle(branch, np.array(z, dtype=float), p) for branch, z in equilibria(p)]

    def cycle(branch: str, z: np.ndarray, p: Parameters) -> Cycle:
        turn = p["carrier"] * np.exp(p["shear"] * z[0])
        period = 2 * pi / turn

        def at(t: Any) -> np.ndarray:
            wave = np.exp(1j * turn * np.asarray(t))
            w = np.broadcast_to(z, (*wave.shape, z.size)).copy()
            if turned:
                plane = wave * complex(z[0], z[1])
                w[..., 0], w[..., 1] = plane.real, plane.imag
            return np.concatenate([wave.real[..., None], wave.imag[..., None], w], axis=-1)

        rates = np.linalg.eigvals(inner.jacobian(z, {k: p[k] for k in inner.parameters}))
        return Cycle(branch, p, period, at, period * np.append(rates, [0, -2]))

    def carried(answer: zoo.Answer) -> CycleAnswer:
        omegas = () if answer.kind == "bt" or answer.omega is None else np.atleast_1d(answer.omega)
        angles = tuple(folded(omega * _period(answer, omega)) for omega in omegas)
        soft = None if answer.kind != "hopf" or not answer.lyapunov else answer.lyapunov < 0
        return CycleAnswer(
            KINDS[answer.kind],
            answer.at,
            angles if len(angles) > 1 else (angles[0] if angles else None),
            soft,
        )

    def _period(answer: zoo.Answer, omega: float) -> float:
        """Of the cycle with the critical pair."""
        found = all_cycles({**system.parameters, **answer.at})
        return min(found, key=lambda c: np.abs(c.exponents - 1j * omega * c.period).min()).period

    system = System(
        rhs, ("cosine", "sine", *inner.states), {**inner.parameters, "carrier": carrier, "shear": shear}
    )
    curves = tuple(
        KnownCurve(KINDS[c.kind], c.along, c.until, equation, tuple(map(carried, c.answers)))
        for c, equation in zip(base.curves, equations, strict=False)
    )
    return KnownCycles(system, base.along, base.until, all_cycles, tuple(map(carried, base.answers)), curves)


def _rest(n: int) -> Equilibria:
    return lambda p: [("main", (0.0,) * n)]


def _with_answers(known: KnownCycles, number: int, until: Any, extra: Sequence[CycleAnswer]) -> KnownCycles:
    """With a narrower window and more answers for one of the curves."""
    curves = list(known.curves)
    curves[number] = replace(curves[number], until=until, answers=(*curves[number].answers, *extra))
    return replace(known, curves=tuple(curves))


def cusp() -> KnownCycles:
    """z' = b + a z - z^3: lpc where 27 b^2 = 4 a^3, cpc at a = b = 0."""
    return suspended(
        zoo.cusp(),
        lambda p: [("main", (z,)) for z in whole_roots(-1.0, 0.0, p["a"], p["b"])],
        [lambda p: 27 * p["b"] ** 2 - 4 * p["a"] ** 3],
        carrier=2.2,
        shear=0.15,
    )


def transcritical() -> KnownCycles:
    """z' = mu z - z^2: cycles z = 0 and z = mu cross at mu = 0 (bp), and their periods differ."""
    return suspended(
        zoo.transcritical(),
        lambda p: [("main", (0.0,)), ("crossing", (p["mu"],))],
        carrier=2.2,
        shear=0.15,
    )


def pitchfork() -> KnownCycles:
    """z' = mu z - z^3: cycles z = +-sqrt(mu) branch off at mu = 0 (bp)."""

    def equilibria(p: Parameters) -> list[tuple[str, Sequence[float]]]:
        side = sqrt(max(p["mu"], 0.0))
        return [("main", (0.0,)), *(("crossing", (z,)) for z in (side, -side) if z)]

    return suspended(zoo.pitchfork(), equilibria, carrier=2.2, shear=0.15)


def closed_loop() -> KnownCycles:
    """z' = z^2 + p^2 - 1: the cycles are a closed branch, lpc at p = +-1."""
    known = suspended(
        zoo.closed_loop(),
        lambda p: [("main", (z,)) for z in whole_roots(1.0, 0.0, p["p"] ** 2 - 1)[::-1]],
        carrier=2.2,
        shear=0.15,
    )
    return replace(known, closed=True)


def neimark_sacker(c: float = -1.0) -> KnownCycles:
    """z' = (mu + i omega) z + c z |z|^2: ns at mu = 0, angle omega T, soft for c < 0."""
    return suspended(zoo.hopf(c, 2.0), _rest(2), carrier=5.3, shear=0.2)


def chenciner() -> KnownCycles:
    """z' = (mu + i) z + nu z |z|^2 - z |z|^4: ns at mu = 0; ch at mu = nu = 0."""
    return suspended(zoo.bautin(), _rest(2), [lambda p: p["mu"]], carrier=4.7, shear=0.2)


def brusselator() -> KnownCycles:
    """The Brusselator: ns at b = 1 + a^2, its curve through r4 and r3, where a T = pi/2 and 2 pi/3.

    T = 2 pi exp(-shear a) / carrier, so a = -W(-shear angle carrier / (2 pi)) / shear.
    """
    carrier, shear = 6.6, 0.02
    known = suspended(
        zoo.brusselator(),
        lambda p: [("main", (p["a"], p["b"] / p["a"]))],
        [lambda p: p["b"] - 1 - p["a"] ** 2],
        carrier=carrier,
        shear=shear,
    )
    extra = []
    for kind, angle in (("r4", pi / 2), ("r3", 2 * pi / 3)):
        a = float(-lambertw(-shear * angle * carrier / (2 * pi)).real / shear)
        extra.append(CycleAnswer(kind, {"a": a, "b": 1 + a**2}, angle))
    return _with_answers(known, 0, {"a": (0.3, 3.0), "b": (0.2, 12.0)}, extra)


def bogdanov_takens(b2: float = -1.0) -> KnownCycles:
    """x' = y, y' = b1 + b2 x + x^2 - x y: lpc on b1 = b2^2/4, ns on b1 = 0 > b2, r1 where they meet.

    On the ns curve the angle is sqrt(-b2) T: r4 and r3 at pi/2 and 2 pi/3; the window ends before pi.
    """
    carrier = 4.3

    def equilibria(p: Parameters) -> list[tuple[str, Sequence[float]]]:
        return [("main", (x, 0.0)) for x in whole_roots(1.0, p["b2"], p["b1"])]

    known = suspended(
        zoo.bogdanov_takens(b2),
        equilibria,
        [lambda p: p["b1"], lambda p: p["b1"] - p["b2"] ** 2 / 4],
        carrier=carrier,
        shear=0.1,
    )
    extra = [
        CycleAnswer(kind, {"b1": 0.0, "b2": -((angle * carrier / (2 * pi)) ** 2)}, angle)
        for kind, angle in (("r4", pi / 2), ("r3", 2 * pi / 3))
    ]
    return _with_answers(known, 0, {"b2": (-3.2, 1.0), "b1": (-1.0, 1.3)}, extra)


def zero_hopf(b2: float = 0.2) -> KnownCycles:
    """x' = b1 + x^2 - |w|^2, w' = (b2 + x + x^2 + 3i) w: lpc and ns, lpns at b1 = b2 = 0, ch at b1 = -b2 = -1/4.

    The plane that turns is (x, Re w); the angle along the ns curve stays between those of r4 and r3.
    """

    def equilibria(p: Parameters) -> list[tuple[str, Sequence[float]]]:
        return [("main", (x, 0.0, 0.0)) for x in whole_roots(1.0, 0.0, p["b1"])]

    return suspended(
        zoo.zero_hopf(b2),
        equilibria,
        [lambda p: p["b1"], lambda p: p["b1"] + ((p["b1"] - p["b2"]) / p["theta"]) ** 2],
        carrier=11.0,
        shear=0.03,
    )


def hopf_hopf() -> KnownCycles:
    """Two Hopf normal forms that meet: ns at m1 = 0, nsns at m1 = m2 = 0; six states."""
    return suspended(zoo.hopf_hopf(), _rest(4), [lambda p: p["m1"]], carrier=5.4, shear=0.2)


def lorenz() -> KnownCycles:
    """Lorenz' equations: ns, the pitchfork at rho = 1, and ns on the other side, of another period."""

    def equilibria(p: Parameters) -> list[tuple[str, Sequence[float]]]:
        x = sqrt(p["beta"] * max(p["rho"] - 1, 0.0))
        sides = (x, -x) if x else ((0.0,) if p["rho"] == 1 else ())
        return [*(("main", (x, x, p["rho"] - 1)) for x in sides), ("crossing", (0.0,) * 3)]

    known = suspended(zoo.lorenz(), equilibria, carrier=25.1, shear=0.01)
    first, pitchfork, _ = known.answers
    mirrored = min(known.cycles(first.at, "main"), key=lambda c: -c.period)
    angle = folded(float(np.sort(mirrored.exponents.imag)[-1]))
    return replace(known, answers=(first, pitchfork, replace(first, angle=angle)))


def predator_prey() -> KnownCycles:
    """Predator and prey: a transcritical bp at k = 0.6 where the predators die out, and ns at k = 2.2."""

    def equilibria(p: Parameters) -> list[tuple[str, Sequence[float]]]:
        x = p["d"] / (p["a"] - p["d"])
        return [("main", (x, (1 - x / p["k"]) * (1 + x) / p["a"])), ("crossing", (p["k"], 0.0))]

    return suspended(zoo.predator_prey(), equilibria, carrier=2.3, shear=0.1)


def stiff() -> KnownCycles:
    """ns beside lags of rates 1e-3, 1, 1e3 and 1e6 per unit time, eight states."""
    return suspended(zoo.stiff(), _rest(6), carrier=5.3, shear=0.2)
