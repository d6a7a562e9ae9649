"""What the numbers of a stay mean: its verdict, and sentences an engineer can act on."""

from collections.abc import Iterator, Sequence
from math import floor, log10

from rainwind.engineering.answers import Band, ModeAnswer, StayAnswer, Verdict
from rainwind.engineering.bridge import Bridge
from rainwind.engineering.wording import compass, share

__all__ = ["stay_sentences", "verdict"]

_MOST_MARGIN = 10.0  # printed


def verdict(answer: StayAnswer) -> Verdict:
    """sufficient: model, at its band's high end, and PTI rule find enough damping in every mode; insufficient: the
    model's middle and the rule both find too little in one mode; doubtful: everything between.
    """
    if answer.failure:
        return "failed"
    enough = all(_model_enough(mode, high=True) and _rule_enough(mode) for mode in answer.modes)
    if enough:
        return "sufficient"
    short = any(not _model_enough(mode, high=False) and not _rule_enough(mode) for mode in answer.modes)
    return "insufficient" if short else "doubtful"


def _model_enough(mode: ModeAnswer, *, high: bool) -> bool:
    needed = mode.damping_needed_observed
    return mode.damping_total >= (needed.high if high else needed.middle)


def _rule_enough(mode: ModeAnswer) -> bool:
    return mode.damping_total >= mode.rule_damping


def stay_sentences(answer: StayAnswer, bridge: Bridge) -> tuple[str, ...]:
    """The answer of one stay in words: range, amplitude, damping, rule against model, remedy."""
    worst = answer.worst
    if worst is None:
        return (f"Stay {answer.cable.name} could not be assessed: {answer.failure}",)
    return tuple(_said(answer, worst, bridge))


def _said(answer: StayAnswer, mode: ModeAnswer, bridge: Bridge) -> Iterator[str]:
    observed = bridge.limits.observed_speeds
    yield _range(answer, observed)
    yield _amplitude(answer, bridge)
    yield _damping(mode)
    yield _rule_and_model(mode)
    if mode.unlimited > 0:
        yield (
            f"In {share(mode.unlimited)} of the samples mode {mode.number} is still unstable at "
            f"{bridge.question.speeds[1]:g} m/s: at low damping the model has no upper limit of wind speed. Rivulets "
            f"have been observed at {observed[0]:g} to {observed[1]:g} m/s."
        )
    for one in answer.modes:
        if one.lost is not None and one.lost.max() >= 0.5:
            yield (
                f"In mode {one.number} half of the samples or more lose their rivulet at some wind speeds before a "
                "steady vibration is reached; the amplitude given is the largest until then."
            )
            break


def _range(answer: StayAnswer, observed: Sequence[float]) -> str:
    hit = [mode for mode in answer.modes if mode.range_low.exists]
    if not hit:
        return "With the damping there is, small vibrations grow at no wind speed looked at, in any sample."
    mode = max(hit, key=lambda one: (one.range_low.share, -one.margin))
    low, high = mode.range_low.middle, mode.range_high.middle
    lower, upper = max(low, observed[0]), min(high, observed[1])
    within = ""
    if lower >= upper:
        within = f"; the middle of the band lies outside the observed speeds, {observed[0]:g} to {observed[1]:g} m/s"
    elif (lower, upper) != (low, high):
        within = f"; within the observed speeds {lower:.1f} to {upper:.1f} m/s"
    worst = ""
    if mode.damping_needed_observed.high > 0:
        mirrored = 2 * answer.cable.heading - mode.worst_direction  # the same wind from the stay's other side
        both = dict.fromkeys((compass(mode.worst_direction), compass(mirrored)))
        worst = f"; worst with wind from {' or '.join(both)}"
    modes = ", ".join(str(one.number) for one in hit)
    return (
        f"Rain-wind vibration is possible in mode{'s' if len(hit) > 1 else ''} {modes}: mode {mode.number} from "
        f"{_band(mode.range_low, 1, '.1f')} to {_band(mode.range_high, 1, '.1f')} m/s in "
        f"{share(mode.range_low.share)} of the samples{within}{worst}."
    )


def _amplitude(answer: StayAnswer, bridge: Bridge) -> str:
    mode = max(answer.modes, key=lambda one: one.amplitude.high)
    diameter = answer.cable.diameter
    if mode.amplitude.high < 0.05 * diameter:
        return "In time hardly a sample vibrates by more than a twentieth of a diameter."
    limit = bridge.limits.amplitude_diameters
    verdict_ = "above" if mode.amplitude.high > limit * diameter else "within"
    amplitude = _band(mode.amplitude, 1, _digits(mode.amplitude.middle))
    return (
        f"Amplitude in mode {mode.number}, half peak to peak: {amplitude} m "
        f"({mode.amplitude.high / diameter:.1f} diameters at the high end, {verdict_} the limit of {limit:g})."
    )


def _damping(mode: ModeAnswer) -> str:
    needed = mode.damping_needed_observed
    if not needed.high > 0:
        return "At the observed wind speeds no mode needs damping."
    margin = (
        f"{mode.margin:{_digits(mode.margin)}}" if mode.margin < _MOST_MARGIN else f"above {_MOST_MARGIN:g}"
    )
    return (
        f"Mode {mode.number} decides: it has {100 * mode.damping_total:.2f} % of critical and needs "
        f"{_band(needed, 100, _digits(100 * needed.high))} % (margin {margin} at the high end)."
    )


def _rule_and_model(mode: ModeAnswer) -> str:
    rule, needed = 100 * mode.rule_damping, 100 * mode.damping_needed_observed.middle
    model = f"for {needed:{_digits(needed)}} %" if needed > 0 else "for none"
    begin = f"The PTI rule asks for {rule:.2f} %, the model {model} (middle)"
    if needed > 1.25 * rule:
        return (
            f"{begin}: what the model asks for falls as the frequency and the rivulet's friction rise, and the rule's "
            "Scruton number knows neither."
        )
    if needed < 0.8 * rule:
        return (
            f"{begin}: the rule is one number for all modes, and the model finds less energy at this frequency and "
            "with this rivulet."
        )
    return f"{begin}: they agree."


def _digits(value: float) -> str:
    """How a value is printed: two decimals, and more where that left less than two digits of it."""
    more = 1 - floor(log10(value)) if value > 0 else 2
    return f".{min(max(more, 2), 3)}f"


def _band(band: Band, scale: float, digits: str) -> str:
    low, middle, high = (format(scale * value, digits) for value in (band.low, band.middle, band.high))
    return f"{middle} ({low} to {high})"
