"""The pages of pictures: stays by margin, wind rose, ranges over direction, amplitudes, stability, dampers."""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from io import StringIO

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from rainwind.engineering.answers import BridgeAnswer, ModeAnswer, StayAnswer
from rainwind.engineering.climate import Climate, wind_rose
from rainwind.engineering.damper_curve import DamperCurve, damper_curve, optimum_coefficient
from rainwind.engineering.wind_profile import speed_factor
from rainwind.errors import RainwindError
from rainwind.plotting import damper_curves, style
from rainwind.plotting import wind_rose as rose_picture
from rainwind.reporting import amplitude_curve, range_polar, stability_curve, stay_map, words
from rainwind.reporting.content import Figure, Section

__all__ = ["picture_pages"]

_AMPLITUDES, _STABILITIES, _DAMPERS, _MODES = 6, 4, 4, 6  # stays, and modes, that are drawn, at most
_ROSE = np.array([0.0, 5.0, 10.0, 15.0, 20.0])  # m/s


def picture_pages(answer: BridgeAnswer, climate: Climate | None = None) -> Iterator[Section]:
    """One chapter of figures; none where no stay was computed."""
    blocks = tuple(
        replace(figure, caption=f"Figure {number}. {figure.caption}")
        for number, figure in enumerate(_figures(answer, climate), start=1)
    )
    if blocks:
        yield Section("Pictures", blocks, new_page=True)


def _figures(answer: BridgeAnswer, climate: Climate | None) -> Iterator[Figure]:
    stays = _by_margin(answer)
    if not stays:
        return
    if len(answer.stays) > 1:
        yield _map(answer)
    ranged = _worst_range(answer)
    if climate is not None or ranged is not None:
        yield _round(answer, climate, ranged)
    if len(stays) == 1:
        yield _amplitude_beside_stability(answer, stays[0])
    else:
        yield _amplitudes(answer, stays[:_AMPLITUDES])
        yield _stability(answer, stays[:_STABILITIES])
    damped = [stay for stay in stays if stay.cable.dampers][:_DAMPERS]
    curves = [pair for stay in damped if (pair := (stay, _damper_curve(stay)))[1] is not None]
    if curves:
        yield _dampers(curves)


def _by_margin(answer: BridgeAnswer) -> list[StayAnswer]:
    return sorted((stay for stay in answer.stays if stay.modes), key=lambda stay: stay.margin)


def _worst_range(answer: BridgeAnswer) -> tuple[StayAnswer, ModeAnswer] | None:
    for stay in _by_margin(answer):
        mode = words.range_mode(stay)
        if mode is not None:
            return stay, mode
    return None


def _map(answer: BridgeAnswer) -> Figure:
    height = 84.0 if stay_map.has_chainages(answer) else 60.0
    if stay_map.has_chainages(answer):
        caption = "The stays in elevation, to scale, each from its lower anchorage, with its margin."
    else:
        caption = "Margin of each stay; below 1, dashed, there is less damping than the high end of the band asks for."
    canvas = Canvas()
    svg = _svg(canvas, lambda: stay_map.draw(answer, canvas.subplots()), "double", height)
    return Figure(svg, caption)


def _round(
    answer: BridgeAnswer, climate: Climate | None, ranged: tuple[StayAnswer, ModeAnswer] | None
) -> Figure:
    """Ranges over direction, and beside it the wind rose if there is a climate."""
    question, limits = answer.bridge.question, answer.bridge.limits
    pictures: list[Callable[[Axes], object]] = []
    captions: list[str] = []
    low = high = None
    directions = 2 * np.pi * np.arange(question.directions) / question.directions
    if ranged is not None:
        stay, mode = ranged
        pictures.append(lambda axes: range_polar.draw(mode, axes, limits.observed_speeds, question.speeds[1]))
        captions.append(
            f"{'Left: s' if climate is not None else 'S'}tay {words.named(stay)}, mode {mode.number}: range of wind "
            "speed (radius, m/s) over the direction "
            f"from which the wind comes, in those samples that have one (at most {words.share(mode.share.max())})."
        )
        low, high, directions = mode.speed_low[:, 1], mode.speed_high[:, 1], mode.directions
    if climate is not None:
        site = answer.bridge.site
        factor = 1.0 / float(
            speed_factor(site, climate.height)
        )  # from the anemometer to the reference height
        rose = wind_rose(climate, directions, _ROSE, wet=True, factor=factor)
        pictures.append(lambda axes: rose_picture.draw(rose, axes, low=low, high=high))
        hatched = (
            "; hatched: the middle of that range, rim: directions that have one" if low is not None else ""
        )
        captions.append(
            f"{'Right: h' if ranged else 'H'}ours a year with rain by direction and speed of the wind, at "
            f"{site.reference_height:g} m{hatched}."
        )
    canvas = Canvas()

    def fill() -> None:
        grid = canvas.subplots(1, len(pictures), subplot_kw={"projection": "polar"}, squeeze=False)
        for picture, axes in zip(pictures, grid.flat, strict=True):
            picture(axes)

    beside = len(pictures) > 1
    svg = _svg(canvas, fill, "double" if beside else "single", 122 if beside else 102)
    return Figure(svg, " ".join(captions), 1.0 if beside else 0.5)


def _amplitudes(answer: BridgeAnswer, stays: list[StayAnswer]) -> Figure:
    least = "; the stays with the least margins" if len(stays) < len(answer.stays) else ""
    caption = f"{_OF_AMPLITUDES}{least}. {_LESS_THAN_TABLES}"
    return _panels(lambda k, axes: _amplitude(answer, stays[k], axes), len(stays), caption)


def _stability(answer: BridgeAnswer, stays: list[StayAnswer]) -> Figure:
    return _panels(
        lambda k, axes: _stable(answer, stays[k], axes), len(stays), f"{_OF_STABILITY}. {_LESS_THAN_TABLES}"
    )


def _amplitude_beside_stability(answer: BridgeAnswer, stay: StayAnswer) -> Figure:
    def draw(k: int, axes: Axes) -> None:
        (_stable if k else _amplitude)(answer, stay, axes)

    left, right = (f"{said[0].lower()}{said[1:]}" for said in (_OF_AMPLITUDES, _OF_STABILITY))
    return _panels(draw, 2, f"Left: {left}. Right: {right}. {_LESS_THAN_TABLES}")


_OF_AMPLITUDES = (
    "Amplitude at the antinode, half peak to peak, over wind speed, in the direction that needs most damping"
)
_OF_STABILITY = (
    "Stability in the direction that needs most damping: below the line small vibrations about the upper rivulet grow "
    "in half of the samples; the band holds 90 % of them"
)
_LESS_THAN_TABLES = (
    "The tables say more than the highest point of these curves: they take each sample where it is worst, and that is "
    "at another wind for each."
)


def _amplitude(answer: BridgeAnswer, stay: StayAnswer, axes: Axes) -> None:
    limits = answer.bridge.limits
    mode = words.amplitude_mode(stay) or stay.modes[0]
    amplitude_curve.draw(mode, axes, limits.observed_speeds, limits.amplitude_diameters * stay.cable.diameter)
    _titled(axes, stay, mode)


def _stable(answer: BridgeAnswer, stay: StayAnswer, axes: Axes) -> None:
    mode = stay.worst
    assert mode is not None
    stability_curve.draw(mode, axes, answer.bridge.limits.observed_speeds)
    _titled(axes, stay, mode)


def _titled(axes: Axes, stay: StayAnswer, mode: ModeAnswer) -> None:
    axes.set_title(f"stay {words.for_figure(stay.cable.name)}, mode {mode.number}", loc="left")


def _damper_curve(stay: StayAnswer) -> DamperCurve | None:
    """Of the stay's first damper; None where it cannot be computed."""
    cable, damper = stay.cable, stay.cable.dampers[0]
    modes = [mode.number for mode in stay.modes][:_MODES]
    best = optimum_coefficient(cable, 1, damper.position, damper.support_stiffness)
    ends = sorted((best, damper.coefficient))
    over = np.geomspace(ends[0] / 20, ends[1] * 10, 60)
    try:
        return damper_curve(cable, modes, damper.position, over, damper.support_stiffness)
    except RainwindError:
        return None


def _dampers(curves: list[tuple[StayAnswer, DamperCurve | None]]) -> Figure:
    def draw(k: int, axes: Axes) -> None:
        stay, curve = curves[k]
        worst = stay.worst
        assert curve is not None
        assert worst is not None
        wanted = worst.damping_needed_observed.middle - worst.damping_own
        targets = {worst.number: wanted} if wanted > 0 else {}
        damper_curves.draw(curve, axes, chosen=stay.cable.dampers[0].coefficient, targets=targets)
        for line in axes.lines:
            if str(line.get_label()).startswith("chosen"):
                line.set_label("the damper there is")
        axes.set_title(
            f"stay {words.for_figure(stay.cable.name)}, damper at {curve.position:.3g} m", loc="left"
        )

    caption = (
        "Damping that the first damper of a stay adds, over its coefficient. Dashed: what the mode that decides needs "
        "beyond the stay's own damping, at the middle of the band."
    )
    return _panels(draw, len(curves), caption)


def _panels(draw: Callable[[int, Axes], None], count: int, caption: str) -> Figure:
    """Two beside each other, with one legend below all."""
    canvas, rows = Canvas(), (count + 1) // 2

    def fill() -> None:
        grid = canvas.subplots(rows, 2 if count > 1 else 1, squeeze=False)
        labelled: dict[str, Artist] = {}
        for k, axes in enumerate(grid.flat):
            if k >= count:
                axes.set_visible(False)
                continue
            draw(k, axes)
            handles, labels = axes.get_legend_handles_labels()
            labelled = {**dict(zip(labels, handles, strict=True)), **labelled}
            if axes.get_legend() is not None:
                axes.get_legend().remove()
            if k + 2 < count:
                axes.set_xlabel("")
        canvas.legend(
            labelled.values(), labelled.keys(), loc="outside lower center", ncols=3 if count > 1 else 2
        )

    double = count > 1
    svg = _svg(canvas, fill, "double" if double else "single", (16.0 if double else 32.0) + 38.0 * rows)
    return Figure(svg, caption, 1.0 if double else 0.5)


def _svg(canvas: Canvas, fill: Callable[[], object], width: str, height: float) -> str:
    """The figure as SVG text; letters that the font lacks stand as boxes."""
    out = StringIO()
    with style.journal(canvas, width=width, height=height), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        fill()
        canvas.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return out.getvalue()
