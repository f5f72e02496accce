"""Scans that something near the laser hides, in the test room."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from slam_core.config import MapConfig, SlamConfig
from slam_core.localization.hidden_walls import MOST, SOME, TRUSTED_NS, covered, hidden, match_visible, misled
from slam_core.localization.tracking import NEAR
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.results import PlanarGaussian
from slam_core.scan.stabilise import StabilisedScan, stabilise
from tests.worlds import mapped_room, room_scan, standing

CONFIG = SlamConfig(map=MapConfig(size=400))
HERE = np.array([0.5, -0.5, 0.2])
SHARP = np.diag([0.01, 0.01, 0.005]) ** 2.0
VAGUE = np.diag([0.5, 0.5, 0.5]) ** 2.0
USUAL = 0.95

Hide = Callable[[NDArray[np.float32]], NDArray[np.float32]]


@pytest.fixture(scope="module")
def room() -> Pyramid:
    """The test room, mapped from four places."""
    return mapped_room(CONFIG)


def hand(ranges: NDArray[np.float32]) -> NDArray[np.float32]:
    """All around."""
    return np.minimum(ranges, np.float32(0.4))


def crowd(ranges: NDArray[np.float32]) -> NDArray[np.float32]:
    """Two beams in five end on people."""
    found = ranges.copy()
    for begin in range(0, len(found), len(found) // 4):
        body = slice(begin, begin + len(found) // 10)
        found[body] = np.minimum(found[body], 0.6)
    return found


def seen(pose: NDArray[np.float64] = HERE, hide: Hide = np.array) -> StabilisedScan:
    """A scan of the room from a pose (3,)."""
    scan = room_scan(pose)
    return stabilise(replace(scan, ranges=hide(scan.ranges)), standing, CONFIG.scan)


def at(pose: NDArray[np.float64], covariance: NDArray[np.float64] = SHARP) -> PlanarGaussian:
    """A prediction."""
    return PlanarGaussian(pose, covariance)


def test_a_hand_hides_all_walls(room: Pyramid) -> None:
    """Every beam ends before them. Without it none does."""
    found = hidden(room, seen(hide=hand), HERE, MOST)
    assert found is not None
    assert found.mean() > 0.9
    assert hidden(room, seen(), HERE, SOME) is None


def test_where_little_of_the_map_is_known_that_part_tells() -> None:
    """A robot that only saw ahead is covered all around: behind it nothing is known. Far off nothing is."""
    pyramid, ahead = Pyramid(CONFIG.map), seen(hide=_ahead)
    for _ in range(3):
        pyramid.update(ahead.points, np.empty((0, 2), np.float32), ahead.laser, HERE, CONFIG.map)
    scan, far = seen(hide=hand), HERE + np.array([30.0, 0.0, 0.0])
    found = covered(pyramid, scan, at(HERE), HERE, 0)
    assert found is not None
    assert 0.3 < found.value < MOST
    assert covered(pyramid, scan, at(far), far, 0) is None
    assert covered(pyramid, scan, at(far, VAGUE), HERE, 0) is None  # it may be elsewhere, and see something else


def _ahead(ranges: NDArray[np.float32]) -> NDArray[np.float32]:
    """The half of the view."""
    k = len(ranges) // 4
    return np.concatenate((np.full(k, np.inf), ranges[k:-k], np.full(k, np.inf)))


def test_what_crosses_walls_is_not_hidden(room: Pyramid) -> None:
    """At a wrong pose many beams end in free space, too, but others go through the walls."""
    wrong = HERE + np.array([2.0, 1.0, 0.6])
    assert room.unexpected(seen().points, wrong).mean() > SOME
    assert hidden(room, seen(), wrong, SOME) is None


def test_a_covered_scan_is_told_by_the_sure_pose_where_the_prediction_is_vague(room: Pyramid) -> None:
    """For a while: then the robot may be anywhere."""
    scan, far = seen(hide=hand), at(np.array([30.0, 0.0, 0.0]), VAGUE)
    found = covered(room, scan, far, HERE, TRUSTED_NS - 1)
    assert found
    assert found.code == "hidden"
    assert found.value > MOST
    assert covered(room, scan, far, HERE, TRUSTED_NS) is None
    assert covered(room, scan, at(HERE), far.mean, TRUSTED_NS)
    straight = at(HERE, np.diag([0.5, 0.5, 0.01]) ** 2.0)  # inertial data tell the heading: either may be the one
    assert covered(room, scan, straight, far.mean, 0)
    assert covered(room, scan, at(far.mean, straight.covariance), HERE, 0)
    assert covered(room, scan, at(HERE, VAGUE), far.mean, 0) is None
    assert covered(room, seen(hide=crowd), at(HERE), HERE, 0) is None


def test_the_walls_between_people_are_matched(room: Pyramid) -> None:
    """The people do not drag the match along, and are left out of it."""
    off = HERE + np.array([0.02, -0.015, 0.01])
    match = match_visible(room, seen(hide=crowd), at(off, 4.0 * SHARP), USUAL, CONFIG.matcher)
    assert match
    assert np.abs(match.pose - HERE).max() < 0.01
    assert 0.3 < len(match.left_out) / len(seen().points) < 0.5
    assert len(match.residuals) == len(seen().points)
    assert match.fit.hit > USUAL


@pytest.mark.parametrize(
    ("prior", "hide"),
    [
        (at(HERE, VAGUE), crowd),
        (at(HERE), np.array),  # nobody is there
        (at(HERE), hand),  # nothing is left
        (at(HERE + np.array([0.3, 0.3, 0.0])), crowd),  # the walls are elsewhere
    ],
)
def test_nothing_is_left_out_of_other_scans(room: Pyramid, prior: PlanarGaussian, hide: Hide) -> None:
    """A vague prediction, no people, no walls, or walls that do not fit: the match of all beams remains."""
    assert match_visible(room, seen(hide=hide), prior, USUAL, CONFIG.matcher) is None


def test_a_match_beyond_the_noise_of_the_prediction_is_not_believed_while_walls_are_hidden(room: Pyramid) -> None:
    """The same match is believed if nothing hides the walls, or if the prediction is vague."""
    match = coarse_to_fine(room, seen().points, HERE, CONFIG.matcher)
    match = match._replace(pose=HERE + np.array([0.3, 0.0, 0.0]))
    found = misled(room, seen(hide=crowd), match, at(HERE))
    assert found
    assert found.code == "hidden"
    assert misled(room, seen(), match, at(HERE)) is None
    assert misled(room, seen(hide=crowd), match, at(HERE, VAGUE)) is None
    near = match._replace(pose=HERE + np.array([0.4 * NEAR * 0.01, 0.0, 0.0]))
    assert misled(room, seen(hide=crowd), near, at(HERE)) is None
