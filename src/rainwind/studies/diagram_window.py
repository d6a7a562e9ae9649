"""The window of a diagram in one parameter: from text with units, checked before anything is computed."""

from collections.abc import Sequence

from rainwind.dynamics.system import number
from rainwind.errors import InputError
from rainwind.io.schema import NUMBERS
from rainwind.io.units import KINDS, Kind, from_text, unit_text
from rainwind.io.usual import FASTEST, impossible, unusual_value
from rainwind.parameters import replace_parameters, unknown_name
from rainwind.physics.model import RivuletModel
from rainwind.studies.equilibrium_map import speed_window

SPEED = "wind.speed"
_NAMES = {
    "wind.speed": "wind speed", "wind.yaw": "yaw", "section.damping_ratio": "damping ratio",
    "section.damping_ratio_y": "damping ratio in y", "section.damping_ratio_z": "damping ratio in z",
    "section.frequency_y": "frequency in y", "section.frequency_z": "frequency in z",
    "section.diameter": "diameter", "section.mass": "mass", "rivulet.mass": "rivulet mass",
    "rivulet.height": "rivulet height", "rivulet.friction": "rivulet friction",
}  # fmt: skip


def kind_of(along: str) -> Kind | None:
    """The kind of quantity that a parameter is."""
    if along.startswith("section.frequency"):
        return KINDS["frequency"]
    return next((n.kind for n in NUMBERS if f"{n.table}.{n.field}" == along), None)


def unit_of(kind: Kind | None) -> str:
    """The unit in which people read it."""
    return "" if kind is None else {"deg": "°"}.get(kind.preferred, unit_text(kind.preferred))


def si(value: float, kind: Kind | None) -> float:
    """A value in the unit in which people read it, in SI and radians."""
    if kind is None:
        return value
    factor, divisor = kind.suffixes[kind.preferred]
    return value * factor / divisor


def in_words(value: float, along: str) -> str:
    """A parameter's value, given in SI, with the unit in which people read it."""
    kind = kind_of(along)
    return f"{value / si(1.0, kind):.6g} {unit_of(kind)}".strip()


def name_of(along: str) -> str:
    """A parameter in words."""
    return _NAMES.get(along, along.replace(".", ": ").replace("_", " "))


def held(model: RivuletModel, along: str) -> list[str]:
    """The parameters that lead besides `along`, each with its value: wind, damping, frequencies, sizes, rivulet."""
    values = {name: model.parameters[name] for name in _NAMES if name in model.parameters and name != along}
    names = dict(_NAMES)
    if values.get("wind.yaw") == 0.0:
        del values["wind.yaw"]
    if {"section.damping_ratio_y", "section.damping_ratio_z"} <= set(model.parameters):
        values.pop("section.damping_ratio", None)
    if values.get("section.frequency_y") == values.get("section.frequency_z"):
        values.pop("section.frequency_z", None)
        names["section.frequency_y"] = "frequency"
    return [f"{names[name]} {in_words(value, name)}" for name, value in values.items()]


def window_from_text(along: str, until: Sequence[str]) -> tuple[float, float]:
    """The two ends of the range as typed, in SI: numbers with their unit, or plain ones where SI's unit is usual."""
    kind = kind_of(along)
    ends = []
    for text in until:
        try:
            if kind is None or kind.suffixes[kind.preferred] == (1, 1):
                try:
                    ends.append(float(text))
                    continue
                except ValueError:
                    if kind is None:
                        raise InputError("is no number") from None
            ends.append(from_text(text, kind))
        except InputError as error:
            raise InputError(f"--until '{text}' {error}") from error
    return ends[0], ends[1]


def checked_window(
    model: RivuletModel, along: str, until: tuple[float, float] | None = None
) -> tuple[float, float]:
    """The window (SI) if the model, and any bridge, allows both of its ends; by default around the onset speed.

    Raises InputError for an unknown parameter, a window that is none, and ends that are not allowed.
    """
    if along not in model.parameters:
        raise unknown_name(along, model.parameters, "parameter")
    if until is None:
        if along != SPEED:
            raise InputError(f"the range of {along} has no default; say until where, two numbers")
        low, high = speed_window(model)
        return low, min(high, FASTEST)
    apart = {"section.damping_ratio_y", "section.damping_ratio_z"}
    if along == "section.damping_ratio" and apart <= set(model.parameters):
        raise InputError(
            f"{along} changes nothing: the case has {' and '.join(sorted(apart))}; vary one of these"
        )
    low, high = (number(end, f"an end of the range of {along}") for end in until)
    span = f"the range of {along}, {in_words(low, along)} to {in_words(high, along)},"
    if not low < high:
        raise InputError(f"{span} is none: the first must be the smaller")
    for end in (low, high):
        try:
            reason = impossible(replace_parameters(model, {along: end}))
        except InputError as error:
            reason = str(error)
        if reason:
            raise InputError(f"{span} leaves what is allowed at {in_words(end, along)}: {reason}")
    return low, high


def unusual_ends(along: str, window: tuple[float, float]) -> list[str]:
    """A sentence for each end of a window that is outside the parameter's usual range; zero is fine for an end."""
    return [
        f"--until {in_words(end, along)}{reason}"
        for end in window
        if end and (reason := unusual_value(along, end))
    ]
