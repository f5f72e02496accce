"""The whole run at one moment: what the engine publishes for views and panels.

Immutable values. The arrays are views of append-only buffers: safe to keep, never to write.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hectorscope.inputs import Finding, SourceReport
from hectorscope.run.inspection import View
from hectorscope.run.map_images import MapImage
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.settings import Mode
from hectorscope.session.downloads import Download
from slam_core.config import SlamConfig
from slam_core.results import StepResult

PlaybackState = Literal["loading", "playing", "paused", "seeking", "ended", "waiting", "failed"]


@dataclass(frozen=True, slots=True)
class PlaybackStatus:
    """Where the run is. Times are of the recording; a live stream has no end (end_ns None).

    preparing: what the run waits for until it can go on, empty if for nothing. prepared: the share of it that is
    done, if known.
    """

    state: PlaybackState = "loading"
    live: bool = False
    time_ns: int = 0
    start_ns: int = 0
    end_ns: int | None = None
    speed: float = 1.0
    realtime_factor: float = 0.0
    scan_rate: float = 0.0
    detail: str = ""
    preparing: str = ""
    prepared: float | None = None


@dataclass(frozen=True, slots=True)
class LogEntry:
    """A line for the page's log, at a time of the recording, when so many scans had given a result.

    answer: whether it answers what somebody asked for by hand, who may have no eye on the log.
    """

    time_ns: int
    text: str
    level: Literal["info", "warning", "error"] = "info"
    scans: int = 0
    answer: bool = False


@dataclass(frozen=True, slots=True)
class Question:
    """Something would be lost: nothing happens until a person agrees. agree, decline: the words of the buttons."""

    number: int
    text: str
    agree: str
    decline: str


@dataclass(frozen=True, slots=True)
class UndoOffer:
    """What can be taken back, until a time of `time.monotonic`, in seconds."""

    what: str
    expires: float


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """The whole run at one moment, for whoever draws it.

    epoch: grows at every restart or backward seek; a view that sees it change forgets what it drew.
    trajectory: (n, 8) stamp in seconds since the start, x, y, z, qw, qx, qy, qz of T_map_base, one row a scan.
    navigation: (n, 11) the same columns and the velocity in the map, a hundred times a second.
    truth: the columns of the trajectory. truth_in_map: (4,) x, y, z, yaw that carry truth into the map frame
    (first pose on first pose). series: structured (n,) of SERIES_DTYPE, one row a scan. maps: finest level first.
    mode: whether the map is new, a prior map that stays as it is, or one that is continued. searching: why the
    robot's place in the map is unknown, empty while it is known. warnings: what is wrong at this moment, with the
    remedies. unused: what was not used of inertial data and aids as it came, by reason.
    saves: whether there is a folder for Save. obeyed: how many commands were carried out, held back or refused.
    question: what waits for an answer. undo: what can be taken back. views: what each browser that looks closer
    sees of its beam or cell, by the number of the browser; None if that is not there now. examined: what is wrong
    with the recording as a whole; None until somebody had it examined. downloads: the latest archive of
    each browser.
    """

    sequence: int = 0
    epoch: int = 0
    source: str = ""
    playback: PlaybackStatus = PlaybackStatus()
    config: SlamConfig = field(default_factory=SlamConfig)
    result: StepResult | None = None
    trajectory: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 8)))
    navigation: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 11)))
    truth: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 8)))
    truth_in_map: NDArray[np.float64] = field(default_factory=lambda: np.zeros(4))
    series: NDArray[np.void] = field(default_factory=lambda: np.empty(0, SERIES_DTYPE))
    maps: tuple[MapImage, ...] = ()
    map_updates: int = 0
    scans: int = 0
    report: SourceReport = field(default_factory=SourceReport)
    log: tuple[LogEntry, ...] = ()
    mode: Mode = "map"
    searching: str = ""
    warnings: tuple[str, ...] = ()
    unused: Mapping[str, int] = field(default_factory=dict)
    saves: bool = False
    obeyed: int = 0
    question: Question | None = None
    undo: UndoOffer | None = None
    views: Mapping[int, View | None] = field(default_factory=dict)
    examined: tuple[Finding, ...] | None = None
    downloads: Mapping[int, Download] = field(default_factory=dict)
