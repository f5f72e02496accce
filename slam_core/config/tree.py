"""One tree of frozen dataclasses: it makes the command line, the sliders, the TOML file and the checks."""

from dataclasses import dataclass, field

from slam_core.config.groups.fusion import FusionConfig
from slam_core.config.groups.map import MapConfig
from slam_core.config.groups.matcher import MatcherConfig
from slam_core.config.groups.navigation import AidingConfig, MotionConfig, NavigationConfig, PlatformConfig
from slam_core.config.groups.scan import ScanConfig
from slam_core.config.groups.tracking import TrackingConfig
from slam_core.config.leaves import leaves


@dataclass(frozen=True, slots=True)
class SlamConfig:
    """All settings of the pipeline."""

    scan: ScanConfig = field(default_factory=ScanConfig)
    map: MapConfig = field(default_factory=MapConfig)
    matcher: MatcherConfig = field(default_factory=MatcherConfig)
    navigation: NavigationConfig = field(default_factory=NavigationConfig)
    aiding: AidingConfig = field(default_factory=AidingConfig)
    platform: PlatformConfig = field(default_factory=PlatformConfig)
    motion: MotionConfig = field(default_factory=MotionConfig)
    fusion: FusionConfig = field(default_factory=FusionConfig)
    tracking: TrackingConfig = field(default_factory=TrackingConfig)

    @classmethod
    def paper(cls) -> "SlamConfig":
        """The method of the paper: every addition of the defaults switched off (`presets.ADDITIONS`)."""
        from slam_core.config.presets import preset  # noqa: PLC0415  # it is made of this tree

        return preset("paper")

    def __post_init__(self) -> None:
        """Refuse values out of range: ConfigError names the setting, the value and the range."""
        for leaf in leaves(self):
            leaf.check(leaf.value)
