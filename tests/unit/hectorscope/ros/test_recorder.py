"""The writer of bags."""

import errno
import os
import sqlite3
from pathlib import Path

import pytest
from rosbags import rosbag1, rosbag2
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Reader as Rosbag1Reader
from rosbags.typesys import Stores, get_typestore

from hectorscope.ros.recorder import Recorder, RecorderError


def write_points(bag: Recorder, count: int) -> None:
    for i in range(count):
        point = bag.make("geometry_msgs/msg/Point", x=float(i), y=0.0, z=0.0)
        bag.write("/p", bag.make("geometry_msgs/msg/PointStamped", header=bag.header(i, "map"), point=point), i)


@pytest.mark.parametrize("compress", [True, False])
@pytest.mark.parametrize("name", ["run.bag", "run.mcap", "run"])
def test_what_is_written_can_be_read(tmp_path: Path, name: str, compress: bool) -> None:
    """Each container, packed or not, gives the messages back."""
    with Recorder(tmp_path / "new" / name, compress=compress) as bag:
        write_points(bag, 5)
    with AnyReader([tmp_path / "new" / name], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        read = [(time, reader.deserialize(raw, c.msgtype).point.x) for c, time, raw in reader.messages()]
    assert read == [(i, float(i)) for i in range(5)]
    assert [path.name for path in (tmp_path / "new").iterdir()] == [name]


@pytest.mark.parametrize("name", ["run.bag", "run.mcap", "run"])
def test_a_failure_leaves_nothing(tmp_path: Path, name: str) -> None:
    """Neither the bag nor its temporary files stay when the block ends with an error."""
    with pytest.raises(ZeroDivisionError), Recorder(tmp_path / name) as bag:
        write_points(bag, 5)
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())


def test_tf_static_is_latched(tmp_path: Path) -> None:
    """ROS 1 marks the connection, so that a player hands it to late joiners."""
    with Recorder(tmp_path / "run.bag") as bag:
        bag.write("/tf_static", bag.make("tf2_msgs/msg/TFMessage", transforms=[]), 1)
        write_points(bag, 1)
    with Rosbag1Reader(tmp_path / "run.bag") as reader:
        latching = {c.topic: c.ext.latching for c in reader.connections}
    assert latching == {"/tf_static": 1, "/p": None}


def test_unknown_suffix(tmp_path: Path) -> None:
    """The message names the suffix and the choices."""
    with pytest.raises(RecorderError, match=r"ends in \.zip: give NAME\.bag, NAME\.mcap"):
        Recorder(tmp_path / "run.zip")


def test_a_place_that_cannot_be_written(tmp_path: Path) -> None:
    """The message names the place and the reason: something stands in the way, a name is too long."""
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file" / "run.bag", tmp_path / ("x" * 300), tmp_path / ("x" * 254)):
        with pytest.raises(RecorderError, match="cannot be written"), Recorder(path):
            pass


FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
FULL_DATABASE = sqlite3.OperationalError("database or disk is full")


@pytest.mark.parametrize("step", ["open", "write", "close"])
@pytest.mark.parametrize(("name", "error"), [("run.bag", FULL), ("run.mcap", FULL), ("run", FULL_DATABASE)])
def test_a_full_disk_is_told_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, error: Exception, step: str
) -> None:
    """Wherever it runs full, at the beginning, on the way or at the end: the place, the reason, the remedy."""

    def full(*_: object) -> None:
        raise error

    monkeypatch.setattr(rosbag1.Writer if name == "run.bag" else rosbag2.Writer, step, full)
    words = (
        rf"{name} cannot be written \((database or disk is full|No space left on device)\): choose another place"
    )
    with pytest.raises(RecorderError, match=words), Recorder(tmp_path / name) as bag:
        write_points(bag, 5)
    assert not list(tmp_path.iterdir())
