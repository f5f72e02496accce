"""From one configuration to another."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from slam_core.config.leaves import Leaves, leaves
from slam_core.config.tree import SlamConfig


def with_value(config: SlamConfig, name: str, value: Any) -> SlamConfig:
    """A copy of `config` with one setting changed; ConfigError for an unknown name or a bad value."""
    return with_values(config, {name: value})


def with_values(config: SlamConfig, values: Mapping[str, Any]) -> SlamConfig:
    """The same with any number of settings, by name."""
    known, groups = Leaves(config), defaultdict[str, dict[str, Any]](dict)
    for name, value in values.items():
        leaf = known[name]
        group, key = name.split(".")
        groups[group][key] = leaf.check(value)
    return replace(config, **{group: replace(getattr(config, group), **keys) for group, keys in groups.items()})


def needs_restart(old: SlamConfig, new: SlamConfig) -> bool:
    """Whether the change from `old` to `new` touches a setting that only a rebuilt map can follow."""
    pairs = zip(leaves(old), leaves(new), strict=True)
    return any(a.param.restart and a.value != b.value for a, b in pairs)
