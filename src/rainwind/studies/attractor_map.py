"""Where over wind speed and damping the cable rests, vibrates, beats, is chaotic or loses its rivulet (section 5).

Each cell is one trajectory, followed until it is clear where it ends: from the upper rivulet's equilibrium D (the
nearest one where there is none), the cable displaced across the wind by one diameter. Other starts may end
elsewhere (`basins.py`). The lines are the fold and the Hopf curves of figure 9: they limit where D
is stable, not where a start as large as this one settles on a vibration.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from rainwind.dynamics.attractors import Progress, attractors
from rainwind.errors import InputError
from rainwind.io.results import Column, Table, save_csv, save_netcdf
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.maps import draw_amplitudes, draw_cells, handles
from rainwind.plotting.regions import draw_fold, draw_hopf
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import speed_window
from rainwind.studies.long_time import (
    CHAOS,
    CYCLE,
    MISSING,
    NAMES,
    TORUS,
    TURNS,
    UNDECIDED,
    amplitudes_of,
    numbers_of,
    times_of,
    upper_rivulet,
)
from rainwind.studies.stability_diagram import StabilityDiagram, stability_diagram

SPEED, RATIO = "wind.speed", "section.damping_ratio"
PERCENT = 100.0
SHAPE = (50, 50)
RATIOS = (0.0001, 0.008)


@dataclass(frozen=True, eq=False)
class Result:
    """speed (m,) in m/s, ratio (k,); kind (k, m): a number in long_time.NAMES, -1 not computed; amplitudes (k, m) in m.

    rate, efolds (k, m): the growth of a disturbance across the flow where it was followed. period (k, m): of cycles.
    displaced: how far the cable was displaced at the start, m.
    """

    model: RivuletModel
    speed: np.ndarray
    ratio: np.ndarray
    kind: np.ndarray
    amplitude: dict[str, np.ndarray]
    period: np.ndarray
    rate: np.ndarray
    efolds: np.ndarray
    displaced: float
    longest: float
    diagram: StabilityDiagram | None = None

    @property
    def partial(self) -> bool:
        """Whether the user stopped it."""
        return bool(np.any(self.kind == MISSING))

    @property
    def empty(self) -> bool:
        """Whether nothing was computed."""
        return bool(np.all(self.kind == MISSING))


def compute(
    model: RivuletModel | None = None,
    *,
    speeds: tuple[float, float] | None = None,
    ratios: tuple[float, float] | None = None,
    shape: tuple[int, int] = SHAPE,
    displaced: float | None = None,
    longest: float | None = None,
    curves: bool = True,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Result:
    """The map over `shape` speeds and damping ratios (y and z alike), by default around the onset, 0.01 to 0.8 %.

    displaced: m, by default one diameter. longest: s, after which what is still open is decided. Ctrl-C (or progress
    raising KeyboardInterrupt) gives what is done, spread over the whole map. Raises InputError.
    """
    model = model or paper.model()
    model = model.with_parameters({RATIO: model.section.damping_ratio})
    if model.section.damping_ratio_y is not None or model.section.damping_ratio_z is not None:
        raise InputError(
            "the map varies one damping ratio for y and z, but this section has damping_ratio_y or damping_ratio_z "
            "of its own; give damping_ratio alone"
        )
    speeds = speeds or speed_window(model)
    ratios = ratios or RATIOS
    for name, (low, high) in (("speeds", speeds), ("ratios", ratios)):
        if not 0.0 <= low < high:
            raise InputError(
                f"{name} = ({low!r}, {high!r}): give two numbers, zero or above, the lower one first"
            )
    if min(shape) < 2:
        raise InputError(f"shape = {shape!r}: give two numbers of 2 or more")
    displaced = model.section.diameter if displaced is None else displaced
    speed, ratio = np.linspace(*speeds, shape[0]), np.linspace(*ratios, shape[1])
    upper = upper_rivulet(model, speeds)
    starts = [upper.at(u) for u in speed]
    if any(x is None for x in starts):
        raise InputError(
            "this case has no upper rivulet D at any wind speed, so that there is nothing to start from; "
            "'rainwind diagram' shows its equilibria"
        )
    longest, window = times_of(model, longest, float(ratio[0]))
    order = np.random.default_rng(1).permutation(speed.size * ratio.size)  # a part shows the whole, coarsely
    row, column = np.divmod(order, speed.size)
    x = np.array(starts, dtype=float)[column]
    x[:, model.states.index("y")] += displaced
    found = attractors(
        model, x, longest=longest, window=window, varying={SPEED: speed[column], RATIO: ratio[row]},
        workers=workers, progress=progress,
    )  # fmt: skip
    back = np.argsort(order)
    every = [found[i] for i in back]
    grid = (ratio.size, speed.size)

    def column_of(name: str) -> np.ndarray:
        values = [np.nan if one is None else getattr(one, name) for one in every]
        return np.array([np.nan if v is None else v for v in values], dtype=float).reshape(grid)

    known = None
    if curves:
        known = stability_diagram(model, speeds, (0.0, ratios[1]), shape=None, grow=False)
    return Result(
        model, speed, ratio, numbers_of(every).reshape(grid),
        {name: amplitudes_of(every, name).reshape(grid) for name in ("y", "z") if name in model.states},
        column_of("period"), column_of("rate"), column_of("efolds"), displaced, longest, known,
    )  # fmt: skip


def draw(result: Result, figure: Figure) -> Figure:
    """What happens (a), and how large it is (b), over wind speed and damping in per cent."""
    with style.journal(figure, width="double", height=92):
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        percent = PERCENT * result.ratio
        draw_cells(left, result.speed, percent, result.kind)
        largest = np.fmax.reduce(list(result.amplitude.values())) / result.model.section.diameter
        largest = np.where(np.isin(result.kind, (CYCLE, TORUS, CHAOS, TURNS, UNDECIDED)), largest, np.nan)
        names = " and ".join(f"${name}$" for name in result.amplitude)
        draw_amplitudes(right, result.speed, percent, largest, f"largest amplitude of {names} (diameters)")
        for axes in (left, right):
            _curves(result, axes)
            axes.set_xlabel(style.UNDISTURBED)
        left.set_ylabel(style.DAMPING)
        style.panel(left, "a", f"rivulet at D, cable displaced by {result.displaced:g} m: what follows")
        style.panel(right, "b", "how large the vibration is (half peak to peak)")
        there = {k: name for k, name in enumerate(NAMES) if np.any(result.kind == k)}
        shown = handles(there)
        if result.diagram is not None:
            shown += left.plot([], [], color=style.BLACK, linewidth=1.2, label="Hopf curve of D")
            shown += left.plot([], [], color=style.BLACK, linestyle=style.DASH_DOTTED, label="fold: D begins")
        figure.legend(handles=shown, loc="outside lower center", ncols=5)
        if result.partial:
            done = int(np.sum(result.kind != MISSING))
            figure.suptitle(
                f"stopped: {done} of {result.kind.size} cells are computed, dots mark the others",
                fontsize=8.0,
            )
    return figure


def _curves(result: Result, axes: object) -> None:
    known = result.diagram
    if known is None:
        return
    top = PERCENT * float(result.ratio[-1])
    limits = axes.get_xlim(), axes.get_ylim()  # type: ignore[attr-defined]
    if known.onset is not None:
        draw_fold(axes, known.onset, 0.0, top)  # type: ignore[arg-type]
    for piece in known.pieces:
        if piece.letter == "D" and piece.others == 0:
            draw_hopf(axes, piece.speed, PERCENT * piece.ratio, on_d=True)  # type: ignore[arg-type]
    axes.set(xlim=limits[0], ylim=limits[1])  # type: ignore[attr-defined]


def summary(result: Result) -> list[str]:
    """How many cells end on what, and where the rare things are."""
    done = int(np.sum(result.kind != MISSING))
    said = []
    if result.partial:
        said.append(f"Stopped by the user: {done} of {result.kind.size} cells are computed.")
    for k, name in enumerate(NAMES):
        rows, columns = np.nonzero(result.kind == k)
        if not rows.size:
            continue
        u, xi = result.speed[columns], PERCENT * result.ratio[rows]
        said.append(
            f"{name}: {rows.size} of {done} cells, between {u.min():.1f} and {u.max():.1f} m/s and between "
            f"{xi.min():.3g} and {xi.max():.3g} % damping."
        )
    largest = np.nanmax([np.nanmax(a, initial=0.0) for a in result.amplitude.values()])
    many = largest / result.model.section.diameter
    return [*said, f"Largest half peak to peak: {largest:.2f} m, {many:.1f} diameters."]


def tables(result: Result) -> dict[str, Table]:
    """One row for each cell, SI."""
    ratio, speed = (grid.ravel() for grid in np.meshgrid(result.ratio, result.speed, indexing="ij"))
    words = np.array([*NAMES, "not computed"], dtype=object)  # -1 is the last one
    columns = {
        SPEED: Column(speed, "m/s"), RATIO: Column(ratio),
        "kind": Column(words[result.kind.ravel()]),
        **{f"{n} half peak to peak": Column(a.ravel(), "m") for n, a in result.amplitude.items()},
        "period": Column(result.period.ravel(), "s"),
        "growth across the flow": Column(result.rate.ravel(), "1/s"),
        "log of the growth": Column(result.efolds.ravel()),
    }  # fmt: skip
    return {"cells": Table(columns, {"displaced_m": result.displaced, "followed_s": result.longest})}


def save(result: Result, path: Path) -> None:
    """Draw it into an image file. OSError where it cannot be written."""
    style.save(draw(result, Figure()), path)


def save_data(result: Result, image: Path) -> list[Path]:
    """Write the cells beside the image, as .csv and .nc; the files' names. InputError."""
    from rainwind import __version__

    found = tables(result)
    csv_file, nc_file = image.with_name(f"{image.stem}_cells.csv"), image.with_suffix(".nc")
    save_csv(csv_file, found["cells"])
    save_netcdf(nc_file, found, source="attractor_map", version=__version__)
    return [csv_file, nc_file]
