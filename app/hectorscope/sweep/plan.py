"""From the command line to specs: recordings times settings, or a list from a TOML file."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from hectorscope.common.paths import absence, exists
from hectorscope.inputs import OptionValue
from hectorscope.sweep.fetch import is_address, listed
from hectorscope.sweep.spec import SENSORS, RunSpec
from hectorscope.sweep.vary import VaryError, fitting
from slam_core.config import SlamConfig, with_values

_RUNS = "runs"
_FILES = ("recording", "truth", "relations")  # of a run in a file, beside its settings


def recordings(names: Iterable[str]) -> list[tuple[str, str]]:
    """Each recording as it was named and as an absolute path or an address, in order, each once.

    An address may have a pattern, as in s3://bucket/*.bag. VaryError for a path without anything.
    """
    found: dict[str, str] = {}
    for name in names:
        for each in listed(name) if is_address(name) else (name,):
            if not is_address(each) and (why := absence(Path(each))):
                raise VaryError(f"{each} {why}: give recordings, as paths or addresses")
            found.setdefault(each if is_address(each) else str(Path(each).resolve()), each)
    return [(name, path) for path, name in found.items()]


def with_setting(base: RunSpec, values: Mapping[str, Any]) -> RunSpec:
    """A spec with other values of settings and sensor options; ConfigError for a bad one."""
    checked = {name: fitting(name, value) for name, value in values.items()}
    settings = {**base.settings, **{n: v for n, v in checked.items() if not n.startswith(SENSORS)}}
    sensors = {n.removeprefix(SENSORS): v for n, v in checked.items() if n.startswith(SENSORS)}
    changes = tuple(change for change in base.changes if change[1] not in checked)
    with_values(SlamConfig(), settings)
    options: Mapping[str, OptionValue] = {**base.options, **sensors}
    return replace(base, settings=settings, options=options, changes=changes)


def product(
    bags: Sequence[tuple[str, str]], settings: Sequence[Mapping[str, Any]], base: RunSpec
) -> list[RunSpec]:
    """Every recording with every setting, recording by recording: a worker then fetches each once."""
    chosen = [with_setting(base, values) for values in settings]
    return [replace(spec, recording=name, path=path) for name, path in bags for spec in chosen]


def from_file(path: Path, bags: Sequence[tuple[str, str]], base: RunSpec) -> tuple[list[RunSpec], list[str]]:
    """The specs of the [[runs]] of a TOML file, and the names that they vary; VaryError or ConfigError.

    A run has `recording`, or is done on each of `bags`, and settings: `matcher.sigma = 0.2`. It may have `truth`,
    as of --truth, and `relations`. Paths are relative to the file.
    """
    try:
        entries = _entries(path)
    except (OSError, ValueError, RecursionError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise VaryError(f"--runs {path} cannot be read ({reason}): give a TOML file with [[runs]]") from error
    specs, names = list[RunSpec](), dict[str, None]()
    for files, values in entries:
        names |= dict.fromkeys(values)
        own = recordings([files["recording"]]) if "recording" in files else bags
        specs += product(own, [values], _with_files(base, files))
    if not specs:
        raise VaryError(f"--runs {path} names no recording: give recordings there or on the command line")
    return specs, list(names)


def _entries(path: Path) -> list[tuple[dict[str, str], dict[str, Any]]]:
    """Of each run; RecursionError for tables without end."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    entries = table.get(_RUNS)
    if table.keys() != {_RUNS} or not isinstance(entries, list) or not entries:
        raise VaryError(f"--runs {path} has no list of runs: write each below [[{_RUNS}]]")
    return [_entry(path, entry) for entry in entries]


def _entry(path: Path, entry: Any) -> tuple[dict[str, str], dict[str, Any]]:
    """The files of one run, and its settings."""
    if not isinstance(entry, dict) or not all(isinstance(entry.get(name, ""), str) for name in _FILES):
        raise VaryError(f"--runs {path} has the run {entry!r}: give a recording and settings below [[{_RUNS}]]")
    files = {name: _beside(path, entry[name]) for name in _FILES if name in entry}
    return files, dict(_flat({name: value for name, value in entry.items() if name not in _FILES}))


def _beside(path: Path, name: str) -> str:
    """A file that another one names; a topic or an address as it is."""
    return name if is_address(name) or not exists(path.parent / name) else str(path.parent / name)


def _with_files(base: RunSpec, files: Mapping[str, str]) -> RunSpec:
    """With the truth and the relations of a run of its own."""
    options = {**base.options, "truth_topic": files["truth"]} if "truth" in files else base.options
    relations = str(Path(files["relations"]).resolve()) if "relations" in files else base.relations
    return replace(base, options=options, relations=relations)


def _flat(tree: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
