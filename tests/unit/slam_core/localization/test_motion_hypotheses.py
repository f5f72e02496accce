"""Other motions of a sweep than the predicted one."""

import numpy as np
import pytest

from slam_core.config import SlamConfig, with_value
from slam_core.geometry import wrap
from slam_core.localization.deskew_refinement import cost
from slam_core.localization.motion_hypotheses import best_match, hypotheses, is_bent
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import LaserScan
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.scan.stabilise import stabilise
from tests.worlds import room_ranges

CONFIG = SlamConfig()
DT = 212_000_000  # 4.7 Hz
ANGLES = np.linspace(-np.pi / 2, np.pi / 2, 361)


def sweep(stamp_ns: int, start: np.ndarray, rate: float) -> LaserScan:
    """Half a turn of the laser from a pose (3,), while the robot turns in place at `rate`, rad/s."""
    increment = 0.5 * DT * 1e-9 / (len(ANGLES) - 1)
    poses = start + np.outer(increment * np.arange(len(ANGLES)), [0.0, 0.0, rate])
    ranges = [room_ranges(pose, angle[None])[0] for pose, angle in zip(poses, ANGLES, strict=True)]
    step = float(ANGLES[1] - ANGLES[0])
    return LaserScan(stamp_ns, np.array(ranges, np.float32), float(ANGLES[0]), step, time_increment=increment)


def at_rest(scans: int = 4) -> tuple[Pyramid, PlanarMotion, int]:
    """A map of the room, and the motion of a robot that has stood still for some scans."""
    pyramid, motion = Pyramid(CONFIG.map), PlanarMotion()
    for k in range(scans):
        scan = sweep(k * DT, np.zeros(3), 0.0)
        prior = motion.prior(scan.mid_ns, CONFIG.motion)
        placed = stabilise(scan, motion.poses, CONFIG.scan)
        if k:
            match = coarse_to_fine(pyramid, placed.points, prior.mean, CONFIG.matcher, prior=prior)
            motion.fuse(match.gaussian, CONFIG.fusion)
        pyramid.update(placed.points, placed.cleared, placed.laser, np.zeros(3), CONFIG.map)
    return pyramid, motion, scans * DT


def test_a_hypothesis_moves_what_depends_on_the_heading():
    """The conditional mean: the heading as given, the rate by their covariance, the rest where it was."""
    _, motion, time_ns = at_rest()
    before = motion.prior(time_ns, CONFIG.motion)
    other = motion.given(np.array([0.0, 0.0, 1.0]), 0.4)
    assert wrap(other.planar.mean[2] - before.mean[2]) == pytest.approx(0.4)
    np.testing.assert_allclose(other.planar.mean[:2], before.mean[:2], atol=0.02)
    assert other.twist[2] > motion.twist[2] + 0.4 / (DT * 1e-9)  # it has sped up within the time between scans
    np.testing.assert_array_equal(motion.planar.mean, before.mean)


def test_hypotheses_cover_three_sigmas_of_the_heading():
    """At 4.7 Hz; both ways alike, and none where the heading is known well."""
    _, motion, time_ns = at_rest()
    sigma = float(np.sqrt(motion.prior(time_ns, CONFIG.motion).covariance[2, 2]))
    headings = sorted(float(each.planar.mean[2]) for each in hypotheses(motion))
    assert headings[-1] > 3.0 * sigma - 0.2
    np.testing.assert_allclose(headings, np.negative(headings[::-1]), atol=0.02)
    _, motion, time_ns = at_rest()
    motion.prior(time_ns - DT + 10_000_000, CONFIG.motion)
    assert not any(abs(float(each.planar.mean[2])) > 0.15 for each in hypotheses(motion))


def test_a_turn_that_begins_between_two_scans_is_found():
    """100 degrees/s out of rest: a better match near the true pose, by beams placed as the turn moves them."""
    pyramid, motion, time_ns = at_rest()
    rate = np.radians(100.0)
    scan = sweep(time_ns, np.array([0.0, 0.0, 0.3]), rate)
    true = 0.3 + 0.5e-9 * rate * (scan.end_ns - scan.stamp_ns)
    prior = motion.prior(scan.mid_ns, CONFIG.motion)
    placed = stabilise(scan, motion.poses, CONFIG.scan)
    first = coarse_to_fine(pyramid, placed.points, prior.mean, CONFIG.matcher, prior=prior)
    found = best_match(scan, (placed, first), prior, pyramid, motion, CONFIG)
    assert found is not None
    assert cost(found[1]) < 0.9 * cost(first)
    assert abs(wrap(found[1].pose[2] - true)) < 0.02
    assert np.hypot(*found[1].pose[:2]) < 0.03


def test_a_good_match_stays():
    """No hypothesis is clearly better than the match of a robot that did stand still."""
    pyramid, motion, time_ns = at_rest()
    scan = sweep(time_ns, np.zeros(3), 0.0)
    prior = motion.prior(scan.mid_ns, CONFIG.motion)
    placed = stabilise(scan, motion.poses, CONFIG.scan)
    match = coarse_to_fine(pyramid, placed.points, prior.mean, CONFIG.matcher, prior=prior)
    assert best_match(scan, (placed, match), prior, pyramid, motion, CONFIG) is None


@pytest.mark.parametrize(("heading", "bent"), [(0.0, True), (0.2, False)], ids=["straight on", "turned"])
def test_a_sweep_that_is_bent_otherwise_than_its_match_shows(heading: float, bent: bool) -> None:
    """Beams placed by a turn of 1 rad/s: no motion of a robot that is where it was predicted to be."""
    pyramid, motion, time_ns = at_rest()
    scan = sweep(time_ns, np.zeros(3), 0.0)
    prior = motion.prior(scan.mid_ns, CONFIG.motion)
    placed = stabilise(scan, motion.poses, CONFIG.scan)
    match = coarse_to_fine(pyramid, placed.points, prior.mean, CONFIG.matcher, prior=prior)
    assert not is_bent((placed, match), prior, motion, scan, CONFIG)
    turning = stabilise(scan, motion.given(np.array([0.0, 0.0, 1.0]), 0.2).poses, CONFIG.scan)
    turned = match._replace(pose=prior.mean + np.array([0.0, 0.0, heading]))
    assert is_bent((turning, turned), prior, motion, scan, CONFIG) is bent
    whole = with_value(CONFIG, "scan.deskew", False)
    assert not is_bent((stabilise(scan, motion.poses, whole.scan), match), prior, motion, scan, whole)
