"""Trajectories of the sample case beside heyoka's: another program's Taylor series on the same operations."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.system import as_system

from . import heyoka_peer

pytestmark = [
    pytest.mark.validation,
    pytest.mark.skipif(heyoka_peer.heyoka is None, reason="heyoka is not installed: pip install heyoka"),
]
DURATION = 300.0


def settled(speed: float, outside: str) -> tuple[object, np.ndarray]:
    """The sample case, and eight starts round its stable cycle, each displaced by a thousandth of its size."""
    model = rw.paper_model(outside=outside).with_parameters({"wind.speed": speed})
    on_d = min(rw.find_equilibria(model), key=lambda e: abs(e["phi"] - 0.6))
    run = rw.simulate(model, on_d.state + 1e-3 * np.eye(6)[0], duration=1500.0)
    orbit = rw.find_orbit(model, run)
    assert orbit.stable
    starts = orbit.at(orbit.period * np.arange(8) / 8)
    return model, starts + 1e-3 * np.ptp(starts, axis=0) * np.random.default_rng(0).normal(size=starts.shape)


@pytest.mark.parametrize("outside", ["extend", "blend"])
def test_three_hundred_seconds_round_a_cycle(outside: str):
    """To 1e-10 where disturbances grow less than a thousandfold: round an attracting cycle they hardly grow at all."""
    model, starts = settled(12.0, outside)
    system = as_system(model)
    theirs = heyoka_peer.propagate(
        heyoka_peer.integrator(system, 1e-17, 8, compensated=True), starts, DURATION
    )
    sizes = np.max(np.abs(theirs), axis=0)
    ours = np.array([rw.simulate(model, x, duration=DURATION, tolerance=1e-13).end for x in starts])
    assert np.max(np.abs(ours - theirs) / sizes) < 1e-10
    many = rw.ensemble(
        model, varying=dict(zip(system.states, starts.T, strict=True)), duration=DURATION, tolerance=1e-9
    )
    assert np.max(np.abs(many.final - theirs) / sizes) < 1e-8
