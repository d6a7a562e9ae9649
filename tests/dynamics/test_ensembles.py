"""Many trajectories: each is the one that `simulate` gives, whatever stands beside it."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import ensemble_plan, workers


def _pendulum() -> rw.System:
    return rw.System(
        lambda x, p: (x.w, -p.k * rw.sin(x.a) - p.d * x.w), states=("a", "w"), parameters={"k": 1.0, "d": 0.1}
    )


def _same(a: rw.Ensemble, b: rw.Ensemble) -> None:
    for name in ("final", "times", "codes", "steps"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
    for name, array in a.values.items():
        np.testing.assert_array_equal(array, b.values[name], err_msg=name)


def test_each_trajectory_is_that_of_simulate():
    a = np.linspace(-2.0, 3.0, 11)
    run = rw.ensemble(_pendulum(), {"w": 0.5}, varying={"a": a, "d": 0.01 * a**2}, duration=30.0)
    assert run.finished.all()
    for i in (0, 4, 10):
        one = rw.simulate(
            _pendulum(),
            {"a": float(a[i]), "w": 0.5},
            duration=30.0,
            parameters={"d": 0.01 * float(a[i]) ** 2},
        )
        np.testing.assert_array_equal(run.final[i], one.end)
        assert run.steps[i].tolist() == [one.steps["taylor"], 0]


def test_no_number_depends_on_chunks_or_threads():
    sample = rw.latin_hypercube({"a": (-3.0, 3.0), "d": rw.lognormal(0.1, 1.0), "k": (0.5, 2.0)}, 41)
    reduce = (
        rw.Extremes(since=5.0),
        rw.Mean(),
        rw.Returns("a"),
        rw.Settled(),
        rw.TimeTo("a", 0.0),
        "lyapunov",
    )

    def one(**how) -> rw.Ensemble:
        return rw.ensemble(_pendulum(), varying=sample, duration=20.0, reduce=reduce, **how)

    first = one(workers=1, chunk=41)
    for how in ({"workers": 1, "chunk": 1}, {"workers": 2, "chunk": 5}, {"workers": 3, "chunk": 13}):
        _same(first, one(**how))


def test_a_trajectory_that_runs_away_spoils_no_other():
    system = rw.System(lambda x, p: (p.a * x.x * x.x,), states=("x",), parameters={"a": 1.0})
    a = np.array([-1.0, 0.5, 2.0, -3.0, 0.1])
    run = rw.ensemble(system, [1.0], varying={"a": a}, duration=5.0, workers=1)
    assert run.ended.tolist() == [
        rw.RunEnded.DURATION, rw.RunEnded.RAN_AWAY, rw.RunEnded.RAN_AWAY, rw.RunEnded.DURATION, rw.RunEnded.DURATION,
    ]  # fmt: skip
    good = run.finished
    np.testing.assert_allclose(run["x"][good], 1.0 / (1.0 - 5.0 * a[good]), rtol=1e-8)
    np.testing.assert_allclose(run.times[~good], 1.0 / a[~good], rtol=1e-6)
    assert np.isnan(run["highest", "x"][~good]).all()
    first, second = run.failures
    assert (first.number, first.varied, first.start) == (1, {"a": 0.5}, {"x": 1.0})
    assert "a = 2" in str(second)
    assert "2 did not reach the end" in repr(run)
    assert len(run.where(good)) == 3


def test_a_model_that_refuses_ends_where_simulate_ends():
    model = rw.paper_model(coefficients="reconstructed", outside="refuse")
    phi = np.array([0.6, 1.4, 1.5, 2.5])
    run = rw.ensemble(model, {"phi_dot": 20.0}, varying={"phi": phi}, wind=12.0, duration=20.0, workers=1)
    assert run.limit_names == ("angle of attack",)
    left = 0
    for i in range(3):
        one = rw.simulate(model, {"phi": float(phi[i]), "phi_dot": 20.0}, duration=20.0, wind=12.0)
        assert run.ended[i] is one.ended
        assert run.times[i] == pytest.approx(one.duration, abs=1e-9)
        np.testing.assert_allclose(run.final[i], one.end, atol=1e-9)
        left += one.ended is rw.RunEnded.LEFT_VALIDITY
    assert left == 2
    # outside from the start: `simulate` refuses, here it is a failure
    assert run.ended[3] is rw.RunEnded.LEFT_VALIDITY
    assert run.times[3] == 0.0
    assert "angle of attack" in str(run.failures[-1])


def _stiff() -> rw.System:
    # x follows cos(t) at the rate k: x' = -k (x - cos t); the angle is a state
    return rw.System(
        lambda x, p: (-p.k * (x.x - rw.cos(x.t)), 1.0), states=("x", "t"), parameters={"k": 10.0}
    )


def test_stiff_trajectories_go_to_the_other_method_each_by_itself(monkeypatch):
    monkeypatch.setattr(ensemble_plan, "PAUSE", 512)
    k = np.array([1.0, 1e5, 10.0, 1e6, 2.0])
    how = {"duration": 20.0, "tolerance": 1e-8, "reduce": (rw.Extremes(since=10.0), rw.Mean("t"))}
    run = rw.ensemble(_stiff(), [0.0, 0.0], varying={"k": k}, workers=1, **how)
    assert (run.steps[:, 1] > 0).tolist() == [False, True, False, True, False]
    assert run.finished.all()
    exact = (k**2 * np.cos(20.0) + k * np.sin(20.0)) / (k**2 + 1.0)
    np.testing.assert_allclose(run["x"][1:], exact[1:], atol=1e-7)
    # along its steps the stiff method knows the state less well than at their ends
    np.testing.assert_allclose(run["highest", "x"][1:], k[1:] / np.sqrt(k[1:] ** 2 + 1.0), atol=1e-4)
    np.testing.assert_allclose(run["mean", "t"], 10.0, rtol=1e-9)
    for i in range(5):
        alone = rw.ensemble(_stiff(), [0.0, 0.0], varying={"k": k[i : i + 1]}, workers=1, **how)
        np.testing.assert_array_equal(alone.final[0], run.final[i])
        np.testing.assert_array_equal(alone["amplitude"][0], run["amplitude"][i])


def test_observables_follow_the_stiff_method_too(monkeypatch):
    monkeypatch.setattr(ensemble_plan, "PAUSE", 256)
    run = rw.ensemble(
        _stiff(), [0.0, 0.0], varying={"k": [10.0, 1e6]}, duration=20.0, workers=1, tolerance=1e-8,
        observe={"square": lambda x, p: x.x * x.x, "rate": lambda x, p: p.k * x.t},
        reduce=(rw.Mean("square", since=10.0), rw.Extremes(("square", "rate"), since=10.0)),
    )  # fmt: skip
    assert run.steps[1, 1] > 0
    share = run["k"] / np.sqrt(run["k"] ** 2 + 1.0)
    np.testing.assert_allclose(run["highest", "square"], share**2, rtol=1e-4)
    np.testing.assert_allclose(run["highest", "rate"], 20.0 * run["k"], rtol=1e-9)
    # cos(t - d)^2 from 10 to 20, with tan d = 1/k
    d = np.arctan(1.0 / run["k"])
    mean = share**2 * (0.5 + (np.sin(40.0 - 2 * d) - np.sin(20.0 - 2 * d)) / 40.0)
    np.testing.assert_allclose(run["mean", "square"], mean, rtol=1e-4)


def test_too_many_steps_are_told():
    run = rw.ensemble(_pendulum(), [1.0, 0.0], varying={"k": [1.0, 400.0]}, duration=20.0, most_steps=60)
    assert run.ended.tolist() == [rw.RunEnded.DURATION, rw.RunEnded.TOO_MANY_STEPS]
    assert run.times[1] < 20.0


def test_a_wind_that_varies_is_the_same_for_all():
    model = rw.paper_model(coefficients="reconstructed")
    wind = rw.ramp(9.0, 12.0, duration=12.0)
    y = np.array([0.0, 0.01, 0.02])
    run = rw.ensemble(model, {"phi": 0.6}, varying={"y": y}, wind=wind, duration=12.0)
    one = rw.simulate(model, {"phi": 0.6, "y": 0.01}, wind=wind, duration=12.0)
    np.testing.assert_array_equal(run.final[1], one.end)


def test_a_grid_keeps_its_shape():
    sample = rw.grid({"a": [0.5, 1.0], "k": [1.0, 2.0, 3.0]})
    run = rw.ensemble(_pendulum(), varying=sample, duration=5.0, reduce=("extremes", "settled"))
    assert run.shape == (2, 3)
    assert run.on_grid(("amplitude", "a")).shape == (2, 3)
    assert run.on_grid("amplitude").shape == (2, 3, 2)
    assert run.on_grid("settled")[1, 2] == run["settled"][5]
    data = run.to_xarray()
    assert data["amplitude"].dims == ("a", "k", "state")
    assert float(data["final"].sel(a=1.0, k=3.0, state="w")) == run["w"][5]
    assert data["ended"].values[0, 0] == "the duration is over"
    assert run.parameters["d"].tolist() == [0.1] * 6


def test_units_reach_xarray():
    model = rw.paper_model(coefficients="reconstructed")
    data = rw.ensemble(model, [0.0] * 6, varying={"wind.speed": [9.0, 10.0]}, duration=1.0).to_xarray()
    assert data["end_time"].attrs["units"] == "s"
    assert data.attrs["section.mass"] == 50.0


def test_progress_counts_all_and_an_interrupt_keeps_what_is_done():
    said: list[tuple[int, int, str]] = []
    starts = np.random.default_rng(0).normal(size=(200, 2))
    rw.ensemble(_pendulum(), starts, duration=20.0, chunk=20, progress=lambda *one: said.append(one))
    done = [one[0] for one in said]
    assert done == sorted(done)
    assert (done[0], done[-1]) == (0, 200)
    assert all(one[1] == 200 for one in said)

    def stop(done: int, total: int, what: str) -> None:
        if done >= 40:
            raise KeyboardInterrupt

    part = rw.ensemble(_pendulum(), starts, duration=20.0, chunk=20, workers=1, progress=stop)
    assert part.interrupted
    assert 40 <= part.done.sum() < 200
    assert (part.ended == rw.RunEnded.INTERRUPTED).sum() == (~part.done).sum()
    assert np.isnan(part.final[~part.done]).all()
    assert "interrupted" in repr(part)


def test_a_rate_and_the_time_left_are_told(monkeypatch):
    from rainwind.dynamics import ensembles

    monkeypatch.setattr(ensembles, "monotonic", lambda: 100.0)
    assert ensembles._rate(0, 10, 0.0) == "trajectories"
    assert ensembles._rate(500, 1000, 0.0) == "5 trajectories/s, 3 min left"
    assert ensembles._rate(500, 100, 0.0) == "5 trajectories/s, 20 s left"
    assert ensembles._rate(10, 1000, 0.0) == "0.1 trajectories/s, 2.8 h left"


def test_a_checkpoint_is_gone_on_from(tmp_path, monkeypatch):
    starts = np.random.default_rng(0).normal(size=(100, 2))

    def run(folder=None, chunk: int = 10, progress=None, **more) -> rw.Ensemble:
        how = {"duration": 10.0, "reduce": ("extremes", "settled"), **more}
        return rw.ensemble(
            _pendulum(), starts, workers=1, checkpoint=folder, chunk=chunk, progress=progress, **how
        )

    def stop(done: int, total: int, what: str) -> None:
        if done >= 40:
            raise KeyboardInterrupt

    whole = run()
    part = run(tmp_path / "kept", progress=stop)
    count = int(part.done.sum())
    assert 40 <= count < 100
    (tmp_path / "kept" / ".rows-90-100.npz.1.part").write_bytes(b"torn")
    seen: list[int] = []
    computed: list[int] = []

    def counted(plan, rows, stopped):
        computed.append(len(rows))
        return ensemble_plan.compute(plan, rows, stopped)

    monkeypatch.setattr(workers, "compute", counted)
    again = run(tmp_path / "kept", chunk=7, progress=lambda done, total, what: seen.append(done))
    assert seen[0] == count
    assert sum(computed) == 100 - count  # nothing is done again
    _same(whole, again)
    # a damaged chunk is computed once more
    files = sorted((tmp_path / "kept").glob("rows-*.npz"))
    files[0].write_bytes(files[0].read_bytes()[:200])
    _same(whole, run(tmp_path / "kept"))
    with pytest.raises(rw.RainwindError, match="differs in duration, reductions"):
        run(tmp_path / "kept", duration=11.0, reduce="mean")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "letter.txt").write_text("dear")
    with pytest.raises(rw.RainwindError, match="is not empty"):
        run(tmp_path / "other")


@pytest.mark.parametrize(
    ("more", "what"),
    [
        ({"duration": 0.0}, "positive time"),
        ({"duration": np.nan}, "finite"),
        ({"tolerance": 1.0}, "tolerance"),
        ({"varying": None}, "nothing varies"),
        ({"varying": {}}, "by name"),
        ({"varying": {"b": [1.0]}}, "there is no parameter or state 'b'"),
        ({"varying": {"a": [np.inf]}}, "no finite numbers"),
        ({"varying": {"a": [1.0, 2.0], "k": [1.0]}}, r"rw\.grid"),
        ({"start": np.zeros((3, 2))}, "3 rows, varying 2 values"),
        ({"start": np.zeros((0, 2)), "varying": None}, "N of 1 or more"),
        ({"start": np.zeros((2, 3))}, r"shape \(N, 2\)"),
        ({"start": np.array([[0.0, 1.0], [np.nan, 1.0]])}, "row 1 is not finite"),
        ({"start": np.zeros((2, 2)), "varying": rw.grid({"a": [1.0, 2.0]})}, "grid varies everything"),
        ({"parameters": {"k": 1.0}, "varying": {"k": [1.0, 2.0]}}, "give it once"),
        ({"observe": {"a": lambda x, p: x.a}}, "already"),
        ({"observe": 3.0}, "functions by name"),
        ({"workers": 0}, "number of threads"),
        ({"workers": 1.5}, "number of threads"),
        ({"chunk": 0}, "chunk = 0"),
        ({"wind": 3.0}, "takes no wind"),
    ],
)  # fmt: skip
def test_bad_input_is_refused(more, what: str):
    how = {"varying": {"a": [0.1, 0.2]}, "duration": 1.0, "start": None, **more}
    with pytest.raises(rw.RainwindError, match=what):
        rw.ensemble(_pendulum(), **how)


def test_parameters_that_make_no_sense_are_refused_before_any_work():
    with pytest.raises(rw.RainwindError, match=r"varying reaches rivulet\.mass = -0\.1"):
        rw.ensemble(
            rw.paper_model(coefficients="reconstructed"), varying={"rivulet.mass": [0.2, -0.1]}, duration=1.0
        )


def test_an_ensemble_is_saved_and_loaded(tmp_path):
    sample = rw.grid({"a": [0.5, 1.0], "k": [1.0, 2.0, 3.0]})
    run = rw.ensemble(_pendulum(), varying=sample, duration=5.0, reduce=("extremes", "settled"))
    rw.save(run, tmp_path / "run.nc")
    again = rw.load(tmp_path / "run.nc")
    _same(run, again)
    assert repr(again) == repr(run)
    np.testing.assert_array_equal(again.on_grid(("lowest", "a")), run.on_grid(("lowest", "a")))
    rw.save(run, tmp_path / "run.csv")
    head, first = (tmp_path / "run.csv").read_text().splitlines()[:2]
    assert head.startswith("start a,k,final a,final w,end_time,ended,lowest a")
    assert float(first.split(",")[2]) == run.final[0, 0]
