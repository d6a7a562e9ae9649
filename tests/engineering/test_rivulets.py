"""The rule for rivulets against the two that were described, its Froude number, and the spread of samples."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rainwind.engineering.rivulets import (
    RIVULET_SCATTER,
    SIZE,
    Scatter,
    factors_at,
    sample_factors,
    usual_rivulet,
)
from rainwind.engineering.upper_rivulet import upper_rivulets, wind_speed_normal
from rainwind.errors import InputError
from rainwind.physics.model import paper_model
from rainwind.physics.rivulet import Rivulet

NAMES = ("rivulet.mass", "rivulet.friction", "lift slope", "drag slope", "moment slope")


def test_the_rule_gives_the_rivulet_of_the_sample_case() -> None:
    """0.2 kg/m, 10 mm, 0.05 Nms at 0.1 m: section 3 of Peil & Nahrath (2003)."""
    rivulet = usual_rivulet(0.1)
    assert (rivulet.mass, rivulet.height, rivulet.friction) == pytest.approx((0.2, 0.01, 0.05), rel=1e-12)


def test_the_other_rivulet_of_the_paper_lies_within_the_scatter() -> None:
    """0.08 kg/m with 6 mm (section 5): its mass by its own height is 2.2 h², against 2.0 h²."""
    assert pytest.approx(1.11, abs=0.005) == 0.08 / (1000 * 2.0 * 0.006**2)
    factor = 0.08 / usual_rivulet(0.1).mass
    assert abs(np.log(factor)) < 2.5 * RIVULET_SCATTER.mass


def onset(diameter: float, exponent: float) -> float:
    """Of the sample case's inclination, with the rivulet of one exponent, m/s."""
    rivulet = usual_rivulet(diameter)
    one = {name: np.ones(1) for name in NAMES} | {SIZE: np.array([exponent])}
    mass = rivulet.mass * factors_at(one, diameter)["rivulet.mass"]
    model = paper_model().with_parameters(
        {"section.diameter": diameter, "rivulet.mass": rivulet.mass, "rivulet.height": rivulet.height}
    )
    found = upper_rivulets(model, {"lift slope": np.ones(1)}, np.zeros(1)).onset
    return float(wind_speed_normal(model, found, mass[:, None])[0, 0])


@given(st.floats(0.05, 0.4))
def test_the_onset_between_one_size_and_one_shape(diameter: float) -> None:
    """8 m/s at 0.1 m and 45 degrees (section 4.1). U² ~ m_R r / d²: sqrt(d) in proportion, 1/sqrt(d) in one size."""
    for exponent, power in ((0.0, -0.5), (1.0, 0.0), (2.0, 0.5)):
        assert onset(diameter, exponent) == pytest.approx(8.0 * (diameter / 0.1) ** power, rel=1e-3)


@given(st.floats(0.05, 0.4), st.floats(0.0, 2.0))
def test_friction_goes_with_the_contacts_width_and_the_lever(diameter: float, exponent: float) -> None:
    """Width with the root of the area, so d^(e/2); lever squared d²."""
    one = {name: np.ones(1) for name in NAMES} | {SIZE: np.array([exponent])}
    found = usual_rivulet(diameter).friction * factors_at(one, diameter)["rivulet.friction"][0]
    assert found == pytest.approx(0.05 * (diameter / 0.1) ** (2.0 + exponent / 2), rel=1e-12)


def test_a_rivulet_that_is_given_has_no_exponent() -> None:
    samples = sample_factors(RIVULET_SCATTER, 8, 1)
    given_, here = factors_at(samples, None), factors_at(samples, 0.2)
    assert tuple(given_) == tuple(here) == NAMES
    assert np.array_equal(given_["rivulet.mass"], samples["rivulet.mass"])
    assert not np.allclose(here["rivulet.mass"], samples["rivulet.mass"])
    assert np.array_equal(factors_at(samples, 0.1)["rivulet.mass"], samples["rivulet.mass"])


def test_samples_have_the_scatter_asked_for() -> None:
    found = sample_factors(Scatter(0.4, 0.7, 0.2, 0.1, 0.3, 1.0), 4000, 3)
    assert tuple(found) == (*NAMES, SIZE)
    assert (found[SIZE].min(), found[SIZE].max()) == pytest.approx((0.0, 2.0), abs=0.001)
    assert np.mean(found[SIZE] < 0.5) == pytest.approx(0.25, abs=0.001)
    assert np.std(np.log(found["rivulet.mass"])) == pytest.approx(0.4, rel=0.01)
    assert np.std(np.log(found["rivulet.friction"])) == pytest.approx(0.7, rel=0.01)
    assert np.median(found["rivulet.mass"]) == pytest.approx(1.0, abs=0.005)
    for name, wide in zip(NAMES[2:], (0.2, 0.1, 0.3), strict=True):
        assert np.mean(found[name]) == pytest.approx(1.0, abs=0.01)
        assert np.std(found[name]) == pytest.approx(wide, rel=0.02)
    correlation = np.corrcoef(np.array(list(found.values())))
    assert np.abs(correlation - np.eye(6)).max() < 0.06


def test_ninety_per_cent_of_the_masses_lie_within_a_factor_of_two() -> None:
    mass = sample_factors(RIVULET_SCATTER, 2000, 1)["rivulet.mass"]
    assert np.mean((mass > 0.5) & (mass < 2.0)) == pytest.approx(0.9, abs=0.002)


def test_no_scatter_is_the_rule_itself_and_slopes_keep_their_sign() -> None:
    assert all(np.all(v == 1.0) for v in sample_factors(Scatter(0, 0, 0, 0, 0, 0), 5, 1).values())
    assert min(v.min() for v in sample_factors(Scatter(0, 0, 2, 2, 2, 0), 500, 1).values()) >= 0.1


def test_the_same_seed_gives_the_same_samples() -> None:
    a, b, c = (sample_factors(RIVULET_SCATTER, 8, seed) for seed in (1, 1, 2))
    assert all(np.array_equal(a[name], b[name]) for name in NAMES)
    assert not np.array_equal(a["rivulet.mass"], c["rivulet.mass"])


@pytest.mark.parametrize("diameter", [0.0, -0.1, float("nan"), "0.1"])
def test_a_diameter_that_is_none_is_refused(diameter) -> None:
    with pytest.raises(InputError, match="diameter"):
        usual_rivulet(diameter)


@pytest.mark.parametrize(("count", "seed"), [(0, 1), (2.0, 1), (True, 1), (5, -1), (5, "1")])
def test_counts_and_seeds_that_are_none_are_refused(count, seed) -> None:
    with pytest.raises(InputError, match="whole number"):
        sample_factors(RIVULET_SCATTER, count, seed)


def test_a_scatter_in_per_cent_is_refused() -> None:
    with pytest.raises(InputError, match=r"0\.2 means 20 %"):
        Scatter(20.0, 0.1, 0.1, 0.1, 0.1, 1.0)


def test_rivulets_are_those_of_the_physics() -> None:
    assert isinstance(usual_rivulet(0.2), Rivulet)
