"""Where a page is served: its address, port, tokens, certificate, and the name that others know it by."""

import errno
import re
import socket
import ssl
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

from hectorscope.common.paths import is_file
from hectorscope.web.access_control import is_loopback
from slam_core.errors import SlamError

TOKEN = re.compile(r"[A-Za-z0-9_-]{8,128}")
PUBLIC = re.compile(r"https?://[A-Za-z0-9.\-]+(:\d{1,5})?(/[A-Za-z0-9._~\-]+)*/?")
LAST_PORT = 65535


class ServerError(SlamError):
    """The page cannot be served at this address."""


class Certificate(NamedTuple):
    """Files by which a server proves its name: the certificate with those of its issuers, and the private key."""

    chain: Path
    key: Path

    def context(self) -> ssl.SSLContext:
        """For a server; ServerError when the files are of no use."""
        for path in self:
            if not is_file(path):
                raise ServerError(f"{path} is no file: give a certificate and its key in the PEM format")
        made = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        try:
            made.load_cert_chain(self.chain, self.key, password=no_password)
        except (ssl.SSLError, OSError, ValueError) as error:
            reason = getattr(error, "reason", None) or getattr(error, "strerror", None) or error
            raise ServerError(
                f"{self.chain} and {self.key} cannot be used ({reason}): give a certificate and its key in the "
                "PEM format, the key without a password"
            ) from error
        return made


def no_password() -> str:
    """A key that needs one: OpenSSL would ask for it on the terminal."""
    raise ValueError("the key is locked by a password")


@dataclass(frozen=True, slots=True)
class Address:
    """Where a page is served, and who may open it; ServerError for what cannot be.

    An address that others on the network can reach needs a token: 8 to 128 letters, digits, _ or -. viewer_token:
    for who may only look. public: the address at which a reverse proxy offers the page, which needs a token too.
    """

    host: str = "127.0.0.1"
    port: int = 8080
    token: str | None = None
    viewer_token: str | None = None
    certificate: Certificate | None = None
    public: str | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.port <= LAST_PORT:
            raise ServerError(f"port {self.port} does not exist: give 1 to {LAST_PORT}, or 0 for any free one")
        if self.token is None and not is_loopback(self.host):
            raise ServerError(f"{self.host} is open to the network: give a token too, or serve 127.0.0.1")
        if self.public is not None:
            self._check_public(self.public)
        for token, name in ((self.token, "the token"), (self.viewer_token, "the viewers' token")):
            if token is not None and not TOKEN.fullmatch(token):
                raise ServerError(f"{name} has {len(token)} characters: give 8 to 128 letters, digits, _ or -")
        if self.viewer_token is not None and self.token in (None, self.viewer_token):
            raise ServerError("viewers need a token that is not the operator's: give --token as well, another one")

    def _check_public(self, public: str) -> None:
        if not PUBLIC.fullmatch(public):
            raise ServerError(f"{public} is no address of a page: give one like https://station.example/hector/")
        if self.token is None:
            raise ServerError(f"{public} can be opened by others: give a token too")

    @property
    def is_encrypted(self) -> bool:
        """Whether browsers reach the page by https."""
        return self.certificate is not None or (self.public or "").startswith("https:")

    @property
    def public_host(self) -> str:
        """The Host header of a browser that comes by the public address; empty if there is none."""
        return urlsplit(self.public).netloc.lower() if self.public else ""

    def url(self, port: int, token: str | None) -> str:
        """What to open in a browser. port: the one that was got."""
        host = reached_by(self.host)
        name = f"[{host}]" if ":" in host else host
        scheme = "https" if self.certificate else "http"
        start = self.public.rstrip("/") if self.public else f"{scheme}://{name}:{port}"
        return f"{start}/" + (f"?token={token}" if token else "")


# Addresses for documentation, which no machine has (RFC 5737, RFC 3849): packets to them leave it.
ELSEWHERE = {"0.0.0.0": (socket.AF_INET, "192.0.2.1"), "::": (socket.AF_INET6, "2001:db8::1")}


def reached_by(host: str) -> str:
    """The address by which others open what is served at `host`, or where that is all, the name of this machine.

    The system is asked which address packets to the network would have; none is sent.
    """
    if host not in ELSEWHERE:
        return host
    family, elsewhere = ELSEWHERE[host]
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as asked:
            asked.connect((elsewhere, 9))
            found: str = asked.getsockname()[0]
            return found
    except OSError:  # no network
        return socket.gethostname()


def listen(host: str, port: int) -> socket.socket:
    """A listening socket on exactly this address; ServerError when it cannot be had."""
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(address[:2], family=family)
    except socket.gaierror as error:
        raise ServerError(f"host {host!r} is unknown here: give an address of this machine") from error
    except OSError as error:
        if error.errno == errno.EADDRNOTAVAIL:
            raise ServerError(f"host {host} is no address of this machine: give one of its own") from error
        raise ServerError(
            f"port {port} of {host} cannot be had ({error.strerror}): end the other program or give another --port"
        ) from error
