"""Where the numbers and formulas of `engineering` come from, and how far each source was seen by us."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, get_args

from rainwind.errors import InputError

__all__ = ["SOURCES", "STATUS_WORDS", "Source", "Status", "cited"]

Status = Literal["read", "second-hand", "from memory", "derived", "judgement"]
STATUS_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "read": "read in the source itself",
        "second-hand": "read in another text that quotes the source; not checked against it",
        "from memory": "remembered, not checked; look it up before you rely on it",
        "derived": "derived or computed here",
        "judgement": "an engineer's judgement; nobody measured it",
    }
)


@dataclass(frozen=True)
class Source:
    """One source: a short key, the full reference with what was taken from it, and how it was seen.

    Raises InputError for a status that `STATUS_WORDS` does not explain.
    """

    key: str
    text: str
    status: Status

    def __post_init__(self) -> None:
        if self.status not in get_args(Status):
            raise InputError(
                f"status = {self.status!r} is not known; choose one of {', '.join(get_args(Status))}"
            )

    @property
    def sentence(self) -> str:
        """The reference with its status in words, as a report prints it."""
        return f"{self.text} ({STATUS_WORDS[self.status]})"


def cited(key: str) -> Source:
    """The source of one key. Raises InputError for a key that is not there."""
    if key not in SOURCES:
        raise InputError(f"source {key!r} is not known; choose one of {', '.join(SOURCES)}")
    return SOURCES[key]


_FHWA = (
    "Kumarasena, Jones, Irwin & Taylor (2007), Wind-Induced Vibration of Stay Cables, FHWA-HRT-05-083, "
    "Federal Highway Administration"
)
_ALL = (
    # the model
    Source(
        "Peil & Nahrath",
        "Peil & Nahrath (2003), Modeling of rain-wind induced vibrations, Wind and Structures 6(1), 41-52: the model "
        "of cable and rivulet; rivulets of 0.2 kg/m with 10 mm and of 0.08 kg/m with 6 mm",
        "read",
    ),
    Source(
        "coefficients",
        "the sets 'reconstructed', 'reconstructed_cubic' and 'reconstructed_linear': fitted so that the model gives "
        "the numbers that Peil & Nahrath (2003) print; the curves they used (Yamaguchi 1990) are lost",
        "derived",
    ),
    Source(
        "Gu & Lu",
        "Gu & Lu (2001), Theoretical analysis of wind-rain induced vibration of cables, 5th Asia-Pacific Conference "
        "on Wind Engineering: rivulet of 6 mm, as Peil & Nahrath (2003) quote it",
        "second-hand",
    ),
    Source(
        "Lemaitre",
        "Lemaitre, Alam, Hémon, de Langre & Zhou (2006), Rainwater rivulets on a cable subject to wind, Comptes Rendus "
        "Mécanique 334, 158-163: the Froude number is the control parameter (abstract)",
        "read",
    ),
    Source(
        "rivulet rule",
        "rivulets of other cables from that of Peil & Nahrath (2003), between one size and one shape: docs/rivulets.md",
        "judgement",
    ),
    Source(
        "rivulet scatter",
        "how far rivulets, their friction and the slopes of the coefficients may lie from the rule: docs/rivulets.md",
        "judgement",
    ),
    # codes and guidelines
    Source(
        "PTI",
        "PTI DC45.1-18, Recommendations for Stay Cable Design, Testing, and Installation, C5.2.3-1 (errata of "
        "December 2019): m xi / (rho D²) of 10 or more for smooth stays, 5 with a surface treatment that was tested",
        "read",
    ),
    Source(
        "FHWA",
        f"{_FHWA}, chapter 4: m xi / (rho D²) above 10, above 5 with an effective surface treatment; surface "
        "treatment at a minimum",
        "read",
    ),
    Source(
        "FHWA amplitude",
        f"{_FHWA}: amplitudes of 0.5 diameters preferred, 1 recommended, 2 at most, for the comfort of users",
        "from memory",
    ),
    Source(
        "Saito",
        f"{_FHWA}, figure 1 in words: the boundary of rain-wind vibrations after Saito "
        "rises from a reduced speed of 45 to one of 105 at a Scruton number of about 8; where it begins is not said",
        "read",
    ),
    Source(
        "EN 1993-1-11",
        "EN 1993-1-11:2006, Design of structures with tension components, 8.3: stays of more than 70 to 80 m get "
        "damping above 0.5 %; frequencies 20 % off those of the structure and their doubles; L/500 at 15 m/s",
        "second-hand",
    ),
    Source(
        "EN 1991-1-4",
        "EN 1991-1-4:2005, Wind actions, annex E: Strouhal number 0.18 of circular cylinders, Scruton number "
        "2 m delta / (rho b²)",
        "from memory",
    ),
    Source(
        "Strouhal",
        "Strouhal number 0.2 of circular cylinders below the critical Reynolds number, as in most textbooks",
        "from memory",
    ),
    Source(
        "dry galloping",
        f"{_FHWA}, and Honda et al. (1995): U = C f D sqrt(m xi / (rho D²)); the form is quoted by others, "
        "C = 40 of dry inclined stays is from memory",
        "from memory",
    ),
    # cable and damper
    Source(
        "Irvine",
        "Irvine (1981), Cable Structures, MIT Press: frequencies of a shallow cable over its parameter lambda²; the "
        "equation was checked by our own solution",
        "derived",
    ),
    Source(
        "Krenk",
        "Krenk (2000), Vibrations of a taut cable with an external damper, J. Appl. Mech. 67, 772-776: complex "
        "frequencies of a string with a viscous damper; the formulas were checked by our own solution",
        "derived",
    ),
    Source(
        "strand",
        "stays of strands: stress of 40 % of 1860 MPa, modulus of 195 GPa, where no axial stiffness is given",
        "judgement",
    ),
    Source(
        "bending stress",
        "bending stress 2 phi sqrt(E sigma) of a stay at its anchorage: the formula is from memory; derived here for a "
        "solid round bar in a rigid clamp and checked by our own solution of the taut bar",
        "derived",
    ),
    # what was observed
    Source(
        "Fred Hartman",
        f"{_FHWA}, appendix F, table 15: masses, tensions, lengths and frequencies of twelve stays of the Fred "
        "Hartman Bridge, consistent with f = sqrt(T/m)/(2L) to 0.13 %; outer diameters of 160 to 220 mm; vibrations "
        "up to 1.8 m peak to peak at 10 to 15 m/s (a weak source)",
        "second-hand",
    ),
    Source(
        "Stavanger",
        "J. Sound Vib. 503 (2021) 116106: stay C1E of the Stavanger City Bridge; mode 3 at 8 to 12 m/s in light rain, "
        "about two diameters peak to peak, U/(f D) about 35, at 45 to 65 degrees between cable and wind",
        "second-hand",
    ),
    Source(
        "Dongting",
        "J. Wind Eng. Ind. Aerodyn. 95 (2007) 303: 222 stays of the Dongting Lake Bridge; 6 to 14 m/s at the deck, "
        "yaw of 10 to 50 degrees, rain below 8 mm/h, 0.7 m peak to peak, mode 3 (abstract)",
        "second-hand",
    ),
    Source(
        "NRC 2023",
        "J. Wind Eng. Ind. Aerodyn. 242 (2023) 105581: a stay of 218 mm in a wind tunnel with rain, 217 kg, 1.23 Hz, "
        "damping of 0.05 to 0.11 %; 5 to 12 m/s (U/(f D) of 19 to 45), at most 150 mm (abstract)",
        "second-hand",
    ),
    Source(
        "Sutong",
        "Chen (2020), table 1: lengths, masses, diameters, tensions and inclinations of three stays of the Sutong "
        "Bridge",
        "second-hand",
    ),
    # rain and wind
    Source(
        "rain look-back",
        "program code of the monitoring of the Stavanger City Bridge: a record counts as wet if it rained by more "
        "than 0.01 mm/h in the two hours before it",
        "read",
    ),
    Source(
        "observed speeds",
        "5 to 18 m/s, where rivulets have been seen: the field observations named here and rivulets at 8 to 15 m/s "
        "in wind tunnels (Xu et al. 2002), with a margin",
        "judgement",
    ),
)
SOURCES: Mapping[str, Source] = MappingProxyType({source.key: source for source in _ALL})
"""By key, in the order in which a report lists them."""
