"""foxglove.LaserScan becomes the ROS message that it stands for."""

import json
import math

import pytest
from rosbags.typesys.store import Typestore

from hectorscope.ros.decode import standard_types
from hectorscope.ros.foxglove_scan import SCAN, to_cdr

ORIGIN = {"position": {"x": 0, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}


def said(nanoseconds: int) -> bytes:
    """One scan of 5 beams over a quarter of a turn, in JSON."""
    scan = {
        "timestamp": {"sec": 7, "nsec": nanoseconds},
        "frame_id": "laser",
        "pose": ORIGIN,
        "start_angle": 0.0,
        "end_angle": math.pi / 2,
        "ranges": [1.0, 2.0, 3.0, 4.0, 5.0],
    }
    return json.dumps(scan).encode()


def test_a_scan_keeps_its_time_angles_and_ranges() -> None:
    """The step is that between two beams: the last of them lies at the end."""
    scan = standard_types("ros2").deserialize_cdr(to_cdr("json", "")(said(5)), SCAN)
    assert (scan.header.stamp.sec, scan.header.stamp.nanosec, scan.header.frame_id) == (7, 5, "laser")
    assert scan.angle_increment == pytest.approx(math.pi / 8)
    assert list(scan.ranges) == [1.0, 2.0, 3.0, 4.0, 5.0]


def test_scans_share_one_serialiser(monkeypatch: pytest.MonkeyPatch) -> None:
    """A store of types makes its serialiser anew, which takes longer than a scan does."""
    convert = to_cdr("json", "")
    convert(said(0))

    def refuse(*_: object) -> None:
        raise AssertionError("one more store of types")

    monkeypatch.setattr(Typestore, "__init__", refuse)
    for nanoseconds in range(1, 4):
        convert(said(nanoseconds))
