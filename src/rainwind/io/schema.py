"""The keys of a case file: what each means, its symbol, its kind of quantity and the paper's value."""

from dataclasses import dataclass
from math import pi

from rainwind.io.units import KINDS, Kind

__all__ = ["NUMBERS", "OPTIONS", "SCHEMA", "SECTION_KEYS", "TABLES", "Keys", "Number", "Option"]

SCHEMA = 1
TABLES = ("wind", "section", "rivulet", "coefficients", "model")


@dataclass(frozen=True)
class Number:
    """A dimensional key of a case file and the field of the physics that it sets (SI, radians)."""

    table: str
    name: str  # without the unit
    field: str
    kind: Kind
    sample: float  # SI, the paper's sample case
    comment: str
    required: bool = True
    parts: tuple[str, ...] = ()  # names that may be given in its place, all of them
    shown: bool = True  # in the example file
    zero_if_left_out: bool = False
    allowed: str = ""  # of an angle: the physics speaks of radians only
    several: bool = False  # a list of numbers may stand there; the value is a tuple


@dataclass(frozen=True)
class Option:
    """A key that holds words, a count or a number without a unit.

    form: what is read, "text", "texts", "count" or "number"; "" passes anything on to whoever checks it.
    choices: all that is allowed there, () for anything.
    """

    table: str
    name: str
    sample: str | int | float | tuple[str, ...]
    comment: str
    shown: bool = True
    form: str = ""
    choices: tuple[str | int, ...] = ()
    required: bool = False


@dataclass(frozen=True)
class Keys:
    """All keys of one kind of file."""

    tables: tuple[str, ...]
    numbers: tuple[Number, ...]
    options: tuple[Option, ...]
    arrays: tuple[str, ...] = ()  # tables that may be written several times, [[so]]

    def numbers_of(self, table: str) -> dict[str, Number]:
        """Name without unit -> the key, of one table."""
        return {item.name: item for item in self.numbers if item.table == table}

    def options_of(self, table: str) -> dict[str, Option]:
        """Name -> the key, of one table."""
        return {item.name: item for item in self.options if item.table == table}


_SAMPLE = "Peil & Nahrath (2003), section 3"
_TYPICAL = "not in the paper"

NUMBERS = (
    Number(
        "wind",
        "speed",
        "speed",
        KINDS["speed"],
        9.0,
        "U, undisturbed wind speed; one of those in section 4.3",
    ),
    Number(
        "wind",
        "yaw",
        "yaw",
        KINDS["angle"],
        0.0,
        "gamma, 0 = wind across the cable; section 3",
        allowed="-pi to pi rad (-180 to 180 deg)",
        required=False,
    ),
    Number(
        "wind",
        "density",
        "density",
        KINDS["density"],
        1.225,
        f"rho of air at 15 C, {_TYPICAL}",
        required=False,
    ),
    Number(
        "wind",
        "vertical_speed",
        "vertical_speed",
        KINDS["speed"],
        0.0,
        f"w, positive upwards; {_TYPICAL}; 0 if left out",
        required=False,
        shown=False,
        zero_if_left_out=True,
    ),
    Number("section", "diameter", "diameter", KINDS["length"], 0.1, f"d; {_SAMPLE}"),
    Number("section", "mass", "mass", KINDS["mass per length"], 50.0, f"m_S; {_SAMPLE}"),
    Number(
        "section",
        "frequency",
        "frequency",
        KINDS["frequency"],
        1.0,
        f"f_y = f_z of the cable without rivulet; {_SAMPLE}",
        parts=("frequency_y", "frequency_z"),
    ),
    Number(
        "section", "frequency_y", "frequency_y", KINDS["frequency"], 1.0, "f_y", required=False, shown=False
    ),
    Number(
        "section", "frequency_z", "frequency_z", KINDS["frequency"], 1.0, "f_z", required=False, shown=False
    ),
    Number(
        "section",
        "damping",
        "damping_ratio",
        KINDS["ratio"],
        0.002,
        "xi of critical; section 5 (the table of section 3 prints 2 %, a misprint)",
        parts=("damping_y", "damping_z"),
    ),
    Number(
        "section", "damping_y", "damping_ratio_y", KINDS["ratio"], 0.002, "xi_y", required=False, shown=False
    ),
    Number(
        "section", "damping_z", "damping_ratio_z", KINDS["ratio"], 0.002, "xi_z", required=False, shown=False
    ),
    Number(
        "section",
        "inclination",
        "inclination",
        KINDS["angle"],
        pi / 4,
        f"delta; {_SAMPLE}",
        allowed="0 to pi/2 rad (0 to 90 deg)",
    ),
    Number(
        "section",
        "k2_y",
        "k2_y",
        KINDS["quadratic stiffness"],
        0.0077,
        "k_y2 per metre of cable (printed as N/m^2); 0 if left out",
        required=False,
        zero_if_left_out=True,
    ),
    Number(
        "section",
        "k3_y",
        "k3_y",
        KINDS["cubic stiffness"],
        0.00115,
        "k_y3 per metre of cable (printed as N/m^3); 0 if left out",
        required=False,
        zero_if_left_out=True,
    ),
    Number(
        "section",
        "k2_z",
        "k2_z",
        KINDS["quadratic stiffness"],
        0.0,
        "k_z2; section 3; 0 if left out",
        required=False,
        zero_if_left_out=True,
    ),
    Number(
        "section",
        "k3_z",
        "k3_z",
        KINDS["cubic stiffness"],
        0.00115,
        "k_z3; section 3; 0 if left out",
        required=False,
        zero_if_left_out=True,
    ),
    Number(
        "section",
        "k3",
        "k3",
        KINDS["cubic stiffness"],
        100.0,
        f"k_3 of the tension, which couples y and z; {_TYPICAL}; none if left out",
        required=False,
        shown=False,
    ),
    Number(
        "section",
        "sag_offset",
        "sag_offset",
        KINDS["length"],
        0.1,
        f"s, of the tension by the sag; {_TYPICAL}; 0 if left out",
        required=False,
        shown=False,
    ),
    Number("rivulet", "mass", "mass", KINDS["mass per length"], 0.2, f"m_R; {_SAMPLE}"),
    Number("rivulet", "height", "height", KINDS["length"], 0.01, f"h, r = (d + h)/2 follows; {_SAMPLE}"),
    Number(
        "rivulet", "friction", "friction", KINDS["friction"], 0.05, f"d_phi, per metre of cable; {_SAMPLE}"
    ),
)

OPTIONS = (
    Option("coefficients", "set", "reconstructed", "a shipped set, or a file beside this one: 'my_set.toml'"),
    Option(
        "coefficients",
        "outside",
        "blend",
        "outside its validity: blend, extend or refuse",
        choices=("blend", "extend", "refuse"),
    ),
    Option("coefficients", "moment_of", "reconstructed", "take C_M from another set", shown=False),
    Option("model", "degrees_of_freedom", 3, "3: y, phi, z; 2: y, phi", choices=(3, 2)),
    Option(
        "model",
        "angle",
        "arctan",
        "eq. (3): arctan, or linear as printed on its right-hand side",
        choices=("arctan", "linear"),
    ),
    Option(
        "model",
        "relative_speed",
        "wind",
        "eq. (2): wind as in the paper, or full",
        choices=("wind", "full"),
    ),
)

SECTION_KEYS = Keys(TABLES, NUMBERS, OPTIONS)
