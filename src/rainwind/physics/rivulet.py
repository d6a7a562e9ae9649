"""The water rivulet that slides round the cable."""

from dataclasses import dataclass

from rainwind.physics.checks import not_negative, positive


@dataclass(frozen=True)
class Rivulet:
    """One rivulet; the defaults are the sample case of Peil & Nahrath (2003), section 3.

    mass m_R (kg per metre of cable), height h (m), friction d_phi on the cable's surface (Nms per metre of
    cable and rad). Its centre runs on the radius r = (d + h) / 2. Raises InputError.
    """

    mass: float = 0.2
    height: float = 0.01
    friction: float = 0.05

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "mass", positive("rivulet.mass", self.mass, "a cable without rivulet is another model"))
        set_(self, "height", not_negative("rivulet.height", self.height))
        set_(self, "friction", not_negative("rivulet.friction", self.friction))
