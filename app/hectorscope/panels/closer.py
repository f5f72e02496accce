"""A closer look at a beam or a cell that somebody clicked: a card in that browser alone (static/closer.js)."""

import json
from typing import Any

from hectorscope.page.scene import Scene
from hectorscope.panels import _request
from hectorscope.panels._closer import card_html, marks
from hectorscope.run.readings import CellTarget, View
from hectorscope.session.commands import AHEAD, Inspect, Pick
from hectorscope.session.snapshot import Snapshot

REACH = 5.0  # metres: somebody who sees a whole town points that roughly
MOST_BEAMS = 1 << 20
CLOSED = "window.hectorscope?.closer?.show()"


class CloserPanel:
    """Each browser has a selection of its own; what it sees is worked out again for each scan that is shown."""

    title = "Closer look"
    order = 45
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._sent: dict[int, str] = {}
        _request.listen(scene, "look", self._look, for_viewers=True)

    def _look(self, client: int, asked: dict[str, Any]) -> None:
        wanted = command(client, asked)
        if wanted.what is not None:
            self._sent.pop(client, None)  # it may have closed a card that shows the same
        self._scene.send(wanted)

    def draw(self, snapshot: Snapshot) -> None:
        """Send each browser what changed of its card."""
        clients = self._scene.server.get_clients()
        for client in [client for client in list(self._sent) if client not in snapshot.views]:
            self._sent.pop(client, None)  # a browser may ask meanwhile, on another thread
            if client in clients:
                self._scene.run(CLOSED, clients[client])
        for client, view in snapshot.views.items():
            script = script_of(view)
            if client not in clients:
                self._scene.send(Inspect(client, None))
            elif script != self._sent.get(client):
                self._sent[client] = script
                self._scene.run(script, clients[client])


def command(client: int, asked: dict[str, Any]) -> Inspect:
    """What a browser asks for: {"at": [[level, x, y], ...], "reach": metres}, {"beam": number} or nothing.

    BadRequest for what no script of ours sends.
    """
    if "at" in asked:
        asked_at = _request.items(asked["at"], _request.MOST_LEVELS)
        places = tuple(CellTarget(*_request.place(each)) for each in asked_at)
        return Inspect(client, Pick(places, _request.number(asked.get("reach"), 0.0, REACH)))
    if "beam" in asked:
        return Inspect(client, _request.whole(asked["beam"], AHEAD, MOST_BEAMS))
    return Inspect(client, None)


def script_of(view: View | None) -> str:
    """The call in the page."""
    return f"window.hectorscope?.closer?.show({json.dumps(card_html(view))}, {json.dumps(marks(view))})"


PANEL = CloserPanel
