"""The messages that come by the thousand, read in one go: the frame's name and the beams alone vary in length.

What is read has those attributes of the library's objects that are asked for. Whatever is not as expected is left
to the library.
"""

from collections.abc import Callable
from dataclasses import dataclass
from struct import Struct, error
from typing import Any

import numpy as np

from slam_core.measurements import Float32s

Read = Callable[[bytes | memoryview], Any | None]

# Ahead of the frame's name lie four bytes (ROS 1: a counter; ROS 2: the encapsulation), the stamp, and its length.
_LENGTH, _LENGTH_AT, _NAME_AT = Struct("<I"), 12, 16
_LONGEST_NAME = 255
_LITTLE_ENDIAN = b"\x00\x01"


@dataclass(slots=True, eq=False)
class Stamp:
    """builtin_interfaces/Time, or time in ROS 1."""

    sec: int
    nanosec: int


@dataclass(slots=True, eq=False)
class Header:
    """std_msgs/Header."""

    stamp: Stamp
    frame_id: str


@dataclass(slots=True, eq=False)
class Vector:
    """geometry_msgs/Vector3 or Point."""

    x: float
    y: float
    z: float


@dataclass(slots=True, eq=False)
class Quaternion:
    """geometry_msgs/Quaternion."""

    x: float
    y: float
    z: float
    w: float


@dataclass(slots=True, eq=False)
class Imu:
    """sensor_msgs/Imu; of its covariances the first value, which may mark the rest as absent."""

    header: Header
    orientation: Quaternion
    orientation_covariance: tuple[float]
    angular_velocity: Vector
    angular_velocity_covariance: tuple[float]
    linear_acceleration: Vector
    linear_acceleration_covariance: tuple[float]


@dataclass(slots=True, eq=False)
class Pose:
    """geometry_msgs/Pose."""

    position: Vector
    orientation: Quaternion


@dataclass(slots=True, eq=False)
class PoseStamped:
    """geometry_msgs/PoseStamped."""

    header: Header
    pose: Pose


@dataclass(slots=True, eq=False)
class LaserScan:
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
            if length > _LONGEST_NAME or not (ros1 or _as_expected(raw, length)):
                return None
            if length not in forms:
                forms[length] = _form(length, body, alignment, ros1=ros1)
            form = forms[length]
            return make(form.unpack_from(raw), raw, form.size)
        except (error, IndexError, ValueError):
            return None

    return read


def _as_expected(raw: bytes | memoryview, length: int) -> bool:
    """Whether bytes of ROS 2 have their lowest first, and a name that ends with its length."""
    return raw[:2] == _LITTLE_ENDIAN and length > 0 and raw[_NAME_AT + length - 1] == 0


def _form(length: int, body: str, alignment: int, *, ros1: bool) -> Struct:
    """The layout up to the first sequence, with a name of so many bytes. CDR aligns, ROS 1 does not."""
    if ros1:
        return Struct(f"<4xiI4x{length}s{body}")
    padding = -(_NAME_AT - 4 + length) % alignment  # counted from behind the encapsulation
    return Struct(f"<4xiI4x{length - 1}sx{padding}x{body}")


def _imu(values: tuple[Any, ...], raw: bytes | memoryview, end: int) -> Imu | None:
    if len(raw) != end:
        return None
    sec, nanosec, name, qx, qy, qz, qw, turned, wx, wy, wz, turning, ax, ay, az, pushed = values
    turn, push = Vector(wx, wy, wz), Vector(ax, ay, az)
    header = Header(Stamp(sec, nanosec), name.decode())
    return Imu(header, Quaternion(qx, qy, qz, qw), (turned,), turn, (turning,), push, (pushed,))


def _pose(values: tuple[Any, ...], raw: bytes | memoryview, end: int) -> PoseStamped | None:
    if len(raw) != end:
        return None
    sec, nanosec, name, x, y, z, qx, qy, qz, qw = values
    header = Header(Stamp(sec, nanosec), name.decode())
    return PoseStamped(header, Pose(Vector(x, y, z), Quaternion(qx, qy, qz, qw)))


def _scan(values: tuple[Any, ...], raw: bytes | memoryview, end: int) -> LaserScan | None:
    sec, nanosec, name, first, step, pause, least, most, beams = values
    rest = end + 4 * beams
    if len(raw) != rest + 4 + 4 * _LENGTH.unpack_from(raw, rest)[0]:
        return None
    header = Header(Stamp(sec, nanosec), name.decode())
    return LaserScan(header, first, step, pause, least, most, np.frombuffer(raw, "<f4", beams, end))


# Of each type: what follows the header, its alignment, and what is made of it.
_TYPES: dict[str, tuple[str, int, Callable[..., Any]]] = {
    "sensor_msgs/msg/Imu": ("4dd64x3dd64x3dd64x", 8, _imu),
    "geometry_msgs/msg/PoseStamped": ("7d", 8, _pose),
    "sensor_msgs/msg/LaserScan": ("f4xff4xffI", 4, _scan),
}
