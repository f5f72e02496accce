"""The message over the scene. It goes to the page by itself: the panels may be folded away (static/message.js)."""

import json
from time import monotonic

from hectorscope.page.scene import Scene
from hectorscope.panels._message import SYMBOLS, Message, message
from hectorscope.session.snapshot import Snapshot

REPEAT_S = 1.0  # so that a page that has just been opened hears it too


class MessagePanel:
    """Sent when it changes, and again each second."""

    title = "Message"
    order = 5
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._sent: tuple[str, float] = "", 0.0

    def draw(self, snapshot: Snapshot) -> None:
        """Tell every page."""
        script, now = script_of(message(snapshot)), monotonic()
        if script != self._sent[0] or now - self._sent[1] >= REPEAT_S:
            self._sent = script, now
            self._scene.run(script)


def script_of(told: Message | None) -> str:
    """The call in the page; text from outside stays text."""
    words = "" if told is None else json.dumps({**told._asdict(), "symbol": SYMBOLS[told.kind]})
    return f"window.hectorscope?.tell?.({words})"


PANEL = MessagePanel
