"""All equilibria of the section: every root of the rivulet's balance, then of the cable's springs."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from math import pi
from typing import Any

import numpy as np

from rainwind.elementary import cos, sin
from rainwind.physics.coefficients import CoefficientSet, Outside
from rainwind.physics.convexity import least_slope, need_one_rest_position
from rainwind.physics.intervals import Box
from rainwind.physics.letters import Letters
from rainwind.physics.root_isolation import Bracket, isolate_roots, polished_root
from rainwind.physics.spring import rest_positions
from rainwind.physics.tension import rest_position

_BOXES = 1024
# the raw curves are searched a little beyond (-pi, pi], so that a root at pi is inside
_MARGIN = 1e-6
_ROUNDING = 1e-14


@dataclass(frozen=True, eq=False)
class Equilibria:
    """All equilibria; reads like the array `states` of shape (k, n), sorted by phi.

    names: of the n states. unresolved: (state, low, high) where the count of equilibria is not certain, e.g.
    at a fold, where two are one; empty means that no equilibrium is missing.
    """

    states: np.ndarray
    names: tuple[str, ...]
    unresolved: tuple[tuple[str, float, float], ...] = ()

    @property
    def certified(self) -> bool:
        """Whether the list is complete, to the rounding of interval arithmetic."""
        return not self.unresolved

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.states, dtype=dtype)

    def __len__(self) -> int:
        return len(self.states)

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter(self.states)

    def __getitem__(self, index: Any) -> Any:
        return self.states[index]


def find_all_equilibria(
    at: Letters,
    inflow: tuple[float, float],
    coefficients: CoefficientSet,
    outside: Outside,
    degrees_of_freedom: int,
) -> Equilibria:
    """All x with 0 = f(x), eq. (6) of Peil & Nahrath (2003): the inflow (alpha_v, U_rel²) at rest is that of the
    wind alone, (0, U_n²) without vertical wind, so that phi stands alone.

    g(phi) = ½ rho d² U_rel² C_M(alpha_v - phi) + m_R r g cos(delta) sin(phi + beta) = 0, then
    k q + k2 q² + k3 q³ = F for y and z; every combination is an equilibrium. With a tension spring y and z have
    one position for each phi (InputError where that is not proven: `need_one_rest_position`).
    phi runs over (-pi/2, 3 pi/2] with periodic coefficients (in the order of the paper's figure 5: the lower
    rivulet last); with raw ones phi - alpha_v runs over (-pi, pi].
    """
    alpha_v, u_rel_squared = inflow
    angles, unresolved = _rivulet_angles(at, inflow, coefficients, outside)
    q_d = 0.5 * float(at.rho * at.d * u_rel_squared)
    s, c = float(sin(alpha_v)), float(cos(alpha_v))
    rows: list[tuple[float, ...]] = []
    if at.k3 is not None:
        slopes = (least_slope(at.k_y, at.k_y2, at.k_y3), least_slope(at.k_z, at.k_z2, at.k_z3))
        need_one_rest_position(at.k3, at.s, *slopes)
    for phi in angles:
        c_l, c_d, _ = coefficients.at(-phi + alpha_v, outside)
        f_y, f_z = float(-q_d * (c_l * c + c_d * s)), float(q_d * (c_d * c - c_l * s))
        if at.k3 is not None:
            y, z, held = rest_position(at, f_y, f_z, degrees_of_freedom)
            unresolved += [] if held else [("y", y, y)]
            rows.append((y, phi, 0.0, 0.0) if degrees_of_freedom == 2 else (y, phi, z, 0.0, 0.0, 0.0))
            continue
        ys, double_ys = rest_positions(float(at.k_y), at.k_y2, at.k_y3, f_y)
        unresolved += [("y", y, y) for y in double_ys]
        if degrees_of_freedom == 2:
            rows += [(y, phi, 0.0, 0.0) for y in ys]
            continue
        zs, double_zs = rest_positions(float(at.k_z), at.k_z2, at.k_z3, f_z)
        unresolved += [("z", z, z) for z in double_zs]
        rows += [(y, phi, z, 0.0, 0.0, 0.0) for y, z in product(ys, zs)]
    two = degrees_of_freedom == 2
    names = ("y", "phi", "y_dot", "phi_dot") if two else ("y", "phi", "z", "y_dot", "phi_dot", "z_dot")
    return Equilibria(np.array(rows).reshape(-1, len(names)), names, tuple(unresolved))


def _rivulet_angles(
    at: Letters, inflow: tuple[float, float], coefficients: CoefficientSet, outside: Outside
) -> tuple[list[float], list[tuple[str, float, float]]]:
    """All phi, by psi = phi - alpha_v: then the moment's curve stays where it is, whatever the wind."""
    alpha_v, u_rel_squared = inflow
    wind, weight = 0.5 * at.rho * at.d * at.d * u_rel_squared, at.m_r * at.r * at.g_cos_delta
    edges, moment = _moment_on_boxes(coefficients, outside)
    scale = float(wind + at.m_r * at.r * 10.0)
    turned = at.beta + alpha_v

    def balance(psi: Any) -> Any:
        return wind * coefficients.moment_at(-psi, outside) + weight * sin(psi + turned)

    first = wind * moment + weight * sin(Box.variable(edges[:-1], edges[1:]) + turned)
    period = 2 * pi if outside == "blend" else None
    isolated = isolate_roots(balance, edges, first=first, period=period, tiny=1e-15 * scale)
    roots = [polished_root(balance, bracket) for bracket in isolated.brackets]
    if outside == "blend":
        angles = sorted(_on_circle(psi + alpha_v) for psi in roots)
        unresolved = isolated.unresolved
    else:
        inside = [min(psi, pi) for psi in roots if -pi + _ROUNDING < psi <= pi + _ROUNDING]
        unresolved = tuple(
            u for u in isolated.unresolved if u[1] > -pi + 2 * _MARGIN and u[0] <= pi + _ROUNDING
        )
        if outside == "refuse":
            inside = [psi for psi in inside if coefficients.covers(-psi)]
            unresolved = tuple(u for u in unresolved if _meets(u, coefficients.valid))
        angles = [psi + alpha_v for psi in inside]
    return angles, [("phi", low + alpha_v, high + alpha_v) for low, high in unresolved]


@lru_cache(maxsize=64)
def _moment_on_boxes(coefficients: CoefficientSet, outside: Outside) -> tuple[np.ndarray, Box]:
    """Edges in phi and the enclosure of C_M(-phi) between them: the part that no parameter changes."""
    if outside == "blend":
        # the cut of the wrapped angle falls on an edge
        centre = -coefficients.usable_blend.centre
        edges = np.linspace(centre - pi, centre + pi, _BOXES + 1)
    else:
        edges = np.linspace(-pi - _MARGIN, pi + _MARGIN, _BOXES + 1)
    moment = coefficients.moment_at(-Box.variable(edges[:-1], edges[1:]), outside)
    if not isinstance(moment, Box):
        # a constant curve
        bounds = np.full(_BOXES, float(moment))
        moment = Box((bounds, bounds), (np.zeros(_BOXES), np.zeros(_BOXES)))
    return edges, moment


def _on_circle(phi: float) -> float:
    """phi in (-pi/2, 3 pi/2]: the lower rivulet lies near pi, so that is no place for a cut."""
    turned = phi - 2 * pi * round((phi - pi / 2) / (2 * pi))
    return turned + 2 * pi if turned <= -pi / 2 + _ROUNDING else turned


def _meets(psi: Bracket, valid: tuple[float, float]) -> bool:
    return -psi[1] <= valid[1] and -psi[0] >= valid[0]
