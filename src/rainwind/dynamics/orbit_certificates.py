"""A second opinion on a labelled orbit: its certificate with an independent check by shooting."""

from dataclasses import replace
from typing import Any

import numpy as np

from rainwind.dynamics.orbit_results import OrbitPoint
from rainwind.dynamics.results import Certificate
from rainwind.dynamics.shooting import shoot
from rainwind.errors import InputError


def certified(model: Any, point: OrbitPoint, *, tolerance: float = 1e-6) -> OrbitPoint:
    """The point with more checks in its certificate: period, critical multipliers and trivial one by `shoot`.

    tolerance: on the relative difference of the period and on log mu. At a fold of cycles (lpc) an orbit at a fixed
    parameter is ill-determined and its critical multiplier moves like the root of the error: there the tolerance on
    the multiplier is its root. Raises InputError for what is no labelled orbit.
    """
    if not isinstance(point, OrbitPoint):
        given = getattr(point, "kind", type(point).__name__)
        raise InputError(f"certified checks labelled orbits (lpc, pd, ns, bp, ...); got {given}")
    loose = point.kind in ("lpc", "bp", "cpc", "r1", "r2", "foldflip", "lpns")
    allowed = float(np.sqrt(tolerance)) if loose else tolerance
    shot = shoot(model, point.orbit)
    checks = dict(point.certificate.checks)
    checks["period by shooting"] = (shot.period / point.orbit.period - 1.0, allowed)
    targets = {"pd": [1j * np.pi], "ns": [1j * (point.angle or 0.0)]}.get(point.kind, [0.0])
    for target in targets:
        # a pair at -1 may come with either sign of its angle
        far = np.abs(np.exp(shot.log_multipliers) - np.exp(target))
        checks["critical multiplier by shooting"] = (float(np.sort(far)[1 if loose else 0]), allowed)
    if not loose:
        checks["trivial multiplier by shooting"] = (float(shot.trivial_error), allowed)
    note = "; ".join(part for part in (point.note, shot.note) if part)
    margins = point.certificate.margins
    return replace(point, certificate=Certificate(point.certificate.residual, checks, margins), note=note)
