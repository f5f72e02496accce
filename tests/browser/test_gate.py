"""The gate in front of a real browser."""

import http.server
import threading
import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from hectorscope.web.server import PageServer
from tests.browser.conftest import Open, Show
from tests.page import StillEngine, room_snapshot

pytestmark = pytest.mark.browser

PATIENCE_S = 30.0
SAY = "(message) => window.__viserMutable.sendMessage(message)"
KNOCK = """(address) => new Promise((tell) => {
  const socket = new WebSocket(address, 'viser-v1.1.1');
  socket.onopen = () => tell('open');
  socket.onerror = () => tell('refused');
})"""


@pytest.fixture
def elsewhere() -> Iterator[str]:
    """Address of another site."""

    class Blank(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"<title>elsewhere</title>")

        def log_message(self, *_: object) -> None:
            """Say nothing."""

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Blank)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


def test_another_site_cannot_open_the_socket(show: Show, browser: Browser, elsewhere: str) -> None:
    """A page from another origin is refused; the page's own socket is open to itself."""
    context = browser.new_context()
    page = context.new_page()
    page.goto(elsewhere)
    assert page.evaluate(KNOCK, show.url.replace("http", "ws")) == "refused"
    page.goto(show.url)
    assert page.evaluate(KNOCK, show.url.replace("http", "ws")) == "open"
    context.close()


def settled(page: Page, show: Show) -> None:
    """Wait until the server has handled all messages of the page: they come in order, and this is the last."""
    probe = show.server.scene.server.gui.add_slider("last", 0.0, 1.0, 0.1, 0.0)
    page.wait_for_function("document.body.innerText.includes('last')")
    page.evaluate(SAY, {"type": "GuiUpdateMessage", "uuid": probe._impl.uuid, "updates": {"value": 1.0}})
    deadline = time.monotonic() + PATIENCE_S
    while probe.value != 1.0 and time.monotonic() < deadline:
        page.evaluate("0")
    assert probe.value == 1.0


def test_values_out_of_range_are_clamped(show: Show, open_page: Open) -> None:
    """A slider told to go beyond its end stops there, and the settings stay in their range."""
    slider = show.server.scene.server.gui.add_slider("probe", 0.0, 1.0, 0.1, 0.3)
    page = open_page(show.url)
    page.evaluate(SAY, {"type": "GuiUpdateMessage", "uuid": slider._impl.uuid, "updates": {"value": 1e9}})
    settled(page, show)
    assert slider.value == 1.0


def test_internals_and_tunnels_are_out_of_reach(show: Show, open_page: Open) -> None:
    """A page that speaks viser's protocol by itself changes no scene and opens no tunnel."""
    page = open_page(show.url)
    page.evaluate(SAY, {"type": "ShareUrlRequest"})
    page.evaluate(SAY, {"type": "SceneNodeUpdateMessage", "name": "/robot", "updates": {}, "owner": ""})
    settled(page, show)
    assert show.server.scene.server._share_tunnel is None
    assert len(show.server.scene.server.get_clients()) == 1


def test_the_page_cannot_be_pointed_elsewhere(show: Show, browser: Browser) -> None:
    """An address with another server in it is answered by an error."""
    context = browser.new_context()
    answer = context.new_page().goto(f"{show.url}?websocket=ws://evil.example")
    assert answer is not None and answer.status == 400
    context.close()


def test_a_token_opens_the_page_and_leaves_the_address(open_page: Open, browser: Browser) -> None:
    """With the token the page works and scripts cannot see it; without it there is no page."""
    server = PageServer(StillEngine(room_snapshot()), port=0, token="open-sesame")
    server.start()
    try:
        page = open_page(server.url)
        assert "token" not in page.url
        assert "open-sesame" not in page.evaluate("document.cookie")
        context = browser.new_context()
        answer = context.new_page().goto(server.url.split("?")[0])
        assert answer is not None and answer.status == 401
        context.close()
    finally:
        server.stop()
