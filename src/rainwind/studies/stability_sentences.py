"""What figure 9 shows of limit cycles, in sentences: which damping stops every vibration, and what bounds them."""

from collections.abc import Sequence

from rainwind.plotting.cycle_curves import WORDS
from rainwind.studies.cycle_curves import RATIO
from rainwind.studies.cycle_field import CycleField
from rainwind.studies.stability_diagram import StabilityDiagram

POINTS = {
    "zh": "fold–Hopf points (a fold and a Hopf point in one)",
    "hh": "Hopf–Hopf points (two Hopf points in one)",
    "gh": "generalised Hopf points (the onset of vibration turns from soft to hard)",
    "cpc": "cusps of cycles (two folds meet and vanish)",
    "ch": "Chenciner points (the Neimark–Sacker point turns from soft to hard)",
    "r1": "resonances 1:1 (a Neimark–Sacker curve ends on a fold curve)",
    "gpd": "generalised period doublings (the doubling turns from soft to hard)",
    "r2": "resonances 1:2 (a Neimark–Sacker curve ends on a period-doubling curve)",
    "r3": "resonances 1:3",
    "r4": "resonances 1:4",
    "foldflip": "fold–flip points (a fold and a period doubling in one)",
    "lpns": "fold–NS points (a fold and a Neimark–Sacker point in one)",
    "pdns": "doubling–NS points (a period doubling and a Neimark–Sacker point in one)",
    "nsns": "double NS points (two Neimark–Sacker points in one)",
}
_LIMITS = {
    "hopf": "the Hopf curve of D",
    "lpc": "a fold of cycles",
    "ns": "a Neimark–Sacker point",
    "pd": "a period doubling",
}
_CLOSE = 0.999  # of the diagram's top: a curve that comes as near leaves through it


def cycle_sentences(
    diagram: StabilityDiagram,
    stable: CycleField,
    own_ratio: float | None,
    marks: Sequence[tuple[str, float, float]],
) -> list[str]:
    """Which damping stops every vibration; where a cycle is stable at the case's damping; curves and special points.

    marks: special points, kind, speed (m/s) and damping ratio.
    """
    curves = diagram.cycle_curves
    if curves is None:
        return []
    said = [_quiet(diagram, stable)]
    if own_ratio is not None:
        ranges = [f"{a:.2f} to {b:.2f} m/s" for a, b in stable.ranges(own_ratio)]
        where = " and ".join(ranges) or "no wind speed looked at"
        said.append(f"At the case's damping a limit cycle is stable at {where}.")
        apart = [f"{speed:.2f}" for ratio, speed in stable.isolated if ratio == own_ratio]
        if apart:
            said.append(
                f"Among them is a vibration that no Hopf point leads to; it ends in a fold at {' and '.join(apart)} "
                "m/s. Figure 7 and 'rainwind diagram' do not show it."
            )
    for kind, words in WORDS.items():
        found = curves.of(kind)
        if found:
            top = max(float(c[RATIO].max()) for c in found)
            number = "one curve" if len(found) == 1 else f"{len(found)} curves"
            said.append(f"{words[0].upper()}{words[1:]}: {number}, up to {_percent(top)} damping.")
    return [*said, *_points(marks), *_doubts(stable), *(f"{n[0].upper()}{n[1:]}." for n in curves.notes)]


def _doubts(stable: CycleField) -> list[str]:
    """Where the count of stable cycles contradicts itself or a branch: the first three places."""
    few = stable.faults[:3]
    more = f", and {len(stable.faults) - 3} more" if len(stable.faults) > 3 else ""
    return [f"The count of stable cycles is doubtful: {'; '.join(few)}{more}."] if few else []


def highest_limit(diagram: StabilityDiagram, stable: CycleField) -> tuple[float, float, str] | None:
    """The highest damping ratio at which D or a limit cycle changes its stability, the speed, and in what."""
    tops = [(float(x.ratio.max()), float(x.speed[x.ratio.argmax()]), x.kind) for x in stable.limits]
    if diagram.critical is not None:
        tops.append((diagram.critical[1], diagram.critical[0], "hopf"))
    return max(tops, default=None)


def _quiet(diagram: StabilityDiagram, stable: CycleField) -> str:
    """The engineer's answer: above which damping ratio nothing vibrates, and at which wind speed most is needed."""
    low, high = diagram.speeds
    top = highest_limit(diagram, stable)
    looked = "(looked at: D, and limit cycles born from C and D or bounded by their folds)"
    if top is None:
        return f"Between {low:g} and {high:g} m/s nothing vibrates at any damping of this diagram {looked}."
    ratio, speed, kind = top
    if ratio > _CLOSE * diagram.ratios[1]:
        return (
            f"No damping ratio of this diagram, which goes up to {_percent(diagram.ratios[1])}, stops every vibration "
            f"between {low:g} and {high:g} m/s {looked}."
        )
    return (
        f"Above a damping ratio of {_percent(ratio)} nothing vibrates between {low:g} and {high:g} m/s {looked}. Most "
        f"damping is needed at {speed:.2f} m/s, where the last vibration vanishes in {_LIMITS[kind]}."
    )


def _points(marks: Sequence[tuple[str, float, float]]) -> list[str]:
    """Each special point once, under its name in words."""
    said = []
    for kind, words in POINTS.items():
        places = sorted(
            {f"{speed:.3f} m/s ({_percent(r, 4)})": speed for k, speed, r in marks if k == kind}.items(),
            key=lambda item: item[1],
        )
        if places:
            said.append(f"{words[0].upper()}{words[1:]}: {', '.join(text for text, _ in places)}.")
    return said


def _percent(ratio: float, digits: int = 3) -> str:
    return f"{100 * ratio:.{digits}f} %"
