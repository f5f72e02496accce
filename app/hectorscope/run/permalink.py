"""A view as text for the end of an address: recording, run, time and settings; opening it restores the view.

The text is that of a query: r is the recording, t the time in it in seconds, n the name of the run, m the prior
map by its hash, p the preset, s a setting that differs from it, c one that is changed at a time. Whoever reads it
does not trust it.
"""

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from urllib.parse import parse_qsl, urlencode

from hectorscope.common.terminal import printable
from hectorscope.run.fingerprint import Identity
from hectorscope.run.settings import Change, Setting, Settings, value_of
from slam_core.config import PRESETS, ConfigError, nearest_preset, preset, with_values
from slam_core.errors import SlamError

LONGEST = 1000  # characters of a link, the camera not counted
LONGEST_NAME = 60  # characters of a run's name
SECOND = 1_000_000_000
ONCE = ("r", "t", "n", "m", "p")
RECORDING = re.compile(r"([0-9a-f]{64})\.([0-9]{1,18})")
MAP = re.compile(r"[0-9a-f]{64}|")
TIME = re.compile(r"([0-9]{1,9})(?:\.([0-9]{1,9}))?")
CHANGE_AT = re.compile(r"-?[0-9]{1,19}")


class PermalinkError(SlamError):
    """A link cannot be made, or cannot be followed."""


@dataclass(frozen=True, slots=True)
class Permalink:
    """What a link restores. offset_ns: time since the recording's start, not less than 0. name: of the run.

    map_sha256: as of `fingerprint.map_sha256`; empty for a run that began with an empty map.
    """

    recording: Identity
    offset_ns: int
    settings: Settings
    name: str = ""
    map_sha256: str = ""


def to_text(link: Permalink) -> str:
    """The text for an address; PermalinkError if it would be too long."""
    whole, rest = divmod(link.offset_ns, SECOND)
    start = link.settings.start
    nearest, differing = nearest_preset(start)
    fields = [
        ("r", f"{link.recording.sha256}.{link.recording.size}"),
        ("t", f"{whole}.{rest:09d}".rstrip("0").rstrip(".")),
        *([("n", link.name)] if link.name else []),
        *([("m", link.map_sha256)] if link.map_sha256 else []),
        *([("p", nearest)] if nearest != "default" else []),
        *(("s", f"{name}:{_literal(value_of(start, name))}") for name in differing),
        *(("c", f"{each.time_ns}:{each.name}:{_literal(each.value)}") for each in link.settings.changes),
    ]
    text = urlencode(fields, safe=":")
    if len(text) > LONGEST:
        raise PermalinkError("So many settings differ that no link can hold them: save config.toml instead")
    return text


def from_text(text: str) -> Permalink:
    """What a link asks for, checked as if a hand had set it; PermalinkError for anything else."""
    try:
        return _read(text)
    except ConfigError as error:
        raise PermalinkError(f"This link cannot be followed: {error}") from error
    except (ValueError, RecursionError) as error:
        raise PermalinkError("This link cannot be followed: a part of it is missing or damaged") from error


def _read(text: str) -> Permalink:
    pairs = parse_qsl(text, strict_parsing=True, max_num_fields=100) if len(text) <= LONGEST else []
    fields = dict(pairs)
    if len([key for key, _ in pairs if key in ONCE]) != len(fields.keys() & set(ONCE)):
        raise ValueError("given twice")
    recording, time = RECORDING.fullmatch(fields.get("r", "")), TIME.fullmatch(fields.get("t", "0"))
    base = next((name for name in PRESETS if name == fields.get("p", "default")), None)
    prior = MAP.fullmatch(fields.get("m", ""))
    known = fields.keys() <= {*ONCE, "s", "c"}
    if recording is None or time is None or base is None or prior is None or not known:
        raise ValueError("not understood")
    start = with_values(preset(base), dict(map(_setting, (value for key, value in pairs if key == "s"))))
    changes = _changes(value for key, value in pairs if key == "c")
    offset_ns = int(time[1]) * SECOND + int((time[2] or "").ljust(9, "0"))
    identity = Identity(int(recording[2]), recording[1])
    name = printable(fields.get("n", ""))[:LONGEST_NAME]
    return Permalink(identity, offset_ns, Settings(start, changes), name, prior[0])


def _changes(values: Iterable[str]) -> tuple[Change, ...]:
    found = [_change(value) for value in values]
    if found != sorted(found, key=lambda change: change.time_ns):
        raise ValueError("out of order")
    return tuple(found)


def _change(text: str) -> Change:
    at, _, rest = text.partition(":")
    if not CHANGE_AT.fullmatch(at):
        raise ValueError("no time")
    return Change(int(at), *_setting(rest))


def _setting(text: str) -> tuple[str, Setting]:
    """Name and value; whether there is such a setting, and whether it takes the value, is asked later."""
    name, colon, literal = text.partition(":")
    if not colon:
        raise ValueError("no value")
    try:
        value = json.loads(literal)
    except ValueError:  # a word
        value = literal
    return name, value if isinstance(value, bool | int | float) else literal


def _literal(value: Setting) -> str:
    return value if isinstance(value, str) else json.dumps(value)
