"""The result MCAP, read back by rosbags and by mcap."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.exceptions import EndOfFile
from mcap.reader import make_reader
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader

from hectorscope.exporters import chosen, result_mcap
from hectorscope.exporters import run as export_run
from hectorscope.inputs import Item
from hectorscope.run.headless import run_headless
from hectorscope.run.map_images import map_images
from hectorscope.run.pipeline import Pipeline
from slam_core.results import StepResult
from tests.engines import START
from tests.integration.test_export import SCANS, exported, killed
from tests.sources import MemoryRecording

TYPES = {
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/trajectory": "nav_msgs/msg/Path",
    "/poseupdate": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}


@pytest.fixture(scope="module")
def run(drive: list[Item]) -> tuple[Pipeline, list[StepResult]]:
    """The same run without files, and its results."""
    results: list[StepResult] = []
    pipeline, _ = run_headless(MemoryRecording(drive), START, observe=lambda _, result: results.append(result))
    return pipeline, results


@pytest.fixture(scope="module")
def written(drive: list[Item], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a whole run."""
    folder = tmp_path_factory.mktemp("mcap")
    exported(drive, folder, "mcap")
    assert [path.name for path in folder.iterdir()] == ["result.mcap"]
    return folder / "result.mcap"


@pytest.fixture(scope="module")
def read(written: Path) -> dict[str, list[Any]]:
    """Every message by its topic, decoded by rosbags with the definitions of the file."""
    found: dict[str, list[Any]] = {topic: [] for topic in TYPES}
    with AnyReader([written]) as reader:
        assert {connection.topic: connection.msgtype for connection in reader.connections} == TYPES
        for connection, time_ns, content in reader.messages():
            message = reader.deserialize(content, connection.msgtype)
            found[connection.topic].append(message)
            stamp = message.transforms[0].header.stamp if connection.topic == "/tf" else message.header.stamp
            assert stamp.sec * 10**9 + stamp.nanosec == time_ns
    return found


def xyz(place: Any) -> list[float]:
    """Of a point or a vector."""
    return [place.x, place.y, place.z]


def wxyz(q: Any) -> list[float]:
    """Of a quaternion."""
    return [q.w, q.x, q.y, q.z]


def test_every_pose_is_in_tf_and_in_poseupdate(read: dict[str, list[Any]], run: tuple[Pipeline, list[StepResult]]):
    """To the last bit, with the covariance of the fusion and of the filter beside it."""
    pipeline, results = run
    poses = [message.pose.pose for message in read["/poseupdate"]]
    np.testing.assert_array_equal(
        [xyz(p.position) + wxyz(p.orientation) for p in poses], pipeline.trajectory[:, 1:]
    )
    frames = [(m.transforms[0].header.frame_id, m.transforms[0].child_frame_id) for m in read["/tf"]]
    assert set(frames) == {("map", "base_link")}
    moved = [message.transforms[0].transform for message in read["/tf"]]
    np.testing.assert_array_equal(
        [xyz(t.translation) + wxyz(t.rotation) for t in moved], pipeline.trajectory[:, 1:]
    )
    for message, result in zip(read["/poseupdate"], results, strict=True):
        P = message.pose.covariance.reshape(6, 6)
        np.testing.assert_array_equal(P[np.ix_([0, 1, 5], [0, 1, 5])], result.fused.covariance)
        assert result.navigation is not None
        np.testing.assert_array_equal(np.diag(P)[2:5], np.diag(result.navigation.covariance)[[5, 0, 1]])
        assert np.linalg.eigvalsh(P).min() > 0.0


def test_the_last_map_is_that_of_the_run(read: dict[str, list[Any]], run: tuple[Pipeline, list[StepResult]]):
    """Its cells, where it lies, and the size of a cell."""
    image = map_images(run[0].slam.map)[0]
    grid = read["/map"][-1]
    assert (grid.info.height, grid.info.width) == image.cells.shape
    assert grid.info.resolution == pytest.approx(image.resolution)
    assert xyz(grid.info.origin.position) == [image.x, image.y, 0.0]
    classes = np.select([grid.data == 0, grid.data == 100], [1, 2], 0).reshape(image.cells.shape)
    np.testing.assert_array_equal(classes, image.cells)


def test_the_last_path_is_the_trajectory(read: dict[str, list[Any]], run: tuple[Pipeline, list[StepResult]]):
    """Place, rotation and time of every pose."""
    pipeline, results = run
    poses = read["/trajectory"][-1].poses
    got = [xyz(p.pose.position) + wxyz(p.pose.orientation) for p in poses]
    np.testing.assert_array_equal(got, pipeline.trajectory[:, 1:])
    stamps = [p.header.stamp.sec * 10**9 + p.header.stamp.nanosec for p in poses]
    np.testing.assert_allclose(stamps, [result.stamp_ns for result in results], atol=256)


def test_diagnostics_come_each_second_with_the_figures(read: dict[str, list[Any]]):
    """The tracking is the first; a key is a figure of the series."""
    first = [message.status[0] for message in read["/diagnostics"]]
    assert 4 <= len(first) <= 8
    assert {(status.name, status.level) for status in first} == {("hectorscope: tracking", 0)}
    values = {pair.key: float(pair.value) for pair in first[-1].values}
    assert 0.0 < values["residual"] < 0.5
    assert values["beams"] == 181


def test_mcap_finds_the_index_and_the_definitions(written: Path, read: dict[str, list[Any]]):
    """ROS 2 definitions, CDR, statistics, and messages by topic through the index."""
    with written.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == sum(map(len, read.values()))
        assert {channel.topic for channel in summary.channels.values()} == set(TYPES)
        assert {channel.message_encoding for channel in summary.channels.values()} == {"cdr"}
        assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
        assert sum(1 for _ in reader.iter_messages(topics=["/map"])) == len(read["/map"])


def rest(path: Path) -> Iterator[tuple[str, int]]:
    """Topic and time of each message that mcap reads until the file breaks off."""
    topics: dict[int, str] = {}
    with path.open("rb") as file:
        try:
            for record in StreamReader(file).records:
                if isinstance(record, Channel):
                    topics[record.id] = record.topic
                elif isinstance(record, Message):
                    yield topics[record.channel_id], record.log_time
        except EndOfFile:
            return


def test_a_killed_run_leaves_what_it_had(tmp_path: Path, run: tuple[Pipeline, list[StepResult]]):
    """Under a name that says so; poses and a map can be read up to the last chunk."""
    killed(tmp_path, "mcap")
    assert [path.name for path in tmp_path.iterdir()] == ["result.unfinished.mcap"]
    found = list(rest(tmp_path / "result.unfinished.mcap"))
    count = Counter(topic for topic, _ in found)
    assert 20 <= count["/poseupdate"] <= SCANS
    assert count["/map"] == 1
    stamps = [time_ns for topic, time_ns in found if topic == "/poseupdate"]
    assert stamps == [result.stamp_ns for result in run[1][: len(stamps)]]


def test_files_beside_the_run_do_not_change_it(drive: list[Item], tmp_path: Path):
    """The trajectory is the same to the byte with and without streams."""
    exported(drive, tmp_path / "with", "mcap,csv,tum")
    exported(drive, tmp_path / "without", "tum")
    with_streams, without = ((tmp_path / name / "trajectory.tum").read_bytes() for name in ("with", "without"))
    assert with_streams == without


def test_a_long_path_is_thinned(
    drive: list[Item], run: tuple[Pipeline, list[StepResult]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """A path has its first pose and at most MOST_POSES, evenly, however long the run is."""
    monkeypatch.setattr(result_mcap, "MOST_POSES", 20)
    exported(drive, tmp_path, "mcap")
    with AnyReader([tmp_path / "result.mcap"]) as reader:
        (connection,) = [each for each in reader.connections if each.topic == "/trajectory"]
        contents = [content for _, _, content in reader.messages([connection])]
        path: Any = reader.deserialize(contents[-1], connection.msgtype)
    places = [xyz(each.pose.position) for each in path.poses]
    step = -(-run[0].scans // 20)
    np.testing.assert_array_equal(places, run[0].trajectory[::step, 1:4])
    assert 10 <= len(places) <= 20


def test_an_interrupted_run_leaves_a_file_with_its_index(drive: list[Item], tmp_path: Path):
    """As by Ctrl-C: under the name that says so, and readable as any other."""
    broken = MemoryRecording(drive, error=KeyboardInterrupt(), fail_at=len(drive) // 2)  # type: ignore[arg-type]
    with pytest.raises(KeyboardInterrupt):
        export_run(broken, START, tmp_path, truth=None, progress=lambda _: None, formats=chosen("mcap"))
    assert [path.name for path in tmp_path.iterdir()] == ["result.unfinished.mcap"]
    with AnyReader([tmp_path / "result.unfinished.mcap"]) as reader:
        assert {connection.topic for connection in reader.connections} == set(TYPES)
        assert reader.message_count > 20
