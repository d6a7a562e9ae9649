"""The pages of each stay: its sentences, the numbers of every mode side by side, the code checks."""

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from math import degrees, isinf

from rainwind.engineering.answers import BridgeAnswer, CodeCheck, ModeAnswer, StayAnswer
from rainwind.engineering.cable import Cable, Damper
from rainwind.reporting import words
from rainwind.reporting.content import Block, Cell, Points, Section, Table, Words
from rainwind.reporting.quantities import QUANTITIES

__all__ = ["stay_pages"]

_BESIDE = 4  # modes in one table


def stay_pages(answer: BridgeAnswer) -> Iterator[Section]:
    """A chapter with a part for each stay."""
    yield Section("Stay by stay", (Words(_BANDS, "small"),), new_page=True)
    for number, stay in enumerate(answer.stays):
        begins = number > 0 and not stay.failure
        title = f"Stay {words.shortened(stay.cable.name)}"
        yield Section(title, tuple(_stay(stay)), level=2, new_page=begins, one_page=not stay.failure)


_BANDS = (
    "A band stands as its middle (5 to 95 %), and, where the thing does not exist in all samples, with the share "
    "of those in which it does. Amplitudes are those of the antinode."
)


def _stay(stay: StayAnswer) -> Iterator[Block]:
    yield Words(_cable(stay.cable), "small")
    if stay.failure:
        yield Words(f"Not computed: {stay.failure}", "warning")
        return
    yield Words(f"{words.said(stay.verdict)}; margin: {words.margin(stay.margin)}", "strong")
    yield Points(stay.sentences)
    for begin in range(0, len(stay.modes), _BESIDE):
        yield _modes(stay, stay.modes[begin : begin + _BESIDE])
    yield from _cycles([mode for mode in stay.modes if mode.cycles is not None and mode.cycles.sum() > 0])
    if stay.checks:
        yield _checks(stay.checks)


def _cable(cable: Cable) -> str:
    said = (
        f"Length {cable.length:.4g} m, diameter {1e3 * cable.diameter:.4g} mm, {cable.mass:.4g} kg/m, tension "
        f"{cable.tension / 1e3:.4g} kN, inclination {degrees(cable.inclination):.3g}°, rising towards "
        f"{words.compass(cable.heading)}, surface {cable.surface}."
    )
    return " ".join([said, *map(_damper, cable.dampers)]) if cable.dampers else f"{said} No damper."


def _damper(damper: Damper) -> str:
    support = (
        ""
        if isinf(damper.support_stiffness)
        else f" on a support of {damper.support_stiffness / 1e6:.3g} MN/m"
    )
    return (
        f"Damper of {damper.coefficient / 1e3:.3g} kNs/m, {damper.position:.3g} m from the {damper.end} anchorage"
        f"{support}."
    )


def _modes(stay: StayAnswer, modes: Sequence[ModeAnswer]) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for group, quantities in groupby(QUANTITIES, key=lambda one: one.group):
        told = [one for one in quantities if any(one.value(stay, mode) is not None for mode in modes)]
        if told:
            rows.append((Cell(group),))
        for one in told:
            label = one.label + (f" ({one.unit})" if one.unit and one.said is None else "")
            rows.append((Cell(label), *(Cell(one.text(stay, mode)) for mode in modes)))
    header = ("", *(f"Mode {mode.number}" for mode in modes))
    wide = 0.37
    widths = (wide, *[(1 - wide) / max(len(modes), 3)] * len(modes))
    return Table(header, tuple(rows), widths=widths)


def _cycles(modes: Sequence[ModeAnswer]) -> Iterator[Table]:
    """One row a mode, for modes with the same bins of amplitude; those of a stay have."""
    binned = [(mode.number, mode.cycles, mode.cycle_edges) for mode in modes]
    for edges, same in groupby(binned, key=lambda one: () if one[2] is None else tuple(one[2].tolist())):
        rows = [
            (f"Mode {number}", *(_rounded(float(count)) for count in cycles))
            for number, cycles, _ in same
            if cycles is not None
        ]
        header = ("Amplitude (m)", *(f"{a:.2g} to {b:.2g}" for a, b in pairwise(edges)))
        first = 0.09
        widths = (first, *[(1 - first) / max(len(edges) - 1, 1)] * (len(edges) - 1))
        yield Table(
            header,
            tuple(tuple(Cell(text) for text in row) for row in rows),
            "Cycles a year by amplitude, half peak to peak; full vibration from the first minute of rain is more than "
            "there will be.",
            widths,
        )


def _checks(checks: Sequence[CodeCheck]) -> Table:
    rows = tuple(
        (
            Cell(one.rule),
            Cell(one.what),
            Cell(f"{words.number(one.value)} {one.unit}".strip()),
            Cell(f"{one.sense} {one.limit:.3g} {one.unit}".strip()),
            Cell("✓ met" if one.passes else "✗ not met", "pass" if one.passes else "fail"),
        )
        for one in checks
    )
    header = ("Rule", "What", "Value", "Asked", "")
    caption = (
        "Codes and guidelines, for the mode with the least damping; amplitudes at the high end of the band."
    )
    return Table(header, rows, caption, (0.14, 0.42, 0.14, 0.17, 0.13), (0, 1, 4))


def _rounded(count: float) -> str:
    """A whole number of two significant digits: more the counts do not carry."""
    return f"{float(f'{count:.2g}'):.0f}"
