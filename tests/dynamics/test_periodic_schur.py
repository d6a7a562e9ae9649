"""Multipliers of products against products made of known ones, and against mpmath's eigenvalues of the product."""

import cmath
import math

import mpmath
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rainwind.dynamics.kernels.periodic_schur import GROUPED, log_multipliers

EPS = np.finfo(float).eps
TOLERANCE = 1e-10


def known(rng, count, blocks, *, above=0.0, stretch=2.0):
    """P_{j+1} T_j P_j^{-1}: T_j has `blocks` (logs, a complex one for a pair) on its diagonal, P_j is random.

    `above` is the size of T_j above its blocks, `stretch` the condition number of P_j.
    """
    n = sum(1 + (b.imag not in (0.0, math.pi)) for b in blocks)
    t = above * np.triu(rng.normal(size=(count, n, n)), 1)
    i = 0
    for b in blocks:
        shares = b.real * rng.dirichlet(np.full(count, 5.0)) if count < 9 else np.full(count, b.real / count)
        if b.imag in (0.0, math.pi):
            signs = np.where(rng.random(count) < 0.5, -1.0, 1.0)
            signs[-1] *= np.prod(signs) * (1.0 if b.imag == 0.0 else -1.0)
            t[:, i, i] = signs * np.exp(shares)
            i += 1
        else:
            angles = np.full(count, b.imag / count)
            c, s = np.cos(angles), np.sin(angles)
            t[:, i : i + 2, i : i + 2] = np.exp(shares)[:, None, None] * np.array(
                [[c, -s], [s, c]]
            ).transpose(2, 0, 1)
            i += 2
    p = [np.linalg.qr(rng.normal(size=(n, n)))[0] * rng.uniform(1.0, stretch, n) for _ in range(count)]
    p.append(p[0])
    return np.array([p[j + 1] @ t[j] @ np.linalg.inv(p[j]) for j in range(count)])


def listed(blocks):
    """What log_multipliers gives for these blocks, of different moduli."""
    out = []
    for b in sorted(blocks, key=lambda b: -b.real):
        out += [b] if b.imag in (0.0, math.pi) else [complex(b), complex(b).conjugate()]
    return np.array(out, dtype=complex)


def exact(factors, digits):
    """Logs of the eigenvalues of the product."""
    with mpmath.workdps(digits):
        product = mpmath.eye(factors.shape[1])
        for factor in factors:
            product = mpmath.matrix(factor.tolist()) * product
        found = mpmath.eig(product, left=False, right=False) if len(product) > 1 else [product[0, 0]]
        return np.array([complex(mpmath.log(mu)) for mu in found])


def furthest(found, expected):
    """The largest distance when each multiplier is paired with the nearest one left, in relative terms."""
    left = list(expected)
    worst = 0.0
    for mu in found:
        gaps = [abs(cmath.exp(mu - other) - 1) if abs((mu - other).real) < 1 else math.inf for other in left]
        worst = max(worst, min(gaps))
        left.pop(int(np.argmin(gaps)))
    return worst


MODEL = [math.log(258), 0j, -3 + 1.2j, complex(-41, math.pi), -40 * math.log(10)]


@pytest.mark.parametrize("above", [0.0, 0.1])
@pytest.mark.parametrize("count", [60, 300])
@pytest.mark.parametrize(
    "blocks",
    [
        [complex(-7, math.pi)],
        [2 + 3j],
        [90 + 0j, -94.2 + 0j],
        [1 + 0j, -6 + 0.1j],
        MODEL,
        [92.1 + 1j, 40 + 0j, 30 + 2j, 3 + 0.5j, complex(2, math.pi), -2 + 0j, -50 + 3j, -92.1 + 0j],
    ],
    ids=lambda blocks: f"n = {len(listed(blocks))}",
)
def test_known_multipliers_over_eighty_decades(blocks, count, above):
    factors = known(np.random.default_rng(2024), count, blocks, above=above)
    np.testing.assert_allclose(log_multipliers(factors), listed(blocks), rtol=0, atol=TOLERANCE)


@pytest.mark.parametrize("count", [1, 2, 7])
def test_known_multipliers_of_a_few_factors(count):
    blocks = [
        2 + 0j,
        1.5 + 2j,
        complex(0.3, math.pi),
        0j,
        -1 + 0.2j,
        -2 + 3.1j,
        -2.5 + 0j,
        complex(-3, math.pi),
    ]
    factors = known(np.random.default_rng(7), count, blocks, above=0.2)
    np.testing.assert_allclose(
        log_multipliers(factors), listed(blocks[:-1] + blocks[-1:]), rtol=0, atol=1e-12
    )


@pytest.mark.parametrize(
    ("n", "count"), [(1, 60), (2, 1), (2, 60), (2, 300), (3, 60), (6, 1), (6, 60), (12, 2), (12, 30)]
)
def test_random_products_against_mpmath(n, count):
    factors = np.random.default_rng(100 * n + count).normal(size=(count, n, n))
    assert furthest(log_multipliers(factors), exact(factors, 80 + count)) < TOLERANCE


@pytest.mark.parametrize("angle", [1e-8, 1e-6, 1e-3, math.pi / 2, math.pi - 1e-3, math.pi - 1e-6])
@pytest.mark.parametrize("count", [1, 2, 60, 300])
def test_pairs_on_the_unit_circle(angle, count):
    """Also close to +1 and -1, where trace^2 - 4 det would leave half of the digits."""
    blocks = [1 + 0j, complex(0, angle), complex(-2, 3.0 - 0.5 * angle), -4 + 0j]
    found = log_multipliers(known(np.random.default_rng(3), count, blocks, stretch=1.0))
    np.testing.assert_allclose(found, listed(blocks), rtol=0, atol=2e-13)
    assert found[2] == found[1].conjugate()
    assert found[1].imag == pytest.approx(angle, rel=1e-4)  # not a few digits of 1e-8


def test_what_joining_neighbours_costs():
    """Each multiplier to K n eps times the condition number up to which factors are joined."""
    factors = known(np.random.default_rng(5), 60, MODEL, stretch=4.0)
    error = furthest(log_multipliers(factors), exact(factors, 120))
    assert error < 60 * 6 * EPS * GROUPED
    # and many that are each well conditioned are not joined to one that is not: forming the product fails
    product = np.linalg.multi_dot(factors[::-1])
    assert abs(np.log(np.abs(np.linalg.eigvals(product))).min() - MODEL[-1]) > 10


def test_nonnormal_factors_lose_what_their_condition_says():
    """|change| <= sum |A_j| / (|A_j x_j| |y_j x_j|) eps, with a small factor, for products that grow in between."""
    rng = np.random.default_rng(12)
    for _ in range(12):
        n, count = rng.integers(2, 5), rng.integers(1, 8)
        factors = np.triu(rng.normal(size=(count, n, n))) + 1e-4 * rng.normal(size=(count, n, n))
        with mpmath.workdps(80):
            matrices = [mpmath.matrix(f.tolist()) for f in factors]
            product = mpmath.eye(int(n))
            for a in matrices:
                product = a * product
            values, lefts, rights = mpmath.eig(product, left=True, right=True)
            for i, mu in enumerate(values):
                x, y, condition = [rights[:, i]], lefts[i, :], 0.0
                for a in matrices:
                    x.append(a * x[-1])
                for j in range(count - 1, -1, -1):
                    alignment = abs((y * x[j + 1])[0]) / (mpmath.norm(y) * mpmath.norm(x[j]))
                    condition += float(np.linalg.norm(factors[j], 2) / alignment)
                    y = y * matrices[j]
                error = np.min(np.abs(np.exp(log_multipliers(factors) - complex(mpmath.log(mu))) - 1))
                assert error < 30 * EPS * condition


BLOCKS = st.lists(
    st.floats(-30, 30).map(complex)
    | st.floats(-30, 30).map(lambda log: complex(log, math.pi))
    | st.builds(complex, st.floats(-30, 30), st.floats(0.01, 3.13)),
    min_size=1,
    max_size=6,
)


@settings(max_examples=80, derandomize=True, database=None, deadline=None)
@given(BLOCKS, st.integers(0, 2**31), st.integers(15, 40), st.integers(0, 39))
@example([0j, 0j, 4 + 0j, 4 + 0j], 0, 15, 4)  # a deflation that is forgotten later on shows here
def test_shifted_inverted_and_summed(blocks, seed, count, first):
    """A cyclic shift leaves the multipliers, the inverses have the inverse ones; the sum of all logs is log|det|."""
    factors = known(np.random.default_rng(seed), count, blocks)
    found = log_multipliers(factors)
    assert np.all(np.diff(found.real) <= 0)
    assert furthest(found, listed(blocks)) < TOLERANCE
    assert furthest(log_multipliers(np.roll(factors, first % count, axis=0)), found) < TOLERANCE
    inverse = log_multipliers(np.linalg.inv(factors)[::-1])
    assert furthest(-inverse, found) < TOLERANCE
    assert np.sum(found.real) == pytest.approx(np.sum(np.linalg.slogdet(factors)[1]), abs=TOLERANCE)
    assert (
        furthest([np.sum(found)], [cmath.log(np.prod(np.linalg.slogdet(factors)[0])) + np.sum(found.real)])
        < TOLERANCE
    )
    pairs = found[(found.imag != 0) & (found.imag != math.pi)]
    assert np.array_equal(pairs[1::2], pairs[::2].conj())
    assert np.all(pairs[::2].imag > 0)


@settings(max_examples=300, derandomize=True, database=None, deadline=None)
@given(st.integers(0, 2**31), st.integers(1, 12), st.integers(1, 4))
def test_small_integers_converge(seed, n, count):
    """Many defective, equal, zero and symmetric multipliers: whatever they are, QR ends, in the order promised."""
    found = log_multipliers(np.random.default_rng(seed).integers(-1, 2, size=(count, n, n)).astype(float))
    assert not np.isnan(found.real).any()
    assert np.all(found.real[1:] <= found.real[:-1])
    assert np.all((found.imag > -math.pi) & (found.imag <= math.pi))


def test_two_pairs_each_drawing_one_real_shift():
    """Shifts at the real parts of two pairs reduce both alike: Francis' own take over forty sweeps."""
    a = [[1, 0, 0, 0, -1], [-1, -1, -1, -1, 0], [-1, -1, -1, 1, 1], [-1, 0, 0, 1, 1], [-1, -1, 0, 0, -1]]
    a = np.array(a, dtype=float)[None]
    assert furthest(log_multipliers(a), exact(a, 50)) < 1e-13


@pytest.mark.parametrize("n", [3, 4, 12])
def test_roots_of_unity(n):
    """A cyclic permutation is what a double shift from its last two rows leaves as it is."""
    found = log_multipliers(np.roll(np.eye(n), 1, axis=0)[None])
    np.testing.assert_allclose(
        np.sort(found.imag % (2 * math.pi)), 2 * math.pi * np.arange(n) / n, atol=1e-13
    )
    np.testing.assert_allclose(found.real, 0, atol=1e-13)


def test_equal_and_defective():
    np.testing.assert_allclose(
        log_multipliers(np.array([-3 * np.eye(6)] * 5)), 5 * cmath.log(-3).real + 1j * math.pi
    )
    shear = np.eye(2) + np.diag([0.1], 1)
    np.testing.assert_allclose(log_multipliers(np.array([shear] * 10)), 0, atol=1e-15)
    rng = np.random.default_rng(8)
    p = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(10)]
    t = np.diag([0.5, 2.0, 2.0]) + np.diag([0.0, 0.1], 1)
    found = log_multipliers(np.array([p[(j + 1) % 10] @ t @ p[j].T for j in range(10)]))
    np.testing.assert_allclose(found[:2], 10 * math.log(2), atol=1e-6)  # a root of eps, as for any method
    assert np.sum(found[:2].real) == pytest.approx(20 * math.log(2), abs=1e-12)
    assert found[2] == pytest.approx(-10 * math.log(2), abs=1e-12)


@pytest.mark.parametrize("exponent", [300, -300])
def test_factors_of_any_size(exponent):
    """The product's norm is 1e30000."""
    factors = known(np.random.default_rng(9), 100, MODEL, stretch=1.5)
    found = log_multipliers(factors * 10.0**exponent)
    np.testing.assert_allclose(found, listed(MODEL) + 100 * exponent * math.log(10), rtol=1e-14, atol=1e-10)
    far_apart = np.array([np.diag([2.0, 10.0 ** (exponent / 2)]), np.diag([3.0, 10.0 ** (exponent / 2)])])
    expected = sorted([math.log(6), exponent * math.log(10)], reverse=True)
    np.testing.assert_allclose(log_multipliers(far_apart), expected, rtol=1e-14)


def test_zero_multipliers():
    """Of a projection in one factor, of one of rank three as well, of a Jordan block for zero, of nothing but zeros."""
    rng = np.random.default_rng(10)
    factors = known(rng, 30, [1 + 0j, 0.5 + 1j, -1 + 0j, -20 + 0j])
    v, w = rng.normal(size=(2, 5))
    factors[13] = (np.eye(5) - np.outer(v, w) / (v @ w)) @ factors[13]
    found = log_multipliers(factors)
    assert found[-1] == complex(-math.inf, 0)
    assert furthest(found[:4], np.sort(exact(factors, 120))[1:]) < TOLERANCE
    factors[29, 2] = factors[29, 4] = 0.0
    found = log_multipliers(factors)
    assert np.array_equal(np.isneginf(found.real), [False] * 3 + [True] * 2)
    assert furthest(found[:3], np.sort(exact(factors, 120))[2:]) < TOLERANCE
    p = np.linalg.qr(rng.normal(size=(4, 4)))[0]
    nilpotent = np.diag(np.ones(3), 1)
    for product in ([nilpotent], [nilpotent @ p.T, p], [np.eye(4), np.zeros((4, 4)), np.eye(4)]):
        np.testing.assert_array_equal(log_multipliers(np.array(product)), np.full(4, complex(-math.inf, 0)))


def test_empty_and_not_finite():
    assert log_multipliers(np.zeros((5, 0, 0))).shape == (0,)
    np.testing.assert_array_equal(log_multipliers(np.zeros((0, 3, 3))), np.zeros(3))
    for bad in (math.nan, math.inf):
        factors = np.array([np.eye(3)] * 4)
        factors[2, 0, 1] = bad
        assert np.isnan(log_multipliers(factors)).all()


def test_input_is_left_as_it_is():
    factors = np.random.default_rng(11).normal(size=(6, 4, 4)) * 1e200
    before = factors.copy()
    log_multipliers(factors)
    np.testing.assert_array_equal(factors, before)
