"""Case files out: a model as TOML that reads back as the same model, and the commented example."""

from pathlib import Path

from rainwind.errors import InputError
from rainwind.io.schema import NUMBERS, OPTIONS, SCHEMA, TABLES
from rainwind.io.toml_values import toml_value
from rainwind.io.units import written
from rainwind.physics.coefficient_files import load_coefficients, shipped_sets
from rainwind.physics.coefficients import CoefficientSet
from rainwind.physics.model import RivuletModel

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
                rows.append((f"{item.name}_{suffix} = {toml_value(value)}", item.comment))
        for option in OPTIONS:
            if option.table == table and option.shown:
                rows.append((f"{option.name} = {toml_value(option.sample)}", option.comment))
        width = max(len(row[0]) for row in rows)
        lines = [f"{text:<{width}}  # {comment}" for text, comment in rows]
        blocks.append("\n".join([f"[{table}]  {_TITLES[table]}".rstrip(), *lines]) + "\n")
    return "\n".join(blocks)


def case_text(model: RivuletModel, coefficients: str | None = None) -> str:
    """`model` as a case file that reads back as an equal model.

    `coefficients` is the file of its set, relative to the case file; not needed for a shipped set. Raises
    InputError where it is needed.
    """
    rows: dict[str, list[str]] = {table: [] for table in TABLES}
    records = {"wind": model.wind, "section": model.section, "rivulet": model.rivulet}
    for item in NUMBERS:
        value = getattr(records[item.table], item.field, None)
        if value is not None:
            suffix, shown = written(value, item.kind)
            rows[item.table].append(f"{item.name}_{suffix} = {toml_value(shown)}")
    chosen = {"set": coefficients} if coefficients else _shipped_names(model.coefficients)
    rows["coefficients"] = [f"{key} = {toml_value(name)}" for key, name in chosen.items()]
    rows["coefficients"].append(f"outside = {toml_value(model.outside)}")
    for option in OPTIONS:
        if option.table == "model":
            rows["model"].append(f"{option.name} = {toml_value(getattr(model, option.name))}")
    blocks = ["\n".join([f"[{table}]", *lines]) for table, lines in rows.items()]
    return "\n\n".join([f"schema = {SCHEMA}", *blocks]) + "\n"


def _shipped_names(coefficients: CoefficientSet) -> dict[str, str]:
    sets = {name: load_coefficients(name) for name in shipped_sets()}
    for name, one in sets.items():
        if one == coefficients:
            return {"set": name}
    for name, one in sets.items():
        for other, moment in sets.items():
            if moment.moment is not None and one.with_moment_of(moment) == coefficients:
                return {"set": name, "moment_of": other}
    raise InputError(
        f"the set '{coefficients.name}' is not one of those shipped ({', '.join(sets)}); "
        "name its file with coefficients="
    )


def write_case(
    model: RivuletModel, path: Path | str, *, coefficients: str | None = None, force: bool = False
) -> None:
    """Write `model` to the case file `path`, from which `read_case` gives an equal model.

    Raises InputError where the file exists and `force` is not set, and as `case_text` does.
    """
    path = Path(path)
    if path.exists() and not force:
        raise InputError(f"{path}: exists already; choose another name or force to overwrite")
    path.write_text(case_text(model, coefficients), encoding="utf-8")
