"""A line that grows: chunks of segments, of which only those that changed are sent again."""

from bisect import bisect_left

import numpy as np
import viser

from hectorscope.page.theme import Rgb, for_line
from hectorscope.views._corners import Corners
from hectorscope.views._thin_lines import model
from slam_core.measurements import Float32s, Float64s

CHUNK = 256  # segments a node; even, so that dashes go on across chunks
WIDE = (
    4 * CHUNK
)  # segments at the end of a line, at least, that are drawn in its width; those before them are thin
THIN = 8 * CHUNK  # segments of a node of thin ones


class Polyline:
    """Draws rows of a growing array as a line below the node `root`; `dashed` leaves out every second segment.

    The beginning of a very long line is thin: a browser without a graphics card is slow with the wide
    lines of an hour. spacing, tolerance: of the points that are drawn, metres, as in `Corners`.
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
        self._thin: list[viser.GlbHandle] = []  # of THIN segments each
        self._nodes: list[viser.LineSegmentsHandle] = []  # behind those, of CHUNK segments
        self._colour = for_line(colour)
        self._positions: Float64s = np.empty((0, 3))  # also those behind what is drawn, after a jump back
        self._corners = Corners(spacing, tolerance)
        self._points: list[int] = []  # rows that are drawn

    def draw(self, positions: Float64s) -> None:
        """Show the line through `positions` (n, 3); the rows up to the first that differs from before stay."""
        same, before = common_rows(self._positions, positions), self._points
        self._points = self._through(positions, same)
        unchanged = next(
            (k for k, (a, b) in enumerate(zip(before, self._points, strict=False)) if a != b or a >= same),
            min(len(before), len(self._points)),
        )
        if not unchanged == len(before) == len(self._points):
            self._send(max(0, unchanged - 1))

    def _through(self, positions: Float64s, same: int) -> list[int]:
        """The rows to draw. Of a path that was known further nothing is looked at again."""
        if same == len(positions) < len(self._positions):
            corners = self._corners.rows
            return [*corners[: bisect_left(corners, same - 1)], same - 1] if same else []
        self._corners.follow(positions, same)
        self._positions = positions
        return self._corners.points.copy()

    def _send(self, unchanged: int) -> None:
        """The nodes that are not within so many segments, which are as before."""
        count = max(0, len(self._points) - 1)
        thin, before = max(0, count - WIDE) // THIN, len(self._thin)
        while len(self._thin) > min(thin, unchanged // THIN):
            self._thin.pop().remove()
        for k in range(len(self._thin), thin):
            self._thin.append(self._thin_node(self._segments(k * THIN, THIN)))
        starts = range(thin * THIN, count, CHUNK)
        while len(self._nodes) > len(starts):
            self._nodes.pop().remove()
        for k, start in enumerate(starts):
            if k >= len(self._nodes):
                self._nodes.append(self._node(self._segments(start, CHUNK)))
            elif thin != before or start + CHUNK > unchanged:
                self._nodes[k].points = self._segments(start, CHUNK)

    def _segments(self, first: int, count: int) -> Float32s:
        rows = self._points[first : first + count + 1]
        points = self._positions[rows].astype(np.float32)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        return segments[::2] if self._dashed else segments

    def _thin_node(self, segments: Float32s) -> viser.GlbHandle:
        name = f"{self._root}/thin{len(self._thin)}"
        return self._scene.add_glb(name, model(segments, self._colour), cast_shadow=False, receive_shadow=False)

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
