"""Coefficient sets: the blend, the shipped files, sets put together."""

from dataclasses import replace
from math import cos, pi, radians, tanh

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rainwind.physics import CoefficientSet, load_coefficients, paper_model, shipped_sets

WITH_MOMENT = ("reconstructed", "reconstructed-cubic", "reconstructed-linear")
SET = load_coefficients("reconstructed")


def complete(name):
    coefficients = load_coefficients(name)
    return coefficients if coefficients.moment else coefficients.with_moment_of(SET)


def test_the_four_sets_are_shipped():
    assert set(shipped_sets()) == {*WITH_MOMENT, "gu-lu-2001-lift-drag"}


@pytest.mark.parametrize("name", shipped_sets())
def test_shipped_sets_carry_their_own_name_and_say_that_they_are_not_measured(name):
    coefficients = load_coefficients(name)
    assert coefficients.name == name
    assert coefficients.status in ("reconstructed", "unverified")
    assert coefficients.blend is not None


def test_values_of_the_default_set_at_minus_one_rad():
    """By hand from the file's numbers: 1.31724 - 13.22028 + 21.9629 - 10.78773 + 0.89058 and so on."""
    assert SET.at(-1.0, "extend") == pytest.approx((0.16271, 1.45074, -0.16363), abs=1e-12)


@pytest.mark.parametrize("name", shipped_sets())
def test_blend_changes_less_than_a_ten_thousandth_inside_the_valid_range(name):
    coefficients = complete(name)
    alpha = np.linspace(*coefficients.valid, 4001)
    blended, raw = (np.array(coefficients.at(alpha, outside)) for outside in ("blend", "extend"))
    change = np.max(np.abs(blended - raw))
    assert 0 < change < 1e-4


@pytest.mark.parametrize("name", shipped_sets())
def test_half_point_of_the_blend_lies_12_degrees_outside_each_edge(name):
    coefficients = complete(name)
    low, high = coefficients.valid
    for alpha in (low - radians(12), high + radians(12)):
        w, angle = coefficients.usable_blend.weight_and_angle(alpha)
        assert w == pytest.approx(0.5, abs=1e-12)
        assert angle == pytest.approx(alpha, abs=1e-12)


def test_blend_is_the_formula_of_its_docstring():
    for alpha in np.linspace(-pi, pi, 41):
        theta = (alpha + pi / 4 + pi) % (2 * pi) - pi
        w = 0.5 * (1 + tanh((cos(theta) - cos(radians(57))) / 0.03))
        inside = SET.at(theta - pi / 4, "extend")
        bare = (0.0, 1.2, -0.01 * cos(alpha))
        expected = [b + w * (c - b) for b, c in zip(bare, inside, strict=True)]
        np.testing.assert_allclose(SET.at(float(alpha)), expected, rtol=0, atol=1e-12)


@given(st.floats(-pi, pi), st.integers(-4, 4))
def test_blend_is_periodic(alpha, turns):
    np.testing.assert_allclose(SET.at(alpha + 2 * pi * turns), SET.at(alpha), rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", shipped_sets())
def test_blend_ends_in_the_bare_cylinder_and_never_runs_away(name):
    c_l, c_d, c_m = complete(name).at(np.linspace(-pi, pi, 5001))
    assert max(np.max(np.abs(c)) for c in (c_l, c_d, c_m)) < 5
    alpha = complete(name).usable_blend.centre + pi
    assert complete(name).at(alpha) == pytest.approx((0.0, 1.2, -0.01 * cos(alpha)), abs=1e-14)


def test_blend_is_smooth_across_its_cut():
    """Analytic: Chebyshev-like convergence of its Fourier series, with no floor from a jump."""
    c_l, c_d, c_m = SET.at(np.linspace(0, 2 * pi, 4096, endpoint=False))
    for c in (c_l, c_d, c_m):
        spectrum = np.abs(np.fft.rfft(c)) / len(c)
        assert spectrum[800:].max() < 1e-13


def test_arrays_and_numbers_give_the_same():
    alpha = np.linspace(-4, 4, 37).reshape(1, 37)
    for outside in ("blend", "extend"):
        for index, c in enumerate(SET.at(alpha, outside)):
            assert c.shape == alpha.shape
            assert c[0, 5] == pytest.approx(SET.at(float(alpha[0, 5]), outside)[index], abs=1e-13)
        np.testing.assert_array_equal(SET.moment_at(alpha, outside), SET.at(alpha, outside)[2])


def test_moment_of_another_set():
    gu_lu = load_coefficients("gu-lu-2001-lift-drag")
    joined = gu_lu.with_moment_of(SET)
    assert joined.name == "gu-lu-2001-lift-drag + moment of reconstructed"
    assert gu_lu.source in joined.source
    assert SET.source in joined.source
    assert (joined.lift, joined.drag, joined.moment) == (gu_lu.lift, gu_lu.drag, SET.moment)
    assert joined.valid == gu_lu.valid
    paper_model(joined)


def test_moment_of_another_set_is_valid_only_where_both_are():
    wide = CoefficientSet("wide", "test", "artificial", (-1.2, 0.3), [0.1], [1.0], None)
    narrow = CoefficientSet("narrow", "test", "artificial", (-2.0, -0.4), [0.1], [1.0], [0.5, 0.1])
    joined = wide.with_moment_of(narrow)
    assert joined.valid == (-1.2, -0.4)
    w, _ = joined.usable_blend.weight_and_angle(-0.4 + radians(12))
    assert w == pytest.approx(0.5, abs=1e-12)


def test_default_blend_is_as_good_as_the_shipped_one():
    plain = replace(SET, blend=None)
    alpha = np.linspace(*SET.valid, 1001)
    assert np.max(np.abs(np.array(plain.at(alpha)) - np.array(plain.at(alpha, "extend")))) < 1e-4


def test_covers_is_the_closed_valid_range():
    assert SET.covers(-pi / 2)
    assert SET.covers(0.0)
    assert not SET.covers(0.001)
    assert not SET.covers(-0.5 - 2 * pi)


def test_refusal_names_angle_range_and_source():
    model = paper_model(outside="refuse")
    inside, below = (0, 0.8, 0, 0, 0, 0), (0, 2.0, 0, 0, 0, 0)
    assert model.refusal(inside, model.parameters) is None
    message = model.refusal(below, model.parameters)
    assert "-2 rad" in message
    assert "[-1.571, 0]" in message
    assert "'reconstructed'" in message
    assert paper_model().refusal(below, model.parameters) is None


def test_refusal_sees_the_velocities():
    model = paper_model(outside="refuse")
    assert model.refusal((0, 0.1, 0, 5.0, 0, 0), model.parameters) is not None
    assert model.refusal((0, 0.1, 0, float("nan"), 0, 0), model.parameters) is not None


def test_structure_tells_different_equations_apart():
    model = paper_model()
    others = [
        paper_model(outside="extend"),
        paper_model("reconstructed-cubic"),
        paper_model(degrees_of_freedom=2),
        replace(model, angle="linear"),
        replace(model, relative_speed="full"),
        replace(model, section=replace(model.section, damping_ratio_y=0.002)),
        replace(model, section=replace(model.section, damping_ratio_z=0.002)),
    ]
    assert len({model.structure, *(other.structure for other in others)}) == 8
    assert model.with_parameters({"wind.speed": 12.0}).structure == model.structure
