"""The kernels of collocation against dense linear algebra, the polynomials against functions, orders of convergence."""

import numpy as np
import pytest

from rainwind.dynamics import cycle_zoo
from rainwind.dynamics.collocation import Grid, Mesh, basis
from rainwind.dynamics.kernels import chain
from rainwind.dynamics.kernels import collocation as kernel
from rainwind.dynamics.nodes import Node
from rainwind.dynamics.orbit_conditions import condition, slope_by_angle, slopes, start_borders
from rainwind.dynamics.orbit_equations import OrbitEquations
from rainwind.dynamics.orbits import first_node
from rainwind.errors import InputError

ZOO = cycle_zoo.everything()
# intervals, degree, states, parameters
SIZES = [(1, 2, 1, 0), (1, 3, 2, 1), (2, 2, 3, 1), (2, 4, 1, 2), (3, 4, 2, 1), (7, 3, 4, 2), (12, 2, 5, 0)]


class Problem:
    """Random linearised equations at a random profile, and the same as one dense matrix over all unknowns.

    Unknowns: x at all N m + 1 nodes, then T and p. Rows: collocation, interval by interval, then x_N - x_0 = 0.
    """

    def __init__(self, many, m, n, q, seed=0):
        rng = np.random.default_rng([seed, many, m, n, q])
        self.many, self.m, self.n, self.q, self.rng = many, m, n, q, rng
        self.w, self.d = basis(m).values, basis(m).slopes
        self.h = rng.uniform(0.5, 1.5, many)
        self.h /= self.h.sum()
        self.x = rng.normal(size=(many * m + 1, n))
        self.period, self.f = 1.7, rng.normal(size=(many * m, n))
        self.by = rng.normal(size=(many * m, n, n + q))
        self.steps, self.factors, self.orders, self.sign = kernel.condense(
            self.w, self.d, self.h, self.x, self.period, self.f, self.by
        )

    @property
    def c(self):
        return 1 + self.q

    def dense(self):
        many, m, n = self.many, self.m, self.n
        size = (many * m + 1) * n
        matrix = np.zeros((size, size + self.c))
        for j in range(many):
            for i in range(m):
                point = j * m + i
                rows = slice(point * n, (point + 1) * n)
                for k in range(m + 1):
                    node = slice((j * m + k) * n, (j * m + k + 1) * n)
                    jacobian = self.period * self.by[point, :, :n]
                    matrix[rows, node] = self.d[i, k] / self.h[j] * np.eye(n) - self.w[i, k] * jacobian
                matrix[rows, size] = -self.f[point]
                matrix[rows, size + 1 :] = -self.period * self.by[point, :, n:]
        matrix[-n:, :n], matrix[-n:, size - n : size] = -np.eye(n), np.eye(n)
        return matrix

    def defects(self):
        matrix = self.dense()
        # but for T f itself, the equations are the linear operator without its Jacobians
        derivative = np.zeros((self.many * self.m, self.n))
        for j in range(self.many):
            nodes = self.x[j * self.m : (j + 1) * self.m + 1]
            derivative[j * self.m : (j + 1) * self.m] = self.d @ nodes / self.h[j]
        assert matrix.shape[0] == derivative.size + self.n
        return (derivative - self.period * self.f).ravel()

    def inside(self, j):
        """The dense matrix of one interval in its nodes 1 ... m."""
        m, n = self.m, self.n
        return self.dense()[j * m * n : (j + 1) * m * n, (j * m + 1) * n : ((j + 1) * m + 1) * n]


@pytest.mark.parametrize("sizes", SIZES)
def test_condensed_steps_solve_the_equations_of_each_interval(sizes):
    problem = Problem(*sizes)
    matrix, right, n, m = problem.dense(), -problem.defects(), problem.n, problem.m
    rng = np.random.default_rng(1)
    for j in range(problem.many):
        first, lam = rng.normal(size=n), rng.normal(size=problem.c)
        inner = problem.steps[j] @ np.concatenate([first, lam, [1.0]])
        rows = slice(j * m * n, (j + 1) * m * n)
        nodes = slice(j * m * n, ((j + 1) * m + 1) * n)
        left = matrix[rows, nodes] @ np.concatenate([first, inner]) + matrix[rows, -problem.c :] @ lam
        np.testing.assert_allclose(left, right[rows], atol=1e-10 * (1 + np.abs(inner).max()))


@pytest.mark.parametrize("sizes", SIZES)
def test_more_right_hand_sides_and_the_transposed_equations(sizes):
    problem = Problem(*sizes)
    right = np.random.default_rng(2).normal(size=(problem.many, problem.m * problem.n, 3))
    found = np.empty_like(right)
    kernel.solve_inside(problem.factors, problem.orders, right, found)
    transposed = kernel.solve_inside_transposed(problem.factors, problem.orders, right)
    signs = []
    for j in range(problem.many):
        a = problem.inside(j)
        np.testing.assert_allclose(a @ found[j], right[j], atol=1e-10 * (1 + np.abs(found[j]).max()))
        np.testing.assert_allclose(a.T @ transposed[j], right[j], atol=1e-9 * (1 + np.abs(transposed).max()))
        signs.append(np.linalg.slogdet(a)[0])
    assert problem.sign == np.prod(signs)


@pytest.mark.parametrize("sizes", SIZES)
def test_the_periodic_problem_solved_by_the_chain_is_the_dense_one(sizes):
    problem = Problem(*sizes)
    c, size = problem.c, problem.x.size
    rng = np.random.default_rng(3)
    rows, corner, right = rng.normal(size=(c, size)), rng.normal(size=(c, c)), rng.normal(size=(c, 3))
    x, lam, sign, _ = chain.solve_periodic(problem.steps, rows, corner, right)
    whole = np.vstack([problem.dense(), np.hstack([rows, corner])])
    below = np.vstack([np.zeros((size, 3)), right])
    below[: size - problem.n, 0] = -problem.defects()
    expected = np.linalg.solve(whole, below)
    scale = np.abs(expected).max() * np.linalg.cond(whole) * 1e-14
    np.testing.assert_allclose(x.reshape(size, 3), expected[:size], atol=scale)
    np.testing.assert_allclose(lam, expected[size:], atol=scale)
    # the sign of the determinant but for a factor that depends on the sizes alone: see the next test
    assert abs(sign) == 1.0


@pytest.mark.parametrize("sizes", SIZES)
def test_the_sign_follows_the_determinant(sizes):
    """Between any two problems of a size, the product of both signs changes exactly when the determinant's does."""
    seen = set()
    for seed in range(8):
        problem = Problem(*sizes, seed=seed)
        c, size = problem.c, problem.x.size
        rows, corner = problem.rng.normal(size=(c, size)), problem.rng.normal(size=(c, c))
        _, _, sign, _ = chain.solve_periodic(problem.steps, rows, corner, np.zeros((c, 1)))
        whole = np.vstack([problem.dense(), np.hstack([rows, corner])])
        seen.add(float(sign * problem.sign * np.linalg.slogdet(whole)[0]))
    assert len(seen) == 1


@pytest.mark.parametrize("sizes", SIZES)
def test_the_reduced_chain_holds_for_every_solution_of_the_chain(sizes):
    problem = Problem(*sizes)
    n, c, many = problem.n, problem.c, problem.many
    ends, tops, elimination, sign = chain.reduce_chain(problem.steps, n)
    rng = np.random.default_rng(4)
    lam = rng.normal(size=c)
    x = [rng.normal(size=n)]
    for step in problem.steps[:, -n:]:
        x.append(step @ np.concatenate([x[-1], lam, [1.0]]))
    scale = 1e-10 * np.abs(x).max()
    p, q, d = ends[:, :n], ends[:, n : 2 * n], ends[:, 2 * n :]
    np.testing.assert_allclose(p @ x[0] + q @ x[-1], d @ np.append(lam, 1.0), atol=scale)
    right = tops[:, :, 3 * n + c]
    first, last = (np.ascontiguousarray(v[:, None]) for v in (x[0], x[-1]))
    between = chain.mesh_points(tops, np.ascontiguousarray(right[:, :, None]), first, last, lam[:, None])
    np.testing.assert_allclose(between[:, :, 0], x, atol=1e-8 * np.abs(x).max())
    factors, orders = elimination
    assert factors.shape == (many - 1, 2 * n, n)
    assert orders.shape == (many - 1, 2 * n)
    # the chain's rows, seen as equations for x_1 ... x_N, have the determinant 1
    assert sign == np.linalg.slogdet(q)[0]


@pytest.mark.parametrize("sizes", SIZES)
def test_multipliers_of_the_chain_s_rows_are_the_adjoint_of_its_reduction(sizes):
    """What the ends' rows say, weighted, the chain's rows say with the multipliers found; all else cancels."""
    problem = Problem(*sizes)
    n, many = problem.n, problem.many
    ends, _, elimination, _ = chain.reduce_chain(problem.steps, n)
    weights = np.random.default_rng(5).normal(size=(n, 2))
    found = chain.multipliers_of_rows(elimination, weights)
    rows = np.zeros((many * n, (many + 1) * n))
    for j in range(many):
        rows[j * n : (j + 1) * n, j * n : (j + 1) * n] = -problem.steps[j, -n:, :n]
        rows[j * n : (j + 1) * n, (j + 1) * n : (j + 2) * n] = np.eye(n)
    scale = 1e-12 * np.abs(rows).max() * np.abs(found).max()
    total = found.reshape(many * n, 2).T @ rows
    np.testing.assert_allclose(total[:, :n], weights.T @ ends[:, :n], atol=scale)
    np.testing.assert_allclose(total[:, -n:], weights.T @ ends[:, n : 2 * n], atol=scale)
    np.testing.assert_allclose(total[:, n:-n], 0.0, atol=scale)
    above = problem.steps[:, -n:, n:].reshape(many * n, -1)
    np.testing.assert_allclose(
        found.reshape(many * n, 2).T @ above, weights.T @ ends[:, 2 * n :], atol=1e2 * scale
    )


def test_the_chain_survives_growth_and_decay_that_a_product_loses():
    """x -> G x + b with G = diag(1e8, 1e-8) in skew coordinates, 40 times: periodic only at G's fixed point."""
    many, n = 40, 2
    skew = np.array([[1.0, 0.4], [-0.3, 1.0]])
    rates = np.array([1e8, 1e-8])
    g = skew @ np.diag(rates) @ np.linalg.inv(skew)
    steps = np.zeros((many, n, n + 2))
    steps[:, :, :n] = g
    steps[:, :, -1] = skew.sum(axis=1)
    # the row holds lambda, which drives nothing, at zero
    x, lam, _, _ = chain.solve_periodic(steps, np.zeros((1, (many + 1) * n)), np.eye(1), np.zeros((1, 1)))
    fixed = skew @ (1.0 / (1.0 - rates))
    np.testing.assert_allclose(x[:, :, 0], np.tile(fixed, (many + 1, 1)), rtol=1e-7)
    assert lam == pytest.approx(0.0)


def test_a_chain_that_is_not_a_number_has_no_sign_and_reaches_no_foreign_memory():
    """Newton's iterates may be anything; the orders of a reduction that ended early are used as row numbers."""
    steps = np.full((5, 4, 4), np.nan)
    ends, _, elimination, sign = chain.reduce_chain(steps, 2)
    assert sign == 0.0
    assert np.all(np.isnan(ends))
    assert np.all((elimination[1] >= 0) & (elimination[1] < 4))
    assert chain.multipliers_of_rows(elimination, np.ones((2, 1))).shape == (5, 2, 1)


def test_a_singular_interval_gives_no_sign():
    a = np.array([[1.0, 2.0, 1.0], [2.0, 4.0, 1.0]])
    assert kernel.eliminate(a)[1] == 0.0
    assert kernel.eliminate(np.full((2, 3), np.nan))[1] == 0.0


# --- polynomials ---------------------------------------------------------------------------------------------------


def uneven(intervals, degree):
    even = Grid.even(Mesh(intervals, degree))
    return Grid(even.times + 0.03 * np.sin(2 * np.pi * even.times), degree)


@pytest.mark.parametrize("degree", [2, 3, 4, 7, 12])
def test_polynomials_of_the_grid_s_degree_are_exact(degree):
    grid = uneven(5, degree)
    rng = np.random.default_rng(degree)
    exact = np.polynomial.Legendre(rng.normal(size=degree + 1), domain=[0, 1])
    x = exact(grid.nodes)
    t = np.sort(rng.uniform(size=50))
    assert grid.at(x, t) == pytest.approx(exact(t), abs=1e-12)
    assert grid.at(x, grid.nodes) == pytest.approx(x, abs=1e-14)
    points = grid.times[:-1, None] + grid.lengths[:, None] * grid.basis.points
    assert grid.at_points(x) == pytest.approx(exact(points), abs=1e-12)
    assert grid.slopes_at_points(x) == pytest.approx(exact.deriv()(points), abs=1e-9)
    assert grid.quadrature @ x == pytest.approx(exact.integ()(1.0) - exact.integ()(0.0), abs=1e-13)
    assert grid.next_derivative(x[:, None], np.ones(1))[1:-1] == pytest.approx(
        0.0, abs=1e-5 * 40.0**degree
    )  # the derivative of order m is one constant, so that its differences are rounding


@pytest.mark.parametrize("degree", [2, 4, 7])
def test_a_row_is_an_integral(degree):
    grid = uneven(6, degree)
    rng = np.random.default_rng(degree)
    x, values = rng.normal(size=(len(grid.nodes), 3)), rng.normal(size=(6, degree, 3))
    weights = grid.lengths[:, None] * grid.basis.weights
    expected = np.einsum("ji,jin,jin->", weights, values, grid.at_points(x))
    assert np.sum(grid.row(values) * x) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("degree", [2, 4, 7])
def test_another_mesh_keeps_the_polynomial(degree):
    """A profile of that degree, closed or not, is the same function on every adapted mesh."""
    grid = uneven(9, degree)
    exact = np.polynomial.Legendre(np.arange(1.0, degree + 2), domain=[0, 1])
    x = np.stack([exact(grid.nodes), -2 * exact(grid.nodes)], axis=1)
    for many in (None, 9, 13, 4):
        other = grid.adapted(x, np.ones(2), many)
        assert len(other.lengths) == (many or 9)
        assert other.times[0] == 0.0
        assert other.times[-1] == 1.0
        assert np.all(other.lengths > 0)
        assert grid.at(x, other.nodes)[:, 0] == pytest.approx(exact(other.nodes), abs=1e-10)


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_the_mesh_goes_where_the_function_is_steep_and_the_error_is_foretold(degree):
    def steep(t):
        return np.stack([np.tanh(30 * np.sin(2 * np.pi * t)), np.cos(2 * np.pi * t)], axis=-1)

    def worst(grid):
        """Interpolated at the nodes; collocation's own error is of the same order."""
        t = np.linspace(0, 1, 5001)
        return np.abs(grid.at(steep(grid.nodes), t) - steep(t)).max()

    grid = Grid.even(Mesh(80, degree))
    even, scale = worst(grid), np.ones(2)
    for _ in range(3):
        grid = grid.adapted(steep(grid.nodes), scale)
    assert worst(grid) < (0.2, 0.1, 0.05)[degree - 2] * even
    assert grid.lengths.max() < 10.0 / 80 * 1.001
    assert 0.2 < grid.error(steep(grid.nodes), scale) / worst(grid) < 6.0


def test_a_profile_at_rest_gets_an_even_mesh():
    grid = uneven(8, 3).adapted(np.zeros((25, 2)), np.ones(2))
    assert np.all(np.isfinite(grid.times))


@pytest.mark.parametrize(
    "wrong",
    [{"intervals": 3}, {"degree": 1}, {"degree": 13}, {"intervals": 4.5}, {"intervals": True}, {"most": 20}],
)
def test_a_mesh_within_its_limits(wrong):
    with pytest.raises(InputError, match=r"Mesh: \w+ must be a whole number from"):
        Mesh(**wrong)


# --- orbits --------------------------------------------------------------------------------------------------------


def on_even_grid(name, mesh, along=None):
    """The equations on an even grid, and the discrete orbit by Newton from the exact one."""
    known = ZOO[name]
    cycle = known.start
    grid = Grid.even(mesh)
    x = cycle.at(cycle.period * grid.nodes)
    along = along or (known.along,)
    system = known.system
    problem = OrbitEquations(
        system, along, grid, np.maximum(1.0, np.abs(x).max(axis=0)), cycle.period, np.ones(len(along)), mesh
    )
    u = np.concatenate([x.ravel(), [cycle.period], [system.parameters[name] for name in along]])
    return problem, u


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_order_2m_at_mesh_points_and_m_plus_1_between(degree):
    """The level curve H = h, an elliptic function: H is off by the error across the orbit, T by the period's."""
    known = ZOO["level curve"]
    h, exact = known.system.parameters["h"], known.start.period
    errors = []
    counts = np.array({2: (24, 48, 96), 3: (12, 24, 48), 4: (10, 16, 24)}[degree])
    for many in counts:
        problem, u = on_even_grid("level curve", Mesh(int(many), degree))
        node = first_node(problem, u)
        x, period, _ = problem.parts(node.u)
        between = problem.grid.at(x, np.linspace(0, 1, 2001))
        off = [
            np.abs(z[:, 1] ** 2 / 2 + z[:, 0] ** 2 / 2 - z[:, 0] ** 3 / 3 - h).max()
            for z in (x[::degree], between)
        ]
        errors.append([*off, abs(period - exact)])
    orders = -np.diff(np.log(errors), axis=0) / np.diff(np.log(counts))[:, None]
    assert orders[-1, 0] == pytest.approx(2 * degree, abs=0.3)
    assert orders[-1, 1] == pytest.approx(degree + 1, abs=0.3)
    assert orders[-1, 2] == pytest.approx(2 * degree, abs=0.3)


@pytest.mark.parametrize("kind", ["lpc", "pd", "ns", "bp"])
@pytest.mark.parametrize("name", ["chenciner", "fold-flip"])
def test_slopes_of_the_conditions_are_their_derivatives(name, kind):
    """w, v and the point across which phi(0) lies are held: the slopes are those of exactly this scalar."""
    known = ZOO[name]
    problem, u = on_even_grid(name, Mesh(6, 3), known.curves[0].along)
    rng = np.random.default_rng(0)
    # near an orbit, not on it: its defects have no part in the scalars
    u = u + 0.05 * np.append(rng.normal(size=u.size - 2), [0.0, 0.0])
    x = problem.profile(u)
    x[-1] = x[0]
    angle = 0.8 if kind == "ns" else 0.0
    at = problem.linearise(u)
    borders = start_borders(problem, u, at, kind, angle)
    found = condition(problem, u, at, kind, borders, angle)
    by = slopes(problem, u, found)

    def scalars(v, angle=angle):
        return condition(problem, v, problem.linearise(v), kind, borders, angle).values

    def difference(function, h=1e-5):
        return (8 * (function(h) - function(-h)) - function(2 * h) + function(-2 * h)) / (12 * h)

    profile, period, parameters = np.zeros((4, u.size)), np.zeros(u.size), np.zeros((2, u.size))
    profile[:, : problem.profile_size] = rng.normal(size=(4, problem.profile_size))
    profile[:, problem.profile_size - problem.n : problem.profile_size] = profile[:, : problem.n]
    period[-3], parameters[0, -2], parameters[1, -1] = 1.0, 1.0, 1.0
    for direction in (*profile, period, *parameters):
        expected = difference(lambda h, direction=direction: scalars(u + h * direction))
        assert by @ direction == pytest.approx(expected, rel=1e-6, abs=1e-8)
    if kind == "ns":
        expected = difference(lambda h: scalars(u, angle + h))
        assert slope_by_angle(found) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("name", ["level curve", "chenciner", "fold-flip", "stiff and linear"])
def test_an_orbit_s_multipliers_and_residual(name):
    problem, u = on_even_grid(name, Mesh(30, 5))
    node = first_node(problem, u)
    orbit = problem.orbit(node)
    exact = np.delete(ZOO[name].start.exponents, np.argmin(np.abs(ZOO[name].start.exponents)))
    assert np.sort(orbit.exponents.real) == pytest.approx(np.sort(exact.real), rel=2e-5, abs=1e-8)
    assert abs(orbit.trivial) < 1e-7
    assert abs(orbit.liouville) < 1e-3
    assert orbit.residual < 1e-9
    assert orbit.period == pytest.approx(ZOO[name].start.period, rel=1e-9)


def test_newton_says_none_where_it_finds_nothing():
    problem, u = on_even_grid("hopf", Mesh(6, 3))
    far = u + 1e3 * np.random.default_rng(0).normal(size=u.size)
    tangent = np.zeros(u.size)
    tangent[-1] = 1.0
    assert problem.correct(Node(far, tangent), far, tangent) is None
    far[3] = np.nan
    assert problem.correct(Node(far, tangent), far, tangent) is None
