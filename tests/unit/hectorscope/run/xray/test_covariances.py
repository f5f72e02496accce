"""Prior, scan, their fusion, and the cloud of noisy matches."""

import numpy as np
import pytest

from hectorscope.run.xray.covariances import MATCHES, Cloud, best_omega, fused, fusion
from slam_core.matching.matcher import hessian_covariance
from slam_core.navigation.covariance_intersection import intersect
from tests.xray import problem, scanned


def test_r_is_that_of_the_run():
    """Eq. (15) by the reference and by the core, whose R of the shown match it is."""
    _, result = scanned()
    assert result.match is not None
    R = fusion(problem(), 0.3).R
    np.testing.assert_allclose(R, result.match.covariance, atol=0.02 * np.abs(R).max())
    np.testing.assert_allclose(R, hessian_covariance(result.match.hessian, 0.2), atol=0.02 * np.abs(R).max())


def test_fused_covariances_are_those_of_the_core():
    """Eq. (18) at the omega of the slider, and the Kalman update."""
    P, R = problem().prior.covariance, fusion(problem(), 0.3).R
    found, zero = fusion(problem(), 0.3), np.zeros(3)
    np.testing.assert_allclose(found.fused, intersect(P, np.eye(3), R, zero, 0.3)[1], rtol=1e-6)
    np.testing.assert_allclose(found.kalman, intersect(P, np.eye(3), R, zero, 0.5, "kalman")[1], rtol=1e-6)


def test_another_omega_changes_the_fused_covariance_alone():
    """It is that of (18) with it; all else is the same object, so that a slider costs next to nothing."""
    first = fusion(problem(), 0.3)
    other = first.at(0.7)
    assert other.omega == 0.7
    np.testing.assert_array_equal(other.fused, fusion(problem(), 0.7).fused)
    assert other.sampled is first.sampled
    assert other.R is first.R


def test_no_omega_has_a_smaller_determinant_than_the_best():
    """Against a search of another kind, on covariances that are each better in one direction."""
    P, R = np.diag([1.0, 0.01, 0.1]), np.diag([0.02, 2.0, 0.1])
    best = best_omega(P, R)
    others = [np.linalg.det(fused(P, R, omega)) for omega in np.linspace(0.01, 0.99, 37)]
    assert np.linalg.det(fused(P, R, best)) <= min(others) * (1.0 + 1e-9)
    assert np.linalg.det(intersect(P, np.eye(3), R, np.zeros(3), 0.5, "determinant")[1]) == pytest.approx(
        np.linalg.det(fused(P, R, best)), rel=1e-3
    )


def test_a_cloud_is_the_same_each_time_and_spreads_with_the_noise():
    """Seeded; no noise gives no spread; twice the noise more of it; its covariance is that of its ends."""
    one, again, wide, still = (Cloud(problem(), noise) for noise in (0.01, 0.01, 0.05, 0.0))
    for _ in range(30):
        for cloud in (one, again, wide, still):
            cloud.try_next()
    np.testing.assert_array_equal(one.ends, again.ends)
    np.testing.assert_allclose(one.covariance, np.cov(one.ends.T), atol=1e-15)
    assert np.trace(still.covariance) < 1e-12 < np.trace(one.covariance) < np.trace(wide.covariance)
    assert not one.whole
    assert len(one) == 30 < MATCHES
