"""Shares and directions in words."""

from math import nan, pi

import pytest

from rainwind.engineering.wording import NONE, compass, share


@pytest.mark.parametrize(
    ("value", "said"),
    [(0, "0 %"), (0.004, "less than 1 %"), (0.125, "12 %"), (0.996, "more than 99 %"), (1, "100 %")],
)
def test_a_share_is_never_rounded_to_none_or_all(value: float, said: str) -> None:
    assert share(value) == said


def test_a_direction_has_one_of_sixteen_points() -> None:
    assert [compass(k * pi / 8) for k in (0, 1, 10)] == ["0° (N)", "22° (NNE)", "225° (SW)"]
    assert compass(2 * pi - 1e-9) == "0° (N)"
    assert compass(nan) == NONE
