"""viser's server behind the access control, by private parts of viser.

viser is pinned exactly; tests pin each of these uses. A page that cannot be guarded is not served.
"""

import contextlib
import io
import socket
import ssl
import threading
import time
from collections.abc import Awaitable, Callable
from types import SimpleNamespace
from typing import Any

import msgspec.msgpack
import viser
import websockets
import websockets.asyncio.server
import websockets.exceptions
from viser.infra import _infra
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from hectorscope.common.terminal import silent_logger
from hectorscope.page.viser_private import input_control
from hectorscope.web.access_control import UPLOAD, AccessControl
from hectorscope.web.messages import admit
from hectorscope.web.roles import Browser, Roles
from hectorscope.web.uploads import Uploads
from slam_core.errors import SlamError

CAMERA_PERIOD = 0.5  # seconds between camera messages that reach viser: it sends 50 a second and nobody reads them
MAX_MESSAGE = 256 * 1024  # bytes from a browser: the longest request, in letters of four bytes
_starting = threading.Lock()

Handler = Callable[[Any], Awaitable[None]]


class UnguardedError(SlamError):
    """The access control cannot be put before the viser that is installed."""


def open_server(
    listener: socket.socket,
    access: AccessControl,
    uploads: Uploads | None = None,
    roles: Roles | None = None,
    tls: ssl.SSLContext | None = None,
) -> viser.ViserServer:
    """A viser server that accepts on `listener` only, behind the access control. Takes over the socket.

    uploads: takes the recordings that browsers send; None refuses them. tls: encrypts all connections; None none.
    """
    host, port = listener.getsockname()[:2]
    guarded: list[bool] = []
    controls: list[viser.ViserServer] = []

    def find(uuid: str) -> Any:
        return input_control(controls[0], uuid) if controls else None

    def serve(handler: Any, _host: str, _port: int, **options: Any) -> Any:
        guarded.append(True)
        options |= {
            "process_request": lambda _, request: answer(access, request),
            "create_connection": listening(find, access, roles or Roles()),
            "max_size": MAX_MESSAGE,
            "server_header": None,
            "ssl": tls,
            "logger": silent_logger("hectorscope.web.websockets"),
        }
        return websockets.asyncio.server.serve(routed(handler, uploads), sock=listener, **options)

    stand_in = SimpleNamespace(**vars(websockets))
    stand_in.asyncio = SimpleNamespace(server=SimpleNamespace(serve=serve, ServerConnection=ServerConnection))
    with _starting, quiet():
        names = vars(_infra)
        original, names["websockets"] = names["websockets"], stand_in
        try:
            server = viser.ViserServer(host, port, label="Hectorscope", verbose=False)
        finally:
            names["websockets"] = original
    controls.append(server)
    if not guarded or server.get_port() != port:
        stop_server(server)
        raise UnguardedError(f"viser {viser.__version__} starts its server in another way: install viser 1.1.1")
    return server


def stop_server(server: viser.ViserServer) -> None:
    """Close every connection and the port."""
    with quiet():
        server.stop()


def quiet() -> contextlib.AbstractContextManager[Any]:
    """Viser prints a banner of its own; ours gives the address to open."""
    return contextlib.redirect_stdout(io.StringIO())


def answer(access: AccessControl, request: Request) -> Response | None:
    """The decision of the access control, as the WebSocket library takes it."""
    headers = {name.lower(): ", ".join(request.headers.get_all(name)) for name in request.headers}
    reply = access.answer(request.path, headers)
    if reply is None:
        return None
    sent = Headers({**reply.headers, "Content-Length": str(len(reply.body)), "Connection": "close"})
    return Response(reply.status.value, reply.status.phrase, sent, reply.body)


def routed(handler: Handler, uploads: Uploads | None) -> Handler:
    """The handler of viser for the page's connections, and that of the uploads for theirs."""

    async def handle(connection: Any) -> None:
        if connection.request.path.partition("?")[0] != UPLOAD:
            await handler(connection)
        elif uploads is not None:
            with contextlib.suppress(websockets.exceptions.ConnectionClosed):
                await uploads.receive(connection)

    return handle


def listening(find: Callable[[str], Any], access: AccessControl, roles: Roles) -> type[ServerConnection]:
    """A connection class that hands on only what the roles and `admit` let pass."""

    class Listening(ServerConnection):
        camera_seen = -CAMERA_PERIOD
        browser: Browser | None = None

        def known(self) -> Browser:
            """Whose it is, by the cookie of its handshake."""
            if self.browser is None:
                cookies = "; ".join(self.request.headers.get_all("Cookie")) if self.request else ""
                self.browser = Browser(access.role(cookies), str((self.remote_address or ("",))[0]))
            return self.browser

        def connection_lost(self, exc: Exception | None) -> None:
            """It is gone."""
            if self.browser is not None:
                roles.leave(self.browser)
            super().connection_lost(exc)

        async def piece(self) -> str | bytes:
            """For an upload: as it came."""
            return await super().recv()

        async def recv(self, decode: bool | None = None) -> Any:
            while True:
                message = self.filtered(await super().recv(decode))
                if message is not None:
                    return message

        def filtered(self, raw: Any) -> bytes | None:
            try:
                decoded = msgspec.msgpack.decode(raw) if isinstance(raw, bytes) else None
                message = admit(decoded, find) if roles.passes(self.known(), decoded) else None
            except (msgspec.DecodeError, RecursionError):
                return None
            if message is None or (message["type"] == "ViewerCameraMessage" and not self.wants_camera()):
                return None
            return msgspec.msgpack.encode(message)

        def wants_camera(self) -> bool:
            now = time.monotonic()
            if now - self.camera_seen < CAMERA_PERIOD:
                return False
            self.camera_seen = now
            return True

    return Listening
