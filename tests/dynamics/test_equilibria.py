"""Finding equilibria: each once, and an honest word on whether these are all."""

import numpy as np

import rainwind as rw

CUBIC = rw.System(lambda x, p: [p.m * x.x - x.x**3], ("x",), {"m": 1.0})


def roots(parameters):
    m = parameters["m"]
    return [[0.0], [np.sqrt(m)], [-np.sqrt(m)]] if m > 0 else [[0.0]]


def test_a_list_from_starts_claims_nothing():
    found = rw.find_equilibria(CUBIC, starts=[[x] for x in np.linspace(-2, 2, 9)])
    assert sorted(round(e["x"], 9) for e in found) == [-1, 0, 1]
    assert not found.complete
    assert "others" in found.note


def test_a_system_that_lists_its_equilibria_is_believed():
    system = rw.System(CUBIC.rhs, ("x",), {"m": 4.0}, all_states=roots)
    found = rw.find_equilibria(system)
    assert [e["x"] for e in found] == [0, 2, -2]
    assert found.complete
    assert found[1:] == (found[1], found[2])


def test_a_root_listed_twice_is_no_complete_list():
    system = rw.System(CUBIC.rhs, ("x",), {"m": 4.0}, all_states=lambda p: [*roots(p), [2.0]])
    found = rw.find_equilibria(system)
    assert len(found) == 3
    assert not found.complete


def test_the_rivulet_models_equilibria_are_certified():
    found = rw.find_equilibria(rw.paper_model())
    assert len(found) == 4
    assert found.complete


def test_an_exact_root_with_a_singular_jacobian_stands():
    """Newton cannot move there, and need not."""
    assert rw.find_equilibrium(CUBIC.with_parameters({"m": 0.0}), [0.0]).residual == 0


def test_parameters_may_be_arrays():
    x, m = np.zeros((3, 1)), np.array([1.0, 2.0, 3.0])
    assert CUBIC.jacobian(x, {"m": m})[:, 0, 0].tolist() == [1, 2, 3]


def test_a_walk_by_hand_goes_until_told_to_stop():
    fold = rw.System(lambda x, p: [p.m - x.x**2], ("x",), {"m": 1.0})
    seen = []
    for point in rw.walk_equilibria(fold, "m", start=[1.0], until=(-1.0, 2.0), ds=0.1, upward=False):
        seen.append(point)
        if point["x"] < -0.5:
            break
    assert seen[0]["x"] == 1
    assert all(abs(p.parameters["m"] - p["x"] ** 2) < 1e-9 for p in seen)
    assert [p.stable for p in seen] == [p["x"] > 0 for p in seen]  # round the fold at 0


def test_a_walk_by_hand_ends_on_the_bound():
    *_, last = rw.walk_equilibria(CUBIC, "m", start=[1.0], until=(0.5, 3.0))
    assert last.parameters["m"] == 3.0
