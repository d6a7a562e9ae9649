"""All equilibria of the section: every root of the rivulet's balance, then of the cable's springs."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.physics.coefficients import CoefficientSet, Outside


@dataclass(frozen=True)
class Equilibria:
    """Placeholder."""

    states: np.ndarray

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """The states."""
        return np.array(self.states, dtype=dtype)

    def __len__(self) -> int:
        return len(self.states)

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter(self.states)


def find_all_equilibria(
    at: Any, coefficients: CoefficientSet, outside: Outside, degrees_of_freedom: int
) -> Equilibria:
    """Not yet built."""
    raise NotImplementedError
