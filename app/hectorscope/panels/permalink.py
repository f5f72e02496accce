"""The link to what is shown: told to the page, which adds its camera and copies it (static/permalink.js)."""

import html
import json
from typing import Any

from viser import GuiEvent

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.panels._controls import by_hand
from hectorscope.panels._handles import put, put_value
from hectorscope.run.permalink import Permalink, PermalinkError, from_text, to_text
from hectorscope.session.commands import Follow
from hectorscope.session.snapshot import Snapshot


class PermalinkPanel:
    """An invisible element with the link, and a hidden control that takes one that is to be followed."""

    title = "Permalink"
    order = 4
    rate = 2.0

    def __init__(self, scene: Scene) -> None:
        gui = scene.server.gui
        self._scene = scene
        self._follow = gui.add_text("Follow", "", visible=False)
        self._follow.on_update(by_hand(self._followed))
        self._told: dict[str, str] = {"follow": viser_private.uuid_of(self._follow)}
        self._mark = gui.add_html(mark(self._told))

    def draw(self, snapshot: Snapshot) -> None:
        """Tell the link when it is another one."""
        put(self._mark, mark({**self._told, **link_of(snapshot)}))

    def _followed(self, event: GuiEvent[Any]) -> None:
        text = event.target.value.strip()  # a page that asks again makes it another value by a space
        put_value(event.target, "")  # so that the same can be followed again
        if not text:
            return
        self._scene.run("window.hectorscope?.followed?.()", event.client)
        try:
            self._scene.send(Follow(from_text(text)))
        except PermalinkError as error:
            self._scene.notify(str(error), event.client, failed=True)


def link_of(snapshot: Snapshot) -> dict[str, str]:
    """The text of the link, or why there is none, in a word for the page."""
    playback = snapshot.playback
    if playback.live:
        return {"none": "A live stream has no link: nobody can go back to this moment."}
    if snapshot.recording is None:
        return {"none": "There is no link yet: the recording is still being read."}
    offset_ns = max(0, playback.time_ns - playback.start_ns)
    settings, prior = snapshot.ahead.settings, snapshot.map_sha256
    try:
        return {"link": to_text(Permalink(snapshot.recording, offset_ns, settings, map_sha256=prior))}
    except PermalinkError as error:
        return {"none": str(error)}


def mark(told: dict[str, str]) -> str:
    """The invisible element."""
    return f'<i class="hs-mark" data-hs-link="{html.escape(json.dumps(told))}"></i>'


PANEL = PermalinkPanel
