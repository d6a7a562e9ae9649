"""What becomes of a right-hand side: the tape it leaves, and the errors it meets."""

import math
from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from scipy.special import erf as scipy_erf

from rainwind import elementary as rw
from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels.values import values
from rainwind.dynamics.tape import Symbol, trace
from rainwind.errors import TraceError


def run(tape, *inputs):
    return values(*tape.arrays, np.array([inputs], dtype=float))[0]


def codes(tape):
    return [int(code) for code in tape.operations[:, 0]]


def one(f):
    """Trace f(x) of one state."""
    return trace(lambda x, p: f(x.x), ["x"], [])


# ---- what is recorded


def test_equal_subexpressions_are_recorded_once():
    def rhs(x, p):
        return (x.a * x.b) + rw.sin(x.a), (x.b * x.a) - rw.cos(x.a)

    assert sorted(codes(trace(rhs, ["a", "b"], []))) == sorted([op.MUL, op.SINCOS, op.ADD, op.SUB])


def test_noncommutative_operations_are_kept_apart():
    tape = trace(lambda x, p: (x.a - x.b, x.b - x.a), ["a", "b"], [])
    assert run(tape, 3, 1).tolist() == [2, -2]


def test_what_no_derivative_needs_is_dropped():
    def rhs(x, p):
        _ = rw.exp(x.a) + p.unused * 3.0
        return x.a * x.a, 0.0

    tape = trace(rhs, ["a", "b"], ["unused"])
    assert codes(tape) == [op.MUL]
    assert run(tape, 3, 5, 7).tolist() == [9, 0]


@pytest.mark.parametrize(
    "f",
    [
        lambda x: x + 0,
        lambda x: 0.0 + x,
        lambda x: x - 0,
        lambda x: x * 1,
        lambda x: 1.0 * x,
        lambda x: x / 1,
        lambda x: x**1,
        lambda x: +x,
        lambda x: x**1.0,
        lambda x: sum([x]),
    ],
)
def test_operations_that_change_nothing_are_not_recorded(f):
    tape = one(f)
    assert codes(tape) == []
    assert run(tape, 2.5) == [2.5]


@pytest.mark.parametrize(
    ("f", "value"),
    [
        (lambda x: x * 0, 0), (lambda x: 0 * x + 3, 3), (lambda x: 0 / x, 0), (lambda x: x**0, 1),
        (lambda x: x**0.0, 1), (lambda x: 1**x, 1), (lambda x: rw.sin(0 * x) + 2, 2),
        (lambda x: rw.exp(0.0 * x + 1.0), math.e), (lambda x: 3, 3), (lambda x: np.float64(0.5), 0.5),
        (lambda x: Fraction(1, 4), 0.25), (lambda x: np.int64(7), 7), (lambda x: np.array(2.0), 2),
    ],
)  # fmt: skip
def test_constants_are_computed_while_tracing(f, value):
    tape = one(f)
    assert codes(tape) == []
    assert run(tape, 2.5) == [value]


def test_the_sign_of_a_zero_constant_is_kept():
    tape = trace(lambda x, p: (rw.atan2(0.0, x.a), rw.atan2(-0.0, x.a)), ["a", "b"], [])
    assert run(tape, -1, 0).tolist() == [math.pi, -math.pi]


def test_outputs_may_be_inputs_constants_or_equal():
    tape = trace(lambda x, p: (x.b, p.c, 2.0, x.b), ["a", "b", "d", "e"], ["c"])
    assert run(tape, 1, 2, 3, 4, 5).tolist() == [2, 5, 2, 2]


def test_no_parameters_and_states_that_appear_nowhere():
    tape = trace(lambda x, p: (-x.b, x.b), ["a", "b"], {})
    assert tape.parameters == ()
    assert run(tape, 9, 2).tolist() == [-2, 2]


@pytest.mark.parametrize(
    "give",
    [
        tuple, list, lambda pair: np.array(list(pair)), lambda pair: (item for item in pair),
        lambda pair: dict(zip("ba", reversed(list(pair)), strict=True)),
    ],
)  # fmt: skip
def test_derivatives_may_come_in_any_container(give):
    tape = trace(lambda x, p: give((x.b, 2.0 * x.a)), ["a", "b"], [])
    assert run(tape, 3, 5).tolist() == [5, 6]


def test_a_generator_function_is_a_right_hand_side():
    def rhs(x, p):
        for value in x:
            yield value * p.k

    assert run(trace(rhs, ["a", "b"], ["k"]), 1, 2, 10).tolist() == [10, 20]


def test_numpy_matrices_and_vectors_of_states():
    matrix = np.array([[1.0, 2.0], [3.0, 4.0]])
    tape = trace(lambda x, p: matrix @ np.array(list(x)), ["a", "b"], [])
    assert run(tape, 1, 10).tolist() == [21, 43]


@pytest.mark.parametrize(
    ("f", "expected"),
    [
        (lambda x: np.float64(2.0) * x, 1.0),
        (lambda x: np.float64(2.0) + x, 2.5),
        (lambda x: np.float64(2.0) - x, 1.5),
        (lambda x: np.int64(2) / x, 4.0),
        (lambda x: np.float32(2) ** x, 2**0.5),
        (lambda x: x ** np.int64(2), 0.25),
        (lambda x: x ** np.float64(-2), 4.0),
        (lambda x: x * np.array(4.0), 2.0),
        (lambda x: np.array(4.0) * x, 2.0),
        (lambda x: +(-(x * 1)) * -1, 0.5),
        (lambda x: np.negative(x), -0.5),
        (lambda x: np.square(x), 0.25),
        (lambda x: np.sin(x), math.sin(0.5)),
        (lambda x: np.sqrt(x), 0.5**0.5),
        (lambda x: np.arctan2(x, 2.0), math.atan2(0.5, 2)),
        (lambda x: np.arctan2(2, x), math.atan2(2, 0.5)),
        (lambda x: rw.atan2(2, x), math.atan2(2, 0.5)),
        (lambda x: scipy_erf(x), math.erf(0.5)),
        (lambda x: x**x, 0.5**0.5),
        (lambda x: 3**x, 3**0.5),
        (lambda x: x**-1.5, 0.5**-1.5),
        (lambda x: (x - 1) ** 3, -0.125),
        (lambda x: (-2.0) ** 3 * x, -4.0),
        (lambda x: True + x, 1.5),
        (lambda x: rw.wrap_angle(x + 2 * math.pi), 0.5),
        (lambda x: Fraction(1, 2) * x, 0.25),
    ],
)
def test_numbers_of_every_kind_take_part(f, expected):
    assert run(one(f), 0.5)[0] == pytest.approx(expected, rel=1e-15, abs=1e-15)


@pytest.mark.parametrize("exponent", [2, 3, 7, 65, 100, 1001])
def test_whole_powers_are_exact_at_zero_and_below(exponent):
    tape = one(lambda x: x**exponent)
    assert run(tape, 0.0) == [0.0]
    assert run(tape, -1.0) == [(-1) ** exponent]


def test_any_word_may_name_a_state_or_parameter():
    names = ["index", "count", "lambda", "_names", "_values", "x", "self", "wind.speed", "U ∞", "T", "real"]
    tape = trace(lambda x, p: [2 * x[name] + p[name] for name in names], names, names)
    numbers = np.arange(2.0 * len(names))
    assert run(tape, *numbers).tolist() == (2 * numbers[: len(names)] + numbers[len(names) :]).tolist()
    tape = trace(
        lambda x, p: (x.index, x.count, x._names, x._values), ["count", "_values", "index", "_names"], []
    )
    assert run(tape, 1, 2, 3, 4).tolist() == [3, 1, 4, 2]


def test_states_by_number_slice_and_unpacking():
    def rhs(x, p):
        a, *rest = x
        (k,) = p
        assert len(x) == 3
        return x[-1] * k, a, sum(x[1:]) + 0 * sum(rest)

    assert run(trace(rhs, ["a", "b", "c"], ["k"]), 1, 2, 3, 4).tolist() == [12, 1, 5]


def test_a_long_right_hand_side_needs_no_recursion():
    def chain(x):
        for i in range(5000):
            x = x + 1.0 / (i + 1)
        return x

    assert run(one(chain), 0.25)[0] == chain(0.25)


# ---- what is refused: every message names the line; the marks below say which one must be named

kept = []


def branch_if(x, p):
    if x.x:  # here
        return x.y, x.x
    return x.x, x.y


def branch_max(x, p):
    y = max(x.x, 0.0)  # here
    return y, y


def branch_abs(x, p):
    return x.x, abs(x.y)  # here


def branch_equal(x, p):
    return x.x, (x.y == 1.0) * x.x  # here


def branch_unequal(x, p):
    return x.x, (x.y != 1.0) * x.x  # here


def branch_in(x, p):
    return x.x, x.y in (1.0, 2.0)  # here


def branch_numpy_less(x, p):
    return x.x, np.float64(1.0) < x.y  # here


def branch_numpy_where(x, p):
    return x.x, np.where(x.x > 0, x.x, x.y)  # here


def branch_numpy_maximum(x, p):
    return x.x, np.maximum(x.x, x.y)  # here


def branch_numpy_abs(x, p):
    return x.x, np.abs(x.x)  # here


def branch_sorted(x, p):
    return sorted(x)  # here


def branch_while(x, p):
    n = 1
    while n < p.k:  # here
        n = n + 1
    return x.x, n


def branch_floor(x, p):
    return x.x, math.floor(x.y)  # here


def branch_modulo(x, p):
    return x.x % (2 * math.pi), x.y  # here


def branch_floor_division(x, p):
    return x.x, 7 // x.y  # here


def branch_round(x, p):
    return round(x.x, 2), x.y  # here


def branch_and(x, p):
    return x.x and x.y, x.y  # here


def branch_in_a_helper(x, p):
    return x.x, _helper(x.y)


def _helper(value):
    return value if value > 0 else -value  # here


BRANCHES = [
    branch_if, branch_max, branch_abs, branch_equal, branch_unequal, branch_in, branch_numpy_less,
    branch_numpy_where, branch_numpy_maximum, branch_numpy_abs, branch_sorted, branch_while, branch_floor,
    branch_modulo, branch_floor_division, branch_round, branch_and,
]  # fmt: skip


def unknown_math(x, p):
    return x.x, math.sin(x.y)  # here


def unknown_isnan(x, p):
    return x.x, x.y * math.isnan(x.x)  # here


def unknown_numpy_floor(x, p):
    return np.floor(x.x), x.y  # here


def unknown_numpy_hypot(x, p):
    return np.hypot(x.x, 1.0), x.y  # here


def unknown_numpy_divmod(x, p):
    return np.float64(3.0) // x.x, x.y  # here


def unknown_name(x, p):
    return x.x, x.y._elementary_("gamma")  # here


def unknown_number_of_arguments(x, p):
    return x.x, x.y._elementary_("sin", x.x, x.y)  # here


def unknown_attribute(x, p):
    return x.x.real, x.y  # here


def unknown_numpy_clip(x, p):
    return x.x, np.clip(x.y, 0, 1)  # here


def unknown_array_times_symbol(x, p):
    return np.array([1.0, 2.0]) * x.x  # here


def unknown_numpy_out(x, p):
    return x.x, np.add(x.x, 1.0, where=True)  # here


def unknown_index(x, p):
    y = x.x[0]  # here
    return y, y


def unknown_call(x, p):
    return x.x(2), x.y  # here


def unknown_unpacking(x, p):
    a, b, _ = x  # here
    return a, b


def unknown_text(x, p):
    return x.x + "1", x.y  # here


def unknown_none(x, p):
    return x.x * None, x.y  # here


def unknown_complex(x, p):
    return x.x * 1j, x.y  # here


def unknown_list(x, p):
    return x.x - [1.0], x.y  # here


def unknown_integer_use(x, p):
    return x.x, [1, 2, 3][x.y]  # here


def unknown_format(x, p):
    return x.x, float(f"{x.y:.3f}")  # here


def unknown_key(x, p):
    return x.x, {x.y: 1.0}[x.y]  # here


UNKNOWN = [
    unknown_math, unknown_isnan, unknown_numpy_floor, unknown_numpy_hypot, unknown_numpy_divmod, unknown_name,
    unknown_number_of_arguments, unknown_attribute, unknown_numpy_clip, unknown_array_times_symbol,
    unknown_numpy_out, unknown_index, unknown_call, unknown_unpacking, unknown_text, unknown_none,
    unknown_complex, unknown_list, unknown_integer_use, unknown_format, unknown_key,
]  # fmt: skip


def infinite_constant(x, p):
    return x.x * float("inf"), x.y  # here


def nan_constant(x, p):
    return x.x, math.nan - x.y  # here


def nan_argument(x, p):
    return x.x, rw.atan2(x.y, float("nan"))  # here


def nan_exponent(x, p):
    return x.x ** float("nan"), x.y  # here


def division_by_zero(x, p):
    a = x.x + 1 / 0.0  # here
    return a, a


def division_of_a_symbol_by_zero(x, p):
    return x.x / 0.0, x.y  # here


def folded_division_by_zero(x, p):
    return x.x, 1.0 / (0 * x.x)  # here


def numpy_division_by_zero(x, p):
    return x.x, x.y + np.float64(1.0) / 0.0  # here


def numpy_overflow(x, p):
    return x.x, x.y * np.exp(1000.0)  # here


def numpy_nan(x, p):
    return x.x, x.y * rw.log(-1.0)  # here


def math_overflow(x, p):
    return x.x, x.y * math.exp(1000.0)  # here


def math_domain(x, p):
    return x.x, x.y * math.log(-1.0)  # here


def folded_overflow(x, p):
    return x.x, rw.exp(0 * x.y + 1000.0) * x.y  # here


def folded_log_of_zero(x, p):
    return x.x, rw.log(0 * x.y) * x.y  # here


def folded_zero_to_minus_one(x, p):
    return x.x, (0 * x.y) ** -1.0  # here


def huge_integer(x, p):
    return x.x, x.y * 10**400  # here


def zero_to_a_power(x, p):
    return x.x, 0**x.y  # here


def negative_to_a_power(x, p):
    return x.x, (-2.0) ** x.y  # here


NOT_FINITE = [
    infinite_constant,
    nan_constant,
    nan_argument,
    nan_exponent,
    division_by_zero,
    division_of_a_symbol_by_zero,
    folded_division_by_zero,
    numpy_division_by_zero,
    numpy_overflow,
    numpy_nan,
    math_overflow,
    math_domain,
    folded_overflow,
    folded_log_of_zero,
    folded_zero_to_minus_one,
    huge_integer,
    zero_to_a_power,
    negative_to_a_power,
]


def wrong_state(x, p):
    return x.x, x.z  # here


def wrong_state_key(x, p):
    return x.x, x["X"]  # here


def wrong_parameter(x, p):
    return x.x, p["wind.sped"]  # here


def wrong_parameter_name(x, p):
    return x.x, p.kk  # here


def wrong_number(x, p):
    return x.x, x[2]  # here


def wrong_kept_symbol(x, p):
    return x.x, x.y + kept[0]  # here


def wrong_key_of_a_dictionary(x, p):
    return x.x, {"a": 1.0}["b"] * x.x  # here


WRONG_NAMES = [
    wrong_state, wrong_state_key, wrong_parameter, wrong_parameter_name, wrong_number, wrong_kept_symbol,
    wrong_key_of_a_dictionary,
]  # fmt: skip


def result_too_few(x, p):  # here
    return (x.x,)


def result_too_many(x, p):  # here
    return x.x, x.y, x.x


def result_one_symbol(x, p):  # here
    return x.x


def result_number(x, p):  # here
    return 1.0


def result_nothing(x, p):  # here
    pass


def result_text(x, p):  # here
    return "xy"


def result_infinite(x, p):  # here
    return x.x, math.inf


def result_nan_array(x, p):  # here
    return np.array([1.0, np.nan])


def result_text_item(x, p):  # here
    return x.x, "1.0"


def result_none_item(x, p):  # here
    return x.x, None


def result_matrix(x, p):  # here
    return np.ones((2, 1))


def result_kept_symbol(x, p):  # here
    return x.x, kept[0]


def result_missing_name(x, p):  # here
    return {"x": x.x}


def result_wrong_name(x, p):  # here
    return {"x": x.x, "z": x.y}


def result_name_too_many(x, p):  # here
    return {"x": x.x, "y": x.y, 3: x.y}


def result_generator(x, p):
    yield x.x
    yield x.y if x.y > 0 else 0.0  # here


def signature_too_short(x):  # here
    return x.x, x.y


RESULTS = [
    result_too_few, result_too_many, result_one_symbol, result_number, result_nothing, result_text,
    result_infinite, result_nan_array, result_text_item, result_none_item, result_matrix, result_kept_symbol,
    result_missing_name, result_wrong_name, result_name_too_many, signature_too_short,
]  # fmt: skip


def line_marked_in(function):
    """Number of the line marked `# here`, counted from the head of the function."""
    first = function.__code__.co_firstlineno
    with open(__file__, encoding="utf-8") as file:
        lines = file.readlines()
    return next(i + 1 for i in range(first - 1, len(lines)) if lines[i].rstrip().endswith("# here"))


def refusal(rhs, line=None):
    kept.clear()
    trace(lambda x, p: (kept.append(x.a), x.a)[1], ["a"], [])
    with pytest.raises(TraceError) as caught:
        trace(rhs, ["x", "y"], {"k": 1.0, "wind.speed": 2.0})
    message = str(caught.value)
    assert f"(line {line or line_marked_in(rhs)} of {__file__})" in message
    return message


@pytest.mark.parametrize("rhs", [*BRANCHES, branch_in_a_helper])
def test_a_branch_is_refused(rhs):
    assert "a branch or comparison on a traced value" in refusal(rhs)


@pytest.mark.parametrize("rhs", [*UNKNOWN, result_generator])
def test_what_cannot_be_recorded_is_refused(rhs):
    refusal(rhs)


@pytest.mark.parametrize("rhs", NOT_FINITE)
def test_constants_that_are_not_finite_are_refused(rhs):
    refusal(rhs)


@pytest.mark.parametrize("rhs", WRONG_NAMES)
def test_wrong_names_are_refused(rhs):
    refusal(rhs)


@pytest.mark.parametrize("rhs", RESULTS)
def test_wrong_results_are_refused_where_the_right_hand_side_is_defined(rhs):
    refusal(rhs)


@pytest.mark.parametrize(
    ("rhs", "words"),
    [
        (unknown_math, "use rw.sin"),
        (unknown_numpy_floor, "'floor' cannot be recorded; known: acos, asin"),
        (unknown_name, "'gamma' cannot be recorded"),
        (unknown_number_of_arguments, "'sin' takes 1 argument, 2 given"),
        (infinite_constant, "the constant inf is not finite"),
        (division_by_zero, "division by zero"),
        (folded_overflow, "overflow encountered in exp"),
        (negative_to_a_power, "the base must be positive"),
        (wrong_state, "states are x, y; there is no 'z'"),
        (wrong_parameter, "parameters are k, wind.speed; there is no 'wind.sped'"),
        (wrong_kept_symbol, "of another right-hand side"),
        (result_too_few, "rhs returned 1 derivatives for 2 states (x, y)"),
        (result_missing_name, "rhs returned derivatives of x; they are needed of x, y"),
        (result_nothing, "rhs returned None"),
        (result_infinite, "the constant inf is not finite"),
    ],
)
def test_the_message_says_what_is_wrong(rhs, words):
    assert words in refusal(rhs)


def test_the_cause_is_kept():
    with pytest.raises(TraceError) as caught:
        trace(division_by_zero, ["x", "y"], [])
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


def test_a_bound_method_a_callable_and_a_partial_are_located_too():
    class Model:
        def rhs(self, x, p):  # here
            return (x.x,)

        def __call__(self, x, p):
            return (x.x,)

    first = Model.rhs.__code__.co_firstlineno
    refusal(Model().rhs, first)
    refusal(Model(), Model.__call__.__code__.co_firstlineno)
    refusal(partial(Model.rhs, None), first)


@pytest.mark.parametrize("states", ["phi", ["x", "x"], [1, 2], [None]])
def test_lists_of_names_are_checked(states):
    with pytest.raises(TraceError, match="states = "):
        trace(lambda x, p: tuple(x), states, [])
    with pytest.raises(TraceError, match="parameters = "):
        trace(lambda x, p: tuple(x), ["a"], states)


def test_a_lambda_of_constants_only():
    assert run(trace(lambda x, p: (1, 2), ["a", "b"], []), 0, 0).tolist() == [1, 2]


def test_symbols_print():
    seen = []
    trace(lambda x, p: seen.append(repr(x.a)) or x.a, ["a"], [])
    assert seen == ["Symbol(('in', 0))"]
    assert Symbol.__hash__ is None
