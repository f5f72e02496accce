"""The tree of frames."""

import math

import numpy as np
import pytest

from hectorscope.ros.stamps import AHEAD
from hectorscope.ros.tf import HISTORY_NS, TfTree
from slam_core import geometry
from slam_core.measurements import Transform

SECOND = 1_000_000_000


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0) -> Transform:
    return Transform(np.array([x, y, z]), geometry.from_euler(0.0, 0.0, yaw))


def test_a_chain_is_the_product_of_its_transforms() -> None:
    """Up one branch and down another, the lookup equals the product of matrices."""
    tree = TfTree()
    odom_base, base_laser, base_imu = at(1, 2, 0, 0.5), at(0.2, 0, 0.3, math.pi / 2), at(0, -0.1, 0, -0.2)
    tree.add("odom", "base", 0, odom_base, static=False)
    tree.add("base", "laser", 0, base_laser, static=True)
    tree.add("base", "imu", 0, base_imu, static=True)
    expected = np.linalg.inv(geometry.matrix(base_imu)) @ geometry.matrix(base_laser)
    found = tree.lookup("imu", "laser", 0)
    assert found is not None
    np.testing.assert_allclose(geometry.matrix(found), expected, atol=1e-12)
    back = tree.lookup("laser", "odom", 0)
    assert back is not None
    expected = np.linalg.inv(geometry.matrix(odom_base) @ geometry.matrix(base_laser))
    np.testing.assert_allclose(geometry.matrix(back), expected, atol=1e-12)


def test_between_samples_the_transform_is_interpolated() -> None:
    """Half-way in time is half-way in position and turn; beyond the ends the nearest sample holds."""
    tree = TfTree()
    tree.add("base", "laser", 100, at(0.0), static=False)
    tree.add("base", "laser", 200, at(1.0, yaw=0.4), static=False)
    for time_ns, x, yaw in ((150, 0.5, 0.2), (50, 0.0, 0.0), (900, 1.0, 0.4)):
        T = tree.lookup("base", "laser", time_ns)
        assert T is not None
        assert T.translation[0] == pytest.approx(x)
        assert geometry.heading(T.rotation) == pytest.approx(yaw)


def test_frames_of_two_trees_are_not_joined() -> None:
    """No common ancestor, no transform."""
    tree = TfTree()
    tree.add("a", "b", 0, at(), static=True)
    tree.add("c", "d", 0, at(), static=True)
    assert tree.lookup("b", "d", 0) is None


def test_a_cycle_of_frames_ends_the_climb() -> None:
    """Transforms that form a ring do not hang the lookup."""
    tree = TfTree()
    tree.add("a", "b", 0, at(), static=True)
    tree.add("b", "a", 0, at(), static=True)
    assert tree.climb("a") == ["a", "b"]
    assert tree.lookup("a", "b", 0) is not None


def test_a_dynamic_transform_that_never_changes_counts_as_fixed() -> None:
    """ROS 1 publishes fixed mounts to /tf again and again: nobody has to wait for the next one."""
    tree = TfTree()
    for time_ns in range(0, 1000, 100):
        tree.add("base", "laser", time_ns, at(0.2), static=False)
    revision = tree.revision
    assert tree.known_until_ns("base", "laser") is None
    tree.add("base", "laser", 1000, at(0.3), static=False)
    assert tree.known_until_ns("base", "laser") == 1000
    assert tree.revision > revision
    held = tree.lookup("base", "laser", 450)
    assert held is not None
    assert held.translation[0] == pytest.approx(0.2)


def test_late_and_repeated_samples_are_no_news() -> None:
    """A sample that is not newer than the last one changes nothing."""
    tree = TfTree()
    tree.add("odom", "base", 200, at(1.0), static=False)
    tree.add("odom", "base", 200, at(5.0), static=False)
    tree.add("odom", "base", 100, at(9.0), static=False)
    T = tree.lookup("odom", "base", 150)
    assert T is not None
    assert T.translation[0] == 1.0


def test_a_lone_sample_of_the_future_is_no_news() -> None:
    """It is named, and the samples behind it are taken in; one that the next confirms is followed."""
    tree = TfTree()
    seconds = (0, 1, 100_000, 2, 3, 23, 24)
    news = [tree.add("base", "laser", s * SECOND, at(float(s)), static=False) for s in seconds]
    assert news == ["", "", AHEAD, "", "", AHEAD, ""]
    for s in (1, 2, 3, 24):
        T = tree.lookup("base", "laser", s * SECOND)
        assert T is not None
        assert T.translation[0] == s


def test_a_clock_set_back_begins_the_motion_anew() -> None:
    """What was stamped by the clock before is forgotten, as its times mean something else now."""
    tree = TfTree()
    for s in (0, 1, -3600, -3599, -3598, -3597):
        tree.add("base", "laser", s * SECOND, at(float(s)), static=False)
    assert tree.known_until_ns("base", "laser") == -3597 * SECOND
    T = tree.lookup("base", "laser", -3597 * SECOND - SECOND // 2)
    assert T is not None
    assert T.translation[0] == pytest.approx(-3597.5)


def test_old_motion_is_forgotten() -> None:
    """A tree that lives for days keeps a bounded past, and what it keeps is right."""
    tree = TfTree()
    step = HISTORY_NS // 100
    for i in range(1000):
        tree.add("odom", "base", i * step, at(float(i)), static=False)
    kept = tree._edges["base"].stamps
    assert len(kept) <= 201
    T = tree.lookup("odom", "base", 950 * step + step // 2)
    assert T is not None
    assert T.translation[0] == pytest.approx(950.5)
