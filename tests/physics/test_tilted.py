"""Tilted coefficients: the curves turn about the middle of their range, and the model takes the factors from p."""

import numpy as np
import pytest

from rainwind.physics import paper_model
from rainwind.physics.tilted import SLOPES, ScatteredModel, SteeperCoefficients

MODEL = paper_model()
GIVEN = MODEL.coefficients
X = (0.1, 0.7, -0.05, 0.3, 0.2, -0.1)


@pytest.mark.parametrize("outside", ["blend", "extend"])
def test_curves_turn_about_the_middle_of_the_range(outside):
    same = SteeperCoefficients(GIVEN, (1.0, 1.0, 1.0))
    steeper = SteeperCoefficients(GIVEN, (1.1, 1.0, 0.9))
    low, high = GIVEN.valid
    middle = 0.5 * (low + high)
    for alpha in (-1.2, -0.5, 2.0):
        assert same.at(alpha, outside) == GIVEN.at(alpha, outside)
    assert np.allclose(steeper.at(middle, outside), GIVEN.at(middle, outside), atol=1e-12)

    def slopes(one) -> np.ndarray:
        return (np.array(one.at(middle + 1e-3, outside)) - np.array(one.at(middle - 1e-3, outside))) / 2e-3

    assert np.allclose(slopes(steeper) / slopes(GIVEN), (1.1, 1.0, 0.9), rtol=1e-3)


def test_the_scattered_model_is_the_model_where_all_factors_are_one():
    scattered = ScatteredModel(MODEL)
    assert tuple(scattered.parameters)[-3:] == SLOPES == ("lift slope", "drag slope", "moment slope")
    assert scattered.rhs(X, scattered.parameters) == MODEL.rhs(X, MODEL.parameters)
    assert scattered.structure != MODEL.structure


@pytest.mark.parametrize("factor", SLOPES)
def test_the_model_takes_every_factor_from_p(factor):
    scattered = ScatteredModel(MODEL)
    before = np.array(MODEL.rhs(X, MODEL.parameters))
    after = np.array(scattered.rhs(X, {**scattered.parameters, factor: 1.2}))
    assert np.all(after[:3] == before[:3])
    assert abs(after[4] - before[4]) > 1e-6  # every force moves the rivulet, directly or with the cable
    assert MODEL.coefficients is GIVEN  # the model itself is left alone
