"""All settings of the pipeline: the tree, what is known of each leaf, and changes of it."""

from slam_core.config.changes import needs_restart, with_value, with_values
from slam_core.config.leaves import ConfigError, Leaf, Leaves, Param, leaves
from slam_core.config.presets import ADDITIONS, PRESETS, Addition, preset, preset_values
from slam_core.config.tree import (
    AidingConfig,
    CovarianceMethod,
    FusionConfig,
    FusionMethod,
    MapConfig,
    MatcherConfig,
    MotionConfig,
    NavigationConfig,
    PlatformConfig,
    ScanConfig,
    SlamConfig,
    StartEstimate,
    TrackingConfig,
)

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
    "ScanConfig",
    "SlamConfig",
    "StartEstimate",
    "TrackingConfig",
    "leaves",
    "needs_restart",
    "preset",
    "preset_values",
    "with_value",
    "with_values",
]
