"""A word to every page each second, so that a page whose link is broken knows it (static/link.js)."""

from hectorscope.page.scene import Stage
from hectorscope.session.snapshot import Snapshot


class Pulse:
    """Drawn like a view, whatever the run does."""

    title = "Pulse"
    rate = 1.0

    def __init__(self, stage: Stage) -> None:
        self._stage = stage

    def draw(self, _snapshot: Snapshot) -> None:
        """Say that the server is there."""
        self._stage.run("window.hectorscope?.beat?.()")
