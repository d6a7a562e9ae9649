"""The keys of a bridge's case file: what each means, its unit and the value of the example.

The example's values are made up: they are of the size that real stays have, and of no bridge.
"""

from dataclasses import replace
from math import radians

from rainwind.engineering.bridge import ClimateSource, Limits, Question, Site
from rainwind.engineering.cable import SURFACES
from rainwind.io.schema import SECTION_KEYS, Keys, Number, Option
from rainwind.io.units import KINDS

__all__ = ["BRIDGE_KEYS", "BRIDGE_MARKS", "FIELDS", "TITLES"]

BRIDGE_MARKS = ("bridge", "cable", "stays")
"""A file with any of these tables describes a bridge, any other one a section."""

TITLES = {
    "bridge": "what the report says of the bridge",
    "cable": "a stay; write [[cable]] once for each, or [stays] for a table of them",
    "damper": "a viscous damper: [[cable.damper]] below its stay, or [[damper]] for all stays",
    "stays": "stays from a table, one row each; its columns are the keys of [cable]",
    "cable_defaults": "what stays leave out; the keys of [cable]",
    "site": "the wind at the bridge",
    "climate": "records of wind and rain; without them no hours a year are counted",
    "limits": "what the owner accepts",
    "assessment": "how much is computed",
    "rivulet": "per metre of cable; without this table the rule for the stay's diameter holds",
}
_LENGTH = replace(KINDS["length"], preferred="m", example="130 m")
_SPEED = KINDS["speed"]
_MN = replace(KINDS["force"], preferred="MN", example="900 MN")


def _stay(name: str, kind: str, sample: float, comment: str, **more: object) -> Number:
    field = {"damping": "damping_ratios"}.get(name, name)
    return Number("cable", name, field, KINDS[kind], sample, comment, **more)  # type: ignore[arg-type]


_CABLE = (
    replace(_stay("length", "length", 130.0, "of the chord between the anchorages"), kind=_LENGTH),
    _stay("diameter", "length", 0.16, "outer"),
    _stay("mass", "mass per length", 60.0, "with pipe and filling"),
    _stay("tension", "force", 3.2e6, "along the chord"),
    _stay(
        "inclination",
        "angle",
        radians(35.0),
        "of the chord to the horizontal",
        allowed="0 to pi/2 rad (0 to 90 deg)",
    ),
    _stay(
        "heading",
        "angle",
        radians(90.0),
        "compass direction in which the stay rises: 0 north, 90 east",
        allowed="0 to 2 pi rad (0 to 360 deg)",
    ),
    _stay(
        "damping",
        "ratio",
        0.0015,
        "of critical, without dampers; a list is of modes 1, 2, ...; 0.1 % if left out",
        required=False,
        several=True,
    ),
    replace(
        _stay(
            "axial_stiffness", "force", 1.6e9, "EA; estimated from the tension if left out", required=False
        ),
        kind=_MN,
    ),
    _stay("bending_stiffness", "bending stiffness", 9e5, "EI; 0 if left out", required=False),
    replace(
        _stay(
            "base_height",
            "length",
            20.0,
            "of the lower anchorage above ground or water; 10 m if left out",
            required=False,
        ),
        kind=_LENGTH,
    ),
    replace(
        _stay("chainage", "length", 40.0, "of the lower anchorage along the bridge", required=False),
        kind=_LENGTH,
    ),
)
_DAMPER = (
    Number("damper", "position", "position", _LENGTH, 4.0, "from its anchorage along the chord"),
    Number("damper", "coefficient", "coefficient", KINDS["damper coefficient"], 1.4e5, "c, force over speed"),
    Number(
        "damper",
        "support_stiffness",
        "support_stiffness",
        KINDS["stiffness"],
        2e7,
        "of what it stands on, in series with it; rigid if left out",
        required=False,
    ),
)
_SITE = Site()
_CLIMATE = ClimateSource("climate.csv")  # type: ignore[arg-type]
_QUESTION = Question()
_LIMITS = Limits()
_PLACE = (
    Number(
        "site",
        "reference_height",
        "reference_height",
        _LENGTH,
        _SITE.reference_height,
        "to which every wind speed of the answer belongs",
        required=False,
    ),
    Number(
        "site",
        "roughness",
        "roughness",
        _LENGTH,
        _SITE.roughness,
        "roughness length of the logarithmic profile",
        required=False,
    ),
    Number("site", "density", "density", KINDS["density"], _SITE.density, "of the air", required=False),
    Number(
        "climate",
        "height",
        "height",
        _LENGTH,
        _CLIMATE.height,
        "of the anemometer above ground",
        required=False,
    ),
    Number(
        "climate",
        "look_back",
        "look_back",
        KINDS["time"],
        _CLIMATE.look_back,
        "a record is wet if it rained in this time before it",
        required=False,
    ),
    Number(
        "climate",
        "rain_threshold",
        "rain_threshold",
        KINDS["rain rate"],
        _CLIMATE.rain_threshold,
        "rain above this wets a stay",
        required=False,
    ),
    Number(
        "limits",
        "observed_low",
        "observed_low",
        _SPEED,
        _LIMITS.observed_speeds[0],
        "lowest speed at which rivulets have been seen",
        required=False,
    ),
    Number(
        "limits",
        "observed_high",
        "observed_high",
        _SPEED,
        _LIMITS.observed_speeds[1],
        "highest speed at which rivulets have been seen",
        required=False,
    ),
    Number(
        "assessment", "low", "low", _SPEED, _QUESTION.speeds[0], "lowest wind speed looked at", required=False
    ),
    Number(
        "assessment",
        "high",
        "high",
        _SPEED,
        _QUESTION.speeds[1],
        "highest wind speed looked at",
        required=False,
    ),
)
_RIVULET = tuple(item for item in SECTION_KEYS.numbers if item.table == "rivulet")

FIELDS = (*(item.name for item in _CABLE), "surface", "dampers")
"""What a stay's `assumed` may name."""

_OPTIONS = (
    Option("bridge", "name", "A bridge", "of the bridge; the file's name if left out", form="text"),
    Option(
        "bridge",
        "assumptions",
        ("No damping was measured: 0.15 % is taken.",),
        "sentences that the report repeats",
        form="texts",
    ),
    Option(
        "bridge",
        "sources",
        ("Drawings of the contractor (read).",),
        "of the numbers, each with its status in words",
        form="texts",
    ),
    Option("cable", "name", "S1", "of the stay, each its own", form="text", required=True),
    Option(
        "cable",
        "surface",
        "smooth",
        f"{', '.join(SURFACES)}; smooth if left out",
        form="text",
        choices=tuple(SURFACES),
    ),
    Option(
        "cable", "assumed", ("damping", "heading"), "keys, without unit, that nobody measured", form="texts"
    ),
    Option(
        "damper",
        "end",
        "lower",
        "the anchorage that it is near: lower, upper",
        form="text",
        choices=("lower", "upper"),
    ),
    Option(
        "damper",
        "stays",
        ("S1", "S2"),
        "only of a [[damper]]: the stays that have it, all if left out",
        form="texts",
    ),
    Option("stays", "file", "stays.csv", "a .csv or .xlsx file beside this one", form="text", required=True),
    Option("stays", "sheet", "stays", "of an .xlsx file, the first one if left out", form="text"),
    Option(
        "site",
        "profile",
        "uniform",
        "of the wind over height: uniform, power, logarithmic",
        form="text",
        choices=("uniform", "power", "logarithmic"),
    ),
    Option("site", "exponent", _SITE.exponent, "of the power profile", form="number"),
    Option(
        "climate",
        "file",
        "climate.csv",
        "records, or how often each wind blows, beside this file",
        form="text",
        required=True,
    ),
    Option(
        "limits",
        "amplitude_diameters",
        _LIMITS.amplitude_diameters,
        "largest half peak to peak, in diameters of the stay",
        form="number",
    ),
    Option("assessment", "modes", _QUESTION.modes, "of each stay, from the first", form="count"),
    Option("assessment", "directions", _QUESTION.directions, "of the wind, round the compass", form="count"),
    Option(
        "assessment",
        "sets",
        _QUESTION.sets,
        "of coefficients: shipped ones, or files beside this one",
        form="texts",
    ),
    Option(
        "assessment", "samples", _QUESTION.samples, "of rivulet and coefficients, for each set", form="count"
    ),
    Option(
        "assessment",
        "runs",
        _QUESTION.runs,
        "samples that are followed in time, for the amplitude",
        form="count",
    ),
    Option("assessment", "seed", _QUESTION.seed, "of the samples", form="count"),
)


def _of_defaults() -> tuple[tuple[Number, ...], tuple[Option, ...]]:
    numbers = tuple(replace(item, table="cable_defaults", required=False) for item in _CABLE)
    options = (item for item in _OPTIONS if item.table == "cable" and item.name != "name")
    return numbers, tuple(replace(item, table="cable_defaults") for item in options)


_DEFAULT_NUMBERS, _DEFAULT_OPTIONS = _of_defaults()
BRIDGE_KEYS = Keys(
    tables=(*(table for table in TITLES),),
    numbers=(*_CABLE, *_DAMPER, *_DEFAULT_NUMBERS, *_PLACE, *_RIVULET),
    options=(*_OPTIONS, *_DEFAULT_OPTIONS),
    arrays=("cable", "damper"),
)
