"""What a run is given, checked at the door: parameters that may follow signals, a start, turning states."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rainwind.dynamics.drive import Drive, drive
from rainwind.dynamics.signals import Signal
from rainwind.dynamics.system import System, number
from rainwind.errors import InputError
from rainwind.parameters import unknown_name

_WIND = "wind.speed"
_TURN = 2.0 * np.pi


def run_parameters(
    system: System, given: Mapping[str, float | Signal] | None, wind: float | Signal | None
) -> dict[str, float | Signal]:
    """Parameters by name, `wind` among them as "wind.speed". Raises InputError."""
    if given is not None and not isinstance(given, Mapping):
        raise InputError(f"parameters go by name, for example {{'a': 1.0}}; got {given!r}")
    found = dict(given or {})
    if wind is not None:
        if _WIND not in system.parameters:
            raise InputError(
                f"this model has no parameter '{_WIND}', so it takes no wind; give what varies by its own name, "
                f"parameters={{name: ...}}. Known: {', '.join(system.parameters) or 'none'}"
            )
        if _WIND in found:
            raise InputError(f"wind and parameters['{_WIND}'] are the same thing; give one of them")
        found[_WIND] = wind
    for name, value in found.items():
        if name not in system.parameters:
            raise unknown_name(name, system.parameters, "parameter")
        if not isinstance(value, Signal):
            found[name] = number(value, f"parameter '{name}'")
    return found


def run_drive(system: System, signals: Mapping[str, Signal], duration: float) -> Drive:
    """The signals' polynomials from 0 to the duration, whose values the system allows. Raises InputError."""
    for name, signal in signals.items():
        if signal.since > 0.0 or signal.until < duration:
            raise InputError(
                f"the signal of '{name}' is given from {signal.since:g} to {signal.until:g}, the run goes from 0 to "
                f"{duration:g}; shorten the run, or lengthen the signal (.then, .repeated, .shifted)"
            )
    found = drive(signals, {name: system.number(name) for name in signals}, duration)
    for i, name in enumerate(signals):
        for value in Signal(found.pieces.times, found.pieces.coefficients[:, i]).extremes():
            try:
                system.allowed({name: value})
            except InputError as error:
                raise InputError(f"the signal of '{name}' reaches {value:.6g}: {error}") from None
    return found


def run_start(system: System, start: Any) -> np.ndarray:
    """The state (n,) that anything with states stands for, as `simulate` takes it. Raises InputError."""
    names = getattr(start, "states", None)
    if names is None:
        if isinstance(start, Mapping) and not start:
            raise InputError(f"start = {{}} names no state; give some of {', '.join(system.states)}")
        return system.state(start)
    if tuple(names) != system.states:
        raise InputError(
            f"start has the states {', '.join(names)}, the model has {', '.join(system.states)}; "
            "give a point of this model"
        )
    for attribute in ("end", "state", "profile"):
        found = getattr(start, attribute, None)
        if found is not None:
            return system.state(found[0] if np.ndim(found) == 2 else found)
    raise InputError(f"start = {start!r} has no state; give numbers, a mapping, an equilibrium or an orbit")


def turning_states(system: System, x: np.ndarray) -> tuple[str, ...]:
    """The states in which the system is 2-pi-periodic: tried at the start and some states around it."""
    scale = np.maximum(np.abs(x), 0.1)
    points = x + np.random.default_rng(1).uniform(-1.0, 1.0, (6, x.size)) * scale
    f, slopes = system.f(points), np.abs(system.jacobian(points)).max(axis=(0, 1))
    found = []
    for i, name in enumerate(system.states):
        moved = system.f(points + _TURN * np.eye(x.size)[i])
        if np.all(np.isfinite(moved)) and slopes[i] > 0.0:
            same = np.abs(moved - f) <= 1e-10 * (np.abs(f) + np.abs(f).max())
            if np.all(same):
                found.append(name)
    return tuple(found)
