"""Small systems whose special points are known in closed form, to test the numerics against.

Lyapunov coefficients are Kuznetsov's, with |q| = 1. For the normal form z' = (mu + i omega) z + c z |z|^2, z = x + iy,
the unit vector is q = (1, -i) / sqrt 2, so that z = sqrt 2 times Kuznetsov's coordinate and l1 = 2 Re c / omega.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Any

from rainwind.dynamics.system import System


@dataclass(frozen=True)
class Answer:
    """A special point known in closed form: kind, free parameters, frequency, first Lyapunov coefficient."""

    kind: str
    at: Mapping[str, float]
    omega: float | tuple[float, float] | None = None
    lyapunov: float | None = None


@dataclass(frozen=True)
class KnownCurve:
    """A curve of folds or Hopf points in two parameters, from the first point of that kind on the branch."""

    kind: str
    along: tuple[str, str]
    until: Mapping[str, tuple[float, float]]
    answers: tuple[Answer, ...]


@dataclass(frozen=True, eq=False)
class Known:
    """A system, a branch of equilibria of it, all special points on the branch, and curves from these."""

    system: System
    along: str
    start: tuple[float, ...]
    until: tuple[float, float]
    answers: tuple[Answer, ...]
    curves: tuple[KnownCurve, ...] = ()


def brusselator(a: float = 1.0) -> Known:
    """x' = a - (b + 1) x + x^2 y, y' = b x - x^2 y (Prigogine & Lefever 1968).

    Equilibrium (a, b/a), trace b - 1 - a^2, determinant a^2: Hopf at b = 1 + a^2, omega = a,
    l1 = -(2 + a^2) / (2 a (1 + 2 a^2)).
    """
    l1 = -(2.0 + a**2) / (2.0 * a * (1.0 + 2.0 * a**2))
    hopf = Answer("hopf", {"b": 1.0 + a**2}, a, l1)
    curve = KnownCurve("hopf", ("a", "b"), {"a": (0.1 * a, 3.0 * a), "b": (0.2, 2.0 + 6.0 * a**2)}, ())

    def rhs(x: Any, p: Any) -> Any:
        return p.a - (p.b + 1) * x.x + x.x**2 * x.y, p.b * x.x - x.x**2 * x.y

    system = System(rhs, ("x", "y"), {"a": a, "b": 0.5})
    return Known(system, "b", (a, 0.5 / a), (0.2, 3.0 + 2.0 * a**2), (hopf,), (curve,))


def cusp(a: float = 3.0) -> Known:
    """x' = b + a x - x^3: the hysteresis cubic (Kuznetsov, 3rd ed., sec. 8.2).

    Folds where a = 3 x^2, b = -2 x^3, so 27 b^2 = 4 a^3; cusp at a = b = 0.
    """
    b = 2.0 * (a / 3.0) ** 1.5
    folds = (Answer("fold", {"b": b}), Answer("fold", {"b": -b}))
    width = max(3.0 * b, 1e-6)
    curve = KnownCurve(
        "fold",
        ("b", "a"),
        {"b": (-width, width), "a": (-a, 2.0 * a)},
        (Answer("cusp", {"a": 0.0, "b": 0.0}),),
    )
    system = System(lambda x, p: [p.b + p.a * x.x - x.x**3], ("x",), {"a": a, "b": -2.0 * b})
    return Known(system, "b", (-2.0 * sqrt(a / 3.0),), (-2.5 * b, 2.5 * b), folds, (curve,))


def close_folds(distance: float = 1e-3) -> Known:
    """The cubic of `cusp` with folds at x = +- distance / 2, within a wide window."""
    known = cusp(0.75 * distance**2)
    system = known.system.with_parameters({"b": -1.0})
    return Known(system, "b", (-1.0,), (-1.5, 1.5), known.answers)


def hopf(c: float = -1.0, omega: float = 2.0) -> Known:
    """z' = (mu + i omega) z + c z |z|^2: Hopf at mu = 0, l1 = 2 c / omega."""

    def rhs(x: Any, p: Any) -> Any:
        square = x.x**2 + x.y**2
        return (
            p.mu * x.x - p.omega * x.y + p.c * x.x * square,
            p.omega * x.x + p.mu * x.y + p.c * x.y * square,
        )

    system = System(rhs, ("x", "y"), {"mu": -0.5, "omega": omega, "c": c})
    return Known(
        system, "mu", (0.0, 0.0), (-1.0, 1.5), (Answer("hopf", {"mu": 0.0}, omega, 2.0 * c / omega),)
    )


def bautin() -> Known:
    """z' = (mu + i) z + nu z |z|^2 - z |z|^4 (Kuznetsov, sec. 8.3): on mu = 0, l1 = 2 nu; GH at mu = nu = 0."""

    def rhs(x: Any, p: Any) -> Any:
        square = x.x**2 + x.y**2
        growth = p.mu + p.nu * square - square**2
        return growth * x.x - x.y, x.x + growth * x.y

    system = System(rhs, ("x", "y"), {"mu": -0.5, "nu": -0.7})
    curve = KnownCurve(
        "hopf",
        ("nu", "mu"),
        {"nu": (-2.0, 3.0), "mu": (-1.0, 1.0)},
        (Answer("gh", {"mu": 0.0, "nu": 0.0}, 1.0, 0.0),),
    )
    return Known(system, "mu", (0.0, 0.0), (-1.0, 1.5), (Answer("hopf", {"mu": 0.0}, 1.0, -1.4),), (curve,))


def bogdanov_takens(b2: float = -1.0, s: float = -1.0) -> Known:
    """x' = y, y' = b1 + b2 x + x^2 + s x y (Kuznetsov, sec. 8.4).

    Fold at x = -b2/2, b1 = b2^2/4; Hopf at x = 0, b1 = 0 where b2 < 0, omega = sqrt(-b2),
    l1 = s / (2 omega^3 (1 + omega^2)); Bogdanov-Takens at b1 = b2 = 0. For b2 > 0 x = 0 is a neutral saddle.
    """

    def rhs(x: Any, p: Any) -> Any:
        return x.y, p.b1 + p.b2 * x.x + x.x**2 + p.s * x.x * x.y

    answers = [Answer("fold", {"b1": b2**2 / 4.0})]
    curves = []
    window = {"b2": (-2.0, 2.5), "b1": (-1.0, 1.3)}
    double = (Answer("bt", {"b1": 0.0, "b2": 0.0}),)
    if b2 < 0:
        w = sqrt(-b2)
        answers.insert(0, Answer("hopf", {"b1": 0.0}, w, s / (2.0 * w**3 * (1.0 + w**2))))
        curves.append(KnownCurve("hopf", ("b2", "b1"), window, double))
    curves.append(KnownCurve("fold", ("b2", "b1"), window, double))
    # the equilibrium x = -3/2, on the Hopf point's side where b2 < 0
    system = System(rhs, ("x", "y"), {"b1": 1.5 * b2 - 2.25, "b2": b2, "s": s})
    return Known(system, "b1", (-1.5, 0.0), (-8.0, 1.3), tuple(answers), tuple(curves))


def zero_hopf(b2: float = 0.5, theta: float = 1.0, s: float = -1.0, omega: float = 3.0) -> Known:
    """x' = b1 + x^2 + s |w|^2, w' = (b2 + theta x + x^2 + i omega) w (after Kuznetsov, sec. 8.5).

    With w = 0: fold at x = b1 = 0; Hopf where b2 = -theta x - x^2, b1 = -x^2, l1 = -s (theta + 2 x) / (omega x);
    zero-Hopf at b1 = b2 = 0, generalised Hopf at x = -theta / 2.
    """

    def rhs(x: Any, p: Any) -> Any:
        growth = p.b2 + p.theta * x.x + x.x**2
        return (
            p.b1 + x.x**2 + p.s * (x.y**2 + x.z**2),
            growth * x.y - p.omega * x.z,
            p.omega * x.y + growth * x.z,
        )

    answers = [(0.0, Answer("fold", {"b1": 0.0}))]
    if theta**2 > 4.0 * b2:
        for sign in (1.0, -1.0):
            x = 0.5 * (-theta + sign * sqrt(theta**2 - 4.0 * b2))
            # the other root, without cancellation
            x = b2 / (0.5 * (-theta - sqrt(theta**2 - 4.0 * b2))) if sign > 0 and theta > 0 else x
            answers.append((x, Answer("hopf", {"b1": -(x**2)}, omega, -s * (theta + 2.0 * x) / (omega * x))))
    answers.sort(key=lambda pair: pair[0])
    window = {"b2": (-2.0, 2.0), "b1": (-4.0, 3.0)}
    double = Answer("zh", {"b1": 0.0, "b2": 0.0}, omega)
    general = Answer("gh", {"b1": -(theta**2) / 4.0, "b2": theta**2 / 4.0}, omega, 0.0)
    curves = (
        KnownCurve("fold", ("b2", "b1"), window, (double,)),
        KnownCurve("hopf", ("b2", "b1"), window, (general, double)),
    )
    system = System(rhs, ("x", "y", "z"), {"b1": -2.25, "b2": b2, "theta": theta, "s": s, "omega": omega})
    return Known(
        system,
        "b1",
        (-1.5, 0.0, 0.0),
        (-4.0, 1.0),
        tuple(answer for _, answer in answers),
        curves if len(answers) > 1 else curves[:1],
    )


def fold_beside_hopf(distance: float = 1e-4) -> Known:
    """`zero_hopf` with a Hopf point at b1 = -distance, beside the fold at b1 = 0."""
    x = -sqrt(distance)
    return zero_hopf(b2=-x - x**2)


def hopf_hopf(first: float = 1.0, second: float = 2.3) -> Known:
    """w1' = (m1 + i first) w1 - w1 (|w1|^2 + 2 |w2|^2), w2' = (m2 + i second) w2 - w2 (3 |w1|^2 + |w2|^2).

    Kuznetsov, sec. 8.6. Hopf curves m1 = 0 (omega = first) and m2 = 0 (omega = second); Hopf-Hopf at both.
    """

    def rhs(x: Any, p: Any) -> Any:
        a, b = x.a**2 + x.b**2, x.c**2 + x.d**2
        g1, g2 = p.m1 - a - 2 * b, p.m2 - 3 * a - b
        return (
            g1 * x.a - p.w1 * x.b,
            p.w1 * x.a + g1 * x.b,
            g2 * x.c - p.w2 * x.d,
            p.w2 * x.c + g2 * x.d,
        )

    system = System(rhs, ("a", "b", "c", "d"), {"m1": -0.5, "m2": -0.3, "w1": first, "w2": second})
    curve = KnownCurve(
        "hopf",
        ("m2", "m1"),
        {"m2": (-1.0, 1.5), "m1": (-1.0, 1.0)},
        (Answer("hh", {"m1": 0.0, "m2": 0.0}, (first, second)),),
    )
    point = Answer("hopf", {"m1": 0.0}, first, -2.0 / first)
    return Known(system, "m1", (0.0,) * 4, (-1.0, 1.5), (point,), (curve,))


def two_oscillators(distance: float = 1e-3, first: float = 1.0, second: float = 2.3) -> Known:
    """Two uncoupled Hopf normal forms that cross at mu = 0 and mu = distance."""
    base = hopf_hopf(first, second).system.rhs

    def rhs(x: Any, p: Any) -> Any:
        return base(x, _With(p, m1=p.mu, m2=p.mu - p.distance))

    system = System(rhs, ("a", "b", "c", "d"), {"mu": -0.5, "distance": distance, "w1": first, "w2": second})
    answers = (
        Answer("hopf", {"mu": 0.0}, first, -2.0 / first),
        Answer("hopf", {"mu": distance}, second, -2.0 / second),
    )
    return Known(system, "mu", (0.0,) * 4, (-1.0, 1.5), answers)


class _With:
    """Parameters with some replaced."""

    def __init__(self, p: Any, **changes: Any) -> None:
        self._p, self._changes = p, changes

    def __getattr__(self, name: str) -> Any:
        return self._changes[name] if name in self._changes else getattr(self._p, name)


def double_crossing(distance: float = 1e-3, centre: float = 0.1234) -> Known:
    """z' = ((mu - centre)^2 - distance^2 / 4 + i) z - z |z|^2: one pair crosses and comes back."""

    def rhs(x: Any, p: Any) -> Any:
        growth = (p.mu - p.centre) ** 2 - 0.25 * p.distance**2 - x.x**2 - x.y**2
        return growth * x.x - x.y, x.x + growth * x.y

    system = System(rhs, ("x", "y"), {"mu": -0.5, "centre": centre, "distance": distance})
    answers = tuple(Answer("hopf", {"mu": centre + sign * distance / 2.0}, 1.0, -2.0) for sign in (-1.0, 1.0))
    return Known(system, "mu", (0.0, 0.0), (-1.0, 1.5), answers)


def transcritical() -> Known:
    """x' = mu x - x^2: branches x = 0 and x = mu cross at mu = 0."""
    system = System(lambda x, p: [p.mu * x.x - x.x**2], ("x",), {"mu": -0.7})
    return Known(system, "mu", (0.0,), (-1.0, 1.5), (Answer("bp", {"mu": 0.0}),))


def pitchfork() -> Known:
    """x' = mu x - x^3: branches x = 0 and mu = x^2 cross at mu = 0."""
    system = System(lambda x, p: [p.mu * x.x - x.x**3], ("x",), {"mu": -0.7})
    return Known(system, "mu", (0.0,), (-1.0, 1.5), (Answer("bp", {"mu": 0.0}),))


def lorenz(sigma: float = 10.0, beta: float = 8.0 / 3.0) -> Known:
    """x' = sigma (y - x), y' = rho x - y - x z, z' = x y - beta z (Lorenz 1963).

    Pitchfork of the origin at rho = 1. On the other branch, x^2 = beta (rho - 1), the characteristic polynomial is
    s^3 + (sigma + beta + 1) s^2 + beta (rho + sigma) s + 2 sigma beta (rho - 1): Hopf at
    rho = sigma (sigma + beta + 3) / (sigma - beta - 1), omega^2 = beta (rho + sigma); subcritical (l1 > 0).
    """

    def rhs(x: Any, p: Any) -> Any:
        return p.sigma * (x.y - x.x), p.rho * x.x - x.y - x.x * x.z, x.x * x.y - p.beta * x.z

    rho = sigma * (sigma + beta + 3.0) / (sigma - beta - 1.0)
    start = 0.75 * rho
    x = sqrt(beta * (start - 1.0))
    system = System(rhs, ("x", "y", "z"), {"sigma": sigma, "beta": beta, "rho": start})
    curve = KnownCurve("hopf", ("sigma", "rho"), {"sigma": (8.0, 30.0), "rho": (1.5, 80.0)}, ())
    # the branch runs through the pitchfork to the mirrored Hopf point
    answers = (
        Answer("hopf", {"rho": rho}, sqrt(beta * (rho + sigma))),
        Answer("bp", {"rho": 1.0}),
        Answer("hopf", {"rho": rho}, sqrt(beta * (rho + sigma))),
    )
    return Known(system, "rho", (x, x, start - 1.0), (0.2, 1.3 * rho), answers, (curve,))


def closed_loop() -> Known:
    """x' = x^2 + p^2 - 1: the equilibria are a circle, with folds at p = -1 and p = 1."""
    system = System(lambda x, p: [x.x**2 + p.p**2 - 1.0], ("x",), {"p": 0.0})
    return Known(system, "p", (1.0,), (-3.0, 3.0), (Answer("fold", {"p": 1.0}), Answer("fold", {"p": -1.0})))


def stiff() -> Known:
    """The Hopf normal form (omega = 2, c = -1) that drives x^2 into lags of rates 1e-3, 1, 1e3 and 1e6."""
    base, rates = hopf().system, (1e-3, 1.0, 1e3, 1e6)

    def rhs(x: Any, p: Any) -> Any:
        lags = [rate * (x.x**2 - x[f"lag{k}"]) for k, rate in enumerate(rates)]
        return (*base.rhs(x, p), *lags)

    names = ("x", "y", *(f"lag{k}" for k in range(len(rates))))
    system = System(rhs, names, dict(base.parameters))
    return Known(system, "mu", (0.0,) * 6, (-1.0, 1.5), (Answer("hopf", {"mu": 0.0}, 2.0, -1.0),))


def scaled() -> Known:
    """`brusselator` (a = 1) with x counted in 1e-5, y in 1e5 and b in 1e-5: Hopf at b = 2e-5, omega = 1."""

    def rhs(x: Any, p: Any) -> Any:
        u, v, b = x.x * 1e-5, x.y * 1e5, p.b * 1e5
        return (1.0 - (b + 1) * u + u**2 * v) * 1e5, (b * u - u**2 * v) * 1e-5

    system = System(rhs, ("x", "y"), {"b": 0.5e-5})
    return Known(system, "b", (1e5, 0.5e-5), (0.2e-5, 5e-5), (Answer("hopf", {"b": 2e-5}, 1.0),))


def neutral_saddle() -> Known:
    """x' = (1 + mu) x, y' = -y + mu: eigenvalues 1 + mu and -1 add to zero at mu = 0, which is nothing special."""
    system = System(lambda x, p: [(1 + p.mu) * x.x, -x.y + p.mu], ("x", "y"), {"mu": -0.5})
    return Known(system, "mu", (0.0, -0.5), (-0.9, 1.5), ())


def predator_prey(death: float = 0.5, prey: float = 0.6) -> Known:
    """x' = x (1 - x/k) - a x y / (1 + x), y' = -d y + a x y / (1 + x) (Rosenzweig & MacArthur 1963).

    With a such that the prey alone is X at coexistence, a = d (1 + X) / X: coexistence meets y = 0 at k = X
    (branch point); Hopf at k = 1 + 2 X, omega = sqrt(d / k), l1 = -sqrt(d k) / ((1 + X) (1 + d + 2 d X)).
    """

    def rhs(x: Any, p: Any) -> Any:
        eaten = p.a * x.x * x.y / (1 + x.x)
        return x.x * (1 - x.x / p.k) - eaten, eaten - p.d * x.y

    a = death * (1.0 + prey) / prey
    k = 1.0 + 2.0 * prey
    start = 0.5 * (prey + k)
    y = (1.0 - prey / start) * (1.0 + prey) / a
    l1 = -sqrt(death * k) / ((1.0 + prey) * (1.0 + death + 2.0 * death * prey))
    system = System(rhs, ("x", "y"), {"a": a, "d": death, "k": start})
    answers = (Answer("bp", {"k": prey}), Answer("hopf", {"k": k}, sqrt(death / k), l1))
    curve = KnownCurve("hopf", ("d", "k"), {"d": (0.1, 0.7), "k": (1.0, 8.0)}, ())
    return Known(system, "k", (prey, y), (0.4 * prey, 2.0 * k), answers, (curve,))


def everything() -> dict[str, Known]:
    """All systems of the zoo, by name."""
    return {
        "brusselator": brusselator(),
        "brusselator 0.5": brusselator(0.5),
        "cusp": cusp(),
        "close folds 1e-2": close_folds(1e-2),
        "close folds 1e-3": close_folds(1e-3),
        "hopf": hopf(),
        "hard hopf": hopf(0.7, 0.3),
        "bautin": bautin(),
        "bogdanov-takens": bogdanov_takens(),
        "hard bogdanov-takens": bogdanov_takens(-0.6, 1.0),
        "neutral saddle beside a fold": bogdanov_takens(1.0),
        "zero-hopf": zero_hopf(0.2),
        "zero-hopf b2 < 0": zero_hopf(-0.4),
        "fold beside hopf 1e-4": fold_beside_hopf(),
        "fold beside hopf 1e-6": fold_beside_hopf(1e-6),
        "hopf-hopf": hopf_hopf(),
        "hopf-hopf near 1:1": hopf_hopf(1.0, 1.001),
        "two oscillators 1e-3": two_oscillators(1e-3),
        "two oscillators 1e-6": two_oscillators(1e-6),
        "two oscillators 1e-6 near 1:1": two_oscillators(1e-6, 1.0, 1.001),
        "double crossing 1e-3": double_crossing(1e-3),
        "double crossing 1e-6": double_crossing(1e-6),
        "transcritical": transcritical(),
        "pitchfork": pitchfork(),
        "lorenz": lorenz(),
        "closed loop": closed_loop(),
        "stiff": stiff(),
        "scaled": scaled(),
        "neutral saddle": neutral_saddle(),
        "predator-prey": predator_prey(),
    }
