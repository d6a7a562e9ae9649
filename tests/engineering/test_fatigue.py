"""The angle of a sine at its end; the stress of a clamped taut bar, solved without its formula."""

from math import pi, radians

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from rainwind.engineering.cable import STRAND_MODULUS, STRAND_STRESS, Cable
from rainwind.engineering.fatigue import anchorage_angle, bending_stress
from rainwind.errors import InputError

STAY = Cable("1N", 100.0, 0.16, 60.0, 3e6, radians(30), 0.0)


def test_angle_is_the_slope_of_the_mode_at_its_end():
    for mode in (1, 2, 5):
        shape = 0.3 * np.sin(mode * pi * np.array([0.0, 1e-4]) / STAY.length)
        assert anchorage_angle(STAY, mode, 0.3) == pytest.approx((shape[1] - shape[0]) / 1e-4, rel=1e-6)
    found = anchorage_angle(STAY, 2, np.array([0.0, 0.1, np.nan]))
    assert found == pytest.approx([0, 0.2 * pi / 100, np.nan], nan_ok=True)


@pytest.mark.parametrize("diameter", [0.005, 0.1])
def test_stress_of_a_clamped_taut_bar(diameter: float):
    """EI w'''' = T w'' from a clamp to where the bar runs straight at the angle: no formula of the stress in it."""
    angle, stress, modulus = 0.01, 700e6, 200e9
    tension, inertia = stress * pi * diameter**2 / 4, pi * diameter**4 / 64
    far = 12 * np.sqrt(modulus * inertia / tension)
    ratio = tension * far**2 / (modulus * inertia)

    def slopes(
        _: np.ndarray, w: np.ndarray
    ) -> np.ndarray:  # over x / far: slope, curvature times far, its change
        return np.array([w[1], w[2], ratio * w[1]])

    ends = lambda a, b: np.array([a[0], b[0] - angle, b[1]])  # noqa: E731
    x = np.linspace(0, 1, 101)
    found = solve_bvp(slopes, ends, x, np.zeros((3, 101)), tol=1e-8, max_nodes=100_000)
    assert found.success
    curvature = found.sol(0.0)[1] / far
    assert bending_stress(angle, stress, modulus) == pytest.approx(
        modulus * curvature * diameter / 2, rel=1e-4
    )


def test_ten_milliradians_of_a_usual_strand():
    assert bending_stress(0.01, STRAND_STRESS, STRAND_MODULUS) == pytest.approx(240.9e6, rel=1e-3)
    assert bending_stress(np.array([0.0, 0.02]), 500e6, 200e9) == pytest.approx([0, 400e6])


def test_bad_input():
    for mode in (0, 1.5, True):
        with pytest.raises(InputError, match="mode"):
            anchorage_angle(STAY, mode, 0.1)  # type: ignore[arg-type]
    for amplitude in (-0.1, np.array([0.1, -0.1]), np.inf):
        with pytest.raises(InputError, match="amplitude"):
            anchorage_angle(STAY, 1, amplitude)
    for bad, word in (
        ((-1.0, 1.0, 1.0), "angle"),
        ((0.0, 0.0, 1.0), "axial_stress"),
        ((0.0, 1.0, -1.0), "modulus"),
    ):
        with pytest.raises(InputError, match=word):
            bending_stress(*bad)
