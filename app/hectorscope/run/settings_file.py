"""Settings as a TOML file: one table a group, `[sensors]` where something is stated of them, and `[[changes]]`."""

import json
import math
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from hectorscope.common.numbers import as_float, is_time_ns
from hectorscope.inputs import SENSOR_OPTIONS, OptionValue, SourceOptions
from hectorscope.run.settings import Change, Settings
from slam_core.config import ConfigError, Leaf, SlamConfig, leaves, with_values

_CHANGES, _SENSORS = "changes", "sensors"
_CHANGE_KEYS = {"time_ns": (int,), "name": (str,), "value": (bool, int, float, str)}

# Settings that had another name in files of version 0.1: both are read.
RENAMED = {
    "map.doubt_interval": "map.clear_interval",
    "map.patience": "map.keyframe_max_delay",
    "matcher.blind_share": "matcher.degeneracy_threshold",
    "matcher.second_start": "matcher.prior_restart_sigmas",
    "motion.refinements": "motion.deskew_refinements",
    "navigation.gate_patience": "navigation.gate_reset_time",
    "tracking.go_on": "tracking.continue_from_prediction",
    "tracking.max_surprise": "tracking.unaided_mahalanobis_limit",
    "tracking.min_fit": "tracking.min_inlier_ratio",
    "tracking.min_place": "tracking.relocalise_min_inlier_ratio",
    "tracking.search_interval": "tracking.relocalise_interval",
}
# Settings of version 0.1 without which no trajectory is worse: entries of old files that are passed over.
REMOVED = {
    "aiding.compass_tolerance",
    "matcher.coarse_beams",
    "matcher.max_yaw_step",
    "matcher.weak_observability_threshold",
    "matcher.weak_share",
    "motion.observed_only",
    "motion.odometry_gate",
    "tracking.mahalanobis_limit",
    "tracking.max_sigmas",
}


class SettingsError(ConfigError):
    """A settings file cannot be used: the message names the file, the entry and the remedy."""


def to_toml(settings: Settings, sensors: Mapping[str, OptionValue] = MappingProxyType({})) -> str:
    """Every setting, grouped, with its unit and range beside it; sensors: the `SENSOR_OPTIONS` that are stated."""
    lines: list[str] = []
    group = ""
    for leaf in leaves(settings.start):
        table, key = leaf.name.split(".")
        if table != group:
            lines += ["", f"[{table}]"]
            group = table
        lines.append(f"{key} = {_literal(leaf.value)}{_remark(leaf)}")
    if sensors:
        lines += ["", f"[{_SENSORS}]", *(f"{name} = {_literal(value)}" for name, value in sensors.items())]
    for change in settings.changes:
        lines += ["", f"[[{_CHANGES}]]", f"time_ns = {change.time_ns}"]
        lines += [f"name = {_literal(change.name)}", f"value = {_literal(change.value)}"]
    return "\n".join(lines[1:]) + "\n"


def _literal(value: OptionValue) -> str:
    # JSON writes numbers, true, false and plain words just as TOML does
    return json.dumps(value)


def _remark(leaf: Leaf) -> str:
    if leaf.choices:
        return f"  # {' | '.join(leaf.choices)}"
    if leaf.param.low is None or leaf.param.high is None:
        return ""
    return f"  # {leaf.param.low:g} to {leaf.param.high:g} {leaf.param.unit}".rstrip()


def read_toml(path: Path, base: SlamConfig | None = None) -> Settings:
    """The settings of a file; what it does not name is as in `base` (the defaults). SettingsError if it is bad."""
    return read_file(path, base)[0]


def read_file(path: Path, base: SlamConfig | None = None) -> tuple[Settings, dict[str, OptionValue]]:
    """As `read_toml`, with what the file states of the sensors, by the names of `SENSOR_OPTIONS`."""
    try:
        return from_tree(tomllib.loads(path.read_text(encoding="utf-8")), base)
    except OSError as error:
        raise SettingsError(f"{path} cannot be read ({error.strerror}): give an existing TOML file") from error
    except (ValueError, RecursionError) as error:  # also numbers of thousands of digits, tables without end
        raise SettingsError(f"{path} is not valid TOML ({error}): correct it there") from error
    except ConfigError as error:
        raise SettingsError(f"{path}: {error}") from error


def from_tree(tree: dict[str, Any], base: SlamConfig | None = None) -> tuple[Settings, dict[str, OptionValue]]:
    """The settings of a parsed file, and what it states of the sensors; ConfigError for bad ones."""
    sensors = sensor_options(tree.pop(_SENSORS, {}))
    return _settings(tree, base or SlamConfig()), sensors


def sensor_options(table: Any) -> dict[str, OptionValue]:
    """What a table states of the sensors, by the names of `SENSOR_OPTIONS`; SettingsError if it is bad."""
    if not isinstance(table, dict):
        raise SettingsError(f"{_SENSORS} is {table!r}: write what is stated of the sensors below [{_SENSORS}]")
    kinds = get_type_hints(SourceOptions)
    values = {name: _as_floats(value) for name, value in table.items()}
    for name, value in values.items():
        if name not in SENSOR_OPTIONS:
            raise SettingsError(f"{_SENSORS}.{name} = {value!r}: there are {', '.join(SENSOR_OPTIONS)}")
        kind, _ = get_args(kinds[name])
        if not _fits(value, kind):
            raise SettingsError(f"{_SENSORS}.{name} = {value!r}: give {_wanted(kind)}, or remove it")
    return values


def _as_floats(value: Any) -> Any:
    """A whole number, and those of a list of numbers, as floats; anything else as it is."""
    if isinstance(value, list) and all(type(part) in {int, float} for part in value):
        return tuple(map(as_float, value))
    return as_float(value) if type(value) is int else value


def _fits(value: Any, kind: Any) -> bool:
    """Whether a value is of a type of `SourceOptions`, and finite."""
    if get_origin(kind) is Literal:
        return value in get_args(kind)
    if get_origin(kind) is tuple:
        return type(value) is tuple and len(value) == len(get_args(kind)) and all(map(math.isfinite, value))
    return type(value) is kind and (kind is not float or math.isfinite(value))


def _wanted(kind: Any) -> str:
    if get_origin(kind) is Literal:
        return " or ".join(get_args(kind))
    if get_origin(kind) is tuple:
        return f"{len(get_args(kind))} finite numbers"
    return {bool: "true or false", float: "a finite number"}.get(kind, "a word")


def _settings(tree: dict[str, Any], base: SlamConfig) -> Settings:
    changes = tree.pop(_CHANGES, [])
    if not isinstance(changes, list):
        raise SettingsError(f"{_CHANGES} is {changes!r}: write each change below [[{_CHANGES}]]")
    changes = [each for each in changes if not (isinstance(each, dict) and each.get("name") in REMOVED)]
    config = with_values(base, dict(_entries(tree)))
    return Settings(config, tuple(sorted(map(_change, changes), key=lambda change: change.time_ns)))


def _entries(tree: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for group, table in tree.items():
        if not isinstance(table, dict):
            raise SettingsError(f"{group} stands outside of a group: put it below one, as in [matcher]")
        for key, value in table.items():
            name = f"{group}.{key}"
            if name not in REMOVED:
                yield RENAMED.get(name, name), value


def _change(entry: Any) -> Change:
    if not isinstance(entry, dict) or entry.keys() != _CHANGE_KEYS.keys():
        raise SettingsError(f"the change {entry!r} is incomplete: give time_ns, name and value")
    for key, kinds in _CHANGE_KEYS.items():
        if type(entry[key]) not in kinds or (key == "time_ns" and not is_time_ns(entry[key])):
            raise SettingsError(
                f"the change {entry!r} has a bad {key}: give nanoseconds of 64 bits, a name and a value"
            )
    return Change(entry["time_ns"], str(RENAMED.get(entry["name"], entry["name"])), entry["value"])
