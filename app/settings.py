"""A configuration and its changes over the recording's time: what a run is a function of."""

from dataclasses import dataclass, field

from slam_core.config import ConfigError, SlamConfig, leaves, needs_restart, with_value

Setting = float | int | bool | str


@dataclass(frozen=True, slots=True)
class Change:
    """One setting takes a value from the first scan at or after `time_ns` on."""

    time_ns: int
    name: str
    value: Setting


@dataclass(frozen=True, slots=True)
class Settings:
    """A start and changes in order of time, as a value: every method returns another one."""

    start: SlamConfig = field(default_factory=SlamConfig)
    changes: tuple[Change, ...] = ()

    def __post_init__(self) -> None:
        """ConfigError for a change that a running map cannot follow, or a bad one."""
        config = self.start
        for change in self.changes:
            changed = with_value(config, change.name, change.value)
            if needs_restart(config, changed):
                raise ConfigError(f"{change.name} cannot change at {change.time_ns} ns: set it from the start")
            config = changed

    def at(self, time_ns: int) -> SlamConfig:
        """The configuration that a scan of this time is processed with."""
        return apply(self.start, [change for change in self.changes if change.time_ns <= time_ns])

    def changed(self, time_ns: int, name: str, value: Setting) -> "Settings":
        """A setting takes a value from `time_ns` on, whatever was planned for it later.

        A setting that needs a new map changes from the start. ConfigError for an unknown name or a bad value.
        """
        now = self.at(time_ns)
        if needs_restart(now, with_value(now, name, value)):
            return Settings(with_value(self.start, name, value), self.changes)
        kept = [c for c in self.changes if c.name != name or c.time_ns < time_ns]
        return Settings(self.start, _in_order([*kept, Change(time_ns, name, value)]))

    def flattened(self, time_ns: int) -> "Settings":
        """The values of this time from the start on; what is planned for later stays."""
        return Settings(self.at(time_ns), tuple(c for c in self.changes if c.time_ns > time_ns))


def apply(config: SlamConfig, changes: list[Change]) -> SlamConfig:
    """`config` after the changes."""
    for change in changes:
        config = with_value(config, change.name, change.value)
    return config


def value_of(config: SlamConfig, name: str) -> Setting:
    """The value of a setting by its dotted name; ConfigError for an unknown one."""
    values: dict[str, Setting] = {leaf.name: leaf.value for leaf in leaves(config)}
    if name not in values:
        raise ConfigError(f"{name!r} is no setting: choose one of {', '.join(values)}")
    return values[name]


def _in_order(changes: list[Change]) -> tuple[Change, ...]:
    return tuple(sorted(changes, key=lambda change: change.time_ns))
