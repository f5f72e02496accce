"""What passes between the engine and everybody else: commands one way, snapshots the other.

Both are immutable values. A snapshot's arrays are views of append-only buffers: safe to keep, never to write.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from slam_core.config import SlamConfig
from slam_core.results import StepResult

# ------------------------------------------------------------------------------------------- commands


@dataclass(frozen=True, slots=True)
class Play:
    """Go on from here."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Stop before the next scan."""


@dataclass(frozen=True, slots=True)
class PlayPause:
    """Pause if it runs, else go on: decided where the state is known, not by a drawing that may be late."""


@dataclass(frozen=True, slots=True)
class StepScan:
    """Process exactly one more scan, then pause."""


@dataclass(frozen=True, slots=True)
class SetSpeed:
    """Playback speed, times real time; inf for as fast as it goes."""

    speed: float


@dataclass(frozen=True, slots=True)
class Restart:
    """Begin the recording again with an empty map (a live stream keeps flowing, the map starts anew)."""


@dataclass(frozen=True, slots=True)
class Seek:
    """Go to this time of the recording, by running up to it."""

    time_ns: int


@dataclass(frozen=True, slots=True)
class Configure:
    """Change one setting, by its dotted name; acts from the next scan."""

    name: str
    value: float | int | bool | str


@dataclass(frozen=True, slots=True)
class Save:
    """Leave the results so far in the folder that the program was started with."""


@dataclass(frozen=True, slots=True)
class Quit:
    """End the engine."""


Command = Play | Pause | PlayPause | StepScan | SetSpeed | Restart | Seek | Configure | Save | Quit

# ------------------------------------------------------------------------------------------ snapshots

Mode = Literal["map", "localise", "continue"]
PlaybackState = Literal["loading", "playing", "paused", "seeking", "ended", "waiting", "failed"]


@dataclass(frozen=True, slots=True)
class PlaybackStatus:
    """Where the run is. Times are of the recording; a live stream has no end (end_ns None)."""

    state: PlaybackState = "loading"
    live: bool = False
    time_ns: int = 0
    start_ns: int = 0
    end_ns: int | None = None
    speed: float = 1.0
    realtime_factor: float = 0.0
    scan_rate: float = 0.0
    detail: str = ""


@dataclass(frozen=True, slots=True)
class SourceReport:
    """Counters of a source: nothing is lost in silence.

    skipped: reason (with the topic's name and the remedy) -> how often. dropped: scans given up to keep up with a
    live stream. waiting: why nothing flows at this moment, and the remedy; empty while all is well.
    notes: sentences on what was found or assumed (a mount, a choice among topics, a cut file). warnings: sentences
    on what is wrong, with the remedies.
    """

    read: Mapping[str, int] = field(default_factory=dict)
    skipped: Mapping[str, int] = field(default_factory=dict)
    dropped: int = 0
    waiting: str = ""
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class MapImage:
    """One level as classes, cropped to what is known. Row 0 is the lowest y.

    cells: (rows, cols) uint8, 0 unknown, 1 free, 2 occupied. x, y: map coordinates of the lower left corner of
    cells[0, 0]. revision grows whenever the level changes. surfels: of the same cells as in a GridLevel; no rows
    if the level has none.
    """

    level: int
    resolution: float
    x: float
    y: float
    cells: NDArray[np.uint8]
    revision: int
    surfels: NDArray[np.uint32] = field(default_factory=lambda: np.zeros((0, 0), np.uint32))


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


# One row a scan; the plots and metrics read columns by name. All float64 seconds, metres, radians.
SERIES_FIELDS = (
    "time_s", "x", "y", "z", "roll", "pitch", "yaw",
    "match_sigma_x", "match_sigma_y", "match_sigma_yaw",
    "filter_sigma_x", "filter_sigma_y", "filter_sigma_yaw",
    "fused_sigma_x", "fused_sigma_y", "fused_sigma_yaw",
    "residual", "iterations", "beams", "map_updates", "weakest_sigma", "unexpected", "weakest_share",
    "gyro_bias_x", "gyro_bias_y", "gyro_bias_z", "accel_bias_x", "accel_bias_y", "accel_bias_z",
    "vx", "vy", "vz",
    "stabilise_ms", "match_ms", "update_ms", "filter_ms",
)  # fmt: skip
SERIES_DTYPE = np.dtype([(name, np.float64) for name in SERIES_FIELDS])


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """The whole run at one moment, for whoever draws it.

    epoch: grows at every restart or backward seek; a view that sees it change forgets what it drew.
    trajectory: (n, 8) stamp in seconds since the start, x, y, z, qw, qx, qy, qz of T_map_base, one row a scan.
    navigation: (n, 11) the same columns and the velocity in the map, a hundred times a second.
    truth: the columns of the trajectory. truth_in_map: (4,) x, y, z, yaw that carry truth into the map frame
    (first pose on first pose). series: structured (n,) of SERIES_DTYPE, one row a scan. maps: finest level first.
    mode: whether the map is new, given and left as it is, or given and going on. searching: why the robot's place
    in the map is unknown, empty while it is known. warnings: what is wrong at this moment, with the remedies.
    unused: what was not used of inertial data and aids as it came, by reason.
    saves: whether there is a folder for Save. obeyed: how many commands have been carried out or refused so far.
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
    report: SourceReport = SourceReport()
    log: tuple[LogEntry, ...] = ()
    mode: Mode = "map"
    searching: str = ""
    warnings: tuple[str, ...] = ()
    unused: Mapping[str, int] = field(default_factory=dict)
    saves: bool = False
    obeyed: int = 0
