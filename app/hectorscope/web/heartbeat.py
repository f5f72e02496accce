"""A word to every page each second, so that a page whose link is broken knows it (static/link.js)."""

from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot


class Heartbeat:
    """Drawn like a view, whatever the run does."""

    title = "Heartbeat"
    rate = 1.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def draw(self, _snapshot: Snapshot) -> None:
        """Show that the server is alive."""
        self._scene.run("window.hectorscope?.beat?.()")
