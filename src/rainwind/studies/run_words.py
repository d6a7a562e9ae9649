"""What a run is given as text, with units: its wind, its duration, its start."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rainwind.dynamics.signals import Signal, ramp
from rainwind.engineering.turbulent_wind import turbulent_wind
from rainwind.errors import InputError
from rainwind.io.units import KINDS, Kind, from_text
from rainwind.io.usual import FASTEST
from rainwind.io.wind_records import read_wind
from rainwind.physics.model import RivuletModel
from rainwind.studies.equilibrium_map import equilibria_by_letter

PUSH = 1e-3  # m, of y, where a start is named by its letter alone
DURATION = 300.0  # s
_SPEED = "wind.speed"
# a command has no options for it
_BRIDGED, _BRIDGED_HERE = "gaps='interpolate'", "rainwind.read_wind(file, gaps='interpolate') in Python"
_TIME = Kind("time", {"s": (1, 1), "min": (60, 1), "h": (3600, 1)}, ("s",), "s", "300 s")
_TURNING = Kind("angular velocity", {"rad_s": (1, 1)}, ("rad/s",), "rad_s", "0.1 rad/s")
_STATES = {
    "y": KINDS["length"], "z": KINDS["length"], "phi": KINDS["angle"],
    "y_dot": KINDS["speed"], "z_dot": KINDS["speed"], "phi_dot": _TURNING,
}  # fmt: skip
WINDS = (
    "a speed such as '9 m/s', a ramp such as '8 m/s to 14 m/s' or '8 m/s to 14 m/s in 2 min', a record such as "
    "wind.csv, or 'turbulent 12 m/s, 10 %, 100 m, seed 1' (mean, intensity, length scale)"
)
STARTS = "a letter such as D, or states such as 'phi = 45 deg, y = 10 mm', or both: 'D, y = 10 mm'"


@dataclass(frozen=True)
class WindGiven:
    """Parameters of the model that the wind sets, numbers or signals; in words; and how long it is given, s."""

    parameters: Mapping[str, float | Signal]
    words: str
    until: float = float("inf")

    @property
    def first(self) -> float:
        """The speed at the start, m/s."""
        speed = self.parameters[_SPEED]
        return float(speed.at(0.0)) if isinstance(speed, Signal) else speed

    @property
    def varies(self) -> bool:
        """Whether it is more than a number."""
        return isinstance(self.parameters[_SPEED], Signal)


def seconds(text: str) -> float:
    """A duration from text; a plain number is in seconds. Raises InputError."""
    found = _number(text, _TIME, "--duration")
    if not found > 0.0:
        raise InputError(f"--duration '{text}': give a time above 0, such as '300 s' or '5 min'")
    return found


def wind_from_text(text: str | None, model: RivuletModel, duration: float | None) -> WindGiven:
    """The wind, by default the case's own; a ramp takes the whole duration unless it says how long. InputError."""
    if text is None:
        speed = model.wind.speed
        return WindGiven({_SPEED: speed}, f"{speed:g} m/s")
    given = text.strip()
    if given.lower().endswith((".csv", ".txt", ".tsv")) or Path(given).is_file():
        try:
            record = read_wind(given)
        except InputError as error:
            raise InputError(str(error).replace(_BRIDGED, _BRIDGED_HERE)) from error
        until = record.speed.until
        if duration is not None and duration > until:
            raise InputError(
                f"--duration {duration:g} s: the record {Path(given).name} ends after {until:g} s; give at most that, "
                "or leave --duration out"
            )
        return WindGiven(record.parameters, f"record {Path(given).name}", until)
    if given.lower().startswith("turbulent"):
        return _turbulent(given, duration or DURATION)
    parts = re.split(r"\s+to\s+", given)
    if len(parts) > 2:
        raise InputError(f"--wind '{text}' has more than one 'to'; give {WINDS}")
    if len(parts) == 2:
        end, _, length = parts[1].partition(" in ")
        low, high = _speed(parts[0]), _speed(end)
        over = seconds(length) if length else duration or DURATION
        return WindGiven(
            {_SPEED: ramp(low, high, over)}, f"{low:g} to {high:g} m/s in {over:g} s", float("inf")
        )
    speed = _speed(given)
    return WindGiven({_SPEED: speed}, f"{speed:g} m/s")


def _turbulent(text: str, duration: float) -> WindGiven:
    given = [part.strip() for part in text[len("turbulent") :].split(",")]
    if len(given) != 4 or not re.fullmatch(r"seed\s+\d+", given[3]):
        raise InputError(
            f"--wind '{text}': write a turbulent wind as 'turbulent 12 m/s, 10 %, 100 m, seed 1'"
        )
    mean = _speed(given[0])
    intensity = _number(given[1], KINDS["ratio"], "--wind")
    length = _number(given[2], KINDS["length"], "--wind")
    seed = int(given[3].split()[1])
    found = turbulent_wind(mean=mean, intensity=intensity, length=length, duration=duration, seed=seed)
    words = f"turbulent {mean:g} m/s, {100 * intensity:g} %, {length:g} m, seed {seed}"
    return WindGiven(found.parameters, words, found.speed.until)


def start_from_text(text: str | None, model: RivuletModel, wind: WindGiven) -> tuple[np.ndarray, str]:
    """The state (n,) at the start, and its words; by default D with y displaced by 1 mm, A without D. InputError."""
    at = model.with_parameters({_SPEED: wind.first})
    parts = [part.strip() for part in (text or "").split(",") if part.strip()]
    letters = [part for part in parts if "=" not in part]
    if len(letters) > 1 or (letters and parts[0] is not letters[0]):
        raise InputError(f"--start '{text}': give {STARTS}")
    state, words, pushed = np.zeros(len(at.states)), [], not parts
    if letters or not parts:
        known = equilibria_by_letter(at)
        default = next((one for one in ("D", "A", *known) if one in known), "D")
        letter = letters[0].upper() if letters else default
        if letter not in known:
            there = f"there are {', '.join(known)}" if known else "there is none with a letter"
            raise InputError(
                f"--start '{letters[0] if letters else 'D'}': no such equilibrium at {wind.first:g} m/s; {there}. Give "
                f"{STARTS}"
            )
        state, pushed = known[letter].state.copy(), len(parts) <= 1
        words.append(letter)
    for part in parts[len(letters) :]:
        name, _, value = (piece.strip() for piece in part.partition("="))
        if name not in at.states:
            raise InputError(f"--start: there is no state '{name}'; the states are {', '.join(at.states)}")
        state[at.states.index(name)] = _number(value, _STATES[name], f"--start {name} =")
        words.append(f"{name} = {value}")
    if pushed:
        state[at.states.index("y")] += PUSH
        words.append(f"y displaced by {1000 * PUSH:g} mm")
    return state, ", ".join(words)


def span_from_text(span: tuple[str, str] | None) -> tuple[float, float] | None:
    """Two times of a run, s. Raises InputError."""
    if span is None:
        return None
    since, until = (_number(text, _TIME, "--span") for text in span)
    if not 0.0 <= since < until:
        raise InputError(f"--span '{span[0]}' '{span[1]}': give two times of the run, the earlier one first")
    return since, until


def _speed(text: str) -> float:
    found = _number(text, KINDS["speed"], "--wind", f"give {WINDS}")
    if not 0.0 < found <= FASTEST:
        raise InputError(f"--wind '{text.strip()}': a wind speed is above 0 and up to {FASTEST:g} m/s")
    return found


def _number(text: str, kind: Kind, option: str, more: str = "") -> float:
    """A number with its unit; a plain one is in SI where that is how people read it."""
    try:
        try:
            plain = float(text)
        except ValueError:
            return from_text(text, kind)
        if not np.isfinite(plain):
            raise InputError("is not a finite number")
        if kind.suffixes[kind.preferred] != (1, 1):
            raise InputError(f'has no unit; write {kind} with its unit, such as "{kind.example}"')
        return plain
    except InputError as error:
        raise InputError(f"{option} '{text.strip()}' {error}" + (f"; {more}" if more else "")) from error
