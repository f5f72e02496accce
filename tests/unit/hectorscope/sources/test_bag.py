"""Recordings: every container, whole."""

import itertools
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter

from hectorscope.cli.opening import demo_bag
from hectorscope.ros.recorder import Recorder
from slam_core.measurements import Imu, LaserScan, TruthPose
from tests.bags import CONTAINERS, TENTH, kinds, messages_for, open_run, small_run
from tests.conftest import ROOT
from tests.ros_messages import SECOND, START, Messages, write_bag


def test_opening_a_recording_does_not_load_the_compiler() -> None:
    """The page is served as soon as the recording is open, and numba takes longer to load than all the rest."""
    script = "import sys, hectorscope.sources.bag, hectorscope.sources.carmen; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=False).returncode == 0


@pytest.mark.parametrize("name", CONTAINERS)
def test_every_container_gives_the_same_run(tmp_path: Path, name: str) -> None:
    """Counts, order, span and the mount, which holds for the first scan though it was recorded last."""
    source = open_run(write_bag(tmp_path / name, small_run(messages_for(name))))
    items = list(source.items())
    assert Counter(type(item) for item in items) == {LaserScan: 50, Imu: 50, TruthPose: 50}
    assert [type(item) for item in items[:3]] == [LaserScan, Imu, TruthPose]
    first = items[0]
    assert isinstance(first, LaserScan)
    np.testing.assert_array_equal(first.T_base_laser.translation, [0.2, 0.0, 0.1])
    assert source.span_ns == (START, START + 50 * TENTH)
    assert source.report.read == {"/scan": 50, "/imu": 50, "/ground_truth": 50, "/tf_static": 1}
    assert not source.report.skipped


@pytest.mark.parametrize("name", CONTAINERS)
def test_every_reading_begins_anew(tmp_path: Path, name: str) -> None:
    """A second call of items, even with the first one under way, gives everything again with new counters."""
    source = open_run(write_bag(tmp_path / name, small_run(messages_for(name))))
    first = source.items()
    begun = list(itertools.islice(first, 7))
    again = [item.stamp_ns for item in source.items()]
    assert len(again) == 150
    assert [item.stamp_ns for item in begun] == again[:7]
    assert source.report.read["/scan"] == 50
    first.close()


def test_close_ends_the_items(tmp_path: Path) -> None:
    """A reader that is told to stop does not go on to the end."""
    source = open_run(write_bag(tmp_path / "run.mcap", small_run(Messages())))
    items = source.items()
    next(items)
    source.close()
    assert len(list(items)) <= 1


def test_a_packed_recording_is_unpacked_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However often it is read; closing it leaves nothing behind, even with a reading under way."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    source = open_run(demo_bag("handheld"))
    for _ in range(2):
        assert len(list(itertools.islice(source.items(), 7))) == 7
    items = source.items()
    next(items)
    assert len(list(tmp_path.iterdir())) == 1
    source.close()
    list(items)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".db3", ".mcap"])
def test_a_folder_without_metadata_is_read_by_its_files(tmp_path: Path, suffix: str) -> None:
    """A recorder that was killed leaves no metadata.yaml; the parts are joined in their order, with a warning.

    A folder among them is no part, whatever its name.
    """
    entries = small_run(Messages())
    folder = tmp_path / "run"
    (folder / f"earlier{suffix}").mkdir(parents=True)
    for number, part in enumerate((entries[:75], entries[75:])):
        name = f"part{number}" + (".mcap" if suffix == ".mcap" else "")
        made = write_bag(tmp_path / name, part)
        storage = made if made.is_file() else next(made.glob("*.db3"))
        shutil.move(storage, folder / f"run_{number + 9}{suffix}")
    source = open_run(folder)
    stamps = [item.stamp_ns for item in source.items()]
    assert len(stamps) == 150
    assert stamps == sorted(stamps)
    assert "metadata.yaml is missing" in source.report.notes[0]


def test_a_bare_file_is_read(tmp_path: Path) -> None:
    """The .db3 out of a rosbag2 folder needs neither the folder nor its metadata."""
    folder = write_bag(tmp_path / "run", small_run(Messages()))
    source = open_run(next(folder.glob("*.db3")))
    assert kinds(source)[LaserScan] == 50
    assert not source.report.notes[0].startswith("run.db3 is cut")


@pytest.mark.parametrize("name", CONTAINERS)
def test_packed_recordings_are_read(tmp_path: Path, name: str) -> None:
    """LZ4 chunks, zstd chunks and zstd files are unpacked on the way."""
    ros = messages_for(name)
    with Recorder(tmp_path / name, compress=True) as recorder:
        for topic, message, time_ns in small_run(ros):
            recorder.write(topic, message, START + time_ns)
    source = open_run(tmp_path / name)
    assert kinds(source) == {LaserScan: 50, Imu: 50, TruthPose: 50}
    assert not any("cut off" in note for note in source.report.notes)


def test_a_bag_without_definitions_is_read(tmp_path: Path) -> None:
    """Older rosbag2 recorders store type names only."""
    database = next(write_bag(tmp_path / "run", small_run(Messages())).glob("*.db3"))
    with sqlite3.connect(database) as connection:
        connection.execute("DELETE FROM message_definitions")
    assert kinds(open_run(database))[LaserScan] == 50


@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_an_mcap_of_another_recorder_is_read(tmp_path: Path, encoding: str) -> None:
    """Files without the ros2 profile, with ROS 1 messages or unordered, are read whole and without a warning."""
    ros = Messages("ros1" if encoding == "ros1" else "ros2")
    serialise = ros.store.serialize_ros1 if ros.ros1 else ros.store.serialize_cdr
    name = "sensor_msgs/LaserScan" if ros.ros1 else "sensor_msgs/msg/LaserScan"
    with (tmp_path / "run.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros1" if ros.ros1 else "")
        schema = writer.register_schema(name, "", b"")
        channel = writer.register_channel("/scan", encoding, schema)
        for i in (1, 0, 2):
            data = bytes(serialise(ros.scan(i), "sensor_msgs/msg/LaserScan"))
            writer.add_message(channel, log_time=START + i, data=data, publish_time=START + i)
        writer.finish()
    source = open_run(tmp_path / "run.mcap")
    assert [item.stamp_ns - START for item in source.items()] == [0, 1, 2]
    assert not any("cut off" in note for note in source.report.notes)


def mcap_of(path: Path, channels: list[tuple[str, str, str, list[Any]]]) -> Path:
    """An .mcap of channels (topic, type, definition, messages); a message every nanosecond, in turn."""
    ros = Messages("ros2")
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros2")
        for topic, msgtype, definition, sent in channels:
            schema = writer.register_schema(msgtype, "ros2msg", definition.encode())
            channel = writer.register_channel(topic, "cdr", schema)
            for i, message in enumerate(sent):
                raw = bytes(ros.store.serialize_cdr(message, message.__msgtype__))
                writer.add_message(channel, log_time=START + i, data=raw, publish_time=START + i)
        writer.finish()
    return path


def test_one_topic_in_two_types_is_routed_by_type(tmp_path: Path) -> None:
    """Each channel plays the part of its type; what another recorder calls the same topic does not end the run."""
    ros = Messages("ros2")
    channels = [
        (
            "/data",
            f"sensor_msgs/msg/{kind}",
            ros.store.generate_msgdef(f"sensor_msgs/msg/{kind}", ros_version=2)[0],
            m,
        )
        for kind, m in (
            ("LaserScan", [ros.scan(i) for i in range(3)]),
            ("Imu", [ros.imu(i, "base_link") for i in range(2)]),
        )
    ]
    source = open_run(mcap_of(tmp_path / "run.mcap", channels))
    assert kinds(source) == {LaserScan: 3, Imu: 2}
    assert not source.report.skipped


def test_a_topic_whose_definition_contradicts_its_type_is_named(tmp_path: Path) -> None:
    """It plays no part, another topic of the type does, and a warning gives the field."""
    ros, name = Messages("ros2"), "sensor_msgs/msg/Imu"
    text = ros.store.generate_msgdef(name, ros_version=2)[0]
    scans = ("/scan", "sensor_msgs/msg/LaserScan", "", [ros.scan(i) for i in range(3)])
    wrong = text.replace("float64 y\n", "string y\n")
    assert wrong != text
    channels = [
        scans,
        ("/a_imu", name, wrong, [ros.imu(i, "base_link") for i in range(9)]),
        ("/imu", name, text, [ros.imu(i, "base_link") for i in range(2)]),
    ]
    source = open_run(mcap_of(tmp_path / "run.mcap", channels))
    assert kinds(source) == {LaserScan: 3, Imu: 2}
    (warning,) = source.report.warnings
    assert warning == (
        "/a_imu is not used: its definition of geometry_msgs/msg/Quaternion has orientation.y of another kind"
    )


def test_the_span_is_in_the_time_of_the_scans(tmp_path: Path) -> None:
    """A recording of a replay has today's receive times and yesterday's stamps: the stamps count."""
    ros = Messages("ros1")
    day = 86400 * SECOND
    entries = [("/scan", ros.scan(i * TENTH), day + i * TENTH) for i in range(5)]
    source = open_run(write_bag(tmp_path / "run.bag", entries))
    assert source.span_ns == (START, START + 4 * TENTH)


# --------------------------------------------------------------------------------------------- damaged
