"""The numbers of every stay and mode as comma-separated text, one row each."""

import csv
import io
from math import isnan

from rainwind.engineering.answers import BridgeAnswer
from rainwind.reporting.quantities import columns, values

__all__ = ["csv_text", "harmless"]


def csv_text(answer: BridgeAnswer) -> str:
    """Header and rows; a stay that failed has one row with its reason. What does not exist is empty; inf: no limit."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["stay", "verdict", "mode", *columns(), "failure"])
    for stay in answer.stays:
        begin = [harmless(stay.cable.name), stay.verdict]
        if not stay.modes:
            writer.writerow([*begin, "", *([""] * len(columns())), harmless(stay.failure)])
        for mode in stay.modes:
            numbers = ["" if isnan(value) else repr(float(value)) for value in values(stay, mode)]
            writer.writerow([*begin, mode.number, *numbers, harmless(stay.failure)])
    return out.getvalue()


def harmless(text: str) -> str:
    """The text in one line; a spreadsheet would compute what begins like a formula: such a text gets a quote first."""
    text = " ".join(text.split())
    return f"'{text}" if text[:1] in tuple("=+-@") else text
