"""Access control of the server: who gets the page, and who may open its WebSocket.

viser has no login, checks neither Origin nor Host, and accepts every value that a browser sends. Every request
comes here first. All of them are answered here but one kind: a WebSocket of our own page, which `admits_socket`
decides. It refuses whatever it does not know. `messages.py` then passes on what the controls of the page need.
"""

import hmac
import ipaddress
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from typing import Literal
from urllib.parse import parse_qs, unquote, urlsplit

from hectorscope.page.static_files import File

HOST = re.compile(r"(?P<name>[A-Za-z0-9.\-]+|\[[0-9A-Fa-f:.]+\])(:\d+)?")
FORBIDDEN_QUERIES = ("websocket", "playbackPath")  # they make the page take scripts or scenes from elsewhere
HEALTH = "/healthz"  # open to anybody: reports only that the server runs
PAGE = ("/", "/index.html")
LASTING = "private, max-age=31536000, immutable"
SOCKET = "/"  # where the page's WebSocket is opened
UPLOAD = "/upload"  # where one for a recording is opened, if the server takes any; there is no third
NO_SOCKET = "No WebSocket is opened here.\n"
FOREIGN_HOST = "Unknown host name: use the address that was printed when the program started.\n"
FOREIGN_ORIGIN = "Requests from other sites are refused.\n"
FOREIGN_SERVER = "This page shows its own server only.\n"
NO_TOKEN = "This page needs the whole address, with its token: it was printed when the program started.\n"


Role = Literal["operator", "viewer"]


@dataclass(frozen=True, slots=True)
class Reply:
    """An HTTP answer."""

    status: HTTPStatus
    headers: Mapping[str, str] = field(default_factory=dict)
    body: bytes = b""


@dataclass(frozen=True, slots=True)
class AccessControl:
    """Decides over HTTP requests. `files` is everything that is served, by path; "/" is the page.

    token: None lets everybody in who can reach a loopback address. viewer_token: lets in who may only look; None
    lets nobody in so. answers: makes what changes, by path, for a role. any_host: the server is reachable by names
    that it cannot know, so the Host header is not checked (the token then is what protects it). public_host: the
    name, with its port, by which browsers come through a reverse proxy. encrypted: they come by https, so that the
    cookie is for that alone. uploads: whether recordings are taken.
    """

    files: Mapping[str, File]
    token: str | None = None
    cookie: str = "hectorscope"
    any_host: bool = False
    public_host: str = ""
    encrypted: bool = False
    uploads: bool = False
    viewer_token: str | None = None
    answers: Mapping[str, Callable[[Role], File]] = field(default_factory=dict)

    def answer(self, target: str, headers: Mapping[str, str]) -> Reply | None:
        """The reply to a request for `target`; None: a WebSocket is opened. Header names in lower case."""
        path, _, query = target.partition("?")
        fields, host = parse_qs(query, keep_blank_values=True), headers.get("host", "")
        for refused, status, text in (
            (not self.is_our_host(host), HTTPStatus.MISDIRECTED_REQUEST, FOREIGN_HOST),
            (not is_same_origin(headers.get("origin"), host), HTTPStatus.FORBIDDEN, FOREIGN_ORIGIN),
            (any(name in fields for name in FORBIDDEN_QUERIES), HTTPStatus.BAD_REQUEST, FOREIGN_SERVER),
        ):
            if refused:
                return plain(status, text)
        if "upgrade" in headers:
            return None if self.admits_socket(path, headers) else plain(HTTPStatus.FORBIDDEN, NO_SOCKET)
        if path in PAGE and self.token is not None and "token" in fields:
            return self._exchange(fields["token"][0])
        role = self.role(headers.get("cookie", ""))
        if path in self.answers and role is None:  # monitors bring no cookies
            role = self._role_of(headers.get("authorization", "").removeprefix("Bearer "))
        if path != HEALTH and role is None:
            return plain(HTTPStatus.UNAUTHORIZED, NO_TOKEN)
        if path in self.answers and role is not None:
            return self._made(self.answers[path](role))
        return self._serve(unquote(path), headers)

    def admits_socket(self, path: str, headers: Mapping[str, str]) -> bool:
        """Whether a WebSocket is opened: at two paths, from our host and origin, with the token; else refused."""
        host = headers.get("host", "")
        return (
            (path == SOCKET or (path == UPLOAD and self.uploads))
            and headers.get("upgrade", "").strip().lower() == "websocket"
            and self.is_our_host(host)
            and is_same_origin(headers.get("origin"), host)
            and self.role(headers.get("cookie", ""))
            in (("operator",) if path == UPLOAD else ("operator", "viewer"))
        )

    def is_our_host(self, host: str) -> bool:
        """Whether the Host header names this machine; a foreign name is another site's, bound to our address."""
        name = host_name(host)
        return name is not None and (self.any_host or is_loopback(name) or host.lower() == self.public_host)

    def role(self, cookies: str) -> Role | None:
        """What the token in the cookie allows; None: nothing at all."""
        if self.token is None:
            return "operator"
        try:
            morsel = SimpleCookie(cookies).get(self.cookie)
        except CookieError:
            return None
        return None if morsel is None else self._role_of(morsel.value)

    def _role_of(self, token: str) -> Role | None:
        """Both are compared in any case, so that the time that it takes tells nothing."""
        may_act, may_look = (
            known is not None and hmac.compare_digest(token.encode(), known.encode())
            for known in (self.token, self.viewer_token)
        )
        return "operator" if may_act else "viewer" if may_look else None

    def _exchange(self, token: str) -> Reply:
        """Token for cookie: the token leaves the address bar, and scripts cannot read the cookie."""
        if self._role_of(token) is None:
            return plain(HTTPStatus.UNAUTHORIZED, NO_TOKEN)
        cookie = f"{self.cookie}={token}; HttpOnly; SameSite=Lax; Path=/" + ("; Secure" if self.encrypted else "")
        return Reply(HTTPStatus.SEE_OTHER, {"Location": "./", "Set-Cookie": cookie, **guards("")})

    def _made(self, file: File) -> Reply:
        sent = {"Content-Type": file.kind, "Cache-Control": "no-store", **guards("")}
        return Reply(HTTPStatus.OK, sent, file.content)

    def _serve(self, path: str, headers: Mapping[str, str]) -> Reply:
        found = self.files.get("/" if path == "/index.html" else path)
        if found is None:
            return plain(HTTPStatus.NOT_FOUND, "Not found.\n")
        keep = LASTING if found.lasting else "no-cache"
        sent = {"Content-Type": found.kind, "Cache-Control": keep, **guards(headers.get("host", ""))}
        if "gzip" in headers.get("accept-encoding", ""):
            return Reply(HTTPStatus.OK, {**sent, "Content-Encoding": "gzip"}, found.zipped)
        return Reply(HTTPStatus.OK, sent, found.content)


def host_name(host: str) -> str | None:
    """The name in a Host header, without port and brackets; None when it is none."""
    found = HOST.fullmatch(host)
    return found["name"].strip("[]").lower() if found else None


def is_loopback(name: str) -> bool:
    """Whether a host name or address means this machine alone."""
    if name == "localhost":
        return True
    try:
        return ipaddress.ip_address(name).is_loopback
    except ValueError:
        return False


def is_same_origin(origin: str | None, host: str) -> bool:
    """Browsers send Origin on every WebSocket; programs that are no browsers need none."""
    try:
        return origin is None or (origin.startswith(("http://", "https://")) and urlsplit(origin).netloc == host)
    except ValueError:  # an address of no form, as http://[
        return False


def guards(host: str) -> dict[str, str]:
    """The headers that keep the page to itself: own scripts, own socket, no frames around it."""
    sockets = f"ws://{host} wss://{host}" if host else ""
    policy = (
        "default-src 'none'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; worker-src 'self' blob:; "
        "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; "
        f"connect-src 'self' data: blob: {sockets}; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
    )
    return {
        "Content-Security-Policy": policy,
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Resource-Policy": "same-origin",
    }


def plain(status: HTTPStatus, text: str) -> Reply:
    """A line of text."""
    return Reply(status, {"Content-Type": "text/plain; charset=utf-8", **guards("")}, text.encode())
