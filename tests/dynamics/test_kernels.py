"""Values, tangents and jets of a tape against SymPy's derivatives at 40 digits.

The measure of an error is the largest intermediate: the largest |k! c_k| of any slot of the tape, for all
orders k up to the one compared, along the direction compared (for a Jacobian: along each of its directions).
"""

import ast
import math
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rainwind import elementary as rw
from rainwind.dynamics.kernels import compiling
from rainwind.dynamics.kernels.jets import directional, run_jets
from rainwind.dynamics.kernels.tangents import first_order, jacobians, second_order
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.tape import trace

TOLERANCE = 1e-12
NAMES = ("u", "w", "q")  # two states, one parameter
POINT = (0.7, -1.3, 0.9)
VECTOR = (0.8, -0.5, 0.3)


class ForSymPy:
    """The words of rainwind.elementary, for SymPy."""

    sin, cos, tan = sympy.sin, sympy.cos, sympy.tan
    asin, acos, atan, atan2 = sympy.asin, sympy.acos, sympy.atan, sympy.atan2
    sinh, cosh, tanh = sympy.sinh, sympy.cosh, sympy.tanh
    exp, log, sqrt, erf = sympy.exp, sympy.log, sympy.sqrt, sympy.erf


# Each keeps its argument inside the domain and away from singular points, whatever a is.
UNARY = {
    "negative": lambda e, a: -a,
    "sin": lambda e, a: e.sin(a),
    "cos": lambda e, a: e.cos(a),
    "tan": lambda e, a: e.tan(0.875 * e.sin(a)),
    "asin": lambda e, a: e.asin(0.875 * e.tanh(a)),
    "acos": lambda e, a: e.acos(0.875 * e.sin(a)),
    "atan": lambda e, a: e.atan(a),
    "sinh": lambda e, a: e.sinh(1.5 * e.sin(a)),
    "cosh": lambda e, a: e.cosh(1.5 * e.tanh(a)),
    "tanh": lambda e, a: e.tanh(a),
    "exp": lambda e, a: e.exp(e.cos(a)),
    "log": lambda e, a: e.log(1 + a * a),
    "sqrt": lambda e, a: e.sqrt(1.5 + e.sin(a)),
    "erf": lambda e, a: e.erf(a),
    "square": lambda e, a: a**2,
    "cube": lambda e, a: e.sin(a) ** 3,
    "seventh": lambda e, a: e.cos(a) ** 7,
    "inverse": lambda e, a: (2 + e.sin(a)) ** -1,
    "inverse cube": lambda e, a: (2 + e.cos(a)) ** -3,
    "power 1.5": lambda e, a: (1.5 + e.sin(a)) ** 1.5,
    "power 0.5": lambda e, a: (1.5 + e.cos(a)) ** 0.5,
    "power -2.25": lambda e, a: (2 + e.sin(a)) ** -2.25,
    "exponent": lambda e, a: 1.75 ** e.sin(a),
}
BINARY = {
    "add": lambda e, a, b: a + b,
    "subtract": lambda e, a, b: a - b,
    "multiply": lambda e, a, b: a * b,
    "divide": lambda e, a, b: a / (2 + e.sin(b)),
    "divide twice": lambda e, a, b: a / (1.5 + b * b) / (2 + e.cos(a)),
    "atan2 right": lambda e, a, b: e.atan2(a, 1 + b * b),
    "atan2 below": lambda e, a, b: e.atan2(-1 - a * a, b),
    "atan2 left": lambda e, a, b: e.atan2(1.5 + e.sin(a), -1 - e.cos(b)),
    "symbol to symbol": lambda e, a, b: (1.5 + e.sin(a)) ** e.cos(b),
}


def evaluate(tree, functions, leaves):
    """The value of a tree: a name, a number, or (operation, subtree, ...)."""
    if isinstance(tree, str):
        return leaves[NAMES.index(tree)]
    if isinstance(tree, float):
        return sympy.Rational(tree) if functions is ForSymPy else tree
    operation, *arguments = tree
    arguments = [evaluate(argument, functions, leaves) for argument in arguments]
    return (UNARY | BINARY)[operation](functions, *arguments)


def exact(expression):
    """Floats of an expression, which are exact in binary, as fractions."""
    floats = expression.atoms(sympy.Float)
    return expression.xreplace({number: sympy.Rational(float(number)) for number in floats})


def tape_of(trees):
    """A tape with one state for each tree, of which the first two are u and w."""
    states = [*NAMES[:2], *(f"more{i}" for i in range(len(trees) - 2))]

    def rhs(x, p):
        return [evaluate(tree, rw, (x.u, x.w, p.q)) for tree in trees] + [0.0] * (len(states) - len(trees))

    return trace(rhs, states, ["q"])


def padded(tape, three):
    """u, w, q as the inputs of a tape."""
    row = np.zeros(len(tape.states) + 1)
    row[0], row[1], row[-1] = three
    return row


def largest_intermediate(tape, point, vector, order):
    slots = np.zeros((tape.template.size, order + 1))
    slots[:, 0] = tape.template
    slots[: point.size, 0] = point
    if order:
        slots[: point.size, 1] = vector
    run_jets(tape.operations, slots)
    return np.max(np.abs(slots) * [math.factorial(k) for k in range(order + 1)])


SYMBOLS = sympy.symbols("u w q")
ALONG = sympy.symbols("vu vw vq")
T = sympy.Symbol("t")


def reference(tree, order):
    """f along the line (a function of t differentiated `order` times), its gradient and D_v of that."""
    f = exact(sympy.sympify(evaluate(tree, ForSymPy, SYMBOLS)))
    gradient = [sympy.diff(f, s) for s in SYMBOLS]
    along = [sum(v * sympy.diff(g, s) for s, v in zip(SYMBOLS, ALONG, strict=True)) for g in gradient]
    line = f.subs({s: s + T * v for s, v in zip(SYMBOLS, ALONG, strict=True)}, simultaneous=True)
    derivatives = [line]
    for _ in range(order):
        derivatives.append(sympy.diff(derivatives[-1], T))
    derivatives = [d.subs(T, 0) for d in derivatives]
    compute = sympy.lambdify([*SYMBOLS, *ALONG], [derivatives, gradient, along], modules="mpmath", cse=True)
    with mpmath.workdps(40):
        numbers = [mpmath.mpf(n) for n in (*POINT, *VECTOR)]
        return [np.array([float(n) for n in part]) for part in compute(*numbers)]


def compare(trees, order):
    """Largest error of all that the kernels give for these trees, in largest intermediates."""
    tape = tape_of(trees)
    point, vector = padded(tape, POINT), padded(tape, VECTOR)
    inputs = np.array([0, 1, point.size - 1])
    answers = [reference(tree, order) for tree in trees]
    line, gradient, along = (np.array(part) for part in zip(*answers, strict=True))
    used = slice(0, len(trees))

    units = np.eye(point.size)[inputs]
    scale = [largest_intermediate(tape, point, vector, k) for k in range(order + 1)]
    scale_j = max(largest_intermediate(tape, point, unit, 1) for unit in units)
    scale_vj = max(
        largest_intermediate(tape, point, sign * unit + vector, 2) for unit in units for sign in (1, -1)
    )

    f, jacobian = jacobians(*tape.arrays, point[None], inputs)
    f2, jacobian2, mixed = second_order(*tape.arrays, point, inputs, vector)
    errors = {
        "values": (values(*tape.arrays, point[None])[0, used] - line[:, 0]) / scale[0],
        "values with J": (f[0, used] - line[:, 0]) / scale[0],
        "values with D_v J": (f2[used] - line[:, 0]) / scale[0],
        "J": (jacobian[0, used] - gradient) / scale_j,
        "J with D_v J": (jacobian2[used] - gradient) / scale_j,
        "D_v J": (mixed[used] - along) / scale_vj,
    }
    for k in range(1, order + 1):
        ours = directional(*tape.arrays, point, vector[None], k)[0, used]
        errors[f"derivative {k}"] = (ours - line[:, k]) / scale[k]
    return {what: float(np.max(np.abs(error))) for what, error in errors.items()}


@pytest.mark.parametrize("name", [*UNARY, *BINARY])
def test_each_function_to_order_four(name):
    tree = (name, ("add", "u", "q")) if name in UNARY else (name, ("multiply", "u", "q"), ("add", "w", "q"))
    errors = compare([tree, ("multiply", tree, "w")], order=4)
    assert max(errors.values()) < TOLERANCE, errors


@pytest.mark.parametrize(
    "tree",
    [
        ("sin", "u"),
        ("exp", ("square", "u")),
        ("tan", "u"),
        ("asin", "u"),
        ("acos", "w"),
        ("atan", "u"),
        ("tanh", ("sinh", "u")),
        ("erf", "w"),
        ("log", "u"),
        ("sqrt", "w"),
        ("power -2.25", "u"),
        ("divide", "u", "w"),
        ("atan2 right", "u", "w"),
    ],
)
def test_order_seven_and_eight(tree):
    errors = compare([tree, "u"], order=8)
    assert max(errors.values()) < TOLERANCE, errors


LEAVES = st.sampled_from(NAMES) | st.sampled_from((0.5, -1.25, 2.0, 3.0))


def trees(depth):
    """Expressions as deep as this, each operation as likely as any other."""
    if depth == 0:
        return LEAVES
    below, beside = trees(depth - 1), trees(max(depth - 2, 0))
    unary = st.tuples(st.sampled_from(list(UNARY)), below)
    return unary | st.tuples(st.sampled_from(list(BINARY)), below, beside)


TREES = trees(2) | trees(3)


@settings(
    max_examples=50,
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
@given(st.tuples(TREES, TREES))
def test_random_expressions_to_order_three(pair):
    errors = compare(pair, order=3)
    assert max(errors.values()) < TOLERANCE, errors


# ---- one point and many


def wide_tape():
    """Every operation, with a chain in the parameter alone and outputs that are inputs and constants."""
    trees = [(name, ("add", "u", ("sin", "q"))) for name in UNARY]
    trees += [(name, ("multiply", "u", "q"), ("subtract", "w", ("exp", "q"))) for name in BINARY]
    return tape_of(["w", 3.0, *trees])


def points_of(tape, count, *, vary):
    rng = np.random.default_rng(20030617)
    points = np.tile(padded(tape, POINT), (count, 1))
    for i in vary:
        points[:, i] += rng.uniform(-0.5, 0.5, count)
    return points


@pytest.mark.parametrize("count", [1, 2, 7, 8, 9, 63, 64, 65, 200])
@pytest.mark.parametrize("vary", [(0, 1), (0, -1), (-1,), ()])
def test_many_points_equal_one_by_one(count, vary):
    tape = wide_tape()
    points = points_of(tape, count, vary=vary)
    directions = np.array([points.shape[1] - 1, 0, 1])
    f, d = jacobians(*tape.arrays, points, directions)
    alone = [jacobians(*tape.arrays, point[None], directions) for point in points]
    np.testing.assert_allclose(f, [value[0] for value, _ in alone], rtol=1e-15)
    np.testing.assert_allclose(d, [derivative[0] for _, derivative in alone], rtol=1e-15)
    np.testing.assert_array_equal(values(*tape.arrays, points), f)


def test_one_point_that_is_not_finite_leaves_the_others_alone():
    tape = wide_tape()
    points = points_of(tape, 70, vary=(0, 1))
    directions = np.array([0, 1])
    f, d = jacobians(*tape.arrays, points, directions)
    points[33, 0] = math.nan
    f2, d2 = jacobians(*tape.arrays, points, directions)
    others = np.arange(70) != 33
    np.testing.assert_array_equal(f[others], f2[others])
    np.testing.assert_array_equal(d[others], d2[others])
    assert np.isnan(f2[33]).any()
    points[0, 0] = math.nan
    np.testing.assert_array_equal(jacobians(*tape.arrays, points, directions)[0][others][1:], f[others][1:])


@pytest.mark.parametrize("count", [0, 1, 100])
def test_no_points_no_directions_no_operations(count):
    tape = trace(lambda x, p: (x.b, 4.0), ["a", "b"], ["k"])
    points = np.arange(3.0 * count).reshape(count, 3)
    f, d = jacobians(*tape.arrays, points, np.array([1, 2]))
    assert f.shape == (count, 2)
    assert d.shape == (count, 2, 2)
    np.testing.assert_array_equal(f, np.stack([points[:, 1], np.full(count, 4.0)], axis=1))
    np.testing.assert_array_equal(d, np.broadcast_to([[1.0, 0.0], [0.0, 0.0]], d.shape))
    assert jacobians(*tape.arrays, points, np.array([], dtype=int))[1].shape == (count, 2, 0)
    _, first, mixed = second_order(*tape.arrays, np.array([1.0, 2, 3]), np.array([1, 0]), np.ones(3))
    np.testing.assert_array_equal(first, [[1, 0], [0, 0]])
    np.testing.assert_array_equal(mixed, np.zeros((2, 2)))
    vectors = np.array([[1.0, 2.0, 3.0]])
    for order, expected in enumerate([[5.0, 4.0], [2.0, 0.0], [0.0, 0.0]]):
        ours = directional(*tape.arrays, np.array([4.0, 5.0, 6.0]), vectors, order)
        np.testing.assert_array_equal(ours, [expected])


def test_first_order_leaves_inactive_rows_unread():
    tape = wide_tape()
    inputs = padded(tape, POINT)
    slots = tape.template.copy()
    slots[: inputs.size] = inputs
    tangents = np.full((slots.size, 1), math.nan)
    active = np.zeros(slots.size, dtype=bool)
    tangents[0], active[0] = 1.0, True
    first_order(tape.operations, slots, tangents, active)
    f, d = jacobians(*tape.arrays, inputs[None], np.array([0]))
    np.testing.assert_array_equal(slots[tape.outputs], f[0])
    ours = np.where(active[tape.outputs], tangents[tape.outputs, 0], 0.0)
    np.testing.assert_array_equal(ours, d[0, :, 0])


def test_run_jets_along_a_curve():
    """f of the curve u = u0 + 2 t - t^2 + t^3, w = w0 + t^2, against f along it in closed form."""
    tape = tape_of([("exp", "u"), ("multiply", "u", "w"), ("square", "w"), ("sin", "q")])
    slots = np.zeros((tape.template.size, 4))
    slots[:, 0] = tape.template
    slots[0], slots[1] = (0.3, 2.0, -1.0, 1.0), (1.5, 0.0, 1.0, 0.0)
    slots[tape.operations[0, 1] :] = 7.0  # what an earlier run left is not read
    run_jets(tape.operations, slots)
    u, w, t = slots[0], slots[1], sympy.Symbol("t")
    curve = sum(sympy.Rational(float(c)) * t**k for k, c in enumerate(u))
    series = sympy.series(sympy.exp(sympy.cos(curve)), t, 0, 4).removeO()
    expected = [float(series.coeff(t, k)) for k in range(4)]
    np.testing.assert_allclose(slots[tape.outputs[0]], expected, rtol=1e-13)
    np.testing.assert_allclose(slots[tape.outputs[1]], np.convolve(u, w)[:4], rtol=1e-15)
    np.testing.assert_allclose(slots[tape.outputs[2]], np.convolve(w, w)[:4], rtol=1e-15)
    np.testing.assert_array_equal(slots[tape.outputs[3]], [0, 0, 0, 0])


def test_many_vectors_equal_one_by_one():
    tape = wide_tape()
    point = padded(tape, POINT)
    vectors = np.zeros((5, point.size))
    vectors[0, 0] = vectors[1, 1] = vectors[2, -1] = 1.0
    vectors[3] = 0.5
    together = directional(*tape.arrays, point, vectors, 3)
    alone = [directional(*tape.arrays, point, vector[None], 3)[0] for vector in vectors]
    np.testing.assert_array_equal(together, alone)
    assert not together[4].any()


# ---- the tape and the function it was traced from


@settings(max_examples=200, derandomize=True, database=None, deadline=None)
@given(TREES, st.tuples(*[st.floats(-3, 3)] * 3))
def test_values_equal_the_function_called_with_numbers(tree, numbers):
    tape = tape_of([tree, "u"])
    scale = largest_intermediate(tape, np.array(numbers), np.zeros(3), 0)
    error = values(*tape.arrays, np.array([numbers]))[0, 0] - evaluate(tree, rw, numbers)
    assert abs(error) <= TOLERANCE * scale


@pytest.mark.parametrize("name", [*UNARY, *BINARY])
def test_each_function_equals_itself_called_with_numbers(name):
    tree = (name, "u") if name in UNARY else (name, "u", "w")
    tape = tape_of([tree, "u"])
    for u in np.linspace(-3, 3, 13):
        expected = evaluate(tree, rw, (u, 0.4, 0.0))
        assert values(*tape.arrays, np.array([[u, 0.4, 0.0]]))[0, 0] == pytest.approx(
            expected, rel=4e-15, abs=4e-16
        )


KERNELS = sorted(Path(compiling.__file__).parent.glob("[a-z]*.py"))


@pytest.mark.parametrize("path", KERNELS, ids=lambda path: path.stem)
def test_the_cache_of_a_kernel_depends_on_all_kernels_that_it_imports(path):
    """Else a change of a called kernel would leave the caller's old code in use."""
    imported = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("rainwind.dynamics.kernels"):
            parts = (node.module or "").split(".")
            imported |= {parts[3]} if len(parts) > 3 else {alias.name for alias in node.names}
        if isinstance(node, ast.Import):
            assert not any(alias.name.startswith("rainwind") for alias in node.names), (
                "write: from ... import"
            )
    if path.stem != "compiling":
        assert imported <= compiling._needs(path.stem)
