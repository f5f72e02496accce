"""The surfels of the finest level, which the match settles on: a piece of line a cell."""

import numpy as np
import viser

from hectorscope.page.scene import Scene
from hectorscope.run.map_image import MapImage
from hectorscope.session.snapshot import Snapshot
from slam_core.measurements import Float32s

LIFT = 0.02  # metres over the floor
PIXELS = 2.0


class SurfelsView:
    """Off until somebody asks for it, and nothing is sent until then. What counts little is hardly seen."""

    title = "Surfels"
    rate = 1.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._layer = scene.layer(
            "surfels", "Surfels", colour="accent", on_floor=True, shown=False, on_demand=True
        )
        self._lines: viser.LineSegmentsHandle | None = None
        self._drawn: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Send the lines of a map that changed."""
        display, maps = self._scene.display, snapshot.maps
        if self._layer.key not in display.asked:
            return
        finest = maps[0] if maps else None
        state = (snapshot.epoch, finest and finest.revision)
        if state == self._drawn:
            return
        self._drawn = state
        self._show(*self._encoded(finest))

    def _encoded(self, finest: MapImage | None) -> tuple[Float32s, np.ndarray]:
        """Segments (n, 2, 3), and greys that say how much they count; static/dress.js colours them."""
        if finest is None:
            return np.empty((0, 2, 3), np.float32), np.empty((0, 2, 3), np.uint8)
        from slam_core.mapping.surfels import pieces  # noqa: PLC0415 - needs numba, and few ask for surfels

        ends, counts = pieces(finest.surfels, finest.resolution, finest.x, finest.y)
        segments = np.concatenate([ends, np.full((len(ends), 2, 1), LIFT, np.float32)], axis=2)
        grey = np.rint(255.0 * counts).astype(np.uint8)
        return segments, np.broadcast_to(grey[:, None, None], (len(grey), 2, 3)).copy()

    def _show(self, segments: Float32s, colours: np.ndarray) -> None:
        if self._lines is not None:
            self._lines.visible = len(segments) > 0
        if not len(segments):  # without any there can be no node
            return
        if self._lines is None:
            self._lines = self._scene.server.scene.add_line_segments(
                f"{self._layer.root.name}/lines", segments, colours, thickness=PIXELS, thickness_units="screen"
            )
        else:
            self._lines.points, self._lines.colors = segments, colours


VIEW = SurfelsView
