"""A configuration and its changes over the recording's time, as a value and as TOML."""

from dataclasses import dataclass, field, replace

from slam_core.config import SlamConfig, with_value

Setting = float | int | bool | str


@dataclass(frozen=True, slots=True)
class Change:
    """One setting takes a value from the first scan at or after `time_ns`."""

    time_ns: int
    name: str
    value: Setting


@dataclass(frozen=True, slots=True)
class Settings:
    """What a run is a pure function of, together with its recording: a start and changes in order of time."""

    start: SlamConfig = field(default_factory=SlamConfig)
    changes: tuple[Change, ...] = ()

    @property
    def current(self) -> SlamConfig:
        """The configuration after every change."""
        config = self.start
        for change in self.changes:
            config = with_value(config, change.name, change.value)
        return config

    def changed(self, time_ns: int, name: str, value: Setting) -> "Settings":
        """One more change, not before the last one; ConfigError for an unknown name or a bad value."""
        with_value(self.current, name, value)
        if self.changes:
            time_ns = max(time_ns, self.changes[-1].time_ns)
        return replace(self, changes=(*self.changes, Change(time_ns, name, value)))

    def rewound(self, time_ns: int) -> "Settings":
        """The history up to `time_ns` as it was; later changes move there, so that the current values stay."""
        kept = tuple(change for change in self.changes if change.time_ns <= time_ns)
        later = {change.name: change.value for change in self.changes if change.time_ns > time_ns}
        moved = tuple(Change(time_ns + 1, name, value) for name, value in later.items())
        return replace(self, changes=kept + moved)
