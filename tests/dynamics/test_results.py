"""What a branch answers: columns, pieces, places, extrema, audits."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import zoo
from rainwind.dynamics.results import Certificate, Ended, Unexplained, kind_of_equilibrium

CUSP = zoo.cusp()
BRANCH = rw.continue_equilibria(CUSP.system, "b", start=[-2.0], until=(-5, 5), ds=0.05)


def test_columns_by_name():
    np.testing.assert_array_equal(BRANCH["x"], BRANCH.state[:, 0])
    np.testing.assert_array_equal(BRANCH["b"], BRANCH.parameter)
    np.testing.assert_array_equal(BRANCH["a"], np.full(len(BRANCH), 3.0))
    np.testing.assert_allclose(BRANCH["b"], BRANCH["x"] ** 3 - 3 * BRANCH["x"], atol=1e-7)


def test_stability_changes_at_the_labels():
    np.testing.assert_array_equal(BRANCH.stable, np.abs(BRANCH["x"]) > 1)


def test_pieces_are_cut_at_the_labels():
    pieces = list(BRANCH.pieces("x", "b"))
    assert [unstable for unstable, _ in pieces] == [0, 1, 0]
    for (_, left), (_, right) in pairwise(pieces):
        assert left[0][-1] == right[0][0] == pytest.approx(np.sign(right[0][0]), abs=1e-8)
        assert abs(left[1][-1]) == pytest.approx(2, abs=1e-12)


def test_places_of_a_value():
    where = BRANCH.at("b", 0.5)
    assert len(where) == 3
    x = np.interp(where, BRANCH.arclength, BRANCH["x"])
    np.testing.assert_allclose(x**3 - 3 * x, 0.5, atol=1e-2)


def test_extrema():
    inside = BRANCH["b"][np.abs(BRANCH["x"]) < 1.5]
    assert inside.max() < 2.5
    loop = rw.continue_equilibria(zoo.closed_loop().system, "p", start=[1.0], until=(-3, 3), ds=0.1)
    assert loop.extremum("x") == pytest.approx(1, abs=1e-6)
    assert loop.extremum("p") == pytest.approx(1, abs=1e-4)
    assert loop.extremum("p", largest=False) == pytest.approx(-1, abs=1e-4)
    assert BRANCH.extremum("b") == 5


def test_a_special_point_tells_what_it_is():
    (hopf,) = rw.continue_equilibria(zoo.hopf().system, "mu", start=[0, 0], until=(-1, 1)).points()
    assert str(hopf).startswith("hopf at mu = ")
    assert hopf["x"] == 0
    assert hopf["omega"] == 2
    assert hopf.certificate.holds


def test_an_audit_tells_of_a_broken_certificate():
    point = replace(BRANCH.special[0], certificate=Certificate(0.0, {"trust": (1.0, 1e-6)}, {"margin": 2.0}))
    (fault,) = replace(BRANCH, special=(point,)).audit()
    assert "certificate does not hold: residual 0.0e+00; trust 1.0e+00 (<= 1e-06); margin 2" in fault


@pytest.mark.parametrize(
    ("eigenvalues", "words"),
    [
        ([-1, -2], "stable node"),
        ([-1 + 1j, -1 - 1j, -3], "stable focus"),
        ([1 + 1j, 1 - 1j, -3], "unstable focus"),
        ([1, -2], "saddle"),
        ([1, 2], "unstable node"),
        ([1 + 1j, 1 - 1j, 2, -1], "saddle-focus"),
    ],
)
def test_kinds_of_equilibrium(eigenvalues, words):
    assert kind_of_equilibrium(np.array(eigenvalues, complex)) == words


def test_all_equilibria_from_starts():
    system = CUSP.system.with_parameters({"b": 0.5})
    found = rw.find_equilibria(system, starts=[[x] for x in np.linspace(-3, 3, 25)])
    assert len(found) == 3
    roots = np.sort(np.roots([-1, 0, 3, 0.5]).real)
    np.testing.assert_allclose(sorted(e["x"] for e in found), roots, rtol=1e-12)
    assert [e.stable for e in sorted(found, key=lambda e: e["x"])] == [True, False, True]


def test_a_column_that_is_not_there_names_all_that_are():
    with pytest.raises(rw.RainwindError) as error:
        BRANCH["zz"]
    known = str(error.value).split("Known: ")[1].split(", ")
    assert all(len(BRANCH[name]) == len(BRANCH) for name in known)
    assert {"a", "b", "x"} == set(known)
    circle = zoo.hopf()
    (start,) = rw.continue_equilibria(circle.system, "mu", start=[0, 0], until=(-1, 1)).points()
    orbits = rw.continue_orbits(
        circle.system,
        "mu",
        start=start,
        until=(-1, 1),
        ds=0.5,
        monitors=[rw.Monitor("size", lambda orbit: orbit.amplitude["x"])],
    )
    with pytest.raises(rw.RainwindError) as error:
        orbits["zz"]
    known = str(error.value).split("Known: ")[1].split(", ")
    assert all(len(orbits[name]) == len(orbits) for name in known)
    assert {"mu", "period", "mesh_error", "x", "max y", "min x", "mean y", "size", "omega"} <= set(known)


def test_an_audit_says_where_to_look_with_digits_enough_to_begin_there():
    at = BRANCH.parameter[20]
    gap = Unexplained((0.123456789123, 0.2), ({"a": 3.0, "b": at}, {"a": 3.0, "b": at + 1e-7}), 1)
    (fault,) = replace(BRANCH, unexplained=(gap,)).audit()
    first, second = fault.split("between b = ")[1].split(", arclength ")[0].split(" and ")
    assert float(first) == pytest.approx(at, abs=1e-8)
    assert float(second) - float(first) == pytest.approx(1e-7, abs=1e-8)
    assert "arclength 0.1234567891 and 0.2" in fault
    assert "a = " not in fault
    ended = (Ended.AT_BOUND, Ended.STEP_TOO_SMALL)
    (fault,) = replace(BRANCH, ended=ended).audit()
    assert fault == f"Newton failed even at the smallest step, at b = {BRANCH.parameter[-1]:.10g}"
