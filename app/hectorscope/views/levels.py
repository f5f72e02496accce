"""The pyramid: every level as a crisp grid with its name, laid out as asked."""

import numpy as np
import viser

from hectorscope.page import palette_png
from hectorscope.page.scene import Scene
from hectorscope.page.theme import Theme
from hectorscope.page.viser_private import set_png
from hectorscope.run.map_images import MapImage
from hectorscope.session.snapshot import Snapshot
from hectorscope.views._levels import Placement, bulk, placements

BLOCK = 64  # cells of the finest level: images grow by whole blocks, so that their size seldom changes
OPAQUE = 255
VEILED_FREE, VEILED_OCCUPIED = 36, 170  # opacity of a level with others below
SAFETY = 0.1  # metres that the floor lies below the lowest pose


class LevelsView:
    """Images fed with palette PNGs; each level is encoded again only when its cells or colours changed."""

    title = "Maps"
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._root = scene.layer("map", "Maps", on_floor=True).root.name
        self._names = scene.layer("names", "Level names", on_floor=True).root.name
        self._levels: list[_Level] = []
        self._epoch = 0
        self._rows = 0

    def draw(self, snapshot: Snapshot) -> None:
        """Encode what changed, then show it all at once."""
        display, maps = self._scene.display, snapshot.maps
        self._match_count(len(maps))
        places = placements(display, maps)
        pngs = [
            level.encoded(image, snapshot.epoch, place, display.theme)
            for level, image, place in zip(self._levels, maps, places, strict=True)
        ]
        with self._scene.server.atomic():
            for level, image, place, png in zip(self._levels, maps, places, pngs, strict=True):
                level.show(image, place, png)
            self._sink(snapshot)

    def _match_count(self, count: int) -> None:
        scene = self._scene.server.scene
        while len(self._levels) < count:
            self._levels.append(_Level(scene, self._root, self._names, len(self._levels)))
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
    """One level's image and label."""

    def __init__(self, scene: viser.SceneApi, root: str, names: str, index: int) -> None:
        blank = np.zeros((1, 1, 4), np.uint8)
        self._image = scene.add_image(
            f"{root}/level{index}", blank, 1.0, 1.0, format="png", cast_shadow=False, receive_shadow=False
        )
        self._label = scene.add_label(
            f"{names}/level{index}", "", anchor="bottom-left", font_screen_scale=0.9, visible=False
        )
        self._index = index
        self._drawn: object = None
        self._corner = (0.0, 0.0)

    def encoded(self, image: MapImage, epoch: int, place: Placement, theme: Theme) -> bytes | None:
        """The PNG to send; None when the one there is right."""
        state = (epoch, image.revision, image.cells.shape, place.veiled, theme.dark)
        if state == self._drawn or not image.cells.size:
            return None
        self._drawn = state
        low, high = bulk(image)
        self._corner = (float(low[0]), float(high[1]))
        free, occupied = (VEILED_FREE, VEILED_OCCUPIED) if place.veiled else (OPAQUE, OPAQUE)
        cells, _, _ = aligned(image)
        # Unknown has the colour of free: filtering would else draw a fringe around the map.
        return palette_png.encode(cells, (theme.free, theme.free, theme.occupied), (0, free, occupied))

    def show(self, image: MapImage, place: Placement, png: bytes | None) -> None:
        """Put picture and label in their place."""
        self._image.visible = self._label.visible = place.shown and image.cells.size > 0
        cells, x, y = aligned(image)
        rows, cols = (n * image.resolution for n in cells.shape)
        if png is not None:
            self._image.render_width, self._image.render_height = cols, rows
            set_png(self._image, png)
        self._image.position = (x + cols / 2 + place.x, y + rows / 2, place.z)
        self._label.text = f"level {self._index}: {100 * image.resolution:g} cm"
        self._label.position = (self._corner[0] + place.x, self._corner[1], place.z)

    def remove(self) -> None:
        """Take both away."""
        self._image.remove()
        self._label.remove()


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
