"""The connection to a live server: what cannot work is told at once, what may come back is waited for."""

import base64
import hashlib
import re
import socket
import threading
from collections.abc import Callable
from itertools import islice
from typing import Any

import pytest

from hectorscope.inputs import SourceError
from hectorscope.sources import _websocket
from hectorscope.sources._websocket import LARGEST_FRAME, Link
from hectorscope.sources.foxglove import PEER


def closed_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def answering_once(reply: bytes) -> int:
    """The port of a plain TCP server that answers one caller with `reply`."""
    listener = socket.create_server(("127.0.0.1", 0))

    def answer() -> None:
        caller, _ = listener.accept()
        with listener, caller:
            caller.recv(4096)
            caller.sendall(reply)

    threading.Thread(target=answer, daemon=True).start()
    return int(listener.getsockname()[1])


@pytest.mark.parametrize(
    "uri", ["ws://", "http://127.0.0.1:8765", "ws://127.0.0.1:notaport", "ws://127.0.0.1:70000"]
)
def test_bad_address_is_refused_with_the_form_of_a_good_one(uri: str) -> None:
    """An address that is no WebSocket address is an error that shows what one looks like."""
    with pytest.raises(SourceError, match=r"is no address of this kind: give ws://HOST:PORT"):
        Link(uri, PEER)


def test_impossible_host_is_refused() -> None:
    """A host name that cannot be one is told without asking the network."""
    with pytest.raises(SourceError, match=r"names no possible host"):
        Link("ws://robot..local:8765", PEER)


def test_web_server_is_refused() -> None:
    """A web server's answer is named by its status, with what was expected."""
    port = answering_once(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n")
    with pytest.raises(SourceError, match=r"HTTP status 404: it must be a Foxglove WebSocket server"):
        Link(f"ws://127.0.0.1:{port}", PEER)


def test_something_that_is_no_web_server_is_refused() -> None:
    """A service that does not speak HTTP at all is told apart from silence."""
    port = answering_once(b"SSH-2.0-OpenSSH_9.2\r\n")
    with pytest.raises(SourceError, match=r"does not greet like a WebSocket server"):
        Link(f"ws://127.0.0.1:{port}", PEER)


@pytest.mark.parametrize("protocol", [None, "rosbridge"])
def test_websocket_server_of_another_kind_is_refused(scripted: Callable[..., Any], protocol: str | None) -> None:
    """A WebSocket server that takes neither of the two sub-protocols is not listened to."""
    with pytest.raises(SourceError, match=r"it must be a Foxglove WebSocket server"):
        Link(scripted([], protocol=protocol).uri, PEER)


def test_plain_server_behind_a_secure_address_is_refused(scripted: Callable[..., Any]) -> None:
    """wss:// to a server without TLS says which address would do."""
    uri = scripted([]).uri.replace("ws://", "wss://")
    with pytest.raises(SourceError, match=r"does not speak TLS: give ws://"):
        Link(uri, PEER)


@pytest.mark.parametrize("protocol", ["foxglove.sdk.v1", "foxglove.websocket.v1"])
def test_both_subprotocols_are_spoken(scripted: Callable[..., Any], protocol: str) -> None:
    """Servers of the old and of the new name are understood."""
    link = Link(scripted(["hello"], protocol=protocol).uri, PEER)
    (frames,) = islice(link.connections(), 1)
    assert next(frames) == "hello"
    link.close()


def test_absent_server_is_waited_for(scripted: Callable[..., Any]) -> None:
    """A refused connection is no error: the link says why it waits, and closing it ends the wait."""
    link = Link(f"ws://127.0.0.1:{closed_port()}", PEER)
    assert "start the bridge" in link.status
    threading.Timer(0.6, link.close).start()
    assert list(link.connections()) == []


def test_lost_connection_is_made_again(scripted: Callable[..., Any]) -> None:
    """Each time that the server hangs up, the next connection follows, and the status tells the loss."""
    server = scripted(["hello"], answers={"bye": ["x" * (LARGEST_FRAME + 1)]})
    link = Link(server.uri, PEER)
    statuses = []
    for frames in islice(link.connections(), 3):
        assert next(frames) == "hello"
        statuses.append(link.status)
        link.send("bye")  # brings a frame beyond the limit, which ends the connection
        assert list(frames) == []
        statuses.append(link.status)
    link.close()
    assert statuses[::2] == ["", "", ""]
    assert all("lost the connection" in status for status in statuses[1::2])


def stalling(frame: bytes) -> int:
    """The port of a server that greets every caller like a bridge, sends `frame`, and says nothing any more."""
    listener = socket.create_server(("127.0.0.1", 0))
    callers: list[socket.socket] = []

    def answer() -> None:
        while True:
            callers.append(listener.accept()[0])
            key = re.search(rb"Sec-WebSocket-Key: (\S+)", callers[-1].recv(4096))
            assert key is not None
            proof = base64.b64encode(hashlib.sha1(key[1] + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest())
            callers[-1].sendall(
                b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                b"Sec-WebSocket-Protocol: foxglove.sdk.v1\r\nSec-WebSocket-Accept: " + proof + b"\r\n\r\n" + frame
            )

    threading.Thread(target=answer, daemon=True).start()
    return int(listener.getsockname()[1])


@pytest.mark.parametrize("frame", [b"", b"\x82\x7e\xff\xff" + bytes(100)], ids=["at once", "in a frame"])
def test_a_link_that_stalls_is_made_again(
    frame: bytes,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Silence, also within a frame, counts as a loss after a while; nothing is printed."""
    monkeypatch.setattr(_websocket, "PING_INTERVAL_S", 0.1)
    monkeypatch.setattr(_websocket, "PING_TIMEOUT_S", 0.2)
    link = Link(f"ws://127.0.0.1:{stalling(frame)}", PEER)
    for frames in islice(link.connections(), 2):
        assert list(frames) == []
        assert "lost the connection to" in link.status
    link.close()
    assert not caplog.records
    assert "Traceback" not in "".join(capfd.readouterr())
