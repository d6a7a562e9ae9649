"""Which initial state leads to which end at one wind speed: basins in a plane of two states (section 4.2).

The paper: rain drops that lie between the unstable equilibria B and C are pushed to D and form the upper rivulet;
the others run down to A. Each cell is one trajectory from a state in the plane, all other states those of D (zero where
there is no D), followed until it is clear where it ends.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from rainwind.dynamics.attractors import Attractor, Progress, attractors
from rainwind.errors import InputError
from rainwind.io.results import Column, Table, save_csv, save_netcdf
from rainwind.parameters import unknown_name
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.maps import FACES, HATCHES, draw_cells
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import equilibria_by_letter
from rainwind.studies.long_time import (
    CYCLE,
    MISSING,
    NAMES,
    Group,
    amplitudes_of,
    groups_of,
    numbers_of,
    times_of,
)

PLANES = {"cable": ("y", "phi"), "rivulet": ("phi", "phi_dot")}
SHAPE = (80, 80)
# in diameters, radians and radians a second
_WINDOWS = {"phi": (-np.pi / 3.0, np.pi), "phi_dot": (-60.0, 60.0)}
_ACROSS = 4.0
_LABELS = {
    "y": r"initial cable displacement $y$ (m)", "z": r"initial cable displacement $z$ (m)",
    "phi": r"initial rivulet angle $\phi$ (°)", "phi_dot": r"initial rivulet speed $\dot\phi$ (rad/s)",
    "y_dot": r"initial cable speed $\dot y$ (m/s)", "z_dot": r"initial cable speed $\dot z$ (m/s)",
}  # fmt: skip
_UNITS = {"y": "m", "z": "m", "phi": "rad", "y_dot": "m/s", "z_dot": "m/s", "phi_dot": "rad/s"}
# of several stable vibrations, the most frequent first
_CYCLES = ((FACES[CYCLE], None), (style.ORANGE, None), ("#8C6BB1", "////"), ("#66C2A4", "...."))
_TURN = {"phi": float(np.degrees(1.0))}


@dataclass(frozen=True, eq=False)
class Share:
    """The share of the window that leads to one end, with its standard error."""

    group: Group
    share: float
    error: float


@dataclass(frozen=True, eq=False)
class Result:
    """plane: two states' names; first (m,), second (k,): their values, SI; found (k * m): what each cell ends on.

    kind (k, m): a number in long_time.NAMES, -1 not computed. equilibria: by letter, at this wind speed.
    """

    model: RivuletModel
    plane: tuple[str, str]
    first: np.ndarray
    second: np.ndarray
    found: tuple[Attractor | None, ...]
    kind: np.ndarray
    base: np.ndarray
    equilibria: dict[str, np.ndarray]
    longest: float

    @property
    def partial(self) -> bool:
        """Whether the user stopped it."""
        return bool(np.any(self.kind == MISSING))

    @property
    def empty(self) -> bool:
        """Whether nothing was computed."""
        return bool(np.all(self.kind == MISSING))

    @property
    def groups(self) -> tuple[Group, ...]:
        """What ends on the same; cycles of different size apart."""
        return groups_of(self.found)

    @property
    def shares(self) -> tuple[Share, ...]:
        """Of the cells computed; the error is that of as many places taken by chance, an upper bound for a grid."""
        done = int(np.sum(self.kind != MISSING))
        shares = [(group, len(group.members) / done) for group in self.groups]
        # a share of 0 or 1 in N cells may be one in N wrong
        return tuple(Share(g, s, float(np.sqrt(max(s * (1.0 - s), 1.0 / done) / done))) for g, s in shares)


def compute(
    model: RivuletModel | None = None,
    plane: tuple[str, str] = PLANES["cable"],
    *,
    first: tuple[float, float] | None = None,
    second: tuple[float, float] | None = None,
    shape: tuple[int, int] = SHAPE,
    longest: float | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Result:
    """The basins at the model's own wind speed, over `shape` cells of two states within windows (SI).

    Ctrl-C (or progress raising KeyboardInterrupt) gives what is done, spread over the whole plane. Raises InputError.
    """
    model = model or paper.model()
    for name in plane:
        if name not in model.states:
            raise unknown_name(name, model.states, "state")
    if plane[0] == plane[1]:
        raise InputError(f"the plane needs two states; got '{plane[0]}' twice")
    if min(shape) < 2:
        raise InputError(f"shape = {shape!r}: give two numbers of 2 or more")
    axes = []
    for name, window, many in zip(plane, (first, second), shape, strict=True):
        low, high = window or _window(model, name)
        if not (np.isfinite(low) and np.isfinite(high) and low < high):
            raise InputError(
                f"the window of {name}, ({low!r}, {high!r}), needs two numbers, the lower one first"
            )
        step = (high - low) / many
        axes.append(low + step * (np.arange(many) + 0.5))  # the middles of the cells
    at_rest = {letter: one.state for letter, one in equilibria_by_letter(model).items()}
    base = at_rest.get("D", np.zeros(len(model.states)))
    i, j = (model.states.index(name) for name in plane)
    grid = np.meshgrid(*axes)
    x = np.tile(base, (grid[0].size, 1))
    x[:, i], x[:, j] = grid[0].ravel(), grid[1].ravel()
    section = model.section
    ratios = (section.damping_ratio, section.damping_ratio_y, section.damping_ratio_z)
    longest, window = times_of(model, longest, min(r for r in ratios if r is not None))
    order = np.random.default_rng(1).permutation(len(x))  # a part tells of the whole
    found = attractors(model, x[order], longest=longest, window=window, workers=workers, progress=progress)
    every = tuple(found[k] for k in np.argsort(order))
    kind = numbers_of(every).reshape(grid[0].shape)
    return Result(model, (plane[0], plane[1]), axes[0], axes[1], every, kind, base, at_rest, longest)


def _window(model: RivuletModel, name: str) -> tuple[float, float]:
    if name in _WINDOWS:
        return _WINDOWS[name]
    reach = _ACROSS * model.section.diameter
    if name.endswith("_dot"):
        reach *= 2.0 * np.pi * (model.section.frequency_z if name[0] == "z" else model.section.frequency_y)
    return -reach, reach


def draw(result: Result, figure: Figure) -> Figure:
    """The plane with the equilibria A to D by letter, and a legend with the share that each end has."""
    with style.journal(figure, width="double", height=96):
        axes = figure.add_subplot()
        groups, numbers = result.shares, np.full(result.kind.size, MISSING)
        faces, hatches, cycles = [], [], 0
        for k, share in enumerate(groups):
            numbers[list(share.group.members)] = k
            face, hatch = FACES[share.group.number], HATCHES[share.group.number]
            if share.group.number == CYCLE:
                face, hatch = _CYCLES[min(cycles, len(_CYCLES) - 1)]
                cycles += 1
            faces.append(face)
            hatches.append(hatch)
        x, y = (_TURN.get(name, 1.0) * values for name, values in _axes(result))
        draw_cells(axes, x, y, numbers.reshape(result.kind.shape), faces=faces, hatches=hatches)
        _mark(result, axes)
        axes.set(xlabel=_LABELS[result.plane[0]], ylabel=_LABELS[result.plane[1]])
        shown = [
            Patch(
                facecolor=face, edgecolor="#606060", linewidth=0.4, hatch=hatch,
                label=f"{one.group.words}\n{100 * one.share:.1f} ± {100 * one.error:.1f} % of the cells",
            )
            for one, face, hatch in zip(groups, faces, hatches, strict=True)
        ]  # fmt: skip
        figure.legend(
            handles=shown, loc="outside right upper", title="what a start ends on", alignment="left"
        )
        axes.set_title(_title(result), loc="left")
    return figure


def _axes(result: Result) -> list[tuple[str, np.ndarray]]:
    return [(result.plane[0], result.first), (result.plane[1], result.second)]


def _title(result: Result) -> str:
    said = (
        f"$U$ = {result.model.wind.speed:g} m/s, damping ratio {100 * result.model.section.damping_ratio:g} %"
    )
    if result.partial:
        done = int(np.sum(result.kind != MISSING))
        said += f"; stopped: {done} of {result.kind.size} cells are computed, dots mark the others"
    return said


def _mark(result: Result, axes: Axes) -> None:
    """The equilibria: where a line or a point of the plane is one, with its letter."""
    i, j = (result.model.states.index(name) for name in result.plane)
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    for letter, state in result.equilibria.items():
        for turn in (-2.0 * np.pi, 0.0, 2.0 * np.pi):
            px, py = (
                _TURN.get(n, 1.0) * (float(state[k]) + (turn if n == "phi" else 0.0))
                for n, k in zip(result.plane, (i, j), strict=True)
            )
            if not (x0 <= px <= x1 and y0 <= py <= y1):
                continue
            axes.plot(px, py, "o", color=style.BLACK, markersize=3.2, markerfacecolor="white", zorder=3)
            axes.annotate(
                letter, (px, py), xytext=(4, 3), textcoords="offset points", fontsize=8.0, zorder=3,
                bbox={"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
            )  # fmt: skip


def summary(result: Result) -> list[str]:
    """The shares, and over which angles a rivulet at rest ends where."""
    said = []
    if result.partial:
        done = int(np.sum(result.kind != MISSING))
        said.append(f"Stopped by the user: {done} of {result.kind.size} cells are computed.")
    for one in result.shares:
        said.append(
            f"{one.group.words}: {100 * one.share:.1f} % of the cells (standard error at most {100 * one.error:.1f} %)."
        )
    places = [
        f"{k} at {np.degrees(x[result.model.states.index('phi')]):.1f}°" for k, x in result.equilibria.items()
    ]
    if len(result.shares) == 1 and not result.partial:
        said.append(
            "Every start ends the same way at this wind speed; another one may have more to choose from."
        )
    return [
        *said,
        f"Equilibria at {result.model.wind.speed:g} m/s: {', '.join(places) or 'none with a letter'}.",
    ]


def tables(result: Result) -> dict[str, Table]:
    """One row for each cell, SI and radians."""
    first, second = np.meshgrid(result.first, result.second)
    words = np.array([*NAMES, "not computed"], dtype=object)
    number = np.full(result.kind.size, MISSING)
    for k, group in enumerate(result.groups):
        number[list(group.members)] = k
    columns = {
        result.plane[0]: Column(first.ravel(), _UNITS[result.plane[0]]),
        result.plane[1]: Column(second.ravel(), _UNITS[result.plane[1]]),
        "kind": Column(words[result.kind.ravel()]), "group": Column(number),
        **{
            f"{name} half peak to peak": Column(amplitudes_of(result.found, name), "m")
            for name in ("y", "z") if name in result.model.states
        },
    }  # fmt: skip
    shares = result.shares
    summed = {
        "group": Column(np.arange(len(shares))),
        "kind": Column(np.array([NAMES[one.group.number] for one in shares], dtype=object)),
        "share": Column(np.array([one.share for one in shares])),
        "standard error": Column(np.array([one.error for one in shares])),
    }
    facts = {"wind_speed_m_s": result.model.wind.speed, "followed_s": result.longest}
    return {"cells": Table(columns, facts), "shares": Table(summed, facts)}


def save(result: Result, path: Path) -> None:
    """Draw it into an image file. OSError where it cannot be written."""
    style.save(draw(result, Figure()), path)


def save_data(result: Result, image: Path) -> list[Path]:
    """Write both tables beside the image, as .csv, and all in one .nc; the files' names. InputError."""
    from rainwind import __version__

    paths = []
    for name, table in tables(result).items():
        paths.append(image.with_name(f"{image.stem}_{name}.csv"))
        save_csv(paths[-1], table)
    paths.append(image.with_suffix(".nc"))
    save_netcdf(paths[-1], tables(result), source="basins", version=__version__)
    return paths
