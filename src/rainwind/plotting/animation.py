"""An animation of the cable's section: its orbit, the rivulet on it, the wind. As mp4, gif, or one HTML page.

Everything is drawn to one scale. y points down and z leeward as in the equations of motion; the wind comes from the
left.
The rivulet's centre is at (y - r cos phi, z - r sin phi), so that phi counts from the top towards windward.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, HTMLWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch

from rainwind.errors import InputError
from rainwind.plotting import style

FORMATS = (".mp4", ".gif", ".html")
_RATE = {".mp4": 30, ".gif": 20, ".html": 20}  # frames a second
_DPI = {".mp4": 160, ".gif": 90, ".html": 90}
_MOST = 1500  # frames
_WATER, _CABLE = "#2E86C1", "#D9D9D9"
_TRAIL = 1.0  # s of the past that the orbit's line shows strongest
_SIZE = (5.0, 4.2)  # inches


@dataclass(frozen=True, eq=False)
class Scene:
    """What is shown: times (m,) in s, rising by equal steps; y, z (m,) in m; phi (m,) in rad; wind (m,) in m/s.

    diameter: of the cable; radius: from its centre to the rivulet's, m. pace: how many times faster than in life.
    title: above the picture.
    """

    times: np.ndarray
    y: np.ndarray
    z: np.ndarray
    phi: np.ndarray
    wind: np.ndarray
    diameter: float
    radius: float
    pace: float = 1.0
    title: str = ""


def frames(suffix: str, duration: float, pace: float = 1.0) -> int:
    """How many frames a second of film and `duration` seconds of a run make. Raises InputError where too many."""
    if suffix not in FORMATS:
        raise InputError(
            f"'{suffix}' is no format of an animation; end the file's name with {', '.join(FORMATS)}"
        )
    count = max(2, round(duration / pace * _RATE[suffix]))
    if count > _MOST:
        longest = _MOST / _RATE[suffix] * pace
        raise InputError(
            f"{duration:g} s make {count} pictures, allowed are {_MOST}; show {longest:g} s or less"
        )
    return count


def checked_format(path: Path) -> str:
    """The format by the file's name, if it can be written here. Raises InputError for another one or without ffmpeg."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise InputError(
            f"'{suffix}' is no format of an animation; end the file's name with {', '.join(FORMATS)}"
        )
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise InputError(
            "an mp4 needs the program ffmpeg, which is not found; install it, or write a .gif or .html"
        )
    return suffix


def animate(scene: Scene, path: Path, *, progress: Callable[[int, int], None] | None = None) -> None:
    """Write the animation; it repeats for ever where the format can (gif, HTML).

    An mp4 needs ffmpeg. The HTML page holds its pictures and needs no network. progress(done, total): at each frame.
    Raises InputError for another format or without ffmpeg, OSError where the file cannot be written.
    """
    suffix = checked_format(path)
    figure = Figure()
    with style.journal(figure), mpl.rc_context({"animation.embed_limit": 200.0}):
        figure.set_layout_engine("none")
        figure.set_size_inches(_SIZE)
        drawn = _Drawing(scene, figure)
        total = scene.times.size

        def at(k: int) -> list:
            if progress is not None:
                progress(k, total)
            return drawn.show(k)

        film = FuncAnimation(figure, at, frames=total, init_func=list, blit=False, cache_frame_data=False)
        rate = _RATE[suffix]
        if suffix == ".html":
            writer = HTMLWriter(fps=rate, embed_frames=True, default_mode="loop")
        else:
            writer = PillowWriter(fps=rate) if suffix == ".gif" else FFMpegWriter(
                fps=rate, codec="libx264", extra_args=["-pix_fmt", "yuv420p", "-crf", "20"]
            )  # fmt: skip
        film.save(path, writer=writer, dpi=_DPI[suffix])


class _Drawing:
    """The parts of the picture that move."""

    def __init__(self, scene: Scene, figure: Figure) -> None:
        self.scene, d = scene, scene.diameter
        self.axes = axes = figure.add_axes((0.13, 0.12, 0.84, 0.78))
        reach = [1.1 * d, 1.1 * d]
        middle = []
        for k, values in enumerate((scene.z, scene.y)):
            middle.append(0.5 * (values.min() + values.max()))
            reach[k] += 0.5 * float(np.ptp(values))
        self._window(axes, middle, reach)
        axes.set(xlabel="$z$ (m), leeward", ylabel="$y$ (m), downward")
        axes.set_title(scene.title, loc="left")
        axes.axhline(0.0, color=style.GREY, linewidth=0.4, zorder=0)
        axes.axvline(0.0, color=style.GREY, linewidth=0.4, zorder=0)
        axes.plot(scene.z, scene.y, color=style.BLACK, linewidth=0.5, alpha=0.25, zorder=1)
        (self.trail,) = axes.plot([], [], color=style.VERMILION, linewidth=1.2, zorder=2)
        self.cable = Circle((0, 0), 0.5 * d, facecolor=_CABLE, edgecolor=style.BLACK, linewidth=0.9, zorder=3)
        self.mark = axes.plot([], [], color=style.BLACK, linewidth=0.5, linestyle=style.DASHED, zorder=4)[0]
        self.rivulet = Circle(
            (0, 0), 0.11 * d, facecolor=_WATER, edgecolor="#1B4F72", linewidth=0.7, zorder=5
        )
        axes.add_patch(self.cable)
        axes.add_patch(self.rivulet)
        self.clock = axes.text(0.98, 0.97, "", transform=axes.transAxes, ha="right", va="top", zorder=6)
        self._wind()

    def _window(self, axes: Axes, middle: list[float], reach: list[float]) -> None:
        """Limits in one scale that fill the axes, with room for the wind's arrow at the left."""
        wide, high = 0.84 * _SIZE[0], 0.78 * _SIZE[1]
        reach[0] *= 1.25
        scale = max(reach[0] / wide, reach[1] / high)
        x, y = scale * wide, scale * high
        axes.set(xlim=(middle[0] - x, middle[0] + x), ylim=(middle[1] + y, middle[1] - y))
        axes.set_aspect("equal", adjustable="box")

    def _wind(self) -> None:
        """One arrow, its length in proportion to the wind."""
        low, high = self.axes.get_xlim()
        self.left, self.long = low + 0.03 * (high - low), 0.16 * (high - low)
        top, bottom = sorted(self.axes.get_ylim())
        self.height = top + 0.1 * (bottom - top)
        self.arrow = FancyArrowPatch(
            (0, 0), (0, 0), arrowstyle="-|>", mutation_scale=11, linewidth=1.6, color=style.BLUE, zorder=6
        )
        self.axes.add_patch(self.arrow)
        self.speed = self.axes.text(
            self.left, self.height + 0.035 * (bottom - top), "", color=style.BLUE, va="top", zorder=6
        )

    def show(self, k: int) -> list:
        """Move everything to frame k."""
        s = self.scene
        z, y, phi, r = float(s.z[k]), float(s.y[k]), float(s.phi[k]), s.radius
        self.cable.center = (z, y)
        self.rivulet.center = (z - r * np.sin(phi), y - r * np.cos(phi))
        self.mark.set_data([z, z - r * np.sin(phi)], [y, y - r * np.cos(phi)])
        begin = int(np.searchsorted(s.times, s.times[k] - _TRAIL * s.pace))
        self.trail.set_data(s.z[begin : k + 1], s.y[begin : k + 1])
        share = float(s.wind[k] / s.wind.max())
        self.arrow.set_positions((self.left, self.height), (self.left + self.long * share, self.height))
        self.speed.set_text(f"{s.wind[k]:.1f} m/s")
        turns = (np.degrees(phi) + 90.0) % 360.0 - 90.0
        faster = f", {s.pace:g} times faster" if s.pace != 1.0 else ""
        self.clock.set_text(f"$t$ = {s.times[k]:.2f} s{faster}\n" + rf"$\phi$ = {turns:.0f}°")
        return [self.cable, self.rivulet, self.mark, self.trail, self.arrow, self.speed, self.clock]
