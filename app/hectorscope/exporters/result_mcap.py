"""result.mcap: map, path, tf, poses with covariance and diagnostics as ROS 2 messages, while the run goes on."""

from pathlib import Path
from typing import Any

from mcap.writer import Writer

from hectorscope.exporters import Exporter, _ros_results
from hectorscope.exporters._files import GrowingFile
from hectorscope.run.map_images import level_image
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_FIELDS, series_row
from slam_core.results import StepResult

NAME = "result.mcap"
CHUNK = 1 << 13  # bytes: a killed process loses as much, some fifteen scans
MAP_NS = 10_000_000_000  # between two maps and paths
DIAGNOSTICS_NS = 1_000_000_000  # the custom of /diagnostics
MOST_POSES = 5000  # of a path: more are left out evenly; /tf and /poseupdate have all
# The figures of a scan that its diagnostics hold.
FIGURES = ("residual", "iterations", "beams", "unexpected", "weakest_share", "fused_sigma_x", "fused_sigma_y",
           "fused_sigma_yaw", "match_ms", "update_ms")  # fmt: skip
COLUMNS = {name: SERIES_FIELDS.index(name) for name in FIGURES}


class ResultStream:
    """An open MCAP in chunks, each of which is on the disk as soon as it is full."""

    def __init__(self, folder: Path) -> None:
        self._file = GrowingFile(folder / NAME)
        self._writer = Writer(self._file, chunk_size=CHUNK)
        self._writer.start(profile="ros2", library="hectorscope")
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._map_due_ns = self._diagnostics_due_ns = 0
        self._last: StepResult | None = None

    def add(self, pipeline: Pipeline, result: StepResult) -> None:
        """Pose and tf of the scan; the others when they are due."""
        stamp_ns = result.stamp_ns
        self._write("/tf", _ros_results.transforms(result), stamp_ns)
        self._write("/poseupdate", _ros_results.pose_with_covariance(result), stamp_ns)
        changed = self._last is None or self._last.tracking != result.tracking
        if changed or stamp_ns >= self._diagnostics_due_ns:
            self._diagnostics_due_ns = stamp_ns + DIAGNOSTICS_NS
            row = series_row(result, 0.0, pipeline.slam.map.updates)
            figures = {name: row[column] for name, column in COLUMNS.items()}
            self._write("/diagnostics", _ros_results.diagnostics(result, figures, pipeline.warnings()), stamp_ns)
        self._last = result
        if stamp_ns >= self._map_due_ns:
            self._map_due_ns = stamp_ns + MAP_NS
            self._overview(pipeline, stamp_ns)

    def finish(self, pipeline: Pipeline) -> None:
        """The last map and path, and the index that lets readers seek."""
        if self._last is not None:
            self._overview(pipeline, self._last.stamp_ns)
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.finish()

    def close(self) -> None:
        """What there is, with its index, if the file is still open."""
        if not self._file.closed:
            self._writer.finish()  # type: ignore[no-untyped-call]
            self._file.close()

    def _overview(self, pipeline: Pipeline, stamp_ns: int) -> None:
        trajectory = pipeline.trajectory
        thinned = trajectory[:: 1 + (len(trajectory) - 1) // MOST_POSES]
        self._write("/trajectory", _ros_results.path(thinned, pipeline.start_ns or 0, stamp_ns), stamp_ns)
        if not pipeline.slam.map.empty:
            self._write("/map", _ros_results.occupancy(level_image(pipeline.slam.map, 0), stamp_ns), stamp_ns)

    def _write(self, topic: str, message: Any, stamp_ns: int) -> None:
        msgtype: str = message.__msgtype__
        if topic not in self._channels:
            self._channels[topic] = self._connect(topic, msgtype)
        content = bytes(_ros_results.STORE.serialize_cdr(message, msgtype))
        self._writer.add_message(self._channels[topic], stamp_ns, content, stamp_ns)

    def _connect(self, topic: str, msgtype: str) -> int:
        if msgtype not in self._schemas:
            definition, _ = _ros_results.STORE.generate_msgdef(msgtype, ros_version=2)
            self._schemas[msgtype] = self._writer.register_schema(msgtype, "ros2msg", definition.encode())
        return self._writer.register_channel(topic, "cdr", self._schemas[msgtype])


EXPORTER = Exporter("mcap", (NAME,), stream=ResultStream)
