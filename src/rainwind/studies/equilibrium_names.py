"""Which of the paper's letters A, B, C, D the equilibria of a diagram have, and what the letters mean."""

from itertools import pairwise

import numpy as np

from rainwind.dynamics.results import Branch
from rainwind.physics.model import RivuletModel
from rainwind.studies.equilibrium_map import equilibria_by_letter, equilibrium_map, speed_window

SPEED = "wind.speed"
LETTERS = (
    "The paper's letters: A is the lower rivulet, which hangs below; D is the upper rivulet; B and C are the "
    "equilibria beside D, which are never stable."
)
_SAME = 1e-3  # of states in SI: a walk's point and an equilibrium computed there


def letters_of(
    model: RivuletModel, along: str, window: tuple[float, float], branches: tuple[Branch, ...]
) -> tuple[tuple[str, ...], ...]:
    """For each branch a letter for each of its points, "" where an equilibrium has none.

    Between two folds a branch keeps its letter; it is looked up half way, among all equilibria there.
    """
    speeds = window if along == SPEED else speed_window(model)
    known = equilibrium_map(model, speeds) if along == SPEED else None
    found = []
    for branch in branches:
        letters = np.full(len(branch), "", dtype=object)
        cuts = [-np.inf, *(p.arclength for p in branch.points("fold")), np.inf]
        for low, high in pairwise(cuts):
            inside = np.flatnonzero((branch.arclength > low) & (branch.arclength < high))
            if not inside.size:
                continue
            half = inside[inside.size // 2]
            value, state = float(branch.parameter[half]), branch.state[half]
            if known is not None:
                letters[inside] = known.letter_near(value, state)
                continue
            there = equilibria_by_letter(model.with_parameters({along: value}), speeds)
            near = (name for name, one in there.items() if np.abs(one.state - state).max() < _SAME)
            letters[inside] = next(near, "")
        found.append(tuple(map(str, letters)))
    return tuple(found)


def with_letter(letter: str) -> str:
    """How a sentence names an equilibrium."""
    return f"equilibrium {letter}" if letter else "an equilibrium without a letter"
