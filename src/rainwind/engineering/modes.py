"""The modes of a stay: frequencies in and out of its plane, with sag and bending, and its nonlinear stiffness."""

from dataclasses import dataclass
from math import sin
from typing import Any

from rainwind.engineering.bending import (
    ENDS,
    Ends,
    bending_parameter,
    frequency,
    hyperbolic,
    mode_number,
    wave_number,
)
from rainwind.engineering.cable import Cable
from rainwind.engineering.mode_shape import ModeShape
from rainwind.engineering.nonlinear_stiffness import cubic_stiffness, sag_offset
from rainwind.engineering.sag import lambda_squared, sagging_wave_number, symmetric_parts
from rainwind.physics.checks import one_of

__all__ = ["Mode", "cable_mode", "cable_modes"]


@dataclass(frozen=True, eq=False)
class Mode:
    """One mode of a stay, without wind, water and dampers.

    number: 1, 2, ..., that of the string's mode which it becomes without sag. frequency_in, frequency_out: Hz, in
    the stay's vertical plane (with sag) and out of it. k3: N/m⁴ per metre, and sag_offset s: m, of the section's
    energy k3 (s v + (v² + w²) / 2)², with v in plane, positive down, and w out of plane. shape: in plane, a function
    of xi = x / L from the lower end, its largest value 1.
    """

    number: int
    frequency_in: float
    frequency_out: float
    k3: float
    sag_offset: float
    shape: ModeShape

    def at(self, xi: Any) -> Any:
        """The shape in plane at xi = x / L, 0 (lower end) to 1, a number or an array."""
        return self.shape(xi)


def cable_mode(cable: Cable, number: int, *, ends: Ends = "clamped") -> Mode:
    """One mode. ends: "clamped" as strands are in their anchorages, or "pinned"; without EI they are the same.

    Raises InputError.
    """
    number = mode_number(number)
    one_of("ends", ends, ENDS)
    epsilon = bending_parameter(cable)
    q_out = wave_number(number, epsilon, ends)
    if number % 2:
        q_in = sagging_wave_number(number, lambda_squared(cable), epsilon, ends)
        edge, constant = symmetric_parts(q_in, epsilon, ends)
        shape = ModeShape(True, q_in, hyperbolic(q_in, epsilon), edge, constant)
    else:
        q_in = q_out
        shape = ModeShape(False, q_in, hyperbolic(q_in, epsilon), sin(q_in / 2))
    f_in, f_out = frequency(cable, q_in), frequency(cable, q_out)
    return Mode(
        number=number,
        frequency_in=f_in,
        frequency_out=f_out,
        k3=cubic_stiffness(cable, number),
        sag_offset=sag_offset(cable, number, f_in, f_out),
        shape=shape,
    )


def cable_modes(cable: Cable, count: int, *, ends: Ends = "clamped") -> tuple[Mode, ...]:
    """Modes 1 to count. Raises InputError."""
    return tuple(cable_mode(cable, number, ends=ends) for number in range(1, mode_number(count) + 1))
