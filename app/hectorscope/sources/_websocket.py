"""A connection to a WebSocket server that is made again whenever it is lost."""

import re
import socket
import ssl
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from websockets.exceptions import (
    ConnectionClosed,
    InvalidHandshake,
    InvalidMessage,
    InvalidStatus,
    InvalidURI,
    WebSocketException,
)
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol
from websockets.uri import parse_uri

from hectorscope.common.terminal import silent_logger
from hectorscope.inputs import LinkOptions, SourceError
from hectorscope.sources._backoff import FIRST_PAUSE_S, longer

CONNECT_TIMEOUT_S = 5.0
PING_INTERVAL_S, PING_TIMEOUT_S = 5.0, 10.0  # without an answer the link counts as lost
# A robot with hundreds of topics sends megabytes of definitions in one frame; nothing honest is larger.
LARGEST_FRAME = 32 * 2**20


@dataclass(frozen=True, slots=True)
class Peer:
    """What a link looks for. what: the kind of server. remedy: what to do where none listens.

    addresses: the forms of its addresses, without TLS and with it. subprotocols: offered to it; one has to be
    chosen if there are any.
    """

    what: str
    remedy: str
    addresses: tuple[str, str]
    subprotocols: Sequence[Subprotocol] = ()


HEADER = re.compile(r"[A-Za-z0-9!#$%&'*+.^_`|~-]+")
_FAILURES = (OSError, WebSocketException, UnicodeError)
# Errors with their remedies; the first kind that fits is reported.
_REMEDIES: tuple[tuple[type[Exception], str], ...] = (
    (InvalidURI, "{uri} is no address of this kind: give {forms}"),
    (UnicodeError, "{uri} names no possible host: give {forms}"),
    (socket.gaierror, "the host of {uri} is not known: check its spelling, or give its number"),
    (ConnectionRefusedError, "nothing listens at {uri}: {peer.remedy}"),
    (TimeoutError, "{uri} does not answer: check that the host is up and the port is open"),
    (
        ssl.SSLCertVerificationError,
        "the certificate of {uri} is not trusted ({error.verify_message}): name its issuer by --ca",
    ),
    (ssl.SSLError, "{uri} does not speak TLS: give {peer.addresses[0]}"),
    (InvalidStatus, "{uri} answers with HTTP status {error.response.status_code}: it must be {peer.what}"),
    (
        InvalidMessage,
        "{uri} does not greet like a WebSocket server (with a certificate: {peer.addresses[1]}):"
        " it must be {peer.what}",
    ),
    (InvalidHandshake, "{uri} speaks another protocol: it must be {peer.what}"),
)
_REMEDY = "{uri} cannot be reached ({error}): check the network"


class Link:
    """One connection after another to the same address, until `close`.

    status: why nothing flows right now; empty while connected.
    """

    def __init__(
        self, uri: str, peer: Peer, patience: float | None = None, options: LinkOptions | None = None
    ) -> None:
        """Try once: SourceError if waiting would not help, as with a wrong address or another protocol.

        patience: seconds of silence after which an empty frame is handed out, for who has something to ask again.
        """
        self.uri, self._peer, self._patience = uri, peer, patience
        self._options = options or LinkOptions()
        check_options(uri, self._options)
        self.status = ""
        self._closed = threading.Event()
        self._connection: ClientConnection | None = None
        try:
            self._connection = _connect(uri, peer, self._options)
        except _FAILURES as error:
            if _is_final(error):
                raise SourceError(self._explain(error)) from error
            self.status = self._explain(error)

    @property
    def round_trip_s(self) -> float:
        """Of the last ping over the connection; 0 before the first."""
        return self._connection.latency if self._connection else 0.0

    def connections(self) -> Iterator[Iterator[str | bytes]]:
        """The frames of every connection that is made; between two of them the pauses grow up to a limit."""
        pause = 0.0
        while not self._closed.wait(pause):
            connection = self._connection or self._reconnect(pause)
            if connection is None:
                pause = longer(pause)
                continue
            pause = FIRST_PAUSE_S
            yield self._frames(connection)
            self._connection = None

    def _reconnect(self, waited: float) -> ClientConnection | None:
        try:
            self._connection = _connect(self.uri, self._peer, self._options)
        except _FAILURES as error:
            self.status = self._explain(error)
            return None
        if self._closed.is_set():  # while it was being made, when there was nothing to close yet
            self._connection.close()
        return self._connection

    def _frames(self, connection: ClientConnection) -> Iterator[str | bytes]:
        self.status = ""
        with connection:
            try:
                while True:
                    try:
                        frame = connection.recv(self._patience)
                    except TimeoutError:
                        frame = ""
                    yield frame
            except ConnectionClosed as error:
                self.status = f"lost the connection to {self.uri} ({_reason(error)}): trying again"

    def send(self, text: str) -> None:
        """Ask something of the server; a connection that is just being lost will be noticed by its reader."""
        if self._connection is not None:
            try:
                self._connection.send(text)
            except ConnectionClosed:
                return

    def _explain(self, error: Exception) -> str:
        text = next((text for kind, text in _REMEDIES if isinstance(error, kind)), _REMEDY)
        forms = " or ".join(self._peer.addresses)
        return text.format(uri=self.uri, error=error, peer=self._peer, forms=forms)

    def close(self) -> None:
        """End `connections`, from any thread."""
        self._closed.set()
        if self._connection is not None:
            self._connection.close()


def check_options(uri: str, options: LinkOptions) -> None:
    """SourceError for a certificate that is none, or headers that could not be sent."""
    if options.ca:
        try:
            ssl.create_default_context(cafile=options.ca)
        except (OSError, ssl.SSLError) as error:
            raise SourceError(
                f"--ca {options.ca} cannot be read as a certificate ({error.strerror or error}): give a PEM file"
            ) from error
    for name, value in options.headers:
        if not HEADER.fullmatch(name) or not value.isascii() or not value.isprintable():
            raise SourceError(f"--header {name!r} cannot be sent to {uri}: give NAME=VALUE in plain letters")


def _connect(uri: str, peer: Peer, options: LinkOptions) -> ClientConnection:
    scheme, _, rest = uri.partition("://")
    schemes = [form.partition("://")[0] for form in peer.addresses]
    place = f"{('ws', 'wss')[schemes.index(scheme)]}://{rest}" if scheme in schemes else uri
    try:
        parse_uri(place)
    except ValueError as error:  # a port that is no number
        raise InvalidURI(uri, str(error)) from error
    connection = connect(
        place,
        ssl=ssl.create_default_context(cafile=options.ca) if options.ca and place.startswith("wss://") else None,
        additional_headers=options.headers,
        subprotocols=peer.subprotocols or None,
        compression=None,  # a robot's processor has better things to do
        proxy=None,  # a robot is a neighbour, not a web site
        open_timeout=CONNECT_TIMEOUT_S,
        ping_interval=PING_INTERVAL_S,
        ping_timeout=PING_TIMEOUT_S,
        close_timeout=1.0,
        max_size=LARGEST_FRAME,
        logger=silent_logger("hectorscope.sources.websockets"),
    )
    if peer.subprotocols and connection.subprotocol is None:
        connection.close()
        raise InvalidHandshake("the server chose none of the sub-protocols offered")
    return connection


def _is_final(error: Exception) -> bool:
    """Whether only a person can help."""
    if isinstance(error, InvalidStatus):
        return error.response.status_code < 500
    if isinstance(error, InvalidMessage):  # cut off while greeting: perhaps it is just starting
        return not isinstance(error.__cause__, EOFError)
    return isinstance(error, InvalidURI | UnicodeError | InvalidHandshake | socket.gaierror | ssl.SSLError)


def _reason(error: ConnectionClosed) -> str:
    return error.rcvd.reason or "closed by the server" if error.rcvd else "broken off"
