"""How a report says things: numbers, bands, directions, verdicts; a value that does not exist is "none"."""

from dataclasses import dataclass, replace
from math import floor, isinf, isnan, log10

from rainwind.engineering.answers import Band, BridgeAnswer, ModeAnswer, StayAnswer, Verdict
from rainwind.engineering.wording import NONE, compass, share

__all__ = [
    "VERDICTS", "VerdictWords", "amplitude_mode", "band", "band_lines", "band_parts", "compass",
    "for_figure", "in_percent", "joined", "margin", "named", "number", "range_mode", "said", "share",
    "shortened", "speed_range", "stays", "summary_row", "summary_rows", "unbroken",
]  # fmt: skip

_NOTHING = 1e-6  # of any unit printed: less is rounding
NOT_NEEDED = "no damping needed"


@dataclass(frozen=True)
class VerdictWords:
    """A verdict for the eye: its word, a symbol, the ink and paper of its mark; told apart in grey print too."""

    word: str
    symbol: str
    ink: str
    paper: str
    meaning: str


VERDICTS: dict[Verdict, VerdictWords] = {
    "sufficient": VerdictWords(
        "sufficient", "✓", "#0B4F3A", "#E3F3EC", "model and code rule both find enough damping"
    ),
    "doubtful": VerdictWords(
        "doubtful", "?", "#4A3200", "#F7D58A", "model and code rule disagree, or the band decides"
    ),
    "insufficient": VerdictWords(
        "insufficient", "✗", "#FFFFFF", "#A63A00", "model and code rule both find too little damping"
    ),
    "failed": VerdictWords("not computed", "–", "#333333", "#FFFFFF", "could not be computed"),
}


def number(value: float | None, digits: int = 3) -> str:
    """A number with so many significant digits, no exponent above 0.0001; nan and None are "none"."""
    if value is None or isnan(value):
        return NONE
    if isinf(value):
        return "no limit" if value > 0 else "minus no limit"
    if value == 0:
        return "0"
    if abs(value) < 1e-4:
        return f"{value:.{digits - 1}e}"
    return _minus(f"{value:.{_decimals(value, digits)}f}")


def band(values: Band | None, digits: int = 2, unit: str = "") -> str:
    """A band as "0.40 (0.25 to 0.61) %": the middle, the ends, and the share of samples where that is not all."""
    if values is None or not values.exists:
        return NONE
    text, there = band_parts(values, digits)
    text += f" {unit}" if unit else ""
    return f"{text}, {there}" if there else text


def band_lines(values: Band | None, digits: int = 2) -> str:
    """A band for a cell of a table: middle and ends, and in a second line the share of samples if not all."""
    if values is None or not values.exists:
        return NONE
    return "\n".join(part for part in band_parts(values, digits) if part)


def band_parts(values: Band, digits: int = 2) -> tuple[str, str]:
    """Middle and ends, and in how many samples (empty if in all): two texts of one band that exists."""
    there = "" if values.share >= 1.0 else f"in {share(values.share)} of samples"
    largest = max(abs(values.high), abs(values.low))
    if largest < _NOTHING:
        return "0", there
    decimals = _decimals(largest, digits)
    if abs(values.middle) >= _NOTHING:
        decimals = min(_decimals(largest, digits + 1), _decimals(values.middle, digits))
    low, middle, high = (_minus(f"{v:.{decimals}f}") for v in (values.low, values.middle, values.high))
    return f"{middle} ({low} to {high})", there


def margin(value: float) -> str:
    """The damping there over the damping needed: "0.62"; infinite where none is needed."""
    if isinf(value):
        return NOT_NEEDED
    return number(value, 2)


def joined(names: list[str], most: int = 12) -> str:
    """Names as "a, b and c"; of many the first ones and how many more."""
    names = [shortened(name, 30) for name in names]
    if len(names) > most:
        return f"{', '.join(names[:most])} and {len(names) - most} more"
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} and {names[-1]}"


def shortened(text: str, letters: int = 60) -> str:
    """The text in one line, cut with "…" where it is longer than so many letters."""
    text = " ".join(text.split())
    return text if len(text) <= letters else text[: letters - 1].rstrip() + "…"


def for_figure(text: str, letters: int = 24) -> str:
    """A text of a user, shortened, that matplotlib reads neither as a formula nor as a control character."""
    seen = "".join(letter for letter in text if letter.isprintable() or letter.isspace())
    return shortened(seen, letters).replace("$", r"\$")


def unbroken(text: str) -> str:
    """The text with per cent and metres per second kept with their numbers at the end of a line."""
    return text.replace(" %", "\u00a0%").replace(" m/s", "\u00a0m/\u2060s").replace("(m/s)", "(m/\u2060s)")


def said(verdict: Verdict) -> str:
    """Symbol and word of a verdict."""
    one = VERDICTS[verdict]
    return f"{one.symbol} {one.word}"


def stays(count: int) -> str:
    """ "1 stay", "2 stays"."""
    return f"{count} stay" if count == 1 else f"{count} stays"


def named(stay: StayAnswer, letters: int = 30) -> str:
    """The stay's name, short enough for a sentence or a figure."""
    return shortened(stay.cable.name, letters)


def _decimals(value: float, digits: int) -> int:
    if value == 0 or isnan(value) or isinf(value):
        return 1
    return min(max(digits - 1 - floor(log10(abs(value))), 0), 8)


def _minus(text: str) -> str:
    """With a true minus sign, and none before zero."""
    if text.startswith("-") and not text.strip("-0."):
        text = text[1:]
    return text.replace("-", "−")


def range_mode(stay: StayAnswer) -> ModeAnswer | None:
    """The mode whose range of wind speed stands for the stay: found in most samples, then of least margin."""
    there = [mode for mode in stay.modes if mode.range_low.exists]
    return max(there, key=lambda mode: (mode.range_low.share, -mode.margin), default=None)


def amplitude_mode(stay: StayAnswer) -> ModeAnswer | None:
    """The mode whose amplitude is the largest at the band's high end."""
    there = [mode for mode in stay.modes if mode.amplitude.exists]
    return max(there, key=lambda mode: mode.amplitude.high, default=None)


def speed_range(stay: StayAnswer) -> tuple[str, str]:
    """Where the stay's range of wind speed begins, in how many samples; where it ends, in how many it is open."""
    mode = range_mode(stay)
    if mode is None:
        return NONE, NONE
    begins, ends = (band_parts(one)[0] if one.exists else NONE for one in (mode.range_low, mode.range_high))
    if mode.range_low.share < 1:
        begins += f"\nin {share(mode.range_low.share)}"
    return begins, ends + (f"\nopen in {share(mode.unlimited)}" if mode.unlimited > 0 else "")


def summary_rows(answer: BridgeAnswer) -> tuple[list[str], list[list[str]]]:
    """Header and rows of the first page's table, which a terminal shows too: one row a stay, texts only."""
    header = [
        "stay",
        "verdict",
        "margin",
        "damping there (%)",
        "damping needed (%)",
        "range begins (m/s)",
        "range ends (m/s)",
        "amplitude (m)",
    ]
    return header, [summary_row(stay) for stay in answer.stays]


def summary_row(stay: StayAnswer) -> list[str]:
    """One stay: name, verdict, margin and mode that decides, damping there and needed, range, largest amplitude."""
    name, mode = shortened(stay.cable.name, 40), stay.worst
    if stay.failure or mode is None:
        return [name, f"{said(stay.verdict)}\n{shortened(stay.failure, 240)}", *[NONE] * 6]
    largest = amplitude_mode(stay)
    return [
        name,
        said(stay.verdict),
        margin(stay.margin) + (f"\nmode {mode.number}" if not isinf(stay.margin) else ""),
        number(100 * mode.damping_total),
        band_lines(in_percent(mode.damping_needed_observed)),
        *speed_range(stay),
        band_lines(largest.amplitude) if largest else NONE,
    ]


def in_percent(values: Band) -> Band:
    """A band of ratios in per cent."""
    return replace(values, low=100 * values.low, middle=100 * values.middle, high=100 * values.high)
