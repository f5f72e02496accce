"""What happened, newest first: changed settings with their times, warnings, errors."""

import re
from dataclasses import replace

from viser import Icon

from app.panels import _workspace
from app.panels._format import clock, text
from app.snapshot import LogEntry, Snapshot
from app.web.stage import Stage

SHOWN = 100
DRAG_NS = 1_000_000_000  # changes of one setting this close together are one movement of a hand
CHANGE = re.compile(r"(?P<name>[\w.]+): (?P<old>\S+) → (?P<new>\S+)")


class LogPanel:
    """A list that is sent only when it grew."""

    title = "Log"
    order = 70
    rate = 2.0

    def __init__(self, stage: Stage) -> None:
        self._drawn: tuple[LogEntry, ...] | None = None
        with _workspace.tab(stage, self.title, Icon.LIST_DETAILS):
            self._list = stage.server.gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Send the newest entries, if there are new ones."""
        if snapshot.log != self._drawn:
            self._drawn = snapshot.log
            self._list.content = log_html(snapshot.log, snapshot.playback.start_ns)


def folded(entries: tuple[LogEntry, ...]) -> list[LogEntry]:
    """The entries with each drag of a control as one: 'name: first → last', at the time of the last."""
    out: list[LogEntry] = []
    for entry in entries:
        now, before = CHANGE.fullmatch(entry.text), CHANGE.fullmatch(out[-1].text) if out else None
        if now and before and now["name"] == before["name"] and entry.time_ns - out[-1].time_ns < DRAG_NS:
            out[-1] = replace(entry, text=f"{now['name']}: {before['old']} → {now['new']}")
        else:
            out.append(entry)
    return out


def log_html(entries: tuple[LogEntry, ...], start_ns: int) -> str:
    """The newest entries as a list; text is escaped."""
    rows = [
        f'<li class="hs-{entry.level}"><time>{clock((entry.time_ns - start_ns) / 1e9)}</time>'
        f"<span>{text(entry.text)}</span></li>"
        for entry in reversed(folded(entries)[-SHOWN:])
    ]
    return f'<ol class="hs-log-list">{"".join(rows)}</ol>' if rows else EMPTY


EMPTY = '<p class="hs-empty">Nothing happened yet.</p>'

PANEL = LogPanel
