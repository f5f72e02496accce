"""Each second: a word to every page, which knows by it that its link holds, and a limit to what waits for one."""

import logging

from hectorscope.page.scene import Scene
from hectorscope.page.viser_private import hang_up, unsent
from hectorscope.session.snapshot import Snapshot
from hectorscope.web.roles import Roles

MOST_UNSENT = 16 * 2**20  # characters of scripts that may wait for one browser

log = logging.getLogger(__name__)


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


class SlowBrowsers:
    """Ends the connections of browsers that read too little, for which messages would fill the memory.

    Their pages connect again by themselves, and then get what is true by then instead of all that was.
    """

    title = "Slow browsers"
    rate = 1.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def draw(self, _snapshot: Snapshot) -> None:
        """Look at each of them."""
        for number, client in self._scene.server.get_clients().items():
            if unsent(client) > MOST_UNSENT:
                log.warning("browser %d reads too slowly: its connection is ended", number)
                hang_up(client)
