"""Finding equilibria: each once, and an honest word on whether these are all."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.equations import Equations

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


def lorenz_84(x, p):
    x, y, z = x
    return (
        -(y**2) - z**2 - p.a * x + p.a * p.F,
        x * y - p.b * x * z - y + p.G,
        p.b * x * y + x * z - z,
    )


def test_newton_arrives_from_far_away():
    """Plain Newton comes home from 11 of 300 such guesses."""
    system = rw.System(lorenz_84, ("x", "y", "z"), {"a": 0.25, "b": 4.0, "F": 0.5, "G": 0.25})
    for guess in np.random.default_rng(0).uniform(-1, 1, (50, 3)):
        assert rw.find_equilibrium(system, guess).residual < 1e-12


def test_a_pole_before_the_bound_is_no_bound():
    """a x = 1 goes to infinity before a = 0."""
    system = rw.System(lambda x, p: [p.a * x.x - 1.0], ("x",), {"a": 1.0})
    branch = rw.continue_equilibria(system, "a", start=[1.0], until=(-1.0, 2.0))
    assert branch.ended[1] is rw.Ended.AT_BOUND
    assert branch.ended[0] in (rw.Ended.NOT_FINITE, rw.Ended.STEP_TOO_SMALL, rw.Ended.TOO_MANY_POINTS)
    assert branch["a"].min() > 0


def test_a_turn_near_the_start_is_not_the_start():
    """The S-shaped curve comes back beside its start, a thousandth of a unit away."""
    system = rw.System(lambda x, p: [p.r + 1e-6 * x.x - x.x**3], ("x",), {"r": 0.0})
    branch = rw.continue_equilibria(system, "r", start=[0.001], until=(-1e-9, 1e-9))
    assert branch.ended == (rw.Ended.AT_BOUND, rw.Ended.AT_BOUND)


@pytest.mark.parametrize(("name", "window"), [("wind.speed", (-5, 20)), ("rivulet.mass", (0, 1))])
def test_a_window_beyond_what_the_model_allows_is_refused(name, window):
    model = rw.paper_model()
    with pytest.raises(rw.RainwindError, match="leaves what the model allows"):
        rw.continue_equilibria(model, name, start=rw.find_equilibria(model)[1], until=window)


def test_a_walk_from_the_bound_has_no_point_twice():
    branch = rw.continue_equilibria(CUBIC, "m", start=[1.0], until=(0.5, 1.0))
    assert np.all(np.diff(branch.arclength) > 0)
    assert branch["m"][[0, -1]].tolist() == [0.5, 1.0]


def test_a_ctrl_c_inside_a_kernel_keeps_the_points(monkeypatch):
    """numba reports it as a SystemError whose cause is the KeyboardInterrupt."""
    march, calls = Equations.march, []

    def interrupted(*arguments):
        calls.append(1)
        if len(calls) == 2:
            raise SystemError(
                "CPUDispatcher returned a result with an exception set"
            ) from KeyboardInterrupt()
        return march(*arguments)

    monkeypatch.setattr(Equations, "march", interrupted)
    branch = rw.continue_equilibria(CUBIC, "m", start=[1.0], until=(0.5, 8.0))
    assert rw.Ended.INTERRUPTED in branch.ended
    assert len(branch) == 33
    assert len(calls) == 2  # the other direction is not walked any more


def test_results_print_in_a_line():
    branch = rw.continue_equilibria(CUBIC, "m", start=[1.0], until=(0.5, 8.0))
    assert len(repr(branch)) < 200
    assert "m = 0.5 ... 8" in repr(branch)
    assert repr(rw.find_equilibrium(CUBIC, [1.0])) == "<stable node at x = 1>"
