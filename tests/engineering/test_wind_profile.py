"""Profiles against their formulas, and the factor of a mode against integrals done by hand."""

from math import asin, exp, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rainwind.engineering.bridge import Site
from rainwind.engineering.cable import Cable
from rainwind.engineering.modes import cable_mode
from rainwind.engineering.wind_profile import lowest_height, mode_factor, speed_factor
from rainwind.errors import InputError

POWER = Site("power", reference_height=10.0, exponent=0.2)
LOG = Site("logarithmic", reference_height=10.0, roughness=0.01)


def stay(rise, base=20.0, length=200.0):
    """A string that rises by `rise` (m)."""
    return Cable(
        "a", length, 0.16, 70.0, 4e6, asin(rise / length), 1.0, axial_stiffness=1.0, base_height=base
    )


def test_profiles_by_hand():
    assert speed_factor(Site(), 80.0) == 1.0
    assert speed_factor(POWER, 320.0) == pytest.approx(2.0)  # 32 ** 0.2
    assert speed_factor(LOG, 0.01 * exp(9.0)) == pytest.approx(9.0 / log(1000.0))
    heights = np.array([[1.0, 10.0, 40.0], [5.0, 100.0, 0.0]])
    for site in (Site(), POWER, LOG):
        found = speed_factor(site, heights)
        assert found.shape == (2, 3)
        assert found[1, 1] == speed_factor(site, 100.0)


@given(
    st.sampled_from(["uniform", "power", "logarithmic"]),
    st.floats(0.5, 60.0),
    st.floats(1e-4, 0.4),
    st.floats(0.05, 0.4),
)
def test_the_factor_is_one_at_the_reference_height_and_never_falls(profile, reference, roughness, exponent):
    site = Site(profile, reference, exponent, roughness)
    assert speed_factor(site, reference) == pytest.approx(1.0, rel=1e-14)
    factors = speed_factor(site, np.linspace(0, 150, 301))
    assert np.all(factors > 0)
    assert np.all(np.diff(factors) >= 0)


def test_near_the_ground_the_profile_is_constant():
    assert lowest_height(POWER) == 1.0
    assert speed_factor(POWER, 0.0) == speed_factor(POWER, 1.0) == pytest.approx(10**-0.2)
    rough = Site("logarithmic", reference_height=10.0, roughness=0.3)
    assert lowest_height(rough) == 3.0
    assert speed_factor(rough, 0.1) == pytest.approx(log(10) / log(10 / 0.3))


@pytest.mark.parametrize("height", [-1.0, float("nan"), np.array([5.0, -0.1])])
def test_heights_below_ground_are_refused(height):
    with pytest.raises(InputError, match="height"):
        speed_factor(POWER, height)


@pytest.mark.parametrize("number", [1, 2, 5])
def test_a_linear_square_of_the_profile_counts_at_mid_span(number):
    # factor² = z / 10 is linear, and sin² is even about mid-span: so it counts there
    site = Site("power", reference_height=10.0, exponent=0.5)
    cable = stay(rise=100.0)
    assert mode_factor(cable, cable_mode(cable, number), site) == pytest.approx(sqrt(70.0 / 10.0), rel=1e-9)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_square_of_the_profile_that_grows_with_the_square_of_height(number):
    # the mean of (a + b xi)² with the weight 2 sin²(n pi xi) is (a + b / 2)² + b² (1 / 12 - 1 / (2 n² pi²))
    site = Site("power", reference_height=10.0, exponent=1.0)
    cable = stay(rise=100.0)
    expected = sqrt((2 + 5) ** 2 + 10**2 * (1 / 12 - 1 / (2 * number**2 * pi**2)))
    assert mode_factor(cable, cable_mode(cable, number), site) == pytest.approx(expected, rel=1e-6)


def test_a_horizontal_stay_sees_the_speed_at_its_height():
    cable = stay(rise=0.0, base=35.0)
    for site in (Site(), POWER, LOG):
        assert mode_factor(cable, cable_mode(cable, 1), site) == pytest.approx(
            speed_factor(site, 35.0), rel=1e-12
        )


def test_the_plain_mean_lies_below_by_half_the_square_of_the_variation():
    cable = stay(rise=110.0, base=15.0)
    mode = cable_mode(cable, 1)
    xi = np.linspace(0, 1, 20001)
    weight = mode.at(xi) ** 2 / np.sum(mode.at(xi) ** 2)
    factor = speed_factor(POWER, 15.0 + 110.0 * xi)
    mean = np.sum(weight * factor)
    variation = sqrt(np.sum(weight * (factor - mean) ** 2)) / mean
    assert mode_factor(cable, mode, POWER) / mean - 1 == pytest.approx(variation**2 / 2, rel=0.01)
    assert variation**2 / 2 < 0.01
