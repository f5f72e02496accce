"""A line that grows: chunks of segments, of which only the last one is sent again."""

import numpy as np
import viser

from hectorscope.page.theme import Rgb, for_line
from slam_core.measurements import Float32s, Float64s

CHUNK = 256  # segments a node


class Polyline:
    """Draws rows of a growing array as a line below the node `root`; `dashed` leaves out every second segment.

    Points closer than `spacing` metres to the last one drawn are left out; the line ends at the newest kept point.
    """

    def __init__(
        self,
        scene: viser.SceneApi,
        root: str,
        colour: Rgb,
        *,
        spacing: float,
        pixels: float,
        dashed: bool = False,
    ) -> None:
        self._scene, self._root = scene, root
        self._spacing, self._pixels, self._dashed = spacing, pixels, dashed
        self._nodes: list[viser.LineSegmentsHandle] = []
        self._colour = for_line(colour)
        self._forget()

    def _forget(self) -> None:
        for node in self._nodes:
            node.remove()
        self._nodes = []
        self._epoch: int | None = None
        self._rows = 0
        self._points: list[Float64s] = []  # of the open chunk, its first one ends the chunk before

    def draw(self, positions: Float64s, epoch: int) -> None:
        """Bring the line up to date with all `positions` (n, 3); another epoch or fewer rows begin a new line."""
        if epoch != self._epoch or len(positions) < self._rows:
            self._forget()
            self._epoch = epoch
        kept = [self._append(position) for position in positions[self._rows :]]
        self._rows = len(positions)
        if any(kept):
            self._send()

    def _append(self, position: Float64s) -> bool:
        """Whether the point was kept."""
        if self._points and np.abs(position - self._points[-1]).max() < self._spacing:
            return False
        self._points.append(position.copy())
        if len(self._points) == CHUNK + 1:
            self._send()
            self._points = [self._points[-1]]
            self._nodes.append(self._node(np.zeros((1, 2, 3), np.float32)))
        return True

    def _send(self) -> None:
        segments = self._segments()
        if not len(segments):
            return
        if not self._nodes:
            self._nodes.append(self._node(segments))
        self._nodes[-1].points = segments

    def _segments(self) -> Float32s:
        points = np.array(self._points, np.float32)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        return segments[::2] if self._dashed else segments

    def _node(self, segments: Float32s) -> viser.LineSegmentsHandle:
        name = f"{self._root}/chunk{len(self._nodes)}"
        return self._scene.add_line_segments(
            name, segments, self._colour, thickness=self._pixels, thickness_units="screen"
        )
