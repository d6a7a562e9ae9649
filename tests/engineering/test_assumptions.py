"""What was assumed is told with its value."""

from dataclasses import replace

import pytest

from rainwind.engineering.assumptions import assumption_sentences
from rainwind.engineering.bridge import Bridge
from rainwind.engineering.cable import Cable
from rainwind.physics import Rivulet

STAY = Cable(
    "S", 100.0, 0.16, 60.0, 3e6, 0.5, 1.0, axial_stiffness=1.5e9, bending_stiffness=9e5,
    damping_ratios=(0.001, 0.0015), surface="helical fillet", base_height=12.0,
)  # fmt: skip


def said(stay: Cable, **changes: object) -> list[str]:
    return list(assumption_sentences(Bridge("B", (stay,), **changes), stay))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("damping",), "damping 0.1, 0.15 %"),
        (("surface", "base_height"), "surface helical fillet; base height 12 m"),
        (("bending_stiffness",), "bending stiffness 900 kNm²"),
        (("heading",), "heading 57.3°"),
        (("tension",), "tension"),
    ],
)
def test_fields_with_their_values(names, words):
    assert said(replace(STAY, assumed=names), rivulet=Rivulet()) == [f"Not measured but assumed: {words}."]


def test_stiffness_and_rivulet_that_nobody_gave():
    assert said(STAY, rivulet=Rivulet()) == []
    # EA = T * 195 GPa / (0.4 * 1860 MPa) = 3 MN * 262.1
    stiffness, rivulet = said(replace(STAY, axial_stiffness=None))
    assert stiffness.startswith("Axial stiffness 786 MN, estimated from the tension")
    assert rivulet.startswith("Rivulet by the rule for the diameter: 0.32 kg/m, 16 mm high")
