"""The wind that meets the cable section."""

from dataclasses import dataclass
from math import pi

from rainwind.physics.checks import finite_number, not_negative, positive, radians_between


@dataclass(frozen=True)
class Wind:
    """The undisturbed wind, the same over the whole section; its speeds may also be given as functions of time.

    speed: horizontal speed U in m/s, above 0 (test still air with density 0). yaw: gamma in rad, -pi to pi;
    0 is across the cable's vertical plane, above 0 the cable descends downwind. density: rho in kg/m³.
    vertical_speed: w in m/s, positive upwards: a gust's or turbulence's, or that of wind over a slope.
    Raises InputError. Source: Peil & Nahrath (2003), figs. 2 and 3; rho is not printed there, w is ours.
    """

    speed: float
    yaw: float = 0.0
    density: float = 1.225
    vertical_speed: float = 0.0

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "speed", positive("wind.speed", self.speed, "for still air set wind.density = 0"))
        set_(self, "yaw", radians_between("wind.yaw", self.yaw, -pi, pi))
        set_(self, "density", not_negative("wind.density", self.density, "0 means still air"))
        set_(self, "vertical_speed", finite_number("wind.vertical_speed", self.vertical_speed))
