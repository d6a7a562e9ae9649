"""Numbers of a bridge that are allowed and most likely slips of a unit; each gives a sentence, none is an error.

Where no source is named, the range is an engineer's judgement, chosen wide.
"""

from collections.abc import Iterator
from math import inf, pi, radians, sqrt

from rainwind.engineering.bridge import Bridge
from rainwind.engineering.cable import Cable
from rainwind.engineering.sag import lambda_squared
from rainwind.io.bridge_schema import BRIDGE_KEYS
from rainwind.io.units import written
from rainwind.io.usual import SOLID, Range, is_usual, usual_sentence

__all__ = ["unusual_bridge"]

_JUDGED = "engineer's judgement"
_STAY = {
    "length": Range(10.0, 700.0, f"the longest stays measure 580 m ({_JUDGED})"),
    "diameter": Range(0.04, 0.4, f"stay cables measure 80 to 300 mm ({_JUDGED})"),
    "mass": Range(3.0, 400.0, f"steel strands in a pipe of that diameter ({_JUDGED})"),
    "inclination": Range(
        radians(5.0), radians(85.0), f"a smaller one is most likely meant in radians ({_JUDGED})"
    ),
    "heading": Range(
        radians(6.5), 2 * pi, f"a smaller one is perhaps meant in radians ({_JUDGED})", zero=True
    ),
    "damping": Range(
        0.0003,
        0.005,
        f"stays without dampers have 0.05 to 0.2 %; a smaller number is most likely meant as a ratio ({_JUDGED})",
    ),
    "base_height": Range(0.5, 300.0, f"of the lower anchorage above ground or water ({_JUDGED})", zero=True),
}
_DENSITY = Range(0.9, 1.5, "air from 2500 m height to the sea, -30 to 40 C")
_FREQUENCY = (0.1, 10.0)
_STRESS = (100e6, 1200e6)
_STRAIN = (0.0005, 0.01)
_OF_BEST = (0.01, 100.0)
_SAG = 15.0  # lambda²; the longest stays have about 2
_STEEL = 7850.0  # kg/m³


def unusual_bridge(bridge: Bridge) -> list[str]:
    """A sentence for each number of the bridge outside its usual range; stays with the same one share a sentence."""
    stays: dict[str, list[str]] = {}
    for stay in bridge.stays:
        for sentence in _of_stay(stay):
            stays.setdefault(sentence, []).append(stay.name)
    sentences = [f"{_who(names, len(bridge.stays))}: {sentence}" for sentence, names in stays.items()]
    return [*sentences, *_of_place(bridge)]


def _who(names: list[str], of: int) -> str:
    if len(names) == of > 1:
        return f"all {of} stays"
    quoted = [f"'{name}'" for name in names]
    if len(quoted) == 1:
        return f"stay {quoted[0]}"
    few = quoted if len(quoted) <= 4 else [*quoted[:3], f"{len(quoted) - 3} more"]
    return f"stays {', '.join(few[:-1])} and {few[-1]}"


def _of_stay(stay: Cable) -> Iterator[str]:
    numbers = BRIDGE_KEYS.numbers_of("cable")
    for name, usual in _STAY.items():
        item = numbers[name]
        given = getattr(stay, item.field)
        for value in dict.fromkeys(given if item.several else (given,)):
            if not is_usual(value, usual):
                suffix, shown = written(value, item.kind)
                yield usual_sentence(f"{name}_{suffix} = {shown:.6g}", usual, item.kind, suffix)
    density = stay.mass / (pi / 4 * stay.diameter**2)
    if not is_usual(density, SOLID):
        yield (
            f"mass and diameter make a cable of {density:.3g} kg/m3, which is unusual: usual is {SOLID.low:g} to "
            f"{SOLID.high:g} kg/m3; {SOLID.why}"
        )
    frequency = stay.wave_speed / (2 * stay.length)
    if not _FREQUENCY[0] <= frequency <= _FREQUENCY[1]:
        yield (
            f"tension, mass and length make a first frequency of {frequency:.3g} Hz, which is unusual: usual is "
            f"{_FREQUENCY[0]:g} to {_FREQUENCY[1]:g} Hz ({_JUDGED})"
        )
    stress = stay.tension * _STEEL / stay.mass
    if not _STRESS[0] <= stress <= _STRESS[1]:
        yield (
            f"tension and mass make a stress of {stress / 1e6:.3g} MPa if all mass is steel, which is unusual: usual "
            f"is {_STRESS[0] / 1e6:g} to {_STRESS[1] / 1e6:g} MPa; strands break at 1860 ({_JUDGED})"
        )
    sag = lambda_squared(stay)
    if sag > _SAG:
        yield (
            f"its sag makes lambda² = {sag:.3g}, which is unusual: stays have less than 3, and one beyond about 25 is "
            f"not computed; are tension, mass and length right? ({_JUDGED})"
        )
    yield from _of_stiffness(stay)
    yield from _of_dampers(stay)


def _of_stiffness(stay: Cable) -> Iterator[str]:
    if stay.axial_stiffness is not None:
        strain = stay.tension / stay.axial_stiffness
        if not _STRAIN[0] <= strain <= _STRAIN[1]:
            yield (
                f"tension and axial_stiffness make a strain of {100 * strain:.3g} %, which is unusual: usual is "
                f"{100 * _STRAIN[0]:g} to {100 * _STRAIN[1]:g} %; axial_stiffness is EA ({_JUDGED})"
            )
    if stay.bending_stiffness > 0:
        slenderness = stay.length * sqrt(stay.tension / stay.bending_stiffness)
        if slenderness < 20:
            yield (
                f"bending_stiffness makes it a beam more than a cable, L sqrt(T/EI) = {slenderness:.3g}, which is "
                f"unusual: usual is 20 or more; the unit of EI is N m^2 ({_JUDGED})"
            )


def _of_dampers(stay: Cable) -> Iterator[str]:
    for damper in stay.dampers:
        share = damper.position / stay.length
        # the best for the first mode, c = sqrt(T m) / (pi x/L): derived from the damped string
        best = sqrt(stay.tension * stay.mass) / (pi * share)
        if not _OF_BEST[0] <= damper.coefficient / best <= _OF_BEST[1]:
            yield (
                f"a damper of c = {damper.coefficient / 1000:.4g} kNs/m at {damper.position:g} m, which is unusual: "
                f"about {best / 1000:.3g} kNs/m would be the best there for the first mode; is its unit right?"
            )
        if share > 0.1:
            yield (
                f"a damper at {100 * share:.3g} % of the length, which is unusual: usual is 1 to 10 % ({_JUDGED})"
            )
        if damper.support_stiffness < inf and damper.support_stiffness < stay.tension / damper.position / 10:
            yield (
                f"a damper on a support of {damper.support_stiffness / 1000:.4g} kN/m, which is unusual: softer than a "
                f"tenth of the cable itself there, it hardly works; is its unit right?"
            )


def _of_place(bridge: Bridge) -> Iterator[str]:
    site, climate = bridge.site, bridge.climate
    if not is_usual(site.density, _DENSITY):
        kind = BRIDGE_KEYS.numbers_of("site")["density"].kind
        yield usual_sentence(f"[site] density_kg_m3 = {site.density:g}", _DENSITY, kind, "kg_m3")
    if site.profile == "power" and not 0.05 <= site.exponent <= 0.45:
        yield f"[site] exponent = {site.exponent:g}, which is unusual: usual is 0.05 (water) to 0.45 (city; {_JUDGED})"
    if site.profile == "logarithmic" and not 1e-5 <= site.roughness <= 3:
        yield (
            f"[site] roughness_m = {site.roughness:g}, which is unusual: usual is 0.00001 (water) "
            f"to 3 m (city; {_JUDGED})"
        )
    if climate is not None and climate.look_back > 86400:
        yield (
            f"[climate] look_back_h = {climate.look_back / 3600:g}, which is unusual: usual is up to 24 h; a stay "
            f"dries within hours ({_JUDGED})"
        )
    if climate is not None and climate.rain_threshold > 8:
        yield (
            f"[climate] rain_threshold_mm_h = {climate.rain_threshold:g}, which is unusual: usual is 0 to 8 mm/h; most "
            f"vibrations were seen in light rain ({_JUDGED})"
        )
    if bridge.limits.amplitude_diameters > 5:
        yield (
            f"[limits] amplitude_diameters = {bridge.limits.amplitude_diameters:g}, which is unusual: usual is up to 2 "
            "diameters (FHWA, from memory)"
        )
