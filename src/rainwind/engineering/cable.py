"""A stay cable as a bridge engineer describes it, with the dampers at its ends."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isinf, pi, sqrt
from typing import Literal, get_args

from rainwind.errors import InputError
from rainwind.physics.checks import finite_number, not_negative, one_of, positive, radians_between

__all__ = ["SURFACES", "Cable", "Damper", "Surface"]

Surface = Literal["smooth", "helical fillet", "dimples"]
SURFACES: tuple[str, ...] = get_args(Surface)
End = Literal["lower", "upper"]

STRAND_STRESS = 0.40 * 1860e6
"""Pa: stays are usually stressed to 40-45 % of the strands' strength of 1860 MPa (engineer's judgement)."""
STRAND_MODULUS = 195e9
"""Pa: of prestressing strand (engineer's judgement)."""


@dataclass(frozen=True)
class Damper:
    """A viscous damper across the cable near an anchorage, in plane and out of plane alike.

    position: distance from its anchorage along the chord, m; coefficient: c in Ns/m; support_stiffness: of what it
    stands on, in series with it, N/m (infinite: rigid); end: the anchorage that it is near. Raises InputError.
    """

    position: float
    coefficient: float
    support_stiffness: float = inf
    end: End = "lower"

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "position", positive("damper.position", self.position))
        set_(self, "coefficient", positive("damper.coefficient", self.coefficient, "in Ns/m"))
        if not (isinstance(self.support_stiffness, float) and isinf(self.support_stiffness)):
            stiffness = positive(
                "damper.support_stiffness", self.support_stiffness, "leave it out for a rigid one"
            )
            set_(self, "support_stiffness", stiffness)
        one_of("damper.end", self.end, get_args(End))


@dataclass(frozen=True)
class Cable:
    """A stay between two anchorages. Raises InputError.

    length: of the chord, m. diameter: outer, m. mass: kg/m. tension: along the chord, N. inclination: of the chord
    to the horizontal, rad, 0 to pi/2. heading: the compass direction in which the stay rises, from its lower to its
    upper anchorage, rad clockwise from north. axial_stiffness: EA in N (None: estimated from the tension,
    `estimated_axial_stiffness`). bending_stiffness: EI in Nm². damping_ratios: of critical, without dampers, of modes
    1, 2, ...; the last one serves all higher modes. base_height: of the lower anchorage above the ground or water, m.
    chainage: of the lower anchorage along the bridge, m, for its picture. assumed: fields that nobody measured.
    """

    name: str
    length: float
    diameter: float
    mass: float
    tension: float
    inclination: float
    heading: float
    axial_stiffness: float | None = None
    bending_stiffness: float = 0.0
    damping_ratios: tuple[float, ...] = (0.001,)
    surface: Surface = "smooth"
    base_height: float = 10.0
    chainage: float | None = None
    dampers: tuple[Damper, ...] = ()
    assumed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError(f"cable.name = {self.name!r} must be a text that is not empty")
        for field in ("length", "diameter", "mass", "tension"):
            set_(self, field, positive(f"cable.{field}", getattr(self, field)))
        set_(self, "inclination", radians_between("cable.inclination", self.inclination, 0.0, pi / 2))
        set_(self, "heading", radians_between("cable.heading", self.heading, 0.0, 2 * pi))
        if self.axial_stiffness is not None:
            set_(self, "axial_stiffness", positive("cable.axial_stiffness", self.axial_stiffness, "EA in N"))
        set_(self, "bending_stiffness", not_negative("cable.bending_stiffness", self.bending_stiffness))
        set_(self, "base_height", not_negative("cable.base_height", self.base_height))
        if self.chainage is not None:
            set_(self, "chainage", finite_number("cable.chainage", self.chainage))
        if not isinstance(self.damping_ratios, Sequence) or not self.damping_ratios:
            raise InputError(f"cable.damping_ratios = {self.damping_ratios!r} must hold one ratio or more")
        ratios = tuple(
            not_negative("cable.damping_ratios", r, "1 means critical") for r in self.damping_ratios
        )
        if max(ratios) >= 1.0:
            raise InputError(
                f"cable.damping_ratios = {max(ratios):g} is critical damping or more; a stay has 0.1 to 2 %, "
                "0.001 to 0.02"
            )
        set_(self, "damping_ratios", ratios)
        one_of("cable.surface", self.surface, SURFACES)
        for damper in self.dampers:
            if damper.position >= self.length / 2:
                raise InputError(
                    f"a damper {damper.position:g} m from the {damper.end} anchorage of stay '{self.name}', which is "
                    f"{self.length:g} m long, lies beyond mid-span; give the distance from the nearer anchorage"
                )
        set_(self, "dampers", tuple(self.dampers))
        set_(self, "assumed", tuple(self.assumed))

    @property
    def estimated_axial_stiffness(self) -> float:
        """EA in N: as given, or that of strands stressed to `STRAND_STRESS` by the tension."""
        if self.axial_stiffness is not None:
            return self.axial_stiffness
        return STRAND_MODULUS * self.tension / STRAND_STRESS

    @property
    def wave_speed(self) -> float:
        """sqrt(T/m) in m/s."""
        return sqrt(self.tension / self.mass)

    def damping_ratio(self, mode: int) -> float:
        """Of critical, without dampers, of mode 1, 2, ..."""
        return self.damping_ratios[min(mode, len(self.damping_ratios)) - 1]
