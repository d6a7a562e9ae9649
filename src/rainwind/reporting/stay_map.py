"""The stays of a bridge as a sketch in elevation, coloured by margin; bars where nobody said where they stand."""

from math import cos, isinf, isnan, sin
from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from rainwind.engineering.answers import BridgeAnswer, StayAnswer
from rainwind.plotting import style
from rainwind.reporting import words

__all__ = ["LEVELS", "draw", "has_chainages"]

LEVELS: tuple[tuple[float, str, Any, float, str], ...] = (
    (0.5, "#A63A00", "-", 2.4, "margin below 0.5"),
    (1.0, "#E69F00", style.DASHED, 2.0, "0.5 to 1"),
    (2.0, "#0072B2", "-", 1.3, "1 to 2"),
    (float("inf"), "#00805C", "-", 0.8, "above 2, or no damping needed"),
)
"""Up to which margin: colour, dashes and width, so that grey print tells them apart too."""
_WIDE, _HIGH = 150.0, 66.0  # mm, of the drawing on a page
_LABELS = 45  # places that have one, at most twice as many
_FAILED = ("#767676", style.DOTTED, 1.2, "not computed")


def has_chainages(answer: BridgeAnswer) -> bool:
    """Whether every stay says where its lower anchorage is along the bridge."""
    return all(stay.cable.chainage is not None for stay in answer.stays)


def draw(answer: BridgeAnswer, axes: Axes) -> Axes:
    """Lines from the lower anchorages up to the tower if every stay has a chainage, else a bar of margin for each."""
    if has_chainages(answer):
        _elevation(answer, axes)
        used = dict.fromkeys(_look(stay) for stay in answer.stays)
        order = [one for one in (*(level[1:] for level in LEVELS), _FAILED) if one in used]
        handles = [
            Line2D([], [], color=color, linestyle=dashes, linewidth=width, label=label)
            for color, dashes, width, label in order
        ]
        axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 1.14), ncols=len(handles))
    else:
        _bars(answer, axes)
    return axes


def _elevation(answer: BridgeAnswer, axes: Axes) -> None:
    first = min(answer.stays, key=lambda stay: stay.cable.chainage or 0.0).cable.heading
    for stay in answer.stays:
        cable = stay.cable
        x, z = cable.chainage or 0.0, cable.base_height
        # a stay that rises the other way leans back along the bridge
        side = 1.0 if cos(cable.heading - first) >= -1e-9 else -1.0
        if _leans_back(answer, first):
            side = -side
        across, up = side * cable.length * cos(cable.inclination), cable.length * sin(cable.inclination)
        color, dashes, width, _ = _look(stay)
        axes.plot([x, x + across], [z, z + up], color=color, linestyle=dashes, linewidth=width, zorder=3)
        axes.plot([x], [z], "o", color=color, markersize=2.5, zorder=4)
    ground = min(stay.cable.base_height for stay in answer.stays)
    axes.axhline(ground, color="#9A9A9A", linewidth=0.8, zorder=1)
    _label(answer, axes)
    _frame(axes, ground, max(len(label.get_text()) for label in axes.texts))
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    axes.set_xticks([])
    axes.tick_params(axis="y", right=False)
    axes.set_ylabel("height (m)")


def _frame(axes: Axes, ground: float, letters: int) -> None:
    """Equal scales, and room below the ground for labels of so many letters."""
    low, high = axes.dataLim.intervalx
    top = axes.dataLim.intervaly[1]
    room = min(1.3 * letters + 2.0, 0.5 * _HIGH)  # mm
    scale = max((high - low) / _WIDE, (top - ground) / (_HIGH - room))  # m a mm
    axes.set_aspect("equal")
    axes.set_xlim(low - 3 * scale, high + 3 * scale)
    axes.set_ylim(ground - room * scale, top + 2 * scale)
    axes.spines["left"].set_bounds(ground, top)
    axes.set_yticks([tick for tick in axes.get_yticks() if ground <= tick <= top])


def _label(answer: BridgeAnswer, axes: Axes) -> None:
    """Name and margin below each lower anchorage; stays at one place share a line, of many only some have one."""
    places: dict[float, list[StayAnswer]] = {}
    for stay in answer.stays:
        places.setdefault(round(stay.cable.chainage or 0.0), []).append(stay)
    step = 1 + len(places) // _LABELS
    for place in sorted(places)[::step]:
        there = places[place]
        said = ", ".join(f"{words.for_figure(one.cable.name, 12)}: {_said(one)}" for one in there[:2])
        if len(there) > 2:
            said += f" and {len(there) - 2} more"
        height = min(one.cable.base_height for one in there)
        axes.annotate(
            said, (place, height), xytext=(0, -4), textcoords="offset points", rotation=90, ha="center", va="top",
            fontsize=6.5,
        )  # fmt: skip


def _leans_back(answer: BridgeAnswer, first: float) -> bool:
    """Whether the stays with the first one's heading rise towards smaller chainages.

    Stays of one fan meet at the tower: of both ways of leaning it is the one whose upper ends lie closer together.
    """
    fan = [stay.cable for stay in answer.stays if cos(stay.cable.heading - first) >= -1e-9]
    if len(fan) < 2:
        return False

    def spread(side: float) -> float:
        tops = [(c.chainage or 0.0) + side * c.length * cos(c.inclination) for c in fan]
        return max(tops) - min(tops)

    return spread(-1.0) < spread(1.0)


def _bars(answer: BridgeAnswer, axes: Axes) -> None:
    names = [words.for_figure(stay.cable.name, 14) for stay in answer.stays]
    top = 1.25 * max([1.0, *(m for m in map(_finite, answer.stays) if m is not None)])
    for k, stay in enumerate(answer.stays):
        color = _look(stay)[0]
        height = _finite(stay)
        if height is not None:
            axes.bar(k, height, 0.55, color=color, zorder=2)
        axes.annotate(
            _said(stay), (k, height or 0.0), xytext=(0, 3), textcoords="offset points", ha="center", va="bottom",
            fontsize=7, rotation=90 if len(names) > 12 else 0,
        )  # fmt: skip
    axes.axhline(1.0, color=style.BLACK, linestyle=style.DASHED, linewidth=0.8, zorder=3)
    axes.set_xlim(-0.6 - 0.5 * (len(names) < 3), len(names) - 0.4 + 0.5 * (len(names) < 3))
    axes.set_ylim(0, top)
    axes.set_xticks(range(len(names)), names, rotation=90 if len(names) > 8 else 0)
    axes.tick_params(axis="x", length=0)
    axes.set_ylabel("margin")


def _said(stay: StayAnswer) -> str:
    if stay.failure:
        return words.VERDICTS["failed"].word
    return words.margin(stay.margin)


def _finite(stay: StayAnswer) -> float | None:
    return None if isnan(stay.margin) or isinf(stay.margin) else stay.margin


def _look(stay: StayAnswer) -> tuple[str, Any, float, str]:
    if stay.failure or isnan(stay.margin):
        return _FAILED
    return next((*one,) for limit, *one in LEVELS if stay.margin < limit or isinf(limit))  # type: ignore[return-value]
