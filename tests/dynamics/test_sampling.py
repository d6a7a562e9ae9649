"""Samples: where their points lie is known."""

import numpy as np
import pytest
from scipy import stats

import rainwind as rw


def test_a_grid_has_all_combinations_and_the_last_name_varies_fastest():
    sample = rw.grid({"a": [1.0, 2.0], "b": [10.0, 20.0, 30.0]})
    assert sample.shape == (2, 3)
    assert len(sample) == 6
    np.testing.assert_array_equal(sample.values["a"], [1, 1, 1, 2, 2, 2])
    np.testing.assert_array_equal(sample.values["b"], [10, 20, 30, 10, 20, 30])


def test_a_latin_hypercube_has_one_point_in_each_layer():
    sample = rw.latin_hypercube({"a": (2.0, 4.0), "b": rw.normal(1.0, 0.5)}, 50, seed=3)
    layers = np.floor((sample.values["a"] - 2.0) / 2.0 * 50).astype(int)
    np.testing.assert_array_equal(np.sort(layers), np.arange(50))
    layers = np.floor(stats.norm(1.0, 0.5).cdf(sample.values["b"]) * 50).astype(int)
    np.testing.assert_array_equal(np.sort(layers), np.arange(50))


def test_sobol_points_are_balanced():
    sample = rw.sobol({"a": (0.0, 1.0), "b": (0.0, 1.0)}, 64)
    cells = np.floor(8 * np.stack([sample.values["a"], sample.values["b"]])).astype(int)
    # a (0, m, 2)-net: exactly one point in each of 8 x 8 boxes
    assert len(set(map(tuple, cells.T))) == 64


def test_distributions_have_their_moments():
    sample = rw.sobol({"n": rw.normal(3.0, 0.2), "l": rw.lognormal(2.0, 0.1), "t": stats.triang(0.5)}, 4096)
    n, logs, t = sample.values["n"], np.log(sample.values["l"]), sample.values["t"]
    assert (n.mean(), n.std()) == pytest.approx((3.0, 0.2), rel=2e-3)
    assert (logs.mean(), logs.std()) == pytest.approx((np.log(2.0), 0.1), rel=2e-3)
    assert (t.mean(), t.var()) == pytest.approx((0.5, 1 / 24), rel=2e-3)


def test_a_seed_repeats_and_another_does_not():
    def one(seed: int) -> np.ndarray:
        return rw.latin_hypercube({"a": (0.0, 1.0)}, 8, seed=seed).values["a"]

    np.testing.assert_array_equal(one(5), one(5))
    assert not np.array_equal(one(5), one(6))


@pytest.mark.parametrize(
    ("call", "what"),
    [
        (lambda: rw.grid({}), "by name"),
        (lambda: rw.grid({"a": []}), "at least one value"),
        (lambda: rw.grid({"a": [1.0, 1.0]}), "twice"),
        (lambda: rw.grid({"a": [1.0, np.nan]}), "number 1"),
        (lambda: rw.grid({"a": "words"}), "no array of numbers"),
        (lambda: rw.latin_hypercube({"a": (1.0, 1.0)}, 4), "must lie below"),
        (lambda: rw.latin_hypercube({"a": (0.0, 1.0)}, 0), "whole number of 1 or more"),
        (lambda: rw.latin_hypercube({"a": 3.0}, 4), "no distribution"),
        (lambda: rw.sobol({"a": (0.0, 1.0)}, 100), "give 128"),
        (lambda: rw.sobol({"a": (0.0, 1.0)}, 8, seed=-1), "seed"),
        (lambda: rw.normal(1.0, 0.0), "must be positive"),
        (lambda: rw.lognormal(-1.0, 0.1), "must be positive"),
    ],
)
def test_bad_samples_are_refused(call, what: str):
    with pytest.raises(rw.RainwindError, match=what):
        call()
