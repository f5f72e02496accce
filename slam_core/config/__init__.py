"""All settings of the pipeline: the tree, what is known of each leaf, and changes of it."""

from slam_core.config.changes import needs_restart, with_value, with_values
from slam_core.config.groups.fusion import FusionConfig, FusionMethod
from slam_core.config.groups.map import MapConfig
from slam_core.config.groups.matcher import CovarianceMethod, MatcherConfig, StartEstimate
from slam_core.config.groups.navigation import AidingConfig, MotionConfig, NavigationConfig, PlatformConfig
from slam_core.config.groups.scan import ScanConfig
from slam_core.config.groups.tracking import TrackingConfig
from slam_core.config.leaves import ConfigError, Leaf, Leaves, Param, Tier, leaves
from slam_core.config.presets import ADDITIONS, PRESETS, Addition, Preset, differences, nearest_preset, preset
from slam_core.config.tree import SlamConfig

__all__ = [
    "ADDITIONS",
    "PRESETS",
    "Addition",
    "AidingConfig",
    "ConfigError",
    "CovarianceMethod",
    "FusionConfig",
    "FusionMethod",
    "Leaf",
    "Leaves",
    "MapConfig",
    "MatcherConfig",
    "MotionConfig",
    "NavigationConfig",
    "Param",
    "PlatformConfig",
    "Preset",
    "ScanConfig",
    "SlamConfig",
    "StartEstimate",
    "Tier",
    "TrackingConfig",
    "differences",
    "leaves",
    "nearest_preset",
    "needs_restart",
    "preset",
    "with_value",
    "with_values",
]
