"""The messages that come by the thousand, read in one go: the frame's name and the beams alone vary in length.

What is read has those attributes of the library's objects that are asked for. Whatever is not as expected is left
to the library.
"""

from collections.abc import Callable
from struct import Struct, error
from typing import Any, NamedTuple

import numpy as np

from slam_core.measurements import Float32s

Read = Callable[[bytes | memoryview], Any | None]

# Ahead of the frame's name lie four bytes (ROS 1: a counter; ROS 2: the encapsulation), the stamp, and its length.
_LENGTH, _LENGTH_AT, _NAME_AT = Struct("<I"), 12, 16
_LONGEST_NAME = 255
_LITTLE_ENDIAN = b"\x00\x01"


class Stamp(NamedTuple):
    """builtin_interfaces/Time, or time in ROS 1."""

    sec: int
    nanosec: int


class Header(NamedTuple):
    """std_msgs/Header."""

    stamp: Stamp
    frame_id: str


class Vector(NamedTuple):
    """geometry_msgs/Vector3 or Point."""

    x: float
    y: float
    z: float


class Quaternion(NamedTuple):
    """geometry_msgs/Quaternion."""

    x: float
    y: float
    z: float
    w: float


class Imu(NamedTuple):
    """sensor_msgs/Imu; of its covariances the first value, which may say that the rest is absent."""

    header: Header
    orientation: Quaternion
    orientation_covariance: tuple[float]
    angular_velocity: Vector
    angular_velocity_covariance: tuple[float]
    linear_acceleration: Vector
    linear_acceleration_covariance: tuple[float]


class Pose(NamedTuple):
    """geometry_msgs/Pose."""

    position: Vector
    orientation: Quaternion


class PoseStamped(NamedTuple):
    """geometry_msgs/PoseStamped."""

    header: Header
    pose: Pose


class LaserScan(NamedTuple):
    """sensor_msgs/LaserScan without its intensities, its last angle and the time between two scans."""

    header: Header
    angle_min: float
    angle_increment: float
    time_increment: float
    range_min: float
    range_max: float
    ranges: Float32s


def quick_reader(msgtype: str, *, ros1: bool) -> Read | None:
    """Reads messages of a type in its standard definition, None where the library should; None for other types."""
    if msgtype not in _TYPES:
        return None
    body, alignment, make = _TYPES[msgtype]
    forms: dict[int, Struct] = {}

    def read(raw: bytes | memoryview) -> Any | None:
        try:
            length = _LENGTH.unpack_from(raw, _LENGTH_AT)[0]
            if length > _LONGEST_NAME or not (ros1 or raw[:2] == _LITTLE_ENDIAN):
                return None
            if length not in forms:
                forms[length] = _form(length, body, alignment, ros1=ros1)
            form = forms[length]
            sec, nanosec, name, *values = form.unpack_from(raw)
            if not ros1:
                if name[-1:] != b"\0":
                    return None
                name = name[:-1]
            return make(Header(Stamp(sec, nanosec), name.decode()), values, raw, form.size)
        except (error, ValueError):
            return None

    return read


def _form(length: int, body: str, alignment: int, *, ros1: bool) -> Struct:
    """The layout up to the first sequence, with a name of so many bytes. CDR aligns, ROS 1 does not."""
    if ros1:
        return Struct(f"<4xiI4x{length}s{body}")
    padding = -(_NAME_AT - 4 + length) % alignment  # counted from behind the encapsulation
    return Struct(f"<4xiI4x{length}s{padding}x{body}")


def _imu(header: Header, v: list[float], raw: bytes | memoryview, end: int) -> Imu | None:
    if len(raw) != end:
        return None
    turn, push = Vector(v[5], v[6], v[7]), Vector(v[9], v[10], v[11])
    return Imu(header, Quaternion(v[0], v[1], v[2], v[3]), (v[4],), turn, (v[8],), push, (v[12],))


def _pose(header: Header, v: list[float], raw: bytes | memoryview, end: int) -> PoseStamped | None:
    if len(raw) != end:
        return None
    return PoseStamped(header, Pose(Vector(v[0], v[1], v[2]), Quaternion(v[3], v[4], v[5], v[6])))


def _scan(header: Header, v: list[Any], raw: bytes | memoryview, end: int) -> LaserScan | None:
    beams = v[5]
    rest = end + 4 * beams
    if len(raw) != rest + 4 + 4 * _LENGTH.unpack_from(raw, rest)[0]:
        return None
    return LaserScan(header, v[0], v[1], v[2], v[3], v[4], np.frombuffer(raw, "<f4", beams, end))


# Of each type: what follows the header, its alignment, and what is made of it.
_TYPES: dict[str, tuple[str, int, Callable[..., Any]]] = {
    "sensor_msgs/msg/Imu": ("4dd64x3dd64x3dd64x", 8, _imu),
    "geometry_msgs/msg/PoseStamped": ("7d", 8, _pose),
    "sensor_msgs/msg/LaserScan": ("f4xff4xffI", 4, _scan),
}
