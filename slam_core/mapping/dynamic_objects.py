"""Removal of dynamic objects from the map: occupied cells that beams pass are cleared soon, at rest as well."""

from slam_core.config import MapConfig
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float64s
from slam_core.scan.stabilise import StabilisedScan


class DynamicObjectRemoval:
    """Clears with one scan every `clear_interval` seconds."""

    def __init__(self) -> None:
        self._cleared_ns = 0

    def clear(
        self, pyramid: Pyramid, scan: StabilisedScan, pose: Float64s, time_ns: int, config: MapConfig
    ) -> None:
        """Clear what the scan at `pose` (3,) passes, if it is time."""
        interval_ns = round(config.clear_interval * 1e9)
        if interval_ns and not 0 <= time_ns - self._cleared_ns < interval_ns:  # a clock may be set back
            self._cleared_ns = time_ns
            pyramid.clear(scan.points, scan.laser, pose, config)
