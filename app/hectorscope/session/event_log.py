"""The event log of the page: the newest lines, each drag of a control as one."""

import re
import time
from collections.abc import Callable
from dataclasses import replace

from hectorscope.session.snapshot import LogEntry

LINES = 500
DRAG_S = 1.0  # changes of one setting this close together, of a person's time, are one drag
CHANGE = re.compile(r"(?P<name>[\w.]+): (?P<old>\S+) → (?P<new>\S+)")


class EventLog:
    """Keeps the newest lines. entries: oldest first, a new tuple whenever a line is added.

    clock: seconds, monotonic, of the person who moves a control; the recording may stand still or race meanwhile.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.entries: tuple[LogEntry, ...] = ()
        self._clock = clock
        self._added_at = 0.0
        self._noted: set[str] = set()

    def is_new(self, text: str) -> bool:
        """Whether this is asked for the first time; for what is to stand in the log once."""
        known = text in self._noted
        self._noted.add(text)
        return not known

    def add(self, entry: LogEntry) -> None:
        """One more line, or the last one replaced where the same control was moved on."""
        now, last = self._clock(), self.entries[-1:]
        drag = merged(last[0], entry) if last and now - self._added_at < DRAG_S else None
        self.entries = (*self.entries[:-1], drag) if drag else (*self.entries, entry)[-LINES:]
        self._added_at = now


def merged(last: LogEntry, entry: LogEntry) -> LogEntry | None:
    """Both as one, 'name: first → last', at the time of `entry`; None if they are of two settings.

    A value that goes back to the first one stays a line of its own: the other value acted in between.
    """
    before, now = CHANGE.fullmatch(last.text), CHANGE.fullmatch(entry.text)
    if not before or not now or before["name"] != now["name"] or before["old"] == now["new"]:
        return None
    return replace(entry, text=f"{now['name']}: {before['old']} → {now['new']}")
