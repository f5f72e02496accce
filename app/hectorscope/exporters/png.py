"""map.png and map_png.yaml: the probabilities of the finest level as shades of grey, unknown cells transparent."""

import io
from pathlib import Path

import numpy as np
from PIL import Image

from hectorscope.exporters import Exporter
from hectorscope.exporters._grid import finest, shades, write_map
from hectorscope.run.results import Run


def _write(run: Run, folder: Path) -> None:
    grid = finest(run)
    if grid is not None:
        opacity = np.where(grid.known[::-1], np.uint8(255), np.uint8(0))
        picture = Image.fromarray(np.stack([shades(grid), opacity], axis=-1))
        content = io.BytesIO()
        picture.save(content, "PNG")
        write_map(grid, folder / "map.png", folder / "map_png.yaml", content.getvalue(), "scale")


EXPORTER = Exporter("png", ("map.png", "map_png.yaml"), _write)
