"""What a target is: the paper's words and number, ours, and the verdict that follows from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

VERDICTS = ("met", "partly", "missed", "not_computed", "impossible")


@dataclass(frozen=True)
class Statement:
    """One statement of the paper: `paper` is its number, numbers or words; where: its section.

    tolerance: how far `computed` may lie from `paper`, in `unit`; None for statements of kind or sign.
    fitted_key: the note in a coefficient set's [fitted] that says the set was fitted to this.
    """

    id: str
    what: str
    paper: float | list[float] | str
    unit: str
    where: str
    tolerance: float | None = None
    fitted_key: str | None = None


@dataclass(frozen=True)
class Part:
    """One thing that must hold for a statement to be met."""

    what: str
    holds: bool


@dataclass(frozen=True)
class Rows:
    """A small table of numbers behind a target, for a reader who wants more than the verdict."""

    header: tuple[str, ...]
    rows: tuple[tuple[str | float | None, ...], ...]


@dataclass(frozen=True)
class Outcome:
    """What the model gives. quantity: what `computed` is; verdict: None where it follows from the parts."""

    computed: float | list[float] | None = None
    quantity: str = ""
    parts: tuple[Part, ...] = ()
    note: str = ""
    details: Rows | None = None
    verdict: str | None = None


@dataclass(frozen=True)
class Target:
    """A statement and its outcome, with whether the coefficient set was fitted to it."""

    statement: Statement
    outcome: Outcome
    fitted: bool

    @property
    def verdict(self) -> str:
        """met where every part holds, missed where none does, partly between."""
        if self.outcome.verdict is not None:
            return self.outcome.verdict
        held = [part.holds for part in self.outcome.parts]
        return "met" if held and all(held) else "partly" if any(held) else "missed"

    def record(self) -> dict[str, Any]:
        """As plain data for targets.json."""
        of, got = self.statement, self.outcome
        return {
            "id": of.id,
            "what": of.what,
            "paper": of.paper,
            "computed": got.computed,
            "unit": of.unit,
            "fitted": self.fitted,
            "verdict": self.verdict,
            "fitted_to": (of.fitted_key or "").replace("_", " ") if self.fitted else "",
            "quantity": got.quantity,
            "tolerance": of.tolerance,
            "where": of.where,
            "parts": [{"what": part.what, "holds": part.holds} for part in got.parts],
            "note": got.note,
            "details": None
            if got.details is None
            else {"header": list(got.details.header), "rows": [list(row) for row in got.details.rows]},
        }


def close(computed: float | None, paper: float, tolerance: float) -> bool:
    """Whether a number was found and lies within the tolerance."""
    return computed is not None and abs(computed - paper) <= tolerance


def falling(values: Sequence[float | None]) -> bool:
    """Whether all numbers were found and each lies below the one before."""
    found = [v for v in values if v is not None]
    return len(found) == len(values) and all(b < a for a, b in pairwise(found))


def rising(values: Sequence[float | None]) -> bool:
    """Whether all numbers were found and each lies above the one before."""
    return falling([None if v is None else -v for v in values])


def alike(values: Sequence[float | None], tolerance: float) -> bool:
    """Whether all numbers were found and each lies within the tolerance of the first."""
    found = [v for v in values if v is not None]
    return len(found) == len(values) and all(abs(v - found[0]) <= tolerance for v in found)
