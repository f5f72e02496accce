"""foxglove.LaserScan in JSON, as the ROS message that it stands for."""

import json
import math
import struct
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_typestore

from hectorscope.ros.messages import BadMessage
from hectorscope.ros.roles import SCAN

SCHEMA = "foxglove.LaserScan"
MOST_BEAMS = 1 << 20
NEAREST = 0.01  # m: the schema has no limits; 0 is no distance
HOME = {"x": 0.0, "y": 0.0, "z": 0.0}
_store = get_typestore(Stores.ROS2_HUMBLE)


def to_cdr(data: bytes | memoryview) -> bytes:
    """The same scan as sensor_msgs/LaserScan, serialised; BadMessage for what is none."""
    try:
        said = json.loads(bytes(data))
        return _serialised(said)
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError, struct.error) as error:
        raise BadMessage(f"JSON that is no {SCHEMA}") from error


def _serialised(said: Any) -> bytes:
    if _is_moved(said.get("pose") or {}):
        raise BadMessage("scan with a pose of its own in its frame: publish the mount by tf")
    ranges = np.array([math.nan if each is None else each for each in said["ranges"]], np.float32)
    if ranges.ndim != 1 or not 0 < len(ranges) <= MOST_BEAMS:
        raise ValueError("no beams")
    first, last = float(said["start_angle"]), float(said["end_angle"])
    types, stamp = _store.types, said["timestamp"]
    time = types["builtin_interfaces/msg/Time"](sec=int(stamp["sec"]), nanosec=int(stamp["nsec"]))
    message = types[SCAN](
        header=types["std_msgs/msg/Header"](stamp=time, frame_id=str(said["frame_id"])),
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
    return bytes(_store.serialize_cdr(message, SCAN))


def _is_moved(pose: Any) -> bool:
    """Whether the laser is anywhere but at the origin of its frame."""
    at, turn = pose.get("position") or HOME, pose.get("orientation") or HOME
    return any(abs(float(part.get(axis, 0.0))) > 1e-6 for part in (at, turn) for axis in HOME)
