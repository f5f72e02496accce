"""Files that a run leaves, at its end or on the way. One file a format; each has `EXPORTER`, an `Exporter`."""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.registry import members
from app.settings import Settings
from app.snapshot import MapImage
from slam_core.given import SavedLevel


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What a run has to tell.

    trajectory: (n, 8) seconds since start_ns, x, y, z, qw, qx, qy, qz. maps: finest level first, cropped to what
    is known; empty without a map. metrics: plain values, as they will stand in metrics.json. levels: every cell of
    the same levels. navigation: (n, 11) the columns of the trajectory and the velocity in the map, a hundred times
    a second.
    """

    start_ns: int
    trajectory: NDArray[np.float64]
    maps: tuple[MapImage, ...]
    settings: Settings
    metrics: Mapping[str, Any]
    levels: tuple[SavedLevel, ...] = ()
    navigation: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 11)))


@dataclass(frozen=True, slots=True)
class Exporter:
    """`write(run, folder)` leaves its files in `folder` (under a temporary name, then renamed).

    `order` sorts the exporters: on a disk that fills up, what comes first is there.
    """

    files: tuple[str, ...]
    write: Callable[[Run, Path], None]
    order: int = 50


def exporters() -> list[Exporter]:
    """Every exporter of this folder, in order."""
    return sorted(members(sys.modules[__name__], "EXPORTER"), key=lambda exporter: exporter.order)
