"""The numbers of one mode, each with its words and unit, once for the pages, the workbook and the text table."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import degrees, nan, radians

import numpy as np

from rainwind.engineering.answers import Band, ModeAnswer, StayAnswer
from rainwind.engineering.criteria import EUROCODE, PTI, TWICE
from rainwind.reporting import words

__all__ = ["QUANTITIES", "Quantity", "columns", "in_degrees", "scaled", "values"]

Value = float | Band | None


@dataclass(frozen=True)
class Quantity:
    """One number or band of a mode. value gives it in `unit`; None: the stay has no such thing.

    group: the heading under which the pages list it. digits: significant ones. band: value is one. said: how a page
    prints a number, if not as `words.number`.
    """

    group: str
    label: str
    unit: str
    value: Callable[[StayAnswer, ModeAnswer], Value]
    digits: int = 3
    band: bool = False
    said: Callable[[float], str] | None = None

    def text(self, stay: StayAnswer, mode: ModeAnswer) -> str:
        """As a page prints it: a number, or a band in one or two lines."""
        value = self.value(stay, mode)
        if isinstance(value, Band):
            return words.band_lines(value, self.digits)
        if self.said is not None and value is not None:
            return self.said(value)
        return words.number(value, self.digits)


def scaled(band: Band | None, factor: float) -> Band | None:
    """The band in another unit."""
    if band is None:
        return None
    return replace(band, low=factor * band.low, middle=factor * band.middle, high=factor * band.high)


def columns() -> tuple[str, ...]:
    """The headers of `values`: a band is four columns."""
    found: list[str] = []
    for one in QUANTITIES:
        name = one.label + (f" ({one.unit})" if one.unit else "")
        if one.band:
            found += [f"{name}, {part}" for part in ("5 %", "middle", "95 %")]
            found.append(f"{one.label}, share of samples")
        else:
            found.append(name)
    return tuple(found)


def values(stay: StayAnswer, mode: ModeAnswer) -> tuple[float, ...]:
    """The numbers under `columns`, nan where there is none."""
    found: list[float] = []
    for one in QUANTITIES:
        value = one.value(stay, mode)
        if one.band:
            is_band = isinstance(value, Band)
            found += [value.low, value.middle, value.high, value.share] if is_band else [nan] * 4
        else:
            assert not isinstance(value, Band)
            found.append(nan if value is None else float(value))
    return tuple(found)


def _times_diameter(band: Band | None, stay: StayAnswer) -> Band | None:
    return scaled(band, 1.0 / stay.cable.diameter)


def _most_lost(mode: ModeAnswer) -> float | None:
    return None if mode.lost is None or not len(mode.lost) else 100 * float(np.max(mode.lost))


def _percent(value: float) -> str:
    return words.share(value / 100)


def in_degrees(direction: float) -> float:
    """A direction of the wind without the dust of pi: 60, not 59.99999999999999."""
    return round(degrees(direction), 9)


def _wind(degrees_: float) -> str:
    return words.compass(radians(degrees_))


_MODE, _DAMPING, _RANGE, _SIZE = "The mode", "Damping", "Wind", "Vibration"
_DAMPER, _YEAR, _OTHER = "Dampers", "In a year", "Other vibrations"

QUANTITIES: tuple[Quantity, ...] = (
    Quantity(_MODE, "frequency in plane", "Hz", lambda s, m: m.frequency_in, 4),
    Quantity(_MODE, "frequency out of plane", "Hz", lambda s, m: m.frequency_out, 4),
    Quantity(_MODE, "Scruton number m ξ / (ρ D²), PTI and FHWA", "", lambda s, m: m.scruton.get(PTI)),
    Quantity(_MODE, "Scruton number 2 m δ / (ρ D²), Eurocode", "", lambda s, m: m.scruton.get(EUROCODE)),
    Quantity(_MODE, "Scruton number 2 m ξ / (ρ D²), also in use", "", lambda s, m: m.scruton.get(TWICE)),
    Quantity(_DAMPING, "damping without dampers", "%", lambda s, m: 100 * m.damping_own),
    Quantity(_DAMPING, "damping there, with dampers", "%", lambda s, m: 100 * m.damping_total),
    Quantity(
        _DAMPING,
        "damping needed, observed speeds",
        "%",
        lambda s, m: scaled(m.damping_needed_observed, 100),
        2,
        True,
    ),
    Quantity(
        _DAMPING, "damping needed, all speeds", "%", lambda s, m: scaled(m.damping_needed, 100), 2, True
    ),
    Quantity(_DAMPING, "damping by the PTI rule", "%", lambda s, m: 100 * m.rule_damping),
    Quantity(_DAMPING, "margin", "", lambda s, m: m.margin, said=words.margin),
    Quantity(_RANGE, "range begins", "m/s", lambda s, m: m.range_low, 2, True),
    Quantity(_RANGE, "range ends", "m/s", lambda s, m: m.range_high, 2, True),
    Quantity(_RANGE, "range open, share of samples", "%", lambda s, m: 100 * m.unlimited, said=_percent),
    Quantity(
        _RANGE, "worst direction, wind from", "°", lambda s, m: in_degrees(m.worst_direction), said=_wind
    ),
    Quantity(_SIZE, "amplitude, half peak to peak", "m", lambda s, m: m.amplitude, 2, True),
    Quantity(_SIZE, "amplitude, peak to peak", "m", lambda s, m: scaled(m.amplitude, 2), 2, True),
    Quantity(_SIZE, "amplitude in diameters", "D", lambda s, m: _times_diameter(m.amplitude, s), 2, True),
    Quantity(_SIZE, "amplitude without dampers", "m", lambda s, m: m.amplitude_undamped, 2, True),
    Quantity(
        _SIZE, "samples that lose their rivulet, at most", "%", lambda s, m: _most_lost(m), said=_percent
    ),
    Quantity(_SIZE, "build-up time", "s", lambda s, m: m.build_up, 2, True),
    Quantity(_SIZE, "uplift of mid-span", "mm", lambda s, m: scaled(m.uplift, 1e3), 2, True),
    Quantity(_DAMPER, "damper stroke", "mm", lambda s, m: scaled(m.stroke, 1e3), 2, True),
    Quantity(_DAMPER, "damper force", "kN", lambda s, m: scaled(m.force, 1e-3), 2, True),
    Quantity(_YEAR, "hours in the range, with rain", "h a year", lambda s, m: m.hours, 2, True),
    Quantity(_YEAR, "hours with rain at observed speeds", "h a year", lambda s, m: m.hours_observed, 2, True),
    Quantity(_YEAR, "hours in the range, dry", "h a year", lambda s, m: m.hours_dry, 2, True),
    Quantity(_OTHER, "dry galloping from", "m/s", lambda s, m: m.galloping_speed),
    Quantity(_OTHER, "vortex shedding at", "m/s", lambda s, m: m.vortex_speed),
)
"""In the order in which a report lists them."""
