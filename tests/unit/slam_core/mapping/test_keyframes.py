"""Which scans are written: by the way since the last, and where nothing tells the motion by how well they fit."""

import numpy as np
import pytest

from slam_core.config import MapConfig
from slam_core.mapping.keyframes import KeyframePolicy

CONFIG = MapConfig(update_distance=0.4, update_angle=0.06, keyframe_max_delay=0.5)
SECOND = 1_000_000_000
WELL, BADLY = np.full(100, 0.10, np.float32), np.full(100, 0.13, np.float32)


@pytest.fixture
def policy():
    """After scans that fitted well, the last of them written at the origin at time 0."""
    policy = KeyframePolicy()
    assert policy.selects(np.zeros(3), 0, None, CONFIG)
    for k in range(20):
        assert not policy.selects(np.zeros(3), k, WELL, CONFIG)
    return policy


@pytest.mark.parametrize("pose", [(0.41, 0.0, 0.0), (0.0, -0.41, 0.0), (0.0, 0.0, 0.061), (0.0, 0.0, -0.061)])
def test_a_scan_is_written_once_the_robot_moved_or_turned(policy, pose):
    """As far as the settings say, in any direction, and then not again at the same place."""
    pose = np.array(pose)
    assert not policy.selects(0.9 * pose, SECOND, None, CONFIG)
    assert policy.selects(pose, SECOND, None, CONFIG)
    assert not policy.selects(pose, 2 * SECOND, None, CONFIG)


def turned(by):
    """A pose at the origin."""
    return np.array([0.0, 0.0, by])


def test_a_scan_in_a_turn_that_fits_badly_waits_for_a_better_one(policy):
    """The better one is written at once, though the robot turned little further."""
    assert not policy.selects(turned(0.6), SECOND, BADLY, CONFIG)
    assert policy.selects(turned(0.61), SECOND + 1, WELL, CONFIG)


@pytest.mark.parametrize("rate", [0.0, 0.4, -0.4])
def test_a_scan_that_fits_badly_is_written_where_the_robot_turns_slowly(policy, rate):
    """Its sweep is not distorted: what fits badly is new, and the next scans need it."""
    assert policy.selects(np.array([0.5, 0.0, rate]), SECOND, BADLY, CONFIG)


def test_nothing_waits_longer_than_the_longest_delay(policy):
    """After half a second any scan will do, and the next wait begins anew."""
    assert not policy.selects(turned(0.6), SECOND, BADLY, CONFIG)
    assert not policy.selects(turned(1.2), SECOND + SECOND // 2 - 1, BADLY, CONFIG)
    assert policy.selects(turned(1.9), SECOND + SECOND // 2, BADLY, CONFIG)
    assert not policy.selects(turned(2.5), 2 * SECOND, 2.0 * BADLY, CONFIG)


def test_a_clock_that_is_set_back_ends_the_wait(policy):
    """Or the map would never be written again."""
    assert not policy.selects(turned(-3.0), 5 * SECOND, BADLY, CONFIG)
    assert policy.selects(turned(0.3), SECOND, BADLY, CONFIG)


def test_what_is_new_does_not_count_as_a_bad_fit(policy):
    """Ends on unknown map have a residual of one half each: such a scan is written."""
    new = np.concatenate([WELL, np.full(300, 0.5, np.float32)])
    assert policy.selects(turned(0.6), SECOND, new, CONFIG)


def test_a_scan_on_nothing_but_unknown_map_is_written_at_once(policy):
    """Also at the place of the last one, after a restart."""
    nothing = np.full(100, 0.5, np.float32)
    assert not policy.selects(np.zeros(3), SECOND, nothing, CONFIG)
    policy.restart()
    assert policy.selects(np.zeros(3), SECOND, nothing, CONFIG)
    assert not policy.selects(np.zeros(3), SECOND, nothing, CONFIG)


def test_all_scans_are_alike_where_the_motion_is_known(policy):
    """Without residuals there is no wait, nor with a delay of 0, the paper's way."""
    assert policy.selects(turned(0.6), SECOND, None, CONFIG)
    assert policy.selects(turned(1.2), 2 * SECOND, BADLY, MapConfig(keyframe_max_delay=0.0))


def test_each_laser_has_keyframes_of_its_own(policy):
    """What one has written shows nothing of what another one sees."""
    assert policy.selects(np.zeros(3), SECOND, None, CONFIG, facing=2)
    assert not policy.selects(np.zeros(3), 2 * SECOND, None, CONFIG, facing=2)
    assert not policy.selects(np.zeros(3), 3 * SECOND, None, CONFIG)
