"""A word to every page each second, so that a page whose link is broken knows it (static/link.js)."""

from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot
from hectorscope.web.roles import Roles


class Heartbeat:
    """Drawn like a view, whatever the run does."""

    title = "Heartbeat"
    rate = 1.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def draw(self, _snapshot: Snapshot) -> None:
        """Show that the server is alive."""
        self._scene.run("window.hectorscope?.beat?.()")


class InControl:
    """Tells every page each second which one is in control, where only one may act at a time."""

    title = "Control"
    rate = 1.0

    def __init__(self, scene: Scene, roles: Roles) -> None:
        self._scene, self._roles = scene, roles

    def draw(self, _snapshot: Snapshot) -> None:
        """Tell it."""
        if self._roles.one_operator:
            self._scene.run(self._roles.script())
