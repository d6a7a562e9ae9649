"""The coupled cable and rivulet: eqs. (1) to (5) of Peil & Nahrath (2003) as a dynamical system."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from math import cos as cosine
from math import isfinite, pi
from typing import Any, Literal

from rainwind.elementary import atan2, cos, sin
from rainwind.errors import InputError
from rainwind.parameters import parameter_values, replace_parameters, unknown_name
from rainwind.physics.checks import one_of
from rainwind.physics.coefficient_files import load_coefficients
from rainwind.physics.coefficients import OUTSIDE, CoefficientSet, Outside, check_usable
from rainwind.physics.energy import energy_parts, power_parts
from rainwind.physics.letters import Letters, letters
from rainwind.physics.rivulet import Rivulet
from rainwind.physics.section import OPTIONAL, CableSection
from rainwind.physics.static_balance import Equilibria, find_all_equilibria
from rainwind.physics.tension import tension_forces
from rainwind.physics.wind import Wind


@dataclass(frozen=True)
class RivuletModel:
    """A wetted cable section in wind; by shape a system x' = f(x, p) with states, parameters and rhs.

    outside: what the coefficients do beyond their valid range ("blend", "extend", "refuse").
    degrees_of_freedom: 3 (y, phi, z) or 2 (y, phi). angle: "arctan", the exact alpha_v of eq. (3), or
    "linear", its right-hand form. relative_speed: "wind", U_rel = U_n as in the paper, or "full", with the
    velocities of cable and rivulet. All numbers in SI and rad. Raises InputError.
    Source: Peil & Nahrath (2003), section 2; section.k3, the tension of a string, is ours (docs/theory.md).
    """

    wind: Wind
    section: CableSection
    rivulet: Rivulet
    coefficients: CoefficientSet = field(metadata={"parameters": False})
    outside: Outside = "blend"
    degrees_of_freedom: int = field(default=3, metadata={"parameters": False})
    angle: Literal["arctan", "linear"] = "arctan"
    relative_speed: Literal["wind", "full"] = "wind"

    def __post_init__(self) -> None:
        for name, kind in (
            ("wind", Wind),
            ("section", CableSection),
            ("rivulet", Rivulet),
            ("coefficients", CoefficientSet),
        ):
            if not isinstance(getattr(self, name), kind):
                raise InputError(f"{name} = {getattr(self, name)!r} must be a {kind.__name__}")
        one_of("outside", self.outside, OUTSIDE)
        one_of("degrees_of_freedom", self.degrees_of_freedom, (3, 2))
        one_of("angle", self.angle, ("arctan", "linear"))
        one_of("relative_speed", self.relative_speed, ("wind", "full"))
        check_usable(self.coefficients, self.outside)
        if self.normal_speed < 1e-9 * self.wind.speed:
            raise InputError(
                "the wind blows along the cable, so that no wind meets the section (wind.yaw 90 degrees and "
                "section.inclination 0); change either angle"
            )
        if self.angle == "linear" and self.letters(self.parameters).u_z <= 0:
            raise InputError(
                f"wind.vertical_speed = {self.wind.vertical_speed:g} turns the flow around the section back, where "
                "angle='linear' means nothing; take a smaller one, or angle='arctan'"
            )

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states, in the order of eq. (5): y, z in m, phi in rad, their rates per second."""
        if self.degrees_of_freedom == 2:
            return ("y", "phi", "y_dot", "phi_dot")
        return ("y", "phi", "z", "y_dot", "phi_dot", "z_dot")

    @property
    def parameters(self) -> dict[str, float]:
        """Dotted name -> value, SI and rad, e.g. "wind.speed"."""
        return parameter_values(self)

    @property
    def structure(self) -> Hashable:
        """Everything that `rhs` depends on besides x and p; equal keys mean equal right-hand sides."""
        return (
            "RivuletModel", self.coefficients, self.outside, self.degrees_of_freedom, self.angle,
            self.relative_speed, self._given,
        )  # fmt: skip

    @property
    def beta(self) -> float:
        """beta in rad, eq. (1)."""
        return float(self.letters(self.parameters).beta)

    @property
    def normal_speed(self) -> float:
        """U_n in m/s, the wind's component normal to the cable."""
        return float(self.letters(self.parameters).u_n)

    def with_parameters(self, changes: Mapping[str, float]) -> "RivuletModel":
        """A copy with the parameters of these dotted names replaced. Raises InputError."""
        return replace_parameters(self, changes)

    def letters(self, p: Mapping[str, Any]) -> Letters:
        """The letters of eqs. (1) to (4) from the parameters p, indexable by dotted name."""
        return letters(p, self._given)

    def angle_of_attack(self, x: Sequence[Any], p: Mapping[str, Any]) -> Any:
        """alpha in rad, not wrapped, at the states x (in order) and parameters p, eq. (3)."""
        _, phi, _, y_dot, phi_dot, z_dot = self._all_six(x)
        return -phi + self._inflow(self.letters(p), phi, y_dot, phi_dot, z_dot)[0]

    def wind_forces(self, x: Sequence[Any], p: Mapping[str, Any]) -> tuple[Any, Any, Any]:
        """F_y, F_z in N and M_phi in Nm, each per metre of cable, eq. (2), at states x and parameters p."""
        _, phi, _, y_dot, phi_dot, z_dot = self._all_six(x)
        return self._wind_forces(self.letters(p), phi, y_dot, phi_dot, z_dot)

    def rhs(self, x: Sequence[Any], p: Mapping[str, Any]) -> tuple[Any, ...]:
        """x' of eq. (5): x in the order of `states`, p indexable by dotted name; of numbers or tape symbols.

        Eq. (4) solved for the accelerations by hand: the mass matrix is never singular.
        """
        y, phi, z, y_dot, phi_dot, z_dot = self._all_six(x)
        at = self.letters(p)
        f_y, f_z, m_phi = self._wind_forces(at, phi, y_dot, phi_dot, z_dot)
        s, c = sin(phi), cos(phi)
        m, m_r, r = at.m_s + at.m_r, at.m_r, at.r
        centrifugal = m_r * r * phi_dot * phi_dot
        t_y, t_z = (0.0, 0.0) if at.k3 is None else tension_forces(at, y, z)
        # the rows of eq. (4) without their second derivatives
        p_y = f_y - at.d_y * y_dot - y * (at.k_y + y * (at.k_y2 + y * at.k_y3)) - c * centrifugal - t_y
        p_phi = m_phi - at.d_phi * phi_dot + m_r * r * at.g_cos_delta * sin(phi + at.beta)
        if self.degrees_of_freedom == 2:
            phi_ddot = (p_phi / (m_r * r) - s * p_y / m) / (r * (at.m_s + m_r * c * c) / m)
            return (y_dot, phi_dot, (p_y - m_r * r * s * phi_ddot) / m, phi_ddot)
        p_z = f_z - at.d_z * z_dot - z * (at.k_z + z * (at.k_z2 + z * at.k_z3)) - s * centrifugal - t_z
        phi_ddot = (p_phi / (m_r * r) - (s * p_y - c * p_z) / m) / (r * at.m_s / m)
        y_ddot = (p_y - m_r * r * s * phi_ddot) / m
        z_ddot = (p_z + m_r * r * c * phi_ddot) / m
        return (y_dot, phi_dot, z_dot, y_ddot, phi_ddot, z_ddot)

    def energy(self, x: Sequence[Any], p: Mapping[str, Any]) -> Any:
        """Kinetic, elastic and gravity energy in J per metre of cable at states x and parameters p."""
        parts = energy_parts(self.letters(p), self._all_six(x))
        return parts["kinetic"] + parts["elastic"] + parts["gravity"]

    def powers(self, x: Sequence[Any], p: Mapping[str, Any]) -> dict[str, Any]:
        """What changes the energy, in W per metre: "wind", "cable damping", "rivulet friction"."""
        return power_parts(self.letters(p), self._all_six(x), self.wind_forces(x, p))

    @property
    def units(self) -> dict[str, str]:
        """The units of time, of the states and of the parameters that usually vary with time."""
        lengths = {"y": "m", "z": "m", "y_dot": "m/s", "z_dot": "m/s"}
        return {
            "time": "s", **lengths, "phi": "rad", "phi_dot": "rad/s", "wind.speed": "m/s",
            "wind.vertical_speed": "m/s",
        }  # fmt: skip

    @property
    def limits(self) -> dict[str, tuple[Any, Any]]:
        """What is watched along a trajectory: the angle of attack, with a margin that is positive in the valid range.

        With outside="blend" the angle counts modulo a full turn.
        """
        low, high = self.coefficients.valid
        if self.outside == "blend" and high - low >= 2 * pi:
            return {}

        def margin(x: Sequence[Any], p: Mapping[str, Any]) -> Any:
            alpha = self.angle_of_attack(x, p)
            if self.outside == "blend":
                return cos(alpha - 0.5 * (low + high)) - cosine(0.5 * (high - low))
            return (alpha - low) * (high - alpha)

        return {"angle of attack": (self.angle_of_attack, margin)}

    @property
    def losses(self) -> dict[str, Any]:
        """When the upper rivulet is gone: cos(phi + beta) + 1/2 is negative beyond 120 degrees from the cable's top."""
        return {"rivulet lost": lambda x, p: cos(self._all_six(x)[1] + self.letters(p).beta) + 0.5}

    def all_states(self, parameters: Mapping[str, float] | None = None) -> Equilibria:
        """All equilibria, on the whole circle, sorted by phi; `parameters` overrides some of the model's own.

        The result reads like an array of shape (k, n), and says whether it is certified to be complete.
        phi lies in (-pi/2, 3 pi/2] with outside="blend", -alpha in (-pi, pi] with "extend" and "refuse" (without
        vertical wind -alpha is phi); with "refuse", those outside the valid range are left out. Raises InputError
        for unknown names, and for a tension spring with which the cable may have several rest positions.
        Source: Peil & Nahrath (2003), section 4.1, eq. (6).
        """
        at = self.letters(self._merged(parameters))
        alpha_v, u_rel_squared = self._inflow(at, 0.0, 0.0, 0.0, 0.0)
        inflow = float(alpha_v), float(u_rel_squared)
        return find_all_equilibria(at, inflow, self.coefficients, self.outside, self.degrees_of_freedom)

    @property
    def refuses(self) -> bool:
        """Whether `refusal` ever gives a reason."""
        return self.outside == "refuse"

    def refusal(self, x: Sequence[Any], p: Mapping[str, Any]) -> str | None:
        """Why the coefficients cannot be used at the states x and parameters p, or None if they can."""
        if self.outside != "refuse":
            return None
        alpha = float(self.angle_of_attack(x, p))
        if isfinite(alpha) and self.coefficients.covers(alpha):
            return None
        low, high = self.coefficients.valid
        return (
            f"angle of attack {alpha:.4g} rad is outside [{low:.4g}, {high:.4g}] rad where "
            f"'{self.coefficients.name}' is valid ({self.coefficients.source}); choose another "
            "coefficient set, or outside='blend' or 'extend'"
        )

    @property
    def _given(self) -> tuple[str, ...]:
        """The section's optional fields that are given: damping ratios of their own, the tension spring."""
        return tuple(name for name in OPTIONAL if getattr(self.section, name) is not None)

    def _merged(self, parameters: Mapping[str, float] | None) -> dict[str, float]:
        merged = self.parameters
        for name, value in (parameters or {}).items():
            if name not in merged:
                raise unknown_name(name, merged, "parameter")
            merged[name] = float(value)
        return merged

    def _all_six(self, x: Sequence[Any]) -> tuple[Any, ...]:
        if self.degrees_of_freedom == 2:
            y, phi, y_dot, phi_dot = x
            return y, phi, 0.0, y_dot, phi_dot, 0.0
        y, phi, z, y_dot, phi_dot, z_dot = x
        return y, phi, z, y_dot, phi_dot, z_dot

    def _inflow(self, at: Letters, phi: Any, y_dot: Any, phi_dot: Any, z_dot: Any) -> tuple[Any, Any]:
        """alpha_v and U_rel² of eq. (3): the wind relative to the moving rivulet.

        The vertical wind adds u_up to the upward part and u_z - U_n to the onward one.
        """
        upward = y_dot + at.r * phi_dot * sin(phi) + at.u_up
        # U_rel = U_n in the paper: velocities of the cable stay far below it
        u_squared = at.u_z * at.u_z + at.u_up * at.u_up
        if self.angle == "linear" and self.relative_speed == "wind":
            return upward / at.u_z, u_squared
        onward = at.u_z - z_dot + at.r * phi_dot * cos(phi)
        alpha_v = upward / at.u_z if self.angle == "linear" else atan2(upward, onward)
        if self.relative_speed == "full":
            u_squared = upward * upward + onward * onward
        return alpha_v, u_squared

    def _wind_forces(
        self, at: Letters, phi: Any, y_dot: Any, phi_dot: Any, z_dot: Any
    ) -> tuple[Any, Any, Any]:
        a_v, u_rel_squared = self._inflow(at, phi, y_dot, phi_dot, z_dot)
        c_l, c_d, c_m = self.coefficients.at(-phi + a_v, self.outside)
        q_d = 0.5 * at.rho * at.d * u_rel_squared
        f_y = -q_d * (c_l * cos(a_v) + c_d * sin(a_v))
        f_z = q_d * (-c_l * sin(a_v) + c_d * cos(a_v))
        return f_y, f_z, q_d * at.d * c_m


def paper_model(
    coefficients: str | CoefficientSet = "reconstructed",
    outside: Outside = "blend",
    *,
    degrees_of_freedom: int = 3,
) -> RivuletModel:
    """The sample case of Peil & Nahrath (2003), section 3, at a wind speed of 9 m/s.

    coefficients: a shipped set's name, a file's path, or a set. The damping ratio is 0.2 % (printed 2 %, a
    misprint by section 5) and rho = 1.225 kg/m³ (not printed). The paper's own coefficients are lost: the
    default set is a reconstruction. Raises InputError, CaseError.
    """
    chosen = coefficients if isinstance(coefficients, CoefficientSet) else load_coefficients(coefficients)
    return RivuletModel(
        Wind(9.0), CableSection(), Rivulet(), chosen, outside=outside, degrees_of_freedom=degrees_of_freedom
    )
