"""What the targets ask of the upper rivulet: its fold, where D is unstable, how much damping stops it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import cos, pi
from typing import Any

import numpy as np

from rainwind.dynamics.curves import continue_hopf
from rainwind.dynamics.equilibria import continue_equilibria, find_equilibria
from rainwind.dynamics.results import Branch, Equilibrium, SpecialPoint
from rainwind.studies.walks import whole

SPEEDS = (2.0, 30.0)  # m/s
RATIOS = (5e-5, 0.05)
_SEARCH = np.arange(3.0, 30.0, 0.5)


@dataclass(frozen=True)
class UpperRivulet:
    """The branch of C and D, joined at its fold; all speeds in m/s.

    on_c, on_d: Hopf points on either side of the fold. unstable: wind speeds between which D is unstable, an
    upper end at the window's edge counting as open.
    """

    branch: Branch
    fold: SpecialPoint
    on_c: tuple[SpecialPoint, ...]
    on_d: tuple[SpecialPoint, ...]
    c: np.ndarray  # the branch's points on C and on D, from the fold on
    d: np.ndarray
    unstable: tuple[tuple[float, float], ...]

    @property
    def onset(self) -> float | None:
        """The lowest wind speed at which D is unstable."""
        return self.unstable[0][0] if self.unstable else None

    @property
    def end(self) -> float | None:
        """The wind speed above which D is stable; None where D is never unstable or no end was found."""
        open_ended = not self.unstable or self.unstable[-1][1] > SPEEDS[1] - 0.1
        return None if open_ended else self.unstable[-1][1]

    def angle(self, speed: float, *, on_c: bool = False) -> float:
        """phi of D, or of C, in rad at a wind speed."""
        side = self.c if on_c else self.d
        along, phi = self.branch["wind.speed"][side], self.branch["phi"][side]
        order = np.argsort(along)
        return float(np.interp(speed, along[order], phi[order]))


def lower_and_upper(found: Sequence[Equilibrium], beta: float) -> tuple[list[Equilibrium], list[Equilibrium]]:
    """A, which hangs lowest and below the cable's middle, if there is such a one; and the others by phi."""
    by_height = sorted(found, key=lambda e: cos(e["phi"] + beta))
    lower = [e for e in by_height[:1] if cos(e["phi"] + beta) < 0]
    return lower, sorted(by_height[len(lower) :], key=_phi)


def upper_rivulet(model: Any, *, ratio: float | None = None) -> UpperRivulet | None:
    """The branch of C and D at a damping ratio (default: the model's own); None where no fold was found."""
    if ratio is not None:
        model = model.with_parameters({"section.damping_ratio": ratio})
    for speed in _SEARCH:
        at = model.with_parameters({"wind.speed": float(speed)})
        _, above = lower_and_upper(find_equilibria(at), at.beta)
        if len(above) > 2:  # B, D, C in the order of phi
            branch = whole(continue_equilibria(at, "wind.speed", start=above[1], until=SPEEDS))
            return _read(branch) if branch.points("fold") else None
    return None


@dataclass(frozen=True)
class DampingLimits:
    """Damping ratios of D's Hopf curves; None where there is none below 5 %.

    critical: above it D is stable at every wind speed (at `speed`, m/s, it last was not). leaves: where the
    Hopf curve leaves the fold; below it D is born unstable.
    """

    critical: float | None
    speed: float | None
    leaves: float | None


@lru_cache(maxsize=64)
def damping_limits(model: Any) -> DampingLimits:
    """From the tops of the Hopf curves through D's Hopf points, and from their fold-Hopf points."""
    critical: float | None = None
    speed: float | None = None
    leaves: list[float] = []
    for curve, fold_angle in hopf_curves(model):
        ratio = np.where(curve["phi"] < fold_angle, curve["section.damping_ratio"], 0.0)
        top = int(np.argmax(ratio))
        if 0 < top < len(curve) - 1 and (critical is None or _peak(curve, top) > critical):
            critical, speed = _peak(curve, top), float(curve["wind.speed"][top])
        leaves += [p.parameters["section.damping_ratio"] for p in curve.points("zh")]
    return DampingLimits(critical, speed, max(leaves, default=None))


def hopf_curves(model: Any) -> list[tuple[Branch, float]]:
    """The Hopf curves in wind speed and damping through the Hopf points of D, each with the fold's phi."""
    ratio = model.parameters["section.damping_ratio"]
    upper = upper_rivulet(model)
    while upper is not None and not upper.on_d and ratio > 2 * RATIOS[0]:
        ratio /= 2  # the model is above its critical damping
        upper = upper_rivulet(model, ratio=ratio)
    if upper is None:
        return []
    until = {"wind.speed": SPEEDS, "section.damping_ratio": RATIOS}
    along = ("wind.speed", "section.damping_ratio")
    fold = upper.fold["phi"]
    # the large window counts as 20 units of arclength: the curve's top needs shorter steps
    return [(whole(continue_hopf(model, along, start=p, until=until, ds=0.02)), fold) for p in upper.on_d]


def _read(branch: Branch) -> UpperRivulet:
    fold = min(branch.points("fold"), key=lambda p: p.parameter)
    s = branch.arclength
    side = 1.0 if np.interp(fold.arclength + 0.05, s, branch["phi"]) < fold["phi"] else -1.0
    beyond = [p for p in branch.points("fold") if side * (p.arclength - fold.arclength) > 0]
    last = min((side * (p.arclength - fold.arclength) for p in beyond), default=np.inf)
    away = side * (s - fold.arclength)
    d = np.flatnonzero((away > 0) & (away < last))[:: int(side)]
    c = np.flatnonzero(away < 0)[:: -int(side)]

    def on(point: SpecialPoint) -> float:
        return side * (point.arclength - fold.arclength)

    hopf = branch.points("hopf")
    on_d = tuple(sorted((p for p in hopf if 0 < on(p) < last), key=on))
    on_c = tuple(p for p in hopf if on(p) < 0)
    cuts = [(0.0, fold.parameter), *((on(p), p.parameter) for p in on_d), (last, branch.parameter[d[-1]])]
    unstable: list[tuple[float, float]] = []
    for (low, start), (high, stop) in pairwise(cuts):
        inside = d[(away[d] > low) & (away[d] < high)]
        if inside.size and np.median(branch.unstable[inside]) > 0:
            if unstable and unstable[-1][1] == start:
                start = unstable.pop()[0]
            unstable.append((float(start), float(stop)))
    return UpperRivulet(branch, fold, on_c, on_d, c, d, tuple(unstable))


def _peak(curve: Branch, top: int) -> float:
    """The largest damping by a parabola through the points about number `top`."""
    s = curve.arclength[top - 1 : top + 2] - curve.arclength[top]
    a, b, c = np.polyfit(s, curve["section.damping_ratio"][top - 1 : top + 2], 2)
    return float(c - b * b / (4 * a)) if a < 0 else float(curve["section.damping_ratio"][top])


def _phi(point: Equilibrium) -> float:
    return (point["phi"] + pi) % (2 * pi) - pi
