"""Small systems with cycles known exactly, with all their bifurcations, to test the numerics against.

Nothing here comes from a collocation: every orbit is a circle, a harmonic or an elliptic function, van der Pol's a
Taylor series.
"""

from rainwind.dynamics.cycle_zoo import driven, planar, suspended, twisted, van_der_pol
from rainwind.dynamics.cycle_zoo.known import (
    Cycle,
    CycleAnswer,
    KnownCurve,
    KnownCycles,
    Named,
    disguised,
)

__all__ = [
    "Cycle",
    "CycleAnswer",
    "KnownCurve",
    "KnownCycles",
    "Named",
    "disguised",
    "driven",
    "everything",
    "planar",
    "suspended",
    "twisted",
    "van_der_pol",
]  # fmt: skip


def everything() -> dict[str, KnownCycles]:
    """All systems of the zoo, by name."""
    return {
        "hopf": planar.hopf(),
        "bautin": planar.bautin(),
        "cusp from hopf": planar.cusp(),
        "isola": planar.isola(),
        "level curve": planar.level_curve(),
        "alpha loop": planar.alpha_loop(),
        "van der pol": van_der_pol.van_der_pol(),
        "van der pol, classical": van_der_pol.van_der_pol(born=False),
        "forced oscillator": driven.forced_oscillator(),
        "stiff and linear": driven.stiff(),
        "cusp": suspended.cusp(),
        "transcritical": suspended.transcritical(),
        "pitchfork": suspended.pitchfork(),
        "closed loop": suspended.closed_loop(),
        "soft neimark-sacker": suspended.neimark_sacker(),
        "hard neimark-sacker": suspended.neimark_sacker(0.7),
        "chenciner": suspended.chenciner(),
        "brusselator": suspended.brusselator(),
        "bogdanov-takens": suspended.bogdanov_takens(),
        "zero-hopf": suspended.zero_hopf(),
        "hopf-hopf": suspended.hopf_hopf(),
        "lorenz": suspended.lorenz(),
        "predator-prey": suspended.predator_prey(),
        "stiff": suspended.stiff(),
        "soft doubling": twisted.doubling(),
        "hard doubling": twisted.doubling(0.8),
        "soft doubling, flat": twisted.doubling(flat=True),
        "doubled": twisted.doubling(branch="doubled"),
        "doubled, flat": twisted.doubling(flat=True, branch="doubled"),
        "hard doubled": twisted.doubling(0.8, branch="doubled"),
        "generalised doubling": twisted.doubling(-0.7, 1.0),
        "generalised doubling, doubled": twisted.doubling(0.9, 1.0, flat=True, branch="doubled"),
        "pitchfork, one full turn": twisted.doubling(half_turns=2),
        "pitchfork, no turn": twisted.doubling(half_turns=0, flat=True),
        "crossing branch, one full turn": twisted.doubling(half_turns=2, branch="crossing"),
        "1:2, pd": twisted.strong_resonance("q"),
        "1:2, ns": twisted.strong_resonance("a"),
        "1:2, ns, flat": twisted.strong_resonance("a", flat=True),
        "1:2, doubled": twisted.strong_resonance(branch="doubled"),
        "fold-flip": twisted.fold_flip(),
        "fold-flip, pd on the lower sheet": twisted.fold_flip(0.5),
        "fold-flip, doubled": twisted.fold_flip(0.2, branch="doubled"),
        "pd with ns": twisted.doubling_and_torus("a"),
        "ns with pd": twisted.doubling_and_torus("m"),
    }
