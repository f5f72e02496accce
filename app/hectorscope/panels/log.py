"""What happened, newest first: changed settings, warnings, errors. A click on a time goes there."""

import math
from collections.abc import Sequence

from viser import Icon

from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._format import clock, text
from hectorscope.session.snapshot import LogEntry, Snapshot

SHOWN = 100


class LogPanel:
    """A list that is sent only when it grew. An answer comes up in the corner too."""

    title = "Log"
    order = 70
    rate = 2.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._drawn: tuple[LogEntry, ...] = ()
        self._source = ""
        with _workspace.tab(scene, self.title, Icon.LIST_DETAILS):
            self._list = scene.server.gui.add_html(EMPTY)

    def draw(self, snapshot: Snapshot) -> None:
        """Send the newest entries, if there are new ones."""
        if snapshot.log is self._drawn:
            return
        if self._source in {"", snapshot.source}:  # else it is the log of another recording
            for answer in answers(snapshot.log, self._drawn):
                self._scene.notify(answer.text, failed=answer.level != "info")
        self._drawn, self._source = snapshot.log, snapshot.source
        playback = snapshot.playback
        self._list.content = log_html(snapshot.log, playback.start_ns, jumps=playback.end_ns is not None)


def answers(entries: Sequence[LogEntry], before: Sequence[LogEntry]) -> list[LogEntry]:
    """The answers among `entries` that were not there before, oldest first."""
    known = {id(entry) for entry in before}
    return [entry for entry in entries if entry.answer and id(entry) not in known]


def log_html(entries: Sequence[LogEntry], start_ns: int, *, jumps: bool = False) -> str:
    """The newest entries as a list; text is escaped. jumps: a time leads there (static/log.js)."""
    rows = [_line(entry, (entry.time_ns - start_ns) / 1e9, jumps) for entry in reversed(entries[-SHOWN:])]
    return f'<ol class="hs-log-list">{"".join(rows)}</ol>' if rows else EMPTY


def _line(entry: LogEntry, seconds: float, jumps: bool) -> str:
    scan = f"<small>scan {entry.scans}</small>" if entry.scans else ""
    when = f"<time>{clock(seconds)}{scan}</time>"
    if jumps:
        after = math.ceil(1e3 * seconds) / 1e3  # not before it, so that its scan is reached
        when = f'<button type="button" title="Go there" data-hs-seconds="{after}">{when}</button>'
    return f'<li class="hs-{entry.level}">{when}<span>{text(entry.text)}</span></li>'


EMPTY = '<p class="hs-empty">Nothing happened yet.</p>'

PANEL = LogPanel
