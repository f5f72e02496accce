"""foxglove.LaserScan in JSON or protobuf, as the ROS message that it stands for.

Protobuf, which few streams need, is loaded with the first of them.
"""

import base64
import json
import math
import struct
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from hectorscope.ros.decode import BadDefinition, standard_types
from hectorscope.ros.messages import BadMessage
from hectorscope.ros.roles import SCAN

SCHEMA = "foxglove.LaserScan"
ENCODINGS = ("json", "protobuf")
MOST_BEAMS = 1 << 20
NEAREST = 0.01  # m: the schema has no limits; 0 is no distance
AXES = ("x", "y", "z")
WRONG = (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError, struct.error)

ToCdr = Callable[[bytes | memoryview], bytes]


class _Scan(NamedTuple):
    """offset: the parts of the pose of the laser in its frame that must be 0. ranges: as they came."""

    sec: int
    nanosec: int
    frame: str
    offset: tuple[float, ...]
    first: float
    last: float
    ranges: Any


def to_cdr(encoding: str, schema: str) -> ToCdr:
    """A function that gives a scan as sensor_msgs/LaserScan, serialised, and raises BadMessage for what is none.

    schema: of protobuf, its descriptors in base 64; BadDefinition for one that does not define the scan.
    """
    read = _json if encoding == "json" else _protobuf(schema)

    def convert(data: bytes | memoryview) -> bytes:
        try:
            return _serialised(read(bytes(data)))
        except BadMessage:
            raise
        except WRONG as error:
            raise BadMessage(f"{encoding} that is no {SCHEMA}") from error

    return convert


def _json(data: bytes) -> _Scan:
    said = json.loads(data)
    stamp, pose = said["timestamp"], said.get("pose") or {}
    parts = (pose.get("position") or {}, pose.get("orientation") or {})
    offset = tuple(float(part.get(axis, 0.0)) for part in parts for axis in AXES)
    ranges = [math.nan if each is None else each for each in said["ranges"]]
    return _Scan(
        int(stamp["sec"]),
        int(stamp["nsec"]),
        str(said["frame_id"]),
        offset,
        said["start_angle"],
        said["end_angle"],
        ranges,
    )


def _protobuf(schema: str) -> Callable[[bytes], _Scan]:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory  # noqa: PLC0415
    from google.protobuf.message import DecodeError  # noqa: PLC0415

    pool = descriptor_pool.DescriptorPool()
    try:
        for file in descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(schema)).file:
            pool.Add(file)
        message = message_factory.GetMessageClass(pool.FindMessageTypeByName(SCHEMA))
    except (ValueError, TypeError, KeyError, DecodeError) as error:
        raise BadDefinition(f"its definition does not define {SCHEMA}") from error

    def read(data: bytes) -> _Scan:
        try:
            said: Any = message.FromString(data)
        except DecodeError as error:
            raise ValueError("cut off") from error
        parts = (said.pose.position, said.pose.orientation)
        offset = tuple(float(getattr(part, axis)) for part in parts for axis in AXES)
        stamp = said.timestamp
        return _Scan(
            stamp.seconds, stamp.nanos, said.frame_id, offset, said.start_angle, said.end_angle, said.ranges
        )

    return read


def _serialised(scan: _Scan) -> bytes:
    if not all(abs(part) <= 1e-6 for part in scan.offset):
        raise BadMessage("scan with a pose of its own in its frame: publish the mount by tf")
    ranges = np.array(scan.ranges, np.float32)
    if ranges.ndim != 1 or not 0 < len(ranges) <= MOST_BEAMS:
        raise ValueError("no beams")
    first, last = float(scan.first), float(scan.last)
    store = standard_types("ros2")  # one store for all scans: each makes its serialiser anew
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=scan.sec, nanosec=scan.nanosec)
    message = types[SCAN](
        header=types["std_msgs/msg/Header"](stamp=stamp, frame_id=scan.frame),
        angle_min=first,
        angle_max=last,
        angle_increment=(last - first) / max(1, len(ranges) - 1),
        time_increment=0.0,
        scan_time=0.0,
        range_min=NEAREST,
        range_max=math.inf,
        ranges=ranges,
        intensities=np.empty(0, np.float32),
    )
    return bytes(store.serialize_cdr(message, SCAN))
