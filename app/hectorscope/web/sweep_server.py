"""The page of a sweep, behind the same access control as that of a run."""

import json
import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from hectorscope.common.paths import is_file
from hectorscope.exporters import OutputError
from hectorscope.sweep.table import CSV
from hectorscope.web.access_control import NO_SOCKET, AccessControl, Reply, guards, is_loopback, plain
from hectorscope.web.address import Address, listen
from hectorscope.web.sweep_files import JSON, SweepFiles
from hectorscope.web.viewers import Viewers
from slam_core.errors import SlamError

OPEN = "/open"
MOST = 1024  # bytes of a request's body
SLOW_S = 30.0  # until a browser that sends nothing is left


class SweepServer:
    """Serves the page from `start` to `stop`; OutputError without a table, ServerError for a bad address."""

    def __init__(self, folder: Path, *, host: str = "127.0.0.1", port: int = 8080, token: str | None = None):
        if not is_file(folder / CSV):
            raise OutputError(f"{folder} has no {CSV}: give a folder that hectorscope sweep --out left")
        self._folder, self._port, self._address = folder, port, Address(host, port, token)
        self._viewers = Viewers(folder, host, token)

    @property
    def url(self) -> str:
        """What to open in a browser."""
        return self._address.url(self._port, self._address.token)

    def start(self) -> None:
        """Take the port; returns at once."""
        listener = listen(self._address.host, self._port)
        self._port = listener.getsockname()[1]
        access = AccessControl(
            SweepFiles(self._folder),
            self._address.token,
            f"hectorscope_{self._port}",
            any_host=not is_loopback(self._address.host),
        )
        self._server = ThreadingHTTPServer(listener.getsockname()[:2], handler(access, self._viewers), False)
        self._server.socket.close()
        self._server.socket = listener
        threading.Thread(target=self._server.serve_forever, name="sweep page", daemon=True).start()

    def stop(self) -> None:
        """Close the page, the runs that it opened, and the port."""
        self._server.shutdown()
        self._server.server_close()
        self._viewers.close()


def serve_sweep(folder: Path, *, host: str, port: int, token: str | None) -> None:
    """Serve the page until interrupted; prints its address."""
    server = SweepServer(folder, host=host, port=port, token=token)
    server.start()
    print(f"The sweep is at {server.url}", flush=True)
    try:
        threading.Event().wait()
    except KeyboardInterrupt:
        print("stopping")
    finally:
        server.stop()


def handler(access: AccessControl, viewers: Viewers) -> type[BaseHTTPRequestHandler]:
    """What answers each request; nothing of it is logged."""

    class Handler(BaseHTTPRequestHandler):
        timeout = SLOW_S
        server_version, sys_version = "Hectorscope", ""

        def do_GET(self) -> None:
            try:
                reply = access.answer(self.path, self._headers()) or plain(HTTPStatus.FORBIDDEN, NO_SOCKET)
            except OutputError as error:  # the table cannot be read
                reply = plain(HTTPStatus.INTERNAL_SERVER_ERROR, f"{error}\n")
            self._send(reply)

        def do_POST(self) -> None:
            self._send(opened(access, viewers, self.path, self._headers(), self._body()))

        def _headers(self) -> dict[str, str]:
            return {name.lower(): value for name, value in self.headers.items()}

        def _body(self) -> bytes:
            length = self.headers.get("Content-Length", "")
            return self.rfile.read(int(length)) if length.isdecimal() and int(length) <= MOST else b""

        def _send(self, reply: Reply) -> None:
            self.send_response_only(reply.status)
            for name, value in {**reply.headers, "Content-Length": str(len(reply.body))}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(reply.body)

        def log_message(self, *_: Any) -> None:
            """Nowhere."""

    return Handler


def opened(access: AccessControl, viewers: Viewers, path: str, headers: dict[str, str], body: bytes) -> Reply:
    """The reply to a request to open a run: its address, or the reason why not. Only our own page may ask."""
    allowed = access.answer("/", {name: text for name, text in headers.items() if name != "upgrade"})
    if allowed is None or allowed.status != HTTPStatus.OK:
        return allowed or plain(HTTPStatus.FORBIDDEN, NO_SOCKET)
    if path != OPEN or "origin" not in headers:
        return plain(HTTPStatus.FORBIDDEN, "Only the page itself opens runs.\n")
    try:
        key = json.loads(body)["key"]
    except (ValueError, KeyError, TypeError, RecursionError):
        key = None
    if not isinstance(key, str) or f"/run/{key}.json" not in access.files:
        return plain(HTTPStatus.BAD_REQUEST, "There is no such run.\n")
    try:
        answer = {"url": viewers.open(key)}
    except SlamError as error:
        answer = {"error": str(error)}
    return Reply(HTTPStatus.OK, {"Content-Type": JSON, **guards("")}, json.dumps(answer).encode())
