"""The full diagram of any cable: every equilibrium, every vibration, over wind speed or another parameter."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.diagram import Progress, diagram
from rainwind.dynamics.diagram_results import Diagram, StableRange
from rainwind.dynamics.orbit_results import OrbitBranch
from rainwind.dynamics.results import Branch
from rainwind.io.results import Column, Table, save_csv
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.diagram import Panel, decimals, draw_panels
from rainwind.studies.diagram_window import SPEED, checked_window, kind_of, si, unit_of

_UNITS = {"y": "m", "phi": "rad", "z": "m", "y_dot": "m/s", "phi_dot": "rad/s", "z_dot": "m/s"}
_PANELS = {
    "y": Panel("y", r"amplitude of $y$ (m)", amplitude=True),
    "z": Panel("z", r"amplitude of $z$ (m)", amplitude=True),
    "phi": Panel("phi", r"rivulet angle $\phi$ (°)", float(np.degrees(1.0))),
}


def compute(
    model: RivuletModel,
    along: str = SPEED,
    until: tuple[float, float] | None = None,
    *,
    mesh: Mesh | None = None,
    progress: Progress | None = None,
) -> Diagram:
    """The diagram; by default over the wind speeds from half the onset speed to 2.5 times it."""
    window = checked_window(model, along, until)
    return diagram(model, along, until=window, mesh=mesh, progress=progress)


def draw(result: Diagram, figure: Figure) -> Figure:
    """Amplitudes of y and z (half peak-to-peak), and the rivulet's angle with its extremes while the cable vibrates."""
    kind = kind_of(result.along)
    label = style.UNDISTURBED
    if result.along != SPEED:
        label = f"{result.along.replace('.', ': ').replace('_', ' ')} ({unit_of(kind)})".replace(" ()", "")
    panels = [panel for state, panel in _PANELS.items() if state in result.system.states]
    return draw_panels(result, figure, panels, label=label, scale=1.0 / si(1.0, kind), noun="vibration")


def summary(result: Diagram) -> list[str]:
    """What is stable over which range, in sentences; then what the reader must know."""
    # of what was not looked at nothing can be said
    sentences = [] if result.interrupted else [_sentence(result, piece) for piece in result.stable_ranges()]
    soft = [point for point in result.points("ns") if (getattr(point, "coefficient", None) or 0.0) < 0.0]
    kind = kind_of(result.along)
    for point in soft:
        at = f"{point.parameter / si(1.0, kind):.4g} {unit_of(kind)}".strip()
        sentences.append(f"beside {at} a modulated vibration (torus) is likely: it is not computed here")
    return [*sentences, *result.audit()]


def _sentence(result: Diagram, piece: StableRange) -> str:
    kind = kind_of(result.along)
    low, high = (end / si(1.0, kind) for end in (piece.low, piece.high))
    states = [_rest(result, k, piece) for k in piece.equilibria]
    states += [words for k in piece.orbits for words in _vibrations(result, k, piece)]
    digits = decimals((result.until[1] - result.until[0]) / si(1.0, kind))
    ends = f"{low:.{digits}f}-{high:.{digits}f} {unit_of(kind)}".strip()
    return f"{ends}: {'; '.join(states) or 'nothing stable found'}"


def _rest(result: Diagram, number: int, piece: StableRange) -> str:
    branch = result.equilibria[number]
    angles = [np.degrees(columns[0]) for columns in _stable_parts(result, branch, piece, ("phi",))]
    return f"rest, rivulet at {' and '.join(_range(part, '.0f') for part in angles)}°"


def _vibrations(result: Diagram, number: int, piece: StableRange) -> Iterator[str]:
    branch = result.orbits[number]
    names = tuple(name for name in ("y", "z") if name in branch.states)
    for *sizes, period in _stable_parts(result, branch, piece, (*names, "period")):
        swing = ", ".join(f"{name} ±{_range(size, '.3f')} m" for name, size in zip(names, sizes, strict=True))
        yield f"vibration, {swing}, period {_range(period, '.3f')} s"


def _stable_parts(
    result: Diagram, branch: Branch | OrbitBranch, piece: StableRange, names: tuple[str, ...]
) -> Iterator[list[np.ndarray]]:
    """Columns of each stable part of a branch, cut at the range's ends; several parts may lie above each other."""
    for unstable, (x, *columns) in result.pieces(branch, result.along, *names):
        low, high = max(piece.low, float(x.min())), min(piece.high, float(x.max()))
        if unstable or not low < high:
            continue
        order = np.argsort(x)
        inside = x[order][(x[order] > low) & (x[order] < high)]
        at = np.concatenate([[low], inside, [high]])
        yield [np.interp(at, x[order], column[order]) for column in columns]


def _range(values: np.ndarray, pattern: str) -> str:
    low, high = format(float(values.min()), pattern), format(float(values.max()), pattern)
    return low if low == high else f"{low} to {high}"


def tables(result: Diagram) -> dict[str, Table]:
    """A table for each branch and one of the special points, SI and radians."""
    return {
        name: Table({label: Column(values, _unit(label, result.along)) for label, values in columns.items()})
        for name, columns in result.tables().items()
    }


def save(result: Diagram, path: Path) -> None:
    """Draw it into an image file. OSError where it cannot be written."""
    style.save(draw(result, Figure()), path)


def save_tables(result: Diagram, image: Path) -> list[Path]:
    """Write every table beside the image, as `diagram_equilibria_0.csv`; the files' names. InputError."""
    paths = []
    for name, table in tables(result).items():
        paths.append(image.with_name(f"{image.stem}_{name}.csv"))
        save_csv(paths[-1], table)
    return paths


def _unit(label: str, along: str) -> str:
    if label == along:
        kind = kind_of(along)
        return kind.si[0] if kind else ""
    known = {"growth": "1/s", "period": "s"}
    return known.get(label) or _UNITS.get(label.rpartition(" ")[2], "")
