"""The analytic passage from a set's curves into the bare cylinder, 2-pi-periodic in alpha."""

from dataclasses import dataclass
from math import cos as cos_of_number
from math import pi, radians
from typing import Any

from rainwind.elementary import cos, tanh, wrap_angle
from rainwind.errors import InputError
from rainwind.physics.checks import finite_number, positive
from rainwind.physics.curves import Curve, Polynomial, as_curve
from rainwind.physics.expressions import Expression

_MARGIN = radians(12.0)
# tanh argument at the edge of the valid range: changes the values there by less than 1e-4
_STEEPNESS = 5.4
# tanh argument opposite the centre: beyond it the weight is zero to rounding, so that the cut does not show
_FLAT = 20.0
_BARE_LIFT = Polynomial((0.0,))
_BARE_DRAG = Polynomial((1.2,))
_BARE_MOMENT = Expression("-0.01*cos(alpha)")


@dataclass(frozen=True)
class Blend:
    """C = C_bare + w (C_set - C_bare), w = ½ [1 + tanh((cos theta - cos half_width) / width)].

    theta = alpha - centre, wrapped. centre and half_width in rad, width without unit; w = ½ at
    centre ± half_width. The bare cylinder's coefficients are curves in alpha; a small negative moment at
    alpha = 0 is friction that drags the lower rivulet leeward. Raises InputError.
    Source: no print; the paper needs an equilibrium A that polynomials do not have (its section 4.1).
    """

    centre: float
    half_width: float
    width: float
    bare_lift: Curve = _BARE_LIFT
    bare_drag: Curve = _BARE_DRAG
    bare_moment: Curve = _BARE_MOMENT

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "centre", finite_number("blend centre", self.centre))
        set_(self, "half_width", positive("blend half width", self.half_width))
        set_(self, "width", positive("blend width", self.width))
        for name in ("bare_lift", "bare_drag", "bare_moment"):
            set_(self, name, as_curve(f"blend {name}", getattr(self, name)))
        if self.half_width >= pi or (1 + cos_of_number(self.half_width)) / self.width < _FLAT:
            raise InputError(
                f"a blend of half width {self.half_width:.4g} rad and width {self.width:.4g} does not reach "
                "the bare cylinder anywhere on the circle; take smaller ones, or outside='extend' for curves "
                "that are periodic themselves"
            )

    def weight_and_angle(self, alpha: Any) -> tuple[Any, Any]:
        """w, and alpha brought to within pi of the centre; both at alpha (rad)."""
        theta = alpha - self.centre
        w = 0.5 * (1.0 + tanh((cos(theta) - cos_of_number(self.half_width)) / self.width))
        return w, wrap_angle(theta) + self.centre


def default_blend(low: float, high: float) -> Blend:
    """Half points 12° outside the valid range [low, high] (rad), as steep as the shipped sets'."""
    half = 0.5 * (high - low)
    edge = half + _MARGIN
    if edge >= pi:
        raise InputError(
            f"curves valid on {low:.4g} to {high:.4g} rad leave no room for a blend into the bare cylinder; "
            "choose outside='extend', which takes them as they are"
        )
    width = (cos_of_number(half) - cos_of_number(edge)) / _STEEPNESS
    return Blend(centre=0.5 * (low + high), half_width=edge, width=width)
