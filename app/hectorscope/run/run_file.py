"""RUN.toml: a run as a value. Its recording by content, its settings and their changes, and what came out of it.

Whoever opens it replays the recording with these settings: the outcome is a function of them. The hash of the
trajectory shows whether it is the same to the byte.
"""

import hashlib
import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hectorscope.common.terminal import printable
from hectorscope.inputs import OptionValue
from hectorscope.run.annotations import Annotations, read_marks
from hectorscope.run.fingerprint import Identity
from hectorscope.run.permalink import LONGEST_NAME, MAP, RECORDING, Permalink
from hectorscope.run.rows import Rows
from hectorscope.run.settings_file import from_tree, to_toml
from slam_core.errors import SlamError

FILE = "RUN.toml"
LARGEST = 2**20  # bytes of one
# Files of earlier versions have surrogates in pairs, which TOML forbids.
_ESCAPE = re.compile(r"\\(?:(?P<pair>ud[89ab][0-9a-f]{2}\\ud[c-f][0-9a-f]{2})|.)")
_RUN_KEYS = {"name": str, "recording": str, "sha256": str, "size": int, "offset_ns": int}
_RESULT_KEYS = {"scans": int, "trajectory_sha256": str}


class RunFileError(SlamError):
    """A kept run cannot be used: the message names the file, and the remedy."""


@dataclass(frozen=True, slots=True)
class RunFile:
    """A run at an instant. recording: its name, for people. sensors: the `SENSOR_OPTIONS` that are stated.

    scans, trajectory_sha256: what it had given by then. figures: other results, for people. annotations: marks
    that a person set.
    """

    link: Permalink
    recording: str
    scans: int
    trajectory_sha256: str
    sensors: Mapping[str, OptionValue] = field(default_factory=dict)
    figures: Mapping[str, float] = field(default_factory=dict)
    annotations: Annotations = field(default_factory=Annotations)


def hash_of(trajectory: Rows) -> str:
    """SHA-256 of the rows of a trajectory."""
    return hashlib.sha256(trajectory.tobytes()).hexdigest()


def write_text(run: RunFile) -> str:
    """The text of the file."""
    link = run.link
    table: dict[str, str | float] = {
        "name": link.name,
        "recording": run.recording,
        "size": link.recording.size,
        "sha256": link.recording.sha256,
        "offset_ns": link.offset_ns,
        **({"map_sha256": link.map_sha256} if link.map_sha256 else {}),
    }
    results: dict[str, str | float] = {
        "scans": run.scans,
        "trajectory_sha256": run.trajectory_sha256,
        **run.figures,
    }
    lines = ["[run]", *_lines(table), "", "[results]", *_lines(results), ""]
    for mark in run.annotations.marks:
        lines += ["[[marks]]", *_lines(mark.to_tree()), ""]
    return "\n".join(lines) + "\n" + to_toml(link.settings, run.sensors)


def _lines(table: Mapping[str, str | float | list[float]]) -> list[str]:
    # JSON writes numbers and printable text just as TOML does, without escapes for characters beyond ASCII
    shown = {key: printable(value) if isinstance(value, str) else value for key, value in table.items()}
    return [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in shown.items()]


def read_run(path: Path) -> RunFile:
    """The run in a file; RunFileError if it is none, or its settings are bad."""
    try:
        with path.open(encoding="utf-8") as file:
            tree = tomllib.loads(_ESCAPE.sub(_joined, file.read(LARGEST)))
        return _run(tree)
    except OSError as error:
        raise RunFileError(
            f"{path.parent.name}/{FILE} cannot be read ({error.strerror}): keep it again"
        ) from error
    except (SlamError, ValueError, RecursionError) as error:
        raise RunFileError(
            f"{path.parent.name}/{FILE} is no run ({error}): correct it, or keep it again"
        ) from error


def _joined(escape: re.Match[str]) -> str:
    """A pair of surrogates as one character; any other escape as it is."""
    return str(json.loads(f'"{escape[0]}"')) if escape["pair"] else escape[0]


def _run(tree: dict[str, Any]) -> RunFile:
    run, results = _table(tree, "run", _RUN_KEYS), _table(tree, "results", _RESULT_KEYS)
    if not RECORDING.fullmatch(f"{run['sha256']}.{run['size']}") or not 0 <= run["offset_ns"] < 2**63:
        raise RunFileError("run.sha256, run.size or run.offset_ns is out of range")
    prior = run.get("map_sha256", "")
    if not (isinstance(prior, str) and MAP.fullmatch(prior)):
        raise RunFileError("run.map_sha256 is no hash")
    marks = read_marks(tree.pop("marks", []))
    settings, sensors = from_tree(tree)
    identity = Identity(run["size"], run["sha256"])
    link = Permalink(identity, run["offset_ns"], settings, printable(run["name"])[:LONGEST_NAME], prior)
    return RunFile(
        link, printable(run["recording"]), results["scans"], results["trajectory_sha256"], sensors, {}, marks
    )


def _table(tree: dict[str, Any], name: str, keys: Mapping[str, type]) -> dict[str, Any]:
    """A table that is taken out of the tree, with the keys that it must have."""
    table = tree.pop(name, None)
    if not isinstance(table, dict):
        raise RunFileError(f"[{name}] is missing")
    for key, kind in keys.items():
        if type(table.get(key)) is not kind:
            raise RunFileError(f"{name}.{key} is missing, or of another kind")
    return table
