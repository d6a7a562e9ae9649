"""The faults of one file, collected and reported together, each with its line."""

from dataclasses import dataclass, field

from rainwind.errors import CaseError

__all__ = ["Faults"]


@dataclass
class Faults:
    """What is wrong with a file, and where: `lines` maps a key's path to its line."""

    name: str
    lines: dict[tuple[str, ...], int]
    found: list[tuple[int, str]] = field(default_factory=list)

    def add(self, text: str, *key: str) -> None:
        """A fault of `key`, or of the nearest table around it that has a line."""
        while key and key not in self.lines:
            key = key[:-1]
        self.found.append((self.lines.get(key, 0), text))

    def raise_any(self) -> None:
        """Raise one CaseError that lists every fault, in the order of the lines."""
        if not self.found:
            return
        count = "1 fault" if len(self.found) == 1 else f"{len(self.found)} faults"
        listed = [f"  line {line}: {text}" if line else f"  {text}" for line, text in sorted(self.found)]
        raise CaseError("\n".join([f"{self.name}: {count}", *listed]))
