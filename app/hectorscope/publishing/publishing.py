"""Publishes the results of a live run, as the scans come."""

import logging
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from queue import Full, Queue

from hectorscope.inputs import Framed, Source
from hectorscope.publishing import Bus
from hectorscope.results.topics import Message, ResultTopics, base
from hectorscope.run.pipeline import Pipeline
from slam_core import geometry
from slam_core.measurements import Transform
from slam_core.results import StepResult

_logger = logging.getLogger("hectorscope")

MAP_NS = 2_000_000_000  # between two maps, and two paths
MOST_POSES = 1000  # of a path
MOST_WAITING = 256  # messages; beyond, new ones are lost
PATIENCE_S = 5.0  # for what waits at the end


class Publishing:
    """Called by the engine with every result; messages are made and sent on a thread of its own.

    source: knows the frames of the robot, if it is `Framed`.
    """

    def __init__(self, buses: Sequence[Bus], source: Source) -> None:
        self._buses, self._source = buses, source
        self._run: Pipeline | None = None
        self._has_failed = False
        self._waiting: Queue[Message | None] = Queue(MOST_WAITING)
        self._thread = threading.Thread(target=self._send, name="publish", daemon=True)
        self._thread.start()

    def add(self, pipeline: Pipeline, result: StepResult) -> None:
        """Send what the topics have of a scan, soon."""
        if pipeline is not self._run:  # the first run, or a new one
            self._run = pipeline
            self._topics = ResultTopics(MAP_NS, MOST_POSES, self._below, self._wants)
        with self._told():
            for message in self._topics.of(pipeline, result):
                if not self._waiting.full():
                    self._waiting.put(message)

    def close(self) -> None:
        """Send what waits, and end."""
        with suppress(Full):
            self._waiting.put(None, timeout=PATIENCE_S)
            self._thread.join(PATIENCE_S)

    def _send(self) -> None:
        while (message := self._waiting.get()) is not None:
            for bus in self._buses:
                with self._told():
                    bus.publish(message)

    @contextmanager
    def _told(self) -> Iterator[None]:
        """The run goes on, whatever becomes of those who listen."""
        try:
            yield
        except Exception as error:
            if not self._has_failed:
                _logger.warning("the results of a scan were not published: %s", error)
            self._has_failed = True

    def _wants(self, topic: str) -> bool:
        return any(bus.wants(topic) for bus in self._buses)

    def _below(self, result: StepResult) -> tuple[str, Transform] | None:
        """The root of the robot's own frames, such as odom (REP-105): the base has its parent there already.

        The rest of the tree is the robot's: T_map_root = T_map_base T_base_root.
        """
        if not isinstance(self._source, Framed):
            return base(result)
        root, T_root_base = self._source.root(result.stamp_ns)
        return root, geometry.chain(result.T_map_base, geometry.invert(T_root_base))
