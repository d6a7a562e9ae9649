"""Elementary functions in machine code against 40 digits: three units in the last place, anywhere."""

import numpy as np
import pytest
from mpmath import mp

import rainwind as rw
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.tape import Tape, trace
from rainwind.dynamics.taylor import TaylorEngine

R = np.random.default_rng(4)
SPREAD = np.concatenate(
    [R.uniform(-40.0, 40.0, 1000), R.normal(size=1000), 10.0 ** R.uniform(-12.0, 2.5, 400)]
)
UNIT = np.concatenate([R.uniform(-1.0, 1.0, 1500), 1.0 - 10.0 ** R.uniform(-12.0, -1.0, 300)])
POSITIVE = np.concatenate(
    [10.0 ** R.uniform(-300.0, 300.0, 1000), R.uniform(0.5, 2.0, 1500), 1.0 + 1e-8 * UNIT]
)
ANGLES = np.concatenate([SPREAD, 10.0 ** R.uniform(2.0, 12.0, 500), np.arange(-50, 50) * np.pi / 4.0])


def values(function, a: np.ndarray, b: np.ndarray | None = None) -> np.ndarray:
    """A function of driven parameters, by the code that steps run: an output beyond the states."""
    tape = trace(lambda x, p: (0.0, function(p.a, p.b)), ("x", "y"), ("a", "b"))
    engine = TaylorEngine(
        Tape(tape.states[:1], ("y", "a", "b"), *tape.arrays), order=2, lanes=8, driven=("a", "b")
    )
    both = np.stack([a, np.zeros_like(a) if b is None else b], axis=1)
    drives = [Pieces(np.array([0.0, 1.0]), one[None, :, None]) for one in both]
    many = len(drives)
    found, _ = engine.pieces(np.zeros((many, 1)), 1e-3, np.zeros(3), drives=drives, drive_of=np.arange(many))
    return np.array([one.coefficients[0, 1, 0] for one in found])


@pytest.mark.parametrize(
    ("function", "exact", "arguments", "units"),
    [
        (rw.sin, mp.sin, ANGLES, 1.5),
        (rw.cos, mp.cos, ANGLES, 1.5),
        (rw.tan, mp.tan, ANGLES, 3.0),
        (rw.exp, mp.exp, np.concatenate([SPREAD, R.uniform(-708.0, 709.0, 500)]), 1.5),
        (rw.log, mp.log, POSITIVE, 1.5),
        (rw.atan, mp.atan, np.concatenate([SPREAD, 10.0 ** R.uniform(-280.0, 280.0, 300)]), 2.5),
        (rw.tanh, mp.tanh, SPREAD, 2.0),
        (rw.sinh, mp.sinh, SPREAD, 2.5),
        (rw.cosh, mp.cosh, SPREAD, 2.0),
        (rw.asin, mp.asin, UNIT, 3.0),
        (rw.acos, mp.acos, UNIT, 3.0),
        (rw.erf, mp.erf, SPREAD, 2.0),
        (lambda x: (x * x + 0.1) ** 2.7, lambda x: (x * x + mp.mpf(0.1)) ** mp.mpf(2.7), R.normal(size=500), 8.0),
    ],
)  # fmt: skip
def test_to_units_in_the_last_place(function, exact, arguments, units):
    found = values(lambda a, b: function(a), arguments)
    with mp.workdps(40):
        answers = [exact(mp.mpf(float(x))) for x in arguments]
        rounded = np.array([float(y) for y in answers])
        error = np.array([float(mp.mpf(float(f)) - y) for f, y in zip(found, answers, strict=True)])
    assert np.max(np.abs(error) / np.spacing(np.abs(rounded))) < units


def test_angles_all_round():
    angle = R.uniform(-np.pi, np.pi, 3000)
    size = 10.0 ** R.uniform(-200.0, 200.0, 3000)
    y, x = size * np.sin(angle), size * np.cos(angle)
    y, x = (
        np.concatenate(both)
        for both in ((y, [0.0, 0.0, 1.0, -2.0, 0.0, 1e-310]), (x, [1.0, -3.0, 0.0, 0.0, 0.0, 1e-309]))
    )
    found = values(rw.atan2, y, x)
    expected = np.arctan2(y, x)
    np.testing.assert_array_equal(np.signbit(found), np.signbit(expected))
    assert np.max(np.abs(found - expected) / np.spacing(np.maximum(np.abs(expected), 1e-300))) <= 2.5


def test_out_of_the_way():
    with np.errstate(all="ignore"):
        for function, ufunc, arguments in (
            (rw.exp, np.exp, [-1e4, -745.0, -740.0, 709.9, 710.0, 1e300, 0.0]),
            (rw.log, np.log, [0.0, -1.0, 5e-324, 1e-310, 1.7e308]),
            (rw.sinh, np.sinh, [705.0, -705.0, 711.0, 1e-200]),
            (rw.cosh, np.cosh, [705.0, -711.0, 0.0]),
            (rw.tanh, np.tanh, [1e300, -1e300, 0.0, 1e-200]),
            (rw.asin, np.arcsin, [1.0, -1.0, 1.5, 0.0]),
            (rw.acos, np.arccos, [1.0, -1.0, -1.5, 0.0]),
            (rw.sin, np.sin, [1e22, -1e99]),
            (rw.cos, np.cos, [1e22, -1e99]),
        ):
            x = np.array(arguments)
            found = values(lambda a, b, f=function: f(a), x)
            np.testing.assert_allclose(found, ufunc(x), rtol=4e-16, atol=5e-324)
