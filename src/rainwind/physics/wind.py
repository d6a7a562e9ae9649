"""The wind that meets the cable section."""

from dataclasses import dataclass
from math import pi

from rainwind.physics.checks import not_negative, positive, radians_between


@dataclass(frozen=True)
class Wind:
    """Steady horizontal wind.

    speed: undisturbed speed U in m/s, above 0 (test still air with density 0). yaw: gamma in rad, -pi to pi;
    0 is across the cable's vertical plane, above 0 the cable descends downwind. density: rho in kg/m³.
    Raises InputError. Source: Peil & Nahrath (2003), figs. 2 and 3; rho is not printed there.
    """

    speed: float
    yaw: float = 0.0
    density: float = 1.225

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "speed", positive("wind.speed", self.speed, "for still air set wind.density = 0"))
        set_(self, "yaw", radians_between("wind.yaw", self.yaw, -pi, pi))
        set_(self, "density", not_negative("wind.density", self.density, "0 means still air"))
