"""What the access control decides, request by request."""

import itertools
from dataclasses import replace
from http import HTTPStatus

import pytest

from hectorscope.page.static_files import File
from hectorscope.web.access_control import AccessControl, Reply, host_name, is_loopback

OURS = {"host": "127.0.0.1:8080"}
SOCKET = {**OURS, "upgrade": "websocket"}
FILES = {"/": File("text/html; charset=utf-8", b"<html>page</html>"), "/healthz": File("text/plain", b"ok\n")}
OPEN = AccessControl(FILES)
LOCKED = AccessControl(FILES, token="sesame-1234", cookie="hectorscope_8080", any_host=True)
TAKING = replace(LOCKED, uploads=True)


def status(reply: Reply | None) -> HTTPStatus | None:
    return reply.status if reply else None


def test_the_page_is_served() -> None:
    """The page's own address gives the page, with headers that keep it to itself."""
    reply = OPEN.answer("/", OURS)
    assert reply is not None
    assert (reply.status, reply.body) == (HTTPStatus.OK, b"<html>page</html>")
    assert "frame-ancestors 'self'" in reply.headers["Content-Security-Policy"]
    assert "ws://127.0.0.1:8080" in reply.headers["Content-Security-Policy"]


def test_a_socket_from_our_page_goes_on() -> None:
    """A WebSocket handshake from the page itself is left to the server."""
    assert OPEN.answer("/", {**SOCKET, "origin": "http://127.0.0.1:8080"}) is None


def test_a_program_without_origin_goes_on() -> None:
    """Programs that are no browsers send no Origin and are no victims of other sites."""
    assert OPEN.answer("/", SOCKET) is None


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:9999", "file://127.0.0.1:8080", "http://["]
)
def test_a_socket_from_another_site_is_refused(origin: str) -> None:
    """Another site, another port, a sandboxed frame or a file cannot open the socket."""
    assert status(OPEN.answer("/", {**SOCKET, "origin": origin})) == HTTPStatus.FORBIDDEN


@pytest.mark.parametrize("host", ["evil.example", "evil.example:8080", "127.0.0.1.evil.example", "", "a b"])
def test_a_foreign_host_name_is_refused(host: str) -> None:
    """A name that another site bound to our address does not get the page."""
    assert status(OPEN.answer("/", {"host": host})) == HTTPStatus.MISDIRECTED_REQUEST


@pytest.mark.parametrize("host", ["localhost:8080", "127.0.0.1", "[::1]:8080", "LOCALHOST:1"])
def test_names_of_this_machine_are_ours(host: str) -> None:
    """Every loopback name is served, on any port: a tunnel may forward another one."""
    assert status(OPEN.answer("/", {"host": host})) == HTTPStatus.OK


@pytest.mark.parametrize(
    "query", ["websocket=ws://evil.example", "websocket=", "playbackPath=http://evil/x.viser"]
)
def test_the_page_takes_nothing_from_elsewhere(query: str) -> None:
    """Addresses that make the page run another server's script or scene are refused."""
    assert status(OPEN.answer(f"/?{query}", OURS)) == HTTPStatus.BAD_REQUEST


@pytest.mark.parametrize("path", ["/../gate.py", "/%2e%2e/gate.py", "/static/../app/cli.py", "/etc/passwd"])
def test_only_known_files_are_served(path: str) -> None:
    """Whatever is no file of ours is not found."""
    assert status(OPEN.answer(path, OURS)) == HTTPStatus.NOT_FOUND


def test_health_needs_no_token() -> None:
    """A monitor may ask whether the server runs."""
    assert status(LOCKED.answer("/healthz", {"host": "robot:8080"})) == HTTPStatus.OK


@pytest.mark.parametrize(
    "headers", [{}, {"upgrade": "websocket"}, {"cookie": "hectorscope_8080=wrong"}, {"cookie": ";=;"}]
)
def test_without_the_token_nobody_comes_in(headers: dict[str, str]) -> None:
    """Neither page nor socket without the cookie."""
    refused = HTTPStatus.FORBIDDEN if "upgrade" in headers else HTTPStatus.UNAUTHORIZED
    assert status(LOCKED.answer("/", {"host": "robot:8080", **headers})) == refused


def test_a_wrong_token_gives_no_cookie() -> None:
    """Guessing gets nothing."""
    reply = LOCKED.answer("/?token=guess-5678", {"host": "robot:8080"})
    assert status(reply) == HTTPStatus.UNAUTHORIZED
    assert reply is not None and "Set-Cookie" not in reply.headers


def test_the_token_becomes_a_cookie_that_scripts_cannot_read() -> None:
    """The right token is exchanged for a cookie, and leaves the address bar; the cookie opens the page."""
    reply = LOCKED.answer("/?token=sesame-1234", {"host": "robot:8080"})
    assert reply is not None and reply.status == HTTPStatus.SEE_OTHER
    assert "token" not in reply.headers["Location"]
    cookie = reply.headers["Set-Cookie"]
    assert "HttpOnly" in cookie and "SameSite=Lax" in cookie
    kept = {"host": "robot:8080", "cookie": cookie.split(";")[0]}
    assert status(LOCKED.answer("/", kept)) == HTTPStatus.OK
    assert LOCKED.answer("/", {**kept, "upgrade": "websocket", "origin": "https://robot:8080"}) is None


def test_pages_are_compressed_when_asked() -> None:
    """The page is large: it is sent compressed to who understands it."""
    reply = OPEN.answer("/", {**OURS, "accept-encoding": "gzip, br"})
    assert reply is not None and reply.headers["Content-Encoding"] == "gzip"


def test_host_names() -> None:
    """The name in a Host header, or nothing when it is none."""
    assert [host_name(h) for h in ("a.b:1", "[::1]:80", "[::1]", "a/b", "a:b")] == [
        "a.b",
        "::1",
        "::1",
        None,
        None,
    ]


def test_loopback_names() -> None:
    """Only this machine's own addresses count."""
    assert [is_loopback(n) for n in ("localhost", "127.9.9.9", "::1", "0.0.0.0", "10.0.0.1", "x")] == [
        True
    ] * 3 + [False] * 3


PATHS = (
    "/",
    "/index.html",
    "/healthz",
    "/static/x.js",
    "//",
    "/.",
    "/%2f",
    "/healthz/",
    "/?",
    "/healthz?x=/",
    "/upload",
    "/upload?x=/",
    "/upload/",
    "//upload",
    "/%75pload",
    "*",
    "",
)
UPGRADES = (None, "websocket", "WebSocket", "h2c", "websocket, h2c", "")
COOKIES = (None, "hectorscope_8080=sesame-1234", "hectorscope_8080=wrong-1234", "other=sesame-1234")
ORIGINS = (None, "http://robot:8080", "https://robot:8080", "http://evil.example", "null")
HOSTS = ("robot:8080", "127.0.0.1:8080", "evil example", "")


@pytest.mark.parametrize("access", [OPEN, LOCKED, TAKING], ids=["open", "locked", "taking"])
def test_a_socket_is_opened_for_one_kind_of_request_only(access: AccessControl) -> None:
    """Of every path, upgrade, cookie, origin and host: from our host and origin, with the token if any.

    At "/", and at "/upload" if the server takes recordings.
    """
    opened = set()
    for path, upgrade, cookie, origin, host in itertools.product(PATHS, UPGRADES, COOKIES, ORIGINS, HOSTS):
        given = {"upgrade": upgrade, "cookie": cookie, "origin": origin, "host": host}
        reply = access.answer(path, {name: value for name, value in given.items() if value is not None})
        if reply is None:
            opened.add((path, upgrade, cookie, origin, host))
        elif upgrade is not None:
            assert reply.status >= HTTPStatus.BAD_REQUEST, (path, given)
        elif access.token and reply.status == HTTPStatus.OK:
            assert path.partition("?")[0] == "/healthz" or cookie == COOKIES[1], (path, given)
    hosts = ("robot:8080", "127.0.0.1:8080") if access.any_host else ("127.0.0.1:8080",)
    cookies = COOKIES[1:2] if access.token else COOKIES
    assert opened == {
        (path, upgrade, cookie, origin, host)
        for path in ("/", "/?", *(("/upload", "/upload?x=/") if access.uploads else ()))
        for upgrade in ("websocket", "WebSocket")
        for cookie in cookies
        for host in hosts
        for origin in (None, f"http://{host}", f"https://{host}")
        if origin in ORIGINS
    }


@pytest.mark.parametrize(
    "target",
    [
        "/%0d%0aSet-Cookie:x?token=sesame-1234",
        "/https:evil.example?token=sesame-1234",
        "//evil.example/?token=sesame-1234",
        "/\\evil.example?token=sesame-1234",
        "/healthz/..//evil.example?token=sesame-1234",
    ],
)
def test_a_token_redirects_nowhere_but_to_the_page(target: str) -> None:
    """At other paths the token in the address is ignored; no reply sends a browser to another site."""
    reply = LOCKED.answer(target, {"host": "robot:8080"})
    assert reply is not None and reply.status == HTTPStatus.UNAUTHORIZED
    assert "Location" not in reply.headers
    page = LOCKED.answer("/?token=sesame-1234", {"host": "robot:8080"})
    assert page is not None and page.headers["Location"] == "./"


def test_a_file_that_never_changes_is_kept_by_browsers() -> None:
    """Others are asked for again each time; what a proxy shares between people is neither."""
    files = {"/a": File("text/css", b"a", lasting=True), "/b": File("text/css", b"b")}
    kept, asked = (AccessControl(files).answer(path, {"host": "localhost"}) for path in files)
    assert kept
    assert asked
    assert kept.headers["Cache-Control"] == "private, max-age=31536000, immutable"
    assert asked.headers["Cache-Control"] == "no-cache"
