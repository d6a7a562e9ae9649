"""How every printed figure looks: sizes, type, lines, colours; and how it is saved, the same bytes each time."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

WIDTHS = {"single": 90.0, "double": 180.0}  # mm, one and two columns of a journal
# after Okabe and Ito: told apart by the colour-blind, and of different lightness in grey
BLUE, VERMILION, GREEN, ORANGE, BLACK, GREY = "#0072B2", "#C04A00", "#00805C", "#E69F00", "#000000", "#767676"
CYCLE = (BLACK, BLUE, VERMILION, GREEN, ORANGE)
DASHED, DOTTED, DASH_DOTTED = (0, (4.0, 1.8)), (0, (1.0, 1.4)), (0, (6.0, 1.6, 1.0, 1.6))
LINES = ("-", DASHED, (0, (5.0, 1.3, 1.0, 1.3, 1.0, 1.3)), DOTTED, (0, (2.2, 1.2)))
ABSENT, STABLE, UNSTABLE = "#ECECEC", "#FFFFFF", "#F6C9A8"
UNDISTURBED = r"undisturbed wind speed $U$ (m/s)"
DAMPING = r"damping ratio $\xi$ (%)"

_RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "axes.titlelocation": "left",
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "mathtext.fontset": "dejavusans",
    "axes.linewidth": 0.5,
    "axes.unicode_minus": True,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.6,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.minor.width": 0.35,
    "ytick.minor.width": 0.35,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.minor.size": 1.6,
    "ytick.minor.size": 1.6,
    "hatch.linewidth": 0.35,
    "svg.hashsalt": "rainwind",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
    "figure.dpi": 100.0,
    "savefig.dpi": 200.0,
}
_NO_DATE = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}


@contextmanager
def journal(figure: Figure, *, width: str = "single", height: float = 70.0) -> Iterator[Figure]:
    """The journal's style while axes are made and filled; sets the figure's size: a column's width, height in mm."""
    with mpl.rc_context(_RC):
        figure.set_size_inches(WIDTHS[width] / 25.4, height / 25.4)
        figure.set_layout_engine("constrained", w_pad=0.03, h_pad=0.03)
        yield figure


def save(figure: Figure, path: Path | str, *, dpi: float = 200.0) -> None:
    """Write a figure as .png, .svg or .pdf; equal figures give equal files. OSError where it cannot be written."""
    path = Path(path)
    with mpl.rc_context(_RC):
        figure.savefig(path, dpi=dpi, metadata=_NO_DATE.get(path.suffix.lower()))


def panel(axes: Axes, letter: str, text: str = "") -> None:
    """The panel's letter, and what it shows, above its left edge."""
    axes.set_title(f"({letter}) {text}".rstrip(), loc="left", pad=4.0)


def below(figure: Figure, notes: Sequence[str], *, letters: int = 66) -> None:
    """Notes under a figure, in lines of so many letters (66 fill a column); nothing without notes."""
    if notes:
        figure.supxlabel(fill("; ".join(notes), letters), fontsize=7.0, x=0.01, ha="left")


def note(axes: Axes, text: str, *, x: float = 0.5, y: float = 0.5, **kwargs: object) -> None:
    """Small grey text in fractions of the axes, such as what a model does not have."""
    settings: dict[str, object] = {
        "fontsize": 7.0,
        "color": "#505050",
        "ha": "center",
        "va": "center",
        **kwargs,
    }
    axes.text(x, y, text, transform=axes.transAxes, **settings)  # type: ignore[arg-type]
