"""What the motion between matches is known by."""

import numpy as np

from slam_core.config import SlamConfig
from slam_core.measurements import Imu, Odometry
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
