"""A bridge as a case file describes it: its stays, the site, and what is asked."""

from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from typing import Literal, get_args

from rainwind.engineering.cable import Cable
from rainwind.errors import InputError
from rainwind.physics.checks import not_negative, one_of, positive
from rainwind.physics.rivulet import Rivulet

__all__ = ["Bridge", "ClimateSource", "Limits", "Question", "Site"]

ProfileKind = Literal["uniform", "power", "logarithmic"]


@dataclass(frozen=True)
class Site:
    """The wind at the bridge. Raises InputError.

    profile: of the mean speed over height: "uniform", "power" (exponent), "logarithmic" (roughness length in m).
    reference_height: to which every wind speed of an answer belongs, m. density: of the air, kg/m³.
    """

    profile: ProfileKind = "uniform"
    reference_height: float = 10.0
    exponent: float = 0.16
    roughness: float = 0.05
    density: float = 1.225

    def __post_init__(self) -> None:
        one_of("site.profile", self.profile, get_args(ProfileKind))
        for name in ("reference_height", "exponent", "roughness", "density"):
            object.__setattr__(self, name, positive(f"site.{name}", getattr(self, name)))
        if self.profile == "logarithmic" and self.roughness >= self.reference_height:
            raise InputError(
                f"site.roughness = {self.roughness:g} m must be less than the reference height, "
                f"{self.reference_height:g} m"
            )


@dataclass(frozen=True)
class ClimateSource:
    """Where the wind and rain records are, and how they are read. Raises InputError.

    path: a file of records or a joint table. height: of the anemometer, m. look_back: a record counts as wet if
    it rained by more than rain_threshold (mm/h) in the hours before it, s.
    """

    path: Path
    height: float = 10.0
    look_back: float = 7200.0
    rain_threshold: float = 0.01

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", Path(self.path))
        object.__setattr__(self, "height", positive("climate.height", self.height))
        object.__setattr__(self, "look_back", not_negative("climate.look_back", self.look_back))
        threshold = not_negative("climate.rain_threshold", self.rain_threshold)
        object.__setattr__(self, "rain_threshold", threshold)


@dataclass(frozen=True)
class Limits:
    """What the owner accepts. Raises InputError.

    amplitude_diameters: half peak to peak, in cable diameters (FHWA: 0.5 preferred, 1 recommended, 2 at most).
    observed_speeds: m/s, normal to the cable or not, at which rivulets have been seen (5 to 18 m/s).
    """

    amplitude_diameters: float = 0.5
    observed_speeds: tuple[float, float] = (5.0, 18.0)

    def __post_init__(self) -> None:
        amplitude = positive("limits.amplitude_diameters", self.amplitude_diameters)
        object.__setattr__(self, "amplitude_diameters", amplitude)
        low, high = self.observed_speeds
        if not 0 <= low < high < inf:
            raise InputError(
                f"limits.observed_speeds = ({low:g}, {high:g}) must be two speeds, the lower one first"
            )


@dataclass(frozen=True)
class Question:
    """How much is computed. Raises InputError.

    modes: of each stay, from the first. directions: of the wind, evenly round the compass. speeds: m/s at the
    reference height, between which a vibration is looked for. sets: of coefficients, all in one band. samples: of
    rivulet and slopes, for each set. seed: of the samples. runs: how many of them are followed in time (all,
    where that is more than there are).
    """

    modes: int = 3
    directions: int = 36
    speeds: tuple[float, float] = (3.0, 40.0)
    sets: tuple[str, ...] = ("reconstructed", "reconstructed-cubic", "reconstructed-linear")
    samples: int = 64
    seed: int = 1
    runs: int = 12

    def __post_init__(self) -> None:
        for name, low, high in (
            ("modes", 1, 20),
            ("directions", 4, 360),
            ("samples", 2, 1024),
            ("runs", 2, 1024),
            ("seed", 0, 2**31),
        ):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
                raise InputError(f"assessment.{name} = {value!r} must be a whole number from {low} to {high}")
        low, high = self.speeds
        if not 0 < low < high <= 100:
            raise InputError(
                f"assessment.speeds = ({low:g}, {high:g}) must be two speeds up to 100 m/s, the lower first"
            )
        if not self.sets:
            raise InputError("assessment.sets is empty; name one set of coefficients or more")


@dataclass(frozen=True)
class Bridge:
    """Stays of one bridge, with all that an assessment needs. Raises InputError.

    rivulet: None takes the rule for the stay's diameter (`rivulets.usual_rivulet`). assumptions, sources: sentences
    that the report repeats, each source with its status in words.
    """

    name: str
    stays: tuple[Cable, ...]
    site: Site = field(default_factory=Site)
    rivulet: Rivulet | None = None
    climate: ClimateSource | None = None
    limits: Limits = field(default_factory=Limits)
    question: Question = field(default_factory=Question)
    assumptions: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.stays:
            raise InputError("a bridge needs one stay or more")
        names = [stay.name for stay in self.stays]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise InputError(f"two stays have the name {', '.join(map(repr, twice))}; give each its own")
        observed, speeds = self.limits.observed_speeds, self.question.speeds
        if observed[0] >= speeds[1] or observed[1] <= speeds[0]:
            raise InputError(
                f"limits.observed_speeds = ({observed[0]:g}, {observed[1]:g}) lie outside assessment.speeds = "
                f"({speeds[0]:g}, {speeds[1]:g}); widen one: the damping needed is looked for where both overlap"
            )
