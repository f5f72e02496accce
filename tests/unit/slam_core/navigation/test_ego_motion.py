"""What the motion between matches is known by."""

import numpy as np

from slam_core.config import SlamConfig
from slam_core.measurements import Imu
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
