"""When a pose that was found after bad matches counts."""

import numpy as np
import pytest

from slam_core.config import TrackingConfig
from slam_core.localization.confirmation import (
    DRIFT,
    FASTER,
    FEW,
    REACH,
    SEVERAL,
    SIGMAS,
    TURN,
    WALK,
    Confirmation,
)
from slam_core.results import ACCEPTED, Fit, PlanarGaussian, Verdict

USUAL, DT = 0.9, 100_000_000
CONFIG = TrackingConfig()
GOOD, POOR, NEW = Fit(0.9, 0.95), Fit(0.9, 0.7), Fit(0.3, 0.95)
SEARCHED = Verdict("recovered", recovery="relocalised")


class Drive:
    """Matches at 10 Hz, each where it is predicted unless it is said otherwise."""

    def __init__(self) -> None:
        self.confirmation, self.time_ns = Confirmation(np.zeros(3)), 0

    def match(
        self,
        x: float = 0.0,
        fit: Fit = GOOD,
        verdict: Verdict = ACCEPTED,
        predicted: float | None = None,
        sigma: float = 1.0,
        *,
        is_unusual: bool = False,
        measured: bool = False,
    ):
        """The verdict on an accepted match at x, with a standard deviation of the prediction."""
        self.time_ns += DT
        mean = np.array([x if predicted is None else predicted, 0.0, 0.0])
        prior = PlanarGaussian(mean, sigma**2 * np.eye(3))
        pose = np.array([x, 0.0, 0.0])
        return self.confirmation.accepted(
            pose, fit, verdict, prior, USUAL, self.time_ns, CONFIG, is_unusual=is_unusual, measured=measured
        )

    def miss(self, times: int = 1) -> bool:
        """Bad matches. Whether the last one ended a pose that waited."""
        self.time_ns += times * DT
        return [self.confirmation.rejected() for _ in range(times)][-1]


def test_a_tracked_pose_is_sure():
    """No bad match, no jump: the verdict stays, also for a scan that fits worse."""
    drive = Drive()
    assert drive.match() == ACCEPTED
    assert drive.match(fit=POOR) == ACCEPTED
    assert not drive.confirmation.pending


def test_after_a_bad_match_few_good_scans_confirm():
    """Until then the state is degraded and nothing is written; a poor one does not count."""
    drive = Drive()
    drive.match()
    drive.miss()
    waiting = [drive.match() for _ in range(FEW - 1)] + [drive.match(fit=POOR)]
    assert len(waiting) < SEVERAL
    assert {(verdict.state, verdict.accepted, verdict.confirmed) for verdict in waiting} == {
        ("degraded", True, False)
    }
    sure = drive.match()
    assert (sure.state, sure.confirmed) == ("recovered", True)
    assert drive.match() == ACCEPTED


def test_where_predictions_are_near_the_fit_may_be_worse_than_usual():
    """A robot that enters a cluttered room is not lost: several matches in a row are where they were predicted."""
    drive = Drive()
    drive.match()
    drive.miss()
    drive.match(0.3, fit=POOR, predicted=0.0)
    assert not any(drive.match(0.3, fit=POOR).confirmed for _ in range(SEVERAL - 1))
    assert drive.match(0.3, fit=POOR).confirmed


@pytest.mark.parametrize("missed", [0, CONFIG.lost_after])
def test_a_pose_far_off_or_after_long_needs_several_scans_on_known_map(missed):
    """It is lost meanwhile; scans that mostly lie on unknown cells prove nothing, nor do near predictions."""
    drive = Drive()
    drive.match()
    if missed:
        drive.miss(missed)
    waiting = [drive.match(5.0, predicted=0.0)]
    drive.confirmation.agrees()
    waiting += [drive.match(6.0, fit=NEW) for _ in range(20)]
    waiting += [drive.match(6.0) for _ in range(SEVERAL - 2)]
    assert {(verdict.state, verdict.confirmed) for verdict in waiting} == {("lost", False)}
    assert drive.match(6.0).confirmed


def test_poses_that_were_never_confirmed_make_a_robot_lost():
    """Found and given up again for long: steady matches that are poor do not confirm any more."""
    drive = Drive()
    drive.match()
    for _ in range(CONFIG.lost_after // 4 + 1):
        drive.miss()
        assert {drive.match(fit=POOR).state for _ in range(3)} == {"degraded"}
    drive.miss()
    assert {drive.match(fit=POOR).state for _ in range(3 * SEVERAL)} == {"lost"}
    assert drive.confirmation.awaits_search


def test_a_sure_prediction_confirms_after_many_bad_matches():
    """Inertial data carries a robot through scans of noise: where they predict, few good scans suffice."""
    drive = Drive()
    drive.match()
    drive.miss(2 * CONFIG.lost_after)
    assert [drive.match(sigma=0.1).confirmed for _ in range(FEW)] == [False] * (FEW - 1) + [True]


def test_a_pose_far_off_waits_until_a_search_agrees():
    """Until a search of the map has found it too, another place may explain the scans better."""
    drive = Drive()
    drive.match()
    drive.match(5.0, predicted=0.0)
    assert not any(drive.match(5.0 + 0.1 * k).confirmed for k in range(50))
    assert drive.confirmation.awaits_search
    drive.confirmation.agrees()
    assert not drive.confirmation.awaits_search
    assert drive.match(10.0).confirmed


def test_without_searches_a_pose_far_off_need_not_wait_for_one():
    """Also if they were switched off after it was found."""
    drive = Drive()
    drive.match()
    drive.match(50.0, predicted=0.0)
    for k in range(1, 10):
        pose = np.array([50.0 + 0.1 * k, 0.0, 0.0])
        prior, alone = PlanarGaussian(pose, np.eye(3)), TrackingConfig(relocalise=False)
        time_ns = drive.time_ns + k * DT
        verdict = drive.confirmation.accepted(
            pose, GOOD, ACCEPTED, prior, USUAL, time_ns, alone, is_unusual=False, measured=False
        )
    assert verdict.confirmed
    assert not drive.confirmation.pending


def test_a_robot_that_was_lost_stays_so_until_it_is_found():
    """A pose near where it was held is as doubtful as one far off."""
    drive = Drive()
    drive.match()
    drive.match(5.0, predicted=0.0)
    drive.miss()
    assert drive.confirmation.is_lost
    assert {drive.match(0.1 * k).state for k in range(50)} == {"lost"}


def test_a_pose_of_a_search_has_to_hold_at_another_place():
    """A robot at rest may stand where two places look alike."""
    drive = Drive()
    drive.match()
    drive.miss(CONFIG.lost_after)
    drive.match(1.0, verdict=SEARCHED)
    assert not any(drive.match(1.0).confirmed for _ in range(50))
    assert drive.match(1.5).confirmed


def test_a_bad_match_ends_what_waits():
    """The pose that was sure before stays the last one."""
    drive = Drive()
    drive.match(2.0)
    assert not drive.miss()
    drive.match(3.0)
    assert drive.miss()
    assert not drive.confirmation.pending
    assert drive.confirmation.missed == 3
    np.testing.assert_array_equal(drive.confirmation.pose, [2.0, 0.0, 0.0])


def test_a_robot_comes_no_further_than_it_drives():
    """Two metres at once, and one more a second, from where it was sure; before that it may be anywhere."""
    drive = Drive()
    assert drive.confirmation.region(0) is None
    drive.match(1.0)
    region = drive.confirmation.region(drive.time_ns + 3_000_000_000)
    assert region is not None
    np.testing.assert_array_equal(region.centre, [1.0, 0.0, 0.0])
    assert region.radius == REACH + WALK * 3.0
    assert region.holds(np.array([1.0 + region.radius - 0.1, 0.0, 2.0]))
    assert not region.holds(np.array([1.0 + region.radius + 0.1, 0.0, 2.0]))


def test_a_vague_inertial_prediction_makes_a_robot_lost_after_one_bad_match():
    """It follows a long time without scans: few good ones do not show the place, as they do at a sure one."""
    for sigma, state in ((1.0, "lost"), (0.1, "recovered")):
        drive = Drive()
        drive.match()
        drive.miss()
        verdicts = [drive.match(sigma=sigma, measured=True) for _ in range(FEW)]
        assert verdicts[-1].state == state


def predicted(x: float, sigma: float, heading: float = 0.0) -> PlanarGaussian:
    """By inertial data."""
    return PlanarGaussian(np.array([x, 0.0, heading]), sigma**2 * np.diag([1.0, 1.0, 0.01]))


def test_inertial_data_limits_where_a_robot_can_be_and_its_heading():
    """The smaller circle of two counts: what it can have driven, or what its prediction leaves open."""
    drive = Drive()
    drive.match()
    later = drive.time_ns + 10_000_000_000
    for sigma, centre, radius in ((0.5, 3.0, REACH + SIGMAS * 0.5), (5.0, 0.0, REACH + WALK * 10.0)):
        region = drive.confirmation.region(later, None, predicted(3.0, sigma, 1.0))
        assert region is not None
        assert (region.centre[0], region.radius) == (centre, pytest.approx(radius))
        assert (region.heading, region.turn) == (1.0, pytest.approx(TURN + SIGMAS * 0.1 * sigma))
        assert region.holds(np.array([1.0, 0.0, 1.0 + region.turn - 0.1]))
        assert not region.holds(np.array([1.0, 0.0, 1.0 + region.turn + 0.1]))
    never_sure = Confirmation(np.zeros(3)).region(later, None, predicted(3.0, 0.5))
    assert never_sure is not None and never_sure.radius == REACH + SIGMAS * 0.5


def test_a_prediction_that_is_known_to_be_wrong_limits_nothing():
    """The robot was carried: it may be wherever somebody can have walked with it, turned round."""
    drive = Drive()
    drive.match()
    drive.confirmation.rejected_matches.add(Fit(0.9, 0.1), USUAL, CONFIG, is_vague=False)
    drive.miss()
    region = drive.confirmation.region(drive.time_ns + 9_000_000_000, None, predicted(0.0, 0.1))
    assert region is not None
    assert region.radius > REACH + WALK * 9.0
    assert region.holds(np.array([8.0, 0.0, np.pi]))


def test_where_a_robot_was_predicted_counts_while_a_pose_waits():
    """Matches may follow it from a wrong place: they show its motion, and the prediction where that began."""
    drive = Drive()
    drive.match()
    drive.miss(CONFIG.lost_after)
    drive.match(6.0, verdict=SEARCHED, predicted=1.0, sigma=0.2, measured=True)
    assert drive.match(8.0, sigma=0.01, measured=True).state == "lost"
    region = drive.confirmation.region(drive.time_ns, np.array([8.0, 0.0, 0.0]), predicted(8.0, 0.01))
    assert region is not None
    assert region.centre[0] == 1.0 and region.motion[0] == pytest.approx(2.0)
    assert not region.holds(np.array([8.0, 0.0, 0.0]))
    back = drive.confirmation.as_predicted(np.array([8.0, 0.0, 0.0]), drive.time_ns + 2_000_000_000 - DT)
    assert back is not None
    np.testing.assert_allclose(back.mean, [3.0, 0.0, 0.0], atol=1e-12)
    assert back.covariance[0, 0] == pytest.approx(0.2**2 + 1.0)


def test_only_a_pose_far_from_its_prediction_is_given_up_for_it():
    """Not a tracked one, one near the prediction, or one of a robot whose prediction is known to be wrong."""
    drive = Drive()
    drive.match()
    assert drive.confirmation.as_predicted(np.zeros(3), drive.time_ns) is None
    drive.miss()
    drive.match(0.2, predicted=0.0, sigma=0.1, measured=True)
    assert drive.confirmation.as_predicted(np.zeros(3), drive.time_ns) is None
    drive.miss(CONFIG.lost_after)
    drive.match(6.0, verdict=SEARCHED, predicted=0.0, sigma=0.1, measured=True)
    assert drive.confirmation.as_predicted(np.zeros(3), drive.time_ns) is not None
    drive.confirmation.rejected_matches.add(Fit(0.9, 0.1), USUAL, CONFIG, is_vague=False)
    assert drive.confirmation.as_predicted(np.zeros(3), drive.time_ns) is None


def test_a_robot_that_was_seen_to_be_fast_may_be_further_off():
    """Its speed over a second counts, and not what matches of two scans differ by."""
    drive = Drive()
    for k in range(50):
        drive.match(0.5 * k + 0.2 * (k % 2))
    region = drive.confirmation.region(drive.time_ns + 3_000_000_000)
    assert region is not None
    assert region.radius == pytest.approx(REACH + FASTER * 5.0 * 3.0, rel=0.06)


def test_the_way_of_a_lost_robot_to_where_it_is_found_is_no_speed():
    """It may have been anywhere meanwhile, and the place may be wrong."""
    drive = Drive()
    drive.match()
    drive.miss(CONFIG.lost_after)
    drive.match(50.0, verdict=SEARCHED)
    drive.confirmation.agrees()
    for k in range(30):
        drive.match(50.0 + 0.05 * k)
    assert not drive.confirmation.pending
    region = drive.confirmation.region(drive.time_ns + 3_000_000_000)
    assert region is not None
    assert region.radius == pytest.approx(REACH + WALK * 3.0)


def test_a_match_that_is_unusually_far_off_and_fits_badly_waits():
    """It sets the robot in motion; nearer to the prediction, or with a good fit, it is as sure as any."""
    for fit, is_unusual, waits in ((POOR, True, True), (GOOD, True, False), (POOR, False, False)):
        drive = Drive()
        drive.match()
        assert drive.match(0.3, fit, predicted=0.0, is_unusual=is_unusual).confirmed != waits
        assert not drive.confirmation.awaits_search


def test_how_a_robot_moved_since_it_was_found_is_known():
    """Wherever it is, it was within reach then: a place from which it cannot have come is none."""
    drive = Drive()
    drive.match(1.0)
    drive.miss()
    drive.match(3.2, predicted=1.0)
    for x in np.arange(3.3, 8.0, 0.1):
        drive.match(x)
    assert drive.confirmation.awaits_search
    region = drive.confirmation.region(drive.time_ns, np.array([x, 0.0, 0.0]))
    assert region is not None
    assert region.radius == pytest.approx(REACH + WALK * 0.2 + DRIFT * (x - 3.2))
    assert region.reach == pytest.approx(region.radius + x - 3.2)
    assert region.holds(np.array([x, 0.0, 0.0]))
    assert region.holds(np.array([1.0 - (x - 3.2), 0.0, np.pi]))  # turned round, it went the other way
    assert not region.holds(np.array([x - 6.0, 0.0, 0.0]))


def test_of_a_motion_that_jumped_nothing_is_known():
    """A match far from the prediction while a pose waits: the robot may be wherever it can have come since."""
    drive = Drive()
    drive.match(1.0)
    drive.miss()
    drive.match(3.2, predicted=1.0)
    drive.match(4.0, predicted=3.3)
    region = drive.confirmation.region(drive.time_ns, np.array([4.0, 0.0, 0.0]))
    assert region is not None
    assert (region.radius, *region.motion) == (pytest.approx(REACH + WALK * 0.3), 0.0, 0.0, 0.0)
