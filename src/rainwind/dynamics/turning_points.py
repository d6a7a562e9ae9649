"""Zeros and extremes of the columns of polynomial pieces."""

import numpy as np

from rainwind.dynamics.kernels.zeros import find_zeros
from rainwind.dynamics.pieces import Pieces


def zeros_of(pieces: Pieces, i: int) -> tuple[np.ndarray, np.ndarray]:
    """The zeros of one column of some pieces, and whether it rises there."""
    n, found, first, sign = pieces.coefficients.shape[1], [], 0, 0
    none, room = np.zeros((len(pieces), 0, 4)), max(1024, 4 * len(pieces))
    end = pieces.at(pieces.times[-1])
    while first < len(pieces):
        at, piece, rising = np.empty(room), np.empty(room, dtype=np.int64), np.empty(room, dtype=np.bool_)
        count, sign, looked = find_zeros(
            np.zeros((0, 4), dtype=np.int64), np.zeros(n), i, pieces.times[first:], pieces.coefficients[first:],
            np.zeros(0, dtype=np.int64), none[first:], end, sign, at, piece, rising,
        )  # fmt: skip
        found.append((pieces.times[first:][piece[:count]] + at[:count], rising[:count]))
        first += looked
        room = room if looked else 2 * room
    return np.concatenate([t for t, _ in found]), np.concatenate([r for _, r in found])


def extremes_of(pieces: Pieces) -> np.ndarray:
    """The lowest and the highest value of every column (2, n), on the polynomials themselves."""
    slope, joints = pieces.derivative(), pieces.joints()
    low, high = joints.min(axis=0), joints.max(axis=0)
    for i in range(low.size):
        times, _ = zeros_of(slope, i)
        if times.size:
            values = pieces.at(np.minimum(times, pieces.times[-1]))[:, i]
            low[i], high[i] = min(low[i], values.min()), max(high[i], values.max())
    return np.array([low, high])
