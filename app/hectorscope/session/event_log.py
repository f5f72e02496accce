"""The event log of the page: the newest lines, each drag of a control as one."""

import re
from dataclasses import replace

from hectorscope.session.snapshot import LogEntry

LINES = 500
DRAG_NS = 1_000_000_000  # changes of one setting this close together are one movement of a hand
CHANGE = re.compile(r"(?P<name>[\w.]+): (?P<old>\S+) → (?P<new>\S+)")


class EventLog:
    """Keeps the newest lines. entries: oldest first, a new tuple whenever a line is added."""

    def __init__(self) -> None:
        self.entries: tuple[LogEntry, ...] = ()

    def add(self, entry: LogEntry) -> None:
        """One more line, or the last one replaced where the same control was moved on."""
        last = self.entries[-1:]
        drag = drawn_on(last[0], entry) if last else None
        self.entries = (*self.entries[:-1], drag) if drag else (*self.entries, entry)[-LINES:]


def drawn_on(last: LogEntry, entry: LogEntry) -> LogEntry | None:
    """Both as one, 'name: first → last', at the time of `entry`; None if they are not one movement of a hand."""
    before, now = CHANGE.fullmatch(last.text), CHANGE.fullmatch(entry.text)
    if not before or not now or before["name"] != now["name"] or entry.time_ns - last.time_ns >= DRAG_NS:
        return None
    return replace(entry, text=f"{now['name']}: {before['old']} → {now['new']}")
