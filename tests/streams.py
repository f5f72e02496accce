"""A stream that a test drives on."""

from collections.abc import Callable

from hectorscope.inputs import Item
from hectorscope.session.commands import Command
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from slam_core.measurements import LaserScan
from tests.engines import until
from tests.sources import MemoryStream

SECOND = 10**9
SOME = 8  # scans that are sent at once: fewer than the queue of a stream holds


class Robot:
    """A stream and its engine; `drive_on` waits until the run has had what was sent."""

    def __init__(self, engine: Engine, stream: MemoryStream, drive: list[Item]) -> None:
        self.engine, self.stream, self._drive, self._sent = engine, stream, drive, 0
        self.start_ns = drive[0].stamp_ns

    def drive_on(self, seconds: float) -> Snapshot:
        """Send the drive up to a time, some scans at a time, so that none is given up."""
        batch: list[Item] = []
        while (
            self._sent < len(self._drive) and self._drive[self._sent].stamp_ns <= self.start_ns + seconds * SECOND
        ):
            batch.append(self._drive[self._sent])
            self._sent += 1
            if sum(isinstance(item, LaserScan) for item in batch) == SOME:
                self._send(batch)
                batch = []
        return self._send(batch)

    def _send(self, items: list[Item]) -> Snapshot:
        self.stream.send(items)
        scans = [item.stamp_ns for item in self._drive[: self._sent] if isinstance(item, LaserScan)]
        # The last scan may wait for inertial data that covers it.
        return until(self.engine, lambda now: now.ahead.time_ns >= scans[-min(2, len(scans))])

    def after(self, *commands: Command) -> Snapshot:
        """The snapshot once commands were obeyed and no seek is under way."""
        for command in commands:
            self.engine.send(command)
        return self.until(lambda now: now.playback.state != "seeking")

    def until(self, holds: Callable[[Snapshot], object]) -> Snapshot:
        """The first snapshot after all commands for which something holds."""
        return until(self.engine, lambda now: now.obeyed == self.engine.sent and holds(now))
