"""On which line of a TOML text each key stands: tomllib does not say."""

import re

__all__ = ["key_lines"]

_NAME = r"""[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*'"""
_DOTTED = rf"(?:{_NAME})(?:\s*\.\s*(?:{_NAME}))*"
_HEADER = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]")
_KEY = re.compile(rf"\s*({_DOTTED})\s*=(.*)")
_INLINE_KEY = re.compile(rf"[{{,]\s*({_DOTTED})\s*=")


def key_lines(text: str) -> dict[tuple[str, ...], int]:
    """The line (from 1) of every table header and key: ("wind",) and ("wind", "speed_m_s").

    A table of an array carries its number, from 0: ("cable", "1", "length_m") is in the second [[cable]];
    ("cable",) is the first one's header.
    """
    lines: dict[tuple[str, ...], int] = {}
    counts: dict[tuple[str, ...], int] = {}  # tables seen of each array
    table: tuple[str, ...] = ()
    quotes = ""  # the quotes of the text over several lines that we are in
    for count, line in enumerate(text.splitlines(), start=1):
        if quotes:
            quotes = "" if quotes in line else quotes
            continue
        if header := _HEADER.match(line):
            table = _numbered(_parts(header[2]), counts, new=header[1] == "[[")
            if header[1] == "[[":
                lines.setdefault(table[:-1], count)
            lines.setdefault(table, count)
        elif found := _KEY.match(line):
            key = table + _parts(found[1])
            for depth in range(len(table) + 1, len(key) + 1):
                lines.setdefault(key[:depth], count)
            if found[2].lstrip().startswith("{"):
                for inner in _INLINE_KEY.findall(found[2]):
                    lines.setdefault(key + _parts(inner), count)
        for triple in ('"""', "'''"):
            if line.count(triple) % 2:
                quotes = triple
    return lines


def _numbered(names: tuple[str, ...], counts: dict[tuple[str, ...], int], *, new: bool) -> tuple[str, ...]:
    """The path of a header: behind the name of each array the number of its table that is meant, the last one."""
    path: tuple[str, ...] = ()
    for depth, name in enumerate(names, start=1):
        path += (name,)
        if new and depth == len(names):
            counts[path] = counts.get(path, 0) + 1
        if path in counts:
            path += (str(counts[path] - 1),)
    return path


def _parts(dotted: str) -> tuple[str, ...]:
    return tuple(name.strip("\"'") for name in re.findall(_NAME, dotted))
