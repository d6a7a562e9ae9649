"""The time domain's parts of T5 and T7: where sweeps of the wind jump, and how long it takes to reach the cycle."""

from functools import lru_cache

import numpy as np

from rainwind.physics.model import RivuletModel
from rainwind.studies import wind_sweep
from rainwind.studies.targets_record import Part, Rows, close
from rainwind.studies.targets_statements import STATEMENTS
from rainwind.studies.transients import Transient, transient
from rainwind.studies.wind_sweep import Jump

SWEPT = (10.4, 13.2)  # m/s, about the paper's two jumps
SPEEDS = (9.0, 11.0, 12.0, 13.0, 14.0)  # m/s, of T7's table
AT = 9.0  # m/s, T7
FIVE_MINUTES = 300.0  # s
_AFTER = {"cycle": "another vibration", "nowhere": "nowhere: the rivulet runs away"}
_ENDS = {"cycle": "a limit cycle", "turning": "whole turns", "": "it runs away"}


@lru_cache(maxsize=4)
def jumps(model: RivuletModel) -> tuple[Jump, ...]:
    """The jumps of quasi-static sweeps over the wind speeds of the paper's jumps, both ways."""
    return wind_sweep.compute(model, speeds=SWEPT).jumps


def jump_parts(model: RivuletModel) -> tuple[tuple[Part, ...], str]:
    """T5: whether the vibration jumps at 10.7 m/s in falling and at 12.7 m/s in rising wind; what it does."""
    found = [jump for jump in jumps(model) if jump.before == "cycle"]
    limit = STATEMENTS["T5"].tolerance or 0.0
    parts = tuple(
        Part(
            f"in {word} wind the vibration jumps to another within {limit:g} m/s of {at:g} m/s",
            any(
                one.rising == rising and one.after == "cycle" and close(one.speed, at, limit) for one in found
            ),
        )
        for rising, word, at in ((False, "falling", 10.7), (True, "rising", 12.7))
    )
    said = [
        f"in {'rising' if one.rising else 'falling'} wind the vibration ends in a jump at {one.speed:.2f} m/s, to "
        f"{_AFTER.get(one.after, one.after)}"
        for one in found
    ]
    for rising, word in ((True, "rising"), (False, "falling")):
        if not any(one.rising == rising for one in found):
            said.append(f"in {word} wind no vibration jumps between {SWEPT[0]:g} and {SWEPT[1]:g} m/s")
    return parts, f"Quasi-static sweeps: {'; '.join(said)}"


@lru_cache(maxsize=16)
def _run(model: RivuletModel, speed: float) -> Transient | None:
    return transient(model, speed)


def time_part(model: RivuletModel) -> tuple[Part, str, Rows]:
    """T7: whether a small disturbance of D reaches the cycle at 9 m/s after five minutes or more; other wind speeds."""
    runs = {speed: _run(model, speed) for speed in SPEEDS}
    own = runs[AT]
    reached = own is not None and own.end == "cycle" and own.since > FIVE_MINUTES
    part = Part("from D with y displaced by 1 mm the cycle is reached, after more than 5 minutes", reached)
    rows = tuple(
        (f"{speed:g}", *_row(one)) if one is not None else (f"{speed:g}", "no D", None, None, None)
        for speed, one in runs.items()
    )
    header = (
        "wind [m/s]",
        "ends at",
        "within 1 % of the cycle after [s]",
        "passes C after [s]",
        "half amplitudes y, z [m]",
    )
    cycles = [one for one in runs.values() if one is not None and one.end == "cycle"]
    said = "no cycle is reached at any of the wind speeds looked at"
    if cycles:
        said = "a cycle is reached " + ", ".join(f"at {c.speed:g} m/s after {c.since:.0f} s" for c in cycles)
    fate = ""
    if own is not None and np.isfinite(own.lost):
        to = (
            f"falls to {own.end}"
            if own.end in ("A", "B", "C")
            else "runs away, as these coefficients have no A"
        )
        fate = (
            f"From D with y displaced by 1 mm the rivulet at 9 m/s passes C after {own.lost:.0f} s and {to}; "
        )
    return part, f"{fate}{said}, to within 1 % of its amplitudes", Rows(header, rows)


def _row(one: Transient) -> tuple[str, float | None, float | None, str | None]:
    since = round(one.since) if one.end == "cycle" else None
    lost = round(one.lost) if np.isfinite(one.lost) else None
    size = None
    if one.cycle is not None:
        size = ", ".join(f"{one.cycle.amplitude[n]:.3f}" for n in ("y", "z") if n in one.run.states)
    return _ENDS.get(one.end, one.end), since, lost, size
