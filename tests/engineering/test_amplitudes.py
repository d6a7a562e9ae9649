"""Amplitudes of runs in time: the cycle that collocation finds, what is left of a push, lost rivulets, no rivulet."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.engineering.amplitudes import vibrations
from rainwind.engineering.linear_stability import growth
from rainwind.engineering.upper_rivulet import upper_rivulets
from rainwind.physics.tilted import SLOPES

MODEL = rw.paper_model().with_parameters({f"section.{k}_{q}": 0.0 for k in ("k2", "k3") for q in "yz"})
ONE = {name: np.ones(1) for name in ("rivulet.mass", "rivulet.friction", *SLOPES)}


def found(model, *speeds: float):
    branches = upper_rivulets(model, ONE, np.zeros(1))
    rates = growth(model, ONE, branches, np.zeros(1), np.array(speeds))
    return rates, vibrations(model, rates.state, rates.parameters, rates.rate, workers=1)


def test_the_amplitude_is_that_of_the_stable_cycle() -> None:
    """13 m/s, 0.2 %: one stable limit cycle (section 4.3 of Peil & Nahrath 2003), here by collocation."""
    model = MODEL.with_parameters({"wind.speed": 13.0})
    orbit = rw.find_orbit(model, rw.simulate(model, {"y": 0.3, "phi": 0.6}, duration=600.0))
    _, run = found(model, 13.0)
    assert not run.lost.any()
    assert run.amplitude[0, 0, 0] == pytest.approx(max(orbit.amplitude["y"], orbit.amplitude["z"]), rel=2e-3)


def test_what_is_left_of_the_push_is_no_vibration() -> None:
    """D is stable at 30 m/s with 0.2 % (figure 9); at 0.1 % of that rate much of the push is still there."""
    slow = MODEL.with_parameters({"section.damping_ratio": 0.0012})
    rates, run = found(slow, 30.0)
    assert -5e-3 < rates.rate[0, 0, 0] < 0.0
    assert run.amplitude[0, 0, 0] == 0.0


def test_no_rivulet_no_vibration_and_a_lost_one_leaves_its_largest() -> None:
    """Below 8 m/s there is no upper rivulet; at 9 m/s it grows past C and falls to A (docs/paper.md, figure 8)."""
    _, run = found(MODEL, 7.0, 9.0)
    assert run.amplitude[0, 0, 0] == 0.0
    assert list(run.lost[0, 0]) == [False, True]
    assert 0.01 < run.amplitude[0, 0, 1] < 1.0
