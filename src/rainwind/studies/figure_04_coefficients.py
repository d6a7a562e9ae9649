"""Figure 4 (section 3): lift, drag and moment coefficients over the angle of attack.

The paper's curves (after Yamaguchi 1990, and Gu & Lu 2001) are lost. Shown are polynomials of ours, fitted to numbers
that the text prints, NOT measurements. The moment is tied to the text by the static balance of the rivulet,
C_M(-phi) = -m_R r g cos(delta) sin(phi + beta) / (½ rho d² U_n²): at the fold, 8 m/s, both sides touch; a test pins it.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from rainwind.io.results import Column, Table
from rainwind.physics.coefficient_files import load_coefficients, shipped_sets
from rainwind.physics.coefficients import CoefficientSet
from rainwind.physics.model import RivuletModel
from rainwind.plotting import style
from rainwind.studies import paper
from rainwind.studies.equilibrium_map import equilibrium_map, speed_window

_BEYOND = np.pi / 4  # how far beyond the valid range the axis reaches, rad
_NAMES = ("lift", "drag", "moment")
_OTHERS, _VALID = "#8C8C8C", "#ECECEC"
_SYMBOLS = (r"lift $C_L$", r"drag $C_D$", r"moment $C_M$")


@dataclass(frozen=True, eq=False)
class Result:
    """Coefficients (3, m) over the angle of attack alpha (m,) in rad.

    blend and raw: of the model's own set, within its range, and outside as the bare cylinder or as it runs on.
    others: name -> (3, m), NaN outside their valid range or where a set has no moment. balance: speed in m/s ->
    the moment coefficient (m,) that holds the rivulet at phi = -alpha. contact: alpha and C_M at the fold.
    """

    own: CoefficientSet
    alpha: np.ndarray
    blend: np.ndarray
    raw: np.ndarray
    others: dict[str, np.ndarray]
    balance: dict[float, np.ndarray]
    contact: tuple[float, float] | None
    onset: float | None


def compute(model: RivuletModel | None = None) -> Result:
    """Evaluate the model's set, our other sets, and the static balance at and above the fold."""
    model = model or paper.model()
    own = model.coefficients
    alpha = np.linspace(own.valid[0] - _BEYOND, own.valid[1] + _BEYOND, 1081)
    with np.errstate(all="ignore"):
        raw = np.array([np.broadcast_to(c, alpha.shape) for c in own.at(alpha, "extend")])
    blend = np.array([np.broadcast_to(c, alpha.shape) for c in own.at(alpha, "blend")])
    others = {}
    for name in shipped_sets():
        other = load_coefficients(name)
        if other != own:
            others[name] = _within(other, alpha)
    known = equilibrium_map(model, speed_window(model))
    balance, contact = {}, None
    if known.onset is not None:
        balance = {speed: _needed(model, speed, -alpha) for speed in (known.onset, 1.25 * known.onset)}
        fold = known.fold
        if fold is not None:
            at = -fold["phi"]
            contact = at, float(own.moment_at(at, model.outside))
    return Result(own, alpha, blend, raw, others, balance, contact, known.onset)


def _within(other: CoefficientSet, alpha: np.ndarray) -> np.ndarray:
    inside = (alpha >= other.valid[0]) & (alpha <= other.valid[1])
    curves = (other.lift, other.drag, other.moment)
    values = [
        np.full(alpha.shape, np.nan) if c is None else np.broadcast_to(c(alpha), alpha.shape) for c in curves
    ]
    return np.where(inside, np.array(values), np.nan)


def _needed(model: RivuletModel, speed: float, phi: np.ndarray) -> np.ndarray:
    at = model.letters({**model.parameters, "wind.speed": speed})
    weight = at.m_r * at.r * at.g_cos_delta
    return -weight * np.sin(phi + at.beta) / (0.5 * at.rho * at.d**2 * at.u_n**2)


def draw(result: Result, figure: Figure) -> Figure:
    """Three panels; the valid range is shaded."""
    with style.journal(figure, width="double", height=84):
        panels = figure.subplots(1, 3)
        degrees = np.degrees(result.alpha)
        low, high = np.degrees(result.own.valid)
        for k, axes in enumerate(panels):
            style.panel(axes, "abc"[k], _SYMBOLS[k])
            axes.axvspan(low, high, color=_VALID, linewidth=0, zorder=0)
            for values in result.others.values():
                axes.plot(degrees, values[k], color=_OTHERS, linewidth=0.6)
            axes.plot(degrees, result.raw[k], color=style.BLUE, linestyle=style.DASHED, linewidth=0.9)
            axes.plot(degrees, result.blend[k], color=style.BLACK)
            shown = np.concatenate([result.blend[k], *(v[k] for v in result.others.values())])
            bottom, top = np.nanmin(shown), np.nanmax(shown)
            room = 0.12 * max(top - bottom, 0.1)
            axes.set_ylim(bottom - room, top + room)
            axes.set_xlim(degrees[0], degrees[-1])
            axes.set_xticks(np.arange(45 * np.ceil(degrees[0] / 45), degrees[-1] + 1, 45))
            axes.set_xlabel(r"angle of attack $\alpha$ (°)")
        panels[0].set_ylabel("coefficient")
        _balance(result, panels[2])
        handles = [
            Line2D([], [], color=style.BLACK, label="blended into the bare cylinder"),
            Line2D([], [], color=style.BLUE, linestyle=style.DASHED, linewidth=0.9, label="raw curve"),
            Line2D([], [], color=_OTHERS, linewidth=0.6, label="other shipped sets"),
            Patch(color=_VALID, label="valid range"),
            *(line for line in panels[2].lines if not str(line.get_label()).startswith("_")),
        ]
        figure.legend(handles=handles, loc="outside lower left", ncols=3, columnspacing=1.6)
        status = (
            "reconstructed from numbers in the paper's text; not Yamaguchi's data, not measured"
            if result.own.status == "reconstructed"
            else result.own.status
        )
        figure.suptitle(f"Set '{result.own.name}': {status}", fontsize=8.0, x=0.01, ha="left")
    return figure


def _balance(result: Result, axes: Axes) -> None:
    degrees = np.degrees(result.alpha)
    for (speed, needed), line in zip(result.balance.items(), ("-", style.DOTTED), strict=False):
        axes.plot(
            degrees, needed, color=style.VERMILION, linewidth=0.8, linestyle=line,
            label=rf"static balance at $U$ = {speed:.2f} m/s",
        )  # fmt: skip
    if result.contact is not None:
        angle, moment = result.contact
        axes.plot(
            [np.degrees(angle)], [moment], "s", color=style.VERMILION, markerfacecolor="white", zorder=5
        )
        axes.annotate(
            "fold", (np.degrees(angle), moment), xytext=(6, -5), textcoords="offset points", fontsize=7,
            color=style.VERMILION,
        )  # fmt: skip


def tables(result: Result) -> dict[str, Table]:
    """Own curves, other sets and the balance, over the angle of attack."""
    alpha = Column(result.alpha, "rad", "angle of attack")
    found = {}
    for name, values in (("blend", result.blend), ("raw", result.raw), *result.others.items()):
        columns = {key: Column(values[k], "", f"{key} coefficient") for k, key in enumerate(_NAMES)}
        found[name] = Table(
            {"alpha": alpha, **columns}, {"set": result.own.name if name in ("blend", "raw") else name}
        )
    for number, (speed, needed) in enumerate(result.balance.items(), 1):
        found[f"balance_{number}"] = Table(
            {"alpha": alpha, "moment": Column(needed, "", "moment coefficient in static balance")},
            {"wind_speed_m_s": speed},
        )
    return found
