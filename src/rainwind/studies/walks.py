"""What every walk of a study goes through: a picture is drawn from whole branches or not at all."""

from typing import TypeVar

from rainwind.dynamics.orbit_results import OrbitBranch
from rainwind.dynamics.results import Branch, Ended

Walked = TypeVar("Walked", Branch, OrbitBranch)


def whole(branch: Walked) -> Walked:
    """The branch; KeyboardInterrupt if the user stopped its walk."""
    if Ended.INTERRUPTED in branch.ended:
        raise KeyboardInterrupt
    return branch
