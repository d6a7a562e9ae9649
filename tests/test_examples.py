"""Files that come with the examples are what their scripts write."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from rainwind.io.bridge_cases import read_bridge
from rainwind.io.climate_files import read_climate

FOLDER = Path(__file__).parents[1] / "examples/fred_hartman"


def table(path: Path) -> tuple[list[str], np.ndarray]:
    """The comment and the headers; speed, direction and rain."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return lines[:2], np.array([[float(cell) for cell in line.split(",")[1:]] for line in lines[2:]])


def test_the_climate_of_fred_hartman_is_what_its_script_writes(tmp_path: Path):
    out = tmp_path / "climate.csv"
    subprocess.run([sys.executable, FOLDER / "make_climate.py", out], check=True)
    (head, made), (kept_head, kept) = table(out), table(FOLDER / "climate.csv")
    assert head == kept_head
    assert made.shape == kept.shape == (8760, 3)
    different = np.any(made != kept, axis=1)
    assert different.sum() <= 5, "another computer may round a few numbers the other way"


def test_the_climate_says_that_it_is_synthetic_and_looks_like_a_climate():
    path = FOLDER / "climate.csv"
    assert path.read_text(encoding="utf-8").startswith("# SYNTHETIC")
    assert path.stat().st_size < 400_000
    for name in ("case.toml", "with_dampers.toml"):
        bridge = read_bridge(FOLDER / name)
        assert bridge.climate is not None
        assert bridge.climate.path.name == "climate.csv"
        assert any("SYNTHETIC" in sentence for sentence in bridge.assumptions)
    raining = read_climate(replace(bridge.climate, look_back=0.0))
    assert 0.07 < raining.wet_share < 0.09
    assert 4 < raining.speed.mean() < 5.5
    assert raining.speed[raining.wet].mean() > 1.15 * raining.speed[~raining.wet].mean()
    assert raining.coverage == 1
    assert read_climate(bridge.climate).wet_share > raining.wet_share
