"""The whole run at one moment: what the engine publishes for views and panels.

Immutable values. The arrays are views of append-only buffers: safe to keep, never to write.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from hectorscope.inputs import Finding, SourceReport
from hectorscope.run.fingerprint import Identity
from hectorscope.run.map_image import MapImage
from hectorscope.run.readings import View
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.settings import Mode, Settings
from hectorscope.session.station_state import StationState
from hectorscope.steering import DriveState
from slam_core.config import SlamConfig
from slam_core.results import StepResult

if TYPE_CHECKING:  # numba comes with it, and the page is served before
    from hectorscope.session.other_scans import OtherScans
    from hectorscope.session.rework import Rework

PlaybackState = Literal["empty", "loading", "playing", "paused", "seeking", "ended", "waiting", "failed"]


@dataclass(frozen=True, slots=True)
class PlaybackStatus:
    """Where the run is. Times are of the recording; a live stream has no end (end_ns None).

    state: "empty" while no recording is open. kept_ns: first and last time that a stream can be shown at; None for
    a recording, or if there is none yet. lag: seconds that an earlier time of a stream is behind it; None if it is
    shown as it is now. seeks: how many have arrived. preparing: what the run waits for until it can go on, empty
    if for nothing. prepared: the share of it that is done, if known.
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
    kept_ns: tuple[int, int] | None = None
    lag: float | None = None
    seeks: int = 0
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
class Listed:
    """A recording that can be opened. key: what it is asked for by. group: where it comes from, in words."""

    key: str
    name: str
    group: str


@dataclass(frozen=True, slots=True)
class ListedRun:
    """A run of the session. source: the name of its recording. offset_ns: where it was last looked at."""

    number: int
    name: str
    source: str
    offset_ns: int
    settings: Settings


@dataclass(frozen=True, slots=True, eq=False)
class Compared:
    """Another run of the shown recording, at the same time of it or on the way there. whole: whether it is there.

    map: its finest level. map_apart: (n, 2) seconds since the start, and the share of the cells of that level in
    which both differed then. The others as in a `Snapshot`.
    """

    number: int
    name: str
    settings: Settings
    whole: bool
    trajectory: NDArray[np.float64]
    truth_in_map: NDArray[np.float64]
    series: NDArray[np.void]
    map: MapImage | None
    map_apart: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))


@dataclass(frozen=True, slots=True)
class UndoOffer:
    """What can be taken back, until a time of `time.monotonic`, in seconds."""

    what: str
    expires: float


@dataclass(frozen=True, slots=True, eq=False)
class Ahead:
    """What is known of a run, which may be more than is shown of it.

    lineage: another one once what was known is no longer true, as after a change of settings. time_ns: of the last
    scan that is known. whole: whether no more will come. series: as in a `Snapshot`, up to there. settings: with
    their changes. warned: as in a `Pipeline`.
    """

    lineage: tuple[int, int] = (0, 0)
    time_ns: int = 0
    whole: bool = False
    series: NDArray[np.void] = field(default_factory=lambda: np.empty(0, SERIES_DTYPE))
    settings: Settings = field(default_factory=Settings)
    warned: Mapping[str, tuple[int, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Download:
    """An archive for one browser. number: of all that were made."""

    number: int
    name: str
    content: bytes


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
    question: what waits for an answer. undo: what can be taken back. library: what else can be opened.
    recording: by its content, once known; None for a stream. map_sha256: of the prior map, as in a `Permalink`.
    runs, shown_run: those of the session, and the number of the shown one. keeps: whether there is a folder for
    them. compared: the run that it is compared with.
    ahead: of the same run, with what follows.
    views: what each browser that looks closer sees of its beam or cell, by the number of the browser; None if that
    is not there now. examined: what is wrong with the recording as a whole; None until somebody had it examined.
    downloads: the latest archive of each browser. station: what is recorded and written of a stream.
    drive: of a robot that is driven by hand; None for any other source.
    rework: the run before the shown scan, where it may rest there. other_scans: of a recording.
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
    library: tuple[Listed, ...] = ()
    recording: Identity | None = None
    map_sha256: str = ""
    runs: tuple[ListedRun, ...] = ()
    shown_run: int = 0
    keeps: bool = False
    compared: Compared | None = None
    ahead: Ahead = field(default_factory=Ahead)
    views: Mapping[int, View | None] = field(default_factory=dict)
    examined: tuple[Finding, ...] | None = None
    downloads: Mapping[int, Download] = field(default_factory=dict)
    station: StationState = field(default_factory=StationState)
    drive: DriveState | None = None
    rework: "Rework | None" = None
    other_scans: "OtherScans | None" = None
