"""A robot's live topics by Zenoh, as ROS 2 with rmw_zenoh speaks it, through the robot's router."""

import time
from collections.abc import Iterator, Sequence
from functools import partial
from queue import Empty, Full, Queue
from typing import Any

from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.ros.rmw_zenoh import (
    ALL_TOKENS,
    FORM,
    NO_HASH,
    PORT,
    Publication,
    client_config,
    publication,
    router,
    sent_ns,
)
from hectorscope.sources import stream
from hectorscope.sources._live import LiveSource
from hectorscope.sources._offers import Event, Offer, Payload, Withdrawal
from hectorscope.sources._ros2_offers import ros2_offer

TIMEOUT_MS = 1000  # of one attempt
SCOUT_S = 1.0  # for the answers of routers
PAUSE_S = 1.0  # between two attempts to reach the router
LOOK_S = 0.2
MOST_WAITING = 20_000  # events; beyond, the router is held up, and drops what is not reliable


class ZenohWire:
    """One session: Zenoh makes lost connections again, and its subscriptions with them."""

    def __init__(self, uri: str) -> None:
        """SourceError for an address of another form, or without the library."""
        found = router(uri)
        if found is None:
            raise SourceError(f"{uri} is no address of this kind: give {FORM}, such as zenoh://robot:{PORT}/0")
        try:
            import zenoh  # noqa: PLC0415 - of the extra of that name
        except ImportError as error:
            raise SourceError(f"{uri} needs eclipse-zenoh: install hectorscope[zenoh]") from error
        self._zenoh: Any = zenoh
        self._uri, self._router = uri, found
        self._events: Queue[Event] = Queue(MOST_WAITING)
        self._numbers: dict[str, int] = {}  # of the key of a topic in a type
        self._publications: dict[int, Publication] = {}
        self._tokens: dict[int, set[str]] = {}
        self._subscribers: dict[int, Any] = {}
        self._session: Any = None
        self._is_closed = False
        self._is_reached = False

    @property
    def status(self) -> str:
        """Why nothing flows right now; empty while there is a router."""
        remedy = f"no Zenoh router answers at {self._uri}: start it there (rmw_zenohd)"
        return "" if self._is_reached else remedy

    @property
    def round_trip_s(self) -> float:
        """Zenoh does not tell."""
        return 0.0

    def connections(self) -> Iterator[Iterator[Sequence[Event]]]:
        """One, which outlives the loss of its router."""
        while not self._is_closed and self._session is None:
            try:
                self._session = self._zenoh.open(client_config(self._zenoh, self._router.endpoint, TIMEOUT_MS))
            except self._zenoh.ZError:
                time.sleep(PAUSE_S)
        if self._session is None:
            return
        try:
            tokens = ALL_TOKENS.format(domain=self._router.domain)
            self._session.liveliness().declare_subscriber(tokens, self._announced, history=True)
            yield self._batches(self._session)
        finally:  # an open session would keep the program from ending
            self._is_closed = True
            self._session.close()

    def _batches(self, session: Any) -> Iterator[Sequence[Event]]:
        while not self._is_closed:
            self._is_reached = bool(session.info.routers_zid())
            try:
                yield [self._events.get(timeout=LOOK_S)]
            except Empty:
                continue

    def _put(self, event: Event) -> None:
        """From Zenoh's threads; they wait for a slow reader, but not for one that has gone."""
        while not self._is_closed:
            try:
                self._events.put(event, timeout=LOOK_S)
            except Full:
                continue
            return

    def _announced(self, sample: Any) -> None:
        """A publisher has come or gone; a topic is there as long as one of its publishers is."""
        token, is_new = str(sample.key_expr), sample.kind == self._zenoh.SampleKind.PUT
        found = publication(token)
        if found is None:
            return
        number = self._numbers.setdefault(found.key, len(self._numbers) + 1)
        others = self._tokens.setdefault(number, set())
        were = bool(others)
        (others.add if is_new else others.discard)(token)
        if is_new and not were:
            self._publications[number] = found
            known_hash = "" if found.type_hash == NO_HASH else found.type_hash
            self._put(ros2_offer(number, found.topic, found.msgtype, known_hash))
        elif were and not others:
            self._put(Withdrawal(number))

    def subscribe(self, offers: Sequence[Offer]) -> None:
        """Ask for topics; of those that are kept for who comes later, for the last message too."""
        from zenoh import ext  # noqa: PLC0415

        for wanted in offers:
            found = self._publications[wanted.id]
            if self._session is None or wanted.id in self._subscribers:
                continue
            history = ext.HistoryConfig(detect_late_publishers=True) if found.is_latched else None
            self._subscribers[wanted.id] = ext.declare_advanced_subscriber(
                self._session, found.key, partial(self._received, wanted.id), history=history
            )

    def _received(self, number: int, sample: Any) -> None:
        attachment = sample.attachment.to_bytes() if sample.attachment is not None else None
        self._put(Payload(number, sent_ns(attachment) or time.time_ns(), sample.payload.to_bytes()))

    def close(self) -> None:
        """End the session."""
        self._is_closed = True


def scouted(seconds: float = SCOUT_S) -> list[str]:
    """The addresses of routers that answer Zenoh's discovery; none without the library."""
    try:
        import zenoh  # noqa: PLC0415 - of the extra of that name
    except ImportError:
        return []
    try:
        with zenoh.scout(what="router") as scout:
            time.sleep(seconds)
            heard = list(iter(scout.try_recv, None))
    except Exception:  # no network, or one that forbids it: nothing answers
        return []
    places = [place for hello in heard for place in hello.locators if place.startswith("tcp/")]
    return sorted({f"zenoh://{place.removeprefix('tcp/')}" for place in places if "[" not in place})


def _open(uri: str, options: SourceOptions) -> LiveSource:
    return LiveSource(uri, options, ZenohWire(uri))


SOURCE = stream(_open, FORM)
