"""The last pages: what was assumed, where numbers come from, how far to trust it, and the input as it was read."""

from collections.abc import Iterator

from rainwind import __version__
from rainwind.engineering.answers import BridgeAnswer
from rainwind.engineering.sources import SOURCES
from rainwind.reporting import words
from rainwind.reporting.content import Block, Points, Section, Verbatim, Words

__all__ = ["LIMITS", "assumptions", "back_pages"]

LIMITS = (
    "The coefficient sets are reconstructed from one paper. The band scatters their slopes by our judgement. No band "
    "covers a curve of another shape.",
    "The rivulet of a real stay is known to nobody. How it grows with the diameter is one of the scattered quantities.",
    "At low damping the model has no upper limit of wind speed. The report prints its range and that in which "
    "rivulets have been seen side by side.",
    "The damping needed is that of the linear limit. A vibration that is already there can live at a little more "
    "damping.",
    "One section stands for the whole stay, with one rivulet angle over its length. A sliced stay's antinode moved 13 "
    "to 38 % more than the section in two cases that were computed.",
    "The forces are quasi-steady: no vortices, no axial flow. Field vibrations sit at reduced wind speeds U/(f d) of "
    "19 to 48, where that is doubtful; the paper's cable at 80 to 148.",
)
"""How far to trust an assessment: the words of docs/assessment.md."""


def back_pages(answer: BridgeAnswer) -> Iterator[Section]:
    """Assumptions, limits, sources, the computation, the input."""
    yield Section("What was assumed", tuple(_assumed(answer)), new_page=True)
    yield Section("How far to trust it", (Points(LIMITS),))
    if answer.bridge.sources:
        yield Section("Sources of the input", (Points(answer.bridge.sources),))
    yield Section("Sources of the method", (Points(tuple(one.sentence for one in SOURCES.values())),))
    yield Section("The computation", (Words(_computed(answer)),))
    if answer.climate_notes:
        yield Section("Wind and rain records", (Points(answer.climate_notes),))
    yield Section("The input as it was read", (Verbatim(answer.case_text or "(none)"),), new_page=True)


def assumptions(answer: BridgeAnswer) -> tuple[tuple[str, str], ...]:
    """Each assumption once, with the stays that it belongs to in words."""
    found: dict[str, list[str]] = {}
    for stay in answer.stays:
        for said in dict.fromkeys(stay.assumptions or _fields(stay.cable.assumed)):
            found.setdefault(said, []).append(stay.cable.name)
    bridge = [(said, "the bridge") for said in answer.bridge.assumptions]
    return (*bridge, *((said, _whose(names, answer)) for said, names in found.items()))


def _fields(fields: tuple[str, ...]) -> tuple[str, ...]:
    if not fields:
        return ()
    return (f"Assumed, not measured: {words.joined([name.replace('_', ' ') for name in fields], 30)}.",)


def _whose(names: list[str], answer: BridgeAnswer) -> str:
    if len(names) == len(answer.stays) and len(names) > 1:
        return "all stays"
    return f"{'stay' if len(names) == 1 else 'stays'} {words.joined(names)}"


def _assumed(answer: BridgeAnswer) -> Iterator[Block]:
    found = assumptions(answer)
    if not found:
        yield Words("Nothing beyond the method itself.")
        return
    for whose in ("the bridge", "all stays"):
        common = tuple(said for said, of in found if of == whose)
        if common:
            yield Words(f"For {whose}", "strong")
            yield Points(common)
    rest: dict[str, list[str]] = {}
    for said, of in found:
        if of not in ("the bridge", "all stays"):
            rest.setdefault(of, []).append(said)
    if rest:
        yield Words("For some stays", "strong")
        yield Points(tuple(f"{of[0].upper()}{of[1:]}: {' '.join(said)}" for of, said in rest.items()))


def _computed(answer: BridgeAnswer) -> str:
    asked = answer.bridge.question
    return (
        f"rainwind {__version__}, {answer.seconds:.0f} s. Coefficient sets: {words.joined(list(asked.sets))}; "
        f"{asked.samples} samples of rivulet and slopes for each, seed {asked.seed}. Air of "
        f"{answer.bridge.site.density:g} kg/m³, wind profile {answer.bridge.site.profile}."
    )
