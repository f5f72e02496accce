"""What a camera that shows the whole map keeps in view: an invisible box around the bulk of the finest level."""

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot
from hectorscope.views._levels import Bounds, bulk
from slam_core.measurements import Float64s

MARGIN = 0.5  # metres around it


class FocusView:
    """The box /floor/focus/box, which nobody sees; static/levels.js lays the levels out by its size."""

    title = "Focus"
    rate = 2.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        nodes, root = scene.server.scene, f"{scene.floor.name}/focus"
        nodes.add_frame(root, show_axes=False, visible=False)
        self._box = nodes.add_box(f"{root}/box", cast_shadow=False, receive_shadow=False, visible=False)
        self._drawn: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the map and the trajectory."""
        if not snapshot.maps or not snapshot.maps[0].cells.size:
            return
        finest = snapshot.maps[0]
        state = (snapshot.epoch, finest.revision, finest.x, finest.y)
        if state == self._drawn:
            return
        self._drawn = state
        low, high = around(bulk(finest), snapshot.trajectory[:, 1:3])
        size, centre = high - low, (low + high) / 2
        self._box.visible = True
        self._box.dimensions = (float(size[0]), float(size[1]), 0.0)
        self._box.position = (float(centre[0]), float(centre[1]), 0.0)


def around(bounds: Bounds, path: Float64s) -> Bounds:
    """`bounds` grown to hold the path (n, 2) too, with a margin."""
    low, high = bounds
    if len(path):
        low, high = np.minimum(low, path.min(axis=0)), np.maximum(high, path.max(axis=0))
    return low - MARGIN, high + MARGIN


VIEW = FocusView
