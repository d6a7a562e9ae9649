"""How likely a vibration is when what is hard to know scatters: rivulet mass, damping, slopes of coefficients, wind.

Section 5: "the exact values of some parameters are difficult to obtain". Each sample is one cable in one wind: from
the upper rivulet's equilibrium D of the case as given (the nearest one where there is none), the cable displaced by one
diameter, it is followed for 20 minutes (at 1 Hz). It vibrates if in the last minute y or z swings by more than half a
diameter (half peak to peak). A rivulet that is lost does not vibrate. The scatter is our
assumption, no measurement: rivulet mass and damping ratio log-normal, slopes of lift, drag and moment about the middle
of their range normal, all independent. Sobol indices (SciPy, Saltelli's sampling) say which of them decides: of the
amplitude, with the wind uniform over the range.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import lognorm, norm, qmc, sobol_indices, uniform

from rainwind.dynamics.attractors import Progress
from rainwind.dynamics.ensembles import ensemble
from rainwind.dynamics.reductions import Extremes
from rainwind.errors import InputError, is_interrupt
from rainwind.io.results import Column, Table, save_csv, save_netcdf
from rainwind.physics.model import RivuletModel
from rainwind.physics.tilted import DRAG, LIFT, MOMENT, SLOPES, ScatteredModel
from rainwind.plotting import style
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import speed_window
from rainwind.studies.long_time import UpperRivulet, upper_rivulet

MASS, RATIO, SPEED = "rivulet.mass", "section.damping_ratio", "wind.speed"
SCATTER = {MASS: 0.2, RATIO: 0.3, LIFT: 0.1, DRAG: 0.1, MOMENT: 0.1}
WORDS = {MASS: "rivulet mass", RATIO: "damping ratio", SPEED: "wind speed", **{name: name for name in SLOPES}}
PERIODS, LAST = 1200.0, 60.0  # followed, and looked at
THRESHOLD = 0.5  # of the diameter
_TOLERANCE = 1e-7
_FEWEST = 16


@dataclass(frozen=True, eq=False)
class Result:
    """speed (m,); vibrates, lost (m, s): of each sample at each speed, nan where not computed; the samples' factors.

    indices: name -> (first order, its standard error, total, its standard error) of the amplitude; None where stopped.
    """

    model: RivuletModel
    speed: np.ndarray
    factors: dict[str, np.ndarray]
    vibrates: np.ndarray
    lost: np.ndarray
    amplitude: np.ndarray
    scatter: Mapping[str, float]
    nominal: np.ndarray
    indices: dict[str, tuple[float, float, float, float]] | None = None
    evaluations: int = 0
    wind: tuple[float, float] = field(default=(0.0, 0.0))

    @property
    def samples(self) -> int:
        """Samples computed at every speed."""
        return int(np.sum(np.all(np.isfinite(self.vibrates), axis=0)))

    @property
    def partial(self) -> bool:
        """Whether the user stopped it."""
        return self.indices is None or self.samples < self.vibrates.shape[1]

    @property
    def empty(self) -> bool:
        """Whether nothing was computed."""
        return self.samples == 0

    def probability(self, what: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The share of samples (m,), and Wilson's 95 % limits."""
        done = np.all(np.isfinite(what), axis=0)
        n, p, z = int(done.sum()), what[:, done].mean(axis=1), 1.96
        middle = (p + z * z / (2 * n)) / (1 + z * z / n)
        half = z / (1 + z * z / n) * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return p, np.maximum(middle - half, 0.0), np.minimum(middle + half, 1.0)


def compute(
    model: RivuletModel | None = None,
    *,
    speeds: tuple[float, float] | None = None,
    scatter: Mapping[str, float] | None = None,
    samples: int = 256,
    shape: int = 33,
    sobol: int = 512,
    seed: int = 1,
    workers: Any = None,
    progress: Progress | None = None,
) -> Result:
    """Probabilities at `shape` wind speeds from the same samples at each, then Sobol indices from sobol (2 + d) runs.

    scatter: relative standard deviations by name (SCATTER's names), 0 to 0.5; those left out keep their default.
    sobol: a power of two, 0 for none. Ctrl-C (or progress raising KeyboardInterrupt) gives what is done. InputError.
    """
    model = model or paper.model()
    if model.section.damping_ratio_y is not None or model.section.damping_ratio_z is not None:
        raise InputError("one damping ratio for y and z is scattered; give section.damping_ratio alone")
    for name, value in (scatter or {}).items():
        if name not in SCATTER:
            raise InputError(f"scatter names {', '.join(SCATTER)}; got '{name}'")
        if not 0.0 <= value <= 0.5:
            raise InputError(f"scatter of {name} = {value!r}: give a share from 0 to 0.5, 0.2 for 20 %")
    if samples < 2 or shape < 2:
        raise InputError(f"samples = {samples!r} and shape = {shape!r} must be 2 or more")
    if sobol & (sobol - 1) or not (sobol == 0 or sobol >= _FEWEST):
        raise InputError(f"sobol = {sobol!r}: give a power of two, {_FEWEST} or more, or 0 for no indices")
    wide = {**SCATTER, **(scatter or {})}
    low, high = speeds or speed_window(model, 2.0)
    if not 0.0 < low < high:
        raise InputError(f"speeds = ({low!r}, {high!r}): give two numbers above zero, the lower one first")
    runner = _Runner(model, upper_rivulet(model, (low, high)), workers)
    speed, d = np.linspace(low, high, shape), len(wide)
    unit = qmc.Sobol(d, rng=np.random.default_rng(seed)).random(samples) if samples & (samples - 1) == 0 else (
        qmc.LatinHypercube(d, rng=np.random.default_rng(seed)).random(samples)
    )  # fmt: skip
    distributions = _distributions(wide)
    factors = {name: one.ppf(unit[:, k]) for k, (name, one) in enumerate(distributions.items())}
    everything = shape * samples + sobol * (d + 3)
    told = _Told(progress, everything)
    amplitude = np.full((shape, samples), np.nan)
    lost = np.full((shape, samples), np.nan)
    nominal, indices, step = np.full(shape, np.nan), None, max(2, min(32, samples // 4))
    try:
        nominal = runner(speed, {name: np.ones(shape) for name in wide}, told)[0]
        for first in range(0, samples, step):
            part = slice(first, min(first + step, samples))
            many = part.stop - part.start
            found = runner(
                np.repeat(speed, many), {n: np.tile(v[part], shape) for n, v in factors.items()}, told
            )
            amplitude[:, part], lost[:, part] = (values.reshape(shape, many) for values in found)
        if sobol:
            indices = _indices(runner, distributions, (low, high), sobol, seed, told)
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
    bar = THRESHOLD * model.section.diameter
    vibrates = np.where(np.isfinite(amplitude), (amplitude > bar) & (lost < 0.5), np.nan)
    return Result(
        model, speed, factors, vibrates, lost, amplitude, wide, nominal,
        {} if not sobol else indices, sobol * (d + 3), (low, high),
    )  # fmt: skip


class _Told:
    """Progress of several ensembles as one."""

    def __init__(self, progress: Progress | None, total: int) -> None:
        self.progress, self.total, self.before = progress, total, 0

    def __call__(self, done: int) -> None:
        if self.progress is not None:
            count = min(self.before + done, self.total)
            self.progress(count, self.total, f"{count} of {self.total} samples")


class _Runner:
    """Amplitudes in the last minute, and whether the rivulet is lost, of many samples."""

    def __init__(self, model: RivuletModel, upper: UpperRivulet, workers: Any) -> None:
        section = model.section
        self.model, self.upper, self.workers = model, upper, workers
        self.scattered = ScatteredModel(model)
        period = 1.0 / min(section.frequency_y, section.frequency_z)
        self.duration, self.since = PERIODS * period, (PERIODS - LAST) * period
        if upper.at(model.wind.speed) is None:
            raise InputError(
                "this case has no upper rivulet D at any wind speed, so that nothing vibrates with it"
            )

    def __call__(
        self, speed: np.ndarray, factors: Mapping[str, np.ndarray], told: _Told
    ) -> tuple[np.ndarray, np.ndarray]:
        own = self.model.parameters
        varying = {SPEED: speed}
        varying |= {name: f * own.get(name, 1.0) for name, f in factors.items()}
        x = np.array([self.upper.at(float(u)) for u in speed])
        x[:, self.model.states.index("y")] += self.model.section.diameter
        names = tuple(name for name in ("y", "z") if name in self.model.states)
        run = ensemble(
            self.scattered, x, varying=varying, duration=self.duration, tolerance=_TOLERANCE,
            reduce=Extremes(of=names, since=self.since), workers=self.workers,
            progress=lambda done, total, what: told(done),
        )  # fmt: skip
        if run.interrupted:
            raise KeyboardInterrupt
        told.before += len(speed)
        amplitude = np.asarray(run["amplitude"]).reshape(len(speed), -1).max(axis=1)
        phi = run.final[:, self.model.states.index("phi")]
        lost = np.cos(phi + self.model.beta) + 0.5 < 0.0
        failed = ~np.isfinite(amplitude)
        return np.where(failed | lost, 0.0, amplitude), np.asarray(lost | failed, dtype=float)


def _distributions(scatter: Mapping[str, float]) -> dict[str, Any]:
    """Of the factors on each quantity; the median of a log-normal and the mean of a normal is 1."""
    return {
        name: lognorm(s=np.sqrt(np.log1p(max(wide, 1e-9) ** 2)))
        if name in (MASS, RATIO)
        else norm(loc=1.0, scale=max(wide, 1e-9))
        for name, wide in scatter.items()
    }


def _indices(
    runner: _Runner,
    distributions: Mapping[str, Any],
    wind: tuple[float, float],
    many: int,
    seed: int,
    told: _Told,
) -> dict[str, tuple[float, float, float, float]]:
    names = [SPEED, *distributions]
    dists = [uniform(wind[0], wind[1] - wind[0]), *distributions.values()]

    def amplitude(x: np.ndarray) -> np.ndarray:
        flat = x.reshape(len(names), -1)
        found, _ = runner(flat[0], dict(zip(names[1:], flat[1:], strict=True)), told)
        return found.reshape(1, *x.shape[1:])

    with np.errstate(all="ignore"):  # of some resamples, or of all, nothing vibrates
        found = sobol_indices(func=amplitude, n=many, dists=dists, rng=np.random.default_rng(seed))
        spread = found.bootstrap(confidence_level=0.6827, n_resamples=400)
    first, total = (np.ravel(v) for v in (found.first_order, found.total_order))
    errors = [
        0.5 * (np.ravel(one.confidence_interval.high) - np.ravel(one.confidence_interval.low))
        for one in (spread.first_order, spread.total_order)
    ]
    if not np.all(np.isfinite(total)):
        return {}
    return {
        name: (float(first[k]), float(errors[0][k]), float(total[k]), float(errors[1][k]))
        for k, name in enumerate(names)
    }


def draw(result: Result, figure: Figure) -> Figure:
    """Over wind speed the probabilities of a vibration and of a lost rivulet (a); which quantity decides (b)."""
    with style.journal(figure, width="double", height=82):
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
        for what, color, line, name in (
            (result.vibrates, style.VERMILION, "-", "the cable vibrates"),
            (result.lost, style.GREY, style.DASHED, "the rivulet is lost"),
        ):
            p, low, high = result.probability(what)
            left.fill_between(result.speed, low, high, color=color, alpha=0.25, linewidth=0)
            left.plot(result.speed, p, color=color, linestyle=line, label=name)
        bar = THRESHOLD * result.model.section.diameter
        at = result.speed[result.nominal > bar]
        if at.size:
            high, said = np.full(at.size, 1.04), "without scatter it vibrates"
            left.plot(at, high, "s", color=style.BLACK, markersize=2.4, label=said)
        left.set(xlabel=style.UNDISTURBED, ylabel="probability", ylim=(0.0, 1.09), xlim=result.wind)
        left.legend(loc="best")
        style.panel(left, "a", f"{result.samples} samples at each speed, 95 % limits shaded")
        if result.indices:
            names = sorted(result.indices, key=lambda name: result.indices[name][2])  # type: ignore[index]
            rows = np.arange(len(names))
            values = np.array([result.indices[name] for name in names])
            for shift, k, color, label in ((0.18, 2, style.ORANGE, "total"), (-0.18, 0, style.BLUE, "alone")):
                right.barh(
                    rows + shift, np.maximum(values[:, k], 0.0), 0.34, xerr=values[:, k + 1], color=color,
                    label=label, error_kw={"elinewidth": 0.6},
                )  # fmt: skip
            right.set_yticks(rows, [WORDS[name] for name in names])
            right.set(xlabel="Sobol index of the amplitude", xlim=(0.0, None))
            right.tick_params(axis="y", length=0)
            right.legend(loc="lower right")
        else:
            style.note(
                right,
                "not asked for, or\nnothing vibrates"
                if result.indices == {}
                else "stopped before\nthe Sobol indices",
            )
            right.set(xticks=[], yticks=[])
        style.panel(right, "b", "what decides")
        if result.partial:
            figure.suptitle(
                f"stopped: {result.samples} of {result.vibrates.shape[1]} samples are computed", fontsize=8.0
            )
    return figure


def summary(result: Result) -> list[str]:
    """The largest probability and where, the range in which a vibration is likely, what decides; what was assumed."""
    p, low, high = result.probability(result.vibrates)
    k = int(p.argmax())
    said = []
    if result.partial:
        said.append(
            f"Stopped by the user: {result.samples} of {result.vibrates.shape[1]} samples are computed."
        )
    said.append(
        f"A vibration is most likely at {result.speed[k]:.1f} m/s: {100 * p[k]:.0f} % "
        f"({100 * low[k]:.0f} to {100 * high[k]:.0f} % with 95 % confidence)."
    )
    likely = result.speed[p >= 0.5]
    if likely.size:
        said.append(f"It is likelier than not between {likely.min():.1f} and {likely.max():.1f} m/s.")
    if result.indices:
        order = sorted(result.indices.items(), key=lambda item: -item[1][2])
        words = ", ".join(f"{WORDS[name]} {v[2]:.2f} ± {v[3]:.2f}" for name, v in order)
        said.append(f"Total Sobol indices of the amplitude: {words}.")
    wide = ", ".join(f"{WORDS[name]} {100 * value:g} %" for name, value in result.scatter.items())
    return [*said, f"Scatter assumed (standard deviations): {wide}."]


def tables(result: Result) -> dict[str, Table]:
    """Probabilities over speed, and the indices, SI."""
    p, low, high = result.probability(result.vibrates)
    gone = result.probability(result.lost)[0]
    found = {
        "probability": Table(
            {
                SPEED: Column(result.speed, "m/s"), "vibration": Column(p), "low": Column(low), "high": Column(high),
                "rivulet lost": Column(gone), "amplitude without scatter": Column(result.nominal, "m"),
            },
            {"samples": result.samples, **{f"scatter of {n}": v for n, v in result.scatter.items()}},
        )
    }  # fmt: skip
    if result.indices:
        values = np.array(list(result.indices.values())).T
        labels = ("first order", "first order error", "total", "total error")
        found["sobol"] = Table(
            {
                "quantity": Column(np.array(list(result.indices), dtype=object)),
                **{label: Column(v) for label, v in zip(labels, values, strict=True)},
            },
            {"runs": result.evaluations},
        )
    return found


def save(result: Result, path: Path) -> None:
    """Draw it into an image file. OSError where it cannot be written."""
    style.save(draw(result, Figure()), path)


def save_data(result: Result, image: Path) -> list[Path]:
    """Write the tables beside the image, as .csv, and all in one .nc; the files' names. InputError."""
    from rainwind import __version__

    paths = []
    for name, table in tables(result).items():
        paths.append(image.with_name(f"{image.stem}_{name}.csv"))
        save_csv(paths[-1], table)
    paths.append(image.with_suffix(".nc"))
    save_netcdf(paths[-1], tables(result), source="vibration_probability", version=__version__)
    return paths
