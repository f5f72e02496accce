"""Follows a stream without a page, until the program is interrupted or the stream ends."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from hectorscope.cli.interruption import undisturbed
from hectorscope.cli.opening import get_ready, reserved_folder
from hectorscope.cli.options import MapFlags, SettingFlags
from hectorscope.cli.publishing import published
from hectorscope.common.terminal import printable
from hectorscope.inputs import Source
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import LogEntry, Snapshot
from slam_core.errors import SlamError

LOOK_S = 0.5  # how often it is looked for what is to be told


class NothingPublishedError(SlamError):
    """A node that nobody hears."""


def follow(
    source: Source, settings: SettingFlags, saved: MapFlags, publish: Sequence[str], out: Path | None
) -> int:
    """Publish the results of a stream; what the run says goes to the terminal. The exit code.

    out: where they are saved at the end.
    """
    if not publish and out is None:
        raise NothingPublishedError(
            "nothing would be left of the run: give --publish ADDRESS, or --out DIR, or both"
        )
    chosen = settings.settings()
    with reserved_folder(out), published(publish, source) as observer:
        engine = Engine(source, chosen, saved.prior_map(chosen), out=out, look_back=0.0)
        engine.observe(observer)
        for address in publish:
            print(printable(f"Results are published at {address}"), flush=True)
        engine.start(partial(get_ready, live=True))
        try:
            is_sound = _told(engine)
        finally:
            with undisturbed():
                engine.stop()
                if engine.saves:
                    print(printable(engine.save()), flush=True)
    return 0 if is_sound else 1


def _told(engine: Engine) -> bool:
    """Print what is new in the log, until the run ends; whether it ended well."""
    told = Told()
    while True:
        snapshot = engine.mailbox.take(LOOK_S)
        if snapshot is None:
            continue
        for text in told.news(snapshot):
            print(printable(text), flush=True)
        if snapshot.playback.state in {"ended", "failed"}:
            return snapshot.playback.state == "ended"


class Told:
    """Knows which lines of the log, and what reason to wait, were told already."""

    def __init__(self) -> None:
        self._log: tuple[LogEntry, ...] = ()
        self._waiting = ""

    def news(self, snapshot: Snapshot) -> list[str]:
        """The lines that are new."""
        known = set(map(id, self._log))
        new = [entry.text for entry in snapshot.log if id(entry) not in known]
        self._log = snapshot.log
        before, self._waiting = self._waiting, snapshot.report.waiting
        return new if self._waiting in {"", before} else [*new, self._waiting]
