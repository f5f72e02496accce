"""The fused pose claims no more than the map can give."""

import numpy as np

from slam_core.mapping.drift import DrawnMap
from slam_core.results import PlanarGaussian

ALONG, NOWHERE = np.array([0.6, 0.8]), np.zeros(2)
ACROSS = np.array([-0.8, 0.6])
SURE = 0.01


def belief(sigma_along: float) -> PlanarGaussian:
    """A pose that uncertain along, and sure of all else."""
    covariance = SURE**2 * np.eye(3)
    covariance[:2, :2] += (sigma_along**2 - SURE**2) * np.outer(ALONG, ALONG)
    return PlanarGaussian(np.array([1.0, 2.0, 0.3]), covariance)


def sigma(claimed: PlanarGaussian, direction: np.ndarray) -> float:
    return float(np.sqrt(direction @ claimed.covariance[:2, :2] @ direction))


def test_what_was_lost_along_an_open_direction_stays_when_it_closes() -> None:
    """The match beyond is sure of the place on the map; the claim keeps the 2 m, along that direction alone."""
    drawn = DrawnMap()
    for lost in (SURE, 1.0, 2.0):
        claimed = drawn.claim(belief(lost), ALONG)
        assert np.isclose(sigma(claimed, ALONG), lost)
    for _ in range(3):
        claimed = drawn.claim(belief(SURE), NOWHERE)
        assert np.isclose(sigma(claimed, ALONG), 2.0, atol=1e-3)
        assert np.isclose(sigma(claimed, ACROSS), SURE)
        assert claimed.covariance[2, 2] == SURE**2
        assert np.array_equal(claimed.mean, belief(SURE).mean)


def test_stretches_add_up_by_what_each_of_them_lost() -> None:
    """Of 3 m and 4 m, each from a sure pose: 5 m; a direction that opens without a loss adds nothing."""
    drawn = DrawnMap()
    for lost in (3.0, 4.0, SURE):
        drawn.claim(belief(SURE), ALONG)
        drawn.claim(belief(lost), ALONG)
        claimed = drawn.claim(belief(SURE), NOWHERE)
    assert np.isclose(sigma(claimed, ALONG), 5.0, atol=1e-3)


def test_where_no_direction_is_open_the_claim_is_the_filter_s() -> None:
    """However uncertain the pose is."""
    drawn = DrawnMap()
    for lost in (0.5, 3.0, SURE):
        assert np.array_equal(drawn.claim(belief(lost), NOWHERE).covariance, belief(lost).covariance)


def test_a_map_that_goes_on_from_a_prediction_is_as_uncertain_as_that() -> None:
    """3 m and 4 m, in every direction: 5 m from then on, however sure a match is of its place on the map."""
    drawn = DrawnMap()
    for lost in (3.0, 4.0):
        drawn.go_on(PlanarGaussian(np.zeros(3), lost**2 * np.eye(3)))
    claimed = drawn.claim(belief(SURE), NOWHERE)
    assert np.isclose(sigma(claimed, ALONG), 5.0, atol=1e-3)
    assert np.isclose(sigma(claimed, ACROSS), 5.0, atol=1e-3)
