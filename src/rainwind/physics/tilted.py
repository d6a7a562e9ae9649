"""Coefficients with steeper or flatter curves, and a model that has these factors among its parameters."""

from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

from rainwind.physics.coefficients import CoefficientSet, Outside
from rainwind.physics.model import RivuletModel

__all__ = ["DRAG", "LIFT", "MOMENT", "SLOPES", "ScatteredModel", "SteeperCoefficients"]

LIFT, DRAG, MOMENT = "lift slope", "drag slope", "moment slope"
SLOPES = (LIFT, DRAG, MOMENT)
"""Names of the factors among the parameters of a `ScatteredModel`."""


@dataclass(frozen=True)
class SteeperCoefficients:
    """A set whose curves are tilted about the middle of its range: C + (factor - 1) C'(middle) (alpha - middle).

    given: the set. factors: of the slopes of lift, drag and moment, numbers or tape symbols; 1 leaves a curve as it
    is. Source: our assumption of how an uncertain measurement scatters, no measurement itself.
    """

    given: CoefficientSet
    factors: tuple[Any, Any, Any]

    def at(self, alpha: Any, outside: Outside = "blend") -> tuple[Any, Any, Any]:
        """C_L, C_D, C_M at alpha (rad), as `CoefficientSet.at` gives them; with "blend" tilted within the range."""
        low, high = self.given.valid
        middle, step = 0.5 * (low + high), 1e-4
        weight, angle = 1.0, alpha
        if outside == "blend":
            weight, angle = self.given.usable_blend.weight_and_angle(alpha)
        curves = (self.given.lift, self.given.drag, self.given.need_moment())
        slopes = ((curve(middle + step) - curve(middle - step)) / (2.0 * step) for curve in curves)
        return tuple(
            c + weight * (factor - 1.0) * float(slope) * (angle - middle)
            for c, factor, slope in zip(self.given.at(alpha, outside), self.factors, slopes, strict=True)
        )  # type: ignore[return-value]


class ScatteredModel:
    """A model with three more parameters: "lift slope", "drag slope", "moment slope", 1.0 for the set as given.

    model: the model to be scattered, `given` afterwards. By shape a system: states, parameters, structure and rhs.
    """

    def __init__(self, model: RivuletModel) -> None:
        self.given = model
        self.states = model.states
        self.parameters: dict[str, float] = {**model.parameters, **dict.fromkeys(SLOPES, 1.0)}
        self.structure: Hashable = ("scattered", model.structure)

    def rhs(self, x: Sequence[Any], p: Mapping[str, Any]) -> tuple[Any, ...]:
        """The model's own right-hand side with tilted coefficients, at states x (in order) and parameters p."""
        tilted = copy(self.given)
        coefficients = SteeperCoefficients(self.given.coefficients, (p[LIFT], p[DRAG], p[MOMENT]))
        object.__setattr__(tilted, "coefficients", coefficients)
        return tilted.rhs(x, p)
