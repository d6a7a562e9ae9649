"""A value as TOML writes it."""

from collections.abc import Sequence

__all__ = ["toml_value"]


def toml_value(value: float | int | str | Sequence[object]) -> str:
    """A number, a text or a list of these as TOML; a number reads back as the same float."""
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, Sequence):
        return f"[{', '.join(toml_value(one) for one in value)}]"  # type: ignore[arg-type]
    return repr(value)
