"""map.pgm and map.yaml: the finest level as the map servers of ROS read it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import write_whole
from hectorscope.run.map_images import MapImage
from hectorscope.run.results import Run

# Greys of the classes 0 unknown, 1 free, 2 occupied. A reader takes (255 - grey) / 255 for the probability;
# unknown lies a hair above FREE_BELOW, as is the custom.
GREYS = np.array([205, 254, 0], np.uint8)
OCCUPIED_ABOVE = 0.65
FREE_BELOW = 0.196


def pgm(cells: NDArray[np.uint8]) -> bytes:
    """Binary grey image (P5) of classes (rows, columns); its first line is the highest y."""
    rows, columns = cells.shape
    return f"P5\n{columns} {rows}\n255\n".encode() + GREYS[cells[::-1]].tobytes()


def description(level: MapImage) -> str:
    """What the image means; the origin is the lower left corner of the image."""
    return (
        "image: map.pgm\n"
        "mode: trinary\n"
        f"resolution: {level.resolution!r}\n"
        f"origin: [{level.x!r}, {level.y!r}, 0.0]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_ABOVE}\n"
        f"free_thresh: {FREE_BELOW}\n"
    )


def _write(run: Run, folder: Path) -> None:
    if run.maps:
        write_whole(folder / "map.pgm", pgm(run.maps[0].cells))
        write_whole(folder / "map.yaml", description(run.maps[0]).encode())


EXPORTER = Exporter(("map.pgm", "map.yaml"), _write, order=10)
