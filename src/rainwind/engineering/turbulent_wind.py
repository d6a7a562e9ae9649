"""A turbulent wind as signals: the speed along the mean wind and the vertical one."""

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np

from rainwind.dynamics.records import record
from rainwind.dynamics.signals import Signal
from rainwind.errors import InputError
from rainwind.physics.checks import not_negative, positive
from rainwind.physics.turbulence import Component, Spectrum, share_below, turbulent_samples

__all__ = ["VERTICAL_INTENSITY", "VERTICAL_LENGTH", "TurbulentWind", "turbulent_wind"]

VERTICAL_INTENSITY = 0.5
"""Vertical over along-wind standard deviation: IEC 61400-1, annex B, as quoted in the literature."""
VERTICAL_LENGTH = 0.66 / 8.1
"""Vertical over along-wind length scale: IEC 61400-1, annex B, as quoted in the literature."""
_MOST_SAMPLES = 2**24


@dataclass(frozen=True, eq=False)
class TurbulentWind:
    """One record of a turbulent wind.

    speed, vertical_speed: U(t) and w(t) in m/s from 0 to the duration, periodic: `speed.repeated(3)` goes on without
    a jump. intensity, vertical_intensity: standard deviation over mean speed, as asked for. resolved,
    vertical_resolved: the share of that variance in the band between one wave in the record and half the sampling
    rate; the record has this share of it. clipped: share of the time at which the speed was raised to `lowest`.
    """

    speed: Signal
    vertical_speed: Signal
    intensity: float
    vertical_intensity: float
    resolved: float
    vertical_resolved: float
    clipped: float

    @property
    def parameters(self) -> dict[str, Signal]:
        """Both signals by the names of the model's parameters."""
        return {"wind.speed": self.speed, "wind.vertical_speed": self.vertical_speed}


def turbulent_wind(
    *,
    mean: float,
    intensity: float,
    length: float,
    duration: float,
    seed: int,
    spectrum: Spectrum = "kaimal",
    dt: float = 0.1,
    vertical_intensity: float | None = None,
    vertical_length: float | None = None,
    lowest: float | None = None,
) -> TurbulentWind:
    """A turbulent wind U(t), w(t) at one point, a stationary Gaussian process with the spectrum given.

    mean: U in m/s; intensity: sigma_u / U (0.1 is 10 %); length: integral length scale L_u in m, S(0) = 4 sigma² L/U
    (EN 1991-1-4's L(z) times 1.7); duration and dt in s, dt made smaller where it does not divide the duration.
    spectrum: "kaimal" (IEC 61400-1) or "von karman" (ESDU 85020). The vertical part has intensity and length of its
    own, by default 0.5 and 0.66 / 8.1 times those along the wind, and is independent of it. seed: a whole number of
    0 or more; the same seed gives the same wind, to rounding on every machine. Between the samples runs a cubic
    spline. A wind that would stand still or turn back is refused, or raised to `lowest` (m/s), which changes its
    spectrum. Raises InputError. Source of the method: Shinozuka & Deodatis (1991), with random phases.
    """
    mean, length = positive("mean", mean), positive("length", length)
    duration, dt = positive("duration", duration), positive("dt", dt)
    strong = not_negative("intensity", intensity, "0.1 means 10 %")
    up = VERTICAL_INTENSITY * strong if vertical_intensity is None else vertical_intensity
    up = not_negative("vertical_intensity", up, "0.05 means 5 %")
    up_length = VERTICAL_LENGTH * length if vertical_length is None else vertical_length
    up_length = positive("vertical_length", up_length)
    if lowest is not None and not 0 < positive("lowest", lowest) < mean:
        raise InputError(f"lowest = {lowest:g} must lie between 0 and the mean, {mean:g} m/s")
    seed = _seed(seed)
    count = ceil(duration / dt * (1 - 1e-12))
    if not 4 <= count <= _MOST_SAMPLES:
        raise InputError(
            f"duration / dt = {duration:g} / {dt:g} makes {count} samples; allowed is 4 to {_MOST_SAMPLES}"
        )

    def part(component: Component, own_length: float, number: int) -> tuple[np.ndarray, float]:
        samples = turbulent_samples(
            count, duration / count, (seed, number), spectrum, component, own_length, mean
        )
        edges = np.array([0.5, (count - 1) // 2 + 0.5]) / duration
        low, high = share_below(edges, spectrum, component, own_length, mean)
        return samples, float(high - low)

    along, resolved = part("along", length, 0)
    vertical, vertical_resolved = part("vertical", up_length, 1)
    speed, clipped = _above(lowest, mean + strong * mean * along, duration)
    return TurbulentWind(
        speed,
        _periodic(up * mean * vertical, duration, "spline"),
        strong,
        up,
        resolved,
        vertical_resolved,
        clipped,
    )


def _periodic(samples: np.ndarray, duration: float, kind: Any) -> Signal:
    times = np.linspace(0.0, duration, samples.size + 1)
    return record(times, np.append(samples, samples[0]), kind, periodic=True)


def _above(lowest: float | None, samples: np.ndarray, duration: float) -> tuple[Signal, float]:
    """The speed between the samples, and the share of samples that was raised."""
    signal = _periodic(samples, duration, "spline")
    slowest, _ = signal.extremes()
    if lowest is not None and slowest < lowest:
        # no overshoot below the bound
        raised = np.maximum(samples, lowest)
        return _periodic(raised, duration, "cubic"), float(np.mean(samples < lowest))
    if slowest <= 0:
        raise InputError(
            f"the wind's speed would fall to {slowest:.3g} m/s, and the quasi-steady model needs it above 0; take a "
            "lower intensity, another seed, or raise it with lowest, for example lowest=0.5"
        )
    return signal, 0.0


def _seed(given: Any) -> int:
    if isinstance(given, bool) or not isinstance(given, int | np.integer) or given < 0:
        raise InputError(f"seed = {given!r} must be a whole number of 0 or more")
    return int(given)
