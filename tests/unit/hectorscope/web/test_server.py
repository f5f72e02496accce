"""The page's server from outside: address, port, files."""

import http.client
import re
import socket
from collections.abc import Iterator

import pytest

from hectorscope.web.address import ServerError
from hectorscope.web.server import PageServer
from tests.page import StillEngine, room_snapshot


def get(server: PageServer, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", int(server.url.split(":")[2].split("/")[0]), timeout=10)
    connection.request("GET", path, headers=headers)
    return connection.getresponse()


@pytest.fixture(scope="module")
def page() -> Iterator[PageServer]:
    server = PageServer(StillEngine(room_snapshot()), port=0)
    server.start()
    yield server
    server.stop()


def test_the_page_carries_our_title_style_and_scripts(page: PageServer) -> None:
    """The address gives viser's page under our name, with what static/ adds to it in one file of each kind."""
    body = get(page, "/").read()
    assert b"<title>Hectorscope</title>" in body
    for pattern, name in ((rb'<script defer src="(page/\w+)">', "scene.js"), (rb'href="(page/\w+)">', "xray.css")):
        found = re.search(pattern, body)
        assert found is not None
        answer = get(page, f"/{found[1].decode()}")
        assert answer.headers["Cache-Control"].endswith("immutable")
        assert get(page, f"/static/{name}").read() in answer.read()


def test_it_says_that_it_runs(page: PageServer) -> None:
    """A monitor gets a plain ok."""
    assert get(page, "/healthz").read() == b"ok\n"


def test_every_view_and_panel_works(page: PageServer) -> None:
    """Nothing was switched off."""
    assert page.scene.failures == {}


def test_a_foreign_host_header_is_refused(page: PageServer) -> None:
    """A name rebound to this machine does not get the page."""
    assert get(page, "/", Host="evil.example").status == 421


@pytest.mark.parametrize("port", [-1, 65536, 99999])
def test_a_port_that_does_not_exist_is_refused(port: int) -> None:
    """The system would take another one, by the last 16 bits of the number."""
    with pytest.raises(ServerError, match=rf"port {port} does not exist: give 1 to 65535"):
        PageServer(StillEngine(room_snapshot()), port=port)


def test_a_port_in_use_is_named() -> None:
    """The message says which port, and what to do; the next port is not taken instead."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(ServerError, match=rf"port {port} of 127.0.0.1 .*--port"):
            PageServer(StillEngine(), port=port).start()


def test_the_port_is_free_again_after_stop() -> None:
    """A server that was stopped can be started again on the same port."""
    first = PageServer(StillEngine(), port=0)
    first.start()
    first.stop()
    again = PageServer(StillEngine(), port=int(first.url.split(":")[2].strip("/")))
    again.start()
    again.stop()


def test_the_network_needs_a_token() -> None:
    """An address that others can reach is not served to everybody."""
    with pytest.raises(ServerError, match=r"0\.0\.0\.0 is open to the network: give a token"):
        PageServer(StillEngine(), host="0.0.0.0")


def test_a_weak_token_is_refused() -> None:
    """A short token, or one that a cookie cannot carry, is refused, and not repeated in the message."""
    for token in ("short", "has a space in it"):
        with pytest.raises(ServerError, match="8 to 128 letters"):
            PageServer(StillEngine(), token=token)


def test_an_unknown_host_is_named() -> None:
    """A host that is none is named."""
    with pytest.raises(ServerError, match=r"no-such-host\.invalid"):
        PageServer(StillEngine(), host="no-such-host.invalid", token="long-enough-1").start()
