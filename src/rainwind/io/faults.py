"""The faults of one file, collected and reported together, each with its line."""

from dataclasses import dataclass, field
from typing import Protocol

from rainwind.errors import CaseError

__all__ = ["Faults", "Part", "Place", "TableRow"]

_LAST = 10**9  # behind the rows of every table


@dataclass
class Faults:
    """What is wrong with a file, and where: `lines` maps a key's path to its line.

    elsewhere: faults of a table that the file names, each with its row and with its place in words.
    """

    name: str
    lines: dict[tuple[str, ...], int]
    found: list[tuple[int, str]] = field(default_factory=list)
    elsewhere: list[tuple[int, str]] = field(default_factory=list)

    def add(self, text: str, *key: str) -> None:
        """A fault of `key`, or of the nearest table around it that has a line."""
        while key and key not in self.lines:
            key = key[:-1]
        self.found.append((self.lines.get(key, 0), text))

    @property
    def any(self) -> bool:
        """Whether a fault was found."""
        return bool(self.found or self.elsewhere)

    def behind(self, text: str) -> None:
        """The faults of another file, told in its own words behind all others."""
        self.elsewhere.append((_LAST, text.replace("\n", "\n  ")))

    def part(self, *path: str, label: str = "") -> "Part":
        """The place of the table at `path`; messages call it `label`, by default [its name]."""
        return Part(self, path, label or f"[{path[-1]}]")

    def raise_any(self) -> None:
        """Raise one CaseError that lists every fault, in the order of the lines."""
        total = len(self.found) + len(self.elsewhere)
        if not total:
            return
        count = "1 fault" if total == 1 else f"{total} faults"
        listed = [f"  line {line}: {text}" if line else f"  {text}" for line, text in sorted(self.found)]
        listed += [f"  {text}" for _, text in sorted(self.elsewhere, key=lambda fault: fault[0])]
        raise CaseError("\n".join([f"{self.name}: {count}", *listed]))


class Place(Protocol):
    """Where keys stand: a table of the file, or a row of another one."""

    @property
    def label(self) -> str:
        """What messages call it."""
        ...

    def add(self, text: str, key: str = "") -> None:
        """A fault of `key`, or of the place as a whole."""
        ...


@dataclass(frozen=True)
class Part:
    """A table of the case file."""

    faults: Faults
    path: tuple[str, ...]
    label: str

    def add(self, text: str, key: str = "") -> None:
        """A fault of `key`, or of the table as a whole."""
        self.faults.add(text, *self.path, *([key] if key else []))


@dataclass(frozen=True)
class TableRow:
    """A row of a table in another file; columns: key -> the header as it stands there."""

    faults: Faults
    file: str
    row: int
    columns: dict[str, str]
    label: str = "the row"

    def add(self, text: str, key: str = "") -> None:
        """A fault of the cell under `key`, or of the row as a whole."""
        column = f", column '{self.columns[key]}'" if key in self.columns else ""
        self.faults.elsewhere.append((self.row, f"{self.file}, row {self.row}{column}: {text}"))
