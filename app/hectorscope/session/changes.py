"""A change of settings by hand: what it makes of them, in values and in words, before anything is done."""

from collections.abc import Mapping
from dataclasses import dataclass

from hectorscope.run.settings import Setting, Settings, value_of
from slam_core.config import MapConfig, nearest_preset, needs_restart
from slam_core.localization.prior_map import PriorMap
from slam_core.mapping.pyramid import check_room


@dataclass(frozen=True, slots=True)
class SettingsChange:
    """after: the settings with it. text: for the log. old: what it replaces, by name.

    rebuilds: whether a new map is needed. throughout: whether it acts from the start. by_hand: of several
    settings changed at once, those whose old values are of no preset, so that no click brings them back.
    """

    after: Settings
    text: str
    old: Mapping[str, Setting]
    rebuilds: bool
    throughout: bool
    by_hand: tuple[str, ...]

    @property
    def begins_again(self) -> bool:
        """Whether the run begins again with it."""
        return self.rebuilds or self.throughout


def settings_change(
    before: Settings,
    values: Mapping[str, Setting],
    title: str,
    now_ns: int,
    *,
    throughout: bool,
    prior_map: PriorMap | None,
) -> SettingsChange | None:
    """The change at that time, or from the start; None if it changes nothing. SlamError for what cannot be."""
    after = before.changed_all(None if throughout else now_ns, values)
    if any(name.startswith("map.") for name in values):
        check_map(after.at(now_ns).map, prior_map)
    was, now = before.at(now_ns), after.at(now_ns)
    old = {name: value_of(was, name) for name in values if value_of(was, name) != value_of(now, name)}
    if after == before or not (old or throughout):
        return None
    lines = [f"{name}: {value} → {value_of(now, name)}" for name, value in old.items()]
    text = f"{title}: {len(lines)} settings changed" if title or not lines else lines[0]
    return SettingsChange(
        after=after,
        text=f"{text}, for the whole run" if throughout else text,
        old=old,
        rebuilds=needs_restart(before.start, after.start),
        throughout=throughout,
        by_hand=tuple(name for name in nearest_preset(was)[1] if name in old) if title else (),
    )


def check_map(config: MapConfig, prior_map: PriorMap | None) -> None:
    """Refuse what the next run could not begin with."""
    check_room(config)
    if prior_map:
        prior_map.check(config)
