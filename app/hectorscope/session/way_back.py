"""The way back to the start, sought beside the run, and again as the robot drives on."""

import threading
import time

import numpy as np
from numpy.typing import NDArray

from hectorscope.run.map_images import level_image
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.return_path import return_path

AGAIN_S = 3.0
MOST_CELLS = 1 << 22  # of a larger map a coarser picture is searched


class WayBack:
    """Belongs to the engine's thread. shown: whether it is wanted. path: (n, 2), the last one that was found."""

    def __init__(self) -> None:
        self.shown = False
        self.path: NDArray[np.float64] | None = None
        self._thread: threading.Thread | None = None
        self._begun = 0.0

    def show(self, on: bool) -> None:
        """Show it, or no longer."""
        self.shown, self.path, self._begun = on, None, 0.0

    def follow(self, pipeline: Pipeline) -> None:
        """Search again if it is time, beside the run."""
        idle = self._thread is None or not self._thread.is_alive()
        if self.shown and idle and pipeline.scans and time.monotonic() - self._begun >= AGAIN_S:
            if pipeline.slam.map.empty:
                return
            self._begun = time.monotonic()
            level = level_image(pipeline.slam.map, 0, 0, MOST_CELLS)
            self._thread = threading.Thread(
                target=self._find, args=(level, pipeline.trajectory), name="way back", daemon=True
            )
            self._thread.start()

    def _find(self, *known: object) -> None:
        self.path = return_path(*known)  # type: ignore[arg-type]
