"""How fast small vibrations about the upper rivulet D grow: many rivulets, directions and wind speeds at once."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.system import as_system
from rainwind.engineering.upper_rivulet import UpperRivulet, kappa_at
from rainwind.physics.letters import Letters
from rainwind.physics.model import RivuletModel
from rainwind.physics.tension import spring_forces, spring_stiffness
from rainwind.physics.tilted import ScatteredModel

__all__ = ["Growth", "damping_needed", "growth", "states_at_rest"]

MASS, RATIO = "rivulet.mass", "section.damping_ratio"
SPEED, YAW = "wind.speed", "wind.yaw"
_RESTS = 50  # Newton steps for y and z, at most
_AT_REST = 1e-13  # m, of a step
_CANDIDATES = 6
_SECANTS = 12
_MOST = 0.5  # damping ratio: beyond it the word vibration says nothing


@dataclass(frozen=True, eq=False)
class Growth:
    """Of s samples, g directions and n wind speeds at the cable: all (s, g, n), nan without an upper rivulet.

    rate: the largest real part of the complex eigenvalues, 1/s; omega: of that one, rad/s. state: (s, g, n, 6) at rest.
    parameters: of each point, by name, that differ from the model's own.
    """

    model: RivuletModel
    rate: np.ndarray
    omega: np.ndarray
    state: np.ndarray
    parameters: Mapping[str, np.ndarray]


def growth(
    model: RivuletModel,
    factors: Mapping[str, np.ndarray],
    rivulet: UpperRivulet,
    yaw: np.ndarray,
    speed: np.ndarray,
) -> Growth:
    """Eigenvalues about D: factors (s,) on the model's own values by name, yaw (g,) in rad, speed (n,) in m/s."""
    parameters = _parameters(model, factors, yaw, speed)
    state = states_at_rest(model, rivulet, parameters)
    rate, omega = _largest(model, state, parameters)
    return Growth(model, rate, omega, state, parameters)


def _parameters(
    model: RivuletModel, factors: Mapping[str, np.ndarray], yaw: np.ndarray, speed: np.ndarray
) -> dict[str, np.ndarray]:
    """What differs from point to point, each (s, g, n)."""
    own, many = model.parameters, len(next(iter(factors.values())))
    shape = (many, len(yaw), len(speed))
    found = {
        name: np.broadcast_to((factor * own.get(name, 1.0))[:, None, None], shape)
        for name, factor in factors.items()
    }
    found[YAW] = np.broadcast_to(np.asarray(yaw)[:, None], shape)
    found[SPEED] = np.broadcast_to(np.asarray(speed), shape)
    return found


def states_at_rest(
    model: RivuletModel, rivulet: UpperRivulet, parameters: Mapping[str, np.ndarray]
) -> np.ndarray:
    """The states (s, g, n, 6) at rest on D; nan where there is none."""
    at = model.letters({**model.parameters, **parameters})
    if at.k3 is None:
        at = at._replace(k3=0.0)
    phi = rivulet.angles(kappa_at(model, at.u_n, parameters[MASS]))
    lift, drag, _ = rivulet.coefficients.at(-phi)
    pressure = 0.5 * at.rho * at.d * at.u_n**2
    y, z = _displaced(at, -pressure * lift, pressure * drag)
    rest = np.zeros_like(phi)
    return np.stack([y, phi, z, rest, rest, rest], axis=-1)


def _displaced(at: Letters, f_y: np.ndarray, f_z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """y and z in m where the springs hold these forces in N/m, by Newton's method; one position holds each."""
    y, z = f_y / at.k_y, f_z / at.k_z
    for _ in range(_RESTS):
        r_y, r_z = spring_forces(at, y, z)
        r_y, r_z = r_y - f_y, r_z - f_z
        h_yy, h_yz, h_zz = spring_stiffness(at, y, z)
        det = h_yy * h_zz - h_yz * h_yz
        step_y, step_z = (h_zz * r_y - h_yz * r_z) / det, (h_yy * r_z - h_yz * r_y) / det
        y, z = y - step_y, z - step_z
        if np.nanmax(np.hypot(step_y, step_z), initial=0.0) < _AT_REST:
            break
    return y, z


def _largest(
    model: RivuletModel, state: np.ndarray, parameters: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Rate and omega of the least damped vibration at each point; nan where the state is."""
    there = np.isfinite(state[..., 1])
    rate, omega = np.full(there.shape, np.nan), np.full(there.shape, np.nan)
    if there.any():
        system = as_system(ScatteredModel(model))
        matrices = system.jacobian(state[there], {name: values[there] for name, values in parameters.items()})
        values = np.linalg.eigvals(matrices)
        vibrating = np.where(np.abs(values.imag) > 0, values.real, -np.inf)
        first = vibrating.argmax(axis=-1)[:, None]
        best = np.take_along_axis(vibrating, first, -1)[:, 0]
        rate[there] = best
        omega[there] = np.abs(np.take_along_axis(values.imag, first, -1)[:, 0])
    return rate, omega


def damping_needed(found: Growth, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The damping ratio (s,) above which D is stable at every point `inside` (s, g, n), and the point of it (s,) flat.

    A vibration's rate falls by omega for each unit of damping ratio, to first order: by that estimate the candidates
    are chosen, and each is solved exactly. 0 where nothing needs damping, with point -1; at most 0.5.
    """
    own = found.model.section.damping_ratio
    many = found.rate.shape[0]
    estimate = np.where(inside, own + found.rate / found.omega, np.nan).reshape(many, -1)
    estimate = np.where(np.isfinite(estimate), estimate, -np.inf)
    count = min(_CANDIDATES, estimate.shape[1])
    chosen = np.argpartition(-estimate, count - 1, axis=1)[:, :count]
    first = np.take_along_axis(estimate, chosen, 1)
    need = _needed_at(found, chosen, np.where(np.isfinite(first), first, np.nan))
    need = np.where(np.isfinite(need) & (need > 0), need, 0.0)
    best = need.argmax(axis=1)[:, None]
    ratio = np.take_along_axis(need, best, 1)[:, 0]
    point = np.where(ratio > 0, np.take_along_axis(chosen, best, 1)[:, 0], -1)
    return np.minimum(ratio, _MOST), point


def _needed_at(found: Growth, chosen: np.ndarray, guess: np.ndarray) -> np.ndarray:
    """The ratio at which the rate is zero at the points chosen (s, c), by secants; 0 where none is needed."""
    many = found.rate.shape[0]

    def at(values: np.ndarray) -> np.ndarray:
        flat = values.reshape(many, -1, *values.shape[3:])
        return flat[np.arange(many)[:, None], chosen]

    state = at(found.state)
    fixed = {name: at(values) for name, values in found.parameters.items()}

    def rate(ratio: np.ndarray) -> np.ndarray:
        hidden = np.where(np.isfinite(ratio)[..., None], state, np.nan)
        return _largest(found.model, hidden, {**fixed, RATIO: np.maximum(ratio, 0.0)})[0]

    a, b = np.maximum(guess, 1e-6), np.maximum(guess, 1e-6) * 1.02 + 1e-6
    r_a, r_b = rate(a), rate(b)
    for _ in range(_SECANTS):
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -r_b * (b - a) / (r_b - r_a)
        step = np.clip(np.where(np.isfinite(step), step, 0.0), -0.5 * b, b + 0.01)
        a, r_a, b = b, r_b, np.clip(b + step, 0.0, 2 * _MOST)
        r_b = rate(b)
        if np.nanmax(np.abs(step), initial=0.0) < 1e-9:
            break
    return np.where(rate(np.zeros_like(b)) > 0, b, 0.0)
