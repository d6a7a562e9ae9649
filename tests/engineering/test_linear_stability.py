"""Growth and needed damping over many samples against continuation, the equilibria's eigenvalues and each other."""

from math import pi

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.system import as_system
from rainwind.engineering.linear_stability import damping_needed, growth
from rainwind.engineering.upper_rivulet import upper_rivulets, wind_speed_normal
from rainwind.engineering.vibration_ranges import unstable_ranges
from rainwind.physics.model import RivuletModel
from rainwind.physics.tilted import SLOPES

# an equivalent section has none of the paper's own small spring terms
MODEL = rw.paper_model().with_parameters({f"section.{k}_{q}": 0.0 for k in ("k2", "k3") for q in "yz"})
STIFF = MODEL.with_parameters({"section.k3": 100.0, "section.sag_offset": 0.4})


def found(model: RivuletModel, speed: np.ndarray, yaw: np.ndarray, many: int = 1, **factors: list[float]):
    names = ("rivulet.mass", "rivulet.friction", *SLOPES)
    given = {name: np.array(factors.get(name.replace(".", "_"), [1.0] * many)) for name in names}
    beta = np.arctan2(np.sin(yaw) * np.sin(pi / 4), np.cos(yaw))
    branches = upper_rivulets(model, given, beta)
    return branches, growth(model, given, branches, yaw, speed), given


@pytest.mark.parametrize("model", [MODEL, STIFF], ids=["paper", "stretching cable"])
@pytest.mark.parametrize("yaw", [0.0, 0.6])
def test_states_are_at_rest_and_rates_are_eigenvalues(model: RivuletModel, yaw: float) -> None:
    speed = np.array([11.0, 17.0])
    _, rates, _ = found(model, speed, np.array([yaw]))
    for k, u in enumerate(speed):
        system = as_system(model.with_parameters({"wind.speed": float(u), "wind.yaw": yaw}))
        state = rates.state[0, 0, k]
        assert system.f(state) == pytest.approx(np.zeros(6), abs=1e-9)
        values = np.linalg.eigvals(system.jacobian(state))
        best = max((v for v in values if v.imag > 0), key=lambda v: v.real)
        assert rates.rate[0, 0, k] == pytest.approx(best.real, abs=1e-10)
        assert rates.omega[0, 0, k] == pytest.approx(best.imag, rel=1e-9)


def test_the_range_of_the_sample_case_is_that_of_its_hopf_point() -> None:
    """8 to 14.8 m/s: section 4 of Peil & Nahrath (2003); the Hopf point by continuation."""
    speed = np.geomspace(3.0, 40.0, 64)
    branches, rates, _ = found(MODEL, speed, np.array([0.0]))
    onset = wind_speed_normal(MODEL, branches.onset, np.array([[MODEL.rivulet.mass]]))
    low, high, opened = unstable_ranges(rates.rate, speed, onset)
    upper = rw.find_equilibria(MODEL.with_parameters({"wind.speed": 12.0}))[1]
    hopf = rw.continue_equilibria(MODEL, "wind.speed", start=upper, until=(10.0, 20.0)).points("hopf")
    assert low[0, 0] == pytest.approx(8.0, abs=0.05)
    assert high[0, 0] == pytest.approx(hopf[-1].parameter, abs=0.1)
    assert not opened[0, 0]


def test_needed_damping_is_the_top_of_the_hopf_curve() -> None:
    """About 0.7 % in section 5; 0.70 % by AUTO-07p with this set, at one wind speed: hence a fine grid."""
    _, rates, _ = found(MODEL, np.linspace(8.0, 12.0, 201), np.array([0.0]))
    ratio, point = damping_needed(rates, np.isfinite(rates.rate))
    assert ratio[0] == pytest.approx(0.0070, abs=0.0001)
    assert point[0] >= 0


def test_at_the_needed_damping_nothing_grows_and_just_below_something_does() -> None:
    mass, friction = [0.7, 1.0, 1.6], [2.0, 0.5, 1.0]
    speed, yaw = np.linspace(6.0, 18.0, 40), np.array([-0.4, 0.0, 0.9])
    _, rates, _ = found(MODEL, speed, yaw, 3, rivulet_mass=mass, rivulet_friction=friction)
    ratio, _ = damping_needed(rates, np.isfinite(rates.rate))
    for k, need in enumerate(ratio):
        for factor, grows in ((1.002, False), (0.998, True)):
            at = MODEL.with_parameters({"section.damping_ratio": float(factor * need)})
            one = {"rivulet_mass": [mass[k]], "rivulet_friction": [friction[k]]}
            rate = found(at, speed, yaw, **one)[1].rate
            assert bool(np.nanmax(rate) > 0) is grows


def test_nothing_to_damp_needs_no_damping() -> None:
    _, rates, _ = found(MODEL, np.linspace(4.0, 7.0, 5), np.array([0.0]))
    ratio, point = damping_needed(rates, np.isfinite(rates.rate))
    assert ratio[0] == 0.0
    assert point[0] == -1


def test_a_rivulet_that_only_damps_needs_no_damping() -> None:
    """Wind up along the cable: even without any damping nothing grows. So 0, not nearly 0."""
    speed, yaw = np.array([11.9, 12.0]), np.array([-0.8])
    bare = MODEL.with_parameters({"section.damping_ratio": 0.0})
    _, at_zero, _ = found(bare, speed, yaw, rivulet_mass=[0.4])
    assert np.nanmax(at_zero.rate) < 0
    _, rates, _ = found(MODEL, speed, yaw, rivulet_mass=[0.4])
    assert damping_needed(rates, np.isfinite(rates.rate))[0][0] == 0.0


def test_the_displacement_of_a_soft_cable_holds_the_forces() -> None:
    """Strong wind on a cable that hardly holds: the springs are far from linear, and lift works against the sag."""
    soft = MODEL.with_parameters(
        {
            "section.frequency_y": 0.15,
            "section.frequency_z": 0.15,
            "section.k3": 400.0,
            "section.sag_offset": 0.3,
        }
    )
    _, rates, _ = found(soft, np.array([20.0, 40.0]), np.array([0.0]))
    for k, u in enumerate((20.0, 40.0)):
        state = rates.state[0, 0, k]
        assert as_system(soft.with_parameters({"wind.speed": u})).f(state) == pytest.approx(
            np.zeros(6), abs=1e-9
        )
