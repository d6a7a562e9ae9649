"""Limit cycles of AUTO polished to rounding, and their multipliers, by two ways that share only the equations.

AUTO stores a cycle to 11 digits and prints its multipliers to 6. Both ways solve for the same cycle by multiple
shooting from AUTO's mesh points, at AUTO's wind speed, on the plane that AUTO's phase condition chose for t = 0:

* `explicit`: segments integrated together with their variational equations by DOP853 (explicit, adaptive);
  multipliers are the eigenvalues of the product of the segments, multiplied with 100 digits (mpmath);
* `gauss`: each segment is one step of the 8-stage Gauss method (implicit, order 16) with its exact derivative;
  multipliers by orthogonal iteration through the segments, never forming a product that under- or overflows.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass

import mpmath
import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.integrate import solve_ivp

from .auto_runner import Array, LabelledPoint
from .sample_case import Equations

# x and a length of time -> x later, d(x later)/dx, the integral of x and that of the trace of J (nan if unknown)
Flow = Callable[[Array, float], tuple[Array, Array, Array, float]]


class NotConverged(RuntimeError):
    """Newton's method did not reach the tolerance."""


class Field:
    """f and J at one wind speed and damping ratio, as quick as ctypes allows."""

    def __init__(self, equations: Equations, speed: float, damping_ratio: float) -> None:
        self._func = equations.func
        self._u, self._f, self._par = np.zeros(6), np.zeros(6), np.zeros(36)
        self._par[:2] = speed, damping_ratio
        self._dfdu, self._dfdp = np.zeros((6, 6), order="F"), np.zeros((6, 36), order="F")
        u, par, f, dfdu, dfdp = (
            ctypes.c_void_p(a.ctypes.data) for a in (self._u, self._par, self._f, self._dfdu, self._dfdp)
        )
        self._icp, n, ijac = (
            (ctypes.c_int * 2)(1, 2),
            ctypes.byref(ctypes.c_int(6)),
            ctypes.byref(ctypes.c_int(1)),
        )
        self._arguments = (n, u, self._icp, par, ijac, f, dfdu, dfdp)

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """Shapes (6,) and (6, 6); the arrays are new."""
        self._u[:] = x
        self._func(*self._arguments)
        return self._f.copy(), self._dfdu.copy()


@dataclass(frozen=True)
class RefinedOrbit:
    """A cycle in K segments."""

    speed: float
    damping_ratio: float
    period: float
    times: Array  # shape (K,), of the segments' beginnings, on [0, 1)
    states: Array  # shape (K, 6)
    monodromy: Array  # shape (K, 6, 6): of each segment
    mean: Array  # shape (6,), over a period
    trace: float  # integral of the trace of J over a period: sum of log|multiplier| (Liouville)
    residual: float  # largest gap between segments
    maxima: Array  # shape (3,): of y, phi, z
    minima: Array


def explicit_flow(field: Field, tolerance: float = 3e-14) -> Flow:
    """DOP853 on x and its variational equations."""

    def rhs(_: float, v: Array) -> Array:
        f, jacobian = field(v[:6])
        return np.concatenate([f, (jacobian @ v[6:].reshape(6, 6)).ravel()])

    def flow(x: Array, h: float) -> tuple[Array, Array, Array, float]:
        start = np.concatenate([x, np.eye(6).ravel()])
        end = solve_ivp(rhs, (0.0, h), start, "DOP853", rtol=tolerance, atol=1e-15).y[:, -1]
        return end[:6], end[6:].reshape(6, 6), np.full(6, np.nan), np.nan

    return flow


def gauss_flow(field: Field, stages: int = 8) -> Flow:
    """One step of the Gauss method; the derivative is that of the step itself."""
    nodes, weights = leggauss(stages)
    c, b = (nodes + 1) / 2, weights / 2
    # a[i, j]: the integral of the j-th Lagrange polynomial from 0 to c_i
    lagrange = [np.poly1d(np.poly(np.delete(c, j))) / np.prod(c[j] - np.delete(c, j)) for j in range(stages)]
    a = np.array([[ci * np.dot(b, lj(ci * c)) for lj in lagrange] for ci in c])

    def flow(x: Array, h: float) -> tuple[Array, Array, Array, float]:
        f, jacobian = field(x)
        # the linearly implicit Euler step: a stiff rivulet would send an explicit one far away
        stage = x + np.array([np.linalg.solve(np.eye(6) - ci * h * jacobian, ci * h * f) for ci in c])
        last = np.inf
        for _ in range(12):
            values = [field(s) for s in stage]
            slopes, jacobians = np.array([v[0] for v in values]), np.array([v[1] for v in values])
            matrix = np.eye(6 * stages) - h * np.einsum("ij,jkl->ikjl", a, jacobians).reshape(
                2 * (6 * stages,)
            )
            change = np.linalg.solve(matrix, (x + h * a @ slopes - stage).ravel()).reshape(stages, 6)
            stage = stage + change
            size = np.abs(change).max()
            if size < 1e-12 and size >= last / 4:  # rounding
                break
            last = size
        else:
            raise NotConverged(f"Gauss step of {h:g} s: the last change is {size:g}")
        values = [field(s) for s in stage]
        slopes, jacobians = np.array([v[0] for v in values]), np.array([v[1] for v in values])
        matrix = np.eye(6 * stages) - h * np.einsum("ij,jkl->ikjl", a, jacobians).reshape(2 * (6 * stages,))
        by_x = np.linalg.solve(matrix, np.tile(np.eye(6), (stages, 1))).reshape(stages, 6, 6)
        derivative = np.eye(6) + h * np.einsum("i,ijk,ikl->jl", b, jacobians, by_x)
        trace = h * np.dot(b, np.trace(jacobians, axis1=1, axis2=2))
        return x + h * b @ slopes, derivative, h * b @ stage, float(trace)

    return flow


def refine(
    equations: Equations,
    point: LabelledPoint | RefinedOrbit,
    way: Callable[[Field], Flow],
    *,
    speed: float | None = None,
    damping_ratio: float | None = None,
    along: tuple[Array, float] | None = None,
    segments: int = 100,
) -> RefinedOrbit:
    """The cycle near `point`, at its wind speed and damping ratio unless others are given; raises NotConverged.

    With `along`, a direction v of shape (6,) and a length, the wind speed is unknown too, and v . (x - x of
    `point`) at t = 0 is that length: so it also works where the cycles fold.
    """
    if not isinstance(point, RefinedOrbit):
        point = _as_segments(point, segments)
    damping_ratio = float(point.damping_ratio if damping_ratio is None else damping_ratio)
    speed = float(point.speed if speed is None else speed)
    starts, times, period = point.states, point.times, point.period
    count, x = len(times), starts.copy()
    lengths = np.diff(np.append(times, 1.0))
    normal = Field(equations, speed, damping_ratio)(starts[0])[0]
    normal /= np.linalg.norm(normal)
    last, by_speed = np.inf, None
    for _ in range(14):
        field = Field(equations, speed, damping_ratio)
        flow = way(field)
        ends, matrices, means, traces = zip(
            *(flow(s, h * period) for s, h in zip(x, lengths, strict=True)), strict=True
        )
        gaps = np.array(ends) - np.roll(x, -1, axis=0)
        size_of = 6 * count + 1 + (along is not None)
        system, right = np.zeros((size_of, size_of)), np.zeros(size_of)
        for k in range(count):
            rows, following = slice(6 * k, 6 * k + 6), 6 * ((k + 1) % count)
            system[rows, rows] += matrices[k]
            system[rows, following : following + 6] -= np.eye(6)
            system[rows, 6 * count] = lengths[k] * field(ends[k])[0]
        system[6 * count, :6] = normal
        right[: 6 * count], right[6 * count] = gaps.ravel(), normal @ (x[0] - starts[0])
        if along is not None:
            if by_speed is None:  # differences at the first guess are good enough for Newton's method
                up = way(Field(equations, speed + 1e-6, damping_ratio))
                moved = [up(s, h * period)[0] for s, h in zip(x, lengths, strict=True)]
                by_speed = (np.array(moved) - np.array(ends)).ravel() / 1e-6
            system[: 6 * count, -1] = by_speed
            system[-1, :6], right[-1] = along[0], along[0] @ (x[0] - starts[0]) - along[1]
        size = np.abs(right).max()
        if size < 1e-11 and size >= last / 4:  # rounding
            break
        last = size
        change = np.linalg.solve(system, -right)
        x, period = x + change[: 6 * count].reshape(count, 6), period + change[6 * count]
        if along is not None:
            speed += change[-1]
    else:
        raise NotConverged(f"multiple shooting at {speed:g} m/s: the last gap is {size:g}")
    highest, lowest = _extremes(field, x, lengths * period)
    return RefinedOrbit(
        speed=float(speed),
        damping_ratio=damping_ratio,
        period=float(period),
        times=times,
        states=x,
        monodromy=np.array(matrices),
        mean=np.sum(means, axis=0) / period,
        trace=float(np.sum(traces)),
        residual=float(np.abs(gaps).max()),
        maxima=highest,
        minima=lowest,
    )


def _as_segments(point: LabelledPoint, segments: int) -> RefinedOrbit:
    """AUTO's cycle as a first guess; only what `refine` starts from is filled in."""
    rows = np.linspace(0, len(point.times) - 1, segments + 1).round().astype(int)[:-1]
    speed, damping_ratio, period = (float(point.parameters[i]) for i in (0, 1, 10))
    states, none = point.profile[rows, :6], np.full(6, np.nan)
    return RefinedOrbit(
        speed, damping_ratio, period, point.times[rows], states, np.empty(0), none, np.nan, np.nan, none, none
    )


def crossing(
    equations: Equations,
    point: LabelledPoint | RefinedOrbit,
    name: str,
    *,
    damping_ratio: float | None = None,
    other_speed: float | None = None,
) -> RefinedOrbit:
    """The cycle near `point` where a multiplier lies on the unit circle ("ns", "pd"), by the secant method.

    It begins with the speed of `point` and another, 1e-5 m/s higher unless given; raises NotConverged.
    """
    orbit = refine(equations, point, gauss_flow, damping_ratio=damping_ratio)
    speeds = [orbit.speed, orbit.speed + 1e-5 if other_speed is None else other_speed]
    values = [log_critical(orbit, name)]
    for _ in range(12):
        orbit = refine(equations, orbit, gauss_flow, speed=speeds[-1])
        values.append(log_critical(orbit, name))
        step = -values[-1] * (speeds[-1] - speeds[-2]) / (values[-1] - values[-2])
        if abs(step) < 1e-11:
            return orbit
        speeds.append(speeds[-1] + step)
    raise NotConverged(f"no multiplier on the unit circle near {orbit.speed:g} m/s ({name})")


def fold_of_cycles(equations: Equations, point: LabelledPoint) -> RefinedOrbit:
    """The cycle near `point` at which the wind speed is extremal: vertices of parabolas through three cycles."""
    direction, width = np.eye(6)[1], 1e-4
    orbit = refine(equations, point, gauss_flow, along=(direction, 0.0))
    for _ in range(15):
        sides = [refine(equations, orbit, gauss_flow, along=(direction, s)) for s in (-width, width)]
        low, middle, high = sides[0].speed, orbit.speed, sides[1].speed
        bend = (low - 2 * middle + high) / width**2
        step = (low - high) / (2 * bend * width)
        orbit = refine(equations, orbit, gauss_flow, along=(direction, float(np.clip(step, -0.02, 0.02))))
        if abs(bend) * step**2 < 1e-12:
            return orbit
        # where the branch goes, as far as it is not along the flow: any other direction may stand still
        direction = sides[1].states[0] - sides[0].states[0]
        direction /= np.linalg.norm(direction)
    raise NotConverged(f"no fold of cycles near {orbit.speed:g} m/s")


def critical(values: np.ndarray, name: str) -> complex:
    """The multiplier nearest the unit circle of those that can cross it as this name says; nan if there is none."""
    if name == "ns":
        chosen = values[values.imag > 1e-9 * np.abs(values)]
    else:
        chosen = values[(np.abs(values.imag) <= 1e-9 * np.abs(values)) & (values.real < 0)]
    if len(chosen) == 0:
        return complex("nan")
    return complex(chosen[np.argmin(np.abs(np.log(np.abs(chosen))))])


def log_critical(orbit: RefinedOrbit, name: str) -> float:
    """log|multiplier| of the critical one; raises NotConverged if no multiplier is of its kind."""
    value = float(np.log(abs(critical(multipliers_by_product(orbit), name))))
    if not np.isfinite(value):
        raise NotConverged(f"no multiplier of the kind {name} at {orbit.speed:g} m/s")
    return value


def _extremes(field: Field, states: Array, lengths: Array) -> tuple[Array, Array]:
    """Largest and smallest y, phi, z: where the velocity vanishes inside a segment, by Newton's method on the flow."""
    flow = gauss_flow(field)
    highest, lowest = states[:, :3].max(axis=0), states[:, :3].min(axis=0)
    following = np.roll(states, -1, axis=0)
    for i in range(3):
        for k in np.flatnonzero(states[:, 3 + i] * following[:, 3 + i] < 0):
            v, w = states[k, 3 + i], following[k, 3 + i]
            t, end = lengths[k] * v / (v - w), states[k]
            for _ in range(8):
                end = flow(states[k], t)[0]
                t -= end[3 + i] / field(end)[0][3 + i]
            highest[i], lowest[i] = max(highest[i], end[i]), min(lowest[i], end[i])
    return highest, lowest


def multipliers_by_product(orbit: RefinedOrbit, digits: int = 100) -> np.ndarray:
    """Eigenvalues of the product of the segments in `digits` digits, largest first; shape (6,), complex."""
    with mpmath.workdps(digits):
        product = mpmath.eye(6)
        for matrix in orbit.monodromy:
            product = mpmath.matrix(matrix.tolist()) * product
        values = np.array([complex(v) for v in mpmath.eig(product, left=False, right=False)])
    return _largest_first(values)


def multipliers_by_iteration(orbit: RefinedOrbit, sweeps: int = 150) -> np.ndarray:
    """By orthogonal iteration: blocks of multipliers of like size are left together and multiplied as they are."""
    q = np.eye(6)
    for _ in range(sweeps):
        factors = []
        for matrix in orbit.monodromy:
            q, r = np.linalg.qr(matrix @ q)
            factors.append(r)
    # q and the q before the last sweep span the same spaces, but within blocks they may differ by a rotation
    before, q_before = [], q
    for matrix in orbit.monodromy:
        q, r = np.linalg.qr(matrix @ q)
        before.append(r)
    turn = q_before.T @ q  # block diagonal
    logs = np.sum([np.log(np.abs(np.diag(r))) for r in before], axis=0)
    values: list[complex] = []
    at = 0
    while at < 6:
        end = at + 1
        while end < 6 and (logs[end] > logs[end - 1] - 1.0 or np.abs(turn[:end, end:]).max() > 1e-9):
            end += 1
        # scaled by the mean factor, so that the product of a block can neither vanish nor overflow
        scale = float(np.mean(logs[at:end]))
        block = np.eye(end - at)
        for r in before:
            block = r[at:end, at:end] @ block * np.exp(-scale / len(before))
        block = turn[at:end, at:end] @ block
        values.extend(np.linalg.eigvals(block) * np.exp(scale))
        at = end
    return _largest_first(np.array(values, dtype=complex))


def distance(first: np.ndarray, second: np.ndarray) -> float:
    """Largest relative distance between two sets of multipliers, each with its nearest partner."""
    return float(max(np.min(np.abs(second - value)) / abs(value) for value in first))


def _largest_first(values: np.ndarray) -> np.ndarray:
    return values[np.lexsort((-values.imag, -np.log(np.abs(values)).round(9)))]
