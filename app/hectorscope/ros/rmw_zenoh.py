"""ROS 2 by Zenoh, as rmw_zenoh speaks it, version 1: addresses, keys of topics and their messages, attachments.

A publisher announces itself by a liveliness token,
    @ros2_lv/DOMAIN/SESSION/NODE/ENTITY/MP/ENCLAVE/NAMESPACE/NAME/TOPIC/TYPE/HASH/QOS
in which "%" stands for "/". Its messages are at DOMAIN/TOPIC/TYPE/HASH, without the first "/" of the topic. With
each message come its number, the publisher's time and its identity.
"""

import json
import re
import struct
from dataclasses import dataclass
from typing import Any, NamedTuple

from hectorscope.ros.dds_names import dds_type, ros_type

FORM = "zenoh://HOST:PORT/DOMAIN"
PORT = 7447
ADDRESS = re.compile(
    r"zenoh://(?P<host>[A-Za-z0-9.\-]+|\[[0-9A-Fa-f:.]+\])(:(?P<port>\d{1,5}))?(/(?P<domain>\d+)?)?"
)

ALL_TOKENS = "@ros2_lv/{domain}/**"
PUBLISHER = "MP"
PARTS = 13
NO_HASH = "TypeHashNotSupported"  # of ROS 2 Humble
TRANSIENT_LOCAL = "1"
ATTACHMENT = struct.Struct("<qq")  # number and time [ns]; the length of the identity and that follow


class Router(NamedTuple):
    """Where a router is, as Zenoh names it, and the ROS domain."""

    endpoint: str
    domain: int


def router(uri: str) -> Router | None:
    """The router that an address names; None for an address of another form."""
    found = ADDRESS.fullmatch(uri)
    return found and Router(f"tcp/{found['host']}:{int(found['port'] or PORT)}", int(found["domain"] or 0))


def client_config(zenoh: Any, endpoint: str, timeout_ms: int, **more: Any) -> Any:
    """A client of this router alone: nothing is looked for on the network. more: options, with __ for /."""
    config = zenoh.Config()
    options = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": timeout_ms,
        "scouting/multicast/enabled": False,
        **{name.replace("__", "/"): value for name, value in more.items()},
    }
    for name, value in options.items():
        config.insert_json5(name, json.dumps(value))
    return config


@dataclass(frozen=True, slots=True)
class Publication:
    """A topic in one type. key: of its messages. is_latched: the last message is kept for who comes later."""

    topic: str
    msgtype: str
    type_hash: str
    key: str
    is_latched: bool


def publication(token: str) -> Publication | None:
    """What a token announces; None if it is no publisher's."""
    parts = token.split("/")
    if len(parts) != PARTS or parts[5] != PUBLISHER:
        return None
    domain, topic, name, type_hash, qos = parts[1], parts[9].replace("%", "/"), *parts[10:]
    msgtype = ros_type(name)
    if msgtype is None:
        return None
    durability = qos.split(":")[1] if ":" in qos else ""
    key = _key(domain, topic, name, type_hash)
    return Publication(topic, msgtype, type_hash, key, durability == TRANSIENT_LOCAL)


def announced(domain: int, topic: str, msgtype: str, type_hash: str, *, is_latched: bool) -> Publication:
    """A topic that we publish."""
    return Publication(topic, msgtype, type_hash, _key(domain, topic, dds_type(msgtype), type_hash), is_latched)


def token_of(found: Publication, session: str, number: int, node: str, depth: int) -> str:
    """How a publisher announces itself. number: of it in the session. depth: messages that are kept."""
    domain = found.key.partition("/")[0]
    topic, durability = found.topic.replace("/", "%"), TRANSIENT_LOCAL if found.is_latched else ""
    qos = f":{durability}:,{depth}:,:,:,,"
    words = ("@ros2_lv", domain, session, "0", str(number), PUBLISHER, "%", "%", node, topic)
    return "/".join((*words, dds_type(found.msgtype), found.type_hash, qos))


def attachment(number: int, time_ns: int, identity: bytes) -> bytes:
    """What goes with a message. identity: (16,) of its publisher."""
    return ATTACHMENT.pack(number, time_ns) + bytes([len(identity)]) + identity


def _key(domain: str | int, topic: str, type_name: str, type_hash: str) -> str:
    return f"{domain}/{topic.strip('/')}/{type_name}/{type_hash}"


def sent_ns(attached: bytes | None) -> int | None:
    """The publisher's time of a message; None if it does not tell."""
    if attached is None or len(attached) < ATTACHMENT.size:
        return None
    time_ns: int = ATTACHMENT.unpack_from(attached)[1]
    return time_ns if time_ns > 0 else None
