"""The commented example of a bridge's case file, written from the tables of keys."""

from rainwind.io.bridge_schema import BRIDGE_KEYS, TITLES
from rainwind.io.schema import SCHEMA
from rainwind.io.toml_values import toml_value
from rainwind.io.units import written

__all__ = ["new_bridge_text"]

_HEAD = f"""\
# A case of rainwind: the stays of a bridge, in wind and rain.
# The unit of a number ends its key: diameter_mm = 160, diameter_m = 0.16; or diameter = "160 mm".
# The values are made up. Lines that begin with a single # and a key are off: take the # away to use them.
schema = {SCHEMA}
"""
_EACH_ITS_OWN = ("length", "diameter", "mass", "tension", "inclination", "axial_stiffness", "chainage")
# header, table whose keys it takes, title, keys that are left out, whether all of it is switched off
_BLOCKS = (
    ("[bridge]", "bridge", TITLES["bridge"], (), False),
    ("[[cable]]", "cable", TITLES["cable"], (), False),
    ("[[cable.damper]]", "damper", "of the stay above; [[damper]] serves all stays", ("stays",), False),
    ("[stays]", "stays", TITLES["stays"], (), True),
    ("[cable_defaults]", "cable_defaults", TITLES["cable_defaults"], _EACH_ITS_OWN, True),
    ("[site]", "site", TITLES["site"], (), False),
    ("[climate]", "climate", TITLES["climate"], (), True),
    ("[limits]", "limits", TITLES["limits"], (), False),
    ("[assessment]", "assessment", TITLES["assessment"], (), False),
    ("[rivulet]", "rivulet", TITLES["rivulet"], (), True),
)
_FIRST = ("name", "file", "sheet", "profile")


def new_bridge_text() -> str:
    """A bridge of one stay as a commented case file; every key is there, some switched off by a #."""
    blocks = [_HEAD]
    for header, table, title, without, off in _BLOCKS:
        rows = [(text, comment) for name, text, comment in _rows(table) if name not in without]
        width = max(len(text) for text, _ in rows)
        lines = [f"{header}  # {title}", *(f"{text:<{width}}  # {comment}" for text, comment in rows)]
        blocks.append("\n".join(f"# {line}" if off else line for line in lines) + "\n")
    return "\n".join(blocks)


def _rows(table: str) -> list[tuple[str, str, str]]:
    """Name, line and comment of each key of a table."""
    options = [
        (name, f"{name} = {toml_value(item.sample)}", item.comment)
        for name, item in BRIDGE_KEYS.options_of(table).items()
    ]
    numbers = []
    for name, item in BRIDGE_KEYS.numbers_of(table).items():
        suffix, value = written(item.sample, item.kind)
        numbers.append((name, f"{name}_{suffix} = {value:.12g}", item.comment))
    first = [row for row in options if row[0] in _FIRST]
    return [*first, *numbers, *(row for row in options if row not in first)]
