"""map.pgm and map.yaml: the finest level as the map servers of ROS read it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter, _grid
from hectorscope.run.map_image import MapImage
from hectorscope.run.results import Run

# Greys of the classes 0 unknown, 1 free, 2 occupied. Unknown lies a hair above FREE_BELOW, as is the custom.
GREYS = np.array([205, 254, 0], np.uint8)


def pgm(cells: NDArray[np.uint8]) -> bytes:
    """Binary grey image (P5) of classes (rows, columns); its first line is the highest y."""
    return _grid.pgm(GREYS[cells[::-1]])


def description(level: MapImage) -> str:
    """What the image means; the origin is the lower left corner of the image."""
    return _grid.description("map.pgm", "trinary", level.resolution, level.x, level.y).decode()


def _write(run: Run, folder: Path) -> None:
    if run.maps:
        write_whole(folder / "map.pgm", pgm(run.maps[0].cells))
        write_whole(folder / "map.yaml", description(run.maps[0]).encode())


EXPORTER = Exporter("pgm", ("map.pgm", "map.yaml"), _write, order=10, default=True)
