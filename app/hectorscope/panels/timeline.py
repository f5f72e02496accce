"""The timeline over a recording, or over what is kept of a stream: how far it is known, its marks, its times.

static/timeline.js draws it, and the strip of a series below it, from the rows that `plots.py` sends. It sends the
time that a hand wants to be at; the session takes the newest one.
"""

import html
import json
import math
from dataclasses import dataclass
from time import monotonic
from typing import Any

from viser import GuiButtonHandle, GuiEvent

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._controls import by_hand
from hectorscope.panels._curves import COLUMNS
from hectorscope.run.marks import TITLES, Mark, marks
from hectorscope.session.commands import Seek
from hectorscope.session.snapshot import PlaybackStatus, Snapshot

LONGEST_S = 1e7  # of a recording: months
MOST = 1000  # marks that are sent
MARKS_S = 0.5  # how often they are looked for while a run grows


@dataclass(slots=True)
class Sent:
    """What a browser was sent last."""

    play: str = ""
    marks: str = ""


class TimelinePanel:
    """Sends each browser what changed; a time that comes back is one of the recording."""

    title = "Timeline"
    order = 12
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._playback = PlaybackStatus()
        self._sent: dict[int, Sent] = {}
        self._marks = ""
        self._looked_at, self._seen = 0.0, (*Snapshot().ahead.lineage, 0)
        gui = scene.server.gui
        self._folder = _workspace.bar(scene, "timeline")
        with self._folder:
            self._wanted = gui.add_number("Go to, s", 0.0, min=0.0, max=LONGEST_S, visible=False)
            ask = gui.add_button("Send the timeline", visible=False)
            scene.for_viewers.add(viser_private.uuid_of(ask))
            gui.add_html(container(viser_private.uuid_of(self._wanted), viser_private.uuid_of(ask)))
        self._wanted.on_update(by_hand(self._go))
        ask.on_click(self._begin)

    def _go(self, event: GuiEvent[Any]) -> None:
        span, start_ns = span_ns(self._playback), self._playback.start_ns
        if span is not None:
            self._scene.send(Seek(min(max(start_ns + round(event.target.value * 1e9), span[0]), span[1])))

    def _begin(self, event: GuiEvent[GuiButtonHandle]) -> None:
        """A page is ready: what was sent before may be lost."""
        if event.client is not None:
            self._sent[event.client.client_id] = Sent()

    def draw(self, snapshot: Snapshot) -> None:
        """Send what changed to every browser that has asked."""
        self._playback = snapshot.playback
        visible = span_ns(snapshot.playback) is not None
        if self._folder.visible != visible:
            self._folder.visible = visible
        play, found = play_script(snapshot), self._marks_script(snapshot)
        clients = self._scene.server.get_clients()
        for key, sent in list(self._sent.items()):
            if key not in clients:
                del self._sent[key]
                continue
            for script in (play if play != sent.play else "", found if found != sent.marks else ""):
                if script:
                    self._scene.run(script, clients[key])
            self._sent[key] = Sent(play, found)

    def _marks_script(self, snapshot: Snapshot) -> str:
        """Of the marks, looked for again where there may be others."""
        ahead, report, start_ns = snapshot.ahead, snapshot.report, snapshot.playback.start_ns
        others = len(ahead.series) + len(ahead.warned) + len(report.findings) + len(report.repaired)
        state, now = (*ahead.lineage, others), monotonic()
        if state != self._seen and (state[:2] != self._seen[:2] or now - self._looked_at >= MARKS_S):
            self._seen, self._looked_at = state, now
            found = marks(ahead.series, start_ns, ahead.settings, report, ahead.warned)
            self._marks = marks_script(found, start_ns)
        return self._marks


def container(wanted: str, ask: str) -> str:
    """The element that static/timeline.js fills; the uuids of the controls that it sends by."""
    told = {"wanted": wanted, "ask": ask, "kinds": dict(TITLES), "updates": COLUMNS.index("map_updates")}
    return f'<div class="hs-timeline" data-hs-timeline="{html.escape(json.dumps(told))}"></div>'


def play_script(snapshot: Snapshot) -> str:
    """Where the run is, in seconds since its start; rows: of the series that are shown."""
    playback, ahead = snapshot.playback, snapshot.ahead
    start_ns, span = playback.start_ns, span_ns(playback)
    told = {
        "at": seconds(playback.time_ns - start_ns),
        "begin": seconds(span[0] - start_ns) if span else 0.0,
        "end": seconds(span[1] - start_ns) if span else None,
        "known": seconds(max(ahead.time_ns, playback.time_ns) - start_ns),
        "whole": ahead.whole,
        "rows": len(snapshot.series),
        "state": playback.state,
    }
    return f"window.hectorscope?.play?.({json.dumps(told)})"


def marks_script(found: tuple[Mark, ...], start_ns: int) -> str:
    """Seconds, kind, scan and text of each mark; of very many some are left out."""
    some = found[:: max(1, math.ceil(len(found) / MOST))]
    told = [[after(mark.time_ns - start_ns), mark.kind, mark.scan, mark.text] for mark in some]
    return f"window.hectorscope?.marks?.({json.dumps(told)})"


def span_ns(playback: PlaybackStatus) -> tuple[int, int] | None:
    """First and last time that can be gone to: of a recording, or of what is kept of a stream."""
    return playback.kept_ns if playback.end_ns is None else (playback.start_ns, playback.end_ns)


def seconds(time_ns: int) -> float:
    """Never less than none, to the millisecond."""
    return max(0.0, round(time_ns / 1e9, 3))


def after(time_ns: int) -> float:
    """The millisecond at or after a time, so that a jump reaches its scan."""
    return max(0.0, math.ceil(time_ns / 1e6) / 1e3)


PANEL = TimelinePanel
