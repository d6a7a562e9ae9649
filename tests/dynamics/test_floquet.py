"""Exponents by unshifted QR, for where the shifted one gives up, against it and against known products; their order."""

import numpy as np
import pytest

from rainwind.dynamics import floquet
from rainwind.dynamics.kernels.exponents import matched
from rainwind.dynamics.kernels.periodic_schur import log_multipliers


@pytest.mark.parametrize("seed", range(5))
def test_unshifted_qr_agrees_with_shifted_qr(seed):
    factors = np.random.default_rng(seed).normal(size=(60, 6, 6))
    found = floquet.by_orthogonal_iteration(factors)
    assert found == pytest.approx(log_multipliers(factors), abs=1e-11)


def test_known_exponents_with_a_cluster_and_a_span_of_hundreds_of_decades():
    """As on a doubled orbit of the paper's model, where shifted QR did not converge: 84.7, a cluster of three, -765."""
    rng = np.random.default_rng(3)
    known = np.array([84.7, 0.19, -0.097, -0.502, -765.0])
    many = 240
    frames = [np.linalg.qr(rng.normal(size=(5, 5)))[0] for _ in range(many)]
    frames.append(frames[0])
    factors = np.array([frames[j + 1] @ np.diag(np.exp(known / many)) @ frames[j].T for j in range(many)])
    assert floquet.by_orthogonal_iteration(factors) == pytest.approx(known, abs=1e-9)


def test_exponents_keep_their_places_round_the_circle():
    """A pair just short of -1 follows two multipliers just past it, whatever the sign of their angle."""
    before = np.array([0.1 + np.pi * 1j, -0.2 + 3.1j, -0.2 - 3.1j])
    after = np.array([-0.21 - 3.13j, 0.11 - 3.14159j, -0.21 + 3.13j])
    assert list(matched(before, after)) == [after[1], after[2], after[0]]
