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

__all__ = ["RIVULET_SCATTER", "SIZE", "Scatter", "factors_at", "sample_factors", "usual_rivulet"]

HEIGHT = 0.1
"""Of the diameter: that of the rivulets to which the coefficient sets belong (Peil & Nahrath 2003, read)."""
MASS, FRICTION, AT_DIAMETER = 0.2, 0.05, 0.1
"""kg/m and Nms/m at a diameter of 0.1 m: Peil & Nahrath (2003), section 3 (read); nobody measured the friction."""
SIZE = "size exponent"
"""Name of e among the samples: the mass goes with the diameter to the power e."""

_NORMAL_95 = float(norm.ppf(0.95))
_LEAST_SLOPE = 0.1
_MOST_SAMPLES = 2**16


def usual_rivulet(diameter: float) -> Rivulet:
    """The rivulet of a stay of this outer diameter, m; at 0.1 m that of Peil & Nahrath (2003), section 3.

    Height 0.1 d, mass 2 kg/m² times d, friction 0.05 (d / 0.1 m)^2.5 Nms/m. The mass lies between a rivulet of one size
    on every stay (d^0) and one in proportion to it (d²); the friction goes with the width of the contact, so with the
    root of the mass, and with the lever squared. Raises InputError. Source: our judgement; docs/rivulets.md.
    """
    d = positive("diameter", diameter, "in m")
    ratio = d / AT_DIAMETER
    return Rivulet(MASS * ratio, HEIGHT * d, FRICTION * ratio**2.5)


@dataclass(frozen=True)
class Scatter:
    """How widely rivulet and coefficients scatter about their usual values. Raises InputError.

    mass, friction: standard deviation of the logarithm; lift, drag, moment: standard deviation of the factor on the
    curve's slope; size: half the width of the uniform distribution of e about 1. 0: not at all.
    """

    mass: float
    friction: float
    lift: float
    drag: float
    moment: float
    size: float

    def __post_init__(self) -> None:
        for name in ("mass", "friction", "lift", "drag", "moment", "size"):
            value = not_negative(f"scatter.{name}", getattr(self, name))
            if value > 2.0:
                raise InputError(f"scatter.{name} = {value:g} is too wide; allowed is 0 to 2, 0.2 means 20 %")
            object.__setattr__(self, name, value)


RIVULET_SCATTER = Scatter(
    mass=log(2.0) / _NORMAL_95, friction=log(3.0) / _NORMAL_95, lift=0.2, drag=0.2, moment=0.2, size=1.0
)
"""At one diameter 90 % of all masses within a factor of 2, of all frictions within 3, slopes by 20 %; e from 0 to 2: an
engineer's judgement."""


def sample_factors(scatter: Scatter, count: int, seed: int) -> Mapping[str, np.ndarray]:
    """Factors (count,) on a rivulet's mass, its friction and the slopes of lift, drag and moment, and `SIZE`; by name.

    A Latin hypercube: each quantity is spread evenly over its own distribution, log-normal for mass and friction with
    the median 1, normal about 1 for slopes, which are never below 0.1, uniform for the size exponent. The same seed
    gives the same samples. `factors_at` makes of them the factors for one diameter. Raises InputError.
    """
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= _MOST_SAMPLES:
        raise InputError(f"count = {count!r} must be a whole number from 1 to {_MOST_SAMPLES}")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"seed = {seed!r} must be a whole number of 0 or more")
    uniform = qmc.LatinHypercube(6, rng=np.random.default_rng(seed)).random(count)
    mass, friction, *slopes = norm.ppf(uniform[:, :5]).T
    found = {
        "rivulet.mass": np.exp(scatter.mass * mass),
        "rivulet.friction": np.exp(scatter.friction * friction),
    }
    for name, wide, z in zip(
        (LIFT, DRAG, MOMENT), (scatter.lift, scatter.drag, scatter.moment), slopes, strict=True
    ):
        found[name] = np.maximum(1.0 + wide * z, _LEAST_SLOPE)
    found[SIZE] = 1.0 + scatter.size * (2.0 * uniform[:, 5] - 1.0)
    return MappingProxyType(found)


def factors_at(samples: Mapping[str, np.ndarray], diameter: float | None) -> dict[str, np.ndarray]:
    """The factors on the usual rivulet of a stay of this diameter, m; None: on a rivulet that is given, of any size."""
    found = {name: values for name, values in samples.items() if name != SIZE}
    if diameter is not None and SIZE in samples:
        spread = (positive("diameter", diameter, "in m") / AT_DIAMETER) ** (samples[SIZE] - 1.0)
        found["rivulet.mass"] = found["rivulet.mass"] * spread
        found["rivulet.friction"] = found["rivulet.friction"] * np.sqrt(spread)
    return found
