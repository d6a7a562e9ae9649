"""Wind sweeps of the sample case against AUTO-07p and continuation; a fold of cycles: tests/dynamics/test_sweeps.py."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rainwind as rw
from rainwind.dynamics.sweeps import sweep
from rainwind.studies import wind_sweep

approx = pytest.approx
AUTO = json.loads((Path(__file__).parents[1] / "validation/auto/reference.json").read_text(encoding="utf-8"))


def auto_label(name: str) -> list[float]:
    branches = [b for b in AUTO["orbits"]["branches"] if b["damping_ratio"] == 0.002]
    return [
        label["speed"] for branch in branches for label in branch["labels"] if label["name"].lower() == name
    ]


@pytest.fixture(scope="module")
def result():
    return wind_sweep.compute(speeds=(10.6, 11.6))


def test_the_falling_wind_s_jump_is_autos_neimark_sacker_point(result):
    # AUTO-07p: 10.8525928 m/s, hard, so that the 1 mm of a step may end the vibration a step early
    (torus,) = {round(speed, 6) for speed in auto_label("ns")}
    (jump,) = result.jumps
    assert not jump.rising
    assert jump.resolution <= 0.5 * wind_sweep.FINEST * (1.0 + 1e-6)
    assert jump.speed == approx(torus, abs=wind_sweep.FINEST)
    assert (jump.before, jump.after, jump.kind) == ("cycle", "A", "ns")
    assert jump.point == approx(torus, abs=1e-6)


def test_between_jumps_it_is_the_limit_cycle_of_continuation(result):
    checked = 0
    for one in result.sweeps:
        for level in one.levels:
            if level.steady and level.amplitude[0] > 0.01:
                stable = [orbit for orbit in result.cycles.cycles(level.value) if orbit.stable]
                (orbit,) = stable
                for name in ("y", "phi", "z"):
                    i = one.states.index(name)
                    assert level.amplitude[i] == approx(orbit.amplitude[name], rel=1e-3)
                    if level.value > 11.0:  # farther from the torus, where 1 mm dies out sooner
                        assert level.amplitude[i] == approx(orbit.amplitude[name], rel=1e-4)
                checked += 1
    assert checked > 6


def test_hysteresis(result):
    # below the jump only A is left, and rising wind does not bring the vibration back
    rising = [one for one in result.sweeps if one.rising]
    assert len(rising) == 2
    from_a, back = rising
    assert result.began[result.sweeps.index(from_a)] == "from A at 10.60 m/s"
    assert np.all(from_a["y"] < 1e-4)
    assert from_a.values[-1] == back.values[-1] == 11.6
    assert back["y"][-1] > 0.2


def test_a_jump_at_a_fold_of_cycles_of_the_rivulet():
    """Cubic coefficients, 0.1 % damping: the fold by collocation, the jump by simulation in steps of 0.05 m/s."""
    model = rw.paper_model(coefficients="reconstructed-cubic").with_parameters(
        {"section.damping_ratio": 0.001}
    )
    (cycle,) = [orbit for orbit in wind_sweep.cycle_map(model).cycles(16.85) if orbit.stable]
    branch = rw.continue_orbits(model, "wind.speed", start=cycle, until=(16.6, 16.9))
    (fold,) = [p.parameter for p in branch.points("lpc")]
    assert fold == approx(16.7305, abs=1e-4)
    found = sweep(
        model, "wind.speed", start=cycle.profile[0], until=(16.85, 16.65), step=0.1, finest=0.05,
        scales={"phi": 0.5, "y": 0.1, "z": 0.1}, push={"y": 1e-3}, hold=60.0, longest=3000.0, tolerance=1e-8,
    )  # fmt: skip
    (jump,) = found.jumps
    assert jump.after is not None
    assert jump.after.value < fold < jump.before.value
    assert jump.before.value - jump.after.value == approx(0.05)
    assert jump.before.amplitude[0] > 0.4
    assert jump.after.amplitude[0] < 0.01


def test_the_picture(result, tmp_path):
    figure = wind_sweep.draw(result, Figure())
    assert [axes.get_title(loc="left")[:3] for axes in figure.axes] == ["(a)", "(b)", "(c)"]
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert f"{result.jumps[0].speed:.2f} m/s\nto A" in texts
    legend = [text.get_text() for text in figure.legends[0].texts]
    assert {"rising wind", "falling wind", "stable", "jump"} <= set(legend)
    wind_sweep.save(result, tmp_path / "sweep.svg")
    assert (tmp_path / "sweep.svg").stat().st_size > 10_000


def test_tables_and_sentences(result):
    tables = wind_sweep.tables(result)
    assert list(tables["jumps"].columns["direction"].values) == ["down"]
    assert len(tables) == len(result.sweeps) + 1
    said = "\n".join(wind_sweep.summary(result))
    assert "Rising wind from A at 10.60 m/s: no jump; at 11.60 m/s it is at rest at A." in said
    assert (
        "it jumps from a vibration to A; the nearest point of the limit cycles is the Neimark–Sacker" in said
    )


def test_what_had_not_settled_is_crossed_out_and_said(result):
    def changed(steady):
        sweeps = [
            replace(
                one,
                levels=tuple(replace(level, steady=steady(one, k)) for k, level in enumerate(one.levels)),
            )
            for one in result.sweeps
        ]
        return replace(result, sweeps=tuple(sweeps))

    def crosses(of):
        figure = wind_sweep.draw(of, Figure())
        legend = [text.get_text() for text in figure.legends[0].texts]
        lines = [line for line in figure.axes[0].lines if line.get_marker() == "x"]
        return "not settled after 50 min" in legend, np.concatenate([line.get_xdata() for line in lines])

    calm = changed(lambda one, k: True)
    shown, at = crosses(calm)
    assert not shown
    assert not at.size
    assert "settled" not in "".join(wind_sweep.summary(calm))
    first = result.sweeps[0]
    slow = changed(lambda one, k: not (one is first and k in (0, len(one.levels) - 1)))
    shown, at = crosses(slow)
    assert shown
    assert at == approx([first.values[0], first.values[-1]])
    said = "\n".join(wind_sweep.summary(slow))
    assert (
        f"At 2 of its {len(first.levels)} wind speeds, 10.60 m/s and 11.60 m/s, it had not settled after 50 min"
        in said
    )
