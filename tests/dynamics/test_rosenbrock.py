"""The Rosenbrock method: its coefficients against the order conditions, its steps against stiff problems."""

from collections.abc import Iterator
from math import prod

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rainwind as rw
from rainwind.dynamics.kernels import rosenbrock as kernel
from rainwind.dynamics.system import as_system

# ---- the coefficients, in the form of Hairer & Wanner (1996), section IV.7: alpha, beta = alpha + Gamma, b
GAMMA = np.linalg.inv(np.eye(8) / kernel.GAMMA - np.pad(kernel.C, ((0, 0), (0, 1))))
ALPHA = np.pad(kernel.A, ((0, 0), (0, 1))) @ GAMMA
BETA = ALPHA + GAMMA
WEIGHTS = np.append(kernel.A[7], 1.0)  # of u_1 ... u_8 in the solution


def trees(order: int) -> Iterator[tuple]:
    """All rooted trees with so many nodes; a tree is the sorted tuple of its branches."""

    def forests(nodes: int, largest: tuple | None) -> Iterator[tuple]:
        if nodes == 0:
            yield ()
            return
        for size in range(nodes, 0, -1):
            for tree in trees(size):
                if largest is None or key(tree) <= key(largest):
                    for rest in forests(nodes - size, tree):
                        yield (tree, *rest)

    yield from forests(order - 1, None)


def key(tree: tuple) -> tuple:
    return (size(tree), tuple(map(key, tree)))


def size(tree: tuple) -> int:
    return 1 + sum(map(size, tree))


def density(tree: tuple) -> int:
    return size(tree) * prod(map(density, tree))


def elementary_weight(tree: tuple) -> np.ndarray:
    """Phi_j of HW (7.11'): nodes with one branch take beta, those with more take alpha."""
    if not tree:
        return np.ones(8)
    matrix = BETA if len(tree) == 1 else ALPHA
    return np.prod([matrix @ elementary_weight(branch) for branch in tree], axis=0)


ALL = [(order, tree) for order in range(1, 6) for tree in trees(order)]


def test_there_are_as_many_trees_as_there_should_be():
    assert [sum(order == k for order, _ in ALL) for k in range(1, 6)] == [1, 1, 2, 4, 9]


@pytest.mark.parametrize(("order", "tree"), ALL)
def test_order_five(order, tree):
    assert WEIGHTS @ GAMMA @ elementary_weight(tree) == pytest.approx(1 / density(tree), abs=2e-14)


@pytest.mark.parametrize(("order", "tree"), [one for one in ALL if one[0] <= 4])
def test_the_estimate_compares_with_order_four_and_the_polynomials_have_order_four(order, tree):
    weight = elementary_weight(tree)
    embedded = WEIGHTS.copy()
    embedded[7] = 0.0
    assert embedded @ GAMMA @ weight == pytest.approx(1 / density(tree), abs=2e-14)
    for s in (0.25, 0.7):
        k = kernel.H
        weights = s * (WEIGHTS + (1 - s) * (k[0] + s * (k[1] + s * k[2])))
        assert weights @ GAMMA @ weight == pytest.approx(s**order / density(tree), abs=2e-13)


def test_stages_in_time_are_row_sums():
    # the sums cancel terms that add up to 34, after an inverse with condition 2500
    assert pytest.approx(ALPHA.sum(axis=1), abs=1e-13) == kernel.NODES
    assert pytest.approx(GAMMA.sum(axis=1), abs=1e-13) == kernel.D


def stability(z):
    return 1 + z * (WEIGHTS @ GAMMA) @ np.linalg.solve(np.eye(8) - z * BETA, np.ones(8))


def test_l_stable():
    on_axis = [
        abs(stability(1j * y)) for y in np.concatenate([np.linspace(0, 50, 2001), np.geomspace(50, 1e6, 200)])
    ]
    assert max(on_axis) <= 1 + 1e-12
    assert abs(stability(-1e9)) < 1e-6
    # the stages are stiffly accurate: the solution is the last stage's
    assert pytest.approx(BETA[7], abs=1e-12) == (WEIGHTS @ GAMMA)


# ---- convergence


def test_errors_fall_with_the_fifth_power_of_the_step():
    """On a rotation whose speed depends on the radius: (cos t, sin t) from (1, 0)."""

    def rhs(x, p):
        square = x.u * x.u + x.v * x.v
        return -x.v * square, x.u * square

    steps, at_steps, between = [], [], []
    t = np.linspace(0.0, 20.0, 4001)
    for tolerance in (1e-6, 1e-11):
        system = rw.System(rhs, ("u", "v"))
        run = rw.simulate(system, [1.0, 0.0], duration=20.0, tolerance=tolerance, method="rosenbrock")
        steps.append(len(run))
        at_steps.append(np.abs(run["u"] - np.cos(run.times)).max())
        between.append(np.abs(run.at(t)[:, 0] - np.cos(t)).max())
    finer = np.log(steps[1] / steps[0])
    assert np.log(at_steps[0] / at_steps[1]) / finer == pytest.approx(5.0, abs=0.3)
    assert np.log(between[0] / between[1]) / finer > 4.6
    assert between[1] < 1e-9


@pytest.mark.parametrize("rate", [1.0, 1e5])
def test_a_driven_decay_keeps_its_order(rate):
    """x' = -k (x - u) + u' from x = u(0): x = u for a cubic u, whatever k."""
    u = rw.Signal(np.array([0.0, 1.0, 3.0]), np.array([[1.0, 2.0, -1.5, 0.4], [1.9, 0.2, 0.7, -0.3]]))
    slope = rw.Signal(u.knots, np.array([[2.0, -3.0, 1.2], [0.2, 1.4, -0.9]]))
    system = rw.System(lambda x, p: -p.k * (x.x - p.u) + p.v, ("x",), {"k": rate, "u": 0.0, "v": 0.0})
    run = rw.simulate(
        system, [1.0], duration=3.0, parameters={"u": u, "v": slope}, tolerance=1e-9, method="rosenbrock"
    )
    t = np.linspace(0.0, 3.0, 301)
    assert run.at(t)[:, 0] == pytest.approx(u.at(t), abs=1e-7)
    assert run.end[0] == pytest.approx(u.at(3.0), abs=1e-9)
    assert 1.0 in run.times


def test_a_ramp_has_its_closed_form():
    """x' = u - x, u = t up to t = 2, then 2."""
    system = rw.System(lambda x, p: p.u - x.x, ("x",), {"u": 0.0})
    run = rw.simulate(
        system, [1.0], duration=5.0, parameters={"u": rw.ramp(0, 2, 2)}, tolerance=1e-11, method="rosenbrock"
    )
    at_two = 2.0 - 1.0 + 2.0 * np.exp(-2.0)
    assert run.at(2.0)[0] == pytest.approx(at_two, abs=1e-10)
    assert run.end[0] == pytest.approx(2.0 + (at_two - 2.0) * np.exp(-3.0), abs=1e-10)


# ---- stiff problems


def van_der_pol(mu):
    return rw.System(lambda x, p: (x.v, p.mu * (1 - x.q**2) * x.v - x.q), ("q", "v"), {"mu": mu})


@pytest.mark.parametrize("mu", [1e3, 1e6])
def test_van_der_pol_as_radau_has_it(mu):
    run = rw.simulate(van_der_pol(mu), [2.0, 0.0], duration=1.5 * mu, tolerance=1e-10, method="rosenbrock")
    reference = solve_ivp(
        lambda t, x: [x[1], mu * (1 - x[0] ** 2) * x[1] - x[0]], (0, 1.5 * mu), [2.0, 0.0], method="Radau",
        jac=lambda t, x: [[0, 1], [-2 * mu * x[0] * x[1] - 1, mu * (1 - x[0] ** 2)]], rtol=1e-11, atol=1e-14,
    )  # fmt: skip
    assert run.end == pytest.approx(reference.y[:, -1], rel=3e-8)
    assert len(run) < 20_000


@pytest.mark.parametrize("rate", [1e3, 1e5, 1e8])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_between_the_steps_it_is_as_good_as_at_their_ends(rate, tolerance):
    """x' = -k (x - cos t) - sin t, so x = cos t + exp(-k t) / 2 from 1.5 (Prothero and Robinson's equation)."""
    system = rw.System(
        lambda x, p: (-p.k * (x.x - rw.cos(x.t)) - rw.sin(x.t), 1.0 + 0.0 * x.t), ("x", "t"), {"k": rate}
    )
    run = rw.simulate(system, [1.5, 0.0], duration=20.0, tolerance=tolerance, method="rosenbrock")
    share = np.linspace(0.0, 1.0, 21)[1:-1]
    t = (run.times[:-1, None] + np.diff(run.times)[:, None] * share).ravel()
    exact = np.cos(t) + 0.5 * np.exp(-rate * t)
    assert np.abs(run.at(t)[:, 0] - exact).max() < 5.0 * tolerance * 1.5
    assert np.abs(run["x"] - np.cos(run.times) - 0.5 * np.exp(-rate * run.times)).max() < 5.0 * tolerance
    assert len(run) < 40.0 * tolerance**-0.2 + 200  # steps as of a method of order 5, whatever the rate


def test_pieces_join_however_late_and_fast_a_jump_is():
    """Van der Pol's jumps last 1e-6 at t = 1e6: a ten-thousandth of them is what the clock can tell apart."""
    run = rw.simulate(van_der_pol(1e6), [2.0, 0.0], duration=2e6, tolerance=1e-9, method="rosenbrock")
    h = np.diff(run.times)
    ends = np.einsum("kij,kj->ki", run.pieces.coefficients, h[:, None] ** np.arange(5))
    gaps = np.abs(ends - run.state[1:]) / np.abs(run.state).max(axis=0)
    assert np.abs(run.state[:, 1]).max() > 1e6  # there was a jump
    assert gaps.max() < 1e-14


def test_robertson_over_eleven_decades():
    """Reference: Mazzia & Magherini, Test set for IVP solvers (2008), problem ROBER, at t = 1e11."""
    system = rw.System(
        lambda x, p: (
            -0.04 * x.a + 1e4 * x.b * x.c,
            0.04 * x.a - 1e4 * x.b * x.c - 3e7 * x.b * x.b,
            3e7 * x.b * x.b,
        ),
        ("a", "b", "c"),
    )
    run = rw.simulate(system, [1.0, 0.0, 0.0], duration=1e11, tolerance=1e-10, method="rosenbrock")
    known = [0.2083340149701255e-07, 0.8333360770334713e-13, 0.9999999791665050]
    assert run.end == pytest.approx(known, rel=1e-5)
    assert run.end[2] == pytest.approx(known[2], rel=1e-9)


def test_the_cable_with_a_light_rivulet():
    model = rw.paper_model(outside="extend").with_parameters({"rivulet.mass": 1e-4, "wind.speed": 12.0})
    system = as_system(model)
    start = np.array([0.05, 0.9, 0.0, 0.0, 0.0, 0.0])
    run = rw.simulate(model, start, duration=5.0, tolerance=1e-10, method="rosenbrock")
    reference = solve_ivp(
        lambda t, x: system.f(x), (0, 5.0), start, method="Radau", jac=lambda t, x: system.jacobian(x), rtol=1e-11,
        atol=1e-14,
    )  # fmt: skip
    assert run.end == pytest.approx(reference.y[:, -1], abs=1e-8)
    rate = np.abs(np.linalg.eigvals(system.jacobian(run.end))).max()
    assert rate * 5.0 / len(run) > 20.0  # steps far longer than an explicit method may take
