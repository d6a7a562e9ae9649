"""Where the upper rivulet D rests, for many rivulets, wind speeds and directions at once.

Without vertical wind the rivulet's balance, eq. (6) of Peil & Nahrath (2003), ties the wind to the angle:

    kappa(phi) = ½ rho d² U_n² / (m_R r g cos delta) = -sin(phi + beta) / C_M(-phi)

so that the branch D is an explicit curve over phi, and only kappa and beta matter. D is the part of it in the
coefficients' valid range on the upper windward quarter on which the rivulet is statically stable,
kappa C_M'(-phi) > cos(phi + beta); it begins in a fold, where kappa is least.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

import numpy as np

from rainwind.physics.letters import GRAVITY
from rainwind.physics.model import RivuletModel
from rainwind.physics.tilted import SLOPES, SteeperCoefficients

__all__ = ["UpperRivulet", "upper_rivulets"]

_POINTS = 721  # of phi over the valid range
_STEP = 1e-6  # rad, of the slope's difference
_POLISHES = 4
_ENDLESS = 1e9  # kappa of no wind on earth


@dataclass(frozen=True, eq=False)
class UpperRivulet:
    """The branch D of s samples in g directions: beta (g,) in rad; onset (s, g), kappa at the fold, nan without D.

    phi(kappa) of one sample and direction is read off `angles`.
    """

    coefficients: SteeperCoefficients
    beta: np.ndarray
    onset: np.ndarray
    _curves: tuple[tuple[tuple[np.ndarray, np.ndarray], ...], ...]

    def angles(self, kappa: np.ndarray) -> np.ndarray:
        """phi in rad at rest at kappa (s, g, n) -> (s, g, n); nan where there is no upper rivulet."""
        found = np.full(kappa.shape, np.nan)
        for i, row in enumerate(self._curves):
            for j, (at, phi) in enumerate(row):
                if at.size:
                    # a vertical stay has more than that: nothing weighs on its rivulet
                    inside = np.minimum(kappa[i, j], _ENDLESS)
                    found[i, j] = np.interp(inside, at, phi, left=np.nan, right=np.nan)
        return self._polished(found, kappa)

    def _polished(self, phi: np.ndarray, kappa: np.ndarray) -> np.ndarray:
        """Newton on kappa C_M(-phi) + sin(phi + beta) = 0; a step that would leave the neighbourhood is not taken."""
        beta = self.beta[None, :, None]
        for _ in range(_POLISHES):
            value, slope = _moment(self.coefficients, phi)
            balance = kappa * value + np.sin(phi + beta)
            change = balance / (np.cos(phi + beta) - kappa * slope)
            phi = phi - np.where(np.abs(change) < 0.02, change, 0.0)
        return phi


def upper_rivulets(model: RivuletModel, factors: Mapping[str, np.ndarray], beta: np.ndarray) -> UpperRivulet:
    """The branches D of a model with its slopes of lift, drag and moment times factors (s,), at angles beta (g,).

    factors: by the names of `physics.tilted.SLOPES`; other names are left alone. Source: Peil & Nahrath (2003), eq.
    (6).
    """
    many = len(next(iter(factors.values())))
    lift, drag, moment = (np.asarray(factors.get(name, np.ones(many)))[:, None, None] for name in SLOPES)
    tilted = SteeperCoefficients(model.coefficients, (lift, drag, moment))
    low, high = model.coefficients.valid
    first, last = max(-high, 0.0), min(-low, pi / 2)
    phi = np.linspace(first, last, _POINTS) if first < last else np.zeros(1)
    value, slope = _moment(tilted, np.broadcast_to(phi, (many, 1, phi.size)))
    turned = phi + np.asarray(beta)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        kappa = -np.sin(turned) / value
    stable = (kappa > 0) & np.isfinite(kappa) & (kappa * slope > np.cos(turned))
    curves = [
        [_branch(kappa[i, j], phi, stable[i, j], value[i, 0]) for j in range(len(beta))] for i in range(many)
    ]
    onset = np.array([[at[0] if at.size else np.nan for at, _ in row] for row in curves])
    return UpperRivulet(tilted, np.asarray(beta), onset, tuple(map(tuple, curves)))


def wind_speed_normal(model: RivuletModel, kappa: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """U_n in m/s at kappa, for rivulets of these masses (kg/m)."""
    return np.sqrt(kappa * _weight(model, mass) / (0.5 * model.wind.density)) / model.section.diameter


def kappa_at(model: RivuletModel, normal_speed: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """kappa at U_n in m/s, for rivulets of these masses (kg/m)."""
    wind = 0.5 * model.wind.density * (model.section.diameter * normal_speed) ** 2
    return wind / _weight(model, mass)


def _weight(model: RivuletModel, mass: np.ndarray) -> np.ndarray:
    """m_R r g cos(delta) in Nm/m."""
    radius = 0.5 * (model.section.diameter + model.rivulet.height)
    return mass * radius * GRAVITY * np.cos(model.section.inclination)


def _moment(coefficients: SteeperCoefficients, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """C_M and its slope C_M' at alpha = -phi."""
    below, value, above = (coefficients.at(-phi + step)[2] for step in (-_STEP, 0.0, _STEP))
    return value, (above - below) / (2.0 * _STEP)


def _branch(
    kappa: np.ndarray, phi: np.ndarray, stable: np.ndarray, moment: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """kappa and phi of the longest stable run, kappa rising; its fold found by a parabola. Empty without one.

    A run that ends where the moment passes zero goes on to any wind speed.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], stable, [False]]).astype(int))).reshape(-1, 2)
    if not len(edges):
        return np.empty(0), np.empty(0)
    begin, end = max(edges.tolist(), key=lambda run: run[1] - run[0])
    at, angle = kappa[begin:end], phi[begin:end]
    order = np.argsort(at)
    at, angle = at[order], angle[order]
    last = (
        begin if order[0] == 0 else end - 1
    )  # where kappa is least: the fold is between it and its neighbour
    beyond = last + (1 if last == end - 1 else -1)
    inner = last - (1 if last == end - 1 else -1)
    if 0 <= beyond < phi.size and begin <= inner < end and np.isfinite(kappa[beyond]) and kappa[beyond] > 0:
        a, b, c = np.polyfit(phi[[inner, last, beyond]] - phi[last], kappa[[inner, last, beyond]], 2)
        if a > 0 and abs(b / (2 * a)) <= abs(phi[1] - phi[0]):
            at = np.concatenate([[c - b * b / (4 * a)], at])
            angle = np.concatenate([[phi[last] - b / (2 * a)], angle])
    fastest, after = (begin, begin - 1) if last == end - 1 else (end - 1, end)
    if 0 <= after < phi.size and moment[after] * moment[fastest] < 0:
        share = moment[fastest] / (moment[fastest] - moment[after])
        at = np.concatenate([at, [_ENDLESS]])
        angle = np.concatenate([angle, [phi[fastest] + share * (phi[after] - phi[fastest])]])
    return at, angle
