"""What a run leaves: the value that exporters write."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hectorscope.inputs import SourceReport
from hectorscope.run.annotations import Annotation
from hectorscope.run.map_image import MapImage
from hectorscope.run.series import SERIES_FIELDS
from hectorscope.run.settings import Settings
from slam_core.localization.prior_map import SavedLevel


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """The results of a run.

    trajectory: (n, 8) seconds since start_ns, x, y, z, qw, qx, qy, qz. maps: finest level first, cropped to what
    is known; empty without a map. metrics: plain values, as they will stand in metrics.json. levels: every cell of
    the same levels. report: of the source. navigation: (n, 11) the columns of the trajectory and the velocity in
    the map, a hundred times a second. series: (n, len(SERIES_FIELDS)), a row a result. recording: the file or
    folder that was read, where it is known. annotations: marks that a person set.
    """

    start_ns: int
    trajectory: NDArray[np.float64]
    maps: tuple[MapImage, ...]
    settings: Settings
    metrics: Mapping[str, Any]
    levels: tuple[SavedLevel, ...] = ()
    report: SourceReport = field(default_factory=SourceReport)
    navigation: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 11)))
    series: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, len(SERIES_FIELDS))))
    recording: Path | None = None
    annotations: tuple[Annotation, ...] = ()
