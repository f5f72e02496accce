"""A configuration and its changes over the recording's time: what a run is a function of."""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Literal

from slam_core.config import ConfigError, Leaves, SlamConfig, with_values

Mode = Literal["map", "localise", "continue"]
"""Whether the map is new, given and left as it is, or given and going on."""
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
    _made: dict[int, SlamConfig] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """ConfigError for a change that a running map cannot follow, or a bad one."""
        known = Leaves(self.start)
        for change in self.changes:
            if known[change.name].rebuilds(change.value):
                raise ConfigError(f"{change.name} cannot change at {change.time_ns} ns: set it from the start")

    def at(self, time_ns: int) -> SlamConfig:
        """The configuration that a scan of this time is processed with: one object, as long as it is the same."""
        due = bisect_right(self.changes, time_ns, key=attrgetter("time_ns"))
        if due not in self._made:  # of a name, the last change counts
            values = {change.name: change.value for change in self.changes[:due]}
            self._made[due] = with_values(self.start, values)
        return self._made[due]

    def changed(self, time_ns: int, name: str, value: Setting) -> "Settings":
        """`changed_all` with one setting."""
        return self.changed_all(time_ns, {name: value})

    def changed_all(self, time_ns: int | None, values: Mapping[str, Setting]) -> "Settings":
        """Settings take values from `time_ns` on, whatever was planned for them later; None: from the start.

        Those that need a new map change from the start. ConfigError for an unknown name or a bad value.
        """
        known = Leaves(self.start)
        first = {n: value for n, value in values.items() if time_ns is None or known[n].rebuilds(value)}
        kept, new = [c for c in self.changes if c.name not in values], []
        if time_ns is not None:
            later = {n: value for n, value in values.items() if n not in first}
            kept += [c for c in self.changes if c.name in later and c.time_ns < time_ns]
            new = [Change(time_ns, n, value) for n, value in later.items()]
        start = with_values(self.start, first) if first else self.start
        return Settings(start, _in_order([*kept, *new]))


def value_of(config: SlamConfig, name: str) -> Setting:
    """The value of a setting by its dotted name; ConfigError for an unknown one."""
    value: Setting = Leaves(config)[name].value
    return value


def _in_order(changes: list[Change]) -> tuple[Change, ...]:
    return tuple(sorted(changes, key=lambda change: change.time_ns))
