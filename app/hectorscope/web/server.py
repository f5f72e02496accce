"""The page's server: port, access control, scene, views, panels and the display thread, put together."""

import logging
import re
import socket
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
from hectorscope.web.guarded_server import open_server, stop_server
from hectorscope.web.heartbeat import Heartbeat, InControl
from hectorscope.web.lessons import lessons_file
from hectorscope.web.metrics import METRICS, metrics
from hectorscope.web.renderer import Renderer
from hectorscope.web.roles import Roles
from hectorscope.web.shared_replay import exporter
from hectorscope.web.uploads import Uploads
from slam_core.errors import SlamError

log = logging.getLogger(__name__)

TOKEN = re.compile(r"[A-Za-z0-9_-]{8,128}")
LAST_PORT = 65535
ROLE = "/role"  # what the page of this browser may do


class ServerError(SlamError):
    """The page cannot be served at this address."""


class Driver(Protocol):
    """What the page needs of an engine."""

    @property
    def mailbox(self) -> Mailbox[Snapshot]:
        """The newest snapshot."""

    def send(self, command: Command) -> None:
        """Enqueue a command."""


class PageServer:
    """Serves the page of a driver from `start` to `stop`; ServerError when the address cannot be had.

    port 0 takes any free one. upload_limit: bytes of recordings that browsers may send; 0 takes none. An address
    that others on the network can reach needs a token (8 to 128 letters, digits, _ or -), which then is part of
    `url`. teacher: the key of the teacher's link, for a class.
    """

    def __init__(
        self,
        driver: Driver,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        token: str | None = None,
        upload_limit: int = 0,
        viewer_token: str | None = None,
        teacher: str | None = None,
    ) -> None:
        self.driver, self._host, self._port, self._token = driver, host, port, token
        self._viewer_token, self._teacher = viewer_token, teacher
        check_address(host, port, token)
        check_viewers(token, viewer_token)
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
        return url_of(self._host, self._port, self._token)

    @property
    def viewers_url(self) -> str:
        """The same for who may only look; empty if nobody may."""
        return url_of(self._host, self._port, self._viewer_token) if self._viewer_token else ""

    @property
    def teacher_url(self) -> str:
        """The link by which other browsers follow a view; empty where there is no class."""
        return f"{self.url}#teach={self._teacher}" if self._teacher else ""

    def start(self) -> None:
        """Take the port, build the page and begin to draw; returns at once."""
        listener = listen(self._host, self._port)
        self._port = listener.getsockname()[1]
        self._server = open_server(listener, self._access(), self._uploads, self.roles)
        self.scene = Scene(self._server, self.driver.send, replay=exporter, teacher=self._teacher)
        with viser_private.icons_at_hand():
            views = made(view_classes(), self.scene)  # before the panels, which list the views' layers
            panels = made(panel_classes(), self.scene)
        self.roles.open = self.scene.for_viewers
        beats = (Heartbeat(self.scene), InControl(self.scene, self.roles))
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
            "/": page(client.page, static),
            HEALTH: File("text/plain", b"ok\n"),
            **client.files,
            **static,
            "/lessons.json": lessons_file(resource_folder("static")),
        }
        # Cookies are shared by the ports of a host: the name keeps two programs apart.
        cookie = f"hectorscope_{self._port}"
        any_host = not is_loopback(self._host)
        return AccessControl(
            files,
            self._token,
            cookie,
            any_host=any_host,
            uploads=self._uploads is not None,
            viewer_token=self._viewer_token,
            answers={
                ROLE: lambda role: File("text/plain", role.encode()),
                METRICS: lambda _: metrics(self.driver.mailbox.latest, len(self._server.get_clients())),
            },
        )


def check_address(host: str, port: int, token: str | None) -> None:
    """ServerError for a port that does not exist, a token of no use, or a network without one."""
    if not 0 <= port <= LAST_PORT:
        raise ServerError(f"port {port} does not exist: give 1 to {LAST_PORT}, or 0 for any free one")
    if token is None and not is_loopback(host):
        raise ServerError(f"{host} is open to the network: give a token too, or serve 127.0.0.1")
    if token is not None and not TOKEN.fullmatch(token):
        raise ServerError(f"the token has {len(token)} characters: give 8 to 128 letters, digits, _ or -")


def check_viewers(token: str | None, viewer_token: str | None) -> None:
    """ServerError for a token of viewers that is of no use."""
    if viewer_token is None:
        return
    if token is None or token == viewer_token:
        raise ServerError("viewers need a token that is not the operator's: give --token as well, another one")
    if not TOKEN.fullmatch(viewer_token):
        raise ServerError(
            f"the viewers' token has {len(viewer_token)} characters: give 8 to 128 letters, digits, _ or -"
        )


def url_of(host: str, port: int, token: str | None) -> str:
    """What to open in a browser."""
    name = f"[{host}]" if ":" in host else host
    return f"http://{name}:{port}/" + (f"?token={token}" if token else "")


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


def listen(host: str, port: int) -> socket.socket:
    """A listening socket on exactly this address; ServerError when it cannot be had."""
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(address[:2], family=family)
    except socket.gaierror as error:
        raise ServerError(f"host {host!r} is unknown here: give an address of this machine") from error
    except OSError as error:
        raise ServerError(
            f"port {port} of {host} cannot be had ({error.strerror}): end the other program or give another --port"
        ) from error
