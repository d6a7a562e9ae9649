"""Every key of a case file as Markdown tables, for the documentation."""

from rainwind.io.bridge_schema import BRIDGE_KEYS, TITLES
from rainwind.io.schema import Keys, Number, Option
from rainwind.io.toml_values import toml_value
from rainwind.io.units import written

__all__ = ["key_reference"]

_WRITTEN = {
    "cable": "[[cable]], [cable] or the columns of [stays]",
    "damper": "[[cable.damper]], [[damper]] or columns that begin with damper_",
}
_TYPES = {"text": "text", "texts": "list of texts", "count": "whole number", "number": "number"}


def key_reference(keys: Keys = BRIDGE_KEYS, titles: dict[str, str] = TITLES) -> str:
    """One Markdown table for each table of a case file: key, units, whether it must be there, what it is."""
    blocks = []
    for table in keys.tables:
        if table == "cable_defaults":
            continue  # the keys of [cable]
        rows = [_option(item) for item in keys.options_of(table).values()]
        rows += [_number(item) for item in keys.numbers_of(table).values()]
        head = [
            f"### {_WRITTEN.get(table, f'[{table}]')}",
            "",
            f"{titles[table][0].upper()}{titles[table][1:]}.",
            "",
        ]
        lines = ["| key | unit or type | needed | what it is |", "| --- | --- | --- | --- |", *rows]
        blocks.append("\n".join([*head, *lines]) + "\n")
    return "\n".join(blocks)


def _number(item: Number) -> str:
    suffix, value = written(item.sample, item.kind)
    units = ", ".join(f"`_{key[len(item.name) + 1 :]}`" for key in item.kind.keys(item.name))
    return _row(f"{item.name}_{suffix} = {value:.12g}", units, item.required, item.comment)


def _option(option: Option) -> str:
    kind = ", ".join(f"`{one}`" for one in option.choices) or _TYPES[option.form]
    return _row(f"{option.name} = {toml_value(option.sample)}", kind, option.required, option.comment)


def _row(example: str, kind: str, required: bool, comment: str) -> str:
    return f"| `{example}` | {kind} | {'yes' if required else ''} | {comment} |"
