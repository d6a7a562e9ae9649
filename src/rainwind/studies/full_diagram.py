"""The full diagram of any cable: every equilibrium, every vibration, over wind speed or another parameter."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rainwind.dynamics.collocation import Mesh
from rainwind.dynamics.diagram import Progress, diagram
from rainwind.dynamics.diagram_results import Diagram, StableRange
from rainwind.dynamics.orbit_results import OrbitBranch
from rainwind.dynamics.results import Branch
from rainwind.io.results import Column, Table, save_csv
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.plotting.diagram import Panel, decimals, draw_panels, vibrating
from rainwind.studies.diagram_window import (
    SPEED,
    checked_window,
    held,
    in_words,
    kind_of,
    name_of,
    si,
    unit_of,
)
from rainwind.studies.equilibrium_names import LETTERS, letters_of, with_letter
from rainwind.studies.stability_diagram import stability_diagram

_UNITS = {"y": "m", "phi": "rad", "z": "m", "y_dot": "m/s", "phi_dot": "rad/s", "z_dot": "m/s"}
_PANELS = {
    "y": Panel("y", r"amplitude of $y$ (m)", amplitude=True),
    "z": Panel("z", r"amplitude of $z$ (m)", amplitude=True),
    "phi": Panel("phi", r"rivulet angle $\phi$ (°)", float(np.degrees(1.0))),
}


@dataclass(frozen=True, eq=False)
class Result:
    """The diagram, the model as given, and for each branch of equilibria the letter of each of its points."""

    diagram: Diagram
    model: RivuletModel
    letters: tuple[tuple[str, ...], ...]

    @property
    def empty(self) -> bool:
        """Whether nothing was found before the user stopped the work."""
        return not (self.diagram.equilibria or self.diagram.orbits)


def compute(
    model: RivuletModel,
    along: str = SPEED,
    until: tuple[float, float] | None = None,
    *,
    mesh: Mesh | None = None,
    progress: Progress | None = None,
) -> Result:
    """The diagram; by default over the wind speeds from half the onset speed to 2.5 times it."""
    window = checked_window(model, along, until)
    found = diagram(model, along, until=window, mesh=mesh, progress=progress)
    return Result(found, model, letters_of(model, along, window, found.equilibria))


def draw(result: Result, figure: Figure) -> Figure:
    """Amplitudes of y and z (half peak-to-peak), and the rivulet's angle with its extremes while the cable vibrates.

    Below stands what is held. A diagram that the user stopped says so.
    """
    known = result.diagram
    kind = kind_of(known.along)
    label = style.UNDISTURBED
    if known.along != SPEED:
        label = f"{name_of(known.along)} ({unit_of(kind)})".replace(" ()", "")
    panels = [panel for state, panel in _PANELS.items() if state in known.system.states]
    scale = 1.0 / si(1.0, kind)
    draw_panels(known, figure, panels, label=label, scale=scale, noun="vibration", note=_held(result))
    _letters(result, figure.axes[len(panels) - 1], scale)
    return figure


def _letters(result: Result, axes: Axes, scale: float) -> None:
    """The letter of each equilibrium beside its curve, at the curve's end that is farthest to the right."""
    turn = _PANELS["phi"].scale
    for branch, letters in zip(result.diagram.equilibria, result.letters, strict=True):
        for letter in sorted({*letters} - {""}):
            own = [k for k, one in enumerate(letters) if one == letter]
            last = max(own, key=lambda k: branch.parameter[k])
            axes.annotate(
                letter, (scale * branch.parameter[last], turn * branch["phi"][last]), xytext=(-6, 2),
                textcoords="offset points", ha="right", va="bottom", fontsize=7.5,
            )  # fmt: skip


def summary(result: Result) -> list[str]:
    """What is stable over which range, where the cable vibrates, which damping stops it; what the reader must know."""
    known = result.diagram
    if known.interrupted:  # of what was not looked at nothing can be said
        return [_held(result), *known.audit()]
    low, high = (in_words(end, known.along) for end in known.until)
    sentences = [f"Varied: {name_of(known.along)}, {low} to {high}. {_held(result)}"]
    sentences += [_sentence(result, piece) for piece in known.stable_ranges()]
    sentences += _vibrates(result)
    soft = [point for point in known.points("ns") if (getattr(point, "coefficient", None) or 0.0) < 0.0]
    for point in soft:
        at = in_words(float(f"{point.parameter:.4g}"), known.along)
        sentences.append(f"Beside {at} a modulated vibration (torus) is likely: it is not computed here.")
    return [*sentences, LETTERS, *known.audit()]


def _held(result: Result) -> str:
    """What leads besides the parameter that varies, and is held."""
    return f"Held: {', '.join(held(result.model, result.diagram.along))}."


def _vibrates(result: Result) -> list[str]:
    """Where a vibration is stable; along the wind speed, what is known of the damping that stops it."""
    known = result.diagram
    ranges = [" to ".join(_ends(known, low, high)) for low, high in vibrating(known)]
    unit = unit_of(kind_of(known.along))
    where = f"from {' and from '.join(ranges)} {unit}".strip()
    said = [
        f"A stable vibration exists {where}." if ranges else "No stable vibration was found in this range."
    ]
    if known.along != SPEED:
        return said
    linear = stability_diagram(result.model, known.until, shape=None)
    if linear.critical is not None:
        speed, ratio = linear.critical
        alike = "" if linear.own_ratio is not None else ", the same in y and z,"
        said.append(
            f"With a damping ratio above {100 * ratio:.3f} %{alike} small disturbances of D die out at every wind "
            f"speed of this range (most is needed at {speed:.2f} m/s)."
        )
    return [*said, "Which damping stops every vibration, 'rainwind figure 9' computes for the same case."]


def _ends(known: Diagram, low: float, high: float) -> tuple[str, str]:
    unit = si(1.0, kind_of(known.along))
    digits = decimals((known.until[1] - known.until[0]) / unit)
    return f"{low / unit:.{digits}f}", f"{high / unit:.{digits}f}"


def _sentence(result: Result, piece: StableRange) -> str:
    known = result.diagram
    states = [words for k in piece.equilibria for words in _at_rest(result, k, piece)]
    states += [words for k in piece.orbits for words in _vibrations(known, k, piece)]
    ends = f"{'-'.join(_ends(known, piece.low, piece.high))} {unit_of(kind_of(known.along))}".strip()
    return f"{ends}: {'; '.join(states) or 'nothing stable found'}"


def _at_rest(result: Result, number: int, piece: StableRange) -> Iterator[str]:
    known = result.diagram
    branch, letters = known.equilibria[number], result.letters[number]
    for x, phi in _stable_parts(known, branch, piece, (known.along, "phi")):
        middle = (0.5 * (x[0] + x[-1]), np.interp(0.5 * (x[0] + x[-1]), x, phi))
        away = np.abs(branch.parameter - middle[0]) / np.ptp(known.until) + np.abs(branch["phi"] - middle[1])
        name = with_letter(letters[int(away.argmin())])
        yield f"{name}, rivulet at {_range(np.degrees(phi), '.0f')}°"


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


def tables(result: Result) -> dict[str, Table]:
    """A table for each branch, with the letters of equilibria, and one of the special points, SI and radians."""
    known = result.diagram
    every = known.tables()
    for k, letters in enumerate(result.letters):
        every[f"equilibria_{k}"]["letter"] = np.array(letters, dtype=object)
    return {
        name: Table({label: Column(values, _unit(label, known.along)) for label, values in columns.items()})
        for name, columns in every.items()
    }


def save(result: Result, path: Path) -> None:
    """Draw it into an image file. OSError where it cannot be written."""
    style.save(draw(result, Figure()), path)


def save_tables(result: Result, image: Path) -> list[Path]:
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
