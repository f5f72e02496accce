"""What the motion between matches is known by."""

import numpy as np
import pytest

from slam_core.config import SlamConfig
from slam_core.diagnostics import TOO_LATE
from slam_core.measurements import Imu, LaserScan, Odometry
from slam_core.navigation.ego_motion import SETTLED, EgoMotion
from slam_core.results import FEW, MatchResult

SAMPLE_NS, MATCH_NS, GAP_NS = 10_000_000, 50_000_000, 1_000_000_000
GRAVITY = np.array([0.0, 0.0, 9.80665])


def sampled(motion: EgoMotion, begin_ns: int, end_ns: int) -> None:
    """Inertial data of a base at rest."""
    for stamp_ns in range(begin_ns, end_ns, SAMPLE_NS):
        motion.take(Imu(stamp_ns, np.zeros(3), GRAVITY))


def matched(motion: EgoMotion, begin_ns: int, share: float) -> int:
    """Inertial data and SETTLED matches, whose worst direction such a share of the beams fix; when they end."""
    covariance, nothing = np.diag([1e-4, 1e-4, 1e-6]), np.zeros((0, 4))
    match = MatchResult(np.zeros(3), covariance, np.eye(3), np.zeros(1), (1,), True, nothing, np.zeros(2), share)
    for k in range(SETTLED):
        end_ns = begin_ns + (k + 1) * MATCH_NS
        sampled(motion, end_ns - MATCH_NS, end_ns)
        motion.correct(end_ns - SAMPLE_NS, match, accepted=True)
    return end_ns


def test_the_map_begins_where_the_base_is_with_the_velocity_of_its_wheels():
    """What they have driven before the first scan is no error that a match puts right."""
    motion = EgoMotion(SlamConfig())
    for k in range(100):
        motion.take(Odometry(k * MATCH_NS, np.array([1.0, 0.0]), 0.3))
    now_ns = 99 * MATCH_NS
    motion.catch_up(now_ns)
    assert np.hypot(*motion.prior(now_ns).mean[:2]) > 4.0
    fused, _ = motion.correct(now_ns, None, accepted=True)
    np.testing.assert_allclose(fused.mean, np.zeros(3), atol=1e-9)
    np.testing.assert_allclose(motion.prior(now_ns + MATCH_NS).mean, [0.05, 0.0, 0.015], atol=2e-3)


def test_what_was_driven_before_the_first_scan_says_nothing_against_the_inertial_data():
    """The map begins where the base is then: it goes on at its speed, and its turn was no bias of the gyros."""
    motion = EgoMotion(SlamConfig())
    sampled(motion, 0, GAP_NS)
    for stamp_ns in range(GAP_NS, 3 * GAP_NS, SAMPLE_NS):
        force = GRAVITY + np.array([0.5, 0.25 * (stamp_ns - GAP_NS) * 1e-9, 0.0])
        motion.take(Imu(stamp_ns, np.array([0.0, 0.0, 0.5]), force))
    motion.inertial, now_ns = True, 3 * GAP_NS - SAMPLE_NS
    assert motion.prior(now_ns).mean[0] > 0.5
    fused, _ = motion.correct(now_ns, None, accepted=True)
    np.testing.assert_allclose(fused.mean, np.zeros(3), atol=1e-3)
    forward, _, turned = motion.prior(now_ns + MATCH_NS).mean
    assert forward == pytest.approx(0.05, abs=0.01)
    assert turned == pytest.approx(0.5 * MATCH_NS * 1e-9, abs=1e-3)


def test_a_long_way_within_what_inertial_data_may_be_wrong_by_is_none_of_their_error_either():
    """The position is known to metres then: nothing tells that the base still is where it was."""
    motion = EgoMotion(SlamConfig())
    sampled(motion, 0, GAP_NS)
    for stamp_ns in range(GAP_NS, 6 * GAP_NS, SAMPLE_NS):
        shaken = 0.3 * np.sin(2.0 * np.pi * stamp_ns * 1e-9)
        motion.take(Imu(stamp_ns, np.zeros(3), GRAVITY + np.array([0.1 + shaken, 0.0, 0.0])))
    motion.inertial, now_ns = True, 6 * GAP_NS - SAMPLE_NS
    way, covariance = motion.prior(now_ns)
    assert 1.0 < way[0] < 3.0 * np.sqrt(covariance[0, 0])
    motion.correct(now_ns, None, accepted=True)
    assert motion.prior(now_ns + MATCH_NS).mean[0] == pytest.approx(0.5 * MATCH_NS * 1e-9, abs=0.01)


def test_a_base_that_rests_until_the_first_scan_is_known_to_rest():
    """Where it is then is where it was: its speed is surer for that."""
    motion = EgoMotion(SlamConfig())
    sampled(motion, 0, GAP_NS)
    motion.inertial, now_ns = True, GAP_NS - SAMPLE_NS
    before = motion.prior(now_ns + GAP_NS).covariance
    motion.correct(now_ns, None, accepted=True)
    assert motion.prior(now_ns + GAP_NS).covariance[0, 0] < before[0, 0]


def test_a_scan_is_predicted_by_what_was_measured_until_then():
    """Wheels that turned faster later, before it came, are those of the next scan."""
    motion = EgoMotion(SlamConfig())
    motion.take(Odometry(0, np.array([0.5, 0.0]), 0.0))
    motion.catch_up(0)
    motion.correct(0, None, accepted=True)
    for k in range(1, 5):
        motion.take(Odometry(k * MATCH_NS, np.array([0.5 if k <= 2 else 1.0, 0.0]), 0.0))
    motion.catch_up(2 * MATCH_NS)
    np.testing.assert_allclose(motion.prior(2 * MATCH_NS).mean, [0.05, 0.0, 0.0], atol=2e-3)
    motion.catch_up(4 * MATCH_NS)
    assert 0.12 < motion.prior(4 * MATCH_NS).mean[0] < 0.16


def test_after_a_gap_in_the_inertial_data_matches_have_to_show_the_speed():
    """From the start it is known; the gap is noticed while it lasts and behind it; few beams show no speed."""
    motion = EgoMotion(SlamConfig())
    sampled(motion, 0, GAP_NS)
    motion.inertial = True
    assert motion.knows_speed(GAP_NS)
    assert not motion.knows_speed(2 * GAP_NS)
    now_ns = matched(motion, 2 * GAP_NS, 0.5 * FEW)
    assert not motion.knows_speed(now_ns)
    now_ns = matched(motion, now_ns, 2.0 * FEW)
    assert motion.knows_speed(now_ns)
    sampled(motion, now_ns + GAP_NS, now_ns + 2 * GAP_NS)
    assert not motion.knows_speed(now_ns + 2 * GAP_NS)


def test_a_scan_is_refused_once_the_state_buffer_has_forgotten_its_time():
    """None is that the buffer holds, or of before inertial data came, or without inertial data."""
    motion = EgoMotion(SlamConfig())
    scans = [LaserScan(k * GAP_NS, np.ones(9, np.float32), 0.0, 0.1) for k in range(-1, 9)]
    assert not any(motion.refusal(scan, begun=True) for scan in scans)
    sampled(motion, 0, 8 * GAP_NS)
    motion.inertial = True
    refused = [motion.refusal(scan, begun=True) for scan in scans]
    assert set(refused[2:6]) == {TOO_LATE}
    assert not any(refused[:2]) and not any(refused[8:])


def test_the_scan_at_which_inertial_data_takes_over_is_not_refused():
    """It was measured a moment before the newest sample, at which the filter goes on."""
    motion = EgoMotion(SlamConfig())
    for k in range(3):
        assert not motion.refusal(LaserScan(k * MATCH_NS, np.ones(9, np.float32), 0.0, 0.1), begun=k > 0)
        motion.correct(k * MATCH_NS, None, accepted=True)
    sampled(motion, 0, GAP_NS)
    scan = LaserScan(GAP_NS - MATCH_NS, np.ones(9, np.float32), 0.0, 0.1)
    assert not motion.refusal(scan, begun=True)
    assert motion.inertial
