"""The message over the scene. It goes to the page by itself: the panels may be folded away (static/message.js)."""

import json
from time import monotonic

from hectorscope.page.scene import Scene
from hectorscope.panels._message import SYMBOLS, Message, message
from hectorscope.session.snapshot import Snapshot


class MessagePanel:
    """Sent when it changes, and again each second, as a page may have been opened just now."""

    title = "Message"
    order = 5
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._sent: tuple[str, int] = "", 0

    def draw(self, snapshot: Snapshot) -> None:
        """Tell every page."""
        told = script_of(message(snapshot)), int(monotonic())
        if told != self._sent:
            self._sent = told
            self._scene.run(told[0])


def script_of(told: Message | None) -> str:
    """The call in the page; text from outside stays text."""
    words = "" if told is None else json.dumps({**told._asdict(), "symbol": SYMBOLS[told.kind]})
    return f"window.hectorscope?.tell?.({words})"


PANEL = MessagePanel
