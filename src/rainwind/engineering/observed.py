"""Stays and rigs on which rain-wind vibrations were observed: what was seen, and what had to be assumed."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from math import pi, radians
from typing import Any

from rainwind.engineering.bridge import Site
from rainwind.engineering.cable import Cable

__all__ = ["Observed", "observed_cases", "stays_table"]

_STAND_IN = 100.0  # m: length of the string that moves like a rig's springs
_NO_STRETCH = 1e3  # N: its axial stiffness, so small that neither sag nor stretching counts
_EXPONENT = 0.12  # of the wind's profile above a deck over water: judgement


@dataclass(frozen=True)
class Observed:
    """One stay or rig, and what was seen on it.

    cable, site: as an assessment takes them; modes: how many are compared. status: how the source was seen, in words;
    assumed: inputs that it does not give. speeds: m/s, of the vibrations, at the site's reference height. mode: that
    vibrated, None where the source does not say. amplitude: half peak to peak in m, least and most that was reported;
    if the source does not say whether it is peak to peak, twice too large at most. yaw: rad, in which it vibrated,
    positive where the stay descends downwind. tested_yaw: rad, where a rig stood. field_damping: ratios to which
    dampers brought it, and it is said to have been enough.
    """

    name: str
    source: str
    status: str
    assumed: str
    said: str
    cable: Cable
    site: Site
    modes: int
    speeds: tuple[float, float]
    mode: int | None = None
    amplitude: tuple[float, float] | None = None
    yaw: tuple[float, float] | None = None
    tested_yaw: tuple[float, float] | None = None
    field_damping: tuple[float, float] | None = None

    def reduced(self, frequency: float) -> tuple[float, float]:
        """U / (f D) of the speeds observed, at a frequency in Hz."""
        low, high = self.speeds
        per = frequency * self.cable.diameter
        return low / per, high / per


def stays_table() -> Mapping[str, Any]:
    """The file `data/stays.toml`: each source's numbers with its status, and the cases."""
    text = files("rainwind.engineering").joinpath("data/stays.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def observed_cases() -> tuple[Observed, ...]:
    """All cases, in the order of the file."""
    table = stays_table()
    return tuple(_case(case, table[case["of"]]) for case in table["case"])


def _case(case: Mapping[str, Any], source: Mapping[str, Any]) -> Observed:
    given = {**source, **_row(source, case.get("stay")), **case["assume"]}
    deck = case.get("deck")
    site = Site("uniform") if deck is None else Site("power", reference_height=deck, exponent=_EXPONENT)
    percent = case.get("field_damping_percent")
    return Observed(
        name=case["name"],
        source=source["source"],
        status=source["status"],
        assumed=case["assumed"],
        said=source.get("observed") or source["note"],
        cable=_cable(case, given, site.reference_height),
        site=site,
        modes=case["modes"],
        speeds=tuple(case["observed_speeds"]),
        mode=case.get("observed_mode"),
        amplitude=_pair(case.get("observed_amplitude_m")),
        yaw=_angles(case.get("observed_yaw_deg")),
        tested_yaw=_angles(case.get("tested_yaw_deg")),
        field_damping=None if percent is None else (percent[0] / 100.0, percent[1] / 100.0),
    )


def _row(source: Mapping[str, Any], stay: str | None) -> dict[str, Any]:
    if stay is None:
        return {}
    (row,) = (row for row in source["rows"] if row[0] == stay)
    return dict(zip(source["columns"], row, strict=True))


def _cable(case: Mapping[str, Any], given: Mapping[str, Any], height: float) -> Cable:
    rig = case.get("rig", False)
    length, mass = _STAND_IN if rig else given["length_m"], given["mass_kg_m"]
    tension = (
        1e6 * given["tension_MN"]
        if "tension_MN" in given
        else mass * (2.0 * length * given["frequency_Hz"]) ** 2
    )
    # a rig stands at one yaw: rising 45 degrees off north, winds from the four quarters have yaws of 45 and -45
    alone = case.get("tested_yaw_deg") == [45.0, 45.0]
    return Cable(
        name=case["name"],
        length=length,
        diameter=given["diameter_m"],
        mass=mass,
        tension=tension,
        inclination=radians(given["inclination_deg"]),
        heading=pi / 4 if alone else 0.0,
        axial_stiffness=_NO_STRETCH if rig else None,
        damping_ratios=(given["damping_percent"] / 100.0,),
        base_height=height,
        assumed=tuple(case["assume"]),
    )


def _pair(values: list[float] | None) -> tuple[float, float] | None:
    return None if values is None else (values[0], values[1])


def _angles(degrees: list[float] | None) -> tuple[float, float] | None:
    return None if degrees is None else (radians(degrees[0]), radians(degrees[1]))
