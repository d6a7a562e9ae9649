"""Turbulent wind as signals: what was asked for is what the record has."""

from math import sqrt

import numpy as np
import pytest

import rainwind as rw
from rainwind.engineering.turbulent_wind import TurbulentWind, turbulent_wind
from rainwind.errors import InputError

ASKED = {"mean": 9.0, "intensity": 0.15, "length": 60.0, "duration": 300.0, "seed": 4}


def made(**changes) -> TurbulentWind:
    return turbulent_wind(**{**ASKED, **changes})


@pytest.mark.parametrize("spectrum", ["kaimal", "von karman"])
def test_mean_and_variance_are_those_asked_for_in_the_resolved_band(spectrum):
    wind = made(spectrum=spectrum)
    samples = wind.speed.at(np.arange(3000) * 0.1)
    upward = wind.vertical_speed.at(np.arange(3000) * 0.1)
    assert samples.mean() == pytest.approx(9.0, abs=1e-12)
    assert samples.std() == pytest.approx(0.15 * 9.0 * sqrt(wind.resolved), rel=1e-9)
    assert upward.mean() == pytest.approx(0.0, abs=1e-12)
    assert upward.std() == pytest.approx(0.075 * 9.0 * sqrt(wind.vertical_resolved), rel=1e-9)
    assert 0.9 < wind.resolved < 1
    # small eddies: more of the vertical wind lies beyond the sampling rate
    assert 0.8 < wind.vertical_resolved < wind.resolved
    finer = made(spectrum=spectrum, dt=0.01)
    assert finer.vertical_resolved > 0.96


def test_signals_are_smooth_and_go_on_periodically():
    wind = made()
    for signal in (wind.speed, wind.vertical_speed):
        assert (signal.since, signal.until) == (0.0, 300.0)
        longer = signal.repeated(2)
        for knot in longer.knots[[1, 1500, 3000, 3001]]:
            for derivative in (0, 1, 2):
                before, behind = longer.at([np.nextafter(knot, 0), knot], derivative)
                assert before == pytest.approx(behind, abs=1e-8)


def test_the_parts_are_independent_and_by_the_model_s_names():
    wind = made(duration=3000.0)
    t = np.arange(30000) * 0.1
    assert abs(np.corrcoef(wind.speed.at(t), wind.vertical_speed.at(t))[0, 1]) < 0.1
    other = made(duration=3000.0, vertical_intensity=0.05, vertical_length=20.0)
    assert np.array_equal(other.speed.coefficients, wind.speed.coefficients)
    assert other.vertical_intensity == 0.05
    assert set(wind.parameters) <= set(rw.paper_model().parameters)
    assert wind.parameters["wind.speed"] is wind.speed


def test_the_step_divides_the_duration():
    wind = made(duration=1.0, dt=0.3)
    assert wind.speed.knots == pytest.approx([0, 0.25, 0.5, 0.75, 1.0])
    assert len(made(duration=0.7, dt=0.1).speed) == 7


def test_seeds():
    assert np.array_equal(made().speed.coefficients, made().speed.coefficients)
    assert not np.allclose(made(seed=5).speed.at(1.0), made().speed.at(1.0))


def test_no_turbulence_is_a_constant():
    wind = made(intensity=0.0)
    assert wind.speed.extremes() == pytest.approx((9.0, 9.0))
    assert len(wind.speed) == 1
    assert wind.vertical_speed.extremes() == (0.0, 0.0)


def test_a_wind_that_turns_back_is_refused_or_raised():
    wild = {"intensity": 0.45, "seed": 3}
    with pytest.raises(InputError, match=r"fall to -.* m/s.*lowest=0.5"):
        made(**wild)
    wind = made(**wild, lowest=0.5)
    assert 0.001 < wind.clipped < 0.1
    assert wind.speed.extremes()[0] == pytest.approx(0.5, abs=1e-12)
    assert made(lowest=0.5).clipped == 0.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mean": 0.0}, "mean = 0"),
        ({"mean": np.nan}, "mean = nan is not finite"),
        ({"intensity": -0.1}, "intensity = -0.1"),
        ({"length": 0}, "length = 0"),
        ({"duration": -1}, "duration = -1"),
        ({"dt": 0}, "dt = 0"),
        ({"duration": 0.2}, "makes 2 samples; allowed is 4"),
        ({"duration": 1e9}, "samples; allowed is 4 to 16777216"),
        ({"seed": -1}, "seed = -1 must be a whole number"),
        ({"seed": 1.5}, "seed = 1.5"),
        ({"spectrum": "davenport"}, "spectrum = 'davenport' is not known"),
        ({"lowest": 12.0}, "between 0 and the mean"),
        ({"lowest": -1.0}, "lowest = -1"),
        ({"vertical_intensity": -1.0}, "vertical_intensity = -1"),
        ({"vertical_length": 0.0}, "vertical_length = 0"),
    ],
)
def test_what_is_refused(changes, words):
    with pytest.raises(InputError, match=words):
        made(**changes)
