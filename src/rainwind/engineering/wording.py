"""Directions and shares in words, for sentences and for reports alike."""

from math import isnan, pi

__all__ = ["NONE", "compass", "share"]

NONE = "none"
"""A value that does not exist."""
_POINTS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")


def share(value: float) -> str:
    """A share 0 to 1 as per cent; what is neither none nor all is never rounded to either."""
    percent = round(100 * value)
    if percent == 0 and value > 0:
        return "less than 1 %"
    if percent == 100 and value < 1:
        return "more than 99 %"
    return f"{percent} %"


def compass(direction: float) -> str:
    """A direction in rad clockwise from north as "135° (SE)"; nan is "none"."""
    if isnan(direction):
        return NONE
    degrees = round(direction * 180 / pi) % 360
    return f"{degrees}° ({_POINTS[round(degrees / 22.5) % 16]})"
