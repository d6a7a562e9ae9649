"""Basins, the map over wind and damping, and probabilities: against what equilibria, figure 9 and closed forms say."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rainwind as rw
from rainwind.errors import InputError
from rainwind.io.results import load_netcdf
from rainwind.physics import paper_model
from rainwind.studies import attractor_map, basins, long_time, vibration_probability


def test_a_rivulet_between_b_and_c_goes_to_d(tmp_path: Path):
    # section 4.2; the cable at rest, 16.5 m/s, where D is stable
    model = paper_model().with_parameters({"wind.speed": 16.5})
    found = basins.compute(
        model, ("y_dot", "phi"), first=(-0.001, 0.001), second=(-1.0, 2.0), shape=(2, 30), longest=2000.0
    )
    low, high = (found.equilibria[letter][1] for letter in "BC")
    between = (found.second > low) & (found.second < high)
    assert np.array_equal(found.kind[:, 0] == long_time.REST, between)
    assert np.all(found.kind[~between] == long_time.LOST)
    (lost, rest) = found.shares
    assert lost.share + rest.share == pytest.approx(1.0)
    assert rest.share == pytest.approx(between.mean())
    assert rest.error == pytest.approx(np.sqrt(rest.share * lost.share / 60.0))
    figure = basins.draw(found, Figure())
    assert "16.5 m/s" in figure.axes[0].get_title(loc="left")
    paths = basins.save_data(found, tmp_path / "b.png")
    assert [path.name for path in paths] == ["b_cells.csv", "b_shares.csv", "b.nc"]
    assert load_netcdf(paths[-1])["cells"]["kind"].size == 60


def test_the_map_agrees_with_equilibria_and_cycles():
    # 0.2 %: stable cycles from 10.85 to 14.80 m/s, then D, as AUTO-07p has it; below the fold at 8 m/s no upper rivulet
    found = attractor_map.compute(speeds=(7.0, 17.0), ratios=(0.002, 0.009), shape=(6, 2), longest=2000.0)
    names = [long_time.NAMES[k] for k in found.kind[0]]
    assert names == [*["rivulet lost"] * 3, "steady vibration", "at rest", "at rest"]
    model = paper_model().with_parameters({"wind.speed": 13.0})
    orbit = rw.find_orbit(model, {"y": 0.2, "phi": 0.6})
    assert found.amplitude["y"][0, 3] == pytest.approx(orbit.amplitude["y"], rel=0.01)
    # above the critical damping of 0.7 % nothing vibrates (section 5)
    assert not np.any(found.kind[1] == long_time.CYCLE)
    figure = attractor_map.draw(found, Figure())
    assert len(figure.axes) == 3
    assert any("rivulet lost: " in line for line in attractor_map.summary(found))


def test_chaos_at_very_low_damping():
    # T9: what the map found at 18 m/s and 0.02 %, here by its own means: a positive exponent beside a zero one
    model = paper_model().with_parameters({"wind.speed": 18.0, "section.damping_ratio": 0.0002})
    upper = long_time.upper_rivulet(model, (8.0, 20.0)).at(18.0)
    assert upper is not None
    upper[0] += 0.1
    found = rw.lyapunov(model, upper, duration=1500.0, transient=6000.0, many=3, tolerance=1e-8)
    assert found.exponents[0] > 10.0 * found.errors[0] > 0.0
    assert found.exponents[0] == pytest.approx(0.066, abs=0.015)
    assert abs(found.exponents[1]) < 0.01
    assert found.exponents[2] < -0.004


def test_a_stopped_map_says_so():
    def progress(done: int, total: int, what: str) -> None:
        if done >= 64:
            raise KeyboardInterrupt

    found = attractor_map.compute(
        speeds=(15.5, 16.5), ratios=(0.004, 0.008), shape=(40, 40), longest=1000.0, curves=False, workers=1,
        progress=progress,
    )  # fmt: skip
    assert found.partial
    assert 64 <= np.sum(found.kind >= 0) < 1600
    figure = attractor_map.draw(found, Figure())
    assert "stopped: " in figure.get_suptitle()
    assert attractor_map.summary(found)[0].startswith("Stopped by the user")


def test_probabilities_without_scatter_are_zero_or_one():
    nothing = dict.fromkeys(vibration_probability.SCATTER, 0.0)
    found = vibration_probability.compute(speeds=(7.0, 17.0), scatter=nothing, samples=2, shape=6, sobol=0)
    p, low, high = found.probability(found.vibrates)
    assert p.tolist() == [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]  # as the map above
    assert np.all((low <= p) & (p <= high))
    assert found.probability(found.lost)[0].tolist() == [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]


def test_probability_with_indices():
    found = vibration_probability.compute(
        speeds=(11.0, 15.0), samples=4, shape=3, sobol=16, scatter={"drag slope": 0.0}
    )
    assert not found.partial
    assert found.indices is not None
    assert found.indices["drag slope"][2] == pytest.approx(0.0, abs=1e-6)
    assert found.indices["wind.speed"][2] > 0.1
    assert len(vibration_probability.draw(found, Figure()).axes) == 2


def test_it_says_what_is_wrong():
    with pytest.raises(InputError, match="twice"):
        basins.compute(plane=("phi", "phi"))
    with pytest.raises(InputError, match="psi"):
        basins.compute(plane=("psi", "phi"))
    with pytest.raises(InputError, match="lower one first"):
        attractor_map.compute(speeds=(12.0, 8.0))
    with pytest.raises(InputError, match="sobol = 100: give a power"):
        vibration_probability.compute(sobol=100)
    with pytest.raises(InputError, match="give a share from"):
        vibration_probability.compute(scatter={"rivulet.mass": 20.0})
