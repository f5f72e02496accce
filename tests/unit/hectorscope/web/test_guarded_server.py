"""A running server: sockets without the token, and requests that are not HTTP."""

import asyncio
import itertools
import json
import random
import socket
import threading
from collections.abc import Iterator

import msgspec.msgpack
import pytest
import viser
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.typing import Subprotocol

from hectorscope.page.static_files import File
from hectorscope.web.access_control import AccessControl
from hectorscope.web.address import listen
from hectorscope.web.guarded_server import open_server, stop_server
from hectorscope.web.uploads import Uploads

TOKEN = "open-sesame"
LIMIT = 3 * 2**20  # bytes of recordings
ARRIVED: list[tuple[bytes, str]] = []
CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    **{name: [0.0, 0.0, 1.0] for name in ("position", "look_at", "up_direction")},
    **dict.fromkeys(("fov", "near", "far"), 1.0),
    **dict.fromkeys(("image_height", "image_width"), 600),
}


@pytest.fixture(scope="module")
def locked() -> Iterator[viser.ViserServer]:
    """A server that asks for a token."""
    access = AccessControl({"/healthz": File("text/plain", b"ok")}, token=TOKEN, uploads=True)
    uploads = Uploads(LIMIT, lambda path, name: ARRIVED.append((path.read_bytes(), name)))
    made = open_server(listen("127.0.0.1", 0), access, uploads)
    yield made
    stop_server(made)
    uploads.close()


def knock(server: viser.ViserServer, path: str, cookie: str = "") -> int:
    """The status of a handshake: 101 if the socket opens."""

    async def handshake() -> int:
        headers = {"Cookie": cookie} if cookie else {}
        address = f"ws://127.0.0.1:{server.get_port()}{path}"
        try:
            async with connect(address, subprotocols=[f"viser-v{viser.__version__}"], additional_headers=headers):  # type: ignore[list-item]
                return 101
        except InvalidStatus as refused:
            return refused.response.status_code

    return asyncio.run(handshake())


@pytest.mark.parametrize("path", ["/", "/healthz", "/index.html", "/anything"])
def test_no_path_opens_a_socket_without_the_token(locked: viser.ViserServer, path: str) -> None:
    """Not even the one that answers monitors without a token."""
    assert knock(locked, path) == 403
    assert locked.get_clients() == {}


def test_the_cookie_opens_the_socket_at_one_path(locked: viser.ViserServer) -> None:
    """At "/" with the token, and nowhere else."""
    cookie = f"hectorscope={TOKEN}"
    assert knock(locked, "/", cookie) == 101
    assert knock(locked, "/healthz", cookie) == 403


@pytest.mark.parametrize(
    "request_",
    [
        b"\x00\xff\r\n\r\n",
        b"POST / HTTP/1.1\r\n\r\n",
        b"GET / HTTP/1.1\r\nbad header\r\n\r\n",
        b"GET  HTTP/1.1\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET /" + b"x" * 20_000 + b" HTTP/1.1\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 500 + b"\r\n",
        b"GET / HTTP/1.1\r\nHost: \xff\xfe\r\nCookie: \xff\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\nUpgrade: websocket\r\nUpgrade: websocket\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -5\r\n\r\n",
    ],
)
def test_what_is_not_http_is_refused_without_a_traceback(
    locked: viser.ViserServer, request_: bytes, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    """The connection is closed, nothing is printed, and the server goes on."""
    with socket.create_connection(("127.0.0.1", locked.get_port()), timeout=10) as peer:
        peer.sendall(request_)
        peer.settimeout(10)
        while peer.recv(4096):
            pass
    assert not caplog.records
    assert "Traceback" not in capfd.readouterr().err
    assert knock(locked, "/") == 403


BAD_MESSAGES = (
    b"",
    b"\xc1",
    b"\x91" * 60_000,  # a list in a list in a list
    msgspec.msgpack.encode([1, 2]),
    msgspec.msgpack.encode({"type": ["ViewerCameraMessage"]}),
    msgspec.msgpack.encode({**CAMERA, "position": "here"}),
    msgspec.msgpack.encode({**CAMERA, "wxyz": [None] * 4}),
    msgspec.msgpack.encode({**CAMERA, "more": 1}),
    msgspec.msgpack.encode({"type": "GuiButtonHoldMessage", "uuid": [], "frequency": {}}),
    msgspec.msgpack.encode({"type": "CommandTriggerMessage"}),
    "text",
)


def test_ill_typed_messages_end_in_no_traceback(
    locked: viser.ViserServer, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    """They are dropped one by one; the camera behind them is taken, and makes the browser a client."""
    seen = threading.Event()
    locked.on_client_connect(lambda _: seen.set())

    async def talk() -> bool:
        address = f"ws://127.0.0.1:{locked.get_port()}/"
        protocols, cookie = [Subprotocol(f"viser-v{viser.__version__}")], {"Cookie": f"hectorscope={TOKEN}"}
        async with connect(address, subprotocols=protocols, additional_headers=cookie) as socket_:
            for message in (*BAD_MESSAGES, msgspec.msgpack.encode(CAMERA)):
                await socket_.send(message)
            return await asyncio.to_thread(seen.wait, 30)

    assert asyncio.run(talk())
    assert not caplog.records
    assert "Traceback" not in "".join(capfd.readouterr())


@pytest.mark.parametrize(
    "target",
    [
        f"/%0d%0a?token={TOKEN}",
        f"/https:evil.example?token={TOKEN}",
        f"//evil.example?token={TOKEN}",
        f"https://evil.example/?token={TOKEN}",
        "/?token=%ff%00",
        "/?token=" + "x" * 4000,
        "/%ff%fe",
    ],
)
def test_strange_addresses_are_refused(locked: viser.ViserServer, target: str) -> None:
    """No error within the server, and no way to another site, whoever has the token."""
    with socket.create_connection(("127.0.0.1", locked.get_port()), timeout=10) as peer:
        peer.sendall(f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1:{locked.get_port()}\r\n\r\n".encode())
        reply = b"".join(iter(lambda: peer.recv(4096), b""))
    assert reply.startswith(b"HTTP/1.1 401 ")
    assert b"Location" not in reply and b"Set-Cookie" not in reply


ABSENT = ""
REQUESTS = {
    "path": ("/", "/healthz", "/index.html", "//", "/%2f", "/anything", "/upload", "/upload/"),
    "method": ("GET", "POST", "PUT"),
    "upgrade": (ABSENT, "websocket", "h2c"),
    "cookie": (ABSENT, f"hectorscope={TOKEN}", "hectorscope=wrong"),
    "origin": (ABSENT, "http://OWN", "http://evil.example", "null"),
    "host": ("OWN", "evil.example", ABSENT),
}


def ask(port: int, path: str, method: str, *values: str) -> int:
    """The status of a request with these headers; 0 if the connection is closed without one. OWN: the address."""
    names = ("Upgrade", "Cookie", "Origin", "Host")
    lines = [f"{method} {path} HTTP/1.1", "Connection: Upgrade", "Sec-WebSocket-Version: 13"]
    lines += ["Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="]
    lines += [f"{name}: {value}" for name, value in zip(names, values, strict=True) if value]
    text = "\r\n".join([*lines, "", ""]).replace("OWN", f"127.0.0.1:{port}")
    with socket.create_connection(("127.0.0.1", port), timeout=5) as link:
        link.sendall(text.encode())
        status = link.recv(12)
    return int(status[9:12]) if status else 0


def expected(path: str, method: str, upgrade: str, cookie: str, origin: str, host: str) -> int:
    """The table of answers, from the top: the first line that fits."""
    token = cookie == f"hectorscope={TOKEN}"
    table = (
        (method != "GET", 0),
        (host != "OWN", 421),
        (origin not in (ABSENT, "http://OWN"), 403),
        (upgrade == "websocket" and path in ("/", "/upload") and token, 101),
        (upgrade != ABSENT, 403),
        (path == "/healthz", 200),
        (not token, 401),
        (True, 404),
    )
    return next(status for fits, status in table if fits)


def test_the_table_of_answers(locked: viser.ViserServer) -> None:
    """Every path, method, upgrade, cookie, Origin and Host: two kinds of requests open a socket."""
    requests = list(itertools.product(*REQUESTS.values()))
    answers = {request: ask(locked.get_port(), *request) for request in requests}
    assert answers == {request: expected(*request) for request in requests}


def upload(port: int, name: str, content: bytes, piece: int = 60 * 1024) -> list[dict[str, str]]:
    """The answers to a recording that is sent as the page does."""

    async def talk() -> list[dict[str, str]]:
        address, cookie = f"ws://127.0.0.1:{port}/upload", {"Cookie": f"hectorscope={TOKEN}"}
        async with connect(address, additional_headers=cookie) as link:
            await link.send(json.dumps({"name": name, "size": len(content)}))
            answers = [json.loads(await link.recv())]
            if "send" in answers[0]:
                for at in range(0, len(content), piece):
                    await link.send(content[at : at + piece])
                answers.append(json.loads(await link.recv()))
            return answers

    return asyncio.run(talk())


def test_a_recording_is_taken_within_the_limit(locked: viser.ViserServer) -> None:
    """Byte by byte as it was sent; what is beyond the limit is refused before it is sent."""
    content = random.Random(1).randbytes(2 * 2**20 + 17)
    assert upload(locked.get_port(), "run.bag", content)[-1] == {"arrived": "run.bag"}
    assert [(content, "run.bag")] == ARRIVED
    (refused,) = upload(locked.get_port(), "more.bag", content)
    assert "2.0 MiB, and 1.0 MiB of 3.0 MiB are left" in refused["refused"]


def test_a_message_that_is_too_long_ends_the_upload(
    locked: viser.ViserServer, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    """Nobody makes the server keep more than a piece in memory; nothing is printed, and it goes on."""
    with pytest.raises(ConnectionClosed):
        upload(locked.get_port(), "run.bag", bytes(300 * 1024), piece=300 * 1024)
    assert upload(locked.get_port(), "run.bag", bytes(9))[-1] == {"arrived": "run.bag"}
    assert not caplog.records
    assert "Traceback" not in "".join(capfd.readouterr())
