"""What goes into a run of a sweep and what comes out of it, as plain values that any executor can carry."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from typing import Any, Literal

from hectorscope.inputs import OptionValue, SourceOptions
from hectorscope.run.settings import Change, Setting, Settings
from slam_core.config import SlamConfig, leaves, with_values

Status = Literal["ok", "lost", "refused", "failed", "timeout", "memory", "crashed"]
"""How a run ended. lost: with figures, but the pose was lost. refused: as `run` refuses the recording. failed: by
an error of the program. The last three: stopped at a limit, or its process died."""
SENSORS = "sensors."  # in front of one of the `SENSOR_OPTIONS` that is varied


@dataclass(frozen=True, slots=True)
class RunSpec:
    """One run. recording: as a person named it. path: where a worker finds it, an absolute path or an address.

    settings: those that differ from the defaults, by name. changes: as of `Settings`. options: what is stated of
    the source. relations: a file of them, or "". share: of the recording's time that is run, from its beginning.
    """

    recording: str
    path: str
    settings: Mapping[str, Setting] = field(default_factory=dict)
    changes: tuple[tuple[int, str, Setting], ...] = ()
    options: Mapping[str, OptionValue] = field(default_factory=dict)
    repair: bool = False
    relations: str = ""
    share: float = 1.0

    @property
    def key(self) -> str:
        """The same for the same run: a hash of everything but the name."""
        return _hash({**asdict(self), "recording": ""})

    @property
    def setting_key(self) -> str:
        """The same for the same settings, whatever the recording and the share."""
        return _hash([self.settings, self.changes, self.options])

    def run_settings(self) -> Settings:
        """As the pipeline takes them; ConfigError for a bad value."""
        return Settings(with_values(SlamConfig(), self.settings), tuple(Change(*each) for each in self.changes))

    def source_options(self) -> SourceOptions:
        """As the sources take them."""
        values: dict[str, Any] = dict(self.options)
        return SourceOptions(**values)

    def value(self, name: str) -> Any:
        """Of a setting, or of a sensor option behind `sensors.`; None if that is not stated."""
        if name.startswith(SENSORS):
            return self.options.get(name.removeprefix(SENSORS))
        return self.settings.get(name, _defaults()[name])

    def as_json(self) -> str:
        """One line."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> "RunSpec":
        """Of `as_json`."""
        values = json.loads(text)
        options = {name: tuple(v) if isinstance(v, list) else v for name, v in values["options"].items()}
        changes = tuple(tuple(each) for each in values["changes"])
        return cls(**{**values, "options": options, "changes": changes})


@dataclass(frozen=True, slots=True)
class RunSummary:
    """What became of a run. reason: why there are no figures, or why the recording was refused.

    figures: by dotted name, as in metrics.json; no times. wall_s: seconds that the run took. memory_mb: resident
    memory of the process after it. worker: host and number of the process. picture: a small PNG of the map in
    base64, "" without one. extent: x0, y0, x1, y1 of the picture in the map, metres. path: [seconds, x, y] of some
    poses.
    """

    status: Status
    reason: str = ""
    figures: Mapping[str, float | str | None] = field(default_factory=dict)
    wall_s: float = 0.0
    memory_mb: float = 0.0
    worker: str = ""
    picture: str = ""
    extent: tuple[float, ...] = ()
    path: tuple[tuple[float, ...], ...] = ()

    def as_json(self) -> str:
        """One line."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> "RunSummary":
        """Of `as_json`."""
        values = json.loads(text)
        paths = {"extent": tuple(values["extent"]), "path": tuple(tuple(pose) for pose in values["path"])}
        return cls(**{**values, **paths})


def differing(config: SlamConfig) -> dict[str, Setting]:
    """The settings in which a configuration differs from the defaults, by name."""
    return {leaf.name: leaf.value for leaf in leaves(config) if leaf.value != _defaults()[leaf.name]}


@cache
def _defaults() -> dict[str, Any]:
    return {leaf.name: leaf.value for leaf in leaves(SlamConfig())}


def _hash(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]
