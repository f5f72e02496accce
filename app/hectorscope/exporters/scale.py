"""map_scale.pgm and map_scale.yaml: the probabilities of the finest level, for map servers in the mode scale.

A PGM has no transparency, by which that mode tells unknown cells: they come back as a half. See `png` for an image
that keeps them apart.
"""

from pathlib import Path

import numpy as np

from hectorscope.exporters import Exporter
from hectorscope.exporters._grid import FREE_BELOW, OCCUPIED_ABOVE, finest, pgm, shades, write_map
from hectorscope.run.results import Run

# Between the thresholds a map server maps the shades to 0 to 100: in the middle lies 50.
UNKNOWN = round(255 * (1.0 - (OCCUPIED_ABOVE + FREE_BELOW) / 2.0))


def _write(run: Run, folder: Path) -> None:
    grid = finest(run)
    if grid is not None:
        grey = np.where(grid.known[::-1], shades(grid), np.uint8(UNKNOWN))
        write_map(grid, folder / "map_scale.pgm", folder / "map_scale.yaml", pgm(grey), "scale")


EXPORTER = Exporter("scale", ("map_scale.pgm", "map_scale.yaml"), _write)
