"""Lowest and highest values of the states of a trajectory between given times, such as over each of its periods."""

import numpy as np

from rainwind.dynamics.trajectory import Trajectory
from rainwind.errors import InputError

_PARTS = 4  # of a step, in each of which one turning point is looked for
_NEWTON = 8  # iterations at most; the value at a turning point is flat, so a few already give it to rounding


def extremes_between(run: Trajectory, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest value of each state from each time to the next: (m - 1, n) both.

    times (m,): two or more, increasing, within the run. Turning points are located on the polynomials, to rounding; two
    of them within a quarter of a step would go unseen. Raises InputError.
    """
    times = np.asarray(times, dtype=float)
    if times.ndim != 1 or times.size < 2 or not np.all(np.diff(times) > 0.0):
        raise InputError(f"times must be two or more that increase; got {times!r}")
    edges = run.at(times)
    low, high = np.minimum(edges[:-1], edges[1:]), np.maximum(edges[:-1], edges[1:])
    part = run.pieces.part(float(times[0]), float(times[-1]))
    h, c = np.diff(part.times), part.coefficients
    scaled = c * (h[:, None] ** np.arange(c.shape[2]))[:, None, :]  # powers of s = (t - t_k) / h_k
    piece, state, s = _turning_points(scaled[:, :, 1:] * np.arange(1, c.shape[2]))
    values = _values(scaled[piece, state], s)
    at = part.times[piece] + s * h[piece]
    # joints too: a step meets the next one to the tolerance only, and may turn just there
    joint, count = part.times[:-1], c.shape[1]
    at = np.concatenate([at, np.repeat(joint, count)])
    state = np.concatenate([state, np.tile(np.arange(count), joint.size)])
    values = np.concatenate([values, c[:, :, 0].ravel()])
    k = np.clip(np.searchsorted(times, at, side="right") - 1, 0, times.size - 2)
    np.minimum.at(low, (k, state), values)
    np.maximum.at(high, (k, state), values)
    return low, high


def half_peak_to_peak(run: Trajectory, times: np.ndarray) -> np.ndarray:
    """Half the difference of the extremes of each state from each time to the next (m - 1, n). Raises InputError."""
    low, high = extremes_between(run, times)
    return 0.5 * (high - low)


def _turning_points(slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Piece, state and place 0..1 in the piece of each zero of the slopes (k, n, D), by safeguarded Newton steps."""
    if not slopes.size:
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int), np.zeros(0)
    nodes = np.arange(_PARTS + 1.0) / _PARTS
    at_nodes = slopes @ (nodes[:, None] ** np.arange(slopes.shape[2])).T
    piece, state, first = np.nonzero((at_nodes[..., :-1] > 0.0) != (at_nodes[..., 1:] > 0.0))
    d = slopes[piece, state]
    left, right = nodes[first], nodes[first + 1]
    rising = at_nodes[piece, state, first] <= 0.0
    a, b = at_nodes[piece, state, first], at_nodes[piece, state, first + 1]
    s = left + (right - left) * a / np.where(a == b, 1.0, a - b)
    second = d[:, 1:] * np.arange(1, d.shape[1])
    for _ in range(_NEWTON):
        f, slope = _values(d, s), _values(second, s)
        after = (f > 0.0) == rising
        left, right = np.where(after, left, s), np.where(after, s, right)
        new = s - f / np.where(slope == 0.0, 1.0, slope)
        new = np.where((new >= left) & (new <= right) & (slope != 0.0), new, 0.5 * (left + right))
        if np.all(np.abs(new - s) < 1e-9):
            s = new
            break
        s = new
    return piece, state, s


def _values(c: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Polynomials (m, D + 1), each at its own place (m,)."""
    found = np.zeros(s.shape)
    for j in reversed(range(c.shape[1])):
        found = found * s + c[:, j]
    return found
