"""Which engine takes the next block of steps: the one that costs less for the time it covers."""

import numpy as np

from rainwind.dynamics.drive import Drive
from rainwind.dynamics.kernels import rosenbrock as kernel
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.rosenbrock import BLOCK, Rosenbrock
from rainwind.dynamics.system import System
from rainwind.dynamics.trajectory import RunEnded

_WHY = {kernel.STEP_TOO_SMALL: RunEnded.STEP_TOO_SMALL, kernel.TOO_LARGE: RunEnded.RAN_AWAY}


class Choice:
    """The engines of one run, and which one is on. steps: how many of each so far."""

    def __init__(self, system: System, driven: Drive, tolerance: float, duration: float, method: str) -> None:
        self._stiff = Rosenbrock(system, driven, tolerance)
        self._step = 0.0
        self.steps = {"taylor": 0, "rosenbrock": 0}

    def advance(
        self, t: float, state: np.ndarray, sizes: np.ndarray, end: float, most: int
    ) -> tuple[Pieces, RunEnded | None]:
        """A block of steps, at most `most`, towards `end`; why it cannot go on, if so. Moves state and sizes on."""
        pieces, status, self._step = self._stiff.advance(t, state, sizes, self._step, end, min(most, BLOCK))
        self.steps["rosenbrock"] += len(pieces)
        return pieces, None if status == kernel.RUNNING else _WHY[status]
