"""What a damper near the anchorage would have to be, so that a stay gets the damping that its modes need."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite

from rainwind.engineering.answers import ModeAnswer, StayAnswer
from rainwind.engineering.damper_design import FARTHEST, DamperDesign, design_for
from rainwind.errors import RainwindError

__all__ = ["Remedy", "damper_remedy", "remedy_sentences"]

_LARGEST = 0.1  # ratio: more no damper near an anchorage adds


@dataclass(frozen=True)
class Remedy:
    """One damper for all modes assessed; design at `practice` times the least position, or None where none will do.

    targets: ratio to be added, by mode.
    """

    targets: Mapping[int, float]
    design: DamperDesign | None


def damper_remedy(answer: StayAnswer, level: str) -> Remedy:
    """The damper that meets the damping needed at the band's "middle" or "high" end, over the observed speeds.

    It stands in place of those the stay has. Of one position the least that would do is found first; the design is
    that at 1.5 times as far (practice, a guess).
    """
    targets = {mode.number: need for mode in answer.modes if (need := _missing(mode, level)) > 0.0}
    if not targets or max(targets.values()) > _LARGEST:
        return Remedy(targets, None)
    cable = answer.cable
    try:
        least = design_for(cable, targets, 2.0 * max(targets.values()) * cable.length).least_position
        if not isfinite(least) or 1.5 * least > FARTHEST * cable.length:
            return Remedy(targets, None)
        design = design_for(cable, targets, 1.5 * least)
        return Remedy(targets, design if isfinite(design.low) else None)
    except RainwindError:
        return Remedy(targets, None)


def remedy_sentences(answer: StayAnswer) -> Iterator[str]:
    """What a damper would have to be for the middle and for the high end of the band; none where enough is there."""
    if answer.failure or answer.verdict == "sufficient":
        return
    middle, high = (damper_remedy(answer, level) for level in ("middle", "high"))
    if middle.targets:
        yield _sentence(answer, middle, "the middle")
    if high.targets:
        yield _sentence(answer, high, "the high end")


def _missing(mode: ModeAnswer, level: str) -> float:
    return getattr(mode.damping_needed_observed, level) - mode.damping_own


def _sentence(answer: StayAnswer, remedy: Remedy, where: str) -> str:
    cable, design = answer.cable, remedy.design
    worst = max(remedy.targets, key=lambda number: remedy.targets[number])
    most = 100 * remedy.targets[worst]
    instead = ", in place of those it has," if cable.dampers else ""
    begin = f"For {where} of the band a damper{instead} would have to add up to {most:.2f} % (mode {worst})"
    if design is None:
        return f"{begin}: no single damper near the anchorage can do that; see the inputs, the surface and cross-ties."
    share = 100 * design.least_position / cable.length
    low, high = (_three_digits(value / 1e3) for value in (design.low, design.high))
    return (
        f"{begin}: it must stand at least {design.least_position:.2f} m from its anchorage ({share:.2g} % of the "
        f"length); at {design.position:.2f} m, a coefficient of {low} to {high} kNs/m will do."
    )


def _three_digits(value: float) -> str:
    """A number with three digits that count, without an exponent."""
    return f"{float(f'{value:.3g}'):g}"
