"""An engine that stands still, and snapshots whose picture is known: for tests of the page."""

from dataclasses import replace

import numpy as np

from hectorscope.run.map_image import MapImage
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.session.commands import Command
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import Ahead, PlaybackStatus, Snapshot
from slam_core.geometry import from_euler
from slam_core.measurements import Transform
from slam_core.results import AidingStatus, Durations, MatchResult, NavigationState, PlanarGaussian, StepResult

RESOLUTION = 0.25  # metres a cell of the finest level
LEVELS = 3
AIDING = (
    AidingStatus("height", (5,), 100, innovation=np.array([0.1]), S=np.array([[0.04]]), nis=0.25, bound=25.0),
    AidingStatus("scan", (2, 3, 4), 400, nis=0.5, dropped={"correction older than the history": 1}),
    AidingStatus("gps", (3, 4, 5), 60, 7, innovation=np.ones(3), S=np.eye(3), nis=2500.0, bound=34.0, streak=7),
    AidingStatus("compass", (2,), 30, stamp_ns=-5_000_000_000, dropped={"<metal>": 4}),
)

# The server hears nothing of a page before its camera; on a busy computer the page says something sooner.
LATE_CAMERA = """{
  let mutable;
  Object.defineProperty(window, '__viserMutable', {
    get: () => mutable,
    set: (made) => {
      let send = made.sendMessage;
      const heard = (said) => (said.type === 'ViewerCameraMessage' && !window.cameraHeard ? null : send(said));
      Object.defineProperty(made, 'sendMessage', { get: () => heard, set: (other) => (send = other) });
      mutable = made;
    },
  });
}"""


class StillEngine:
    """Shows what `show` was given and remembers the commands that were sent."""

    def __init__(self, snapshot: Snapshot | None = None) -> None:
        self.mailbox: Mailbox[Snapshot] = Mailbox()
        self.sent: list[Command] = []
        self._run = 0
        if snapshot is not None:
            self.show(snapshot)

    def show(self, snapshot: Snapshot) -> None:
        """Make it the newest."""
        run, cut = snapshot.ahead.lineage
        known = replace(snapshot.ahead, lineage=(run + self._run, cut))
        self.mailbox.put(replace(snapshot, epoch=snapshot.epoch + self._run, ahead=known))

    def begin(self, snapshot: Snapshot) -> None:
        """As if nothing had been shown or sent before: of whatever run it is, it is another one."""
        self._run += 1000
        self.sent.clear()
        self.show(snapshot)

    def send(self, command: Command) -> None:
        """Remember it."""
        self.sent.append(command)


def room_maps(revision: int = 1) -> tuple[MapImage, ...]:
    """A room of 16 m x 12 m around the origin with walls 1 m thick; its north east corner is unknown."""
    cells = np.ones((48, 64), np.uint8)
    cells[:4], cells[-4:], cells[:, :4], cells[:, -4:] = 2, 2, 2, 2
    cells[32:, 44:] = 0
    return tuple(
        MapImage(level, RESOLUTION * 2**level, -8.0, -6.0, cells[:: 2**level, :: 2**level].copy(), revision)
        for level in range(LEVELS)
    )


def planar_gaussian(x: float, y: float, sigma_x: float, sigma_y: float) -> PlanarGaussian:
    """Uncorrelated, with a heading of zero."""
    return PlanarGaussian(np.array([x, y, 0.0]), np.diag([sigma_x**2, sigma_y**2, 1e-4]))


def step_result(index: int = 0, x: float = 0.0, y: float = 0.0, beams: int = 180) -> StepResult:
    """A robot at x, y that looks along x, tilted by 0.1 rad, and sees a ring of 3 m around itself."""
    angles = np.linspace(-2.0, 2.0, beams)
    points = (3.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)).astype(np.float32)
    pose = Transform(np.array([x, y, 0.2]), from_euler(0.1, 0.0, 0.0))
    match = MatchResult(
        pose=np.array([x, y, 0.0]),
        covariance=np.diag([0.001**2, 0.002**2, 1e-6]),
        hessian=np.eye(3),
        residuals=np.linspace(0.0, 1.0, beams, dtype=np.float32),
        iterations=(3, 4, 4),
        converged=True,
        trace=np.zeros((0, 4)),
    )
    return StepResult(
        index=index,
        stamp_ns=index * 25_000_000,
        T_map_base=pose,
        planar=match.pose,
        points=points,
        heights=np.linspace(-1.0, 1.0, beams, dtype=np.float32),
        unexpected=np.arange(beams) < beams // 10,
        match=match,
        prior=planar_gaussian(x, y, 0.003, 0.003),
        fused=planar_gaussian(x, y, 0.0012, 0.0018),
        navigation=NavigationState(0, np.zeros(19), np.eye(15) * 1e-4),
        map_updated=True,
        beams=beams,
        durations=Durations(),
        aiding=AIDING,
    )


def room_snapshot(sequence: int = 1, x: float = 0.0, y: float = 0.0) -> Snapshot:
    """The robot at x, y in the room, having come from the west wall in a straight line; truth 0.1 m beside it."""
    rows = 40
    path = np.zeros((rows, 8))
    path[:, 0] = 0.025 * np.arange(rows)
    path[:, 1], path[:, 2] = np.linspace(-6.0, x, rows), np.linspace(0.0, y, rows)
    path[:, 4] = 1.0
    series = np.zeros(rows, SERIES_DTYPE)
    return Snapshot(
        sequence=sequence,
        source="room",
        playback=PlaybackStatus(state="paused", end_ns=10**9),
        result=step_result(sequence, x, y),
        trajectory=path,
        truth=path + np.array([0, 0, 0.1, 0, 0, 0, 0, 0]),
        series=series,
        ahead=Ahead(series=series),
        maps=room_maps(),
        map_updates=3,
        scans=rows,
    )


def with_series(snapshot: Snapshot, series: np.ndarray, lineage: int = 0) -> Snapshot:
    """Shown and known alike. lineage: of another run."""
    return replace(snapshot, series=series, ahead=Ahead(lineage=(lineage, 0), series=series))


def restarted(snapshot: Snapshot) -> Snapshot:
    """The run begun again: a new epoch with nothing in it."""
    return Snapshot(sequence=snapshot.sequence + 1, epoch=snapshot.epoch + 1, config=snapshot.config)


def without_filter(snapshot: Snapshot) -> Snapshot:
    """The first scan of a run without inertial data: nothing to match, nothing before."""
    assert snapshot.result is not None
    result = snapshot.result._replace(match=None, prior=None, navigation=None)
    return replace(snapshot, result=result, sequence=snapshot.sequence + 1)
