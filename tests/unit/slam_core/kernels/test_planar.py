"""The closed forms that run for every scan."""

import numpy as np
import pytest

from slam_core.kernels.planar import inverse3


@pytest.mark.parametrize("seed", range(20))
def test_inverse_is_numpy_s(seed: int):
    """For well-conditioned matrices it is the inverse."""
    J = np.random.default_rng(seed).normal(0, 30, (20, 3))
    np.testing.assert_allclose(inverse3(J.T @ J), np.linalg.inv(J.T @ J), rtol=1e-9)


@pytest.mark.parametrize("sigma", [0.002, 0.0117, 0.2, 5.0])
@pytest.mark.parametrize("rank", [0, 1, 2])
def test_inverse_stays_a_covariance_when_directions_are_unknown(sigma: float, rank: int):
    """Information of a few directions only, next to almost nothing in the others: symmetric and positive."""
    for seed in range(200):
        J = np.random.default_rng(seed).normal(0, 30, (rank, 3))
        inverse = inverse3(J.T @ J / sigma**2 + np.diag([0.01, 0.01, 0.1]))
        assert (inverse == inverse.T).all()
        assert np.linalg.eigvalsh(inverse).min() > 0
