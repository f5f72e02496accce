"""Objects that appear in free space are written once they have stayed there."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from slam_core.config import MapConfig, SlamConfig, with_value
from slam_core.geometry import transform_points
from slam_core.mapping.newcomers import Newcomers
from slam_core.slam import HectorSlam
from tests.worlds import room_scan

SECOND = 1_000_000_000
DELAY = 3.0
REST = np.zeros(3)
ARC = np.column_stack([np.full(20, 1.5), np.linspace(-0.2, 0.2, 20)]).astype(np.float32)
ALL = np.ones(len(ARC), np.bool_)


def late(newcomers, points, seconds, pose=REST, unexpected=ALL):
    """How many of the points of a keyframe are not written."""
    found = newcomers.too_new(points, pose, unexpected, round(seconds * SECOND), DELAY)
    return int(found.sum())


def test_what_stays_is_written_after_the_delay():
    """Also as seen from another place: it stays in the map."""
    newcomers = Newcomers()
    assert late(newcomers, ARC, 0.0) == len(ARC)
    assert late(newcomers, ARC, 2.9) == len(ARC)
    aside = np.array([0.5, 0.2, 0.3])
    seen = transform_points(np.zeros(3), ARC) - aside[:2]
    turned = seen @ np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    assert late(newcomers, turned.astype(np.float32), 3.1, aside) == 0


def test_what_walks_is_never_written():
    """Somebody who keeps beside the robot, at half a metre a second."""
    newcomers = Newcomers()
    for k in range(40):
        assert late(newcomers, ARC, 0.5 * k, np.array([0.25 * k, 0.0, 0.0])) == len(ARC)


def test_what_was_seen_long_ago_does_not_count():
    """Nor what is to come, where a clock is set back."""
    newcomers = Newcomers()
    late(newcomers, ARC, 100.0)
    assert late(newcomers, ARC, 120.0) == len(ARC)
    assert late(newcomers, ARC, 50.0) == len(ARC)


@given(arrays.arrays(np.bool_, len(ARC)), st.floats(0.0, 1e6), st.sampled_from([0.0, DELAY]))
def test_only_what_lies_in_free_space_waits(unexpected, seconds, delay):
    """Whatever it is; without a delay nothing does."""
    found = Newcomers().too_new(ARC, REST, unexpected, round(seconds * SECOND), delay)
    assert (found == (unexpected & (delay > 0.0))).all()


@pytest.mark.parametrize("delay", [0.0, DELAY])
def test_a_visitor_in_a_known_room_is_no_landmark(delay):
    """A keyframe writes neither the visitor nor what is behind, but the free space up to there; without the delay
    the visitor is in the map at once.
    """
    config = with_value(SlamConfig(map=MapConfig(size=400, keyframe_max_delay=0.0)), "map.appearance_delay", delay)
    slam = HectorSlam(config)
    for k in range(3):
        slam.step(room_scan(np.array([0.5 * k, 0.0, 0.0]), k * SECOND, noise=0.0))
    scan = room_scan(np.array([1.5, 0.0, 0.0]), 3 * SECOND, noise=0.0)
    scan.ranges[60:80] = 1.0
    result = slam.step(scan)
    assert result.map_updated and result.unexpected.sum() >= 15
    there = transform_points(result.planar, result.points[result.unexpected])
    columns, rows = slam.map.levels[0].cell_of(there[:, 0], there[:, 1])
    assert (slam.map.levels[0].log_odds[rows, columns] > 0).mean() == pytest.approx(float(delay == 0.0), abs=0.1)
