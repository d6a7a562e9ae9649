"""What codes and guidelines ask of a stay, and speeds at which other vibrations begin."""

from collections.abc import Iterator, Sequence
from math import isfinite, nan, pi, sqrt
from typing import Literal

from rainwind.engineering.answers import CodeCheck
from rainwind.engineering.cable import Cable
from rainwind.engineering.modes import Mode
from rainwind.errors import InputError
from rainwind.physics.checks import not_negative, positive

__all__ = [
    "EUROCODE", "PTI", "SCRUTON_NAMES", "TWICE", "code_checks", "galloping_speed", "rule_damping", "scruton_numbers",
    "vortex_speed",
]  # fmt: skip

PTI, EUROCODE, TWICE = "PTI", "Eurocode", "twice"
SCRUTON_NAMES = {
    PTI: "m ξ / (ρ D²), PTI and FHWA",
    EUROCODE: "2 m δ / (ρ D²), Eurocode, δ = 2π ξ",
    TWICE: "2 m ξ / (ρ D²), also in use",
}
"""The three definitions in use, by key: 10 of one is 126 of the next and 20 of the last."""

SMOOTH, TREATED = 10.0, 5.0
"""Least m xi / (rho D²) by PTI DC45.1-18 and FHWA-HRT-05-083 (both read): smooth stays, and tested surfaces."""
GALLOPING = 40.0
"""C of U = C f D sqrt(Sc) for dry inclined stays (from memory)."""
STROUHAL = 0.2
"""Of a round cylinder (from memory); EN 1991-1-4 says 0.18, which makes the speed 11 % higher."""
_LONG = 80.0  # m: EN 1993-1-11 says 70 to 80
_EN_DAMPING = 0.005
_EN_SPAN = 500.0
_COMFORT = {"preferred": 0.5, "recommended": 1.0, "at most": 2.0}


def scruton_numbers(cable: Cable, damping_ratio: float, density: float) -> dict[str, float]:
    """The Scruton number by its three definitions, keys of `SCRUTON_NAMES`. Raises InputError.

    damping_ratio: of critical; density of the air, kg/m³. The limits 10 and 5 belong to the first one.
    """
    xi = not_negative("damping_ratio", damping_ratio, "1 means critical")
    first = cable.mass * xi / (positive("density", density) * cable.diameter**2)
    return {PTI: first, EUROCODE: 4 * pi * first, TWICE: 2 * first}


def rule_damping(cable: Cable, density: float) -> float:
    """The damping ratio at which m xi / (rho D²) reaches PTI's limit: 10, or 5 with fillets or dimples.

    The lower limit holds for surfaces whose effect was tested. Source: PTI DC45.1-18, C5.2.3-1 (read).
    """
    return _limit(cable) * positive("density", density) * cable.diameter**2 / cable.mass


def galloping_speed(cable: Cable, frequency: float, damping_ratio: float, density: float) -> float:
    """The wind speed in m/s from which a dry inclined stay may gallop: 40 f D sqrt(m xi / (rho D²)) (from memory)."""
    scruton = scruton_numbers(cable, damping_ratio, density)[PTI]
    return GALLOPING * positive("frequency", frequency) * cable.diameter * sqrt(scruton)


def vortex_speed(cable: Cable, frequency: float) -> float:
    """The wind speed in m/s, normal to the stay, at which vortices shed at its frequency: f D / 0.2 (from memory)."""
    return positive("frequency", frequency) * cable.diameter / STROUHAL


def code_checks(
    cable: Cable,
    modes: Sequence[Mode],
    damping_ratios: Sequence[float],
    density: float,
    *,
    deck_frequencies: Sequence[float] = (),
    amplitude_at_15: float | None = None,
) -> tuple[CodeCheck, ...]:
    """What PTI, FHWA and EN 1993-1-11 ask, for the mode with the least damping.

    damping_ratios: with dampers, of each mode. deck_frequencies: of the structure, Hz; stays should keep 20 % away.
    amplitude_at_15: half peak to peak in m at a wind of 15 m/s. Raises InputError. Sources: each check names its own.
    """
    if len(modes) != len(damping_ratios) or not modes:
        raise InputError(f"{len(damping_ratios)} damping ratios for {len(modes)} modes; give one for each")
    return tuple(_checks(cable, modes, damping_ratios, density, deck_frequencies, amplitude_at_15))


def _checks(
    cable: Cable,
    modes: Sequence[Mode],
    ratios: Sequence[float],
    density: float,
    deck: Sequence[float],
    amplitude: float | None,
) -> Iterator[CodeCheck]:
    least = min(range(len(modes)), key=lambda k: ratios[k])
    of = f"mode {modes[least].number}"
    scruton = scruton_numbers(cable, ratios[least], density)[PTI]
    for rule, source in (("PTI", "PTI"), ("FHWA", "FHWA")):
        what = f"Scruton number m ξ / (ρ D²), {of}, {cable.surface}"
        yield _check(rule, what, scruton, _limit(cable), "", "at least", source)
    yield _check(
        "FHWA",
        "number of surface treatments",
        float(cable.surface != "smooth"),
        1.0,
        "",
        "at least",
        "FHWA",
    )
    if cable.length > _LONG:
        yield _check("EN 1993-1-11", f"damping, {of}, stay above 80 m", 100 * ratios[least], 100 * _EN_DAMPING, "%",
                     "at least", "EN 1993-1-11")  # fmt: skip
    if amplitude is not None and isfinite(amplitude):
        yield _check("EN 1993-1-11", "amplitude at 15 m/s, L/500", amplitude, cable.length / _EN_SPAN, "m", "at most",
                     "EN 1993-1-11")  # fmt: skip
        for word, diameters in _COMFORT.items():
            yield _check("FHWA", f"amplitude at 15 m/s, {word}", amplitude / cable.diameter, diameters, "D", "at most",
                         "FHWA amplitude")  # fmt: skip
    for frequency in deck:
        for times in (1, 2):
            apart, which = _distance(modes, times * positive("deck_frequencies", frequency))
            what = f"distance of mode {which} from {times} x {frequency:.3g} Hz of the structure"
            yield _check("EN 1993-1-11", what, 100 * apart, 20.0, "%", "at least", "EN 1993-1-11")


def _distance(modes: Sequence[Mode], frequency: float) -> tuple[float, int]:
    """How far the nearest mode is off a frequency, relative to it; and its number."""
    found = [
        (abs(f - frequency) / frequency, mode.number)
        for mode in modes
        for f in (mode.frequency_in, mode.frequency_out)
    ]
    return min(found, default=(nan, 0))


def _limit(cable: Cable) -> float:
    return SMOOTH if cable.surface == "smooth" else TREATED


def _check(
    rule: str,
    what: str,
    value: float,
    limit: float,
    unit: str,
    sense: Literal["at least", "at most"],
    source: str,
) -> CodeCheck:
    passes = value >= limit if sense == "at least" else value <= limit
    return CodeCheck(rule, what, value, limit, unit, sense, bool(passes), source)
