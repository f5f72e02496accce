"""One setting at a time: what a person needs to know about it, and whether a value fits.

Each leaf of the tree is annotated with a `Param`: what it does, its unit, its range, and whether changing it means
rebuilding the map from the start (`restart`) or simply acting from the next scan.
"""

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from typing import Any, Literal, get_args, get_origin, get_type_hints

from slam_core.errors import SlamError, nearest


class ConfigError(SlamError):
    """A setting is unknown, has the wrong type, or lies outside its range."""


Tier = Literal["first", "basic", "expert"]
"""Who needs a setting: everybody at once; who tunes the method; who looks into one part of it."""


@dataclass(frozen=True, slots=True)
class Param:
    """What a person needs to know about one setting.

    log: asks for a logarithmic slider. title: the name for people, where the last part of the dotted one does not
    tell enough.
    """

    help: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    restart: bool = False
    log: bool = False
    tier: Tier = "expert"
    title: str = ""


@dataclass(frozen=True, slots=True)
class Leaf:
    """One setting: its dotted name ("matcher.sigma"), type, value and description."""

    name: str
    type: Any
    value: Any
    param: Param

    @property
    def choices(self) -> tuple[str, ...]:
        """The words a choice accepts; empty for numbers and switches."""
        return get_args(self.type) if get_origin(self.type) is Literal else ()

    def check(self, value: Any) -> Any:
        """The value, converted without loss; ConfigError if it does not fit."""
        if self.choices:
            if value not in self.choices:
                raise ConfigError(f"{self.name} is {value!r}: choose one of {', '.join(self.choices)}")
            return value
        if self.type is bool:
            if not isinstance(value, bool):
                raise ConfigError(f"{self.name} is {value!r}: give true or false")
            return value
        return self._check_number(value)

    def rebuilds(self, value: Any) -> bool:
        """Whether this value in the place of its own needs another map; ConfigError if it does not fit."""
        return bool(self.check(value) != self.value and self.param.restart)

    def _check_number(self, value: Any) -> float:
        if isinstance(value, int) and abs(value) > sys.float_info.max:
            value = math.inf if value > 0 else -math.inf  # what no float holds, and no message should
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ConfigError(f"{self.name} is {value!r}: give a finite number")
        if self.type is int and value != int(value):
            raise ConfigError(f"{self.name} is {value!r}: give a whole number")
        low, high = self.param.low, self.param.high
        if (low is not None and value < low) or (high is not None and value > high):
            raise ConfigError(f"{self.name} is {value:g}{_space(self.param.unit)}: give {low:g} to {high:g}")
        return int(value) if self.type is int else float(value)


def _space(unit: str) -> str:
    return f" {unit}" if unit else ""


def leaves(config: Any, prefix: str = "") -> Iterator[Leaf]:
    """Every setting below `config`, in the order of the tree."""
    group: Any = type(config)
    hints = _hints(group)
    for f in fields(config):
        value = getattr(config, f.name)
        if is_dataclass(value):
            yield from leaves(value, f"{prefix}{f.name}.")
        else:
            kind, param = get_args(hints[f.name])
            yield Leaf(f"{prefix}{f.name}", kind, value, param)


class Leaves(dict[str, Leaf]):
    """The settings of a configuration by name; ConfigError for one that there is not."""

    def __init__(self, config: Any) -> None:
        super().__init__((leaf.name, leaf) for leaf in leaves(config))

    def __missing__(self, name: str) -> Leaf:
        near = nearest(name, self, separator=".")
        groups = dict.fromkeys(known.partition(".")[0] for known in self)
        remedy = f"did you mean {near}?" if near else f"choose one of the groups {', '.join(groups)}"
        raise ConfigError(f"{name} is no setting: {remedy}")


@cache
def _hints(group: type) -> dict[str, Any]:
    """The types in a class with their Params: read once, as that takes longer than all else here."""
    return get_type_hints(group, include_extras=True)
