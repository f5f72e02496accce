"""From one configuration to another."""

from dataclasses import replace
from typing import Any

from slam_core.config.leaves import ConfigError, leaves
from slam_core.config.tree import SlamConfig


def with_value(config: SlamConfig, name: str, value: Any) -> SlamConfig:
    """A copy of `config` with one setting changed; ConfigError for an unknown name or a bad value."""
    found = next((leaf for leaf in leaves(config) if leaf.name == name), None)
    if found is None:
        raise ConfigError(
            f"{name!r} is no setting: choose one of {', '.join(leaf.name for leaf in leaves(config))}"
        )
    group, key = name.split(".")
    return replace(config, **{group: replace(getattr(config, group), **{key: found.check(value)})})


def needs_restart(old: SlamConfig, new: SlamConfig) -> bool:
    """Whether the change from `old` to `new` touches a setting that only a rebuilt map can follow."""
    pairs = zip(leaves(old), leaves(new), strict=True)
    return any(a.param.restart and a.value != b.value for a, b in pairs)
