"""The rivulet of a real stay, which nobody has weighed: a rule for the diameter, and how wide the truth may scatter.

docs/rivulets.md gives the reasoning.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import log
from types import MappingProxyType

import numpy as np
from scipy.stats import norm, qmc

from rainwind.errors import InputError
from rainwind.physics.checks import not_negative, positive
from rainwind.physics.rivulet import Rivulet
from rainwind.physics.tilted import DRAG, LIFT, MOMENT

__all__ = ["RIVULET_SCATTER", "Scatter", "sample_factors", "usual_rivulet"]

HEIGHT = 0.1
"""Of the diameter: that of the rivulets to which the coefficient sets belong (Peil & Nahrath 2003, read)."""
AREA = 2.0
"""Section area over height squared: 2.0 and 2.2 for the two rivulets of Peil & Nahrath (2003) (read)."""
WATER = 1000.0
"""kg/m³."""
FRICTION, AT_DIAMETER = 0.05, 0.1
"""Nms/m at a diameter of 0.1 m: Peil & Nahrath (2003), section 3 (read); nobody measured it."""

_NORMAL_95 = float(norm.ppf(0.95))
_LEAST_SLOPE = 0.1
_MOST_SAMPLES = 2**16


def usual_rivulet(diameter: float) -> Rivulet:
    """The rivulet of a stay of this outer diameter, m: similar to that of Peil & Nahrath (2003), section 3.

    height 0.1 d, mass 1000 kg/m³ times 2 h², friction 0.05 (d / 0.1 m)³ Nms/m: the width of its contact grows with d,
    the lever squared with d², the film below it keeps its thickness. The wind speed at which the upper rivulet begins
    to exist then grows with sqrt(d), at one Froude number, as Lemaitre et al. (2006) found (abstract read).
    Raises InputError. Source: our judgement.
    """
    d = positive("diameter", diameter, "in m")
    height = HEIGHT * d
    return Rivulet(WATER * AREA * height**2, height, FRICTION * (d / AT_DIAMETER) ** 3)


@dataclass(frozen=True)
class Scatter:
    """How widely rivulet and coefficients scatter about their usual values. Raises InputError.

    mass, friction: standard deviation of the logarithm; lift, drag, moment: standard deviation of the factor on the
    curve's slope. 0: not at all.
    """

    mass: float
    friction: float
    lift: float
    drag: float
    moment: float

    def __post_init__(self) -> None:
        for name in ("mass", "friction", "lift", "drag", "moment"):
            value = not_negative(f"scatter.{name}", getattr(self, name))
            if value > 2.0:
                raise InputError(f"scatter.{name} = {value:g} is too wide; allowed is 0 to 2, 0.2 means 20 %")
            object.__setattr__(self, name, value)


RIVULET_SCATTER = Scatter(
    mass=log(2.0) / _NORMAL_95, friction=log(3.0) / _NORMAL_95, lift=0.2, drag=0.2, moment=0.2
)
"""90 % of all masses within a factor of 2, of all frictions within 3, slopes by 20 %: an engineer's judgement."""


def sample_factors(scatter: Scatter, count: int, seed: int) -> Mapping[str, np.ndarray]:
    """Factors (count,) on a rivulet's mass and friction and on the slopes of lift, drag and moment, by name.

    A Latin hypercube: each quantity is spread evenly over its own distribution, log-normal for mass and friction with
    the median 1, normal about 1 for slopes, which are never below 0.1. The same seed gives the same samples.
    Raises InputError.
    """
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= _MOST_SAMPLES:
        raise InputError(f"count = {count!r} must be a whole number from 1 to {_MOST_SAMPLES}")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"seed = {seed!r} must be a whole number of 0 or more")
    uniform = qmc.LatinHypercube(5, rng=np.random.default_rng(seed)).random(count)
    mass, friction, *slopes = norm.ppf(uniform).T
    found = {
        "rivulet.mass": np.exp(scatter.mass * mass),
        "rivulet.friction": np.exp(scatter.friction * friction),
    }
    for name, wide, z in zip(
        (LIFT, DRAG, MOMENT), (scatter.lift, scatter.drag, scatter.moment), slopes, strict=True
    ):
        found[name] = np.maximum(1.0 + wide * z, _LEAST_SLOPE)
    return MappingProxyType(found)
