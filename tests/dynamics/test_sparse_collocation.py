"""The sparse operator against the condensed chain, and against derivatives of the equations themselves."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.collocation import Grid, Mesh
from rainwind.dynamics.kernels import chain
from rainwind.dynamics.orbit_equations import OrbitEquations
from rainwind.dynamics.sparse_collocation import bordered, factored, newton_step, operator

RNG = np.random.default_rng(7)


def uneven(intervals, degree):
    even = Grid.even(Mesh(intervals, degree))
    return Grid(even.times + 0.04 * np.sin(2 * np.pi * even.times), degree)


def stiff_system():
    """A circle of period 1 that drives growth by 10^3 and decay by 10^-40 per period."""

    def rhs(x, p):
        radial = 1 - x.c**2 - x.s**2
        return (
            radial * x.c - 2 * np.pi * x.s,
            2 * np.pi * x.c + radial * x.s,
            6.9 * x.up + p.drive * x.c,
            -92.0 * x.down + p.drive * x.s,
        )

    return rw.System(rhs, ("c", "s", "up", "down"), {"drive": 1.0})


def wave(grid, size):
    """A smooth closed profile near, but not on, a solution."""
    t = 2 * np.pi * grid.nodes[:, None]
    k = np.arange(size)
    return size * (np.cos(t + 0.4 * k) + 0.3 * np.sin(2 * t + k))


def paper(grid):
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 9.0})
    units = np.array([0.1, 0.3, 0.1, 0.6, 2.0, 0.6])
    problem = OrbitEquations(
        rw.dynamics.system.as_system(model), ("wind.speed",), grid, units, 1.0, np.ones(1)
    )
    profile = np.array([0.0, 0.9, 0.0, 0.0, 0.0, 0.0]) + 0.2 * wave(grid, 6) / 6 * units
    return problem, np.concatenate([profile.ravel(), [0.97, 9.0]])


def stiff(grid):
    problem = OrbitEquations(stiff_system(), ("drive",), grid, np.ones(4), 1.0, np.ones(1))
    profile = 0.3 * wave(grid, 4)
    return problem, np.concatenate([profile.ravel(), [1.0, 1.0]])


@pytest.mark.parametrize("case", [paper, stiff])
def test_its_newton_step_is_that_of_the_condensed_chain(case):
    problem, u = case(uneven(23, 4))
    x, period, _ = problem.parts(u)
    rows = np.zeros((2, problem.profile_size))
    rows[0] = problem.phase_row(x, x)
    rows[1] = RNG.normal(size=problem.profile_size)
    corner, right = RNG.normal(size=(2, 2)), RNG.normal(size=(2, 3))
    corner[0] = 0.0
    at = problem.linearise(u)
    expected, expected_lam, *_ = chain.solve_periodic(at.steps, rows, corner, right)
    found, lam = newton_step(at, problem.grid, period, problem.defects(u), rows, corner, right)
    assert found.shape == expected.shape
    scale = np.abs(expected).max(axis=(0, 1))
    assert np.abs(found - expected).max(axis=(0, 1)) == pytest.approx(0 * scale, abs=1e-10 * scale.min())
    assert lam == pytest.approx(expected_lam, rel=1e-10, abs=1e-10)


def test_its_null_vectors_are_the_floquet_modes():
    """x' = rate x has the mode exp(rate t): null vector of the operator for rate = 2 pi i only."""
    grid = uneven(12, 8)
    mode = np.exp(2j * np.pi * grid.nodes)[:, None] * np.array([1.0, -1j])
    for rate, apart in ((2.0 * np.pi, 0.0), (2.0 * np.pi + 0.1, 0.1)):
        j = np.array([[0.0, -rate], [rate, 0.0]]) / 1.3
        matrix = operator(grid, np.tile(j, (12 * 8, 1, 1)), 1.3)
        assert np.abs(matrix @ mode.ravel()).max() == pytest.approx(apart, abs=1e-10, rel=0.2)


def test_it_is_the_derivative_of_the_equations():
    problem, u = paper(uneven(9, 3))
    v = wave(problem.grid, 6).ravel() * 1e-3
    matrix = operator(problem.grid, problem.linearise(u).by[:, :, :6], u[-2])
    step = np.append(v, [0.0, 0.0])
    difference = (problem.defects(u + 1e-4 * step) - problem.defects(u - 1e-4 * step)).ravel() / 2e-4
    assert (matrix @ v)[:-6] == pytest.approx(difference, rel=1e-6, abs=1e-7 * np.abs(difference).max())
    assert (matrix @ v)[-6:] == pytest.approx(v[-6:] - v[:6], abs=1e-15)


def test_a_singular_system_gives_no_numbers():
    problem, u = stiff(uneven(5, 3))
    at = problem.linearise(u)
    rows, corner, right = np.zeros((2, problem.profile_size)), np.zeros((2, 2)), np.zeros((2, 1))
    x, lam = newton_step(at, problem.grid, 1.0, problem.defects(u), rows, corner, right)
    assert np.isnan(x).all()
    assert np.isnan(lam).all()


def test_borders_stand_where_they_should():
    matrix = operator(uneven(4, 2), np.zeros((8, 1, 1)), 1.0)
    k = matrix.shape[0]
    whole = bordered(matrix, np.full((k, 1), 2.0), np.full((1, k), 3.0), [[5.0]]).toarray()
    assert whole[:-1, -1].tolist() == [2.0] * k
    assert whole[-1].tolist() == [3.0] * k + [5.0]
    assert factored(bordered(matrix, np.ones((k, 1)), np.ones((1, k)), [[0.0]])) is not None
