"""Topics for ROS 2 by Zenoh, through the robot's router: as rmw_zenoh announces and sends them, version 1."""

import json
import re
import struct
import time
from dataclasses import dataclass, field
from typing import Any

from hectorscope.publishing import BusKind, PublishError
from hectorscope.results import ros_messages
from hectorscope.results.topics import MAP, TF, TOPICS, Message

FORM = "zenoh://HOST:PORT/DOMAIN"
ADDRESS = re.compile(
    r"zenoh://(?P<host>[A-Za-z0-9.\-]+|\[[0-9A-Fa-f:.]+\])(:(?P<port>\d{1,5}))?(/(?P<domain>\d+)?)?"
)
PORT = 7447
TRANSIENT_LOCAL = {MAP}  # the last one is kept for who comes later
NODE = "hectorscope"


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
        attachment = struct.pack("<qqB", self.number, time.time_ns(), len(self.identity)) + self.identity
        self.publisher.put(content, attachment=attachment)

    def hears(self) -> bool:
        """Whether anybody has subscribed."""
        return bool(self.publisher.matching_status.matching)


class ZenohBus:
    """A node of the robot's ROS domain. The router drops what it cannot pass on at once."""

    def __init__(self, uri: str) -> None:
        """PublishError for an address of another form, where no router answers, or without the library."""
        found = ADDRESS.fullmatch(uri)
        if found is None:
            raise PublishError(f"{uri} is no address of a router: give {FORM}, such as zenoh://robot:{PORT}/0")
        try:
            import zenoh  # noqa: PLC0415 - of the extra of that name
        except ImportError as error:
            raise PublishError(f"{uri} needs eclipse-zenoh: install hectorscope[zenoh]") from error
        self._zenoh: Any = zenoh
        domain, port = int(found["domain"] or 0), int(found["port"] or PORT)
        try:
            self._session: Any = zenoh.open(self._config(f"tcp/{found['host']}:{port}"))
        except zenoh.ZError as error:
            raise PublishError(f"no Zenoh router answers at {uri}: start it there (rmw_zenohd)") from error
        self._topics = {topic: self._announced(domain, number, topic) for number, topic in enumerate(TOPICS, 1)}

    def wants(self, topic: str) -> bool:
        """Whether a node has subscribed to it; the last map is kept for those that come."""
        return topic in TRANSIENT_LOCAL or self._topics[topic].hears()

    def publish(self, message: Message) -> None:
        """To the nodes that have subscribed."""
        if self.wants(message.topic):
            self._topics[message.topic].put(message.content)

    def close(self) -> None:
        """Leave the domain."""
        self._session.close()

    def _config(self, endpoint: str) -> Any:
        """A client of this router alone: nothing is looked for on the network."""
        config = self._zenoh.Config()
        options = {
            "mode": "client",
            "connect/endpoints": [endpoint],
            "connect/timeout_ms": 3000,
            "scouting/multicast/enabled": False,
            "timestamping/enabled": True,  # or nothing could be kept for who comes later
        }
        for key, value in options.items():
            config.insert_json5(key, json.dumps(value))
        return config

    def _announced(self, domain: int, number: int, topic: str) -> _Topic:
        from zenoh import ext  # noqa: PLC0415

        package, _, name = TOPICS[topic].split("/")
        dds_type = f"{package}::msg::dds_::{name}_"
        type_hash = ros_messages.STORE.hash_rihs01(TOPICS[topic])
        key = f"{domain}/{topic.strip('/')}/{dds_type}/{type_hash}"
        is_latched = topic in TRANSIENT_LOCAL
        publisher: Any
        if is_latched:
            cache = ext.CacheConfig(max_samples=1)
            publisher = ext.declare_advanced_publisher(self._session, key, cache=cache, publisher_detection=True)
        else:
            publisher = self._session.declare_publisher(key)
        zid = str(self._session.info.zid())
        depth = 100 if topic == TF else 1
        quality = f":1:,{depth}:,:,:,," if is_latched else f"::,{depth}:,:,:,,"
        words = (str(domain), zid, "0", str(number), "MP", "%", "%", NODE, topic.replace("/", "%"))
        token = "/".join(("@ros2_lv", *words, dds_type, type_hash, quality))
        identity = bytes.fromhex(zid.zfill(32))[:15] + bytes([number])
        return _Topic(publisher, self._session.liveliness().declare_token(token), identity)


BUS = BusKind(FORM, ZenohBus)
