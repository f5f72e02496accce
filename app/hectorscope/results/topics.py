"""Which result goes to which topic, and how often."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

from hectorscope.results import ros_messages
from hectorscope.run.map_image import MapImage
from hectorscope.run.map_images import level_image
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_FIELDS, series_row
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Transform
from slam_core.results import StepResult

TF, POSE, PATH, MAP, DIAGNOSTICS = "/tf", "/poseupdate", "/trajectory", "/map", "/diagnostics"
TOPICS = {
    TF: "tf2_msgs/msg/TFMessage",
    POSE: "geometry_msgs/msg/PoseWithCovarianceStamped",
    PATH: "nav_msgs/msg/Path",
    MAP: "nav_msgs/msg/OccupancyGrid",
    DIAGNOSTICS: "diagnostic_msgs/msg/DiagnosticArray",
}
LATCHED = {MAP}  # the last one is kept for who comes later
DEPTHS = {TF: 100}  # messages that are kept for a slow reader; of the others, one
DIAGNOSTICS_NS = 1_000_000_000  # the custom of /diagnostics
# The figures of a scan that its diagnostics hold.
FIGURES = ("residual", "iterations", "beams", "unexpected", "weakest_share", "fused_sigma_x", "fused_sigma_y",
           "fused_sigma_yaw", "match_ms", "update_ms")  # fmt: skip
COLUMNS = {name: SERIES_FIELDS.index(name) for name in FIGURES}


@dataclass(frozen=True, eq=False)
class Message:
    """One for a topic, made where it is needed, on any thread. made: gives an object of rosbags."""

    topic: str
    stamp_ns: int
    made: Callable[[], Any]

    @cached_property
    def value(self) -> Any:
        """The object of rosbags."""
        return self.made()

    @cached_property
    def content(self) -> bytes:
        """The same as CDR."""
        return bytes(ros_messages.STORE.serialize_cdr(self.value, TOPICS[self.topic]))


def definition(topic: str) -> str:
    """Of the messages of a topic, as rosbag2 writes it."""
    text, _ = ros_messages.STORE.generate_msgdef(TOPICS[topic], ros_version=2)
    return str(text)


Below = Callable[[StepResult], tuple[str, Transform] | None]
"""The frame that stands below the map in tf, with its T_map_frame; None for none."""


def base(result: StepResult) -> tuple[str, Transform]:
    """The base itself stands below the map."""
    return ros_messages.BASE, result.T_map_base


@dataclass(slots=True)
class ResultTopics:
    """The messages of one run.

    map_ns: between two maps, and two paths. most_poses: of a path; more are left out evenly, as /tf has all.
    below: what /tf places in the map. wants: whether anybody hears a topic; what nobody does is not made.
    """

    map_ns: int
    most_poses: int
    below: Below = base
    wants: Callable[[str], bool] = lambda _: True
    _last: StepResult | None = None
    _image: MapImage | None = None
    _map_due_ns: int = 0
    _diagnostics_due_ns: int = 0

    def of(self, pipeline: Pipeline, result: StepResult) -> Iterator[Message]:
        """Pose and tf of the scan; the others when they are due."""
        stamp_ns = result.stamp_ns
        if placed := self.below(result):
            yield Message(TF, stamp_ns, partial(ros_messages.transforms, stamp_ns, *placed))
        yield Message(POSE, stamp_ns, partial(ros_messages.pose_with_covariance, result))
        changed = self._last is None or self._last.tracking != result.tracking
        if changed or stamp_ns >= self._diagnostics_due_ns:
            self._diagnostics_due_ns = stamp_ns + DIAGNOSTICS_NS
            row = series_row(result, 0.0, pipeline.slam.map.updates)
            figures = {name: row[column] for name, column in COLUMNS.items()}
            made = partial(ros_messages.diagnostics, result, figures, pipeline.warnings())
            yield Message(DIAGNOSTICS, stamp_ns, made)
        self._last = result
        if stamp_ns >= self._map_due_ns:
            self._map_due_ns = stamp_ns + self.map_ns
            yield from self.overview(pipeline)

    def overview(self, pipeline: Pipeline) -> Iterator[Message]:
        """Path and map so far."""
        if self._last is None:
            return
        stamp_ns, start_ns = self._last.stamp_ns, pipeline.start_ns or 0
        if self.wants(PATH):
            trajectory = pipeline.trajectory
            thinned = trajectory[:: 1 + (len(trajectory) - 1) // self.most_poses]
            yield Message(PATH, stamp_ns, partial(ros_messages.path, thinned, start_ns, stamp_ns))
        if self.wants(MAP) and not pipeline.slam.map.empty:
            yield self._map(pipeline.slam.map, stamp_ns)

    def _map(self, pyramid: Pyramid, stamp_ns: int) -> Message:
        """The map; that of the last time where nothing was written since."""
        if self._image is None or self._image.revision != pyramid.updates:
            self._image = level_image(pyramid, 0, pyramid.updates)
        return Message(MAP, stamp_ns, partial(ros_messages.occupancy, self._image, stamp_ns))
