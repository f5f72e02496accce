"""What a camera that shows the whole map keeps in view: an invisible box around the bulk of every level shown."""

import numpy as np
import viser

from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot
from hectorscope.views._levels import Bounds, Placement, bulk, placements
from slam_core.measurements import Float64s

MARGIN = 0.5  # metres around it


class FocusView:
    """Boxes below /floor/focus, which nobody sees; the page's script reads them."""

    title = "Focus"
    rate = 2.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        root = f"{scene.floor.name}/focus"
        scene.server.scene.add_frame(root, show_axes=False, visible=False)
        self._root = root
        self._boxes: list[viser.BoxHandle] = []
        self._drawn: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the map, the trajectory and the layout."""
        display, maps = self._scene.display, snapshot.maps
        revisions = tuple((image.revision, image.x, image.y) for image in maps)
        state = (snapshot.epoch, revisions, display.layout, display.gap, display.level)
        if state == self._drawn or not maps or not maps[0].cells.size:
            return
        self._drawn = state
        bounds = around(bulk(maps[0]), snapshot.trajectory[:, 1:3])
        with self._scene.server.atomic():
            self._show(bounds, placements(display, maps))

    def _show(self, bounds: Bounds, places: list[Placement]) -> None:
        while len(self._boxes) < len(places):
            name = f"{self._root}/level{len(self._boxes)}"
            self._boxes.append(self._scene.server.scene.add_box(name, cast_shadow=False, receive_shadow=False))
        (low, high), spare = bounds, len(self._boxes) - len(places)
        size, centre = high - low, (low + high) / 2
        for box, place in zip(self._boxes, [*places, *[Placement(shown=False)] * spare], strict=True):
            box.visible = place.shown
            box.dimensions = (float(size[0]), float(size[1]), 0.0)
            box.position = (float(centre[0]) + place.x, float(centre[1]), place.z)


def around(bounds: Bounds, path: Float64s) -> Bounds:
    """`bounds` grown to hold the path (n, 2) too, with a margin."""
    low, high = bounds
    if len(path):
        low, high = np.minimum(low, path.min(axis=0)), np.maximum(high, path.max(axis=0))
    return low - MARGIN, high + MARGIN


VIEW = FocusView
