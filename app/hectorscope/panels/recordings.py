"""The recordings that can be opened: told to the page, which lists them in a dialogue (static/recordings.js)."""

import html
import json
from typing import Any

from viser import GuiEvent

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.panels._controls import by_hand
from hectorscope.panels._handles import put, put_value
from hectorscope.session.commands import ListRecordings, Open
from hectorscope.session.snapshot import Listed, Snapshot


class RecordingsPanel:
    """Two hidden controls: one takes the key of a recording, one asks for the list anew."""

    title = "Recordings"
    order = 3
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        gui = scene.server.gui
        self._send = scene.send
        self._key = gui.add_text("Open", "", visible=False)
        self._key.on_update(by_hand(self._open))
        anew = gui.add_button("List the recordings", visible=False)
        anew.on_click(lambda _: scene.send(ListRecordings()))
        self._controls = {"open": viser_private.uuid_of(self._key), "list": viser_private.uuid_of(anew)}
        self._listed: tuple[Listed, ...] = ()
        self._mark = gui.add_html(mark(self._controls, ()))

    def draw(self, snapshot: Snapshot) -> None:
        """Tell the list when it is another one."""
        if snapshot.library is not self._listed:
            self._listed = snapshot.library
            put(self._mark, mark(self._controls, self._listed))

    def _open(self, event: GuiEvent[Any]) -> None:
        key = event.target.value
        put_value(event.target, "")  # so that the same can be asked for again
        if key:
            self._send(Open(key))


def mark(controls: dict[str, str], listed: tuple[Listed, ...]) -> str:
    """An invisible element with the controls and the list: [key, name, group] of each."""
    told = {**controls, "recordings": [[each.key, each.name, each.group] for each in listed]}
    return f'<i class="hs-mark" data-hs-library="{html.escape(json.dumps(told))}"></i>'


PANEL = RecordingsPanel
