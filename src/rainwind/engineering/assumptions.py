"""What of a stay nobody measured, each with the value that was taken instead."""

from collections.abc import Iterator
from math import degrees

from rainwind.engineering.bridge import Bridge
from rainwind.engineering.cable import Cable
from rainwind.engineering.rivulets import usual_rivulet

__all__ = ["assumption_sentences"]


def assumption_sentences(bridge: Bridge, cable: Cable) -> Iterator[str]:
    """Sentences for a report: the fields that `cable.assumed` names, the stiffness and the rivulet if not given."""
    if cable.assumed:
        yield f"Not measured but assumed: {'; '.join(_with_value(cable, name) for name in cable.assumed)}."
    if cable.axial_stiffness is None:
        yield (
            f"Axial stiffness {cable.estimated_axial_stiffness / 1e6:.0f} MN, estimated from the tension: strands at "
            "40 % of 1860 MPa with 195 GPa."
        )
    if bridge.rivulet is None:
        rivulet = usual_rivulet(cable.diameter)
        yield (
            f"Rivulet by the rule for the diameter: {rivulet.mass:.3g} kg/m, {1000 * rivulet.height:.3g} mm high, "
            f"friction {rivulet.friction:.3g} Nms/m; nobody measured it on this stay."
        )


def _with_value(cable: Cable, name: str) -> str:
    """The field in words, with its value where all stays often have the same; the others stand on the stay's page."""
    values = {
        "damping": f"{', '.join(f'{100 * ratio:.3g}' for ratio in cable.damping_ratios)} %",
        "surface": cable.surface,
        "base_height": f"{cable.base_height:.4g} m",
        "bending_stiffness": f"{cable.bending_stiffness / 1e3:.4g} kNm²",
        "heading": f"{degrees(cable.heading):.4g}°",
    }
    words = name.replace("_", " ")
    return f"{words} {values[name]}" if name in values else words
