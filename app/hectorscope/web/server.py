"""The page's server: port, access control, scene, views, panels and the display thread, put together."""

import logging
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Protocol

from hectorscope.common.resources import resource_folder
from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.page.static_files import File, page, static_files
from hectorscope.page.viser_client import unpacked
from hectorscope.panels import panel_classes
from hectorscope.session.commands import Command, OpenUploaded
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.station_commands import HandOver
from hectorscope.views import view_classes
from hectorscope.web.access_control import HEALTH, AccessControl, is_loopback
from hectorscope.web.address import Address, Certificate, listen
from hectorscope.web.guarded_server import open_server, stop_server
from hectorscope.web.heartbeat import Heartbeat, InControl, SlowBrowsers
from hectorscope.web.lessons import lessons_file
from hectorscope.web.metrics import METRICS, metrics
from hectorscope.web.renderer import Renderer
from hectorscope.web.roles import Roles
from hectorscope.web.shared_replay import exporter
from hectorscope.web.uploads import Uploads

log = logging.getLogger(__name__)

ROLE = "/role"  # what the page of this browser may do


class Driver(Protocol):
    """What the page needs of an engine."""

    @property
    def mailbox(self) -> Mailbox[Snapshot]:
        """The newest snapshot."""

    def send(self, command: Command) -> None:
        """Enqueue a command."""


class PageServer:
    """Serves the page of a driver from `start` to `stop`; ServerError when the address cannot be had.

    port 0 takes any free one. upload_limit: bytes of recordings that browsers may send; 0 takes none. teacher: the
    key of the teacher's link, for a class. The others are those of `Address`.
    """

    def __init__(
        self,
        driver: Driver,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        token: str | None = None,
        viewer_token: str | None = None,
        certificate: Certificate | None = None,
        public: str | None = None,
        upload_limit: int = 0,
        teacher: str | None = None,
    ) -> None:
        self.driver, self._port, self._teacher = driver, port, teacher
        self._address = Address(host, port, token, viewer_token, certificate, public)
        takes = upload_limit and viewer_token is None  # a connection of its own, of which no page is in control
        self._uploads = Uploads(upload_limit, self._arrived) if takes else None
        self.roles = Roles(one_operator=viewer_token is not None, handed_over=self._handed_over)

    def _handed_over(self, address: str) -> None:
        self.driver.send(HandOver(address))

    def _arrived(self, path: Path, name: str) -> None:
        self.driver.send(OpenUploaded(path, name))

    @property
    def url(self) -> str:
        """What to open in a browser."""
        return self._address.url(self._port, self._address.token)

    @property
    def viewers_url(self) -> str:
        """The same for who may only look; empty if nobody may."""
        token = self._address.viewer_token
        return self._address.url(self._port, token) if token else ""

    @property
    def teacher_url(self) -> str:
        """The link by which other browsers follow a view; empty where there is no class."""
        return f"{self.url}#teach={self._teacher}" if self._teacher else ""

    def start(self) -> None:
        """Take the port, build the page and begin to draw; returns at once."""
        certificate = self._address.certificate
        tls = certificate.context() if certificate else None
        listener = listen(self._address.host, self._address.port)
        self._port = listener.getsockname()[1]
        self._server = open_server(listener, self._access(), self._uploads, self.roles, tls)
        self.scene = Scene(self._server, self.driver.send, replay=exporter, teacher=self._teacher)
        with viser_private.icons_at_hand():
            views = made(view_classes(), self.scene)  # before the panels, which list the views' layers
            panels = made(panel_classes(), self.scene)
        self.roles.open = self.scene.for_viewers
        beats = (Heartbeat(self.scene), InControl(self.scene, self.roles), SlowBrowsers(self.scene))
        self._renderer = Renderer(self.scene, self.driver.mailbox, [*views, *panels, *beats])
        self._renderer.start()

    def stop(self) -> None:
        """Close the page, give the port back, and remove what browsers sent."""
        self._renderer.stop()
        stop_server(self._server)
        if self._uploads:
            self._uploads.close()

    def _access(self) -> AccessControl:
        static = static_files(resource_folder("static"))
        client = unpacked(viser_private.INDEX.read_bytes())
        files = {
            **page(client.page, static),
            HEALTH: File("text/plain", b"ok\n"),
            **client.files,
            **static,
            "/lessons.json": lessons_file(resource_folder("static")),
        }
        # Cookies are shared by the ports of a host: the name keeps two programs apart.
        cookie = f"hectorscope_{self._port}"
        return AccessControl(
            files,
            self._address.token,
            cookie,
            any_host=not is_loopback(self._address.host),
            public_host=self._address.public_host,
            encrypted=self._address.is_encrypted,
            uploads=self._uploads is not None,
            viewer_token=self._address.viewer_token,
            answers={
                ROLE: lambda role: File("text/plain", role.encode()),
                METRICS: lambda _: metrics(self.driver.mailbox.latest, len(self._server.get_clients())),
            },
        )


def serve(server: PageServer, up: Callable[[], None]) -> None:
    """Serve the page until interrupted; prints its address. ServerError when the port is taken.

    up: called once the page is there. What the engine loads would only keep a browser waiting before.
    """
    server.start()
    print(f"Hectorscope is at {server.url}", flush=True)
    if server.viewers_url:
        print(f"Viewers, who only look: {server.viewers_url}", flush=True)
    if server.teacher_url:
        print(f"The teacher opens {server.teacher_url}", flush=True)
    try:
        up()
        threading.Event().wait()
    except KeyboardInterrupt:
        print("stopping")
    finally:
        server.stop()


def made(kinds: Iterable[Any], scene: Scene) -> list[Any]:
    """One of each view or panel; one that cannot be made is left out and named on the page."""
    items = []
    for kind in kinds:
        try:
            items.append(kind(scene))
        except Exception as error:  # one broken view must not take the page away
            log.exception("%s cannot be made", kind.title)
            scene.failures[kind.title] = type(error).__name__
    return items
