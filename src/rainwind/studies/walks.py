"""What every walk of a study goes through: a picture is drawn from whole branches or not at all."""

from rainwind.dynamics.results import Branch, Ended


def whole(branch: Branch) -> Branch:
    """The branch; KeyboardInterrupt if the user stopped its walk."""
    if Ended.INTERRUPTED in branch.ended:
        raise KeyboardInterrupt
    return branch
