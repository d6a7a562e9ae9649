"""The stiff engine: blocks of Rosenbrock steps of one trajectory."""

import numpy as np

from rainwind.dynamics.drive import Drive
from rainwind.dynamics.kernels import rosenbrock as kernel
from rainwind.dynamics.kernels.values import specialised
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.system import System

BLOCK = 256


class Rosenbrock:
    """Steps of Rodas5P along one trajectory of a system, with parameters that may follow signals.

    moving: how many operations of the tape a step has to repeat.
    """

    def __init__(self, system: System, drive: Drive, tolerance: float) -> None:
        n = len(system.states)
        inputs = system.inputs(np.zeros(n))
        varies = np.arange(inputs.size) < n
        varies[drive.numbers] = True
        operations, template, outputs = system.tape.arrays
        self._tape = (*specialised(operations, template, inputs, varies), outputs)
        self._drive = drive
        self._tolerance = tolerance
        self.moving = len(self._tape[0])
        self.refused = 0

    def advance(
        self, t: float, state: np.ndarray, sizes: np.ndarray, step: float, end: float, most: int = BLOCK
    ) -> tuple[Pieces, int, float]:
        """At most `most` steps towards `end`: their pieces, a status of the kernel, the next step to try.

        state and sizes are moved on in place.
        """
        times = np.empty(most + 1)
        coefficients = np.empty((most, state.size, kernel.WIDTH))
        count, status, _, step, refused = kernel.advance(
            *self._tape, self._drive.numbers, self._drive.pieces.times, self._drive.pieces.coefficients,
            state, sizes, t, step, end, self._tolerance, times, coefficients,
        )  # fmt: skip
        self.refused += refused
        return Pieces(times[: count + 1], coefficients[:count]), status, step
