"""Trajectories by Taylor series against closed forms, invariants and SciPy; lanes that leave each other alone."""

from concurrent.futures import ThreadPoolExecutor
from math import erf, exp, log, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import rainwind as rw
from rainwind.dynamics.kernels import machine_code
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.system import System, as_system
from rainwind.dynamics.tangent_tape import with_tangents
from rainwind.dynamics.taylor import TaylorEnded, TaylorEngine, TaylorRuns
from rainwind.errors import InputError

OSCILLATOR = System(lambda x, p: (x.v, -p.k * x.u), ("u", "v"), {"k": 1.0})
KEPLER = System(
    lambda s, p: (s.vx, s.vy, *(-q * (s.x * s.x + s.y * s.y) ** -1.5 for q in (s.x, s.y))),
    ("x", "y", "vx", "vy"),
)
PREY = System(lambda s, p: (s.x * (p.a - s.y), -s.y * (1.0 - s.x)), ("x", "y"), {"a": 0.7})
BLOWS_UP = System(lambda s, p: (p.a * s.x * s.x,), ("x",), {"a": 1.0})
BOUNDED = System(lambda s, p: (s.v, p.a * (1.0 - s.x * s.x) * s.v - s.x), ("x", "v"), {"a": 1.0})


def test_ten_thousand_turns_at_the_finest_tolerance():
    """(cos t, -sin t) after 45 000 steps; the time itself, 6e4 s, is known to 7e-12 only."""
    turns = 10_000
    runs = TaylorEngine(OSCILLATOR, 1e-15).advance([[1.0, 0.0]], 2.0 * pi * turns, [1.0])
    expected = np.cos(2.0 * pi * turns), -np.sin(2.0 * pi * turns)
    assert np.max(np.abs(runs.states[0] - expected)) < 5e-12
    assert runs.times[0] == 2.0 * pi * turns


def test_energy_of_an_eccentric_orbit():
    e = 0.6
    start = np.array([1.0 - e, 0.0, 0.0, sqrt((1.0 + e) / (1.0 - e))])
    runs = TaylorEngine(KEPLER, 1e-15).advance([start], 200.0 * pi)
    x, y, vx, vy = runs.states[0]
    assert abs(0.5 * (vx * vx + vy * vy) - 1.0 / np.hypot(x, y) + 0.5) < 1e-13
    assert abs(x * vy - y * vx - sqrt(1.0 - e * e)) < 1e-13
    assert np.max(np.abs(runs.states[0] - start)) < 1e-9


def test_invariant_of_predators_and_prey():
    runs = TaylorEngine(PREY, 1e-15).advance([[0.3, 0.4], [2.0, 1.5]], 500.0, [0.7])
    invariant = lambda x, y: x - log(x) + y - 0.7 * log(y)  # noqa: E731
    for start, end in zip([[0.3, 0.4], [2.0, 1.5]], runs.states, strict=True):
        assert invariant(*end) == pytest.approx(invariant(*start), abs=2e-13)


@pytest.mark.parametrize(
    ("rate", "start", "span", "end"),
    [
        (lambda x: x, 0.3, 5.0, 0.3 * exp(5.0)),
        (lambda x: x**1.5, 0.25, 3.0, (2.0 - 1.5) ** -2.0),
        (rw.sqrt, 0.25, 4.0, 6.25),
        (lambda x: rw.exp(-x), 0.5, 30.0, log(exp(0.5) + 30.0)),
        (rw.tan, 0.01, 4.0, float(np.arcsin(np.sin(0.01) * exp(4.0)))),
        (rw.tanh, 0.01, 6.0, float(np.arcsinh(np.sinh(0.01) * exp(6.0)))),
        (rw.sin, 0.01, 9.0, float(2.0 * np.arctan(np.tan(0.005) * exp(9.0)))),
        (lambda x: x * rw.log(x), 1.1, 3.0, exp(log(1.1) * exp(3.0))),
        (lambda x: 1.0 / rw.cosh(x), 0.0, 8.0, float(np.arcsinh(8.0))),
        (lambda x: 1.0 / x, 2.0, 16.0, 6.0),
    ],
)  # fmt: skip
def test_equations_with_known_solutions(rate, start, span, end):
    system = System(lambda x, p: (rate(x.x),), ("x",))
    runs = TaylorEngine(system, 1e-14).advance([[start]], span)
    assert runs.states[0, 0] == pytest.approx(end, rel=2e-13)
    assert runs.ended == [TaylorEnded.ARRIVED]


@pytest.mark.parametrize(
    ("function", "integral", "end"),
    [
        (rw.erf, lambda u: u * erf(u) + exp(-u * u) / sqrt(pi), 3.0),
        (lambda u: rw.atan2(u, 1.0), lambda u: u * np.arctan(u) - 0.5 * log(1.0 + u * u), 8.0),
        (lambda u: rw.atan2(1.0, u), lambda u: u * (pi / 2.0 - np.arctan(u)) + 0.5 * log(1.0 + u * u), 8.0),
        (rw.asin, lambda u: u * np.arcsin(u) + sqrt(1.0 - u * u), 0.9),
        (rw.acos, lambda u: u * np.arccos(u) - sqrt(1.0 - u * u), 0.9),
        (rw.sinh, np.cosh, 3.0),
    ],
)
def test_known_integrals(function, integral, end):
    system = System(lambda x, p: (1.0, function(x.u)), ("u", "area"))
    runs = TaylorEngine(system, 1e-14).advance([[0.1, 0.0]], end - 0.1)
    assert runs.states[0, 1] == pytest.approx(integral(end) - integral(0.1), rel=1e-13)


def test_the_error_follows_the_tolerance():
    """Van der Pol over 40 s: from 1e-3 to 1e-14 the error of the end is at most 50 tolerances."""
    exact = TaylorEngine(BOUNDED, 1e-15, order=30).advance([[2.0, 0.0]], 40.0, [1.0]).states
    for tolerance in 10.0 ** -np.arange(3, 14.1):
        error = np.max(
            np.abs(TaylorEngine(BOUNDED, tolerance).advance([[2.0, 0.0]], 40.0, [1.0]).states - exact)
        )
        assert error < 50.0 * tolerance
        assert error > 1e-4 * tolerance or tolerance < 1e-13


@pytest.mark.parametrize("outside", ["extend", "blend"])
def test_the_rivulet_model_against_scipy(outside):
    system = as_system(rw.paper_model(outside=outside).with_parameters({"wind.speed": 12.0}))
    start = np.array([0.02, 0.7, 0.01, 0.1, 0.0, -0.2])
    theirs = solve_ivp(lambda t, x: system.f(x), (0.0, 5.0), start, method="DOP853", rtol=1e-13, atol=1e-13)
    runs = TaylorEngine(system, 1e-13).advance([start], 5.0, [*system.parameters.values()])
    np.testing.assert_allclose(runs.states[0], theirs.y[:, -1], atol=2e-11)


def test_pieces_are_the_solution_between_steps():
    (one,), runs = TaylorEngine(OSCILLATOR, 1e-12).pieces([[1.0, 0.0]], 30.0, [1.0])
    t = np.linspace(0.0, 30.0, 3001)
    np.testing.assert_allclose(one.at(t), np.stack([np.cos(t), -np.sin(t)], axis=1), atol=3e-11)
    np.testing.assert_allclose(one.at(t, 1)[:, 0], -np.sin(t), atol=1e-10)
    assert len(one) == runs.steps[0]
    assert one.times[0] == 0.0
    assert one.times[-1] == 30.0


def test_a_start_at_rest_in_some_states():
    """u = v = 0 and a force that sets in like t^3: only their polynomials tell the states' sizes."""
    system = System(lambda s, p: (1.0, s.v, s.t * s.t * s.t - s.u), ("t", "u", "v"))
    runs = TaylorEngine(system, 1e-13).advance([[0.0, 0.0, 0.0]], 2.0)
    assert runs.states[0, 1] == pytest.approx(8.0 - 12.0 + 6.0 * np.sin(2.0), rel=1e-12)
    assert runs.steps[0] < 60


def test_there_and_back():
    starts = np.array([[0.5, 0.1], [1.5, -0.4]])
    engine = TaylorEngine(BOUNDED, 1e-15)
    there = engine.advance(starts, [3.0, 2.0], [0.5])
    back = engine.advance(there.states, [-3.0, -2.0], [0.5], begin=there.times)
    np.testing.assert_allclose(back.states, starts, atol=1e-13)
    np.testing.assert_array_equal(back.times, 0.0)


# lanes


def many(count: int = 41) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    r = np.random.default_rng(5)
    return r.normal(size=(count, 2)), r.uniform(1.0, 20.0, count), r.uniform(0.1, 2.0, (count, 1))


def assert_same_bits(a: TaylorRuns, b: TaylorRuns) -> None:
    for one, other in (
        (a.states, b.states),
        (a.times, b.times),
        (a.statuses, b.statuses),
        (a.steps, b.steps),
    ):
        assert one.tobytes() == other.tobytes()


@pytest.mark.parametrize("lanes", [1, 2, 8, 16])
def test_no_bit_depends_on_the_lanes(lanes):
    starts, spans, parameters = many()
    four = TaylorEngine(BOUNDED, lanes=4).advance(starts, spans, parameters)
    assert_same_bits(four, TaylorEngine(BOUNDED, lanes=lanes).advance(starts, spans, parameters))


def test_no_bit_depends_on_order_or_chunks():
    starts, spans, parameters = many()
    engine = TaylorEngine(BOUNDED, lanes=8)
    whole = engine.advance(starts, spans, parameters)
    order = np.random.default_rng(1).permutation(len(starts))
    mixed = engine.advance(starts[order], spans[order], parameters[order])
    back = np.argsort(order)
    assert mixed.states[back].tobytes() == whole.states.tobytes()
    parts = [
        engine.advance(starts[i : i + 7], spans[i : i + 7], parameters[i : i + 7]) for i in range(0, 41, 7)
    ]
    assert np.concatenate([part.states for part in parts]).tobytes() == whole.states.tobytes()
    walk = engine.blocks(starts, spans, parameters, block=13)
    for _ in walk:
        pass
    assert_same_bits(whole, walk.found)


def test_threads_share_an_engine():
    starts, spans, parameters = many()
    engine = TaylorEngine(BOUNDED, lanes=4)
    whole = engine.advance(starts, spans, parameters)
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(lambda _: engine.advance(starts, spans, parameters), range(8)):
            assert_same_bits(whole, found)


def test_a_lane_that_fails_leaves_the_others_alone():
    starts = np.array([[0.1], [2.0], [0.2], [np.nan], [-1.0], [0.3], [1e120]])
    parameters = np.ones((7, 1))
    good = [0, 2, 4, 5]
    engine = TaylorEngine(BLOWS_UP, lanes=4)
    runs = engine.advance(starts, 1.0, parameters)
    alone = engine.advance(starts[good], 1.0, parameters[good])
    assert runs.states[good].tobytes() == alone.states.tobytes()
    np.testing.assert_allclose(runs.states[good, 0], 1.0 / (1.0 / starts[good, 0] - 1.0), rtol=1e-8)
    assert runs.ended[1] == TaylorEnded.STUCK
    assert runs.times[1] == pytest.approx(0.5, rel=1e-8)
    assert runs.ended[3] == runs.ended[6] == TaylorEnded.RAN_AWAY


def test_a_state_that_grows_for_ever_has_run_away():
    system = System(lambda s, p: (s.x,), ("x",))
    runs = TaylorEngine(system).advance([[1.0], [0.0]], 300.0)
    assert runs.ended == [TaylorEnded.RAN_AWAY, TaylorEnded.ARRIVED]
    assert runs.times[0] == pytest.approx(100.0 * log(10.0), rel=0.05)
    assert np.isfinite(runs.states[0, 0])
    assert runs.states[1, 0] == 0.0


def test_a_state_that_is_no_number_any_more():
    """sqrt at zero: the coefficients are not finite there."""
    system = System(lambda s, p: (-rw.sqrt(s.x),), ("x",))
    runs = TaylorEngine(system).advance([[0.0], [-1.0]], 1.0)
    assert runs.ended == [TaylorEnded.RAN_AWAY] * 2


def test_steps_are_limited_exactly():
    runs = TaylorEngine(OSCILLATOR).advance([[1.0, 0.0]] * 3, [5.0, 50.0, 500.0], [1.0], steps=20)
    assert runs.ended == [TaylorEnded.ARRIVED, TaylorEnded.TOO_MANY, TaylorEnded.TOO_MANY]
    assert runs.steps.tolist()[1:] == [20, 20]


def test_a_trajectory_is_stopped_on_the_way():
    walk = TaylorEngine(OSCILLATOR, lanes=2).blocks([[1.0, 0.0]] * 5, 100.0, [1.0], block=16)
    for block in walk:
        if np.any(block.trajectories == 1):
            walk.stop(1)
    assert walk.found.ended == [TaylorEnded.STOPPED if i == 1 else TaylorEnded.ARRIVED for i in range(5)]
    assert walk.found.times[1] < 50.0


def test_no_time_at_all():
    runs = TaylorEngine(OSCILLATOR).advance([[1.0, 2.0]], 0.0, [1.0])
    assert runs.ended == [TaylorEnded.ARRIVED]
    assert runs.states.tolist() == [[1.0, 2.0]]


# parameters that vary with time


def test_driven_parameters_are_polynomials_between_knots():
    """x' = p(t) with kinks and a jump: the integral of each cubic, exactly."""
    system = System(lambda s, p: (p.a * p.b,), ("x",), {"a": 1.0, "b": 2.0})
    knots = np.array([0.0, 1.0, 2.5, 4.0])
    c = np.random.default_rng(2).normal(size=(3, 1, 4))
    runs = TaylorEngine(system, 1e-14, driven=("a",)).advance(
        [[0.5]] * 3, [4.0, 3.0, 6.0], [0.0, 2.0], drives=[Pieces(knots, c)]
    )
    whole = lambda k, h: sum(c[k, 0, j] * h ** (j + 1) / (j + 1) for j in range(4))  # noqa: E731
    first = whole(0, 1.0) + whole(1, 1.5)
    expected = [0.5 + 2.0 * (first + whole(2, h)) for h in (1.5, 0.5, 3.5)]
    np.testing.assert_allclose(runs.states[:, 0], expected, rtol=1e-13)


def test_driven_oscillator_against_scipy_and_back():
    system = System(lambda s, p: (s.v, -p.k * rw.sin(s.u) - 0.1 * s.v), ("u", "v"), {"k": 1.0})
    knots = np.array([0.0, 2.0, 5.0, 9.0])
    r = np.random.default_rng(8)
    drives = [Pieces(knots, r.uniform(0.0, 0.3, (3, 1, 4))) for _ in range(2)]
    starts = np.array([[1.0, 0.0], [0.5, 0.2], [1.0, 0.0]])
    engine = TaylorEngine(system, 1e-14, driven=("k",))
    runs = engine.advance(starts, 8.0, [0.0], drives=drives, drive_of=[0, 1, 1], begin=0.5)
    for start, which, end in zip(starts, (0, 1, 1), runs.states, strict=True):
        x, t = start, 0.5
        for stop in (2.0, 5.0, 8.5):
            x = solve_ivp(
                lambda t, x, d=drives[which]: (x[1], -d.at(t)[0] * np.sin(x[0]) - 0.1 * x[1]),
                (t, stop), x, method="DOP853", rtol=1e-13, atol=1e-14,
            ).y[:, -1]  # fmt: skip
            t = stop
        np.testing.assert_allclose(end, x, atol=1e-11)
    back = engine.advance(runs.states, -8.0, [0.0], drives=drives, drive_of=[0, 1, 1], begin=8.5)
    np.testing.assert_allclose(back.states, starts, atol=1e-12)


# tangents


def test_monodromy_matrix_in_lanes():
    """One direction a lane, the same steps in all: the derivative of the end by the start, against differences."""
    system = as_system(rw.paper_model().with_parameters({"wind.speed": 12.0}))
    parameters = np.array([*system.parameters.values()])
    start = np.array([0.02, 0.7, 0.01, 0.1, 0.0, -0.2])
    engine = TaylorEngine(with_tangents(system.tape), 1e-13, controlled=6)
    runs = engine.advance(np.hstack([np.tile(start, (6, 1)), np.eye(6)]), 1.1, parameters)
    assert len({end.tobytes() for end in runs.states[:, :6]}) == 1
    plain = TaylorEngine(system, 1e-15)
    h = 1e-4
    points = start + h * np.array([-2.0, -1.0, 1.0, 2.0])[:, None, None] * np.eye(6)
    ends = plain.advance(points.reshape(-1, 6), 1.1, parameters).states.reshape(4, 6, 6)
    differences = (ends[0] - 8.0 * ends[1] + 8.0 * ends[2] - ends[3]) / (12.0 * h)
    np.testing.assert_allclose(runs.states[:, 6:], differences, atol=2e-8)


def test_all_directions_in_one_lane():
    system = as_system(rw.paper_model())
    parameters = np.array([*system.parameters.values()])
    start = np.array([0.02, 0.7, 0.01, 0.1, 0.0, -0.2])
    one = TaylorEngine(with_tangents(system.tape), controlled=6)
    each = one.advance(np.hstack([np.tile(start, (6, 1)), np.eye(6)]), 1.0, parameters)
    all_of_them = TaylorEngine(with_tangents(system.tape, 6), controlled=6)
    together = all_of_them.advance([np.concatenate([start, np.eye(6).ravel()])], 1.0, parameters)
    np.testing.assert_allclose(
        together.states[0, 6:].reshape(6, 6), each.states[:, 6:], rtol=1e-12, atol=1e-12
    )


# the door


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"tolerance": 1e-16}, "tolerance"),
        ({"tolerance": "small"}, "tolerance"),
        ({"lanes": 3}, "lanes"),
        ({"order": 1}, "order"),
        ({"driven": ("q",)}, "'q' is no parameter"),
        ({"controlled": 3}, "controlled"),
    ],
)
def test_bad_engines(options, word):
    with pytest.raises(InputError, match=word):
        TaylorEngine(OSCILLATOR, **options)


@pytest.mark.parametrize(
    ("arguments", "more", "word"),
    [
        (([[1.0]], 1.0, [1.0]), {}, "starts"),
        (([[1.0, 0.0]], [1.0, 2.0], [1.0]), {}, "duration"),
        (([[1.0, 0.0]], np.nan, [1.0]), {}, "finite"),
        (([[1.0, 0.0]], 1.0), {}, "parameters are missing"),
        (([[1.0, 0.0]], 1.0, [1.0, 2.0]), {}, "parameters"),
        (([[1.0, 0.0]], 1.0, [1.0]), {"sizes": [1.0]}, "sizes"),
        (([[1.0, 0.0]], 1.0, [1.0]), {"drive_of": 1}, "drive_of"),
        (([[1.0, 0.0]], 1.0, [1.0]), {"drives": [Pieces(np.arange(2.0), np.ones((1, 1, 4)))]}, "drive"),
    ],
)
def test_bad_runs(arguments, more, word):
    with pytest.raises(InputError, match=word):
        TaylorEngine(OSCILLATOR).advance(*arguments, **more)


def test_code_is_kept_for_later_processes(monkeypatch, tmp_path):
    monkeypatch.setattr(machine_code, "_root", lambda: tmp_path)
    system = System(lambda s, p: (s.x * 0.123456,), ("x",))
    monkeypatch.setattr(machine_code, "_addresses", {})
    first = TaylorEngine(system).advance([[1.0]], 1.0)
    monkeypatch.setattr(machine_code, "_addresses", {})
    monkeypatch.setattr(machine_code, "_compile", lambda writer: pytest.fail("compiled again"))
    second = TaylorEngine(system).advance([[1.0]], 1.0)
    assert_same_bits(first, second)
    assert first.states[0, 0] == pytest.approx(exp(0.123456), rel=1e-9)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-13])
@pytest.mark.parametrize("k", [3, 6, 10, 14])
def test_a_series_with_gaps(k, tolerance):
    """x' = sin(t^k) from t = 0: the last two coefficients are zero there, and say nothing of the radius."""
    system = System(lambda s, p: (1.0, rw.sin(s.t**k)), ("t", "x"))
    runs = TaylorEngine(system, tolerance).advance([[0.0, 0.0]], 1.5)
    expected = quad(lambda t: np.sin(t**k), 0.0, 1.5, epsabs=1e-14, epsrel=1e-14, limit=500)[0]
    assert abs(runs.states[0, 1] - expected) < tolerance


def test_a_radius_that_seems_to_grow_at_once():
    """A force that sets in at a knot, from rest: the step before tells nothing of what comes."""
    system = System(
        lambda s, p: (s.v, p.force * rw.cos(3.0 * s.t) - 25.0 * s.u, 1.0), ("u", "v", "t"), {"force": 0.0}
    )
    drive = Pieces(np.array([0.0, 5.0, 6.0]), np.array([[[0.0]], [[1.0]]]))
    engine = TaylorEngine(system, 1e-12, driven=("force",))
    runs = engine.advance([[0.0, 0.0, 0.0]], 8.0, [0.0], drives=[drive])
    # u'' + 25 u = cos 3 t from t = 5 on, at rest there
    a = np.cos(15.0) / 16.0, -3.0 * np.sin(15.0) / 16.0
    expected = np.cos(24.0) / 16.0 - a[0] * np.cos(15.0) - a[1] * np.sin(15.0) / 5.0
    assert runs.states[0, 0] == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-12, 1e-15])
def test_what_has_decayed_costs_no_more(tolerance):
    """One state is gone within a second; stability limits the steps, and nothing makes them shrink."""
    system = System(lambda s, p: (-50.0 * s.x, rw.cos(s.t), 1.0), ("x", "y", "t"))
    runs = TaylorEngine(system, tolerance).advance([[1.0, 0.0, 0.0]] * 2, [50.0, 100.0])
    assert abs(runs.states[1, 0]) < 1e-14
    assert abs(runs.states[1, 1] - np.sin(100.0)) < max(tolerance, 1e-14)
    assert runs.steps[1] < 2.1 * runs.steps[0] < 2100


def test_decay_for_ever():
    """e^-t for 1e5 s: what is left is the error of steps, a share of a size that shrinks by 1/64 in each."""
    system = System(lambda s, p: (-s.x,), ("x",))
    runs = TaylorEngine(system).advance([[1.0]] * 2, [300.0, 1e5])
    assert runs.ended == [TaylorEnded.ARRIVED] * 2
    assert abs(runs.states[0, 0]) < 1e-9
    assert abs(runs.states[1, 0]) < 1e-100
