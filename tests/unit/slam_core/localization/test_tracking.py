"""Which matches are accepted."""

import numpy as np
import pytest

from slam_core.config import TrackingConfig
from slam_core.localization.tracking import (
    BEYOND,
    LEAST_WINDOW,
    NEAR,
    UNCERTAIN,
    UNUSUAL,
    Tracker,
    exceeds_basin,
    is_beyond,
    least_unusual,
    mahalanobis_distance,
    observed,
    sigmas_off,
)
from slam_core.mapping.grid import GridLevel
from slam_core.results import ACCEPTED, Fit, MatchResult, PlanarGaussian, Rejection, Verdict
from tests.worlds import fit, in_parts

CONFIG = TrackingConfig(lost_after=3)
GOOD, WORSE, BAD = Fit(0.9, 0.95), Fit(0.9, 0.65), Fit(0.9, 0.2)
NEW = Fit(0.1, 0.8)
WHY = Rejection("inlier_ratio", 0.2, 0.9)


def matched(x: float, fit: Fit = GOOD) -> MatchResult:
    """A sure match at a place on the x axis."""
    sure = np.diag([1e-6] * 3)
    pose, nothing = np.array([x, 0.0, 0.0]), np.zeros((0, 4))
    return MatchResult(pose, sure, np.eye(3), np.zeros(1), (1,), True, nothing, np.zeros(2), 1.0, fit)


def predicted(sigma: float) -> PlanarGaussian:
    """A prediction at the origin."""
    return PlanarGaussian(np.zeros(3), np.diag([sigma**2] * 3))


def test_the_fit_counts_known_and_occupied_cells():
    """One endpoint off the map, one on unknown, one on free and one on occupied ground: half known, half hits."""
    level = GridLevel(1.0, (4, 4), np.array([-1.0, -1.0]))
    level.cells[1, 2], level.cells[2, 1] = in_parts([0.9, 0.1])  # at x, y = 1, 0 and 0, 1
    points = np.array([[9.0, 0.0], [-0.5, -0.5], [1.5, 0.5], [0.5, 1.5]], np.float32)
    assert fit(level, points, np.zeros(3)) == Fit(0.5, 0.5)
    turned = np.column_stack([points[:, 1], -points[:, 0]])  # as seen from a quarter turn to the left
    assert fit(level, turned, np.array([0.0, 0.0, 0.5 * np.pi])) == Fit(0.5, 0.5)
    assert fit(level, points[2:3], np.zeros(3)) == Fit(1.0, 1.0)


def test_a_match_is_rejected_for_each_of_three_reasons():
    """Little overlap, few inliers, hardly known and far from the prediction: code, value and limit."""
    tracker = Tracker()
    assert tracker.check(GOOD, 1.0, CONFIG) is None
    assert tracker.check(Fit(0.1, 1.0), 1.0, CONFIG) == ("overlap", 0.1, CONFIG.min_overlap)
    assert tracker.check(BAD, 1.0, CONFIG) == ("inlier_ratio", 0.2, 0.9)
    assert tracker.check(Fit(0.5, 0.9), 40.0, CONFIG) == ("mahalanobis_distance", 40.0, NEAR)
    assert tracker.check(GOOD, 40.0, CONFIG) is None  # the correction at the end of a corridor


def test_the_usual_inlier_ratio_follows_the_place():
    """Where few endpoints ever hit an occupied cell, as among reeds, a low inlier ratio is accepted in time."""
    tracker = Tracker()
    reeds = Fit(0.9, 0.55)
    assert tracker.check(reeds, 0.0, CONFIG)
    for hit in np.linspace(0.9, 0.6, 200):
        tracker.learn(matched(0.0, Fit(0.9, float(hit))), predicted(0.1))
    assert not tracker.check(reeds, 0.0, CONFIG)


def test_the_states_follow_each_other():
    """Degraded, lost after as many scans as set, recovered once, then tracking."""
    tracker = Tracker()
    rejected = [tracker.reject(WHY, CONFIG) for _ in range(4)]
    assert [verdict.state for verdict in rejected] == ["degraded", "degraded", "lost", "lost"]
    assert not any(verdict.accepted for verdict in rejected)
    found = [tracker.accept(None) for _ in range(2)]
    assert [verdict.state for verdict in found] == ["recovered", "tracking"]
    assert tracker.accept(WHY).state == "recovered"


def test_a_pose_from_a_search_needs_a_better_fit():
    """A fit that is just good enough to continue is not good enough to jump to."""
    tracker = Tracker()
    assert not tracker.check(WORSE, 0.0, CONFIG)
    assert not tracker.confirms(WORSE, 0.0, CONFIG)
    assert tracker.confirms(GOOD, 90.0, CONFIG)
    assert not tracker.confirms(Fit(0.1, 1.0), 0.0, CONFIG)


def test_a_match_that_fits_badly_is_compared_with_one_that_fits_clearly_better():
    """Only on known ground, and no match is replaced by one that fits badly, too, or lies on unknown cells."""
    tracker = Tracker()
    assert tracker.is_bad(Fit(0.9, 0.8)) and not tracker.is_bad(Fit(0.9, 0.85))
    assert not tracker.is_bad(Fit(0.5, 0.8))
    assert tracker.is_better(Fit(0.9, 0.9), Fit(0.9, 0.7))
    assert not tracker.is_better(Fit(0.9, 0.85), Fit(0.9, 0.8))
    assert not tracker.is_better(Fit(0.9, 0.75), Fit(0.9, 0.6))
    assert not tracker.is_better(Fit(0.5, 0.9), Fit(0.9, 0.7))


def test_a_match_is_poor_that_hits_less_than_usual_or_lies_on_little_known_map() -> None:
    """A turn that begins is matched there: what is left of the scan on the map fits."""
    tracker = Tracker()
    assert tracker.is_poor(Fit(0.9, 0.8)) and not tracker.is_poor(Fit(0.9, 0.9))
    assert tracker.is_poor(Fit(0.4, 1.0)) and not tracker.is_poor(Fit(0.6, 1.0))


def test_a_scan_on_little_known_map_is_rejected_far_from_the_prediction() -> None:
    """Four tenths of a scan that fit are accepted three sigmas from the prediction, and not ten sigmas away."""
    tracker, little = Tracker(), Fit(0.4, 0.95)
    assert tracker.check(little, 3.0, CONFIG) is None
    assert tracker.confirms(little, 3.0, CONFIG)
    rejection = tracker.check(little, 10.0, CONFIG)
    assert rejection and rejection[:2] == ("mahalanobis_distance", 10.0)
    assert not tracker.confirms(little, 10.0, CONFIG)


@pytest.mark.parametrize(
    ("x", "sigma", "usual", "leaps"),
    [(0.35, 0.05, 0.0, False), (0.5, 0.1, 0.0, True), (0.5, 0.15, 0.0, False), (0.5, 0.1, 0.2, False)],
)
def test_a_leap_is_far_in_metres_in_sigmas_and_for_the_predictions_of_this_robot(
    x: float, sigma: float, usual: float, leaps: bool
) -> None:
    """Half a metre at once where predictions are good; not where a laser that sways makes all of them bad."""
    tracker = Tracker()
    for _ in range(200):
        tracker.learn(matched(usual), predicted(sigma))
    assert tracker.leaps(matched(x), predicted(sigma)) == leaps


@pytest.mark.parametrize(("degrees", "exceeds"), [(5.0, False), (5.7, False), (5.8, True), (40.0, True)])
def test_three_sigmas_of_the_predicted_heading_are_compared_with_the_basin(degrees: float, exceeds: bool) -> None:
    """0.3 rad are the limit, however small the variance of the position."""
    prior = PlanarGaussian(np.zeros(3), np.diag([1.0, 1.0, np.radians(degrees) ** 2]))
    assert exceeds_basin(prior) == exceeds


def test_the_mahalanobis_distance_adds_both_covariances_and_wraps_the_heading():
    """Three and four centimetres and 0.02 rad, on sigmas that add up to 1 cm and 0.01 rad."""
    half = np.diag([1e-4, 1e-4, 1e-4]) / 2
    match = MatchResult(
        np.array([0.03, 0.0, np.pi - 0.01]), half, np.eye(3), np.zeros(1), (1,), True, np.zeros((0, 4))
    )
    prior = PlanarGaussian(np.array([0.0, 0.04, -np.pi + 0.01]), half)
    assert mahalanobis_distance(match, prior) == pytest.approx(np.sqrt(9 + 16 + 4))


def test_the_weakest_direction_is_the_long_axis_of_the_covariance():
    """Two metres along a diagonal corridor, a centimetre across it."""
    turn = np.array([[1.0, -1.0], [1.0, 1.0]]) / np.sqrt(2)
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = turn @ np.diag([4.0, 1e-4]) @ turn.T
    match = MatchResult(np.zeros(3), covariance, np.eye(3), np.zeros(1), (1,), True, np.zeros((0, 4)))
    assert match.weakest_sigma == pytest.approx(2.0)


def test_what_is_unusual_depends_on_the_time_between_two_scans():
    """A fast scanner sees a change of speed as a short step: 4 cm at 10 Hz; the limit of a slow one stays."""
    assert least_unusual(100_000_000) == pytest.approx(0.04)
    assert least_unusual(213_000_000) == least_unusual(10**12) == UNUSUAL
    assert least_unusual(-1) == 0.0  # a clock that was set back


def down_a_corridor(sigma: float) -> PlanarGaussian:
    """A fused pose that is known badly along x."""
    return PlanarGaussian(np.zeros(3), np.diag([sigma**2, 1e-4, 1e-4]))


ALONG = matched(0.0)._replace(unobservable=np.array([1.0, 0.0]))


def test_a_direction_that_no_beam_fixes_is_tracked_as_long_as_it_is_known():
    """Then the state is degraded, with the sigma along it; the match is accepted as before."""
    assert observed(ACCEPTED, ALONG, down_a_corridor(0.99 * UNCERTAIN)) is ACCEPTED
    verdict = observed(ACCEPTED, ALONG, down_a_corridor(3.0))
    assert (verdict.state, verdict.accepted, verdict.confirmed) == ("degraded", True, True)
    assert verdict.rejection == ("unobservable", pytest.approx(3.0), UNCERTAIN)
    assert verdict.undoubted


@pytest.mark.parametrize("state", ["degraded", "lost"])
def test_what_is_worse_than_an_unobservable_direction_stays(state: str):
    """Its reason as well."""
    verdict = Verdict(state, WHY, accepted=False)  # type: ignore[arg-type]
    assert observed(verdict, ALONG, down_a_corridor(3.0)) is verdict
    assert not verdict.undoubted


def test_an_observed_direction_may_be_uncertain():
    """The next match tells. The first scan of a map has none."""
    across = ALONG._replace(unobservable=np.array([0.0, 1.0]))
    for match in (matched(0.0), across, None):
        assert observed(ACCEPTED, match, down_a_corridor(3.0)) is ACCEPTED


def test_a_match_counts_within_the_window_that_was_searched():
    """And half a metre, half a radian beyond; it is three sigmas of the prediction, at least LEAST_WINDOW."""
    distance, angle = LEAST_WINDOW
    turned = matched(0.0)._replace(pose=np.array([0.0, 0.0, angle + BEYOND + 0.01]))
    assert not is_beyond(matched(distance + BEYOND - 0.01), predicted(0.1), CONFIG)
    assert is_beyond(matched(distance + BEYOND + 0.01), predicted(0.1), CONFIG)
    assert is_beyond(turned, predicted(0.1), CONFIG)
    assert not is_beyond(turned, predicted(0.2), CONFIG)
    assert not is_beyond(matched(distance + BEYOND + 0.01), predicted(0.2), CONFIG)


def test_the_distance_of_positions_is_in_sigmas_of_both():
    """Whatever the headings are."""
    turned = matched(0.3)._replace(pose=np.array([0.3, 0.0, 1.0]))
    assert sigmas_off(turned, predicted(0.1)) == pytest.approx(3.0, rel=1e-3)
