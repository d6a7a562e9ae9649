"""The branch D in closed form against the certified equilibria of the model and the continuation's fold."""

from math import atan2, cos, pi, radians, sin, sqrt

import numpy as np
import pytest

import rainwind as rw
from rainwind.engineering.upper_rivulet import kappa_at, upper_rivulets, wind_speed_normal
from rainwind.physics.tilted import LIFT, MOMENT, ScatteredModel

MODEL = rw.paper_model()
MASS = MODEL.rivulet.mass


def factors(**changes: list[float]) -> dict[str, np.ndarray]:
    many = len(next(iter(changes.values()), [1.0]))
    return {LIFT: np.ones(many)} | {name.replace("_", " "): np.array(v) for name, v in changes.items()}


def angle(yaw: float) -> float:
    return atan2(sin(yaw) * sin(pi / 4), cos(yaw))


def test_the_onset_is_the_fold_that_continuation_finds() -> None:
    branch = rw.continue_equilibria(
        MODEL,
        "wind.speed",
        start=rw.find_equilibria(MODEL.with_parameters({"wind.speed": 9.0}))[2],
        until=(7.0, 10.0),
    )
    (fold,) = branch.points("fold")
    onset = upper_rivulets(MODEL, factors(), np.array([0.0])).onset
    assert wind_speed_normal(MODEL, onset, np.array([[MASS]]))[0, 0] == pytest.approx(
        fold.parameter, abs=2e-3
    )


@pytest.mark.parametrize("name", ["reconstructed", "reconstructed-cubic", "reconstructed-linear"])
@pytest.mark.parametrize("yaw", [radians(-25.0), 0.0, radians(40.0), radians(75.0)])
@pytest.mark.parametrize("speed", [10.5, 16.0, 30.0])
def test_angles_are_equilibria_of_the_model(name: str, yaw: float, speed: float) -> None:
    model = rw.paper_model(name).with_parameters({"wind.speed": speed, "wind.yaw": yaw})
    found = upper_rivulets(model, factors(), np.array([angle(yaw)]))
    normal = speed * sqrt(cos(yaw) ** 2 + (sin(yaw) * sin(pi / 4)) ** 2)
    phi = found.angles(kappa_at(model, np.array([[[normal]]]), np.array([[[MASS]]])))[0, 0, 0]
    rests = [e["phi"] for e in rw.find_equilibria(model)]
    if np.isnan(phi):
        above = wind_speed_normal(model, found.onset, np.array([[MASS]]))[0, 0]
        assert not normal > above  # below the fold, or no fold at all
    else:
        assert min(abs(phi - one) for one in rests) < 1e-9


def test_slopes_of_the_moment_are_those_of_the_scattered_model() -> None:
    found = upper_rivulets(MODEL, factors(moment_slope=[0.8, 1.2]), np.array([0.0]))
    phi = found.angles(kappa_at(MODEL, np.full((2, 1, 1), 14.0), np.full((2, 1, 1), MASS)))
    scattered = ScatteredModel(MODEL.with_parameters({"wind.speed": 14.0}))
    for k, factor in enumerate((0.8, 1.2)):
        state = [0.0, phi[k, 0, 0], 0.0, 0.0, 0.0, 0.0]
        p = scattered.parameters | {MOMENT: factor}
        # the moment of all forces on the rivulet: the cable held, so that only its own row of eq. (4) is left
        held = scattered.rhs(state, p | {"section.mass": 1e12})
        assert held[4] == pytest.approx(0.0, abs=1e-6)
        assert phi[k, 0, 0] == pytest.approx(phi[1 - k, 0, 0], abs=0.2)
    assert phi[0, 0, 0] != pytest.approx(phi[1, 0, 0], abs=1e-3)


def test_a_wind_without_upper_rivulet_gives_nan() -> None:
    found = upper_rivulets(MODEL, factors(), np.array([0.0]))
    assert np.isnan(found.angles(kappa_at(MODEL, np.array([[[7.9]]]), np.array([[[MASS]]])))).all()
    assert np.isfinite(found.angles(kappa_at(MODEL, np.array([[[300.0]]]), np.array([[[MASS]]])))).all()


def test_a_heavier_rivulet_needs_the_square_root_more_wind() -> None:
    onset = upper_rivulets(MODEL, factors(), np.array([0.0])).onset
    light, heavy = (wind_speed_normal(MODEL, onset, np.array([[m]]))[0, 0] for m in (0.1, 0.4))
    assert heavy / light == pytest.approx(2.0, rel=1e-12)


def test_a_rivulet_without_weight_rests_where_the_moment_vanishes() -> None:
    """A vertical stay: kappa has no end, and at rest C_M(-phi) = 0."""
    steep = MODEL.with_parameters({"section.inclination": pi / 2})
    beta = np.array([0.2])
    found = upper_rivulets(steep, factors(), beta)
    phi = found.angles(kappa_at(steep, np.full((1, 1, 1), 10.0), np.full((1, 1, 1), 0.2)))
    assert np.isfinite(phi).all()
    assert found.coefficients.at(-phi)[2] == pytest.approx(0.0, abs=1e-12)
