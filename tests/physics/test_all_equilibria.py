"""All equilibria: against a dense scan, in the paper's order, at folds and in degenerate cases."""

from math import degrees, pi, sin

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from rainwind.errors import InputError
from rainwind.physics import CoefficientSet, load_coefficients, paper_model
from rainwind.physics.spring import rest_positions

SETS = ("reconstructed", "reconstructed-cubic", "reconstructed-linear")
MANY = CoefficientSet(
    "many", "made up for this test", "artificial", (-pi, pi),
    lift="sin(alpha)", drag="1.1", moment="0.08*sin(7*alpha + 0.3) + 0.05*cos(2*alpha)",
)  # fmt: skip


def scanned_angles(model, p, low, high):
    """Roots of the rivulet's static balance by a scan of 40 000 steps, without `letters` and intervals."""
    delta, gamma = p["section.inclination"], p["wind.yaw"]
    u_squared = p["wind.speed"] ** 2 * (np.cos(gamma) ** 2 + np.sin(gamma) ** 2 * np.sin(delta) ** 2)
    beta = np.arctan2(np.sin(gamma) * np.sin(delta), np.cos(gamma))
    r = (p["section.diameter"] + p["rivulet.height"]) / 2

    def balance(phi):
        c_m = model.coefficients.at(-phi, model.outside)[2]
        wind = p["wind.density"] / 2 * p["section.diameter"] ** 2 * u_squared * c_m
        return wind + p["rivulet.mass"] * r * 9.81 * np.cos(delta) * np.sin(phi + beta)

    grid = np.linspace(low, high, 40_001)
    values = balance(grid)
    places = np.flatnonzero(values[:-1] * values[1:] < 0)
    return [float(brentq(balance, grid[i], grid[i + 1], xtol=1e-14)) for i in places]


def assert_rest(model, p, states):
    """The right-hand side vanishes, relative to the terms that cancel in it."""
    for x in states:
        rates = np.array(model.rhs(tuple(x), p))
        stiff = p["section.mass"] * (2 * pi * p["section.frequency_y"]) ** 2
        loads = abs(x[0]) * stiff + p["wind.density"] * p["wind.speed"] ** 2 + 1.0
        r = (p["section.diameter"] + p["rivulet.height"]) / 2
        moments = p["wind.density"] * p["wind.speed"] ** 2 * 0.01 + p["rivulet.mass"] * r * 9.81
        angular = moments / (p["rivulet.mass"] * r**2)
        assert np.max(np.abs(rates)) < 1e-10 * (loads / p["section.mass"] + angular), x


CHANGES = st.fixed_dictionaries(
    {
        "wind.speed": st.floats(0.5, 30),
        "wind.yaw": st.floats(-3.1, 3.1),
        "wind.density": st.sampled_from([0.0, 1.225, 1.3]),
        "section.inclination": st.floats(0.05, 1.5),
        "section.diameter": st.floats(0.05, 0.3),
        "rivulet.mass": st.floats(0.01, 1.0),
        "section.k3_y": st.sampled_from([0.0, 0.00115, -300.0, 900.0]),
        "section.k2_y": st.sampled_from([0.0, 0.0077, 200.0]),
    }
)


@settings(max_examples=60, deadline=None)
@given(CHANGES, st.sampled_from([*SETS, MANY]), st.sampled_from(["blend", "extend"]), st.sampled_from([2, 3]))
@example({"wind.speed": 25.0}, MANY, "extend", 3)
def test_every_equilibrium_of_a_dense_scan_is_found_and_no_other(changes, coefficients, outside, freedoms):
    if coefficients is MANY:
        outside = "extend"
    if changes.get("section.k3_y") == 0.0:
        # a quadratic spring may hold no position at all
        changes = {**changes, "section.k2_y": 0.0}
    model = paper_model(coefficients, outside, degrees_of_freedom=freedoms)
    p = {**model.parameters, **changes}
    found = model.all_states(changes)
    assert_rest(model, p, found.states)
    assert np.all(np.diff(found.states[:, 1]) >= 0)
    low, high = (-pi / 2, 1.5 * pi) if outside == "blend" else (-pi, pi)
    # a root on the window's edge may show at either end of it: the tests of still air look there
    within = (found.states[:, 1] > low + 1e-6) & (found.states[:, 1] < high - 1e-6)
    angles = np.unique(found.states[within, 1])
    scanned = scanned_angles(model, p, low + 1e-6, high - 1e-6)
    for phi in scanned:
        assert np.min(np.abs(angles - phi), initial=9.0) < 1e-8
    if found.certified:
        close_pairs = np.sum(np.diff(angles) < (high - low) / 40_000)
        assert len(angles) - 2 * close_pairs <= len(scanned) <= len(angles)


@pytest.mark.parametrize(("speed", "count"), [(5.0, 2), (7.9, 2), (8.1, 4), (9.0, 4), (12.0, 4), (20.0, 4)])
def test_two_equilibria_below_eight_metres_per_second_and_four_above(speed, count):
    """Section 4.1 of the paper (targets T1, T2)."""
    found = paper_model().all_states({"wind.speed": speed})
    assert found.certified
    assert len(found) == count


def test_order_and_angles_at_nine_metres_per_second():
    """B < D < C < A; D about 45° (section 4.3), 44.6° with this set by AUTO-07p."""
    b, d, c, a = np.degrees(paper_model().all_states().states[:, 1])
    assert b == pytest.approx(-5.7, abs=0.5)
    assert d == pytest.approx(44.6, abs=0.05)
    assert d < c < 90
    assert 181 < a < 187


@pytest.mark.parametrize(("speed", "angle"), [(5.0, 181.0), (12.0, 187.0)])
def test_the_lower_rivulet_is_moved_leeward(speed, angle):
    """Reading notes on the blend: A comes at 181° (5 m/s) to 187° (12 m/s)."""
    assert degrees(paper_model().all_states({"wind.speed": speed})[-1][1]) == pytest.approx(angle, abs=0.5)


def test_fold_of_the_default_set():
    """AUTO-07p: 7.997 m/s (data/reconstructed.toml); two more equilibria above."""
    model = paper_model(outside="extend")
    low, high = 7.9, 8.1
    while high - low > 1e-7:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if len(model.all_states({"wind.speed": middle})) == 1 else (low, middle)
    assert low == pytest.approx(7.9970, abs=5e-4)
    near = model.all_states({"wind.speed": high + 1e-6})
    assert near.certified
    assert len(near) == 3


def test_a_double_root_is_reported():
    """C_M = q (cos(alpha + 1) - 1): at alpha = -1 a double root where the weight vanishes (upright cable)."""
    twofold = CoefficientSet("twofold", "test", "artificial", (-pi, pi), 0.1, 1.0, "cos(alpha + 1) - 1")
    found = paper_model(twofold, "extend").all_states({"section.inclination": pi / 2})
    assert not found.certified
    ((name, low, high),) = found.unresolved
    assert name == "phi"
    assert low <= 1.0 <= high
    assert high - low < 1e-4


def test_a_balance_that_vanishes_everywhere_is_reported():
    found = paper_model().all_states({"section.inclination": pi / 2, "wind.density": 0.0})
    assert len(found) == 0
    ((name, low, high),) = found.unresolved
    assert name == "phi"
    assert high - low == pytest.approx(2 * pi)


def test_a_balance_that_vanishes_on_a_part_of_the_circle():
    """erf(60 (cos alpha + 0.5)) - 1 is zero to rounding where cos alpha is well above -0.5."""
    part = CoefficientSet("part", "test", "artificial", (-pi, pi), 0.1, 1.0, "erf(60*(cos(alpha) + 0.5)) - 1")
    found = paper_model(part, "extend").all_states({"section.inclination": pi / 2})
    assert any(high - low > 2.0 for _, low, high in found.unresolved)


@pytest.mark.parametrize("outside", ["blend", "extend"])
def test_still_air_leaves_top_and_bottom(outside):
    found = paper_model(outside=outside).all_states({"wind.density": 0.0})
    assert found.certified
    np.testing.assert_allclose(found.states[:, 1], [0.0, pi], atol=1e-12)


def test_beyond_ninety_degrees_of_yaw_the_weight_follows():
    found = paper_model().all_states({"wind.density": 0.0, "wind.yaw": 2.5})
    beta = np.arctan2(np.sin(2.5) * np.sin(pi / 4), np.cos(2.5))
    np.testing.assert_allclose(np.sin(found.states[:, 1] + beta), 0.0, atol=1e-12)
    assert len(found) == 2


def test_a_constant_moment():
    flat = CoefficientSet("flat", "test", "artificial", (-pi, pi), 0.1, 1.0, 0.02)
    model = paper_model(flat, "extend")
    found = model.all_states()
    lever = 0.2 * 0.055 * 9.81 * np.cos(pi / 4)
    np.testing.assert_allclose(
        np.sin(found.states[:, 1]), -0.5 * 1.225 * 0.01 * 81 * 0.02 / lever, rtol=1e-12
    )
    assert len(found) == 2


def test_refused_states_are_left_out():
    """Below the fold nothing is left; above it C and D."""
    model = paper_model(outside="refuse")
    assert len(model.all_states({"wind.speed": 7.0})) == 0
    found = model.all_states({"wind.speed": 9.0})
    assert len(found) == 2
    assert all(model.refusal(x, model.parameters) is None for x in found)


def test_softening_springs_have_three_positions_each():
    model = paper_model().with_parameters({"section.k3_y": -500.0, "section.k3_z": -1000.0})
    found = model.all_states()
    assert len(found) == 4 * 9
    assert_rest(model, model.parameters, found.states)


def test_a_load_beyond_a_softening_springs_strength_leaves_no_equilibrium():
    """k y + k2 y² is at least -k²/(4 k2): with k2 = 1e7 N/m³ it is -0.097 N; B and C pull up by more."""
    found = paper_model().all_states({"section.k2_y": 1e7, "section.k3_y": 0.0})
    k = 50 * (2 * pi) ** 2
    for phi in paper_model().all_states().states[:, 1]:
        c_l = paper_model().coefficients.at(-phi)[0]
        force = -0.5 * 1.225 * 0.1 * 81 * c_l
        count = np.sum(np.abs(found.states[:, 1] - phi) < 1e-12)
        assert count == (2 if force > -(k**2) / 4e7 else 0)
    assert 0 < len(found) < 8


def test_equilibria_read_like_an_array():
    found = paper_model().all_states()
    np.testing.assert_array_equal(np.asarray(found), found.states)
    assert [x[1] for x in found] == list(found[:, 1])
    assert found.names == paper_model().states


def test_unknown_parameters_are_refused():
    with pytest.raises(InputError, match=r"no parameter 'wind\.sped'.*Did you mean 'wind\.speed'"):
        paper_model().all_states({"wind.sped": 3.0})


@given(
    st.lists(st.floats(-9, 9), min_size=2, max_size=2),
    st.floats(0.1, 50.0).map(lambda x: x if x > 1 else -x),
    st.floats(0.5, 3.0),
)
def test_cubic_with_three_known_roots(roots, k3, scale):
    """k3 (y - a)(y - b)(y - c) with c so that k > 0; the roots are a, b, c."""
    a, b = roots
    c = a * b + scale if k3 > 0 else 0.0
    k = k3 * (a * b + b * c + a * c)
    known = sorted([a, b, c])
    if k <= 1e-3 or min(np.diff(known)) < 1e-2:
        return
    found, doubles = rest_positions(k, -k3 * (a + b + c), k3, k3 * a * b * c)
    assert not doubles
    np.testing.assert_allclose(found, known, rtol=1e-9, atol=1e-9 * max(1, abs(c)))


@pytest.mark.parametrize(
    ("k", "k2", "k3", "force", "expected"),
    [
        (2.0, 0.0, 0.0, 3.0, [1.5]),
        (2.0, 1.0, 0.0, 3.0, [-3.0, 1.0]),
        (2.0, -1.0, 0.0, -3.0, [-1.0, 3.0]),
        (2.0, 1.0, 0.0, -3.0, []),
        (1.0, 0.0, 1.0, 0.0, [0.0]),
        (1.0, 0.0, -1.0, 0.0, [-1.0, 0.0, 1.0]),
        (6.0, -5.0, 1.0, 0.0, [0.0, 2.0, 3.0]),
        (2000.0, 0.0, 1e-300, 1000.0, [0.5]),
    ],
)
def test_springs_with_known_positions(k, k2, k3, force, expected):
    found, doubles = rest_positions(k, k2, k3, force)
    assert not doubles
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_a_spring_at_its_snap_through_reports_the_double_root():
    """y - y² = 1/4 has the double root 1/2."""
    assert rest_positions(1.0, -1.0, 0.0, 0.25) == ([0.5], [0.5])
    model = paper_model().with_parameters({"section.k2_z": -4000.0, "section.k3_z": 0.0, "wind.density": 0.0})
    assert model.all_states().certified


def test_a_set_without_moment_makes_no_model():
    with pytest.raises(InputError, match=r"no moment curve.*with_moment_of"):
        paper_model(load_coefficients("gu-lu-2001-lift-drag"))


def test_the_weight_alone_gives_the_sine():
    """At 1e-3 m/s the wind is nothing: B at the top, A at the bottom."""
    found = paper_model().all_states({"wind.speed": 1e-3})
    assert [abs(sin(x[1])) < 1e-6 for x in found] == [True, True]
