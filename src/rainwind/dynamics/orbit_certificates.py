"""A second opinion on a labelled orbit: its certificate with an independent check by shooting."""

from dataclasses import replace
from typing import Any

import numpy as np

from rainwind.dynamics.orbit_results import OrbitPoint
from rainwind.dynamics.results import Certificate
from rainwind.dynamics.shooting import shoot
from rainwind.errors import InputError


def certified(model: Any, point: OrbitPoint, *, tolerance: float = 1e-6) -> OrbitPoint:
    """The point with more checks in its certificate: period, critical multiplier and trivial one by `shoot`.

    tolerance: on the relative difference of the period and on the multipliers. Where multipliers meet (lpc, bp, cpc,
    r1, r2, foldflip, lpns) an orbit at fixed parameters is ill-determined and they move like the root of the error:
    there ten times the root of the tolerance is allowed. Raises InputError for what is no labelled orbit.
    """
    if not isinstance(point, OrbitPoint):
        given = getattr(point, "kind", type(point).__name__)
        raise InputError(f"certified checks labelled orbits (lpc, pd, ns, bp, ...); got {given}")
    loose = point.kind in ("lpc", "bp", "cpc", "r1", "r2", "foldflip", "lpns")
    allowed = 10.0 * float(np.sqrt(tolerance)) if loose else tolerance
    shot = shoot(model, point.orbit)
    checks = dict(point.certificate.checks)
    checks["period by shooting"] = (shot.period / point.orbit.period - 1.0, allowed)
    if point.angle is not None:
        target = np.exp(1j * point.angle)
    else:
        target = -1.0 if point.kind in ("pd", "gpd", "r2", "pdns", "foldflip") else 1.0
    with np.errstate(over="ignore"):
        far = np.sort(np.abs(np.exp(shot.log_multipliers) - target))
    # beside the critical multiplier 1 lies the trivial one
    checks["critical multiplier by shooting"] = (float(far[1 if target == 1.0 else 0]), allowed)
    if not loose:
        checks["trivial multiplier by shooting"] = (float(shot.trivial_error), allowed)
    note = "; ".join(part for part in (point.note, shot.note) if part)
    margins = point.certificate.margins
    return replace(point, certificate=Certificate(point.certificate.residual, checks, margins), note=note)
