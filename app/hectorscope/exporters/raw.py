"""map_raw.pgm and map_raw.yaml: the values of an occupancy grid, for map servers in the mode raw."""

from pathlib import Path

import numpy as np

from hectorscope.exporters import Exporter
from hectorscope.exporters._grid import finest, pgm, write_map
from hectorscope.run.results import Run

UNKNOWN = 255  # -1 of an occupancy grid


def _write(run: Run, folder: Path) -> None:
    grid = finest(run)
    if grid is not None:
        percent = np.rint(100.0 * grid.probability).astype(np.uint8)
        values = np.where(grid.known, percent, np.uint8(UNKNOWN))[::-1]
        write_map(grid, folder / "map_raw.pgm", folder / "map_raw.yaml", pgm(values), "raw")


EXPORTER = Exporter("raw", ("map_raw.pgm", "map_raw.yaml"), _write)
