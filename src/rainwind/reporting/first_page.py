"""The first page: what was asked, one row a stay, what it means and what to do, for a reader with ten minutes."""

from collections.abc import Iterator
from math import isfinite

from rainwind.engineering.answers import BridgeAnswer, ModeAnswer, StayAnswer
from rainwind.reporting import words
from rainwind.reporting.content import Block, Cell, Points, Section, Table, Words

__all__ = ["first_page", "key_sentences", "next_steps"]

RECONSTRUCTED = (
    "The coefficient sets of this model are reconstructed from one paper, not measured on these stays, and the rivulet "
    "of a real stay is known to nobody. The bands scatter both by judgement; no band covers a curve of another shape."
)


def first_page(answer: BridgeAnswer) -> Section:
    """The section without a heading of its own: the title stands above it."""
    return Section("", tuple(_blocks(answer)))


def _blocks(answer: BridgeAnswer) -> Iterator[Block]:
    yield Words(_asked(answer))
    if answer.interrupted:
        yield Words(
            f"The computation was interrupted: {len(answer.stays)} of {words.stays(len(answer.bridge.stays))} were "
            "reached, the others are missing here.",
            "warning",
        )
    yield Words(RECONSTRUCTED, "warning")
    yield Words(_counts(answer), "strong")
    table = (_table(answer), Words(_legend(), "small"))
    if len(answer.stays) <= _FIT:
        yield from table
    yield Words("What it means", "strong")
    yield Points(key_sentences(answer))
    yield Words("What to do next", "strong")
    yield Points(next_steps(answer), numbered=True)
    if len(answer.stays) > _FIT:
        yield from table


def _asked(answer: BridgeAnswer) -> str:
    asked, limits = answer.bridge.question, answer.bridge.limits
    low, high = asked.speeds
    return (
        f"Asked: whether rain and wind make {words.stays(len(answer.bridge.stays))} vibrate, in "
        f"{asked.modes} mode{'' if asked.modes == 1 else 's'} each, with wind of {low:g} to {high:g} m/s from "
        f"{asked.directions} directions; how much damping stops it. {_samples(answer)} Rivulets have been observed at "
        f"{limits.observed_speeds[0]:g} to {limits.observed_speeds[1]:g} m/s: margins belong to these speeds. Wind "
        f"speeds are those at {answer.bridge.site.reference_height:g} m."
    )


_ENOUGH = 128
"""Samples in all. The high end of the damping that one stay needs was 5.6 and 5.3 % with 32,
2.9 and 4.2 % with 64, 4.4 and 4.0 % with 128, 3.6 and 3.7 % with 256, of two seeds."""


def _samples(answer: BridgeAnswer) -> str:
    asked = answer.bridge.question
    total = asked.samples * len(asked.sets)
    sets = len(asked.sets)
    few = (
        f" With so few samples the ends are rough: {_ENOUGH} in all settle them better."
        if total < _ENOUGH
        else ""
    )
    return (
        f"Bands are 5, 50 (middle) and 95 % of {total} samples ({asked.samples} of rivulet and slopes with "
        f"{sets} coefficient set{'' if sets == 1 else 's'}).{few}"
    )


def _counts(answer: BridgeAnswer) -> str:
    found = [stay.verdict for stay in answer.stays]
    said = [
        f"{found.count(verdict)} {one.word} {one.symbol}"
        for verdict, one in words.VERDICTS.items()
        if found.count(verdict)
    ]
    return f"{words.stays(len(found))}: " + ", ".join(said)


_FIT = 14  # stays whose table leaves room on the page for what it means
_FAR = 0.1  # x_d/L: beyond it no damper is called near an anchorage
_WIDTHS = (0.1, 0.145, 0.095, 0.085, 0.14, 0.14, 0.13, 0.165)


def _table(answer: BridgeAnswer) -> Table:
    header, rows = words.summary_rows(answer)
    cells = tuple(_row(stay, row) for stay, row in zip(answer.stays, rows, strict=True))
    return Table(tuple(text.capitalize() for text in header), cells, widths=_WIDTHS, left=(0, 1))


def _row(stay: StayAnswer, texts: list[str]) -> tuple[Cell, ...]:
    """The marked row; one that failed says why over the rest of its width."""
    if stay.failure:
        return (
            Cell(texts[0]),
            Cell(words.said(stay.verdict), "failed"),
            Cell(words.shortened(stay.failure, 240)),
        )
    return tuple(Cell(text, stay.verdict if i == 1 else "") for i, text in enumerate(texts))


def _legend() -> str:
    meanings = "; ".join(f"{one.symbol} {one.word}: {one.meaning}" for one in words.VERDICTS.values())
    return (
        f"{meanings}. Margin: damping there over damping needed at the high end of its band, at observed speeds, in "
        "the mode that decides; below 1 there is too little. Bands: middle (low to high end). Amplitude: half peak to "
        "peak, of the largest mode. Open: the range reaches the highest speed looked at. Per cents below a band are "
        "shares of the samples."
    )


def key_sentences(answer: BridgeAnswer) -> tuple[str, ...]:
    """Three to five sentences on the bridge as a whole."""
    return tuple(_sentences(answer))


def _sentences(answer: BridgeAnswer) -> Iterator[str]:
    done = [stay for stay in answer.stays if stay.modes]
    if not done:
        yield "No stay could be computed; the reasons stand in the table."
        return
    worst = min(done, key=lambda stay: stay.margin)
    mode = worst.worst
    if mode is not None and isfinite(worst.margin):
        yield (
            f"The least margin is {words.margin(worst.margin)}, stay {words.named(worst)}, mode {mode.number}: it has "
            f"{words.number(100 * mode.damping_total)} % of critical damping and needs "
            f"{words.band(words.in_percent(mode.damping_needed_observed), unit='%')}."
        )
    else:
        yield "At the observed wind speeds no stay needs damping."
    ranged = [(stay, words.range_mode(stay)) for stay in done]
    hit = [(stay, one) for stay, one in ranged if one is not None]
    if hit:
        stay, one = min(hit, key=lambda pair: pair[1].range_low.middle)
        yield (
            f"Rain-wind vibration is possible in {len(hit)} of {words.stays(len(answer.stays))}; it begins first on "
            f"stay {words.named(stay)}, mode {one.number}, at {words.band(one.range_low, unit='m/s')}."
        )
        pairs = [(stay, mode) for stay in done if (mode := words.amplitude_mode(stay)) is not None]
        if pairs:
            yield _largest(answer, pairs)
    else:
        yield "Small vibrations grow at no wind speed looked at, in any sample."
    unlimited = [mode.unlimited for _, mode in hit]
    if unlimited and max(unlimited) > 0:
        yield (
            f"Where a range is open, the model still vibrates at {answer.bridge.question.speeds[1]:g} m/s, the highest "
            "speed looked at; rivulets have not been observed above "
            f"{answer.bridge.limits.observed_speeds[1]:g} m/s."
        )
    if len(done) > 1:
        yield _enough(done)


def _enough(done: list[StayAnswer]) -> str:
    """How many stays have enough by the model's middle, its high end, and the rule."""

    def count(level: str) -> int:
        return sum(
            all(mode.damping_total >= getattr(mode.damping_needed_observed, level) for mode in stay.modes)
            for stay in done
        )

    rule = sum(all(mode.damping_total >= mode.rule_damping for mode in stay.modes) for stay in done)
    return (
        f"Stays with enough damping, of {len(done)} computed: {count('middle')} at the middle of the band, "
        f"{count('high')} at its high end, {rule} by the PTI rule."
    )


def _largest(answer: BridgeAnswer, pairs: list[tuple[StayAnswer, ModeAnswer]]) -> str:
    stay, mode = max(pairs, key=lambda pair: pair[1].amplitude.high)
    limit = answer.bridge.limits.amplitude_diameters
    in_diameters = mode.amplitude.high / stay.cable.diameter
    return (
        f"The largest amplitude is {words.band(mode.amplitude, unit='m')}, half peak to peak, stay "
        f"{words.named(stay)}, mode {mode.number}: {words.number(in_diameters, 2)} diameters at the high end, "
        f"{'above' if in_diameters > limit else 'within'} the accepted {limit:g}."
    )


def next_steps(answer: BridgeAnswer) -> tuple[str, ...]:
    """What to do, the stays with the least margin first."""
    return tuple(_steps(answer))


def _steps(answer: BridgeAnswer) -> Iterator[str]:
    short = _by_margin(answer, "insufficient")
    if short:
        yield (
            f"Add damping to {_names(short, answer)}. {_needs(short[0])} Each stay's page says what a damper would "
            "have to be."
        )
    doubtful = _by_margin(answer, "doubtful")
    if doubtful:
        yield (
            f"Decide about {_names(doubtful, answer)}: measure the damping of the worst modes first, since every "
            f"margin is proportional to it. {_needs(doubtful[0])} Each stay's page says what would do at the middle "
            "and at the high end."
        )
    if any(stay.cable.assumed for stay in answer.stays) or answer.bridge.assumptions:
        yield "Replace what was assumed by what is measured or drawn; it stands at the end of this report."
    failed = [stay for stay in answer.stays if stay.failure]
    for stay in failed[:3]:
        yield f"Stay {words.named(stay)} could not be computed: {words.shortened(stay.failure, 160)}"
    if len(failed) > 3:
        yield f"{len(failed)} stays could not be computed; their parts say why: {_names(failed, answer)}."
    if answer.interrupted:
        yield "Run the same command again; it goes on from the stays that are done."
    if not short and not doubtful and not failed:
        yield "No more damping is needed; watch the stays in rain and wind, as for every bridge."


def _by_margin(answer: BridgeAnswer, verdict: str) -> list[StayAnswer]:
    return sorted((stay for stay in answer.stays if stay.verdict == verdict), key=lambda stay: stay.margin)


def _needs(stay: StayAnswer) -> str:
    """What the stay lacks at the high end of the band, or by the rule, and where a damper would have to stand."""
    mode = stay.worst
    assert mode is not None
    target, there = mode.damping_needed_observed.high, mode.damping_total
    if there >= target:
        mode = max(stay.modes, key=lambda one: one.rule_damping - one.damping_total)
        return (
            f"In stay {words.named(stay)} the model finds enough, but the PTI rule asks for "
            f"{words.number(100 * mode.rule_damping)} % of critical in mode {mode.number}, where there is "
            f"{words.number(100 * mode.damping_total)} %."
        )
    place = 2.0 * (target - mode.damping_own)
    far = ", no longer near: think of the surface and of cross-ties too" if place > _FAR else ""
    return (
        f"To be safe at the high end of the band stay {words.named(stay)}, of the least margin, needs "
        f"{words.number(100 * target)} % of critical in mode {mode.number}, where there is "
        f"{words.number(100 * there)} %. A damper near an anchorage adds at most about half its distance x_d over the "
        f"length L, so x_d/L would have to be at least {words.number(place, 2)}{far}."
    )


def _names(stays: list[StayAnswer], answer: BridgeAnswer) -> str:
    if len(stays) == len(answer.stays) > 3:
        return f"all {len(stays)} stays"
    return ("stay " if len(stays) == 1 else "stays ") + words.joined([stay.cable.name for stay in stays])
