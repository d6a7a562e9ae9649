"""The oracle itself: its equations against answers found by hand, AUTO against the stored reference.

The stored points are checked everywhere; what needs AUTO-07p is skipped where it is not installed.
"""

from __future__ import annotations

import json
from math import cos, pi, sin

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.optimize import minimize_scalar

from .auto_runner import Auto, auto_directory
from .make_reference import REFERENCE
from .refined_orbit import explicit_flow, gauss_flow, multipliers_by_iteration, multipliers_by_product, refine
from .sample_case import (
    EQUATIONS,
    EQUILIBRIA,
    FOLD_CURVE,
    ORBIT_BRANCH,
    Equations,
    backward,
    fold_and_hopf_points,
    tight,
)

pytestmark = pytest.mark.validation
needs_auto = pytest.mark.skipif(auto_directory() is None, reason="AUTO-07p or gfortran is not installed")

# the set "reconstructed", and m_R r g cos(delta): moments per metre of cable
LIFT = Polynomial([1.31724, 13.22028, 21.9629, 10.78773, 0.89058])
DRAG = Polynomial([1.77928, 5.2367, 7.17321, 1.7873, -0.47775])
MOMENT = Polynomial([0.043, -0.19821, -0.74154, -0.19402, 0.14268])
WEIGHT = 0.2 * 0.055 * 9.81 * cos(pi / 4)


@pytest.fixture(scope="module")
def reference():
    return json.loads(REFERENCE.read_text())


@pytest.fixture(scope="module")
def auto(tmp_path_factory):
    return Auto(EQUATIONS, tmp_path_factory.mktemp("auto"))


def by_name(points, name):
    (point,) = (p for p in points if p["name"] == name)
    return point


def speed_of_balance(phi):
    """The wind speed at which the rivulet rests at phi, from row three of eq. (4)."""
    return np.sqrt(-WEIGHT * sin(phi) / (1.225 / 2 * 0.1**2 * MOMENT(-phi)))


def test_the_fold_is_the_least_speed_of_the_rivulets_balance(reference):
    least = minimize_scalar(speed_of_balance, bounds=(0.9, 1.1), method="bounded", options={"xatol": 1e-10})
    fold = by_name(reference["points"]["equilibria"], "fold")
    assert fold["speed"] == pytest.approx(least.fun, abs=1e-9)
    assert fold["state"][1] == pytest.approx(least.x, abs=1e-6)


def test_every_stored_equilibrium_balances_the_rivulet(reference):
    for name, points in reference["points"].items():
        for p in points if name != "orbits" else []:
            phi = p["state"][1]
            wind = 1.225 / 2 * p["speed"] ** 2 * 0.1**2 * MOMENT(-phi)
            # the terms are about 0.07 N; eleven digits of phi leave a few 1e-11
            assert wind + WEIGHT * sin(phi) == pytest.approx(0, abs=2e-10)


def test_hopf_points_have_one_imaginary_pair_and_the_hopf_hopf_point_two(reference):
    def imaginary(p):
        return sum(abs(real) < 1e-10 and abs(imag) > 1 for real, imag in p["eigenvalues"])

    equilibria = reference["points"]["equilibria"]
    assert [imaginary(p) for p in equilibria if p["auto_label"] == "HB"] == [2, 2]
    assert imaginary(by_name(reference["points"]["hopf_curve"], "HH")) == 4


def test_stored_cycles_keep_what_every_cycle_keeps(reference):
    """One multiplier is 1, their product is exp of the integral of the trace (Liouville), two solutions agree."""
    cycles = reference["orbits"]["cycles"]
    assert sorted(c["speed"] for c in cycles) == [9, 10, 12, 12, 12, 13, 14]
    for c in cycles:
        multipliers = np.array([complex(*m) for m in c["multipliers"]])
        assert min(abs(multipliers - 1)) < 1e-12
        assert np.log(abs(multipliers)).sum() == pytest.approx(c["integral_of_trace"], abs=1e-10)
        assert max(c["agreement"][key] for key in ("period", "state", "multipliers_relative")) < 1e-10
        # AUTO prints 6 digits, and its tiny ones are rounding
        for printed in (complex(*m) for m in c["auto"]["multipliers"]):
            if abs(printed) > 1e-4:
                assert min(abs(multipliers - printed)) < 2e-5 * abs(printed)


def test_stored_labels_are_where_a_multiplier_crosses(reference):
    for branch in reference["orbits"]["branches"]:
        for label in branch["labels"]:
            polished = label["polished"]
            multipliers = np.array([complex(*m) for m in polished["multipliers"]])
            if label["name"] == "lpc":
                # a double 1: it splits like the root of rounding
                assert np.sort(abs(multipliers - 1))[1] < 3e-6
            else:
                assert abs(polished["critical_abs_minus_1"]) < 1e-9
            before, after = label["unstable_before_after"]
            assert abs(before - after) == {"lpc": 1, "pd": 1, "ns": 2}[label["name"]]
            # AUTO locates a PD less well where another multiplier is 3e7 (0.02 %, 24.86 m/s)
            large = max(abs(multipliers)) > 1e7
            assert abs(polished.get("from_auto", {"speed": 0.0})["speed"]) < (5e-7 if large else 1e-8)


@needs_auto
def test_two_ways_to_the_same_cycle(auto, reference):
    """The cycle at 14 m/s from AUTO's branch, at AUTO's default tolerances: polished, it is the stored one."""
    _, on_d, _ = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
    (point,) = auto.run(ORBIT_BRANCH | {"UZR": {1: [14.0]}, "NMX": 120}, on_d).points("UZ")
    (stored,) = (c for c in reference["orbits"]["cycles"] if c["speed"] == 14.0)
    first = refine(Equations(auto), point, explicit_flow, speed=14.0, segments=60)
    second = refine(Equations(auto), point, gauss_flow, speed=14.0, segments=60)
    expected = np.array(stored["log_abs_multipliers"])
    for orbit, multipliers in (
        (first, multipliers_by_product(first)),
        (second, multipliers_by_iteration(second)),
    ):
        assert orbit.period == pytest.approx(stored["period"], abs=1e-12)
        assert np.log(abs(multipliers)) == pytest.approx(expected, abs=1e-9)
        assert (orbit.maxima - orbit.minima) / 2 == pytest.approx(
            list(stored["half_peak_to_peak"].values()), abs=1e-11
        )


@needs_auto
def test_jacobian_against_central_differences(auto):
    equations = Equations(auto)
    x, speed, xi, h = np.array([0.1, 0.7, -0.2, 0.4, -1.1, 0.3]), 9.3, 0.002, 1e-6
    _, by_state, by_parameter = equations(x, speed, xi)

    def slope(plus, minus):
        return (equations(*plus)[0] - equations(*minus)[0]) / (2 * h)

    columns = [slope((x + h * e, speed, xi), (x - h * e, speed, xi)) for e in np.eye(6)]
    assert np.stack(columns, axis=1) == pytest.approx(by_state, rel=1e-6, abs=1e-6)
    assert slope((x, speed + h, xi), (x, speed - h, xi)) == pytest.approx(
        by_parameter[:, 0], rel=1e-6, abs=1e-6
    )
    assert slope((x, speed, xi + h), (x, speed, xi - h)) == pytest.approx(
        by_parameter[:, 1], rel=1e-6, abs=1e-6
    )


@needs_auto
def test_accelerations_satisfy_equation_4(auto):
    """The equations of motion as printed, left sides and right, at the accelerations from the Fortran."""
    y, phi, z, vy, w, vz = x = np.array([0.1, 0.7, -0.2, 0.4, -1.1, 0.3])
    speed, xi, r, m_r, m_s = 9.3, 0.002, 0.055, 0.2, 50.0
    (_, _, _, ay, aw, az), _, _ = Equations(auto)(x, speed, xi)
    v = np.arctan2(vy + r * w * sin(phi), speed - vz + r * w * cos(phi))
    alpha, q = -phi + v, 1.225 / 2 * 0.1 * speed**2
    f_y = -q * (LIFT(alpha) * cos(v) + DRAG(alpha) * sin(v))
    f_z = q * (-LIFT(alpha) * sin(v) + DRAG(alpha) * cos(v))
    damper, k = 2 * xi * m_s * 2 * pi, m_s * (2 * pi) ** 2
    left_y = (m_s + m_r) * ay + damper * vy + k * y + 0.0077 * y**2 + 0.00115 * y**3
    left_y += m_r * r * (sin(phi) * aw + cos(phi) * w**2)
    left_z = (m_s + m_r) * az + damper * vz + k * z + 0.00115 * z**3
    left_z += m_r * r * (-cos(phi) * aw + sin(phi) * w**2)
    left_phi = m_r * r**2 * aw + 0.05 * w - WEIGHT * sin(phi)
    left_phi += m_r * r * (sin(phi) * ay - cos(phi) * az)
    assert [left_y, left_z, left_phi] == pytest.approx([f_y, f_z, q * 0.1 * MOMENT(alpha)], abs=1e-9)


@needs_auto
def test_auto_finds_the_stored_fold_and_hopf_points(auto, reference):
    points = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
    for point, name in zip(points, ("fold", "Hopf on D", "Hopf on C"), strict=True):
        stored = by_name(reference["points"]["equilibria"], name)
        assert point.parameters[0] == pytest.approx(stored["speed"], abs=1e-8)
        assert point.state == pytest.approx(np.array(stored["state"]), abs=1e-7)


@needs_auto
def test_restart_and_spectrum(auto):
    """A fold curve towards less damping: the fold stays where it is, with one zero eigenvalue."""
    fold, _, _ = fold_and_hopf_points(auto.run(tight(EQUILIBRIA)))
    curve = auto.run(backward(tight(FOLD_CURVE)), fold)
    assert curve.constants["IRS"] == fold.label
    assert curve.table[:, curve.columns.index("U")] == pytest.approx(
        np.full(len(curve.table), fold.parameters[0])
    )
    assert min(abs(curve.spectrum(len(curve.table)))) < 1e-8


@needs_auto
def test_timing_counts_the_points_and_contains_autos_own_time(auto):
    timing = auto.time(EQUILIBRIA | {"NMX": 50}, repeats=3)
    assert timing.points == 50
    assert timing.wall_best <= timing.wall_median
    assert timing.reported_median < timing.wall_median
