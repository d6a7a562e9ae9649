"""Parameters that follow signals during a run: one table of polynomials between all their knots."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.signals import Signal


@dataclass(frozen=True, eq=False)
class Drive:
    """names: the driven parameters; numbers (m,): theirs among the inputs of the tape; pieces: their values, whose
    times are the knots of all signals between 0 and the end of the run."""

    names: tuple[str, ...]
    numbers: np.ndarray
    pieces: Pieces

    def on(self, times: np.ndarray) -> np.ndarray:
        """Coefficients (k, m, 4) in powers of t - times[k], on steps that stop at every knot: times (k + 1,)."""
        return self.pieces.starting(times[:-1])


def drive(signals: Mapping[str, Signal], numbers: Mapping[str, int], duration: float) -> Drive:
    """The table of some signals, each of which covers [0, duration]."""
    knots = [s.knots[(s.knots > 0.0) & (s.knots < duration)] for s in signals.values()]
    times = np.unique(np.concatenate([[0.0, duration], *knots]))
    table = np.zeros((times.size - 1, len(signals), 4))
    for i, signal in enumerate(signals.values()):
        one = Pieces(signal.knots, signal.coefficients[:, None, :])
        table[:, i : i + 1, : signal.coefficients.shape[1]] = one.starting(times[:-1])
    found = np.array([numbers[name] for name in signals], dtype=np.int64)
    return Drive(tuple(signals), found, Pieces(times, table))
