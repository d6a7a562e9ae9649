"""A report's content as one HTML page that needs nothing beside it."""

import re
from importlib.resources import files

import jinja2
from markupsafe import Markup

from rainwind.reporting import words
from rainwind.reporting.content import Figure, Report

__all__ = ["html"]

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")


def html(report: Report) -> str:
    """The page; every text of the report is escaped, the figures stand in it as SVG."""
    templates = files("rainwind.reporting") / "templates"
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["tidy"] = words.unbroken
    environment.filters["kind"] = lambda block: type(block).__name__
    template = environment.from_string((templates / "report.html.j2").read_text(encoding="utf-8"))
    pictures = {
        id(block): _inline(block, number)
        for number, block in enumerate(
            block for section in report.sections for block in section.blocks if isinstance(block, Figure)
        )
    }
    text = template.render(report=report, pictures=pictures, verdicts=words.VERDICTS, identity=id)
    return _CONTROL.sub("", text)


def _inline(figure: Figure, number: int) -> Markup:
    """The SVG element alone, its names made different from those of the other figures."""
    svg = figure.svg[figure.svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>f{number}-", svg)
    return Markup(svg)
