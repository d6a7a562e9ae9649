"""What docs/cables.md says that the section leaves out, and what it does not."""

from math import pi, radians

import numpy as np
import pytest

from rainwind.engineering.bridge import Site
from rainwind.engineering.cable import Cable
from rainwind.engineering.equivalent_section import section_model
from rainwind.engineering.modes import cable_mode
from rainwind.engineering.wind_profile import mode_factor, speed_factor
from rainwind.physics import Rivulet

from .sliced_stay import SlicedStay

SLICES = 8
XI = (np.arange(SLICES) + 0.5) / SLICES
# stay 24S of the Fred Hartman Bridge; strung softly, so that the tension's spring does not show
CABLE = Cable("24S", 197.847, 0.16, 76.03, 4.53e6, radians(35), 0.0, axial_stiffness=1e-3, base_height=10.0)


def section(number, speed):
    model = section_model(
        CABLE, cable_mode(CABLE, number), coefficients="reconstructed", rivulet=Rivulet(), damping_ratio=0.001
    )
    return model.with_parameters({"wind.yaw": 0.6, "wind.speed": speed})


def upper(model):
    """The upper rivulet at rest, D: the equilibrium nearest to windward of the top whose rivulet is stable."""
    sliced = SlicedStay(model, [1.0], [model.parameters["wind.speed"]])
    states = [np.array(state, dtype=float) for state in model.all_states().states]
    stable = [
        x for x in states if 0 < x[1] < pi / 2 and sliced._pull(x[1] + 1e-5) < sliced._pull(x[1] - 1e-5)
    ]
    return max(stable, key=lambda x: x[1])


def growth(eigenvalues):
    """The largest real part, 1/s."""
    return np.max(eigenvalues.real)


def section_eigenvalues(model):
    rest = upper(model)
    sliced = SlicedStay(model, [1.0], [model.parameters["wind.speed"]])
    return sliced.eigenvalues(sliced.rest([rest[1]]))


def test_one_slice_is_the_section():
    model = section(2, 10.0)
    rest, p = upper(model), model.parameters
    sliced = SlicedStay(model, [1.0], [10.0])
    y, phi, z, y_dot, phi_dot, z_dot = rest + np.array([0.01, 0.2, -0.02, 0.3, -1.0, 0.1])
    found = sliced.rates(np.array([y, z, y_dot, z_dot, phi, phi_dot]))
    expected = np.array(model.rhs((y, phi, z, y_dot, phi_dot, z_dot), p))[[0, 2, 3, 5, 1, 4]]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("speed", [9.0, 11.0, 15.0])
def test_in_the_same_wind_everywhere_the_stay_grows_as_the_section_does(number, speed):
    model = section(number, speed)
    alone = section_eigenvalues(model)
    stay = SlicedStay(model, cable_mode(CABLE, number).at(XI), np.full(SLICES, speed))
    found = stay.eigenvalues(stay.rest(np.full(SLICES, upper(model)[1])))
    for value in alone:
        assert np.min(np.abs(found - value)) < 1e-5 * (1 + abs(value))
    assert growth(found) == pytest.approx(growth(alone), abs=1e-6)


@pytest.mark.parametrize("speed", [10.0, 11.5, 13.0])
def test_one_speed_stands_for_a_wind_that_rises_with_height(speed):
    """Mode 2 in its unstable range; the wind rises by a third between both ends of the stay.

    By first-order perturbation the stay grows by the mean of what the section does at each slice's own speed,
    weighted with the shape squared. The section at the one speed of `mode_factor` differs by the curvature of growth
    over speed: 2e-4 of critical damping is a fifth of the damping that a usual stay has at least.
    """
    site = Site("power", exponent=0.16)
    mode = cable_mode(CABLE, 2)
    factors = speed_factor(site, 10 + XI * CABLE.length * np.sin(CABLE.inclination))
    speeds = speed * factors / mode_factor(CABLE, mode, site)
    models = [section(2, local) for local in speeds]
    local = [growth(section_eigenvalues(model)) for model in models]
    stay = SlicedStay(models[0], mode.at(XI), speeds)
    found = growth(stay.eigenvalues(stay.rest([upper(model)[1] for model in models])))
    assert found == pytest.approx(np.average(local, weights=mode.at(XI) ** 2), abs=5e-4)
    one = growth(section_eigenvalues(section(2, speed)))
    assert found == pytest.approx(one, abs=2e-4 * 2 * pi * mode.frequency_out)


def test_a_steady_force_moves_mid_span_by_pi_squared_over_eight_of_the_section():
    # a string under F per metre: F L² / (8 T); its mode 1 as a section: F / (m (2 pi f)²)
    mode = cable_mode(CABLE, 1)
    stiffness = CABLE.mass * (2 * pi * mode.frequency_out) ** 2
    assert CABLE.length**2 / (8 * CABLE.tension) * stiffness == pytest.approx(pi**2 / 8, rel=1e-9)
