"""One trajectory: against closed forms and conserved quantities, against SciPy, and at its ends."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rainwind as rw
from rainwind.dynamics.system import as_system
from rainwind.errors import InputError

METHODS = ["auto", "taylor", "rosenbrock"]


def oscillator():
    return rw.System(lambda x, p: (x.v, -p.k * x.q), ("q", "v"), {"k": 1.0})


# ---- truth


@pytest.mark.parametrize(("method", "error"), [("auto", 1e-11), ("taylor", 1e-11), ("rosenbrock", 1e-10)])
def test_harmonic_oscillator(method, error):
    run = rw.simulate(oscillator(), {"q": 1.0}, duration=200.0, tolerance=1e-13, method=method)
    t = np.linspace(0.0, 200.0, 4001)
    assert np.abs(run.at(t) - np.stack([np.cos(t), -np.sin(t)], axis=1)).max() < error
    assert np.abs(run.at(t, 1)[:, 0] + np.sin(t)).max() < 10 * error
    assert run.ended is rw.RunEnded.DURATION
    assert run.duration == 200.0


def test_kepler():
    """Eccentricity 0.6: energy -1/2, angular momentum 0.8, back at the start after 2 pi."""

    def rhs(x, p):
        cube = (x.x * x.x + x.y * x.y) ** 1.5
        return x.u, x.v, -x.x / cube, -x.y / cube

    system = rw.System(rhs, ("x", "y", "u", "v"))
    start = [0.4, 0.0, 0.0, 2.0]
    run = rw.simulate(system, start, duration=20 * np.pi, tolerance=1e-12)
    x, y, u, v = run.at(np.linspace(0.0, 20 * np.pi, 2001)).T
    assert np.abs((u * u + v * v) / 2 - 1 / np.hypot(x, y) + 0.5).max() < 1e-11
    assert np.abs(x * v - y * u - 0.8).max() < 1e-11
    assert run.end == pytest.approx(start, abs=1e-9)
    found = run.section(lambda x, p: x.x * x.u + x.y * x.v, direction=1)  # nearest to the centre
    assert found.times == pytest.approx(2 * np.pi * np.arange(1, len(found) + 1), abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_lotka_volterra(method):
    system = rw.System(lambda x, p: (x.a * (1.5 - x.b), x.b * (x.a - 3.0)), ("a", "b"))
    run = rw.simulate(system, [4.0, 2.0], duration=30.0, tolerance=1e-11, method=method)
    invariant = run.value(lambda x, p: x.a - 3 * rw.log(x.a) + x.b - 1.5 * rw.log(x.b), run.times)
    assert np.ptp(invariant) < 1e-9
    reference = solve_ivp(
        lambda t, x: [x[0] * (1.5 - x[1]), x[1] * (x[0] - 3.0)], (0, 30.0), [4.0, 2.0], method="DOP853", rtol=1e-13,
        atol=1e-13,
    )  # fmt: skip
    assert run.end == pytest.approx(reference.y[:, -1], rel=1e-8)


@pytest.mark.parametrize("outside", ["blend", "extend"])
@pytest.mark.parametrize("degrees_of_freedom", [2, 3])
def test_the_cable_as_scipy_has_it(outside, degrees_of_freedom):
    model = rw.paper_model(outside=outside, degrees_of_freedom=degrees_of_freedom)
    system = as_system(model.with_parameters({"wind.speed": 11.0}))
    start = system.state({"phi": 0.9, "y": 0.03, "y_dot": 0.1})
    run = rw.simulate(system, start, duration=20.0, tolerance=1e-12)
    reference = solve_ivp(
        lambda t, x: system.f(x), (0, 20.0), start, method="DOP853", rtol=1e-12, atol=1e-13, dense_output=True
    )
    t = np.linspace(0.0, 20.0, 101)
    assert np.abs(run.at(t) - reference.sol(t).T).max() < 2e-9


@pytest.mark.parametrize("method", METHODS)
def test_a_driven_wind_as_scipy_has_it(method):
    """A ramp, then a jump: SciPy integrates the three smooth parts."""
    model = rw.paper_model(outside="extend")
    system = as_system(model)
    wind = rw.ramp(9.0, 13.0, 4.0, after=2.0, hold=3.0).then(rw.ramp(10.0, 10.0, 0.0))
    start = system.state({"phi": 0.9})
    run = rw.simulate(model, start, duration=15.0, wind=wind, tolerance=1e-12, method=method)
    x = start
    for a, b in ((0.0, 2.0), (2.0, 6.0), (6.0, 9.0), (9.0, 15.0)):
        x = solve_ivp(
            lambda t, x, a=a, b=b: system.f(x, {"wind.speed": wind.at(min(max(t, a), b - 1e-12))}), (a, b), x,
            method="DOP853", rtol=1e-12, atol=1e-13,
        ).y[:, -1]  # fmt: skip
    assert run.end == pytest.approx(x, abs=1e-8)
    assert {2.0, 6.0, 9.0} <= set(run.times.tolist())
    assert run["wind.speed"][[0, -1]].tolist() == [9.0, 10.0]
    assert run.driven_at(4.0) == pytest.approx([11.0])


def test_wind_is_short_for_the_parameter():
    model = rw.paper_model(outside="extend")
    runs = [
        rw.simulate(model, {"phi": 0.9}, duration=5.0, wind=12.0),
        rw.simulate(model, {"phi": 0.9}, duration=5.0, parameters={"wind.speed": 12.0}),
        rw.simulate(model.with_parameters({"wind.speed": 12.0}), {"phi": 0.9}, duration=5.0),
        rw.simulate(model, {"phi": 0.9}, duration=5.0, wind=rw.ramp(12.0, 12.0, 1.0)),
    ]
    for run in runs:
        assert run.end == pytest.approx(runs[0].end, abs=1e-10)
    assert runs[0].parameters["wind.speed"] == 12.0


# ---- which engine


def light(mass):
    return rw.paper_model(outside="extend").with_parameters({"rivulet.mass": mass, "wind.speed": 12.0})


def test_the_engine_is_chosen_by_cost():
    smooth = rw.simulate(light(0.2), {"phi": 1.0}, duration=30.0)
    assert smooth.steps["rosenbrock"] == 0
    stiff = rw.simulate(light(1e-4), {"phi": 1.0}, duration=30.0)
    assert stiff.steps["taylor"] <= 512
    assert stiff.steps["rosenbrock"] > 1000
    sure = rw.simulate(light(1e-4), {"phi": 1.0}, duration=30.0, method="rosenbrock")
    assert stiff.end == pytest.approx(sure.end, abs=1e-8)


def test_a_run_that_becomes_stiff_and_smooth_again_changes_engines():
    """Two masses on a damper that rises a millionfold for a while."""
    system = rw.System(
        lambda x, p: (x.v, -x.q - 0.1 * x.v + (x.w - x.v), p.c * (x.v - x.w) - x.w),
        ("q", "v", "w"),
        {"c": 1.0},
    )
    c = rw.ramp(1.0, 1e6, 0.5, after=20.0, hold=60.0).then(rw.ramp(1e6, 1.0, 0.5, hold=40.0))
    options = {"parameters": {"c": c}, "duration": 120.0}
    run = rw.simulate(system, [1.0, 0.0, 0.0], **options)
    assert run.steps["taylor"] > 100
    assert run.steps["rosenbrock"] > 100
    sure = rw.simulate(system, [1.0, 0.0, 0.0], method="rosenbrock", tolerance=1e-11, **options)
    for t in (10.0, 20.2, 50.0, 120.0):
        assert run.at(t) == pytest.approx(sure.at(t), abs=1e-9)
    # Taylor steps again behind the stiff part: they are the longer ones
    assert np.diff(run.times)[-2] > 0.2


def test_stiffness_after_a_long_smooth_run_is_met_at_once():
    """A follower of an oscillator, w' = c (v - w): the pauses between trials have grown when c rises."""
    system = rw.System(lambda x, p: (x.v, -x.q, p.c * (x.v - x.w)), ("q", "v", "w"), {"c": 1.0})
    smooth = rw.simulate(system, [1.0, 0.0, 0.0], duration=5000.0)
    assert smooth.steps["rosenbrock"] == 0
    c = rw.ramp(1.0, 1e6, 0.5, after=5000.0)
    run = rw.simulate(system, [1.0, 0.0, 0.0], duration=5100.0, parameters={"c": c})
    assert run.steps["rosenbrock"] > 0
    assert run.steps["taylor"] < smooth.steps["taylor"] + 600


@pytest.mark.parametrize("mu", [0.5, 50.0, 1e5])
def test_van_der_pol_by_all_ways(mu):
    system = rw.System(lambda x, p: (x.v, p.mu * (1 - x.q**2) * x.v - x.q), ("q", "v"), {"mu": mu})
    ends = [
        rw.simulate(system, [2.0, 0.0], duration=1.3 * max(mu, 10.0), method=method, tolerance=1e-10).end
        for method in (["auto", "rosenbrock"] if mu > 100 else METHODS)
    ]
    for end in ends:
        assert end == pytest.approx(ends[0], rel=1e-6)


def test_a_run_repeated_is_the_same_run():
    one, two = (rw.simulate(light(1e-3), {"phi": 1.0}, duration=20.0) for _ in range(2))
    assert one.times.tolist() == two.times.tolist()
    assert one.end.tolist() == two.end.tolist()


def test_where_taylor_series_do_not_exist_the_other_engine_helps():
    """A spring like |x|^2.5 from x = 0: no third derivative there, yet a perfectly good solution."""
    system = rw.System(lambda x, p: (x.y - (x.x * x.x) ** 1.25, -x.x), ("x", "y"))
    run = rw.simulate(system, [0.0, 1.0], duration=20.0)
    assert run.ended is rw.RunEnded.DURATION
    assert run.steps["rosenbrock"] > 0
    reference = solve_ivp(
        lambda t, x: [x[1] - abs(x[0]) ** 2.5, -x[0]],
        (0, 20.0),
        [0.0, 1.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-12,
    )
    assert run.end == pytest.approx(reference.y[:, -1], abs=1e-6)
    alone = rw.simulate(system, [0.0, 1.0], duration=20.0, method="taylor")
    assert alone.ended is rw.RunEnded.STEP_TOO_SMALL
    assert len(alone) == 0


# ---- ends


def test_a_run_that_blows_up_keeps_what_is_good():
    """x' = x^2 from 1: x = 1 / (1 - t)."""
    run = rw.simulate(rw.System(lambda x, p: (x.x * x.x,), ("x",)), [1.0], duration=5.0)
    assert run.ended is rw.RunEnded.RAN_AWAY
    assert not run.finished
    assert run.duration == pytest.approx(1.0, abs=1e-6)
    assert np.all(np.isfinite(run.state))
    t = np.linspace(0.0, 0.99, 50)
    x = 1 / (1 - t)
    assert np.all(np.abs(run.at(t)[:, 0] - x) < 2e-8 * x * x)  # an error of the time counts x^2-fold
    assert "t = 1" in run.note


def test_growth_that_goes_on_is_no_blow_up():
    run = rw.simulate(rw.System(lambda x, p: (x.x,), ("x",)), [1.0], duration=200.0, tolerance=1e-12)
    assert run.ended is rw.RunEnded.DURATION
    assert run.end[0] == pytest.approx(np.exp(200.0), rel=1e-9)
    far = rw.simulate(rw.System(lambda x, p: (x.x,), ("x",)), [1.0], duration=300.0)
    assert far.ended is rw.RunEnded.RAN_AWAY
    assert far.duration == pytest.approx(100 * np.log(10.0), abs=2.0)


def test_a_singular_end():
    """x' = -1 / x from 1 reaches zero at 1/2 with an infinite rate."""
    run = rw.simulate(rw.System(lambda x, p: (-1 / x.x,), ("x",)), [1.0], duration=5.0)
    assert run.ended is rw.RunEnded.STEP_TOO_SMALL
    assert run.duration == pytest.approx(0.5, abs=1e-7)
    assert np.all(np.isfinite(run.state))


def test_a_start_where_the_rates_are_not_finite():
    run = rw.simulate(rw.System(lambda x, p: (rw.log(x.x),), ("x",)), [-1.0], duration=5.0)
    assert run.ended is rw.RunEnded.STEP_TOO_SMALL
    assert len(run) == 0
    assert run.end.tolist() == [-1.0]
    assert run.state.tolist() == [[-1.0]]
    assert run.settled().kind == "not settled"
    assert "no step" in repr(run)


@pytest.mark.parametrize("speed", [8.0, 9.0])
def test_a_rivulet_that_is_lost_ends_soon(speed):
    """Extended coefficients drive the rivulet round for ever faster: a reason, and few steps."""
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": speed})
    run = rw.simulate(model, {"phi": 1.0}, duration=1000.0)
    assert run.ended is rw.RunEnded.RAN_AWAY
    assert len(run) < 100_000
    assert run.outside[-1].until == run.duration


def test_too_many_steps():
    run = rw.simulate(oscillator(), [1.0, 0.0], duration=1e6, most_steps=1000)
    assert run.ended is rw.RunEnded.TOO_MANY_STEPS
    assert len(run) == 1000
    assert run.end == pytest.approx([np.cos(run.duration), -np.sin(run.duration)], abs=1e-6)


def test_ctrl_c_keeps_what_is_done():
    seen = []

    def progress(done, total, what):
        seen.append((done, total, what))
        if len(seen) == 3:
            raise KeyboardInterrupt

    run = rw.simulate(oscillator(), [1.0, 0.0], duration=1e5, progress=progress)
    assert run.ended is rw.RunEnded.INTERRUPTED
    assert 0.0 < run.duration < 1e5
    assert run.end == pytest.approx([np.cos(run.duration), -np.sin(run.duration)], abs=1e-6)


def test_progress_rises_to_the_end():
    seen = []
    rw.simulate(oscillator(), [1.0, 0.0], duration=3000.0, progress=lambda *facts: seen.append(facts))
    shares = [done for done, _, _ in seen]
    assert shares == sorted(shares)
    assert seen[-1][:2] == (1000, 1000)
    assert len(seen) > 3


# ---- the range in which a model holds


def test_a_model_that_refuses_ends_where_it_leaves_its_range():
    model = rw.paper_model(outside="refuse").with_parameters({"wind.speed": 9.0})
    run = rw.simulate(model, {"phi": 1.0}, duration=600.0)
    low, high = model.coefficients.valid
    assert run.ended is rw.RunEnded.LEFT_VALIDITY
    alpha = float(model.angle_of_attack(run.end, model.parameters))
    assert min(abs(alpha - low), abs(alpha - high)) < 1e-12
    assert "angle of attack" in run.note
    before = run.value(model.angle_of_attack, np.linspace(0.0, run.duration, 5000))
    assert np.all((before > low - 1e-12) & (before < high + 1e-12))
    extended = rw.paper_model(outside="extend").with_parameters({"wind.speed": 9.0})
    goes_on = rw.simulate(extended, {"phi": 1.0}, duration=run.duration + 0.1)
    assert goes_on.outside[0].since == pytest.approx(run.duration, abs=1e-5)
    assert goes_on.at(run.duration) == pytest.approx(run.end, abs=1e-5)


def test_a_model_that_does_not_refuse_says_where_and_how_long():
    """A position q = 2 sin t that is known up to 1: beyond it from arcsin 1/2 to pi - arcsin 1/2."""

    def margin(x, p):
        return 1.0 - x.q

    system = rw.System(lambda x, p: (x.v, -x.q), ("q", "v"), limits={"position": (lambda x, p: x.q, margin)})
    run = rw.simulate(system, [0.0, 2.0], duration=8.0, tolerance=1e-12)
    first, second = run.outside
    assert (first.since, first.until) == pytest.approx((np.pi / 6, 5 * np.pi / 6), abs=1e-11)
    assert first.duration == pytest.approx(2 * np.pi / 3, abs=1e-11)
    assert first.value == pytest.approx(1.0, abs=1e-14)
    assert second.until == pytest.approx(8.0)  # still out there
    assert second.since == pytest.approx(2 * np.pi + np.pi / 6, abs=1e-11)
    begun = rw.simulate(system, [1.5, 0.0], duration=1.0)
    assert begun.outside[0].since == 0.0
    assert "beyond the model's limits" in repr(begun)


def test_a_start_that_is_refused():
    model = rw.paper_model(outside="refuse")
    with pytest.raises(InputError, match=r"cannot start here: angle of attack .* is outside"):
        rw.simulate(model, {"phi": 3.0}, duration=1.0)


# ---- the door


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"duration": 0.0}, "duration = 0.0: give a positive time"),
        ({"duration": -1.0}, "positive time"),
        ({"duration": np.nan}, "duration must be a finite number"),
        ({"duration": np.inf}, "duration must be a finite number"),
        ({"duration": "long"}, "duration must be a finite number"),
        ({"tolerance": 0.0}, "tolerance = 0.0: give a number from 1e-15 to 0.01"),
        ({"tolerance": 0.5}, "tolerance"),
        ({"tolerance": np.nan}, "tolerance must be a finite number"),
        ({"method": "euler"}, "choose auto, taylor or rosenbrock"),
        ({"most_steps": 0}, "most_steps = 0"),
        ({"most_steps": 2.5}, "most_steps = 2.5"),
        ({"parameters": {"m": 1.0}}, "no parameter 'm'"),
        ({"parameters": {"k": np.nan}}, "parameter 'k' must be a finite number"),
        ({"parameters": {"k": "stiff"}}, "parameter 'k' must be a finite number"),
        ({"parameters": [1.0]}, "parameters go by name"),
        ({"wind": 9.0}, "no parameter 'wind.speed', so it takes no wind"),
        ({"parameters": {"k": rw.ramp(1.0, 2.0, 1.0, hold=2.0)}}, "given from 0 to 3, the run goes from 0 to 10"),
        ({"parameters": {"k": rw.ramp(1.0, 2.0, 1.0).shifted(1.0)}}, "given from 1 to inf"),
    ],
)  # fmt: skip
def test_wrong_options(options, message):
    with pytest.raises(InputError, match=message):
        rw.simulate(oscillator(), [1.0, 0.0], **{"duration": 10.0, **options})


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ([1.0], "a state is 2 finite numbers"),
        ([1.0, 2.0, 3.0], "a state is 2 finite numbers"),
        ([1.0, np.nan], "a state is 2 finite numbers"),
        ({"w": 1.0}, "no state 'w'"),
        ({"q": np.inf}, "state 'q' must be a finite number"),
        ({}, "names no state"),
        ("left", "a state is 2 finite numbers"),
        (None, "a state is 2 finite numbers"),
    ],
)
def test_wrong_starts(start, message):
    with pytest.raises(InputError, match=message):
        rw.simulate(oscillator(), start, duration=1.0)


def test_values_that_a_model_does_not_allow():
    model = rw.paper_model(outside="extend")
    with pytest.raises(InputError, match=r"rivulet\.mass"):
        rw.simulate(model, {"phi": 1.0}, duration=1.0, parameters={"rivulet.mass": -1.0})
    with pytest.raises(InputError, match=r"the signal of 'wind\.speed' reaches -2"):
        rw.simulate(model, {"phi": 1.0}, duration=9.0, wind=rw.ramp(5.0, -2.0, 9.0))
    rw.simulate(model, {"phi": 1.0}, duration=1.0, wind=rw.ramp(5.0, -2.0, 9.0))  # stays above zero
    with pytest.raises(InputError, match="are the same thing"):
        rw.simulate(model, {"phi": 1.0}, duration=1.0, wind=9.0, parameters={"wind.speed": 9.0})
    with pytest.raises(InputError, match="is no model"):
        rw.simulate(3.0, [1.0], duration=1.0)


def test_starts_of_many_kinds():
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 12.0})
    first = rw.find_equilibria(model)[0]
    assert rw.simulate(model, first, duration=0.1).start.tolist() == first.state.tolist()
    run = rw.simulate(model, {"phi": 1.0}, duration=300.0)
    more = rw.simulate(model, run, duration=1.0)
    assert more.start.tolist() == run.end.tolist()
    orbit = rw.find_orbit(model, run.end)
    assert rw.find_orbit(model, run).period == pytest.approx(orbit.period, rel=1e-8)
    with pytest.raises(InputError, match="give a point of this system"):
        rw.find_orbit(oscillator(), run)
    around = rw.simulate(model, orbit, duration=orbit.period, tolerance=1e-12)
    assert around.end == pytest.approx(orbit.profile[0], abs=1e-6)
    with pytest.raises(InputError, match="give a point of this model"):
        rw.simulate(oscillator(), first, duration=1.0)


# ---- what a trajectory offers


def test_columns_and_times():
    run = rw.simulate(oscillator(), {"q": 1.0}, duration=10.0)
    assert run["q"].shape == run.times.shape == (len(run) + 1,)
    assert run.state.shape == (len(run) + 1, 2)
    assert run.state[-1].tolist() == run.end.tolist()
    assert run.at(3.0).shape == (2,)
    assert run.at([[1.0, 2.0]]).shape == (1, 2, 2)
    assert run["k"].tolist() == [1.0] * (len(run) + 1)
    with pytest.raises(InputError, match="no state or parameter 'w'"):
        run["w"]
    with pytest.raises(InputError, match="no state at t = 11"):
        run.at(11.0)
    assert "taylor steps; the duration is over" in repr(run)


def test_to_xarray_has_units():
    model = rw.paper_model(outside="extend")
    run = rw.simulate(model, {"phi": 1.0}, duration=5.0, wind=rw.ramp(9.0, 10.0, 5.0))
    data = run.to_xarray(np.linspace(0.0, 5.0, 11))
    assert data["y"].attrs["units"] == "m"
    assert data["phi_dot"].attrs["units"] == "rad/s"
    assert data["wind.speed"].attrs["units"] == "m/s"
    assert data["time"].attrs["units"] == "s"
    assert data["phi"].values == pytest.approx(run.at(np.linspace(0.0, 5.0, 11))[:, 1])
    assert data["wind.speed"].values[-1] == pytest.approx(10.0)
    assert data.attrs["rivulet.mass"] == 0.2
    assert "units" not in rw.simulate(oscillator(), [1.0, 0.0], duration=1.0).to_xarray()["q"].attrs
    with pytest.raises(InputError, match="no state at t = 6"):
        run.to_xarray([6.0])
    with pytest.raises(InputError, match="one row of numbers"):
        run.to_xarray([[1.0]])


def test_a_trajectory_saved_and_loaded_is_the_same(tmp_path):
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 12.0})
    top = rw.Event("top", lambda x, p: x.y_dot, direction=-1)
    never = rw.Event("never", lambda x, p: x.y - 100.0, terminal=True)
    run = rw.simulate(model, {"phi": 1.0}, duration=30.0, wind=rw.ramp(11.0, 12.0, 5.0), events=[top, never])
    rw.save(run, tmp_path / "run.nc")
    same = rw.load(tmp_path / "run.nc")
    t = np.linspace(0.0, 30.0, 301)
    assert same.at(t).tolist() == run.at(t).tolist()
    assert same.ended is rw.RunEnded.DURATION
    assert same.parameters == run.parameters
    assert same.events["top"].times.tolist() == run.events["top"].times.tolist()
    assert same.events["top"].rising.dtype == bool
    assert len(same.events["never"]) == 0
    assert same["wind.speed"].tolist() == run["wind.speed"].tolist()
    assert repr(same) == repr(run)
    assert same.section(("y", 0.0)).times.tolist() == run.section(("y", 0.0)).times.tolist()
    assert same.settled() == run.settled()
    rw.save(run, tmp_path / "run.csv")
    first, *rows = (tmp_path / "run.csv").read_text(encoding="utf-8").splitlines()
    assert first == "time [s],y [m],phi [rad],z [m],y_dot [m/s],phi_dot [rad/s],z_dot [m/s],wind.speed [m/s]"
    assert len(rows) == len(run) + 1
