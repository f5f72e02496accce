"""A line that grows: chunks of segments, of which only those that changed are sent again."""

from math import ceil

import numpy as np
import viser

from hectorscope.page.theme import Rgb, for_line
from hectorscope.views._corners import Corners
from slam_core.measurements import Float32s, Float64s

CHUNK = 256  # segments a node; even, so that dashes go on across chunks


class Polyline:
    """Draws rows of a growing array as a line below the node `root`; `dashed` leaves out every second segment.

    spacing, tolerance: of the points that are drawn, metres, as in `Corners`.
    """

    def __init__(
        self,
        scene: viser.SceneApi,
        root: str,
        colour: Rgb,
        *,
        spacing: float,
        pixels: float,
        tolerance: float = 0.0,
        dashed: bool = False,
    ) -> None:
        self._scene, self._root = scene, root
        self._pixels, self._dashed = pixels, dashed
        self._nodes: list[viser.LineSegmentsHandle] = []
        self._colour = for_line(colour)
        self._positions: Float64s = np.empty((0, 3))
        self._corners = Corners(spacing, tolerance)
        self._points: list[int] = []  # rows that are drawn

    def draw(self, positions: Float64s) -> None:
        """Show the line through `positions` (n, 3); the rows up to the first that differs from before stay."""
        same, before = common_rows(self._positions, positions), self._points
        self._corners.follow(positions, same)
        self._positions, self._points = positions, self._corners.points.copy()
        unchanged = next(
            (k for k, (a, b) in enumerate(zip(before, self._points, strict=False)) if a != b or a >= same),
            min(len(before), len(self._points)),
        )
        if not unchanged == len(before) == len(self._points):
            self._send(max(0, unchanged - 1) // CHUNK)

    def _send(self, first: int) -> None:
        """The chunks from the first one that changed on."""
        count = ceil(max(0, len(self._points) - 1) / CHUNK)
        while len(self._nodes) > count:
            self._nodes.pop().remove()
        for chunk in range(first, count):
            segments = self._segments(chunk)
            if chunk < len(self._nodes):
                self._nodes[chunk].points = segments
            else:
                self._nodes.append(self._node(segments))

    def _segments(self, chunk: int) -> Float32s:
        rows = self._points[chunk * CHUNK : (chunk + 1) * CHUNK + 1]
        points = self._positions[rows].astype(np.float32)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        return segments[::2] if self._dashed else segments

    def _node(self, segments: Float32s) -> viser.LineSegmentsHandle:
        name = f"{self._root}/chunk{len(self._nodes)}"
        return self._scene.add_line_segments(
            name, segments, self._colour, thickness=self._pixels, thickness_units="screen"
        )


def common_rows(one: Float64s, other: Float64s) -> int:
    """How many rows two arrays begin with in common."""
    count = min(len(one), len(other))
    differing = np.flatnonzero((one[:count] != other[:count]).any(axis=1))
    return int(differing[0]) if len(differing) else count
