"""The messages that are read in one go: as the library reads them, or left to it."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.ros.layouts import quick_reader
from tests.ros_messages import Messages

GENERATIONS = {name: Messages(name) for name in ("ros1", "ros2")}
NUMBERS = st.floats(width=32, allow_nan=False)
NAMES = st.text(max_size=12).filter(lambda name: "\0" not in name)


def raw(ros: Messages, message: Any) -> bytes:
    serialise = ros.store.serialize_ros1 if ros.ros1 else ros.store.serialize_cdr
    return bytes(serialise(message, message.__msgtype__))


def quick(ros: Messages, data: bytes, msgtype: str) -> Any:
    read = quick_reader(msgtype, ros1=ros.ros1)
    assert read is not None
    return read(data)


def same_header(one: Any, other: Any) -> bool:
    return (one.stamp.sec, one.stamp.nanosec, one.frame_id) == (
        other.stamp.sec,
        other.stamp.nanosec,
        other.frame_id,
    )


def parts(vector: Any, names: str) -> list[float]:
    return [getattr(vector, name) for name in names]


@pytest.mark.parametrize("generation", GENERATIONS)
@given(frame=NAMES, ranges=st.lists(NUMBERS, max_size=9), intensities=st.lists(NUMBERS, max_size=3), x=NUMBERS)
def test_a_scan_is_read_as_the_library_reads_it(
    generation: str, frame: str, ranges: list[float], intensities: list[float], x: float
) -> None:
    """Whatever the frame is called, and however many beams and intensities there are."""
    ros = GENERATIONS[generation]
    message = ros.scan(7, frame, ranges=ranges, range_max=x, time_increment=-x)
    message.intensities = np.array(intensities, np.float32)
    found = quick(ros, raw(ros, message), message.__msgtype__)
    assert same_header(found.header, message.header)
    assert found.ranges.tolist() == message.ranges.tolist()
    assert (found.angle_min, found.angle_increment, found.time_increment, found.range_min, found.range_max) == (
        -0.5, 0.5, -x, float(np.float32(0.1)), x,
    )  # fmt: skip


@pytest.mark.parametrize("generation", GENERATIONS)
@given(frame=NAMES, v=st.lists(st.floats(allow_nan=False), min_size=10, max_size=10), absent=st.booleans())
def test_inertial_data_and_poses_are_read_as_the_library_reads_them(
    generation: str, frame: str, v: list[float], absent: bool
) -> None:
    """Every number in its place, and what the covariances deny."""
    ros = GENERATIONS[generation]
    turned = ros.quaternion(*v[6:])
    message = ros.imu(-3, frame, v[:3], v[3:6], turned, absent=["orientation"] if absent else [])
    found = quick(ros, raw(ros, message), message.__msgtype__)
    assert same_header(found.header, message.header)
    assert parts(found.angular_velocity, "xyz") == v[:3]
    assert parts(found.linear_acceleration, "xyz") == v[3:6]
    assert parts(found.orientation, "wxyz") == v[6:]
    assert found.orientation_covariance[0] == -float(absent)
    assert found.angular_velocity_covariance[0] == found.linear_acceleration_covariance[0] == 0.0
    pose = ros.pose_stamped(5, position=v[:3], orientation=turned)
    read = quick(ros, raw(ros, pose), pose.__msgtype__)
    assert same_header(read.header, pose.header)
    assert parts(read.pose.position, "xyz") + parts(read.pose.orientation, "wxyz") == v[:3] + v[6:]


@pytest.mark.parametrize("generation", GENERATIONS)
def test_what_lies_otherwise_is_left_to_the_library(generation: str) -> None:
    """Cut, lengthened and garbled messages, at every length; ROS 2 in the other byte order, or unterminated."""
    ros = GENERATIONS[generation]
    for message in (ros.scan(), ros.imu(), ros.pose_stamped()):
        data = raw(ros, message)
        assert quick(ros, data, message.__msgtype__) is not None
        for end in range(len(data)):
            assert quick(ros, data[:end], message.__msgtype__) is None
        assert quick(ros, data + b"\0", message.__msgtype__) is None
        assert quick(ros, data[:12] + b"\xff" * 4 + data[16:], message.__msgtype__) is None
        if not ros.ros1:
            assert quick(ros, b"\0\0" + data[2:], message.__msgtype__) is None
            end = data.index(b"\0", 16)
            assert quick(ros, data[:end] + b"x" + data[end + 1 :], message.__msgtype__) is None


def test_other_types_have_no_such_reader() -> None:
    """They are the library's alone."""
    assert quick_reader("sensor_msgs/msg/Range", ros1=True) is None


def test_infinite_and_missing_ranges_keep_their_values() -> None:
    """REP-117 has a meaning for each."""
    ros = GENERATIONS["ros2"]
    message = ros.scan(ranges=[math.inf, -math.inf, math.nan])
    np.testing.assert_array_equal(
        quick(ros, raw(ros, message), message.__msgtype__).ranges, [math.inf, -math.inf, math.nan]
    )
