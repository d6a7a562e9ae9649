"""Frequencies and damping of a stay with dampers: exact complex modes of a linear cable."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any, Protocol

import numpy as np

from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.damped_beam import DampedBeam, Ends
from rainwind.engineering.damped_string import DampedString
from rainwind.engineering.damper_places import DamperPlaces
from rainwind.engineering.root_following import follow_roots
from rainwind.errors import ComputationError, InputError
from rainwind.physics.checks import not_negative

__all__ = [
    "DampedCable",
    "DampedMode",
    "DamperWork",
    "damped_cable",
    "damped_modes",
    "damper_work",
    "force",
    "stroke",
]

SMALL = 1e-3
"""Dampers with less than this for the sum of c/sqrt(T m) leave the undamped roots where they are."""
SHAPELESS = 8.0
"""-Re(lambda) L/sqrt(T/m) above which rounding spoils the shape: exp(2 * 8) times 1e-16 is still small."""
DETOUR = 0.6
"""rad: of the complex coefficients that lead round the places where a mode stops vibrating."""


@dataclass(frozen=True)
class DampedMode:
    """One mode of a stay with dampers.

    number: 1, 2, ..., counted where the dampers begin to grow from nothing (modes beyond L/2x, x a damper's position:
    by frequency). frequency: of the free vibration,
    Im(lambda)/2 pi, Hz. damping_ratio: added by the dampers, -Re(lambda)/|lambda|. position_shares: for each damper,
    |displacement of the cable there| over the largest along the cable; nan for a mode that is all but
    gone when a wave has run along the cable once.
    """

    number: int
    frequency: float
    damping_ratio: float
    position_shares: tuple[float, ...] = ()

    @property
    def eigenvalue(self) -> complex:
        """lambda in 1/s: every point moves as exp(lambda t)."""
        omega, ratio = 2 * pi * self.frequency, self.damping_ratio
        return complex(-omega * ratio / sqrt(1 - ratio**2), omega)


@dataclass(frozen=True)
class DamperWork:
    """What a damper does while the cable vibrates steadily; every field an amplitude (half peak to peak).

    displacement: of the cable at the damper, m. stroke: across the dashpot, m, less than the displacement where the
    support gives way. force: in damper and support alike, N. power: mean loss, W.
    """

    displacement: complex
    stroke: float
    force: float
    power: float


class DampedCable(Protocol):
    """A characteristic function, its undamped roots, and the shapes that belong to its roots."""

    dampers: DamperPlaces

    def undamped(self, count: int) -> np.ndarray:
        """The roots (count,) without dampers."""
        ...

    def log_derivative(self, s: np.ndarray, t: complex) -> np.ndarray:
        """f'/f (n,) at s (n,), the dampers' coefficients times t."""
        ...

    def shapes(self, s: np.ndarray, t: complex, x: np.ndarray) -> np.ndarray:
        """Displacements (n, k) at x (k,)."""
        ...


def damped_modes(
    cable: Cable,
    count: int,
    dampers: Sequence[Damper] | None = None,
    *,
    sag: bool = False,
    bending: bool = False,
    ends: Ends = "clamped",
) -> tuple[DampedMode, ...]:
    """Modes 1 to count with any number of dampers (None: the cable's own), exact for a linear cable.

    The plain model is the taut string. sag: modes in the plane of the cable with the tension that its sag adds
    (Irvine's theory, second-hand). bending: with the cable's bending stiffness, and ends that are "clamped" or
    "pinned". Dampers at one place add. Raises InputError for a count below 1 and a damper beyond mid-span,
    ComputationError where too few modes vibrate (far from practice: strong dampers near mid-span).
    """
    count = whole_number("count", count)
    chosen = tuple(cable.dampers if dampers is None else dampers)
    model = damped_cable(cable, chosen, sag=sag, bending=bending, ends=ends)
    (roots,) = scaled_roots(model, count, np.ones(1))
    # shares by a parabola through the largest three of many points: to about 1e-7
    grid = np.linspace(0.0, 1.0, 100 + 60 * count)
    size = np.abs(model.shapes(roots, 1.0, grid))
    largest = np.array([_peak(row) for row in size])
    at = np.abs(model.shapes(roots, 1.0, model.dampers.places))
    largest = np.maximum(largest, at.max(axis=1, initial=0.0))
    shares = np.where(-roots.real > SHAPELESS, np.nan, (at / largest[:, None]).T).T[:, model.dampers.index]
    scale = cable.wave_speed / cable.length / (2 * pi)
    return tuple(
        DampedMode(n, float(root.imag) * scale, float(ratios_of(root)), tuple(map(float, share)))
        for n, root, share in zip(range(1, count + 1), roots, shares, strict=True)
    )


def damper_work(mode: DampedMode, dampers: Sequence[Damper], amplitude: float) -> tuple[DamperWork, ...]:
    """Stroke, force and loss of each damper of the mode while its antinode moves by the amplitude, m.

    The vibration is steady with the mode's frequency, as wind keeps it up: force = |Z(i omega)| displacement with
    Z = i omega c/(1 + i omega c/k), stroke = force/(omega c) (derived). Raises InputError for dampers that are not
    those of the mode.
    """
    amplitude = not_negative("amplitude", amplitude, "in m")
    if len(dampers) != len(mode.position_shares):
        raise InputError(
            f"mode {mode.number} was computed with {len(mode.position_shares)} dampers, not {len(dampers)}; "
            "give the same dampers"
        )
    omega, done = 2 * pi * mode.frequency, []
    for number, (damper, share) in enumerate(zip(dampers, mode.position_shares, strict=True)):
        across, pull = stroke(damper, mode, number, amplitude), force(damper, mode, number, amplitude)
        done.append(
            DamperWork(share * amplitude, float(across), float(pull), float(pull * omega * across / 2))
        )
    return tuple(done)


def stroke(damper: Damper, mode: DampedMode, number: int, amplitude: Any) -> Any:
    """Amplitude across the dashpot, m, of damper 0, 1, ... of the mode, for the antinode's amplitude(s), m.

    The displacement at the damper over |1 + i omega c/k| (derived), for a steady vibration of the mode's frequency.
    """
    yielding = 2 * pi * mode.frequency * damper.coefficient / damper.support_stiffness
    return np.asarray(amplitude) * mode.position_shares[number] / abs(1 + 1j * yielding)


def force(damper: Damper, mode: DampedMode, number: int, amplitude: Any) -> Any:
    """Amplitude of the force, N, omega c times the stroke: |Z(i omega)| times the displacement at the damper."""
    return 2 * pi * mode.frequency * damper.coefficient * stroke(damper, mode, number, amplitude)


def damped_cable(
    cable: Cable,
    dampers: Sequence[Damper],
    *,
    sag: bool = False,
    bending: bool = False,
    ends: Ends = "clamped",
) -> DampedCable:
    """The cable with its dampers as a string, or as a beam or with sag where asked for. Raises InputError."""
    places = DamperPlaces(cable, dampers)
    if not sag and not bending:
        return DampedString(places)
    return DampedBeam(cable, places, sag=sag, bending=bending, ends=ends)


def scaled_roots(model: DampedCable, count: int, scales: np.ndarray) -> np.ndarray:
    """Roots (k, count), lambda L/sqrt(T/m), with the dampers' coefficients times scales (k,), rising, above 0.

    Modes are numbered where the dampers are nothing. A rigid damper at x makes the mode nearest to L/2x stop
    vibrating at c = 2 sqrt(T m) (derived); where count reaches so far, t passes that point in the complex plane, and
    modes are numbered by frequency.
    """
    total = float(model.dampers.eta.sum())
    if total == 0:
        return np.repeat(model.undamped(count)[None, :], len(scales), axis=0)
    near = np.minimum(model.dampers.places, 1.0 - model.dampers.places)
    lost = int(np.floor(near * (count + (1 + len(near)) / 2) + 0.5).sum())
    start = complex(min(SMALL / total, float(scales[0]) / 2))
    if not lost:
        try:
            return _followed(model, model.undamped(count), start, scales)
        except ComputationError:  # one more mode that stops vibrating
            lost = len(near)
    away = _followed(model, model.undamped(count + 2 * lost), start, scales * np.exp(-1j * DETOUR))
    return np.array(
        [_back(model, roots, float(scale), count) for roots, scale in zip(away, scales, strict=True)]
    )


def _followed(model: DampedCable, roots: np.ndarray, start: complex, at: np.ndarray) -> np.ndarray:
    """The roots (k, n) with the coefficients times each of `at` (k,)."""
    found, t = [], start
    for scale in at:
        roots, t = follow_roots(model.log_derivative, roots, t, scale), scale
        found.append(roots)
    return np.array(found)


def _back(model: DampedCable, roots: np.ndarray, scale: float, count: int) -> np.ndarray:
    """The first roots (count,) by frequency with the true coefficients, from those of complex ones."""
    while len(roots) >= count:
        try:
            found = follow_roots(model.log_derivative, roots, scale * np.exp(-1j * DETOUR), complex(scale))
        except ComputationError:  # close to c = 2 sqrt(T m) a root lies out of reach: it vibrates no more
            roots = np.delete(roots, np.argmin(np.real(roots)))
            continue
        vibrating = found[np.imag(found) > 1e-6]
        if len(vibrating) >= count:
            return vibrating[np.argsort(np.imag(vibrating))][:count]
        break
    raise ComputationError(f"fewer than {count} modes vibrate with these dampers")


def ratios_of(roots: np.ndarray) -> np.ndarray:
    """-Re(lambda)/|lambda| of roots of any shape; rounding below zero is cut off."""
    return np.maximum(-np.real(roots) / np.abs(roots), 0.0)


def whole_number(name: str, value: object) -> int:
    """The value as a whole number of 1 or more; InputError otherwise."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < 1:
        raise InputError(f"{name} = {value!r} must be a whole number of 1 or more")
    return int(value)


def _peak(values: np.ndarray) -> float:
    """The largest value between samples (k,) of equal spacing."""
    i = int(np.clip(np.argmax(values), 1, len(values) - 2))
    a, b, c = values[i - 1 : i + 2]
    curvature = a - 2 * b + c
    return float(max(b - (a - c) ** 2 / (8 * curvature) if curvature < 0 else b, values.max()))
