"""Curves of lpc, pd and ns of the cycle zoo: on their closed forms, with every codimension-two point at its place.

Meshes of 20 intervals of degree 4: places good to 1e-6, those of resonances, where multipliers meet, to 1e-5.
"""

from functools import cache
from math import pi

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import cycle_zoo
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.dynamics.results import Ended

ZOO = cycle_zoo.everything()
MESH = rw.Mesh(20)
CONTINUE = {"lpc": rw.continue_lpc, "pd": rw.continue_pd, "ns": rw.continue_ns}
CURVES = [(name, k) for name, known in ZOO.items() for k in range(len(known.curves))]
FINE = ("cusp", "bogdanov-takens", "fold-flip", "generalised doubling", "1:2, ns")  # in short steps too


@cache
def starts(name, kind):
    known = ZOO[name]
    start = find_orbit(known.system, known.start.at, period=known.start.period, mesh=MESH)
    branch = rw.continue_orbits(known.system, known.along, start=start, until=known.until, ds=0.3, mesh=MESH)
    return branch.points(kind)


@cache
def curve_of(name, number, ds, which=0):
    known = ZOO[name]
    curve = known.curves[number]
    start = starts(name, curve.kind)[which]
    return CONTINUE[curve.kind](known.system, curve.along, start=start, until=curve.until, ds=ds)


def assert_found(curve, answers, tolerance=1e-6):
    """The labels are the answers, as many and each at its place."""
    assert curve.audit() == []
    left = [point for point in curve.points() if point.kind != "gh"]  # where orbits vanish: a test of its own
    for answer in answers:
        loose = 1e-4 if answer.kind in ("r1", "r2", "foldflip") else tolerance
        near = [
            p
            for p in left
            if p.kind == answer.kind and all(abs(p.parameters[k] - v) < loose for k, v in answer.at.items())
        ]
        assert near, f"{answer} is missing among {[str(p) for p in left]}"
        left.remove(near[0])
        assert near[0].certificate.holds, str(near[0].certificate)
        if answer.kind in ("r3", "r4"):
            assert near[0].angle == pytest.approx(answer.angle, abs=1e-6)
            assert near[0].angle == pytest.approx({"r3": 2 * pi / 3, "r4": pi / 2}[answer.kind], abs=1e-6)
    assert not left, f"too many: {[str(p) for p in left]}"


@pytest.mark.parametrize(
    ("name", "number", "ds"),
    [(*curve, ds) for curve in CURVES for ds in (0.1, 0.3, 1.0) if ds > 0.1 or curve[0] in FINE],
)
def test_a_curve_is_its_closed_form_and_its_points_the_answers(name, number, ds):
    known = ZOO[name].curves[number]
    curve = curve_of(name, number, ds)
    assert curve.kind == known.kind
    assert curve.along == known.along
    assert_found(curve, known.answers)
    off = [abs(known.equation(orbit.parameters)) for orbit in curve]
    assert max(off) < 1e-6
    for name_of, (low, high) in known.until.items():
        values = curve[name_of]
        assert np.all((values > low - 1e-12) & (values < high + 1e-12))
    if not any(p.kind in ("r1", "r2") for p in curve.points()) and known.kind != "ns":
        assert set(curve.ended) <= {Ended.AT_BOUND, Ended.AT_HOPF, Ended.CLOSED}


@pytest.mark.parametrize(("name", "number"), CURVES)
def test_every_point_of_a_curve_has_its_multipliers_on_the_circle(name, number):
    """At an lpc a second multiplier is 1, at a pd one is -1, at an ns a pair has the modulus 1."""
    kind = ZOO[name].curves[number].kind
    for orbit in curve_of(name, number, 0.3)[::5]:
        exponents = orbit.exponents
        if kind == "lpc":
            assert np.abs(exponents).min() < 1e-6
        elif kind == "pd":
            assert np.abs(np.exp(exponents) + 1).min() < 1e-6
        else:
            pair = np.sort(np.abs(exponents.real))[:2]
            # where they have just met at angle 0 or pi they move like the root of the error
            assert pair.max() < 1e-3


@pytest.mark.parametrize(
    ("name", "number", "kind"),
    [("bogdanov-takens", 0, "r1"), ("1:2, ns", 0, "r2"), ("1:2, ns, flat", 0, "r2")],
)
def test_an_ns_curve_ends_in_a_resonance(name, number, kind):
    for ds in (0.1, 0.3, 1.0):
        curve = curve_of(name, number, ds)
        assert Ended.AT_RESONANCE in curve.ended
        (point,) = curve.points(kind)
        assert "extrapolated" in point.note
        assert point.arclength in (curve.arclength[0], pytest.approx(curve.arclength[-1]))


def test_the_lpc_curve_of_bautin_ends_at_the_generalised_hopf_point():
    """b1 = b2 = 0: the cycles on the curve, r^2 = b2 / 2, have shrunk to the equilibrium there."""
    for ds in (0.1, 0.3, 1.0):
        curve = curve_of("bautin", 0, ds)
        assert Ended.AT_HOPF in curve.ended
        assert curve["x"] == pytest.approx(np.sqrt(curve["b2"] / 2), abs=1e-6)
        assert curve["b2"].min() < 0.1
        (point,) = curve.points()
        assert point.kind == "gh"
        assert "extrapolated" in point.note
        assert point.certificate.holds
        assert [point["b1"], point["b2"]] == pytest.approx([0.0, 0.0], abs=1e-6)


def test_both_folds_of_a_branch_lie_on_one_curve():
    """The cusp's curve passes its cpc and reaches the other fold; so does the isola's, without any label."""
    for name in ("cusp", "isola", "cusp from hopf"):
        known = ZOO[name]
        first, last = starts(name, "lpc")
        for which, other in ((0, last), (1, first)):
            curve = curve_of(name, 0, 0.3, which)
            second = known.curves[0].along[1]
            passes = np.abs(curve[known.curves[0].along[0]] - other.parameters[known.curves[0].along[0]])
            held = np.abs(curve[second] - other.parameters[second])
            assert np.min(passes + held) < 0.2
            assert_found(curve, known.curves[0].answers)


@pytest.mark.parametrize(
    ("name", "number", "kind"),
    [("cusp", 0, "cpc"), ("generalised doubling", 0, "gpd"), ("chenciner", 0, "ch"), ("1:2, ns", 0, "r4")],
)
def test_a_curve_goes_on_from_its_own_points(name, number, kind):
    known = ZOO[name].curves[number]
    point = next(p for p in curve_of(name, number, 0.3).points() if p.kind == kind)
    again = CONTINUE[known.kind](ZOO[name].system, known.along, start=point, until=known.until, ds=0.3)
    assert again.audit() == []
    assert max(abs(known.equation(orbit.parameters)) for orbit in again) < 1e-6
    assert len(again) > 10


@pytest.mark.parametrize("name", ["bogdanov-takens", "1:2, ns"])
def test_the_angle_along_an_ns_curve(name):
    """sqrt(-b2) T, or pi - sqrt(q) T, in closed form."""
    curve = curve_of(name, 0, 0.3)
    for orbit in curve[3:-3:4]:
        p = orbit.parameters
        exact = (
            np.sqrt(-p["b2"]) * 2 * pi / p["carrier"]
            if name == "bogdanov-takens"
            else pi - np.sqrt(p["q"]) * cycle_zoo.twisted.PERIOD
        )
        pair = orbit.exponents[np.argmin(np.abs(orbit.exponents.real) + (orbit.exponents.imag <= 0))]
        assert pair.imag == pytest.approx(exact, abs=1e-6)


@pytest.mark.parametrize(("name", "number"), [("cusp", 0), ("generalised doubling", 0), ("brusselator", 0)])
def test_coordinates_do_not_matter(name, number):
    known, rng = ZOO[name], np.random.default_rng(3)
    n = len(known.system.states)
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0] @ np.diag(10 ** rng.uniform(-0.3, 0.3, n))
    hidden = cycle_zoo.disguised(known, turn, 0.15)
    mesh = rw.Mesh(30)
    start = find_orbit(hidden.system, hidden.start.at, period=hidden.start.period, mesh=mesh)
    branch = rw.continue_orbits(
        hidden.system, hidden.along, start=start, until=hidden.until, ds=0.3, mesh=mesh
    )
    curve = hidden.curves[number]
    found = CONTINUE[curve.kind](
        hidden.system, curve.along, start=branch.points(curve.kind)[0], until=curve.until, ds=0.3
    )
    assert_found(found, curve.answers)
    assert max(abs(curve.equation(orbit.parameters)) for orbit in found) < 1e-6


def test_on_another_mesh():
    known = ZOO["fold-flip"]
    curve = known.curves[0]
    start = starts("fold-flip", "lpc")[0]
    found = rw.continue_lpc(
        known.system, curve.along, start=start, until=curve.until, ds=0.5, mesh=rw.Mesh(15, 5)
    )
    assert found[0].grid.degree == 5
    assert_found(found, curve.answers)
