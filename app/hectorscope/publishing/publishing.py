"""Publishes the results of a live run, as the scans come."""

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

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


class Publishing:
    """Called by the engine with every result. source: knows the frames of the robot, if it is `Framed`."""

    def __init__(self, buses: Sequence[Bus], source: Source) -> None:
        self._buses, self._source = buses, source
        self._run: Pipeline | None = None
        self._has_failed = False

    def add(self, pipeline: Pipeline, result: StepResult) -> None:
        """Send what the topics have of a scan."""
        if pipeline is not self._run:  # the first run, or a new one
            self._run = pipeline
            self._topics = ResultTopics(MAP_NS, MOST_POSES, self._below, self._wants)
        messages: list[Message] = []
        with self._told():
            messages = list(self._topics.of(pipeline, result))
        for bus in self._buses:
            with self._told():
                for message in messages:
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
