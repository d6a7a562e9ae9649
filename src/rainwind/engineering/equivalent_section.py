"""The section that moves like one mode of a stay."""

from math import pi

from rainwind.engineering.cable import Cable
from rainwind.engineering.modes import Mode
from rainwind.engineering.sag import lambda_squared
from rainwind.errors import InputError
from rainwind.physics.coefficient_files import load_coefficients
from rainwind.physics.coefficients import CoefficientSet, Outside
from rainwind.physics.model import RivuletModel
from rainwind.physics.rivulet import Rivulet
from rainwind.physics.section import CableSection
from rainwind.physics.wind import Wind

__all__ = ["section_model"]


def section_model(
    cable: Cable,
    mode: Mode,
    *,
    coefficients: str | CoefficientSet,
    rivulet: Rivulet,
    damping_ratio: float,
    density: float = 1.225,
    outside: Outside = "blend",
) -> RivuletModel:
    """The model of one metre of stay at the mode's antinode, with a wind of 10 m/s across it.

    It moves as the modal coordinate does: mass per metre and frequency of the mode, its stiffness that couples both
    directions, and the damping ratio given (of critical, 0.002 is 0.2 %, own and dampers' together) for both. Set
    `wind.speed` and `wind.yaw` by `with_parameters`. coefficients: a shipped set's name, a file's path, or a set.
    density of the air in kg/m³. Raises InputError, CaseError. docs/cables.md says what this leaves out.
    """
    chosen = coefficients if isinstance(coefficients, CoefficientSet) else load_coefficients(coefficients)
    _need_a_tight_stay(cable, mode)
    section = CableSection(
        diameter=cable.diameter,
        mass=cable.mass,
        frequency_y=mode.frequency_out,
        frequency_z=mode.frequency_out,
        damping_ratio=damping_ratio,
        inclination=cable.inclination,
        k2_y=0.0,
        k3_y=0.0,
        k2_z=0.0,
        k3_z=0.0,
        k3=mode.k3,
        sag_offset=mode.sag_offset,
    )
    return RivuletModel(Wind(10.0, 0.0, density), section, rivulet, chosen, outside=outside)


def _need_a_tight_stay(cable: Cable, mode: Mode) -> None:
    """InputError, in words of the stay, for one whose section would snap through (`CableSection`, derived there).

    That is where sag raises the mode in plane by a factor of sqrt(3): in mode 1 at lambda² of about 25.
    """
    least = cable.mass * (2 * pi * mode.frequency_out) ** 2
    if mode.k3 * mode.sag_offset**2 < least:
        return
    raise InputError(
        f"it sags too much for this model in mode {mode.number}: lambda² = {lambda_squared(cable):.3g}, "
        "about 25 is the most; check tension, mass and axial stiffness"
    )
