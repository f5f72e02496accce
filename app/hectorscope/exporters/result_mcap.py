"""result.mcap: map, path, tf, poses with covariance and diagnostics as ROS 2 messages, while the run goes on."""

from collections.abc import Iterable
from pathlib import Path

from mcap.writer import Writer

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import GrowingFile
from hectorscope.results.topics import TOPICS, Message, ResultTopics, definition
from hectorscope.run.pipeline import Pipeline
from slam_core.results import StepResult

NAME = "result.mcap"
CHUNK = 1 << 13  # bytes: a killed process loses as much, some fifteen scans
MAP_NS = 10_000_000_000  # between two maps and paths
MOST_POSES = 5000  # of a path


class ResultStream:
    """An open MCAP in chunks, each of which is on the disk as soon as it is full."""

    def __init__(self, folder: Path) -> None:
        self._file = GrowingFile(folder / NAME)
        self._writer = Writer(self._file, chunk_size=CHUNK)
        self._writer.start(profile="ros2", library="hectorscope")
        self._channels: dict[str, int] = {}
        self._topics = ResultTopics(MAP_NS, MOST_POSES)

    def add(self, pipeline: Pipeline, result: StepResult) -> None:
        """What the topics have of a scan."""
        self._write(self._topics.of(pipeline, result))

    def finish(self, pipeline: Pipeline) -> None:
        """The last map and path, and the index that lets readers seek."""
        self._write(self._topics.overview(pipeline))
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.finish()

    def close(self) -> None:
        """What there is, with its index, if the file is still open."""
        if not self._file.closed:
            self._writer.finish()  # type: ignore[no-untyped-call]
            self._file.close()

    def _write(self, messages: Iterable[Message]) -> None:
        for message in messages:
            topic, stamp_ns = message.topic, message.stamp_ns
            if topic not in self._channels:
                text = definition(topic).encode()
                schema = self._writer.register_schema(TOPICS[topic], "ros2msg", text)
                self._channels[topic] = self._writer.register_channel(topic, "cdr", schema)
            self._writer.add_message(self._channels[topic], stamp_ns, message.content, stamp_ns)


EXPORTER = Exporter("mcap", (NAME,), stream=ResultStream)
