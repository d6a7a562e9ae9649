"""The pages of pictures."""

from collections.abc import Iterator

from rainwind.engineering.answers import BridgeAnswer
from rainwind.engineering.climate import Climate
from rainwind.reporting.content import Section

__all__ = ["picture_pages"]


def picture_pages(answer: BridgeAnswer, climate: Climate | None = None) -> Iterator[Section]:
    """Map of the stays, wind rose, ranges over direction, amplitudes over speed, damper curves."""
    yield from ()
