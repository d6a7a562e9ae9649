"""Wrong input is one clear message at the door: what was given, what is allowed, what to do."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import zoo
from rainwind.errors import ComputationError, InputError

BRUSSELATOR = zoo.brusselator().system
START = {"x": 1.0, "y": 0.5}
HOPF = rw.continue_equilibria(BRUSSELATOR, "b", start=START, until=(0.2, 5)).points("hopf")[0]
FOLD = rw.continue_equilibria(zoo.cusp().system, "b", start=[-2], until=(-5, 5)).points("fold")[0]
WINDOW = {"a": (0.1, 3.0), "b": (0.2, 8.0)}
NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"along": "c"}, "'c'.*Known|'c'"),
        ({"along": ["b"]}, "b"),
        ({"until": (8, 0.2)}, r"\(8, 0.2\): the first must be the smaller"),
        ({"until": (1, 1)}, "the first must be the smaller"),
        ({"until": (0.2, NAN)}, "upper bound of b must be a finite number; got nan"),
        ({"until": (-INF, 8)}, "lower bound of b must be a finite number; got -inf"),
        ({"until": ("0.2", "8")}, "lower bound of b must be a finite number; got '0.2'"),
        ({"until": 8}, r"two numbers \(low, high\); got 8"),
        ({"until": (1, 2, 3)}, r"two numbers \(low, high\); got \(1, 2, 3\)"),
        ({"until": (1, 2)}, r"start: b = 0.5 lies outside until = \(1, 2\)"),
        ({"start": {"q": 1}}, "'q'"),
        ({"start": {"x": NAN}}, "state 'x' must be a finite number; got nan"),
        ({"start": {"x": "one"}}, "state 'x' must be a finite number; got 'one'"),
        ({"start": [1.0]}, r"a state is 2 finite numbers \(x, y\)"),
        ({"start": [1.0, NAN]}, r"a state is 2 finite numbers \(x, y\)"),
        ({"start": "somewhere"}, r"a state is 2 finite numbers \(x, y\); got 'somewhere'"),
        ({"start": FOLD}, "start has the states x, the system has x, y"),
        ({"ds": 0}, "ds = 0: the step of arclength must be a positive number"),
        ({"ds": -0.1}, "ds = -0.1"),
        ({"ds": NAN}, "ds must be a finite number; got nan"),
        ({"ds": "small"}, "ds must be a finite number; got 'small'"),
        ({"limit": 0}, "limit = 0: at least one point"),
        ({"limit": "many"}, "limit must be a finite number; got 'many'"),
    ],
)
def test_continue_equilibria(changes, words):
    arguments = {"along": "b", "start": START, "until": (0.2, 8.0), **changes}
    along = arguments.pop("along")
    with pytest.raises(InputError, match=words):
        rw.continue_equilibria(BRUSSELATOR, along, **arguments)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"along": ("a", "a")}, "two different parameters"),
        ({"along": ("a",)}, "two different parameters"),
        ({"along": "a"}, "two different parameters"),
        ({"along": ("a", "c")}, "'c'"),
        ({"until": {"a": (0.1, 3)}}, "a window .* for each of a, b; got a"),
        ({"until": {**WINDOW, "c": (0, 1)}}, "'c'"),
        ({"until": (0.1, 3)}, "a window by name"),
        ({"until": {**WINDOW, "a": (3, 0.1)}}, "until for a = .*the first must be the smaller"),
        ({"until": {**WINDOW, "a": (1.5, 3)}}, r"start: a = 1 lies outside until = \(1.5, 3\)"),
        ({"start": FOLD}, r"continue_hopf starts from a special point \(hopf, gh, zh, hh\); got fold"),
        ({"start": START}, "continue_hopf starts from a special point .*; got dict"),
        ({"ds": -1}, "ds = -1"),
        ({"limit": -1}, "limit = -1"),
    ],
)
def test_continue_hopf(changes, words):
    arguments = {"along": ("a", "b"), "start": HOPF, "until": WINDOW, **changes}
    along = arguments.pop("along")
    with pytest.raises(InputError, match=words):
        rw.continue_hopf(BRUSSELATOR, along, **arguments)


def test_continue_fold_refuses_a_hopf_point_and_another_system():
    with pytest.raises(InputError, match=r"continue_fold starts from .* \(fold, cusp, bt, zh\); got hopf"):
        rw.continue_fold(BRUSSELATOR, ("a", "b"), start=HOPF, until=WINDOW)
    with pytest.raises(InputError, match="start has the states x, the system has x, y"):
        rw.continue_fold(BRUSSELATOR, ("a", "b"), start=FOLD, until=WINDOW)


def test_no_equilibrium_near_the_start():
    system = rw.System(lambda x, p: [x.x**2 + p.a], ("x",), {"a": 1.0})
    with pytest.raises(ComputationError, match="Newton found no equilibrium"):
        rw.find_equilibrium(system, [0.3])
    with pytest.raises(ComputationError, match=r"no equilibrium at a = 1 from .*; give another start"):
        rw.continue_equilibria(system, "a", start=[0.3], until=(-2, 2))


def test_a_system_that_cannot_list_its_equilibria():
    with pytest.raises(InputError, match=r"give starts=\[...\]"):
        rw.find_equilibria(BRUSSELATOR)
    with pytest.raises(InputError, match="2 finite numbers"):
        rw.find_equilibria(BRUSSELATOR, starts=[[1.0]])


@pytest.mark.parametrize(
    ("states", "parameters", "words"),
    [
        ((), {}, "at least one state"),
        (("x", "x"), {}, "x stand for more than one"),
        (("x",), {"x": 1.0}, "x stand for more than one"),
        (("x",), {"a": NAN}, "parameter 'a' must be a finite number; got nan"),
        (("x",), {"a": "1"}, "parameter 'a' must be a finite number; got '1'"),
        (("x",), {"a": True}, "parameter 'a' must be a finite number; got True"),
    ],
)
def test_system(states, parameters, words):
    with pytest.raises(InputError, match=words):
        rw.System(lambda x, p: [x[0]], states, parameters)


def test_changed_parameters():
    with pytest.raises(InputError, match="'c'"):
        BRUSSELATOR.with_parameters({"c": 1.0})
    with pytest.raises(InputError, match="changes go by name"):
        BRUSSELATOR.with_parameters(3.0)
    with pytest.raises(InputError, match=r"x must have shape \(..., 2\); got \(3,\)"):
        BRUSSELATOR.f(np.zeros(3))


def test_what_is_no_model():
    with pytest.raises(InputError, match="int is no model: it needs states, parameters and rhs"):
        rw.find_equilibrium(3)


def test_names_of_a_branch():
    branch = rw.continue_equilibria(BRUSSELATOR, "b", start=START, until=(0.2, 3))
    with pytest.raises(InputError, match="'hop'"):
        branch.points("hop")
    with pytest.raises(InputError, match="'q'"):
        branch["q"]
    with pytest.raises(InputError, match="no state or parameter 'q'"):
        branch.special[0]["q"]
