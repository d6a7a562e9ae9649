"""Figure 8: transients of the sample case, against AUTO-07p's cycle, the linear theory and SciPy."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from rainwind.dynamics.extremes import half_peak_to_peak
from rainwind.dynamics.system import as_system
from rainwind.physics.model import paper_model
from rainwind.studies import figure_08_transient as figure_08
from rainwind.studies.transients import transient

approx = pytest.approx
AUTO = json.loads((Path(__file__).parents[1] / "validation/auto/reference.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def result():
    return figure_08.compute()


def test_at_9_and_12_metres_per_second(result):
    assert list(result.runs) == [9.0, 12.0]
    falls, vibrates = result.runs.values()
    assert (falls.end, vibrates.end) == ("A", "cycle")
    # issue 4: past C and down to A within about 200 s
    assert 170.0 < falls.lost < falls.since < 200.0
    # section 4.3: over five minutes, there at 9 m/s
    assert vibrates.since > 300.0
    assert np.isnan(vibrates.lost)


def test_the_settled_amplitude_is_autos(result):
    # AUTO-07p 0.9.2: the largest of the three cycles at 12 m/s, the stable one
    cycles = [c for c in AUTO["orbits"]["cycles"] if c["damping_ratio"] == 0.002 and c["speed"] == 12.0]
    auto = max(cycles, key=lambda c: c["half_peak_to_peak"]["y"])
    one = result.runs[12.0]
    end = one.run.duration
    amplitude = half_peak_to_peak(one.run, np.array([end - auto["period"], end]))[0]
    for name in ("y", "phi", "z"):
        assert amplitude[one.run.states.index(name)] == approx(auto["half_peak_to_peak"][name], rel=1e-5)
        assert one.cycle.amplitude[name] == approx(auto["half_peak_to_peak"][name], rel=1e-5)
    assert one.cycle.stable


def test_at_first_it_grows_as_the_linear_theory_says():
    # D's eigenvalue at 9 m/s: e-fold in 32 s; so small a start that the faster mode alone is left before 5 mm
    one = transient(paper_model(), 9.0, disturbance=1e-6)
    assert one is not None
    rate = one.rest["D"].eigenvalues.real.max()
    assert 1.0 / rate == approx(32.4, abs=0.1)
    before, after = (half_peak_to_peak(one.run, np.array([t, t + 1.0]))[0, 0] for t in (200.0, 250.0))
    assert np.log(after / before) / 50.0 == approx(rate, rel=0.01)
    assert one.end == "A"


def test_the_fall_is_scipys(result):
    # another integrator, from the same start: when phi passes C, and where it is at 184 s
    one = result.runs[9.0]
    system = as_system(paper_model().with_parameters({"wind.speed": 9.0}))
    angle = one.rest["C"]["phi"]

    def passes(_, x):
        return x[1] - angle

    other = solve_ivp(
        lambda _, x: system.f(x), (0.0, 184.0), one.run.start, method="LSODA", rtol=1e-10, atol=1e-12, events=passes
    )  # fmt: skip
    assert one.lost == approx(other.t_events[0][0], abs=1e-4)
    assert one.run.at(184.0)[:3] == approx(other.y[:3, -1], abs=1e-4)


def test_the_time_is_when_the_last_period_beyond_one_per_cent_ends(result):
    # by brute force, on samples
    one = result.runs[12.0]
    period, end = one.cycle.period, one.run.duration
    start = end - int(end / period) * period
    t = start + period * np.arange(int(end / period))[:, None] + period * np.linspace(0.0, 1.0, 201)
    size = 0.5 * np.ptp(one.run.at(t)[..., :3], axis=1)
    own = np.array([one.cycle.amplitude[name] for name in ("y", "phi", "z")])
    off = np.abs(size / own - 1.0).max(axis=1)
    late = t[:, -1] > one.since + 2.0 * period
    assert off[late].max() < 0.0101
    near = (t[:, -1] < one.since + 0.5 * period) & (t[:, -1] > one.since - 2.0 * period)
    assert off[near].max() > 0.0099
    assert not late.all()


def test_the_picture(result, tmp_path):
    figure = figure_08.draw(result, Figure())
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[:2] == ["(a) 9 m/s: falls to A", "(b) 12 m/s: to a limit cycle"]
    assert titles[-2:] == ["(g) the fall, close up", "(h) the cycle, close up"]
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert any(text.startswith("passes C") for text in texts)
    assert any(text.startswith("within 1 %") for text in texts)
    figure.savefig(tmp_path / "figure.png")


def test_tables_and_sentences(result):
    tables = figure_08.tables(result)
    assert set(tables) == {"ends", "periods_9", "course_9", "periods_12", "course_12"}
    assert list(tables["ends"].columns["end"].values) == ["A", "cycle"]
    y = tables["course_12"].columns["y"].values
    assert np.abs(y).max() == approx(tables["periods_12"].columns["max_y"].values.max(), rel=0.02)
    first, second = figure_08.summary(result)
    assert "at 9 m/s" in first.lower()
    assert "falls to A: it is at 183.7° after 184 s" in first
    assert "reaches a limit cycle (y ±0.233 m, z ±0.203 m, phi ±20.6°) to within 1 % after" in second


def test_other_ends():
    calm = figure_08.compute(speeds=(6.0, 15.0))  # below the fold no D; above 14.8 m/s D is stable
    assert calm.runs[6.0] is None
    still = calm.runs[15.0]
    assert still is not None
    assert still.end == "D"
    first, second = figure_08.summary(calm)
    assert first == "There is no upper rivulet D at 6 m/s."
    assert second.endswith("comes to rest at D again.")
    assert len(figure_08.draw(calm, Figure()).axes) == 8
    raw = transient(paper_model(outside="extend"), 9.0)  # no lower rivulet there
    assert raw is not None
    assert raw.end == ""
    flat = figure_08.compute(paper_model(degrees_of_freedom=2), speeds=(13.0,))
    assert len(figure_08.draw(flat, Figure()).axes) == 3
