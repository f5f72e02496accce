"""The pyramid: every level as a crisp grid. Each browser lays the levels out by itself (static/levels.js)."""

import numpy as np
import viser

from hectorscope.page import palette_png
from hectorscope.page.scene import Scene
from hectorscope.page.theme import SENT
from hectorscope.page.viser_private import set_png
from hectorscope.run.map_image import MapImage
from hectorscope.session.snapshot import Snapshot

BLOCK = 64  # cells of the finest level: images grow by whole blocks, so that their size seldom changes
SAFETY = 0.1  # metres that the floor lies below the lowest pose
# Unknown has the colour of free: filtering would else draw a fringe around the map.
COLOURS, OPACITIES = (SENT.free, SENT.free, SENT.occupied), (0, 255, 255)


class LevelsView:
    """Images fed with palette PNGs; each level is encoded again only when its cells changed."""

    title = "Maps"
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._root = scene.layer("map", "Maps", on_floor=True).root.name
        self._levels: list[_Level] = []
        self._epoch = 0
        self._rows = 0

    def draw(self, snapshot: Snapshot) -> None:
        """Encode what changed, and show it."""
        maps = snapshot.maps
        self._match_count(len(maps))
        for level, image in zip(self._levels, maps, strict=True):
            level.show(image, snapshot.epoch)
        self._sink(snapshot)

    def _match_count(self, count: int) -> None:
        scene = self._scene.server.scene
        while len(self._levels) < count:
            self._levels.append(_Level(scene, f"{self._root}/level{len(self._levels)}"))
        while len(self._levels) > count:
            self._levels.pop().remove()

    def _sink(self, snapshot: Snapshot) -> None:
        """Keep the floor below everything that was driven, so that it hides nothing."""
        floor = self._scene.floor
        if snapshot.epoch != self._epoch or len(snapshot.trajectory) < self._rows:
            self._epoch, self._rows = snapshot.epoch, 0
            floor.position = (0.0, 0.0, -SAFETY)
        heights = snapshot.trajectory[self._rows :, 3]
        self._rows = len(snapshot.trajectory)
        if len(heights) and heights.min() < floor.position[2] + SAFETY:
            floor.position = (0.0, 0.0, float(heights.min()) - SAFETY)


class _Level:
    """One level's image, below a node that each browser moves."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        blank = np.zeros((1, 1, 4), np.uint8)
        self._place = scene.add_frame(name, show_axes=False)
        self._image = scene.add_image(
            f"{name}/cells", blank, 1.0, 1.0, format="png", cast_shadow=False, receive_shadow=False
        )
        self._drawn: object = None

    def show(self, image: MapImage, epoch: int) -> None:
        """Put the picture in its place, unless it is there."""
        state = (epoch, image.revision, image.cells.shape)
        if state == self._drawn:
            return
        self._drawn = state
        self._image.visible = image.cells.size > 0
        if not self._image.visible:
            return
        cells, x, y = aligned(image)
        rows, cols = (n * image.resolution for n in cells.shape)
        self._image.render_width, self._image.render_height = cols, rows
        set_png(self._image, palette_png.encode(cells, COLOURS, OPACITIES))
        self._image.position = (x + cols / 2, y + rows / 2, 0.0)

    def remove(self) -> None:
        """Take it away."""
        self._image.remove()
        self._place.remove()


def aligned(image: MapImage) -> tuple[np.ndarray, float, float]:
    """The cells with unknown around them up to whole blocks, and the x, y of their lower left corner."""
    block = max(1, BLOCK >> image.level)
    column, row = (round(c / image.resolution) % block for c in (image.x, image.y))
    rows, cols = image.cells.shape
    size = (-(-(row + rows) // block) * block, -(-(column + cols) // block) * block)
    cells = np.zeros(size, np.uint8)
    cells[row : row + rows, column : column + cols] = image.cells
    return cells, image.x - column * image.resolution, image.y - row * image.resolution


VIEW = LevelsView
