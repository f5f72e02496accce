"""Hector SLAM as a library: 2D laser scans and inertial data in, map and 6DOF pose out.

    import slam_core as hs

    slam = hs.HectorSlam(hs.SlamConfig())
    for measurement in measurements:  # hs.LaserScan, hs.Imu, ..., in order of arrival
        slam.add(measurement)
    slam.finish()

numpy, numba and the standard library only; no files, threads, clocks or prints. numba is imported when HectorSlam
is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from slam_core.config import ConfigError, SlamConfig, with_value, with_values
from slam_core.diagnostics import Diagnostic
from slam_core.errors import SlamError
from slam_core.measurements import (
    Attitude,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    Imu,
    LaserScan,
    MagneticField,
    Measurement,
    Odometry,
    Transform,
)
from slam_core.results import MatchResult, NavigationState, PlanarGaussian, Poses, Status, StepResult

if TYPE_CHECKING:
    from slam_core.localization.prior_map import PriorMap, saved_levels
    from slam_core.slam import HectorSlam

__all__ = [
    "Attitude",
    "ConfigError",
    "Diagnostic",
    "GpsPosition",
    "GpsVelocity",
    "GroundDistance",
    "HectorSlam",
    "Height",
    "Imu",
    "LaserScan",
    "MagneticField",
    "MatchResult",
    "Measurement",
    "NavigationState",
    "Odometry",
    "PlanarGaussian",
    "Poses",
    "PriorMap",
    "SlamConfig",
    "SlamError",
    "Status",
    "StepResult",
    "Transform",
    "saved_levels",
    "with_value",
    "with_values",
]

_LAZY = {
    "HectorSlam": "slam_core.slam",
    "PriorMap": "slam_core.localization.prior_map",
    "saved_levels": "slam_core.localization.prior_map",
}


def __getattr__(name: str) -> Any:
    """Import what needs numba on first use (PEP 562)."""
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module 'slam_core' has no attribute {name!r}")
