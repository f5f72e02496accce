"""The covariance of the fused pose contains the drift of the map."""

import numpy as np

from slam_core.mapping.drift import MapDrift
from slam_core.results import PlanarGaussian

ALONG, NOWHERE = np.array([0.6, 0.8]), np.zeros(2)
ACROSS = np.array([-0.8, 0.6])
SURE = 0.01


def pose(sigma_along: float) -> PlanarGaussian:
    """A pose with this sigma along ALONG, and SURE otherwise."""
    covariance = SURE**2 * np.eye(3)
    covariance[:2, :2] += (sigma_along**2 - SURE**2) * np.outer(ALONG, ALONG)
    return PlanarGaussian(np.array([1.0, 2.0, 0.3]), covariance)


def sigma(fused: PlanarGaussian, direction: np.ndarray) -> float:
    return float(np.sqrt(direction @ fused.covariance[:2, :2] @ direction))


def test_the_drift_along_an_unobservable_direction_stays() -> None:
    """Later matches have a small covariance on the map; the fused one keeps the 2 m, along it alone."""
    drift = MapDrift()
    for lost in (SURE, 1.0, 2.0):
        fused = drift.added_to(pose(lost), ALONG)
        assert np.isclose(sigma(fused, ALONG), lost)
    for _ in range(3):
        fused = drift.added_to(pose(SURE), NOWHERE)
        assert np.isclose(sigma(fused, ALONG), 2.0, atol=1e-3)
        assert np.isclose(sigma(fused, ACROSS), SURE)
        assert fused.covariance[2, 2] == SURE**2
        assert np.array_equal(fused.mean, pose(SURE).mean)


def test_the_drifts_of_stretches_add_up() -> None:
    """Of 3 m and 4 m, each from a well-known pose: 5 m; a stretch without growth adds nothing."""
    drift = MapDrift()
    for lost in (3.0, 4.0, SURE):
        drift.added_to(pose(SURE), ALONG)
        drift.added_to(pose(lost), ALONG)
        fused = drift.added_to(pose(SURE), NOWHERE)
    assert np.isclose(sigma(fused, ALONG), 5.0, atol=1e-3)


def test_without_an_unobservable_direction_nothing_is_added() -> None:
    """However large the covariance of the pose is."""
    drift = MapDrift()
    for lost in (0.5, 3.0, SURE):
        assert np.array_equal(drift.added_to(pose(lost), NOWHERE).covariance, pose(lost).covariance)


def test_a_map_continued_from_a_prediction_has_its_covariance() -> None:
    """3 m and 4 m, in every direction: 5 m from then on, however small the covariance of a match is."""
    drift = MapDrift()
    for lost in (3.0, 4.0):
        drift.continue_from(PlanarGaussian(np.zeros(3), lost**2 * np.eye(3)))
    fused = drift.added_to(pose(SURE), NOWHERE)
    assert np.isclose(sigma(fused, ALONG), 5.0, atol=1e-3)
    assert np.isclose(sigma(fused, ACROSS), 5.0, atol=1e-3)
