"""Inside the matcher, for the scan at which a run rests: a card in each browser that asks (static/xray.js)."""

import json
import threading
from functools import partial
from typing import TYPE_CHECKING, Any

from viser import Icon

from hectorscope.page.scene import Scene
from hectorscope.panels import _request, _workspace
from hectorscope.panels._xray_scene import ClientScene
from hectorscope.panels._xray_shown import Shown
from hectorscope.panels._xray_wanted import wanted_of
from hectorscope.panels._xray_worker import Subject, Worker
from hectorscope.session.snapshot import Snapshot

if TYPE_CHECKING:  # the core comes with it, and the page is served before
    from hectorscope.session.other_scans import OtherScans

BUTTON = '<p class="hs-xray-open"><button type="button" data-hs-do="xray">Look inside the matcher · I</button></p>'
RESTS = ("paused", "ended")
FAR = 100  # scans that one request goes on or back
LONGEST_S = 1e6  # of a recording


class XrayPanel:
    """Each browser looks at what it wants of the scan that all are shown, or of one that it keeps.

    The work has a thread of its own.
    """

    title = "X-ray"
    order = 49
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._worker = Worker(self._show)
        self._lock = threading.Lock()  # nothing is drawn for a browser that has just left
        self._scenes: dict[int, ClientScene] = {}
        self._looked_at: tuple[Any, ...] = ()
        self._source = ""
        self._others: OtherScans | None = None
        with _workspace.tab(scene, "Live", Icon.GAUGE):
            scene.server.gui.add_html(BUTTON)
        _request.listen(scene, "xray", self._ask, for_viewers=True)

    def _ask(self, client: int, asked: dict[str, Any]) -> None:
        """{"open": false} closes, {"home": true} takes the start back, {"scan_by": n} and {"scan_at": seconds}
        go to another scan, anything else is a `Wanted`.
        """
        if asked.get("open") is False:
            self._leave(client)
        elif asked.get("home") is True:
            self._worker.start_at(client, None)
        elif "scan_by" in asked or "scan_at" in asked:
            self._visit(client, asked)
        else:
            self._worker.want(client, wanted_of(asked))

    def _visit(self, client: int, asked: dict[str, Any]) -> None:
        others = self._others
        if others is None:
            return
        if "scan_by" in asked:
            self._worker.visit(client, others, None, _request.whole(asked["scan_by"], -FAR, FAR))
        else:
            self._worker.visit(client, others, _request.number(asked["scan_at"], 0.0, LONGEST_S))

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the run from rest to rest, and the browsers as they leave."""
        self._others = snapshot.other_scans
        rests = snapshot.playback.state in RESTS and snapshot.rework is not None and snapshot.result is not None
        state = (snapshot.rework, snapshot.result, snapshot.config) if rests else ()
        if len(state) != len(self._looked_at) or any(
            a is not b for a, b in zip(state, self._looked_at, strict=True)
        ):
            self._looked_at = state
            anew, self._source = snapshot.source != self._source, snapshot.source
            self._worker.look_at(subject_of(snapshot) if rests else None, anew=anew)
        clients = self._scene.server.get_clients()
        for client in self._worker.viewers:
            if client not in clients:
                self._leave(client)

    def _leave(self, client: int) -> None:
        with self._lock:
            self._worker.leave(client)
            scene = self._scenes.pop(client, None)
            if scene is not None and client in self._scene.server.get_clients():
                scene.clear()

    def _show(self, client: int, shown: Shown) -> None:
        """On the thread of the worker."""
        with self._lock:
            handle = self._scene.server.get_clients().get(client)
            if handle is None or client not in self._worker.viewers:
                return
            if client not in self._scenes:
                self._scenes[client] = ClientScene(handle, partial(self._worker.start_at, client))
            self._scenes[client].draw(shown)
            self._scene.run(script_of(shown, _last_s(self._others)), handle)


def subject_of(snapshot: Snapshot) -> Subject | None:
    """The scan at which the run rests."""
    if snapshot.rework is None or snapshot.result is None:
        return None
    scan_s = (snapshot.result.stamp_ns - snapshot.playback.start_ns) / 1e9
    return Subject(snapshot.rework, snapshot.result, snapshot.config, snapshot.ahead.settings, scan_s)


def _last_s(others: "OtherScans | None") -> float:
    """The time of the last scan that can be gone to; 0 without any."""
    return float(others.times[-1]) if others is not None and len(others.times) else 0.0


def script_of(shown: Shown, last_s: float) -> str:
    """The call in the page. last_s: how far scans of one's own can be gone to, in seconds."""
    told = {
        "words": shown.words,
        "marks": list(shown.marks),
        "level": shown.level,
        "steps": shown.steps,
        "levels": shown.levels,
        "scan": shown.scan_s,
        "last": last_s,
    }
    return f"window.hectorscope?.xray?.show({json.dumps(told)})"


PANEL = XrayPanel
