"""Some beams of some scans of a run, kept for the consistency score of its map."""

import numpy as np

from hectorscope.run.map_image import MapImage
from hectorscope.run.pipeline import Pipeline
from slam_core.evaluation.consistency import consistency
from slam_core.measurements import Float64s
from slam_core.results import StepResult

SCANS = 60  # at least, of a run that has as many; less than twice as many
BEAMS = 45  # of a scan, about


class Sampler:
    """Keeps scans at equal distances over the whole run, whose length is not known before."""

    def __init__(self) -> None:
        self._kept: list[tuple[Float64s, Float64s]] = []
        self._every = 1
        self._seen = 0

    def add(self, _: Pipeline, result: StepResult) -> None:
        """A scan gave a result."""
        if self._seen % self._every == 0:
            self._kept.append((result.planar, _ends(result)))
            if len(self._kept) == 2 * SCANS:
                self._kept, self._every = self._kept[::2], 2 * self._every
        self._seen += 1

    def score(self, image: MapImage | None) -> float:
        """`consistency` of the kept beams with the finished map; 0 without one."""
        if image is None or not self._kept:
            return 0.0
        begins = np.concatenate([np.tile(pose[:2], (len(ends), 1)) for pose, ends in self._kept])
        ends = np.concatenate([ends for _, ends in self._kept])
        return consistency(image.cells == 2, np.array([image.x, image.y]), image.resolution, begins, ends)


def _ends(result: StepResult) -> Float64s:
    """(n, 2) every k-th endpoint, in the map."""
    points = result.points[:: max(1, len(result.points) // BEAMS)].astype(np.float64)
    x, y, yaw = result.planar.tolist()
    cosine, sine = np.cos(yaw), np.sin(yaw)
    ends: Float64s = points @ np.array([[cosine, sine], [-sine, cosine]]) + (x, y)
    return ends
