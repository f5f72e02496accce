"""The page by https, and behind a reverse proxy: a real nginx on a sub-path."""

import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from hectorscope.web.address import Certificate
from hectorscope.web.server import PageServer
from tests.browser.conftest import READY, SIZE, with_query
from tests.certificates import self_signed
from tests.page import StillEngine, room_snapshot

TOKEN = "open-sesame"
NGINX = """
daemon off; pid {folder}/pid; error_log {folder}/errors;
events {{}}
http {{
  access_log off; client_body_temp_path {folder}/body; proxy_temp_path {folder}/proxy;
  fastcgi_temp_path {folder}/fastcgi; uwsgi_temp_path {folder}/uwsgi; scgi_temp_path {folder}/scgi;
  map $http_upgrade $connection_upgrade {{ default upgrade; "" close; }}
  server {{
    listen 127.0.0.1:{port} ssl;
    ssl_certificate {chain}; ssl_certificate_key {key};
    {location}
  }}
}}
"""


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Certificate:
    """One that no browser trusts."""
    return Certificate(*self_signed(tmp_path_factory.mktemp("tls")))


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        return int(taken.getsockname()[1])


def documented(port: int) -> str:
    """The block of docs/station.md, for the page at this port."""
    text = (Path(__file__).parents[2] / "docs" / "station.md").read_text(encoding="utf-8")
    block = text.split("```nginx\n")[1].split("```")[0]
    assert "127.0.0.1:8080" in block
    return block.replace("127.0.0.1:8080", f"127.0.0.1:{port}")


@pytest.fixture
def proxied(certificate: Certificate, tmp_path: Path) -> Iterator[PageServer]:
    """The page at https://127.0.0.1:PORT/hector/, as the documents say."""
    nginx = shutil.which("nginx") or shutil.which("/usr/sbin/nginx")
    if nginx is None:
        pytest.skip("no nginx: apt-get install nginx-light")
    public = free_port()
    server = PageServer(
        StillEngine(room_snapshot()), port=0, token=TOKEN, public=f"https://127.0.0.1:{public}/hector/"
    )
    server.start()
    settings = tmp_path / "nginx.conf"
    location = documented(server.scene.server.get_port())
    settings.write_text(NGINX.format(folder=tmp_path, port=public, location=location, **certificate._asdict()))
    with subprocess.Popen([nginx, "-p", tmp_path, "-c", settings, "-e", tmp_path / "errors"]) as proxy:
        ends = time.monotonic() + 20
        while not (tmp_path / "pid").exists() and proxy.poll() is None and time.monotonic() < ends:
            time.sleep(0.02)
        yield server
        proxy.terminate()
    server.stop()


def opened(browser: Browser, url: str) -> Page:
    """A page of a browser that was told to trust the certificate."""
    page = browser.new_context(viewport=SIZE, ignore_https_errors=True).new_page()
    page.goto(with_query(url))
    page.wait_for_function(READY)
    return page


def cookies(page: Page) -> list[tuple[bool, bool]]:
    """Of each cookie: whether it is for https alone, and out of reach of scripts."""
    return [(bool(kept.get("secure")), bool(kept.get("httpOnly"))) for kept in page.context.cookies()]


def test_a_page_with_a_certificate_comes_by_https(browser: Browser, certificate: Certificate) -> None:
    """The map is drawn, and the cookie with the token is sent by https alone."""
    server = PageServer(StillEngine(room_snapshot()), port=0, token=TOKEN, certificate=certificate)
    server.start()
    try:
        assert server.url.startswith("https://127.0.0.1:")
        page = opened(browser, server.url)
        assert cookies(page) == [(True, True)]
        page.context.close()
    finally:
        server.stop()


def test_the_page_works_behind_a_proxy_on_a_sub_path(browser: Browser, proxied: PageServer) -> None:
    """The printed address is that of the proxy; scene, scripts and lessons come through it."""
    page = opened(browser, proxied.url)
    assert page.url.startswith("https://127.0.0.1:") and "/hector/" in page.url
    assert page.evaluate("fetch('lessons.json').then((answer) => answer.status)") == 200
    assert cookies(page) == [(True, True)]
    # Its address by hand, without the last slash.
    page.goto(page.url.replace("/hector/", "/hector"))
    page.wait_for_function(READY)
    assert "/hector/" in page.url
    page.context.close()


def test_a_stranger_gets_nothing_through_the_proxy(browser: Browser, proxied: PageServer) -> None:
    """Without the token there is no page."""
    context = browser.new_context(ignore_https_errors=True)
    answer = context.new_page().goto(proxied.url.split("?")[0])
    assert answer is not None and answer.status == 401
    context.close()
