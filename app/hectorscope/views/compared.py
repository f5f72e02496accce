"""The run that the shown one is compared with: its trajectory and the walls of its map, in one colour."""

import numpy as np
import viser

from hectorscope.page import palette_png
from hectorscope.page.scene import Scene
from hectorscope.page.theme import SENT
from hectorscope.page.viser_private import set_png
from hectorscope.run.map_image import MapImage
from hectorscope.session.snapshot import Compared, Snapshot
from hectorscope.views._polyline import Polyline

ABOVE = 0.02  # metres over the map of the shown run
WHITE = (255, 255, 255)  # static/dress.js gives it the colour of the theme
COLOURS, OPACITIES = (WHITE, WHITE, WHITE), (0, 0, 200)


class ComparedView:
    """Walls over the map that is shown: where both agree, they lie on each other."""

    title = "Compared run"
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        cells = f"{scene.floor.name}/compared_map"
        layer = scene.layer("compared", self.title, colour="compared", more=(cells,))
        self._line = Polyline(
            scene.server.scene, layer.root.name, SENT.compared, spacing=0.03, tolerance=0.005, pixels=2.5
        )
        self._place = scene.server.scene.add_frame(cells, show_axes=False)
        self._image = scene.server.scene.add_image(
            f"{cells}/cells", np.zeros((1, 1, 4), np.uint8), 1.0, 1.0, format="png", visible=False
        )
        self._drawn: tuple[int, float] | None = None
        self._before: Compared | None = None

    def draw(self, snapshot: Snapshot) -> None:
        """Bring both up to date; nothing is left of a comparison that ended."""
        compared = snapshot.compared
        if self._is_another(compared):
            self._drawn = None
        self._before = compared
        rows = np.empty((0, 3)) if compared is None else compared.trajectory[:, 1:4]
        self._line.draw(rows)
        self._draw_map(compared.map if compared else None)

    def _is_another(self, compared: Compared | None) -> bool:
        """Whether what was drawn is no part of it: of another run, or of the same one before it went back."""
        before = self._before
        if before is None or compared is None:
            return before is not compared
        return before.number != compared.number or len(compared.trajectory) < len(before.trajectory)

    def _draw_map(self, image: MapImage | None) -> None:
        there = image is not None and image.cells.size > 0
        if self._image.visible != there:
            self._image.visible = there
        if image is None or not there or (image.revision, image.x) == self._drawn:
            return
        self._drawn = image.revision, image.x
        png = palette_png.encode(image.cells, COLOURS, OPACITIES)
        show(self._image, image, png)


def show(handle: viser.ImageHandle, image: MapImage, png: bytes) -> None:
    """Put the picture in its place."""
    rows, cols = (n * image.resolution for n in image.cells.shape)
    handle.render_width, handle.render_height = cols, rows
    set_png(handle, png)
    handle.position = (image.x + cols / 2, image.y + rows / 2, ABOVE)


VIEW = ComparedView
