"""All rest positions of a cubic spring under a constant force."""

from collections.abc import Callable
from math import copysign, inf, isfinite, sqrt

from rainwind.physics.root_isolation import polished_root

_EPS = 2.220446049250313e-16
_FARTHEST = 1e90


def rest_positions(k: float, k2: float, k3: float, force: float) -> tuple[list[float], list[float]]:
    """All real y with k y + k2 y² + k3 y³ = force (k > 0), rising; and those that may be double roots.

    Left sides of the first two rows of eq. (4) of Peil & Nahrath (2003), at rest. Positions beyond 1e90 m are
    left out.
    """

    def excess(y: float) -> float:
        return y * (k + y * (k2 + y * k3)) - force

    def sign(y: float) -> int:
        value = excess(y)
        size = abs(k * y) + abs(k2 * y * y) + abs(k3 * y * y * y) + abs(force)
        return 0 if abs(value) <= 8 * _EPS * size else (1 if value > 0 else -1)

    turns = _turning_points(k, k2, k3)
    at_turns = [sign(y) for y in turns]
    far_right = 1 if k3 > 0 or (k3 == 0 and k2 >= 0) else -1
    far_left = -1 if k3 > 0 or (k3 == 0 and k2 <= 0) else 1
    doubles = [y for y, s in zip(turns, at_turns, strict=True) if s == 0]
    reach = max(1e-3, abs(force) / k, *(abs(y) for y in turns), 0.0)
    if not turns:
        roots = [_between(excess, -_far(excess, -reach, far_left), _far(excess, reach, far_right))]
        return [y for y in roots if y is not None], []
    roots: list[float | None] = [*doubles]
    if at_turns[0] * far_left < 0:
        roots.append(_between(excess, -_far(excess, -reach, far_left), turns[0]))
    if at_turns[-1] * far_right < 0:
        roots.append(_between(excess, turns[-1], _far(excess, reach, far_right)))
    if len(turns) == 2 and at_turns[0] * at_turns[1] < 0:
        roots.append(_between(excess, turns[0], turns[1]))
    return sorted(y for y in roots if y is not None), doubles


def _turning_points(k: float, k2: float, k3: float) -> list[float]:
    if k3 == 0:
        points = [] if k2 == 0 else [-0.5 * k / k2]
    else:
        under_root = k2 * k2 - 3 * k3 * k
        if under_root <= 0:
            return []
        # the stable form: no difference of nearly equal numbers
        w = -(k2 + copysign(sqrt(under_root), k2))
        points = [w / (3 * k3) if abs(w) < _FARTHEST * abs(k3) else inf, k / w]
    return sorted(y for y in points if isfinite(y) and abs(y) < _FARTHEST)


def _far(excess: Callable[[float], float], start: float, wanted: int) -> float:
    """A distance from zero, towards `start`, at which the excess has the sign that it keeps from there on."""
    y = 2 * start
    while excess(y) * wanted <= 0:
        y *= 4
        if abs(y) > _FARTHEST:
            return inf
    return abs(y)


def _between(excess: Callable[[float], float], low: float, high: float) -> float | None:
    return polished_root(excess, (low, high)) if isfinite(low) and isfinite(high) else None
