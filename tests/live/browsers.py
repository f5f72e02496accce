"""Browsers without a screen: they open the page's WebSocket as a page does, and read what comes, or less."""

import socket
import threading
from contextlib import suppress

import msgspec.msgpack
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    **{name: [0.0, 0.0, 1.0] for name in ("position", "look_at", "up_direction")},
    **dict.fromkeys(("fov", "near", "far"), 1.0),
    **dict.fromkeys(("image_height", "image_width"), 600),
}
SMALL = 4096  # bytes that a machine receives for a browser that does not read


class Client:
    """A browser in front of the page at a port. pace: seconds that it rests after each message; None: never reads.

    received: bytes so far. ended: once the connection is gone.
    """

    def __init__(self, port: int, pace: float | None = 0.0, cookie: str = "") -> None:
        self.received, self.ended = 0, threading.Event()
        raw = socket.create_connection(("127.0.0.1", port))
        if pace != 0.0:
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SMALL)
        self._pace = pace
        self._link: ClientConnection = connect(
            f"ws://127.0.0.1:{port}/",
            sock=raw,
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            additional_headers={"Cookie": cookie} if cookie else None,
            compression=None,
            max_size=None,
            max_queue=16 if pace == 0.0 else 1,
            ping_interval=None,
            close_timeout=0.1,
        )
        self._link.send(msgspec.msgpack.encode(CAMERA))
        if pace is not None:
            threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        with suppress(ConnectionClosed):
            for message in self._link:
                self.received += len(message)
                if self._pace:
                    threading.Event().wait(self._pace)
        self.ended.set()

    def close(self) -> None:
        """Go away."""
        self._link.close()
