"""The shorter elimination for states whose rate is another state, against the elimination of everything."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.kernels import collocation, kinematic
from rainwind.dynamics.orbit_equations import OrbitEquations


def pendulum(x, p):
    """Two of five: x' = v and z' = v share a rate; v' and the others are anything."""
    return (
        x["v"],
        -p.a * rw.sin(x["x"]) - x["v"] * x["u"],
        x["v"],
        x["u"] * x["x"] - p.b,
        x["z"] ** 2 + p.a * x["u"],
    )


def jerk(x, p):
    """A chain x' = v, v' = w: v is a rate and has one, so that only v is held by w."""
    return (x["x1"], x["x2"], -x["x0"] * p.a - p.b * x["x2"] + x["x1"] ** 2)


SYSTEMS = {
    "shared rate": (rw.System(pendulum, ("x", "v", "z", "u", "y"), {"a": 1.3, "b": 0.4}), [1, -1, 1, -1, -1]),
    "chain": (rw.System(jerk, ("x0", "x1", "x2"), {"a": 0.7, "b": 0.2}), [-1, 2, -1]),
    "rivulet": (rw.paper_model(outside="extend"), [3, 4, 5, -1, -1, -1]),
    "rivulet, two degrees of freedom": (rw.paper_model(degrees_of_freedom=2), [2, 3, -1, -1]),
}  # fmt: skip


def somewhere(model, mesh):
    """The equations of a system at a profile that solves nothing, on an uneven grid."""
    system = rw.dynamics.system.as_system(model)
    rng, n = np.random.default_rng(3), len(system.states)
    grid = Grid(np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 1.5, mesh.intervals))]), mesh.degree)
    grid = Grid(grid.times / grid.times[-1], mesh.degree)
    along = tuple(system.parameters)[:2]
    problem = OrbitEquations(system, along, grid, np.ones(n), 1.0, np.ones(2))
    x = 0.3 * np.sin(2 * np.pi * grid.nodes[:, None] + rng.normal(size=n)) + 0.02 * rng.normal(
        size=(grid.nodes.size, n)
    )
    return problem, np.concatenate([x.ravel(), [1.7], [system.parameters[name] for name in along]])


@pytest.mark.parametrize("degree", [2, 4, 7])
@pytest.mark.parametrize("name", SYSTEMS)
def test_it_finds_what_the_whole_elimination_finds(name, degree):
    model, expected = SYSTEMS[name]
    problem, u = somewhere(model, Mesh(7, degree))
    rates = kinematic.rates_of(problem.tape[0][2])
    assert rates.tolist() == expected
    at, defect, basis, h = problem.linearise(u), problem.defects(u), problem.grid.basis, problem.grid.lengths
    steps, factors, orders, sign = kinematic.condense(
        rates, basis.values, basis.slopes, h, u[problem.profile_size], at.f, at.by, defect
    )
    size = np.abs(at.steps).max()
    np.testing.assert_allclose(steps, at.steps, rtol=0.0, atol=1e-11 * size)
    assert sign == at.sign
    other = np.random.default_rng(1).normal(size=defect.shape)
    expected = np.empty_like(other)
    collocation.solve_inside_once(at.factors, at.orders, -other, expected)
    kinematic.solve_again(
        rates, basis.values, basis.slopes, h, u[problem.profile_size], at.by, factors, orders, other, steps
    )
    np.testing.assert_allclose(steps[:, :, -1], expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())
    np.testing.assert_allclose(steps[:, :, :-1], at.steps[:, :, :-1], rtol=0.0, atol=1e-11 * size)
