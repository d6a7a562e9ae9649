"""The dry cable section: one metre of cable on nonlinear springs and viscous dampers."""

from dataclasses import dataclass
from math import pi
from typing import Any

from rainwind.errors import InputError
from rainwind.physics.checks import finite_number, not_negative, positive, radians_between
from rainwind.physics.convexity import least_slope, need_one_rest_position

OPTIONAL = ("damping_ratio_y", "damping_ratio_z", "k3", "sag_offset")
"""Fields of a section that are None where they are not given, and then no parameters."""


def stiffness(mass: Any, frequency: Any) -> Any:
    """k = m_S (2 pi f)² in N/m per metre of cable: the bare cable's, without rivulet."""
    return mass * (2 * pi * frequency) * (2 * pi * frequency)


def damping(mass: Any, frequency: Any, ratio: Any) -> Any:
    """d = 2 xi m_S (2 pi f) in Ns/m per metre of cable: the bare cable's, without rivulet."""
    return 2 * ratio * mass * (2 * pi * frequency)


@dataclass(frozen=True)
class CableSection:
    """One metre of cable; the defaults are the sample case of Peil & Nahrath (2003), section 3.

    diameter (m), mass (kg/m), frequency_y and frequency_z (Hz), damping_ratio (1 = critical),
    damping_ratio_y and damping_ratio_z (None: follow damping_ratio), inclination delta (rad, 0 to pi/2),
    k2_y, k2_z (N/m³) and k3_y, k3_z (N/m⁴): springs k q + k2 q² + k3 q³ per metre of cable.
    k3 (N/m⁴) and sag_offset s (m): the spring of a string, k3 (s v + (y² + z²)/2)² in J per metre of cable, v in the
    cable's vertical plane, positive down (None: there is none; s None: 0). With it k3 >= 0, and k3 s² must stay
    below the least stiffness of y and z: the cable may not snap through.
    The damping ratio is 0.2 % (printed: 2 %, a misprint by section 5). Raises InputError.
    """

    diameter: float = 0.1
    mass: float = 50.0
    frequency_y: float = 1.0
    frequency_z: float = 1.0
    damping_ratio: float = 0.002
    damping_ratio_y: float | None = None
    damping_ratio_z: float | None = None
    inclination: float = pi / 4
    k2_y: float = 0.0077
    k3_y: float = 0.00115
    k2_z: float = 0.0
    k3_z: float = 0.00115
    k3: float | None = None
    sag_offset: float | None = None

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        for name in ("diameter", "mass", "frequency_y", "frequency_z"):
            set_(self, name, positive(f"section.{name}", getattr(self, name)))
        for name in ("damping_ratio", "damping_ratio_y", "damping_ratio_z"):
            if name == "damping_ratio" or getattr(self, name) is not None:
                set_(self, name, not_negative(f"section.{name}", getattr(self, name), "1 means critical"))
        set_(self, "inclination", radians_between("section.inclination", self.inclination, 0.0, pi / 2))
        for name in ("k2_y", "k3_y", "k2_z", "k3_z"):
            set_(self, name, finite_number(f"section.{name}", getattr(self, name)))
        for name in ("k3", "sag_offset"):
            if getattr(self, name) is not None:
                set_(self, name, not_negative(f"section.{name}", getattr(self, name)))
        if self.k3 is not None:
            slope_y = least_slope(self.stiffness_y, self.k2_y, self.k3_y)
            slope_z = least_slope(self.stiffness_z, self.k2_z, self.k3_z)
            need_one_rest_position(self.k3, self.sag_offset or 0.0, slope_y, slope_z)
        elif self.sag_offset is not None:
            raise InputError(
                f"section.sag_offset = {self.sag_offset:g} acts through section.k3, which is not given; give "
                "section.k3, or leave section.sag_offset out"
            )

    @property
    def stiffness_y(self) -> float:
        """k_y = m_S (2 pi f_y)², N/m per metre."""
        return stiffness(self.mass, self.frequency_y)

    @property
    def stiffness_z(self) -> float:
        """k_z = m_S (2 pi f_z)², N/m per metre."""
        return stiffness(self.mass, self.frequency_z)

    @property
    def damping_y(self) -> float:
        """d_y = 2 xi_y m_S (2 pi f_y), Ns/m per metre."""
        ratio = self.damping_ratio if self.damping_ratio_y is None else self.damping_ratio_y
        return damping(self.mass, self.frequency_y, ratio)

    @property
    def damping_z(self) -> float:
        """d_z = 2 xi_z m_S (2 pi f_z), Ns/m per metre."""
        ratio = self.damping_ratio if self.damping_ratio_z is None else self.damping_ratio_z
        return damping(self.mass, self.frequency_z, ratio)
