"""An assessment as the content of a report: the first page, pictures, stay by stay, what stands behind it."""

from datetime import date

from rainwind import __version__
from rainwind.engineering.answers import BridgeAnswer
from rainwind.engineering.climate import Climate
from rainwind.reporting import words
from rainwind.reporting.back_pages import back_pages
from rainwind.reporting.content import Report
from rainwind.reporting.first_page import first_page
from rainwind.reporting.picture_pages import picture_pages
from rainwind.reporting.stay_pages import stay_pages

__all__ = ["document"]


def document(answer: BridgeAnswer, climate: Climate | None = None, *, day: date | None = None) -> Report:
    """The report's content. day: printed on it, today if None."""
    day = day or date.today()
    return Report(
        title=words.shortened(answer.bridge.name, 90),
        subtitle=f"Rain-wind induced vibration of stay cables: assessment of {day.day} {day:%B %Y}",
        head=words.shortened(answer.bridge.name, 60),
        foot=f"rainwind {__version__}, {day.isoformat()}",
        sections=(
            first_page(answer),
            *picture_pages(answer, climate),
            *stay_pages(answer),
            *back_pages(answer),
        ),
    )
