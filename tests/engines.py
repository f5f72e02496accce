"""Engines for tests: run, told what to do, and waited for."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from hectorscope.inputs import Item, Source
from hectorscope.run.settings import Settings
from hectorscope.session.commands import Command
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.station import Station
from hectorscope.web.server import Driver
from slam_core.config import SlamConfig, with_value
from slam_core.measurements import LaserScan

START = Settings(with_value(SlamConfig(), "map.size", 512))
PATIENCE_S = 20.0


@contextmanager
def running(
    source: Source, settings: Settings = START, *, station: Station | None = None, **options: float
) -> Iterator[Engine]:
    """An engine that is stopped in any case."""
    engine = Engine(source, settings, **options)  # type: ignore[arg-type]
    engine.attach(station or Station())
    engine.start()
    try:
        yield engine
    finally:
        engine.stop()


def until(engine: Driver, holds: Callable[[Snapshot], object], patience_s: float = PATIENCE_S) -> Snapshot:
    """The first snapshot for which something holds."""
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        latest = engine.mailbox.latest
        if latest is not None and holds(latest):
            return latest
        time.sleep(0.01)  # and not `take`: what a page is to draw is left to it
    assert latest is not None
    raise AssertionError(f"never happened; at last {latest.playback}, {latest.report}, {latest.log}")


def state(word: str) -> Callable[[Snapshot], bool]:
    """A condition for `until`."""
    return lambda snapshot: snapshot.playback.state == word


def after(engine: Engine, *commands: Command) -> Snapshot:
    """The snapshot once the commands were obeyed and the engine rests."""
    for command in commands:
        engine.send(command)
    resting = ("paused", "ended", "failed")
    return until(engine, lambda now: now.obeyed == engine.sent and now.playback.state in resting)


def scan_times(items: list[Item]) -> list[int]:
    """Stamps of the scans."""
    return [item.stamp_ns for item in items if isinstance(item, LaserScan)]
