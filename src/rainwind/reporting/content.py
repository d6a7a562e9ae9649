"""What a report holds, before anyone says how it looks: sections of words, tables and figures, all frozen."""

from dataclasses import dataclass
from typing import Literal

__all__ = ["Block", "Cell", "Figure", "Points", "Report", "Section", "Table", "Verbatim", "Words"]

Mark = Literal["", "sufficient", "doubtful", "insufficient", "failed", "pass", "fail"]


@dataclass(frozen=True)
class Cell:
    """One cell of a table: its text, in lines; a mark colours it; the first line may be strong."""

    text: str
    mark: Mark = ""


@dataclass(frozen=True)
class Words:
    """A paragraph; a warning stands in a box; a small one explains a table or a figure."""

    text: str
    kind: Literal["plain", "warning", "strong", "small"] = "plain"


@dataclass(frozen=True)
class Points:
    """Sentences one under the other, with a dot or a number before each."""

    items: tuple[str, ...]
    numbered: bool = False


@dataclass(frozen=True)
class Table:
    """Rows of cells under a header; widths: shares of the page's width, one a column; left: columns that are words.

    The last cell of a row with fewer cells goes over the rest of the width; a row of one is a heading.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    caption: str = ""
    widths: tuple[float, ...] = ()
    left: tuple[int, ...] = (0,)


@dataclass(frozen=True)
class Figure:
    """A picture as SVG text, what it shows, and its share of the page's width."""

    svg: str
    caption: str
    width: float = 1.0


@dataclass(frozen=True)
class Verbatim:
    """Text as it is, in letters of one width."""

    text: str


Block = Words | Points | Table | Figure | Verbatim


@dataclass(frozen=True)
class Section:
    """A heading with what stands under it; level 1 is a chapter, level 2 a part; new_page: it begins one.

    one_page: on paper it is made a little smaller where that keeps it on one page.
    """

    title: str
    blocks: tuple[Block, ...]
    level: Literal[1, 2] = 1
    new_page: bool = False
    one_page: bool = False


@dataclass(frozen=True)
class Report:
    """The whole report: the title, the line under it, the words at the head and foot of a page, the sections."""

    title: str
    subtitle: str
    head: str
    foot: str
    sections: tuple[Section, ...]
