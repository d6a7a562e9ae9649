"""One mode of one stay: where it is unstable, how strongly it vibrates, which damping stops it.

Every coefficient set has samples of rivulet and slopes of its own; all of them together make the bands.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from rainwind.engineering.amplitudes import vibrations
from rainwind.engineering.answers import Band, ModeAnswer
from rainwind.engineering.bridge import Bridge
from rainwind.engineering.cable import Cable
from rainwind.engineering.climate import Climate, cycles, exposure
from rainwind.engineering.criteria import galloping_speed, rule_damping, scruton_numbers, vortex_speed
from rainwind.engineering.damper_design import force, stroke
from rainwind.engineering.dampers import DampedMode
from rainwind.engineering.equivalent_section import section_model
from rainwind.engineering.inflow import beta, normal_factor, yaw
from rainwind.engineering.linear_stability import Growth, damping_needed, growth
from rainwind.engineering.modes import Mode
from rainwind.engineering.rivulets import factors_at, usual_rivulet
from rainwind.engineering.upper_rivulet import UpperRivulet, upper_rivulets, wind_speed_normal
from rainwind.engineering.vibration_ranges import unstable_ranges
from rainwind.engineering.wind_profile import mode_factor, speed_factor
from rainwind.physics.coefficients import CoefficientSet
from rainwind.physics.model import RivuletModel

__all__ = ["Setting"]

_SPEEDS = 64  # looked at, for the range
_FEWEST = 8  # of them, where the observed speeds lie between two
_STEPS = 12  # of the observed speeds, for the amplitude
_BUILD_UP_FROM = 0.1  # diameters
_CYCLE_EDGES = (0.0, 0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0)  # diameters
_MID_SPAN = (
    pi**2 / 8
)  # displacement of a string's mid-span by an even load, over that of the section of mode 1


@dataclass(frozen=True, eq=False)
class _Set:
    """One coefficient set of one mode: its model, branches D, growth over directions and speeds; onset (s, g)."""

    model: RivuletModel
    rivulet: UpperRivulet
    growth: Growth
    onset: np.ndarray


@dataclass(frozen=True)
class Setting:
    """What all modes of all stays share.

    sets: each with its samples (s,) of each scattered quantity by name; workers: threads for the runs in time of one
    stay.
    """

    bridge: Bridge
    climate: Climate | None
    sets: tuple[tuple[CoefficientSet, Mapping[str, np.ndarray]], ...]
    workers: int

    def mode(self, cable: Cable, mode: Mode, damped: DampedMode) -> ModeAnswer:
        """The answer of one mode, with the damping of the stay itself and of its dampers."""
        question, site, limits = self.bridge.question, self.bridge.site, self.bridge.limits
        own = cable.damping_ratio(mode.number)
        ratio = own + damped.damping_ratio
        directions = 2 * pi * np.arange(question.directions) / question.directions
        # winds from both sides of the stay's plane are mirror images: each yaw once
        gamma, side = np.unique(np.round(yaw(directions, cable.heading), 12), return_inverse=True)
        weight = mode_factor(cable, mode, site)  # wind at the cable over that at the reference height
        speed = _looked_at(question.speeds, limits.observed_speeds)
        observed = (speed >= limits.observed_speeds[0]) & (speed <= limits.observed_speeds[1])

        fields = [self._set(cable, mode, one, ratio, gamma, weight * speed) for one in self.sets]
        ranges = [unstable_ranges(f.growth.rate, speed, f.onset / weight) for f in fields]
        low, high, opened = (np.concatenate(parts)[:, side] for parts in zip(*ranges, strict=True))
        needed = np.concatenate([damping_needed(f.growth, _everywhere(f))[0] for f in fields])
        seen = np.concatenate([damping_needed(f.growth, _everywhere(f) & observed)[0] for f in fields])
        worst = _worst_yaw(fields, observed)

        steps = np.linspace(*limits.observed_speeds, _STEPS)
        count = min(question.runs, question.samples)
        at = (gamma[[worst]], weight * steps, count)
        amplitude, lost, slow, rest = self._amplitudes(
            [self._set(cable, mode, one, ratio, *at) for one in self.sets]
        )
        largest = _largest(amplitude)
        # the rows of the samples that were followed in time, set by set
        followed = np.concatenate([k * question.samples + np.arange(count) for k in range(len(fields))])
        undamped = None
        if cable.dampers:
            undamped = self._amplitudes([self._set(cable, mode, one, own, *at) for one in self.sets])[0]
        wet, dry = self._hours(directions, low, high)
        within, _ = self._hours(directions, *_clipped(low, high, limits.observed_speeds))
        edges = np.array(_CYCLE_EDGES) * cable.diameter
        return ModeAnswer(
            number=mode.number,
            frequency_in=mode.frequency_in,
            frequency_out=mode.frequency_out,
            damping_own=own,
            damping_total=ratio,
            scruton=scruton_numbers(cable, ratio, site.density),
            directions=directions,
            speed_low=_bands(low),
            speed_high=_bands(high),
            share=np.isfinite(low).mean(axis=0),
            worst_direction=float(directions[np.flatnonzero(side == worst)[0]]),
            range_low=Band.of(_over_directions(low, np.fmin)),
            range_high=Band.of(_over_directions(high, np.fmax)),
            unlimited=float(opened.any(axis=1).mean()),
            damping_needed=Band.of(needed),
            damping_needed_observed=Band.of(seen),
            rule_damping=rule_damping(cable, site.density),
            speeds=steps,
            amplitudes=_bands(amplitude),
            amplitude=Band.of(largest),
            build_up=Band.of(_build_up(slow, largest, cable.diameter)),
            uplift=Band.of(_MID_SPAN * mode.number**2 * _largest(-rest)),
            lost=lost,
            amplitudes_undamped=None if undamped is None else _bands(undamped),
            amplitude_undamped=None if undamped is None else Band.of(_largest(undamped)),
            stroke=_damper_band(cable, damped, largest, stroke),
            force=_damper_band(cable, damped, largest, force),
            hours=wet,
            hours_dry=dry,
            hours_observed=within,
            cycle_edges=edges if self.climate is not None else None,
            cycles=self._cycles(
                directions, (low[followed], high[followed]), steps, amplitude, mode.frequency_out, edges
            ),
            stability_speeds=speed,
            stability_needed=_bands(_needed_over_speed(fields, worst, ratio)),
            galloping_speed=galloping_speed(cable, mode.frequency_out, ratio, site.density),
            vortex_speed=vortex_speed(cable, mode.frequency_out),
        )

    def _set(
        self,
        cable: Cable,
        mode: Mode,
        one: tuple[CoefficientSet, Mapping[str, np.ndarray]],
        ratio: float,
        gamma: np.ndarray,
        speed: np.ndarray,
        first: int | None = None,
    ) -> _Set:
        """The branches D and the growth about them with one set; speed: at the cable; first: samples, None for all."""
        given = self.bridge.rivulet
        rivulet = given or usual_rivulet(cable.diameter)
        coefficients, samples = one
        every = factors_at(samples, None if given else cable.diameter)
        factors = {name: values[:first] for name, values in every.items()}
        model = section_model(
            cable,
            mode,
            coefficients=coefficients,
            rivulet=rivulet,
            damping_ratio=ratio,
            density=self.bridge.site.density,
        )
        branches = upper_rivulets(model, factors, beta(gamma, cable.inclination))
        mass = factors["rivulet.mass"][:, None] * rivulet.mass
        onset = wind_speed_normal(model, branches.onset, mass) / normal_factor(gamma, cable.inclination)
        return _Set(model, branches, growth(model, factors, branches, gamma, speed), onset)

    def _amplitudes(self, fields: list[_Set]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Of all samples over the speeds of one direction: amplitude (s, k), share lost (k,), growth and y at rest."""
        runs = [
            vibrations(f.model, f.growth.state, f.growth.parameters, f.growth.rate, workers=self.workers)
            for f in fields
        ]
        amplitude = np.concatenate([run.amplitude[:, 0] for run in runs])
        lost = np.concatenate([run.lost[:, 0] for run in runs]).mean(axis=0)
        rate = np.concatenate([f.growth.rate[:, 0] for f in fields])
        return amplitude, lost, rate, np.concatenate([f.growth.state[:, 0, :, 0] for f in fields])

    def _hours(
        self, directions: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> tuple[Band | None, Band | None]:
        if self.climate is None:
            return None, None
        found = exposure(self.climate, directions, low.T, high.T, factor=self._to_reference)
        return Band.of(found.wet_hours), Band.of(found.dry_hours)

    def _cycles(
        self,
        directions: np.ndarray,
        ranges: tuple[np.ndarray, np.ndarray],
        speeds: np.ndarray,
        amplitude: np.ndarray,
        frequency: float,
        edges: np.ndarray,
    ) -> np.ndarray | None:
        """Expected cycles a year in each bin: the mean over all samples, each with its own ranges and amplitudes."""
        if self.climate is None:
            return None
        each = [
            cycles(
                self.climate, directions, low, high, speeds, own, frequency, edges, factor=self._to_reference
            )
            for low, high, own in zip(*ranges, amplitude, strict=True)
        ]
        return np.mean(each, axis=0)

    @property
    def _to_reference(self) -> float:
        """The wind at the reference height over that at the anemometer."""
        assert self.climate is not None
        return 1.0 / speed_factor(self.bridge.site, self.climate.height)


def _looked_at(speeds: tuple[float, float], observed: tuple[float, float]) -> np.ndarray:
    """Wind speeds (n,), rising evenly on a logarithmic scale; more where hardly one of them is an observed speed."""
    grid = np.geomspace(*speeds, _SPEEDS)
    low, high = max(speeds[0], observed[0]), min(speeds[1], observed[1])
    if np.count_nonzero((grid >= low) & (grid <= high)) < 2:
        grid = np.unique(np.concatenate([grid, np.linspace(low, high, _FEWEST)]))
    return grid


def _clipped(low: np.ndarray, high: np.ndarray, bounds: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """The part of each range within the bounds; nan where nothing is left."""
    a, b = np.maximum(low, bounds[0]), np.minimum(high, bounds[1])
    return np.where(a < b, a, np.nan), np.where(a < b, b, np.nan)


def _everywhere(one: _Set) -> np.ndarray:
    return np.isfinite(one.growth.rate)


def _worst_yaw(fields: list[_Set], observed: np.ndarray) -> int:
    """The number of the yaw in which the middle sample needs the most damping at an observed speed, to first order.

    Where the middle sample grows in none, most samples having no rivulet yet, that in which the others grow most.
    """
    rates = np.concatenate([f.growth.rate / f.growth.omega for f in fields])[..., observed]
    per_sample = np.where(np.isfinite(rates), rates, -np.inf).max(axis=-1)
    middle, grows = np.median(per_sample, axis=0), np.maximum(per_sample, 0.0).mean(axis=0)
    if middle.max() <= 0.0 < grows.max():
        return int(grows.argmax())
    return int(np.nan_to_num(middle, neginf=-1e9).argmax())


def _needed_over_speed(fields: list[_Set], yaw_number: int, ratio: float) -> np.ndarray:
    """The damping ratio (s, n) of no growth at each speed of one yaw: the rate falls by omega for each unit of it."""
    need = np.concatenate([(f.growth.rate / f.growth.omega)[:, yaw_number] for f in fields]) + ratio
    return np.maximum(np.nan_to_num(need), 0.0)


def _bands(values: np.ndarray) -> np.ndarray:
    """(s, k) -> (k, 3): the band of each column, nan where nothing is."""
    bands = [Band.of(column) for column in values.T]
    return np.array([[band.low, band.middle, band.high] for band in bands])


def _over_directions(values: np.ndarray, least: Any) -> np.ndarray:
    """(s, g) -> (s,), nan where no direction has a value."""
    return least.reduce(values, axis=1)


def _largest(values: np.ndarray) -> np.ndarray:
    """The largest at any speed (s, k) -> (s,); nan where there is none."""
    return np.fmax.reduce(values, axis=1)


def _build_up(rate: np.ndarray, amplitude: np.ndarray, diameter: float) -> np.ndarray:
    """s from a tenth of a diameter to the amplitude, at the fastest growth; nan where nothing grows."""
    fastest = np.where(np.isfinite(rate), rate, -np.inf).max(axis=1)
    start = _BUILD_UP_FROM * diameter
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.log(amplitude / start) / fastest
    return np.where((fastest > 0) & (amplitude > start), found, np.nan)


def _damper_band(
    cable: Cable, damped: DampedMode, amplitude: np.ndarray, what: Callable[..., Any]
) -> Band | None:
    """The band of the largest stroke or force of any damper of the stay; None without dampers."""
    if not cable.dampers:
        return None
    each = [what(damper, damped, number, amplitude) for number, damper in enumerate(cable.dampers)]
    return Band.of(np.max(each, axis=0))
