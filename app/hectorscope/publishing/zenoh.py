"""Topics for ROS 2 by Zenoh, through the robot's router: as rmw_zenoh announces and sends them, version 1."""

import time
from dataclasses import dataclass, field
from typing import Any

from hectorscope.publishing import BusKind, PublishError
from hectorscope.results import ros_messages
from hectorscope.results.topics import DEPTHS, LATCHED, TOPICS, Message
from hectorscope.ros.rmw_zenoh import FORM, PORT, announced, attachment, client_config, router, token_of

NODE = "hectorscope"
TIMEOUT_MS = 3000


@dataclass(slots=True)
class _Topic:
    """One that is announced. number: of its last message."""

    publisher: Any
    token: Any
    identity: bytes
    number: int = field(default=0)

    def put(self, content: bytes) -> None:
        """With its number, the time and who sends it, as rmw_zenoh attaches them."""
        self.number += 1
        attached = attachment(self.number, time.time_ns(), self.identity)
        self.publisher.put(content, attachment=attached)

    def has_subscribers(self) -> bool:
        """Whether anybody has subscribed."""
        return bool(self.publisher.matching_status.matching)


class ZenohBus:
    """A node of the robot's ROS domain. The router drops what it cannot pass on at once."""

    def __init__(self, uri: str) -> None:
        """PublishError for an address of another form, where no router answers, or without the library."""
        found = router(uri)
        if found is None:
            raise PublishError(f"{uri} is no address of a router: give {FORM}, such as zenoh://robot:{PORT}/0")
        try:
            import zenoh  # noqa: PLC0415 - of the extra of that name
        except ImportError as error:
            raise PublishError(f"{uri} needs eclipse-zenoh: install hectorscope[zenoh]") from error
        # Without times, nothing could be kept for who comes later.
        config = client_config(zenoh, found.endpoint, TIMEOUT_MS, timestamping__enabled=True)
        try:
            self._session: Any = zenoh.open(config)
        except zenoh.ZError as error:
            raise PublishError(f"no Zenoh router answers at {uri}: start it there (rmw_zenohd)") from error
        self._topics = {
            topic: self._announced(found.domain, number, topic) for number, topic in enumerate(TOPICS, 1)
        }

    def wants(self, topic: str) -> bool:
        """Whether a node has subscribed to it; the last map is kept for those that come."""
        return topic in LATCHED or self._topics[topic].has_subscribers()

    def publish(self, message: Message) -> None:
        """To the nodes that have subscribed."""
        if self.wants(message.topic):
            self._topics[message.topic].put(message.content)

    def close(self) -> None:
        """Leave the domain."""
        self._session.close()

    def _announced(self, domain: int, number: int, topic: str) -> _Topic:
        from zenoh import ext  # noqa: PLC0415

        type_hash = ros_messages.STORE.hash_rihs01(TOPICS[topic])
        found = announced(domain, topic, TOPICS[topic], type_hash, is_latched=topic in LATCHED)
        publisher: Any
        if found.is_latched:
            cache = ext.CacheConfig(max_samples=1)
            publisher = ext.declare_advanced_publisher(
                self._session, found.key, cache=cache, publisher_detection=True
            )
        else:
            publisher = self._session.declare_publisher(found.key)
        zid = str(self._session.info.zid())
        token = token_of(found, zid, number, NODE, depth=DEPTHS.get(topic, 1))
        identity = bytes.fromhex(zid.zfill(32))[:15] + bytes([number])
        return _Topic(publisher, self._session.liveliness().declare_token(token), identity)


BUS = BusKind(FORM, ZenohBus)
