"""The walk itself: where it goes, why it ends, what it keeps; on compiled and on plain problems."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import zoo
from rainwind.dynamics.continuation import Walk
from rainwind.dynamics.nodes import Node


class Circle:
    """u^2 + v^2 = 1, not compiled."""

    scale = np.ones(2)

    def correct(self, near, u, tangent):
        start, u = u, u.copy()
        for iteration in range(1, 11):
            f = np.array([u @ u - 1, tangent @ (u - start)])
            step = np.linalg.solve(np.array([2 * u, tangent]), -f)
            u = u + step
            if np.max(np.abs(step)) < 1e-12:
                new = np.array([-u[1], u[0]])
                return Node(u, new * np.sign(new @ tangent), iterations=iteration)
        return None


EAST = Node(np.array([1.0, 0.0]), np.array([0.0, 1.0]))


def test_a_plain_problem():
    nodes = []
    for node in Walk(Circle(), EAST, ds=0.05):
        nodes.append(node)
        if node.arclength > 6:
            break
    u = np.array([node.u for node in nodes])
    np.testing.assert_allclose(np.linalg.norm(u, axis=1), 1, atol=1e-12)
    angle = np.unwrap(np.arctan2(u[:, 1], u[:, 0]))
    arclength = np.array([node.arclength for node in nodes])
    assert np.all(np.diff(angle) > 0)
    np.testing.assert_allclose(angle, arclength, rtol=2e-3)  # tangents are a little shorter than arcs


def test_a_plain_problem_stops_at_its_bound():
    walk = Walk(Circle(), EAST, ds=0.1, window={1: (-0.5, 0.5)})
    last = list(walk)[-1]
    assert walk.ended is rw.Ended.AT_BOUND
    np.testing.assert_allclose(last.u, [np.sqrt(0.75), 0.5], atol=1e-12)


def test_a_plain_problem_whose_newton_fails():
    class Wall(Circle):
        def correct(self, near, u, tangent):
            return None if u[1] > 0.5 else super().correct(near, u, tangent)

    walk = Walk(Wall(), EAST, ds=0.1)
    nodes = list(walk)
    assert walk.ended is rw.Ended.STEP_TOO_SMALL
    assert nodes[-1].u[1] == pytest.approx(0.5, abs=1e-6)


CUSP = zoo.cusp()


def follow(system=CUSP.system, **changes):
    return rw.continue_equilibria(system, "b", **{"start": [-2.0], "until": CUSP.until, **changes})


def test_ends_lie_on_the_bounds():
    branch = follow()
    assert branch.ended == (rw.Ended.AT_BOUND, rw.Ended.AT_BOUND)
    assert branch.parameter[[0, -1]] == pytest.approx(CUSP.until, abs=1e-14)
    assert np.max(branch.residual) < 1e-8  # the walk's tolerance
    assert np.all(np.diff(branch.arclength) > 0)


def test_a_limit_keeps_the_points_before_it():
    branch = follow(limit=7)
    assert branch.ended[1] is rw.Ended.TOO_MANY_POINTS
    assert any(rw.Ended.TOO_MANY_POINTS.value in fault for fault in branch.audit())
    assert 7 <= len(branch) <= 200


def test_a_refusal_ends_the_branch_before_the_state():
    system = rw.System(
        CUSP.system.rhs,
        ("x",),
        CUSP.system.parameters,
        refusal=lambda state, parameters: "too far" if state[0] > 0.3 else None,
    )
    branch = follow(system)
    assert branch.ended == (rw.Ended.AT_BOUND, rw.Ended.REFUSED)
    assert np.max(branch["x"]) <= 0.3
    assert [p.kind for p in branch.points()] == ["fold"]


def test_an_interruption_keeps_the_points():
    def refusal(state, parameters):
        if state[0] > 0.3:
            raise KeyboardInterrupt

    branch = follow(rw.System(CUSP.system.rhs, ("x",), CUSP.system.parameters, refusal=refusal))
    assert rw.Ended.INTERRUPTED in branch.ended
    assert len(branch) > 20


def test_a_branch_that_runs_to_infinity_is_ended():
    system = rw.System(lambda x, p: [p.b * x.x - 1], ("x",), {"b": 1.0})
    branch = rw.continue_equilibria(system, "b", start=[1.0], until=(-1, 2), limit=200_000)
    assert branch.ended[0] in (rw.Ended.NOT_FINITE, rw.Ended.TOO_MANY_POINTS)
    assert branch.audit()
    np.testing.assert_allclose(branch["b"] * branch["x"], 1, rtol=1e-6)


def test_the_step_is_the_largest():
    for ds in (0.02, 0.3):
        assert np.max(np.diff(follow(ds=ds).arclength)) <= ds * (1 + 1e-12)
