"""The picture of a damper's curves shows the numbers that it was given."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from rainwind.engineering.damper_curve import DamperCurve
from rainwind.plotting import damper_curves

CURVE = DamperCurve(
    cable="S1", position=3.0, support_stiffness=1e6, modes=(1, 3), coefficients=np.array([1e4, 3e4, 1e5]),
    ratios=np.array([[0.001, 0.004], [0.003, 0.006], [0.005, 0.002]]), asymptote=np.full((3, 2), 0.002),
)  # fmt: skip


def test_exact_curves_in_per_cent_over_kilonewtons():
    axes = damper_curves.draw(CURVE, Figure().subplots(), chosen=4e4, targets={1: 0.002, 3: 0.003})
    lines = {str(line.get_label()): line for line in axes.lines}
    for i, mode in enumerate(CURVE.modes):
        line = lines[f"mode {mode}"]
        assert line.get_xdata() == pytest.approx([10, 30, 100])
        assert line.get_ydata() == pytest.approx(100 * CURVE.ratios[:, i])
        wanted = lines[f"wanted, mode {mode}"]
        assert wanted.get_ydata() == pytest.approx([0.2 + 0.1 * i] * 2)
        assert wanted.get_color() == line.get_color()
    assert lines["chosen: 40"].get_xdata() == pytest.approx([40, 40])
    assert (axes.get_xscale(), axes.get_title()) == ("log", "")
    assert axes.get_title(loc="left") == "stay S1, damper at 3 m, support 1 MN/m"


def test_one_target_for_all_is_one_line_inside_the_window():
    axes = damper_curves.draw(CURVE, Figure().subplots(), targets={1: 0.01, 3: 0.01})
    (line,) = (line for line in axes.lines if line.get_label() == "wanted")
    assert line.get_ydata() == pytest.approx([1, 1])
    assert axes.get_ylim()[1] > 1


def test_without_targets_and_asymptote():
    axes = damper_curves.draw(CURVE, Figure().subplots(), asymptote=False)
    assert len(axes.lines) == 2
    assert axes.get_ylim() == pytest.approx((0, 1.08 * 0.6))
