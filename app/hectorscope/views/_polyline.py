"""A line that grows: chunks of segments, of which only those that changed are sent again."""

from bisect import bisect_left
from itertools import pairwise

import numpy as np
import viser

from hectorscope.page.theme import Rgb, for_line
from hectorscope.views._corners import Corners
from slam_core.measurements import Float32s, Float64s

CHUNK = 256  # segments a node; even, so that dashes go on across chunks
LARGE = 16 * CHUNK  # of the line's beginning: a browser is slow with hundreds of nodes


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
        self._chunks: list[range] = []  # segments of each node
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
            self._send(unchanged - 1)

    def _through(self, positions: Float64s, same: int) -> list[int]:
        """The rows to draw. Of a path that was known further nothing is looked at again."""
        if same == len(positions) < len(self._positions):
            corners = self._corners.rows
            return [*corners[: bisect_left(corners, same - 1)], same - 1] if same else []
        self._corners.follow(positions, same)
        self._positions = positions
        return self._corners.points.copy()

    def _send(self, unchanged: int) -> None:
        """The chunks that are not within so many segments, which are as before."""
        before, self._chunks = self._chunks, chunks(len(self._points) - 1)
        while len(self._nodes) > len(self._chunks):
            self._nodes.pop().remove()
        for k, chunk in enumerate(self._chunks):
            if k >= len(self._nodes):
                self._nodes.append(self._node(self._segments(chunk)))
            elif chunk != before[k] or chunk.stop > unchanged:
                self._nodes[k].points = self._segments(chunk)

    def _segments(self, chunk: range) -> Float32s:
        rows = self._points[chunk.start : chunk.stop + 1]
        points = self._positions[rows].astype(np.float32)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        return segments[::2] if self._dashed else segments

    def _node(self, segments: Float32s) -> viser.LineSegmentsHandle:
        name = f"{self._root}/chunk{len(self._nodes)}"
        return self._scene.add_line_segments(
            name, segments, self._colour, thickness=self._pixels, thickness_units="screen"
        )


def chunks(segments: int) -> list[range]:
    """All of a line: large ones, and small ones at its end, where it changes."""
    small = max(0, segments) // LARGE * LARGE
    starts = (*range(0, small, LARGE), *range(small, segments, CHUNK))
    return [range(a, b) for a, b in pairwise((*starts, segments))]


def common_rows(one: Float64s, other: Float64s) -> int:
    """How many rows two arrays begin with in common."""
    count = min(len(one), len(other))
    differing = np.flatnonzero((one[:count] != other[:count]).any(axis=1))
    return int(differing[0]) if len(differing) else count
