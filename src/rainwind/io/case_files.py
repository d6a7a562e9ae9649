"""Case files out: a model as TOML that reads back as the same model, and the commented example."""

from pathlib import Path
from typing import Any

from rainwind.errors import InputError
from rainwind.io.schema import NUMBERS, OPTIONS, SCHEMA, TABLES
from rainwind.io.units import written

__all__ = ["case_text", "new_case_text", "write_case"]

_HEAD = f"""\
# A case of rainwind: one section of a stay cable with a water rivulet, in wind.
# The unit of a number ends its key: diameter_mm = 100, diameter_m = 0.1; or diameter = "100 mm".
# The values are the sample case of Peil & Nahrath (2003).
schema = {SCHEMA}
"""
_TITLES = {
    "wind": "",
    "section": "# per metre of cable",
    "rivulet": "# the upper rivulet, per metre of cable",
    "coefficients": "# lift, drag and moment of the wetted section",
    "model": "",
}


def new_case_text() -> str:
    """The paper's sample case as a commented case file; it reads back as `paper_model()`."""
    blocks = [_HEAD]
    for table in TABLES:
        rows = []
        for item in NUMBERS:
            if item.table == table and item.shown:
                suffix, value = written(item.sample, item.kind)
                rows.append((f"{item.name}_{suffix} = {_plain(value)}", item.comment))
        for option in OPTIONS:
            if option.table == table and option.shown:
                rows.append((f"{option.name} = {_plain(option.sample)}", option.comment))
        width = max(len(row[0]) for row in rows)
        lines = [f"{text:<{width}}  # {comment}" for text, comment in rows]
        blocks.append("\n".join([f"[{table}]  {_TITLES[table]}".rstrip(), *lines]) + "\n")
    return "\n".join(blocks)


def case_text(model: Any, coefficients: str | None = None) -> str:
    """`model` (a RivuletModel) as a case file.

    `coefficients` is the name or file of its set, by default the set's own name. Raises InputError where
    a case file cannot say what the model holds.
    """
    records = {"wind": model.wind, "section": model.section, "rivulet": model.rivulet}
    blocks = [f"schema = {SCHEMA}\n"]
    for table, record in records.items():
        lines = [f"[{table}]"]
        for item in NUMBERS:
            value = getattr(record, item.field, None) if item.table == table else None
            if value is not None:
                suffix, shown = written(value, item.kind)
                lines.append(f"{item.name}_{suffix} = {_plain(shown)}")
        blocks.append("\n".join(lines) + "\n")
    name = coefficients or model.coefficients.name
    blocks.append(f"[coefficients]\nset = {_plain(name)}\noutside = {_plain(model.outside)}\n")
    blocks.append(
        "\n".join(
            [
                "[model]",
                *(
                    f"{option.name} = {_plain(getattr(model, option.name))}"
                    for option in OPTIONS
                    if option.table == "model"
                ),
            ]
        )
        + "\n"
    )
    return "\n".join(blocks)


def write_case(model: Any, path: Path | str, coefficients: str | None = None, force: bool = False) -> None:
    """Write `model` to the case file `path`, from which `read_case` gives an equal model.

    Raises InputError where the file exists and `force` is not set, and as `case_text` does.
    """
    path = Path(path)
    if path.exists() and not force:
        raise InputError(f"{path}: exists already; choose another name or force to overwrite")
    path.write_text(case_text(model, coefficients), encoding="utf-8")


def _plain(value: float | int | str) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return repr(value)
